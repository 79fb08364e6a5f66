// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hidden_tag.hpp"

#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "decoder/image/grow_ink.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/survey_options.hpp"
#include "decoder/verify/diagnose.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith {
namespace {

// "000L", or the digits of a stranger.
std::string name_of(const Survey& survey, const Digits& digits) {
  const PlacedTag* tag = find_tag(survey, digits);
  return tag == nullptr ? to_string(digits) : tag->name;
}

TagFinding finding_of(const Survey& survey, const Digits& digits, const FrameCorners& corners) {
  TagFinding finding;
  finding.digits = digits;
  finding.corners = corners;
  if (const PlacedTag* tag = find_tag(survey, digits)) finding.tag = tag->name;
  return finding;
}

// A reading by frame, of any code of the survey's template; the surest.
std::optional<TagFinding> read_as(const Survey& survey, const GrayImage& image) {
  ReadOptions options = read_options_for(std::span(&survey, 1));
  options.code_book.clear();
  options.check.reset();
  const ReadResult result = read_tags(image.view(), options);
  if (result.tags.empty()) return std::nullopt;
  return finding_of(survey, result.tags.front().digits, result.tags.front().corners);
}

std::optional<TagFinding> find_inverted(const Survey& survey, const PageImage& page) {
  auto finding = read_as(survey, exchange_black_and_white(page.image.view()));
  if (!finding) return std::nullopt;
  finding->status = TagStatus::misprinted;
  finding->rule = "inverted";
  finding->message = fmt::format("{} is white on black, expected black on white",
                                 name_of(survey, *finding->digits));
  return finding;
}

// Bars that touch, or that are hairs, stand apart again when as much ink is taken away or added as
// the reader follows by itself.
std::optional<TagFinding> find_grown(const Survey& survey, const PageImage& page) {
  const double module = module_width(survey.tag_template);
  const int pixels = static_cast<int>(std::lround(kMostGrowth * module / page.metres_per_pixel));
  if (pixels < 1) return std::nullopt;
  for (const bool grown : {true, false}) {
    auto finding = read_as(survey, grow_ink(page.image.view(), grown ? -pixels : pixels));
    if (!finding) continue;
    finding->status = TagStatus::unreadable;
    finding->rule = "bars-grown";
    finding->message = fmt::format(
        "{}bars {} than drawn by more than {:.1f} modules ({:.1f} mm): made so much {}, it is {}",
        kUnread, grown ? "wider" : "narrower", kMostGrowth, 1e3 * kMostGrowth * module,
        grown ? "narrower" : "wider", name_of(survey, *finding->digits));
    return finding;
  }
  return std::nullopt;
}

std::optional<TagFinding> find_frameless(const Survey& survey, const PageImage& page) {
  ReadOptions options = read_options_for(std::span(&survey, 1));
  options.search = Search::never;
  options.frameless = Frameless::always;
  const ReadResult result = read_tags(page.image.view(), options);
  if (result.frameless.read.empty()) return std::nullopt;
  const FramelessReading& bars = result.frameless.read.front();
  TagFinding finding = finding_of(survey, bars.digits, bars.bars);
  finding.status = TagStatus::unreadable;
  finding.rule = "no-frame";
  finding.message = fmt::format("the bars of {} are there without their whole feature frame",
                                name_of(survey, bars.digits));
  return finding;
}

}  // namespace

std::optional<TagFinding> find_hidden_tag(const Survey& survey, const PageImage& page) {
  if (auto inverted = find_inverted(survey, page)) return inverted;
  if (auto grown = find_grown(survey, page)) return grown;
  const std::optional<Diagnosis> light = diagnose_picture(page.image.view());
  if (light && light->rule == "too-dark") return std::nullopt;  // that is why there is no frame
  return find_frameless(survey, page);
}

}  // namespace tagsmith
