// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/findings.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/line_levels.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/verify/diagnose.hpp"
#include "decoder/verify/hanging.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// ---- Bows.

namespace {

constexpr int kSidePlaces = 33;  // along a side

// A side from a to b, and the direction out of the frame.
struct FrameEdge {
  PixelPoint a;
  PixelPoint b;
  PixelPoint out;
};

FrameEdge edge_of(const FrameCorners& corners, std::size_t i) {
  const PixelPoint& a = corners[i];
  const PixelPoint& b = corners[(i + 1) % 4];
  const PixelPoint along = (1 / distance(a, b)) * (b - a);
  const PixelPoint middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  PixelPoint out{along.y, -along.x};
  if (dot(out, a - middle) < 0) out = -1.0 * out;
  return {a, b, out};
}

// Where white turns to black on the way outwards through `at`, pixels from there; nothing without a
// clear edge. White is within `inside`, the stroke within `stroke`. `samples` is a buffer that is
// reused.
std::optional<double> edge_at(const GrayView& image, PixelPoint at, PixelPoint out, double inside,
                              double stroke, std::vector<double>& samples) {
  constexpr double kStep = 0.25;
  constexpr double kLeastContrast = 25;  // grey levels
  const int first = static_cast<int>(std::floor(-inside / kStep));
  const int last = static_cast<int>(std::ceil(stroke / kStep));
  const PlacesOnLine places{at, out, first, kStep};
  const auto is_within = [&](PixelPoint point) {
    return point.x >= 0 && point.y >= 0 && point.x <= image.width - 1 &&
           point.y <= image.height - 1;
  };
  if (!is_within(places.at(0)) || !is_within(places.at(last - first))) return std::nullopt;
  const int count = last - first + 1;
  samples.resize(static_cast<std::size_t>(count));
  sample_line(image, places, samples);
  double white = samples.front();
  double black = white;
  for (const double sample : samples) {
    white = sample > white ? sample : white;
    black = sample < black ? sample : black;
  }
  if (white - black < kLeastContrast) return std::nullopt;
  const double level = (white + black) / 2;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i - 1] < level || samples[i] >= level) continue;
    const double part = (samples[i - 1] - level) / (samples[i - 1] - samples[i]);
    return (first + static_cast<double>(i - 1) + part) * kStep;
  }
  return std::nullopt;
}

// The bow of the parabola through the points (place 0 to 1, distance), of which the worst are left
// out until the rest fit.
std::optional<double> fitted_bow(std::vector<Eigen::Vector2d> points) {
  constexpr double kMostScatter = 0.35;  // pixels, root mean square
  constexpr std::size_t kLeast = kSidePlaces * 2 / 3;
  while (points.size() >= kLeast) {
    const auto count = static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd terms(count, 3);
    Eigen::VectorXd values(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double t = points[static_cast<std::size_t>(i)].x();
      terms.row(i) << 1, t, 4 * t * (1 - t);
      values[i] = points[static_cast<std::size_t>(i)].y();
    }
    const Eigen::Vector3d fit = least_squares(terms, values);
    const Eigen::VectorXd residual = (values - terms * fit).cwiseAbs();
    Eigen::Index worst = 0;
    residual.maxCoeff(&worst);
    if (std::sqrt(residual.squaredNorm() / static_cast<double>(count)) < kMostScatter) {
      return fit[2];
    }
    points.erase(points.begin() + worst);
  }
  return std::nullopt;
}

std::optional<double> bow_of_side(const GrayView& image, const FrameEdge& side, double inside,
                                  double stroke) {
  std::vector<Eigen::Vector2d> points;
  std::vector<double> samples;
  for (int i = 0; i < kSidePlaces; ++i) {
    const double t = 0.04 + 0.92 * i / (kSidePlaces - 1);  // clear of the corners
    const PixelPoint at = side.a + t * (side.b - side.a);
    if (const auto edge = edge_at(image, at, side.out, inside, stroke, samples)) {
      points.emplace_back(t, *edge);
    }
  }
  return fitted_bow(std::move(points));
}

