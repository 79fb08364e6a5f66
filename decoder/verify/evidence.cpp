// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/grow_ink.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/verify/diagnose.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// ---- Mirrored prints.

namespace {

struct Strip {
  double white = 0;  // brightest tenth, samples
  double ink = 0;    // share of samples darker than half of it
};

// The strip in the plate's frame; nothing when a part of it is outside the picture.
std::optional<Strip> look_at(const GrayView& image, const TagTemplate& tag,
                             const FrameCorners& corners, const Rectangle& area) {
  constexpr int kAlong = 160;
  constexpr int kAcross = 12;
  const Homography image_from_frame = homography_to(corners);
  std::vector<double> samples;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const PixelPoint at =
          image_from_frame((area.x + area.width * (i + 0.5) / kAlong) / tag.frame_inner_length,
                           (area.y + area.height * (j + 0.5) / kAcross) / tag.frame_inner_height);
      const auto level = sample_nearest(image, at);
      if (!level) return std::nullopt;
      samples.push_back(*level);
    }
  }
  std::ranges::sort(samples);
  const double white = samples[samples.size() * 9 / 10];
  const auto dark = std::ranges::lower_bound(samples, white / 2);
  return Strip{white,
               static_cast<double>(dark - samples.begin()) / static_cast<double>(samples.size())};
}

// Where the label's text stands; nothing when there is no text below the frame.
std::optional<Rectangle> label_below(const TagTemplate& tag) {
  if (!tag.label.shown) return std::nullopt;
  const Rectangle strip = strip_below_frame(tag);
  if (strip.height < kLeastLabelHeight) return std::nullopt;
  // The patches at its right end would count as ink.
  const double width = strip.width - (tag.patch_size > 0 ? 2.5 * tag.patch_size : 0);
  return Rectangle{strip.x, strip.y, width, strip.height};
}

bool is_mirrored(const GrayView& image, const TagTemplate& tag, const FrameCorners& corners,
                 const Rectangle& below) {
  Rectangle above = below;
  above.y = tag.frame_inner_height - below.y - below.height;
  const std::optional<Strip> right = look_at(image, tag, corners, below);
  const std::optional<Strip> wrong = look_at(image, tag, corners, above);
  constexpr double kBlank = 0.003;
  constexpr double kLeastInk = 0.02;
  constexpr double kMostInk = 0.4;  // rock and other plates are darker as a whole
  constexpr double kSameWhite = 0.7;
  return right && wrong && right->ink < kBlank && wrong->ink > kLeastInk && wrong->ink < kMostInk &&
         right->white > kSameWhite * wrong->white && wrong->white > kSameWhite * right->white;
}

// White of the plate above and below the outer edge of the feature frame, metres, in the plate's
// frame as read.
struct Margins {
  double above = 0;
  double below = 0;
};

Margins margins_of(const TagTemplate& tag) {
  const double both = tag.plate_height - tag.frame_inner_height - 2 * tag.frame_stroke;
  return {both / 2 - tag.frame_offset_up, both / 2 + tag.frame_offset_up};
}

// How far the plate's white extends from the frame's outer edge, upwards or downwards: a high
// quantile of places along the frame, since letters end it early. Nothing when it continues beyond
// `farthest` or out of the picture: paper on paper, a white wall.
std::optional<double> white_beyond(const GrayView& image, const TagTemplate& tag,
                                   const Homography& image_from_frame, bool upwards,
                                   double farthest) {
  constexpr int kPlaces = 24;
  constexpr double kStep = 0.001;  // metres
  std::vector<double> widths;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = 0.1 + 0.8 * (i + 0.5) / kPlaces;
    const auto sample = [&](double out) -> std::optional<double> {
      const double down = upwards ? -out : tag.frame_inner_height + out;
      return sample_nearest(image, image_from_frame(along, down / tag.frame_inner_height));
    };
    const auto white = sample(-module_width(tag) * tag.margin_modules / 2);
    if (!white) return std::nullopt;
    const double first = module_width(tag);  // nearer is the stroke's blur
    const int last = static_cast<int>(std::floor((farthest - first) / kStep));
    int step = 0;
    for (; step <= last; ++step) {
      const auto level = sample(tag.frame_stroke + first + step * kStep);
      if (!level) return std::nullopt;
      if (*level < *white / 2) break;
    }
    widths.push_back(first + step * kStep);
  }
  std::ranges::sort(widths);
  const double width = widths[widths.size() * 4 / 5];
  if (width > farthest) return std::nullopt;
  return width;
}

