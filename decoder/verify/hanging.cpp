// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hanging.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/nearest.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {
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
  const Homography image_from_unit = homography_to(corners);
  std::vector<double> samples;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const PixelPoint at =
          image_from_unit((area.x + area.width * (i + 0.5) / kAlong) / tag.frame_inner_length,
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

// Where the label's text stands; nothing when none is below the frame.
std::optional<Rectangle> label_below(const TagTemplate& tag) {
  if (!tag.label.shown) return std::nullopt;
  const Rectangle strip = strip_below_frame(tag);
  if (strip.height < kLeastLabelHeight) return std::nullopt;
  // The patches at its right end would be ink as well.
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
  constexpr double kMostInk = 0.4;  // rock and other plates are darker on the whole
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

// How far the plate's white goes on from the frame's outer edge, upwards or downwards: in most
// places along the frame, since letters end it early. Nothing when it goes on beyond `farthest` or
// out of the picture: paper on paper, a white wall.
std::optional<double> white_beyond(const GrayView& image, const TagTemplate& tag,
                                   const Homography& image_from_unit, bool upwards,
                                   double farthest) {
  constexpr int kPlaces = 24;
  constexpr double kStep = 0.001;  // metres
  std::vector<double> widths;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = 0.1 + 0.8 * (i + 0.5) / kPlaces;
    const auto sample = [&](double out) -> std::optional<double> {
      const double down = upwards ? -out : tag.frame_inner_height + out;
      return sample_nearest(image, image_from_unit(along, down / tag.frame_inner_height));
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

// Where the frame stands out of the plate's middle, a mirrored print has its wider margin above the
// bars as they are read, not below, or the other way round.
bool is_mirrored_by_margins(const GrayView& image, const TagTemplate& tag,
                            const FrameCorners& corners) {
  constexpr double kLeastDifference = 0.010;  // metres
  constexpr double kFits = 0.3;               // of the difference
  const Margins drawn = margins_of(tag);
  const double difference = std::abs(drawn.above - drawn.below);
  if (difference < kLeastDifference) return false;
  const Homography image_from_unit = homography_to(corners);
  const double farthest = std::max(drawn.above, drawn.below) + difference;
  const auto above = white_beyond(image, tag, image_from_unit, true, farthest);
  const auto below = white_beyond(image, tag, image_from_unit, false, farthest);
  return above && below && std::abs(*above - drawn.below) < kFits * difference &&
         std::abs(*below - drawn.above) < kFits * difference;
}

// The place of `corner` of the other plate in this plate's plane, metres right and down of P.
PixelPoint in_plane(const Homography& unit_from_image, const TagTemplate& tag, PixelPoint at) {
  const PixelPoint unit = unit_from_image(at.x, at.y);
  return {unit.x * tag.frame_inner_length, unit.y * tag.frame_inner_height};
}

// P of b in the plane of a, if b hangs there as a does: upright, and of the same size to 15 %.
std::optional<PixelPoint> beside(const TagTemplate& tag, const FrameCorners& a,
                                 const FrameCorners& b) {
  const Homography unit_from_image = inverse(homography_to(a));
  FrameCorners seen;
  for (std::size_t i = 0; i < 4; ++i) seen[i] = in_plane(unit_from_image, tag, b[i]);
  const double length = tag.frame_inner_length;
  const double height = tag.frame_inner_height;
  const auto near_to = [&](PixelPoint side, double x, double y) {
    return distance(side, PixelPoint{x, y}) < 0.15 * length;
  };
  const bool fits = near_to(seen[1] - seen[0], length, 0) &&
                    near_to(seen[2] - seen[3], length, 0) &&
                    near_to(seen[3] - seen[0], 0, height) && near_to(seen[2] - seen[1], 0, height);
  if (!fits) return std::nullopt;
  return seen[0];
}

void compare(const Survey& survey, TagFinding& a, TagFinding& b) {
  const PlacedTag* first = find_tag(survey, *a.digits);
  const PlacedTag* second = find_tag(survey, *b.digits);
  if (first == nullptr || second == nullptr) return;
  const TagTemplate& tag = survey.tag_template;
  constexpr double kFarthest = 4;  // metres
  const std::optional<PixelPoint> there = beside(tag, a.corners, b.corners);
  const std::optional<PixelPoint> back = beside(tag, b.corners, a.corners);
  if (!there || !back || std::abs(there->x) > kFarthest) return;
  std::string rule;
  std::string words;
  if (first->side != second->side) {
    rule = "wrong-wall";
    words = "hang side by side on one wall, expected on opposite ones";
  } else {
    const Eigen::Vector3d way =
        second->world_from_plate.translation - first->world_from_plate.translation;
    const double expected = first->world_from_plate.rotation.col(0).dot(way);
    if (std::abs(expected) > kFarthest || expected * there->x > 0) return;
    rule = "swapped";
    words = fmt::format("hang the wrong way round: {} is to the {} of {}, expected to the {}",
                        second->name, there->x > 0 ? "right" : "left", first->name,
                        expected > 0 ? "right" : "left");
  }
  for (TagFinding* finding : {&a, &b}) {
    finding->status = TagStatus::misplaced;
    finding->rule = rule;
    finding->message = fmt::format("{} and {} {}", first->name, second->name, words);
  }
}

// From the upper edge to the lower one as the tag itself stands.
PixelPoint down_of(const FrameCorners& corners) {
  return corners[3] - corners[0] + (corners[2] - corners[1]);
}

// Opposite, and alike, to 45 degrees.
bool opposes(const PixelPoint& a, const PixelPoint& b) {
  return a.x * b.x + a.y * b.y < -std::abs(cross(a, b));
}
bool agrees(const PixelPoint& a, const PixelPoint& b) { return opposes(a, -1.0 * b); }

struct StandingTag {
  TagFinding* finding = nullptr;
  PixelPoint down;  // in the upright picture
};

void tell(StandingTag& tag, TagStatus status, const std::string& how) {
  tag.finding->status = status;
  tag.finding->rule = "upside-down";
  tag.finding->message = tag.finding->tag + " is upside down" + how;
}

bool is_told(const StandingTag& tag) { return tag.finding->status != TagStatus::ok; }

// Those that stand on their head, the picture being upright as the camera noted. When all do, it is
// the camera that may have noted what is not so.
UpSource tell_heads(std::vector<StandingTag>& tags) {
  const auto on_head = [](const StandingTag& tag) { return opposes(tag.down, {0, 1}); };
  if (!tags.empty() && std::ranges::all_of(tags, on_head)) {
    if (tags.size() == 1) {
      tell(tags.front(), TagStatus::doubtful,
           " by the photo's EXIF orientation, and no other tag in the photo shows whether that is "
           "right. Look where its arrow points: if down, the plate hangs upside down; if up, the "
           "camera was upside down and noted otherwise, or the print is mirrored");
    }
    return UpSource::doubted;
  }
  for (StandingTag& tag : tags) {
    if (!on_head(tag)) continue;
    tell(tag, TagStatus::misprinted,
         " by the photo's EXIF orientation: it hangs upside down, or is a mirrored print");
  }
  return UpSource::camera;
}

// The one against whom all others stand.
void tell_odd_one(std::vector<StandingTag>& tags) {
  for (StandingTag& tag : tags) {
    const auto against = std::ranges::count_if(
        tags, [&](const StandingTag& other) { return opposes(tag.down, other.down); });
    const auto with = std::ranges::count_if(
        tags, [&](const StandingTag& other) { return agrees(tag.down, other.down); });
    if (is_told(tag) || against < 2 || with > 1) continue;  // with itself
    tell(tag, TagStatus::misprinted,
         fmt::format(" against the {} other tags in the photo: it hangs upside down, or is a "
                     "mirrored print (which way is up in the photo is not known: the others may "
                     "be the ones that hang wrong)",
                     against));
  }
}

}  // namespace

// Why: docs/decisions/0018-verification-lines.md.
void find_mirrored(const GrayView& image, const TagTemplate& tag,
                   std::vector<TagFinding>& findings) {
  constexpr double kLeastModule = 4;  // pixels; letters are four modules high and more
  constexpr double kLeastModuleForMargins = 2;
  const std::optional<Rectangle> below = label_below(tag);
  const auto mark = [](TagFinding& finding, const char* why) {
    finding.status = TagStatus::misprinted;
    finding.rule = "mirrored";
    finding.message = finding.tag + " is mirrored: " + why;
  };
  for (TagFinding& finding : findings) {
    if (finding.status != TagStatus::ok || finding.module_px < kLeastModuleForMargins) continue;
    if (below && finding.module_px >= kLeastModule &&
        is_mirrored(image, tag, finding.corners, *below)) {
      mark(finding, "its label stands above the bars, expected below");
    } else if (is_mirrored_by_margins(image, tag, finding.corners)) {
      mark(finding, "the plate's wider margin is on the wrong side of the bars");
    }
  }
}

void find_upside_down(std::vector<TagFinding>& findings) {
  for (TagFinding& finding : findings) {
    if (finding.status != TagStatus::ok) continue;
    const PixelPoint along = finding.corners[1] - finding.corners[0];
    if (along.x > -std::abs(along.y)) continue;
    finding.status = TagStatus::misprinted;
    finding.rule = "upside-down";
    finding.message =
        finding.tag + " is upside down on the page: it is turned, or a mirrored print";
  }
}

bool hangs_upright(const Survey& survey, const TagFinding& finding) {
  const PlacedTag* tag = find_tag(survey, std::string_view(finding.tag));
  return tag != nullptr && tag->world_from_plate.rotation(2, 1) < -std::numbers::sqrt2 / 2;
}

UpSource find_upside_down_by_camera(const Survey& survey, const std::optional<Upright>& camera_up,
                                    std::vector<TagFinding>& findings) {
  std::vector<StandingTag> tags;
  for (TagFinding& finding : findings) {
    if (finding.status != TagStatus::ok || !hangs_upright(survey, finding)) continue;
    FrameCorners corners = finding.corners;
    if (camera_up) {
      for (PixelPoint& corner : corners) corner = camera_up->turn(corner);
    }
    tags.push_back({&finding, down_of(corners)});
  }
  // In a mirrored picture plates read as if they stood on their head.
  const UpSource up = camera_up && !camera_up->mirrors() ? tell_heads(tags) : UpSource::unknown;
  tell_odd_one(tags);
  return up;
}

void find_misplaced(const Survey& survey, std::vector<TagFinding>& findings) {
  constexpr double kLeastModule = 2;  // pixels
  std::vector<TagFinding*> tags;
  for (TagFinding& finding : findings) {
    if (finding.status == TagStatus::ok && finding.module_px >= kLeastModule) {
      tags.push_back(&finding);
    }
  }
  for (std::size_t i = 0; i < tags.size(); ++i) {
    for (std::size_t j = i + 1; j < tags.size(); ++j) compare(survey, *tags[i], *tags[j]);
  }
}

}  // namespace tagsmith
