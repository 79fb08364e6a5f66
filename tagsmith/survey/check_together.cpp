// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/check_together.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/rules.hpp"

namespace tagsmith::detail {

// ---- Exchanged codes.

namespace {

// Metres by which a carefully hung plate is off the place that was printed on it.
constexpr double kHungOff = 0.25;

struct Owner {
  const Survey* survey = nullptr;
  const PlacedTag* tag = nullptr;
};

// Tags in cubes, to find the nearest within a cube's edge.
class TagsByCube {
 public:
  explicit TagsByCube(double edge) : edge_(edge) {}

  void add(const Owner& owner) { cubes_[cube_of(owner.tag->p_in_grid)].push_back(owner); }

  std::optional<Owner> nearest(const Eigen::Vector3d& place, const PlacedTag& except) const {
    std::optional<Owner> nearest;
    double least = edge_;
    const Cube middle = cube_of(place);
    for (int i = 0; i < 27; ++i) {
      const Cube cube{middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1};
      const auto found = cubes_.find(cube);
      if (found == cubes_.end()) continue;
      for (const Owner& owner : found->second) {
        const double distance = (owner.tag->p_in_grid - place).norm();
        if (owner.tag == &except || distance >= least) continue;
        least = distance;
        nearest = owner;
      }
    }
    return nearest;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;

  Cube cube_of(const Eigen::Vector3d& place) const {
    const auto index = [&](double x) { return static_cast<std::int64_t>(std::floor(x / edge_)); };
    return {index(place.x()), index(place.y()), index(place.z())};
  }

  double edge_;
  std::map<Cube, std::vector<Owner>> cubes_;
};

double off_code(const PlacedTag& tag, const Eigen::Vector3d& place) {
  return (place - tag.coded_in_grid).norm();
}

std::string in_words(const Eigen::Vector3d& place) {
  return "(" + format_number(place.x(), 3) + ", " + format_number(place.y(), 3) + ", " +
         format_number(place.z(), 3) + ")";
}

void log_exchanged(const PlacedTag& tag, const Owner& other, bool same_survey, FindingLog& log) {
  const std::string where =
      same_survey ? "" : fmt::format(" of {}:{}", other.survey->file.string(), other.tag->line);
  log.warning(
      {tag.line, tag.column}, std::string(kExchangedCodeRule),
      fmt::format("tag {}: its digits {} say {}, the place of tag {}{}; its own is {} m away",
                  tag.name, to_string(tag.digits), in_words(tag.coded_in_grid), other.tag->name,
                  where, format_number(off_code(tag, tag.p_in_grid), 2)),
      "check which plate hangs where: two plates, or two lines of digits, are exchanged");
}

}  // namespace

void lint_exchanged_codes(const Survey& survey, std::span<const Survey> among, FindingLog& log) {
  const Eigen::Map<const Eigen::Vector3d> resolution(survey.code.resolution.data());
  const double cell = resolution.norm();
  const double reach = cell / 2 + kHungOff;
  std::vector<const PlacedTag*> far;
  for (const PlacedTag& tag : survey.tags) {
    if (off_code(tag, tag.p_in_grid) > cell) far.push_back(&tag);
  }
  if (far.empty()) return;
  TagsByCube others(reach);
  for (const Survey& other : among) {
    if (&other == &survey && among.size() > 1) continue;
    for (const PlacedTag& tag : other.tags) others.add({&other, &tag});
  }
  for (const PlacedTag* tag : far) {
    const std::optional<Owner> other = others.nearest(tag->coded_in_grid, *tag);
    if (!other) continue;
    const double gained = off_code(*tag, tag->p_in_grid) - off_code(*tag, other->tag->p_in_grid);
    if (gained > cell) log_exchanged(*tag, *other, other->survey == &survey, log);
  }
}

// ---- Several surveys.

namespace {

std::string colours_of(const TagTemplate& tag) {
  return tag.white_on_black ? "white on black" : "black on white";
}

// A survey that was made in memory has no file.
std::string name_of(const Survey& survey) {
  return survey.file.empty() ? "survey " + survey.name : survey.file.string();
}

std::string place_of(const Survey& survey, const PlacedTag& tag) {
  return name_of(survey) + (survey.file.empty() ? "" : ":" + std::to_string(tag.line));
}

}  // namespace

Result<void> check_one_grid(const std::vector<Survey>& surveys) {
  for (const Survey& survey : surveys) {
    const Survey& front = surveys.front();
    const char* key =
        survey.grid.x_axis_left != front.grid.x_axis_left ? "grid.x_axis"
        : survey.grid.epsg != 0 && front.grid.epsg != 0 && survey.grid.epsg != front.grid.epsg
            ? "grid.crs"
            : nullptr;
    if (key == nullptr) continue;
    return fail(name_of(survey) + ": " + key + " is not that of " + name_of(front) +
                ", expected one grid for all surveys");
  }
  return {};
}

std::vector<Diagnostic> check_together(const std::vector<Survey>& surveys) {
  struct Owner {
    const Survey* survey;
    const PlacedTag* tag;
  };
  std::map<std::string, const Survey*> by_name;
  std::map<Digits, Owner> by_digits;
  std::vector<Diagnostic> diagnostics;
  for (const Survey& survey : surveys) {
    FindingLog log(survey.file.string());
    const auto [named, new_name] = by_name.emplace(survey.name, &survey);
    if (!new_name) {
      log.error({}, "duplicate-survey",
                "the survey is named " + survey.name + ", and so is " + name_of(*named->second),
                "give each survey a name of its own");
    }
    const Survey& front = surveys.front();
    if (survey.tag_template.white_on_black != front.tag_template.white_on_black) {
      log.error({}, "mixed-colours",
                "the plates are " + colours_of(survey.tag_template) + ", those of " +
                    front.file.string() + " are " + colours_of(front.tag_template),
                "read the pictures of each by itself");
    }
    for (const PlacedTag& tag : survey.tags) {
      const auto [first, is_new] = by_digits.emplace(tag.digits, Owner{&survey, &tag});
      if (is_new || first->second.survey == &survey) continue;
      const PlacedTag& other = *first->second.tag;
      log.error({tag.line, tag.column}, "code-collision",
                "tag " + tag.name + " has the code " + to_string(tag.digits) + ", and so has tag " +
                    other.name + " of " + place_of(*first->second.survey, other),
                "give the surveys different code.origin or different check digits");
    }
    if (surveys.size() > 1) lint_exchanged_codes(survey, surveys, log);
    const std::vector<Diagnostic> found = allowed_removed(log.sorted(), survey.file);
    diagnostics.insert(diagnostics.end(), found.begin(), found.end());
  }
  return diagnostics;
}

}  // namespace tagsmith::detail