// Where the frame is not in the middle of the plate, a mirrored print has its wider margin above
// the bars as they are read, not below, or the reverse.
bool is_mirrored_by_margins(const GrayView& image, const TagTemplate& tag,
                            const FrameCorners& corners) {
  constexpr double kLeastDifference = 0.010;  // metres
  constexpr double kFits = 0.3;               // of the difference
  const Margins drawn = margins_of(tag);
  const double difference = std::abs(drawn.above - drawn.below);
  if (difference < kLeastDifference) return false;
  const Homography image_from_frame = homography_to(corners);
  const double farthest = std::max(drawn.above, drawn.below) + difference;
  const auto above = white_beyond(image, tag, image_from_frame, true, farthest);
  const auto below = white_beyond(image, tag, image_from_frame, false, farthest);
  return above && below && std::abs(*above - drawn.below) < kFits * difference &&
         std::abs(*below - drawn.above) < kFits * difference;
}

}  // namespace

// Why: docs/decisions/0015-files-and-ledger.md.
std::string find_mirroring(const GrayView& image, const TagTemplate& tag,
                           const FrameCorners& corners, double module_px) {
  constexpr double kLeastModule = 4;  // pixels; letters are four modules high and more
  constexpr double kLeastModuleForMargins = 2;
  const std::optional<Rectangle> below = label_below(tag);
  if (below && module_px >= kLeastModule && is_mirrored(image, tag, corners, *below)) {
    return "its label stands above the bars, expected below";
  }
  if (module_px >= kLeastModuleForMargins && is_mirrored_by_margins(image, tag, corners)) {
    return "the plate's wider margin is on the wrong side of the bars";
  }
  return {};
}

// ---- What is seen.

