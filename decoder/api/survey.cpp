// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <utility>

#include <tagsmith/survey.hpp>

#include "decoder/api/data.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/check_tags.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith {
namespace {

using detail::check_number;
using detail::throw_invalid;

constexpr double kFarthestPoint = 1e8;  // metres, of grid coordinates
constexpr double kLongestPart = 1e6;    // metres, of a piece of the center line

void check_point(const std::string& name, const Vector3& point) {
  for (const double coordinate : point)
    check_number(name, coordinate, -kFarthestPoint, kFarthestPoint);
}

detail::PositionCode code_from(const PositionCode& code) {
  constexpr int kPayload = detail::kDigitCount - 1;
  const auto& counts = code.digit_counts;
  const bool counts_fit = std::ranges::all_of(counts, [](int n) { return n >= 1 && n <= 9; }) &&
                          std::accumulate(counts.begin(), counts.end(), 0) == kPayload;
  if (!counts_fit) throw_invalid("the code's digit counts do not sum to 11, each 1 to 9");
  for (const double step : code.resolution) check_number("the code's resolution", step, 1e-9, 1000);
  check_point("the code's origin", code.origin);
  return {code.check_digit == CheckDigit::gs1 ? detail::CheckDigit::gs1 : detail::CheckDigit::sum10,
          counts, code.resolution, code.origin};
}

detail::Tunnel tunnel_from(const SurveyDescription& description, const detail::Grid& grid) {
  check_number("the tunnel's width", description.width, 1e-3, 1000);
  check_number("the tunnel's height", description.height, 1e-3, 1000);
  check_point("the center line's start", description.start);
  check_number("the center line's heading", description.heading, -100, 100);
  if (description.centerline.empty()) throw_invalid("the center line is empty");
  std::vector<detail::CenterlineElement> elements;
  for (const CenterlinePart& part : description.centerline) {
    check_number("the length of a part of the center line", part.length, 1e-6, kLongestPart);
    check_number("the curvature of a part of the center line", part.curvature, -1000, 1000);
    check_number("the grade of a part of the center line", part.grade, -10, 10);
    elements.push_back({part.length, part.curvature, part.grade});
  }
  const Eigen::Vector3d start = world_from_grid(grid, detail::eigen_from(description.start));
  const double heading = world_heading_from_grid(grid, description.heading);
  return plain_tunnel(description.width, description.height,
                      detail::Centerline(start, heading, std::move(elements)));
}

detail::SourcedTag place(const detail::Survey& survey, const TagPlace& tag) {
  const auto name = detail::parse_tag_name(tag.name);
  if (!name) {
    throw_invalid("a tag is named `" + tag.name.substr(0, 60) +
                  "`, expected its pair and side as 000L");
  }
  check_point("corner P of " + tag.name, tag.corner_p);
  detail::PlacedTag placed =
      detail::place_surveyed(survey, *name, detail::eigen_from(tag.corner_p));
  if (tag.sigma) check_number("sigma of " + tag.name, *tag.sigma, 0, 100);
  placed.sigma = tag.sigma.value_or(survey.sigma);
  detail::SourcedTag sourced;
  sourced.printed_digits = tag.digits.has_value();
  const auto with_code =
      tag.digits ? detail::with_digits(placed, survey.code,
                                       detail::checked_digits(*tag.digits, "digits of " + tag.name))
                 : detail::with_own_digits(placed, survey.code);
  sourced.coded = with_code.has_value();
  sourced.tag = with_code ? *with_code : placed;
  return sourced;
}

// All reasons for which a survey file would be refused.
void check_tags(const detail::Survey& survey, const std::vector<detail::SourcedTag>& tags) {
  detail::FindingLog log("survey " + survey.name);
  check_code_range(survey, tags, {}, log);
  check_codes(survey, tags, {}, log);
  check_walls(survey, tags, {}, log);
  if (log.has_errors()) throw_invalid(to_string(log.sorted(), true));
}

std::vector<detail::SourcedTag> place_all(const detail::Survey& survey,
                                          const std::vector<TagPlace>& places) {
  std::vector<detail::SourcedTag> tags;
  tags.reserve(places.size());
  for (const TagPlace& one : places) tags.push_back(place(survey, one));
  std::ranges::sort(tags, {}, [](const detail::SourcedTag& one) {
    return std::pair(one.tag.pair, one.tag.side);
  });
  const auto twice = std::ranges::adjacent_find(
      tags, {}, [](const detail::SourcedTag& one) { return one.tag.name; });
  if (twice != tags.end()) throw_invalid("two tags are named " + twice->tag.name);
  return tags;
}

detail::Survey survey_from(const SurveyDescription& description) {
  if (description.name.empty()) throw_invalid("the survey has no name");
  detail::Survey survey;
  survey.name = description.name;
  survey.file = description.name;  // its name in messages
  survey.grid.x_axis_left = description.x_axis_left;
  survey.tunnel = tunnel_from(description, survey.grid);
  survey.tag_template = detail::template_from(description.plate);
  survey.code = code_from(description.code);
  survey.states_sigma = description.sigma.has_value();
  survey.sigma = description.sigma.value_or(detail::kUsualSigma);
  survey.states_angle_sigma = description.angle_sigma.has_value();
  survey.angle_sigma = description.angle_sigma.value_or(detail::kUsualAngleSigma);
  check_number("sigma", survey.sigma, 0, 100);
  check_number("angle_sigma", survey.angle_sigma, 0, 1);
  const std::vector<detail::SourcedTag> tags = place_all(survey, description.tags);
  check_tags(survey, tags);
  for (const detail::SourcedTag& one : tags) survey.tags.push_back(one.tag);
  return survey;
}

}  // namespace

Survey::Survey(const SurveyDescription& description)
    : data_(std::make_shared<const Data>(survey_from(description))) {}

const std::string& Survey::name() const { return data_->survey.name; }
const PlateTemplate& Survey::plate() const { return data_->plate; }
const std::vector<SurveyTag>& Survey::tags() const { return data_->tags; }

std::optional<SurveyTag> Survey::find(std::string_view name_or_digits) const {
  const detail::Survey& survey = data_->survey;
  const detail::PlacedTag* tag = find_tag(survey, name_or_digits);
  const auto digits = detail::parse_digits(name_or_digits);
  if (tag == nullptr && digits) tag = find_tag(survey, *digits);
  if (tag == nullptr) return std::nullopt;
  return data_->tags[static_cast<std::size_t>(tag - survey.tags.data())];
}

}  // namespace tagsmith
