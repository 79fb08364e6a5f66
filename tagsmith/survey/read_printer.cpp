// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_printer.hpp"

#include <fmt/format.h>

#include "tagsmith/survey/yaml_file.hpp"

namespace tagsmith::detail {
namespace {

PrinterProfile read_profile(const YamlValue& root) {
  const MapReader file(root, {"printer", "scale", "bar_growth_mm", "dot_gain_percent"});
  PrinterProfile profile;
  profile.name = read_name(file.need("printer", "printer: NAME")).value_or("");
  const YamlValue scales = file.need("scale", "scale: [1.001, 0.999], printed over drawn");
  const auto scale = read_numbers(scales, 2, between(0, 2, ""));
  if (scale) profile.scale = {(*scale)[0], (*scale)[1]};
  if (scale && !is_usual(profile.scale)) {
    scales.error("out-of-range",
                 fmt::format("scale is {:g} and {:g}, expected {}", profile.scale.right,
                             profile.scale.down, usual_scales()),
                 "print the test sheet again at 100 %, without \"fit to page\", and measure it");
  }
  const auto growth = read_numbers(file.need("bar_growth_mm", "bar_growth_mm: [0.08, 0.06]"), 2,
                                   between(-2, 2, "mm"));
  if (growth) {
    profile.growth_right = (*growth)[0] / 1000;
    profile.growth_down = (*growth)[1] / 1000;
  }
  profile.dot_gain = file.number_or("dot_gain_percent", 0, between(-60, 60, "%")) / 100;
  return profile;
}

}  // namespace

Result<PrinterProfile> read_printer_profile(const std::filesystem::path& path) {
  return value_without_errors(read_yaml_file<PrinterProfile>(path, "printer", read_profile));
}

std::string printer_profile_text(const PrinterProfile& profile) {
  return fmt::format(
      "# What a printer does to a page, measured by `tagsmith printer`; for `tagsmith print\n"
      "# --profile`. First across, then down the page as it leaves the printer.\n"
      "printer: \"{}\"\n"
      "scale: [{:.5f}, {:.5f}]          # printed length over drawn length\n"
      "bar_growth_mm: [{:.3f}, {:.3f}]      # that every bar is too wide\n"
      "dot_gain_percent: {:.1f}             # that a tone of 50 % covers beyond 50 %\n",
      profile.name, profile.scale.right, profile.scale.down, profile.growth_right * 1000 + 0.0,
      profile.growth_down * 1000 + 0.0, profile.dot_gain * 100 + 0.0);
}

}  // namespace tagsmith::detail