double largest_share(const FrameBow& bow, const FrameCorners& corners) {
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    largest = std::max(largest, std::abs(bow[i]) / distance(corners[i], corners[(i + 1) % 4]));
  }
  return largest;
}

// Outwards from the line between a and b.
double outwards(const FrameEdge& side, const Eigen::Vector2d& middle) {
  const PixelPoint chord = 0.5 * (side.a + side.b);
  return side.out.x * (middle.x() - chord.x) + side.out.y * (middle.y() - chord.y);
}

}  // namespace

std::optional<FrameBow> measure_bow(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners) {
  constexpr double kLeastStroke = 3;  // pixels
  FrameBow bow{};
  for (std::size_t i = 0; i < 4; ++i) {
    const FrameEdge side = edge_of(corners, i);
    // Perpendicular to this side a metre has as many pixels as along the two that meet it.
    const double across = distance(corners[(i + 1) % 4], corners[(i + 2) % 4]);
    const double height = i % 2 == 0 ? tag.frame_inner_height : tag.frame_inner_length;
    const double stroke = tag.frame_stroke * across / height;
    const double clear = i % 2 == 0 ? tag.margin_modules : tag.quiet_zone_modules;
    const double inside = 0.8 * clear * module_width(tag) * across / height;
    if (stroke < kLeastStroke) return std::nullopt;
    const auto measured = bow_of_side(image, side, inside, 0.8 * stroke);
    if (!measured) return std::nullopt;
    bow[i] = *measured;
  }
  return bow;
}

FrameBow bow_of_lens(const Camera& camera, const FrameCorners& corners) {
  FrameBow bow{};
  for (std::size_t i = 0; i < 4; ++i) {
    const FrameEdge side = edge_of(corners, i);
    const auto from = ray_through(camera, {side.a.x, side.a.y});
    const auto to = ray_through(camera, {side.b.x, side.b.y});
    const auto middle = from && to ? project(camera, 0.5 * (*from + *to)) : std::nullopt;
    if (middle) bow[i] = outwards(side, *middle);
  }
  return bow;
}

FrameBow without_radial(const FrameBow& bow, const FrameCorners& corners, int width, int height) {
  const Eigen::Vector2d centre((width - 1) / 2.0, (height - 1) / 2.0);
  const auto shifted = [&](const Eigen::Vector2d& point) -> Eigen::Vector2d {
    const Eigen::Vector2d from = point - centre;
    return from.squaredNorm() * from;
  };
  Eigen::Vector4d by_radial;
  Eigen::Vector4d measured;
  for (std::size_t i = 0; i < 4; ++i) {
    const FrameEdge side = edge_of(corners, i);
    const Eigen::Vector2d a(side.a.x, side.a.y);
    const Eigen::Vector2d b(side.b.x, side.b.y);
    const Eigen::Vector2d moved = shifted((a + b) / 2) - (shifted(a) + shifted(b)) / 2;
    by_radial[static_cast<Eigen::Index>(i)] = side.out.x * moved.x() + side.out.y * moved.y();
    measured[static_cast<Eigen::Index>(i)] = bow[i];
  }
  const double k = by_radial.dot(measured) / std::max(1e-9, by_radial.squaredNorm());
  const Eigen::Vector4d left = measured - k * by_radial;
  return {left[0], left[1], left[2], left[3]};
}

double share_of_bend(const FrameBow& bow, const FrameCorners& corners) {
  double share = 0;
  for (const std::size_t i : {0U, 1U}) {
    if (bow[i] * bow[i + 2] >= 0) continue;  // outwards both or inwards both: not one bend
    const double one = std::abs(bow[i]) / distance(corners[i], corners[i + 1]);
    const double other = std::abs(bow[i + 2]) / distance(corners[i + 2], corners[(i + 3) % 4]);
    share = std::max(share, std::min(one, other));
  }
  return share;
}

