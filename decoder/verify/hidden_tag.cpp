// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hidden_tag.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/grow_ink.hpp"
#include "decoder/reader/judge.hpp"
#include "decoder/reader/survey_options.hpp"
#include "decoder/verify/diagnose.hpp"
#include "decoder/verify/outline.hpp"
#include "tagsmith/symbology/upca.hpp"
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
std::optional<TagFinding> read_as(const Survey& survey, const GrayImage& image,
                                  const PictureReading& read) {
  ReadOptions options = read_options_for(std::span(&survey, 1));
  options.code_book.clear();
  options.check.reset();
  const ReadResult result = read(image.view(), options);
  if (result.tags.empty()) return std::nullopt;
  return finding_of(survey, result.tags.front().digits, result.tags.front().corners);
}

void call_inverted(const Survey& survey, TagFinding& finding) {
  finding.status = TagStatus::misprinted;
  finding.rule = "inverted";
  finding.message = fmt::format("{} is white on black, expected black on white",
                                name_of(survey, *finding.digits));
}

std::optional<TagFinding> find_inverted(const Survey& survey, const PageImage& page,
                                        const PictureReading& read) {
  auto finding = read_as(survey, exchange_black_and_white(page.image.view()), read);
  if (finding) call_inverted(survey, *finding);
  return finding;
}

// Bars that touch, or that are hairs, stand apart again when as much ink is taken away or added as
// the reader follows by itself.
std::optional<TagFinding> find_grown(const Survey& survey, const PageImage& page,
                                     const PictureReading& read) {
  const double module = module_width(survey.tag_template);
  const int pixels = static_cast<int>(std::lround(kMostGrowth * module / page.metres_per_pixel));
  if (pixels < 1) return std::nullopt;
  for (const bool grown : {true, false}) {
    auto finding = read_as(survey, grow_ink(page.image.view(), grown ? -pixels : pixels), read);
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

TagFinding finding_of_bars(const Survey& survey, const FramelessReading& bars) {
  TagFinding finding = finding_of(survey, bars.digits, bars.bars);
  finding.status = TagStatus::unreadable;
  finding.rule = "no-frame";
  finding.message = fmt::format("the bars of {} are there without their whole feature frame",
                                name_of(survey, bars.digits));
  return finding;
}

std::vector<TagFinding> inverted_in_photo(const Survey& survey, const GrayView& photo,
                                          const Camera* camera, const PictureReading& read) {
  ReadOptions options = read_options_for(std::span(&survey, 1));
  if (camera != nullptr && camera->width == photo.width && camera->height == photo.height) {
    options.camera = *camera;
  }
  std::vector<TagFinding> findings;
  for (const Reading& reading : read(exchange_black_and_white(photo).view(), options).tags) {
    TagFinding finding = finding_of(survey, reading.digits, reading.corners);
    finding.module_px = reading.module_px;
    finding.confidence = reading.confidence;
    call_inverted(survey, finding);
    findings.push_back(std::move(finding));
  }
  return findings;
}

// True when the feature frame around these bars would not be wholly in the photo.
bool frame_may_leave(const GrayView& photo, const TagTemplate& tag, const FrameCorners& bars) {
  const double module = module_width(tag);
  const double stroke = tag.frame_stroke / module;
  const double bar_height = tag.frame_inner_height / module - 2 * tag.margin_modules;
  const double beside = (tag.quiet_zone_modules + stroke) / kModuleCount;
  const double above = (tag.margin_modules + stroke) / bar_height;
  const Homography image_from_unit = homography_to(bars);
  for (const double right : {-beside, 1 + beside}) {
    for (const double down : {-above, 1 + above}) {
      const PixelPoint at = image_from_unit(right, down);
      const bool inside =
          at.x >= 0 && at.x <= photo.width - 1 && at.y >= 0 && at.y <= photo.height - 1;
      if (!inside) return true;
    }
  }
  return false;
}

// Bars at the photo's edge are no fault; in light that hides the frame the light is to blame.
TagFinding bars_in_photo(const Survey& survey, const FramelessReading& bars,
                         const GrayView& photo) {
  TagFinding finding = finding_of(survey, bars.digits, bars.bars);
  finding.module_px = bars.module_px;
  finding.confidence = bars.confidence;
  const std::string name = name_of(survey, bars.digits);
  if (frame_may_leave(photo, survey.tag_template, bars.bars)) {
    finding.status = TagStatus::cut_off;
    finding.rule = "cut-off";
    finding.message =
        name + " at the picture's edge, read by its bars without its whole feature frame";
    return finding;
  }
  finding.status = TagStatus::unreadable;
  const std::optional<Diagnosis> light = diagnose_light(photo, bars.bars);
  finding.rule = light ? light->rule : "no-frame";
  finding.message = fmt::format(
      "the bars of {} can be read, but no whole feature frame is to be seen around "
      "them{}",
      name, light ? ": " + light->measured : "");
  return finding;
}

// What was refused there has a name now: a guess where its frame makes it one.
void name_refused(const Survey& survey, const FramelessReading& bars, bool is_guess,
                  TagFinding& refused) {
  const PlacedTag* tag = find_tag(survey, bars.digits);
  if (tag == nullptr) return;
  refused.message +=
      fmt::format("; {} {}", is_guess ? "perhaps it is" : "by its bars it is", tag->name);
  if (!is_guess) refused.tag = tag->name;
}

TagFinding* find_at(std::vector<TagFinding>& findings, const FrameCorners& place) {
  const auto at = std::ranges::find_if(
      findings, [&](const TagFinding& other) { return overlap(other.corners, place); });
  return at == findings.end() ? nullptr : &*at;
}

}  // namespace

void find_hidden_tags(const Survey& survey, const GrayView& photo, const Camera* camera,
                      const FramelessResult& frameless, const PictureReading& read,
                      std::vector<TagFinding>& findings) {
  if (survey.tags.empty()) return;
  const std::vector<TagFinding> inverted = inverted_in_photo(survey, photo, camera, read);
  for (const TagFinding& tag : inverted) {
    std::erase_if(findings, [&](const TagFinding& other) {
      return other.rule != "inverted" && overlap(tag.corners, other.corners);
    });
    findings.push_back(tag);
  }
  if (!inverted.empty()) return;
  for (const FramelessReading& bars : frameless.read) {
    TagFinding* refused = find_at(findings, bars.bars);
    if (refused != nullptr) {
      name_refused(survey, bars, false, *refused);
    } else {
      findings.push_back(bars_in_photo(survey, bars, photo));
    }
  }
  for (const FramelessRejection& rejection : frameless.rejected) {
    if (!rejection.bars_are_sure) continue;
    TagFinding* refused = find_at(findings, rejection.symbol.bars);
    if (refused != nullptr) name_refused(survey, rejection.symbol, true, *refused);
  }
}

std::optional<TagFinding> find_hidden_tag(const Survey& survey, const PageImage& page,
                                          const FramelessResult& frameless,
                                          const PictureReading& read) {
  if (auto inverted = find_inverted(survey, page, read)) return inverted;
  if (auto grown = find_grown(survey, page, read)) return grown;
  const std::optional<Diagnosis> light = diagnose_picture(page.image.view());
  if (light && light->rule == "too-dark") return std::nullopt;  // that is why there is no frame
  if (frameless.read.empty()) return std::nullopt;
  return finding_of_bars(survey, frameless.read.front());
}

}  // namespace tagsmith