namespace {

ReadOptions options_for(const PictureEvidence& evidence) {
  ReadOptions options = read_options_for(std::span(&evidence.survey, 1));
  if (evidence.camera != nullptr) options.camera = *evidence.camera;
  return options;
}

// The survey's name of the tag with these digits; or of the tag that should have them, if the print
// is as the manifest says, or only the check digit is wrong.
std::string tag_of(const PictureEvidence& evidence, const Digits& digits) {
  if (const PlacedTag* tag = find_tag(evidence.survey, digits)) return tag->name;
  if (home_of(evidence.also, digits) != nullptr) return {};
  if (!has_check_digit(evidence.survey.code.check, digits)) {
    const PlacedTag* nearest = nearest_tag(evidence.survey, digits);
    const bool is_own = nearest != nullptr && differing_digits(nearest->digits, digits) == 1;
    return is_own ? nearest->name : std::string();
  }
  const auto printed = std::ranges::find(evidence.expected, digits, &ManifestTag::digits);
  return printed == evidence.expected.end() ? std::string() : printed->name;
}

// From a Reading or FramelessReading, whose outline is given.
TagEvidence seen_as(const PictureEvidence& evidence, Sight sight, const auto& reading,
                    const FrameCorners& corners) {
  TagEvidence seen;
  seen.sight = sight;
  seen.tag.tag = tag_of(evidence, reading.digits);
  seen.tag.digits = reading.digits;
  seen.tag.corners = corners;
  seen.tag.module_px = reading.module_px;
  seen.tag.confidence = reading.confidence;
  seen.tag.page = evidence.page;
  return seen;
}

// The survey's tags that are read in another version of the picture; on a page the first tag,
// whatever its code.
std::vector<TagEvidence> read_changed(const PictureReading& read, const PictureEvidence& evidence,
                                      const GrayImage& changed, Sight sight) {
  ReadOptions options = options_for(evidence);
  options.white_on_black = false;  // black and white are already exchanged where needed
  if (!evidence.is_photo) {
    options.code_book.clear();
    options.check.reset();
  }
  std::vector<TagEvidence> tags;
  for (const Reading& reading : read(changed.view(), options).tags) {
    tags.push_back(seen_as(evidence, sight, reading, reading.corners));
    if (!evidence.is_photo) break;
  }
  return tags;
}

// Bars that touch, or that are hairs, can be separated when the ink is reduced or increased by as
// much as the reader tolerates on its own.
std::vector<TagEvidence> read_with_other_ink(const PictureReading& read,
                                             const PictureEvidence& evidence) {
  const double module = module_width(evidence.survey.tag_template);
  const auto pixels =
      static_cast<int>(std::lround(kJudge.most_growth * module / evidence.metres_per_pixel));
  for (const Sight sight : {Sight::thinned, Sight::thickened}) {
    if (pixels < 1) break;
    const GrayImage changed = grow_ink(evidence.image, sight == Sight::thinned ? -pixels : pixels);
    auto tags = read_changed(read, evidence, changed, sight);
    if (!tags.empty()) return tags;
  }
  return {};
}

// Bars that were read where a frame was refused give the refusal a name; this is a guess if its
// frame makes it one. All others are separate tags; those of no survey are left out.
void see_bars(const FramelessReading& bars, bool is_guess, PictureEvidence& evidence) {
  const auto there = std::ranges::find_if(
      evidence.tags, [&](const TagEvidence& seen) { return overlap(seen.tag.corners, bars.bars); });
  if (there == evidence.tags.end()) {
    if (!is_guess) evidence.tags.push_back(seen_as(evidence, Sight::bars, bars, bars.bars));
    return;
  }
  const PlacedTag* tag = find_tag(evidence.survey, bars.digits);
  if (tag == nullptr) return;
  there->by_bars +=
      fmt::format("; {} {}", is_guess ? "perhaps it is" : "by its bars it is", tag->name);
  if (!is_guess) there->tag.tag = tag->name;
}

// Replaces what was refused there. True when there are some.
bool replace_refused(const std::vector<TagEvidence>& found, PictureEvidence& evidence) {
  for (const TagEvidence& tag : found) {
    std::erase_if(evidence.tags, [&](const TagEvidence& other) {
      return other.sight == Sight::refused && overlap(tag.tag.corners, other.tag.corners);
    });
  }
  evidence.tags.insert(evidence.tags.end(), found.begin(), found.end());
  return !found.empty();
}

// Tags of a picture in which none was read by its frame.
void see_hidden(const PictureReading& read, PictureEvidence& evidence) {
  if (evidence.is_photo && evidence.survey.tags.empty()) return;
  const GrayImage negative = exchange_black_and_white(evidence.image);
  if (replace_refused(read_changed(read, evidence, negative, Sight::negative), evidence)) return;
  const FramelessResult& frameless = evidence.readings.frameless;
  if (evidence.is_photo) {
    for (const FramelessReading& bars : frameless.read) see_bars(bars, false, evidence);
    for (const FramelessRejection& refused : frameless.rejected) {
      if (refused.bars_are_sure) see_bars(refused.symbol, true, evidence);
    }
    return;
  }
  if (replace_refused(read_with_other_ink(read, evidence), evidence)) return;
  const std::optional<Diagnosis> light = diagnose_picture(evidence.image);
  const bool is_dark = light && light->rule == "too-dark";  // why there is no frame
  if (evidence.tags.empty() && !frameless.read.empty() && !is_dark) {
    see_bars(frameless.read.front(), false, evidence);
  }
}

// A tag that was read otherwise stays. What was refused there is given a name, or, where the
// picture's border cuts it, is replaced by the part.
void see_part(const PartReading& part, PictureEvidence& evidence) {
  TagEvidence seen;
  seen.sight = Sight::part;
  seen.tag.corners = part.corners;
  seen.tag.module_px = part.module_px;
  std::vector<std::string> names;
  for (const PartCandidate& candidate : part.candidates) {
    names.push_back(name_of(evidence.survey, candidate.digits));
  }
  seen.fits = fmt::format("{}", fmt::join(names, " or "));
  if (names.size() == 1) seen.tag.tag = names.front();
  const auto is_there = [&](const TagEvidence& other) {
    return overlap(part.corners, other.tag.corners);
  };
  const auto is_refused = [&](const TagEvidence& other) {
    return other.sight == Sight::refused && is_there(other);
  };
  if (leaves(part.corners, evidence.image)) {
    std::erase_if(evidence.tags, is_refused);
  } else if (const auto refused = std::ranges::find_if(evidence.tags, is_refused);
             refused != evidence.tags.end()) {
    refused->by_bars = "; what is in sight fits " + seen.fits;
    refused->tag.tag = seen.tag.tag;
  }
  if (std::ranges::none_of(evidence.tags, is_there)) evidence.tags.push_back(std::move(seen));
}

// Whether what was refused is much smaller than a tag, on a page or scan of known scale that shows
// one: a shape of a logo.
bool is_too_small(const PictureEvidence& evidence, const FrameCorners& refused) {
  constexpr double kLeast = 0.5;  // of the feature frame's length
  if (evidence.metres_per_pixel <= 0 || evidence.readings.tags.empty()) return false;
  const auto& [p, f, r, q] = refused;
  const double longest = std::max({distance(p, f), distance(f, r), distance(r, q), distance(q, p)});
  return evidence.metres_per_pixel * longest <
         kLeast * evidence.survey.tag_template.frame_inner_length;
}

}  // namespace