std::optional<Finding> find_bent(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (!evidence.is_photo) return std::nullopt;
  const Camera* camera = evidence.camera;
  const FrameCorners& corners = seen.tag.corners;
  std::optional<FrameBow> bow = measure_bow(evidence.image, evidence.survey.tag_template, corners);
  if (!bow) return std::nullopt;
  if (camera != nullptr) {
    const FrameBow of_lens = bow_of_lens(*camera, corners);
    for (std::size_t i = 0; i < 4; ++i) (*bow)[i] -= of_lens[i];
  }
  double share = share_of_bend(*bow, corners);
  if (camera == nullptr) {
    const FrameBow left =
        without_radial(*bow, corners, evidence.image.width, evidence.image.height);
    share = std::min(share, largest_share(left, corners));
  }
  const double limit = camera != nullptr ? kMostBend : kMostBendOfUnknownLens;
  if (share <= limit) return std::nullopt;
  return Finding{TagStatus::misprinted, "bent",
                 fmt::format("{} is bent: two opposite sides of its frame bow by {:.1f} % of their "
                             "length, limit {:.0f} %",
                             seen.tag.tag, 100 * share, 100 * limit)};
}

// ---- The findings.

namespace {

// In order of precedence: a tag gets the first finding that applies.
constexpr FindFault kFindings[] = {
    // Which tag it is, and whether it is read.
    find_unknown,
    find_duplicate,
    find_cut_off,
    find_unread,
    // Findings that would make the next ones wrong: a mirrored print looks upside down, and a plate
    // upside down or bent looks as if it hung elsewhere.
    find_mirrored,
    find_upside_down,
    find_bent,
    // Where it hangs, in photos; then its size and its file, for prints.
    find_misplaced,
    find_wrong_scale,
    find_repeated,
    find_other_file,
};

// The beginning of the message on an unreadable tag.
constexpr std::string_view kUnread = "a tag was found and could not be read: ";

// "digit 5 (found 3, expected 8), digit 12 (...)": where two codes differ, counted from 1.
std::string difference_in_words(const Digits& found, const Digits& expected) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == expected[i]) continue;
    parts.push_back(fmt::format("digit {} (found {}, expected {})", i + 1, found[i], expected[i]));
  }
  return parts.empty() ? "no digit" : fmt::format("{}", fmt::join(parts, ", "));
}

// "; nearest is 002R 000001940408, which differs in digit 3 (...)" where a few wrong digits explain
// the code; otherwise empty.
std::string nearest_in_words(const Survey& survey, const Digits& digits) {
  constexpr int kMostWrong = 3;  // digits: in codes of twelve, more are another code
  const PlacedTag* nearest = nearest_tag(survey, digits);
  if (nearest == nullptr || differing_digits(nearest->digits, digits) > kMostWrong) return {};
  return fmt::format("; nearest is {} {}, which differs in {}", nearest->name,
                     to_string(nearest->digits), difference_in_words(digits, nearest->digits));
}

// A code that breaks the survey's check digit. One that is right by the other scheme and that is
// near no tag of the survey is a tag of another survey.
Finding wrong_check_digit(const PictureEvidence& evidence, const TagEvidence& seen) {
  const Digits& digits = *seen.tag.digits;
  const CheckDigit scheme = evidence.survey.code.check;
  const CheckDigit other = scheme == CheckDigit::gs1 ? CheckDigit::sum10 : CheckDigit::gs1;
  const bool other_holds = has_check_digit(other, digits);
  const std::string nearest = nearest_in_words(evidence.survey, digits);
  if (other_holds && seen.tag.tag.empty() && nearest.empty()) {
    return {
        TagStatus::unknown, "not-in-survey",
        fmt::format("{} is not in survey {}, and right by {} where its codes are by {}",
                    to_string(digits), evidence.survey.name, to_string(other), to_string(scheme))};
  }
  const std::string also_right =
      other_holds ? fmt::format("; it is right by {}", to_string(other)) : "";
  return {TagStatus::misprinted, other_holds ? "check-scheme" : "check-digit",
          fmt::format("{} ends with check digit {}, expected {} ({}){}{}", to_string(digits),
                      digits.back(), check_digit(scheme, std::span(digits).first<11>()),
                      to_string(scheme), nearest, also_right)};
}

