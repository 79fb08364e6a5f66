// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_tag_geometry.hpp"

#include "tagsmith/base/text.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kMostModules = 1000.0;
constexpr int kLeastDotsPerInch = 50;
constexpr int kMostDotsPerInch = 10'000;

}  // namespace

std::optional<Size> read_size(const YamlNode* node, const std::string& name, FindingLog& log) {
  const auto values = read_numbers(node, name, 2, above_zero(kLargestPlate, "m"), log);
  if (!values) return std::nullopt;
  return Size{(*values)[0], (*values)[1]};
}

void read_feature_frame(const MapReader& frame, TagTemplate& tag) {
  FindingLog& log = frame.log();
  const auto inner = read_size(frame.need("inner", "inner: [length, height] in metres"),
                               frame.name_of("inner"), log);
  if (inner) {
    tag.frame_inner_length = inner->width;
    tag.frame_inner_height = inner->height;
  }
  tag.frame_stroke = frame.number("stroke", above_zero(1, "m")).value_or(0);
  const auto offset = read_numbers(frame.find("offset"), frame.name_of("offset"), 2,
                                   between(-kLargestPlate, kLargestPlate, "m"), log);
  if (offset) {
    tag.frame_offset_right = (*offset)[0];
    tag.frame_offset_up = (*offset)[1];
  }
}

void read_symbol(const MapReader& symbol, TagTemplate& tag) {
  tag.quiet_zone_modules =
      symbol.number("quiet_zone", between(kQuietZoneModules, kMostModules, "modules"))
          .value_or(tag.quiet_zone_modules);
  tag.margin_modules =
      symbol.number("margin", between(0, kMostModules, "modules")).value_or(tag.margin_modules);
  tag.dots_per_inch = read_integer(symbol.find("dots_per_inch"), symbol.name_of("dots_per_inch"),
                                   kLeastDotsPerInch, kMostDotsPerInch, symbol.log())
                          .value_or(0);
}

void check_symbol(const TagTemplate& tag, const MapReader& file) {
  constexpr double kRounding = 1e-6;  // of lengths written in decimals
  if (bar_height(tag) <= 0) {
    file.log().error(
        file.find("symbol")->place, "no-bars",
        "the bars would be " + format_number(bar_height(tag)) + " m high, expected more than 0",
        "a smaller margin or a higher inner frame");
  }
  if (tag.dots_per_inch > 0 &&
      module_width(tag) < (1 - kRounding) * kMetresPerInch / tag.dots_per_inch) {
    file.log().error(file.find("symbol")->place, "no-dots",
                     "a module is narrower than one dot of " + std::to_string(tag.dots_per_inch) +
                         " dots per inch",
                     "a longer inner frame or a finer printer");
  }
}

}  // namespace tagsmith::detail
