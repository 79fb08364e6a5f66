// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/check_tags.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "decoder/image/pixel.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith {
namespace {

int differing_digits(const Digits& a, const Digits& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
  return count;
}

std::string nearest_in_words(const Survey& survey, const Digits& digits) {
  const PlacedTag* nearest = nearest_tag(survey, digits);
  if (nearest == nullptr) return "the survey has no tags";
  return fmt::format("nearest is {} {}, which differs in {}", nearest->name,
                     to_string(nearest->digits), describe_difference(digits, nearest->digits));
}

// The other survey that has the tag, or null.
const Survey* home_of(std::span<const Survey> also, const Digits& digits) {
  const auto home = std::ranges::find_if(
      also, [&](const Survey& other) { return find_tag(other, digits) != nullptr; });
  return home == also.end() ? nullptr : &*home;
}

// A reading that the survey does not have.
void judge_stranger(const Survey& survey, std::span<const Survey> also, TagFinding& finding) {
  const Digits& digits = *finding.digits;
  if (const Survey* home = home_of(also, digits)) {
    finding.status = TagStatus::unknown;
    finding.rule = "other-survey";
    finding.message = fmt::format("{} is {} of survey {}, expected a tag of {}", to_string(digits),
                                  find_tag(*home, digits)->name, home->name, survey.name);
    return;
  }
  const CheckDigit scheme = survey.code.check;
  if (has_check_digit(scheme, digits)) {
    finding.status = TagStatus::unknown;
    finding.rule = "not-in-survey";
    finding.message = fmt::format("{} is not in survey {}; {}", to_string(digits), survey.name,
                                  nearest_in_words(survey, digits));
    return;
  }
  const std::uint8_t expected = check_digit(scheme, std::span(digits).first<11>());
  finding.status = TagStatus::misprinted;
  finding.message =
      fmt::format("{} ends with check digit {}, expected {} ({}); {}", to_string(digits),
                  digits.back(), expected, to_string(scheme), nearest_in_words(survey, digits));
  const CheckDigit other = scheme == CheckDigit::gs1 ? CheckDigit::sum10 : CheckDigit::gs1;
  const bool other_holds = has_check_digit(other, digits);
  finding.rule = other_holds ? "check-scheme" : "check-digit";
  const PlacedTag* nearest = nearest_tag(survey, digits);
  const bool is_own = nearest != nullptr && differing_digits(nearest->digits, digits) == 1;
  if (is_own) finding.tag = nearest->name;  // only the check digit is another
  if (!other_holds) return;
  finding.message += fmt::format("; it is right by {}", to_string(other));
  if (!is_own) {
    finding.message +=
        ", so it may be a tag of another survey that uses that: give it with --also to be told";
  }
}

TagFinding finding_of(const Survey& survey, std::span<const Survey> also, const Reading& reading) {
  TagFinding finding;
  finding.digits = reading.digits;
  finding.corners = reading.corners;
  finding.module_px = reading.module_px;
  finding.confidence = reading.confidence;
  finding.corner_covariance = reading.corner_covariance;
  if (const PlacedTag* tag = find_tag(survey, reading.digits)) {
    finding.tag = tag->name;
  } else {
    judge_stranger(survey, also, finding);
  }
  return finding;
}

// True when the outline, were it larger by a quarter of its size on every side, would leave the
// picture: what was taken for a feature frame may be the visible end of one.
bool may_be_cut_off(const FrameCorners& corners, const PictureSize& size) {
  const auto leaves = [](double least, double greatest, int pixels) {
    const double margin = 0.25 * (greatest - least);
    return least - margin < 0 || greatest + margin > pixels - 1;
  };
  const auto [left, right] = std::ranges::minmax(corners, {}, &PixelPoint::x);
  const auto [top, bottom] = std::ranges::minmax(corners, {}, &PixelPoint::y);
  return leaves(left.x, right.x, size.width) || leaves(top.y, bottom.y, size.height);
}

TagFinding finding_of(const Rejection& rejection, const std::optional<PictureSize>& size) {
  TagFinding finding;
  finding.corners = rejection.corners;
  finding.refused = rejection.reason;
  if (size && may_be_cut_off(rejection.corners, *size)) {
    finding.status = TagStatus::cut_off;
    finding.rule = "cut-off";
    finding.message = "a tag at the picture's edge, not read: " + describe(rejection);
  } else {
    finding.status = TagStatus::unreadable;
    finding.rule = "undecodable";
    finding.message = std::string(kUnread) + describe(rejection);
  }
  return finding;
}

}  // namespace

