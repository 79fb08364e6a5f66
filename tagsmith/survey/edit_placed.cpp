// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_placed.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/edit_yaml.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {
namespace {

using Values = std::vector<std::pair<std::string, std::string>>;

// What rounds to zero is written without its sign.
std::string rounded(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return fmt::format("{:.{}f}", std::round(value * unit) / unit + 0.0, decimals);
}

std::string point_text(const Eigen::Vector3d& p) {
  return fmt::format("[{}, {}, {}]", rounded(p.x(), 4), rounded(p.y(), 4), rounded(p.z(), 4));
}

Values measured_values(const AsBuiltPlace& place) {
  constexpr double kLeastSigma = 1e-4;  // metres: what is written of a coordinate
  Values values{{"p", point_text(place.p_in_grid)},
                {"sigma", rounded(std::max(place.sigma, kLeastSigma), 4)}};
  if (!place.date.empty()) values.emplace_back("date", place.date);
  const Values attitude{
      {"facing", rounded(std::fmod(degrees(place.attitude.facing.value_or(0)) + 360, 360), 3)},
      {"tilt", rounded(degrees(place.attitude.tilt), 3)},
      {"roll", rounded(degrees(place.attitude.roll), 3)}};
  values.insert(values.end(), attitude.begin(), attitude.end());
  return values;
}

std::string digits_text(const PlacedTag& tag) { return '"' + to_string(tag.digits) + '"'; }

YamlItemEdit changed_entry(std::size_t item, const YamlNode& entry, const PlacedTag& tag,
                           const AsBuiltPlace& place) {
  YamlItemEdit edit{item, measured_values(place)};
  if (value_at(entry, "digits") == nullptr) edit.values.emplace_back("digits", digits_text(tag));
  const bool was_measured = value_at(entry, "date") != nullptr;
  if (!tag.design_in_grid && !was_measured) {
    edit.values.emplace_back("design", point_text(tag.p_in_grid));
  }
  return edit;
}

// The entries of `placed` by the names of their tags.
std::map<std::string, std::size_t> entries_of(const YamlNode* placed) {
  std::map<std::string, std::size_t> entries;
  for (std::size_t i = 0; placed != nullptr && i < placed->items.size(); ++i) {
    const YamlNode* name = value_at(placed->items[i], "tag");
    if (name != nullptr) entries.emplace(name->text, i);
  }
  return entries;
}

}  // namespace

std::string placed_entry(const Survey& survey, const AsBuiltPlace& place) {
  const PlacedTag& tag = *find_tag(survey, std::string_view(place.tag));
  Values values{{"tag", tag.name}, {"side", to_string(tag.side)}};
  std::ranges::move(measured_values(place), std::back_inserter(values));
  values.emplace_back("digits", digits_text(tag));
  std::vector<std::string> words;
  for (const auto& [key, value] : values) words.push_back(fmt::format("{}: {}", key, value));
  return fmt::format("{{ {} }}", fmt::join(words, ", "));
}

Result<std::string> survey_with_places(std::string_view text, const Survey& survey,
                                       const std::vector<AsBuiltPlace>& places) {
  FindingLog log("the survey");
  const std::optional<YamlNode> root = parse_yaml(text, log);
  if (!root) return fail(to_string(log.sorted(), true));
  const YamlNode* placed = value_at(*root, "placed");
  const std::map<std::string, std::size_t> entries = entries_of(placed);
  std::vector<YamlItemEdit> edits;
  std::vector<std::string> added;
  for (const AsBuiltPlace& place : places) {
    const PlacedTag& tag = *find_tag(survey, std::string_view(place.tag));
    const auto entry = entries.find(place.tag);
    if (entry == entries.end()) {
      added.push_back(placed_entry(survey, place));
    } else {
      edits.push_back(changed_entry(entry->second, placed->items[entry->second], tag, place));
    }
  }
  return edit_yaml_list(text, "placed", edits, added);
}

}  // namespace tagsmith::detail