// True when the feature frame around these bars would not be wholly in the photo.
bool frame_may_leave(const GrayView& photo, const TagTemplate& tag, const FrameCorners& bars) {
  const double module = module_width(tag);
  const double stroke = tag.frame_stroke / module;
  const double bar_height = tag.frame_inner_height / module - 2 * tag.margin_modules;
  const double beside = (tag.quiet_zone_modules + stroke) / kModuleCount;
  const double above = (tag.margin_modules + stroke) / bar_height;
  const Homography image_from_frame = homography_to(bars);
  for (const double right : {-beside, 1 + beside}) {
    for (const double down : {-above, 1 + above}) {
      const PixelPoint at = image_from_frame(right, down);
      const bool inside =
          at.x >= 0 && at.x <= photo.width - 1 && at.y >= 0 && at.y <= photo.height - 1;
      if (!inside) return true;
    }
  }
  return false;
}

Finding refused(const PictureEvidence& evidence, const TagEvidence& seen) {
  const std::optional<int> up = evidence.is_photo ? evidence.orientation : std::optional(1);
  const Diagnosis why =
      diagnose(evidence.image, evidence.survey.tag_template, *seen.refusal, up, evidence.is_photo);
  return {TagStatus::unreadable, why.rule, fmt::format("{}{}{}", kUnread, why.words, seen.by_bars)};
}

// Bars that are read without a frame; if the light hides the frame, the light is the reason.
Finding no_frame(const PictureEvidence& evidence, const TagEvidence& seen) {
  const std::string name = name_of(evidence.survey, *seen.tag.digits);
  if (!evidence.is_photo) {
    return {TagStatus::unreadable, "no-frame",
            fmt::format("the bars of {} are there without their whole feature frame", name)};
  }
  const std::optional<Diagnosis> light = diagnose_light(evidence.image, seen.tag.corners);
  return {TagStatus::unreadable, light ? light->rule : "no-frame",
          fmt::format("the bars of {} can be read, but no whole feature frame is to be seen around "
                      "them{}",
                      name, light ? ": " + light->words : "")};
}

// Bars that are read after ink was taken away, or added.
Finding grown(const PictureEvidence& evidence, const TagEvidence& seen) {
  const bool thinned = seen.sight == Sight::thinned;
  const double module_mm = 1e3 * module_width(evidence.survey.tag_template);
  return {TagStatus::unreadable, "bars-grown",
          fmt::format("{}bars {} than drawn by more than {:.1f} modules ({:.1f} mm): made so much "
                      "{}, it is {}",
                      kUnread, thinned ? "wider" : "narrower", kJudge.most_growth,
                      kJudge.most_growth * module_mm, thinned ? "narrower" : "wider",
                      name_of(evidence.survey, *seen.tag.digits))};
}

}  // namespace

void find_faults(PictureEvidence& evidence) {
  for (const FindFault find : kFindings) {
    std::vector<std::optional<Finding>> found;
    for (const TagEvidence& seen : evidence.tags) {
      const bool in_order = seen.tag.finding.status == TagStatus::ok;
      found.push_back(in_order ? find(evidence, seen) : std::nullopt);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i]) evidence.tags[i].tag.finding = std::move(*found[i]);
    }
  }
}

