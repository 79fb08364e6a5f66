// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/check_together.hpp"

#include <map>
#include <string>

#include "tagsmith/survey/allowances.hpp"
#include "tagsmith/survey/exchanged_codes.hpp"
#include "tagsmith/survey/finding_log.hpp"

namespace tagsmith::detail {
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