std::string to_string(TagStatus status) {
  switch (status) {
    case TagStatus::ok:
      return "ok";
    case TagStatus::unknown:
      return "unknown";
    case TagStatus::misprinted:
      return "misprinted";
    case TagStatus::unreadable:
      return "unreadable";
    case TagStatus::duplicate:
      return "duplicate";
    case TagStatus::cut_off:
      return "cut_off";
    case TagStatus::misplaced:
      return "misplaced";
    case TagStatus::doubtful:
      return "doubtful";
  }
  return "unknown";
}

std::string to_string(UpSource source) {
  switch (source) {
    case UpSource::page:
      return "page";
    case UpSource::rig:
      return "rig";
    case UpSource::camera:
      return "camera";
    case UpSource::doubted:
      return "doubted";
    case UpSource::unknown:
      break;
  }
  return "unknown";
}

const PlacedTag* nearest_tag(const Survey& survey, const Digits& digits) {
  const auto nearest = std::ranges::min_element(
      survey.tags, {}, [&](const PlacedTag& tag) { return differing_digits(tag.digits, digits); });
  return nearest == survey.tags.end() ? nullptr : &*nearest;
}

std::string describe_difference(const Digits& found, const Digits& expected) {
  std::string text;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == expected[i]) continue;
    text += fmt::format("{}digit {} (found {}, expected {})", text.empty() ? "" : ", ", i + 1,
                        found[i], expected[i]);
  }
  return text.empty() ? "no digit" : text;
}

std::optional<std::string> check_print_size(const TagTemplate& tag, const FrameCorners& corners,
                                            double metres_per_pixel) {
  const auto& [p, f, lower_right, q] = corners;
  const double length = (distance(p, f) + distance(q, lower_right)) / 2 * metres_per_pixel;
  const double height = (distance(p, q) + distance(f, lower_right)) / 2 * metres_per_pixel;
  const auto fits = [&](double found, double expected) {
    return std::abs(found - expected) <= std::max(0.005 * expected, 1.5 * metres_per_pixel);
  };
  if (fits(length, tag.frame_inner_length) && fits(height, tag.frame_inner_height)) return {};
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
  return fmt::format("its feature frame is {} x {} mm inside, expected {} x {} mm ({}); {}",
                     format_number(length * 1e3, 1), format_number(height * 1e3, 1),
                     format_number(tag.frame_inner_length * 1e3, 1),
                     format_number(tag.frame_inner_height * 1e3, 1), tag.name, scale);
}

std::vector<TagFinding> check_tags(const Survey& survey, const ReadResult& readings,
                                   const std::optional<PictureSize>& size,
                                   std::span<const Survey> also) {
  std::vector<TagFinding> findings;
  std::set<std::string> seen;
  for (const Reading& reading : readings.tags) {
    TagFinding finding = finding_of(survey, also, reading);
    if (finding.status == TagStatus::ok && !seen.insert(finding.tag).second) {
      finding.status = TagStatus::duplicate;
      finding.rule = "duplicate";
      finding.message = finding.tag + " is there more than once, expected once";
    }
    findings.push_back(std::move(finding));
  }
  for (const Rejection& rejection : readings.rejected)
    findings.push_back(finding_of(rejection, size));
  return findings;
}

void VerifyTally::add(const FileReport& report) {
  const auto count = [&](TagStatus status) -> int& {
    switch (status) {
      case TagStatus::ok:
        return counts_.ok;
      case TagStatus::misprinted:
        return counts_.misprinted;
      case TagStatus::unreadable:
        return counts_.unreadable;
      case TagStatus::duplicate:
        return counts_.duplicate;
      case TagStatus::cut_off:
        return counts_.cut_off;
      case TagStatus::misplaced:
        return counts_.misplaced;
      case TagStatus::doubtful:
        return counts_.doubtful;
      case TagStatus::unknown:
        break;
    }
    return counts_.unknown;
  };
  ++counts_.files;
  if (!report.findings.empty()) ++counts_.files_with_findings;
  if (report.stale) counts_.stale.push_back(report.file.string());
  for (const TagFinding& tag : report.tags) {
    ++count(tag.status);
    if (tag.status == TagStatus::ok || tag.status == TagStatus::doubtful) seen_.insert(tag.tag);
  }
}

VerifySummary VerifyTally::summary(const Survey& survey) const {
  VerifySummary summary = counts_;
  for (const PlacedTag& tag : survey.tags) {
    if (!seen_.contains(tag.name)) summary.missing.push_back(tag.name);
  }
  return summary;
}

VerifySummary summarize(const Survey& survey, std::span<const FileReport> reports) {
  VerifyTally tally;
  for (const FileReport& report : reports) tally.add(report);
  return tally.summary(survey);
}

}  // namespace tagsmith