std::optional<Finding> find_unknown(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (seen.sight != Sight::read) return std::nullopt;
  const Survey& survey = evidence.survey;
  const Digits& digits = *seen.tag.digits;
  if (find_tag(survey, digits) != nullptr) return std::nullopt;
  if (const Survey* home = home_of(evidence.also, digits)) {
    return Finding{TagStatus::unknown, "other-survey",
                   fmt::format("{} is {} of survey {}, expected a tag of {}", to_string(digits),
                               find_tag(*home, digits)->name, home->name, survey.name)};
  }
  if (!has_check_digit(survey.code.check, digits)) return wrong_check_digit(evidence, seen);
  if (!seen.tag.tag.empty()) {
    return Finding{TagStatus::unknown, "stale",
                   fmt::format("{} {} is what was printed, but no longer in the survey",
                               seen.tag.tag, to_string(digits))};
  }
  return Finding{TagStatus::unknown, "not-in-survey",
                 fmt::format("{} is not in survey {}{}", to_string(digits), survey.name,
                             nearest_in_words(survey, digits))};
}

std::optional<Finding> find_duplicate(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (seen.sight != Sight::read) return std::nullopt;
  const auto first = std::ranges::find_if(evidence.tags, [&](const TagEvidence& other) {
    return other.sight == Sight::read && other.tag.tag == seen.tag.tag &&
           other.tag.finding.status == TagStatus::ok;
  });
  if (&*first == &seen) return std::nullopt;
  return Finding{TagStatus::duplicate, "duplicate",
                 seen.tag.tag + " is there more than once, expected once"};
}

std::optional<Finding> find_cut_off(const PictureEvidence& evidence, const TagEvidence& seen) {
  const FrameCorners& corners = seen.tag.corners;
  if (!evidence.is_photo) return std::nullopt;
  // The outline that was treated as a feature frame may be the visible end of one.
  constexpr double kHidden = 0.25;
  if (seen.sight == Sight::refused && leaves(corners, evidence.image, kHidden)) {
    return Finding{
        TagStatus::cut_off, "cut-off",
        "a tag at the picture's edge, not read: " + describe(*seen.refusal) + seen.by_bars};
  }
  if (seen.sight == Sight::part && leaves(corners, evidence.image)) {
    return Finding{TagStatus::cut_off, "cut-off",
                   "a tag at the picture's edge; what is in sight fits " + seen.fits};
  }
  if (seen.sight == Sight::bars &&
      frame_may_leave(evidence.image, evidence.survey.tag_template, corners)) {
    return Finding{TagStatus::cut_off, "cut-off",
                   name_of(evidence.survey, *seen.tag.digits) +
                       " at the picture's edge, read by its bars without its whole feature frame"};
  }
  return std::nullopt;
}

std::optional<Finding> find_unread(const PictureEvidence& evidence, const TagEvidence& seen) {
  switch (seen.sight) {
    case Sight::read:
      return std::nullopt;
    case Sight::part:
      return Finding{TagStatus::unreadable, "covered",
                     fmt::format("{}something hides a part of it; what is in sight fits {}",
                                 kUnread, seen.fits)};
    case Sight::refused:
      return refused(evidence, seen);
    case Sight::negative:
      return Finding{TagStatus::misprinted, "inverted",
                     name_of(evidence.survey, *seen.tag.digits) +
                         (evidence.survey.tag_template.white_on_black
                              ? " is black on white, expected white on black"
                              : " is white on black, expected black on white")};
    case Sight::thinned:
    case Sight::thickened:
      return grown(evidence, seen);
    case Sight::bars:
      return no_frame(evidence, seen);
  }
  return std::nullopt;
}

std::optional<Finding> find_mirrored(const PictureEvidence&, const TagEvidence& seen) {
  if (seen.mirrored.empty()) return std::nullopt;
  return Finding{TagStatus::misprinted, "mirrored",
                 seen.tag.tag + " is mirrored: " + seen.mirrored};
}

// A frame as printed, metres: its mean sides, and whether it has the template's size and is a
// rectangle. Scans must be right within 0.5 %, files within 0.2 %, or 1.5 pixels.
struct PrintedFrame {
  double length = 0;
  double height = 0;
  bool fits = false;
  bool is_rectangle = false;
};