void see_tags(const PictureReading& read, PictureEvidence& evidence) {
  ReadOptions options = options_for(evidence);
  options.check.reset();
  options.likely_codes = std::exchange(options.code_book, {});
  options.frameless = Frameless::fallback;
  evidence.readings = without_repeats(read(evidence.image, options));
  for (const Reading& reading : evidence.readings.tags) {
    TagEvidence& seen =
        evidence.tags.emplace_back(seen_as(evidence, Sight::read, reading, reading.corners));
    seen.tag.corner_covariance = reading.corner_covariance;
    if (find_tag(evidence.survey, reading.digits) == nullptr) continue;
    seen.mirrored = find_mirroring(evidence.image, evidence.survey.tag_template, reading.corners,
                                   reading.module_px);
  }
  for (const Rejection& rejection : evidence.readings.rejected) {
    if (is_too_small(evidence, rejection.corners)) continue;
    TagEvidence& seen = evidence.tags.emplace_back();
    seen.sight = Sight::refused;
    seen.refusal = &rejection;
    seen.tag.corners = rejection.corners;
    seen.tag.page = evidence.page;
  }
  if (evidence.readings.tags.empty()) see_hidden(read, evidence);
  if (!evidence.is_photo) return;
  for (const PartReading& part : evidence.readings.parts) see_part(part, evidence);
}

namespace {

// How nearly a refusal was a reading: all of a doubtful one is explained except a digit; of others
// the share of the bars that is explained.
double nearness(const Rejection& rejection) {
  if (rejection.reason == RejectionReason::doubtful) return 1;
  return rejection.symbol ? rejection.symbol->decoding.fit.explained : 0;
}

}  // namespace

ReadResult without_repeats(ReadResult result) {
  std::vector<Rejection> kept;
  for (Rejection& rejection : result.rejected) {
    const auto lies_on = [&](const auto& other) {
      return overlap(other.corners, rejection.corners);
    };
    if (std::ranges::any_of(result.tags, lies_on)) continue;
    const auto same = std::ranges::find_if(kept, lies_on);
    if (same == kept.end()) {
      kept.push_back(std::move(rejection));
    } else if (nearness(rejection) > nearness(*same)) {
      *same = std::move(rejection);
    }
  }
  result.rejected = std::move(kept);
  return result;
}

bool leaves(const FrameCorners& corners, const GrayView& image, double larger_by) {
  const auto beyond = [&](double least, double greatest, int pixels) {
    const double margin = larger_by * (greatest - least);
    return least - margin < 0 || greatest + margin > pixels - 1;
  };
  const auto [left, right] = std::ranges::minmax(corners, {}, &PixelPoint::x);
  const auto [top, bottom] = std::ranges::minmax(corners, {}, &PixelPoint::y);
  return beyond(left.x, right.x, image.width) || beyond(top.y, bottom.y, image.height);
}

std::string name_of(const Survey& survey, const Digits& digits) {
  const PlacedTag* tag = find_tag(survey, digits);
  return tag == nullptr ? to_string(digits) : tag->name;
}

int differing_digits(const Digits& a, const Digits& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
  return count;
}

const PlacedTag* nearest_tag(const Survey& survey, const Digits& digits) {
  const CheckDigit other =
      survey.code.check == CheckDigit::gs1 ? CheckDigit::sum10 : CheckDigit::gs1;
  const PlacedTag* nearest = nullptr;
  int least = static_cast<int>(digits.size());
  for (const PlacedTag& tag : survey.tags) {
    const int differing = differing_digits(tag.digits, digits);
    if (std::ranges::equal(std::span(tag.digits).first<11>(), std::span(digits).first<11>())) {
      return &tag;
    }
    if (differing == least) nearest = nullptr;  // two are equally near
    if (differing < least) nearest = &tag;
    least = std::min(least, differing);
  }
  const bool is_of_other =
      !has_check_digit(survey.code.check, digits) && has_check_digit(other, digits);
  return is_of_other ? nullptr : nearest;
}

const Survey* home_of(std::span<const Survey> also, const Digits& digits) {
  const auto home = std::ranges::find_if(
      also, [&](const Survey& other) { return find_tag(other, digits) != nullptr; });
  return home == also.end() ? nullptr : &*home;
}

}  // namespace tagsmith::detail
