// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/findings.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/verify/diagnose.hpp"
#include "decoder/verify/frame_bow.hpp"
#include "decoder/verify/hanging.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// The beginning of the message on an unreadable tag.
constexpr std::string_view kUnread = "what looks like a tag could not be read: ";

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
  std::string words;
  if (seen.sight == Sight::refused && leaves(corners, evidence.image, kHidden)) {
    words = "a tag at the picture's edge, not read: " + describe(*seen.refusal) + seen.by_bars;
  } else if (seen.sight == Sight::part && leaves(corners, evidence.image)) {
    words = "a tag at the picture's edge; what is in sight fits " + seen.fits;
  } else if (seen.sight == Sight::bars &&
             frame_may_leave(evidence.image, evidence.survey.tag_template, corners)) {
    words = name_of(evidence.survey, *seen.tag.digits) +
            " at the picture's edge, read by its bars without its whole feature frame";
  }
  if (words.empty()) return std::nullopt;
  return Finding{TagStatus::cut_off, "cut-off", std::move(words)};
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

// In order of precedence: a tag gets the first finding that applies.
// Each checks one tag for which none of the findings before it was made. `status` of the picture's
// other tags is the result of those findings.
using FindFault = std::optional<Finding> (*)(const PictureEvidence&, const TagEvidence&);
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

}  // namespace tagsmith::detail