PrintedFrame printed_frame(const PictureEvidence& evidence, const FrameCorners& corners) {
  const double share = evidence.up == UpSource::page ? 0.002 : 0.005;
  const double unit = evidence.metres_per_pixel;
  const TagTemplate& tag = evidence.survey.tag_template;
  const auto& [p, f, r, q] = corners;
  const auto alike = [&](double found, double expected) {
    return std::abs(found - expected) <= std::max(share * expected, 1.5 * unit);
  };
  const double top = unit * distance(p, f), bottom = unit * distance(q, r);
  const double left = unit * distance(p, q), right = unit * distance(f, r);
  PrintedFrame frame{(top + bottom) / 2, (left + right) / 2};
  frame.fits =
      alike(frame.length, tag.frame_inner_length) && alike(frame.height, tag.frame_inner_height);
  frame.is_rectangle = alike(top, bottom) && alike(left, right) &&
                       alike(unit * distance(p, r), unit * distance(f, q));
  return frame;
}

// The printed size and shape, on a page or in a scan: from a frame that is no rectangle, cameras
// compute another direction than the plate has.
std::optional<Finding> find_wrong_scale(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (evidence.metres_per_pixel <= 0) return std::nullopt;
  const TagTemplate& tag = evidence.survey.tag_template;
  const auto [length, height, fits, is_rectangle] = printed_frame(evidence, seen.tag.corners);
  if (fits && is_rectangle) return std::nullopt;
  if (fits) {
    return Finding{TagStatus::misprinted, "wrong-scale",
                   seen.tag.tag +
                       ": its feature frame is no rectangle: opposite sides, or the two diagonals, "
                       "differ in length; the page was sheared, or photographed from the side"};
  }
  const double wide = length / tag.frame_inner_length;
  const double high = height / tag.frame_inner_height;
  constexpr double kAlike = 0.01;
  const std::string scale =
      std::abs(wide / high - 1) < kAlike
          ? fmt::format("{:.1f} % of its size", 50 * (wide + high))
          : fmt::format(
                "{:.1f} % of its width and {:.1f} % of its height: stretched, or of another "
                "template",
                100 * wide, 100 * high);
  return Finding{
      TagStatus::misprinted, "wrong-scale",
      fmt::format("{}: its feature frame is {} x {} mm inside, expected {} x {} mm ({}); {}",
                  seen.tag.tag, format_number(length * 1e3, 1), format_number(height * 1e3, 1),
                  format_number(tag.frame_inner_length * 1e3, 1),
                  format_number(tag.frame_inner_height * 1e3, 1), tag.name, scale)};
}

// A tag that an earlier page of the file holds.
std::optional<Finding> find_repeated(const PictureEvidence& evidence, const TagEvidence& seen) {
  for (const VerifiedTag& earlier : evidence.other_pages) {
    if (earlier.finding.status != TagStatus::ok || earlier.tag != seen.tag.tag) continue;
    return Finding{
        TagStatus::duplicate, "duplicate",
        fmt::format("{} is on page {} already, expected once", seen.tag.tag, earlier.page)};
  }
  return std::nullopt;
}

// A tag that the manifest has in another file.
std::optional<Finding> find_other_file(const PictureEvidence& evidence, const TagEvidence& seen) {
  std::vector<std::string> names;
  for (const ManifestTag& tag : evidence.expected) {
    if (tag.digits == seen.tag.digits) return std::nullopt;
    names.push_back(tag.name);
  }
  if (names.empty()) return std::nullopt;
  return Finding{TagStatus::misprinted, "other-file",
                 fmt::format("{} {} stands in this file, expected {} (manifest.json)", seen.tag.tag,
                             to_string(*seen.tag.digits), fmt::join(names, ", "))};
}

}  // namespace tagsmith::detail
