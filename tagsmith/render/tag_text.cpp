// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/tag_text.hpp"

#include <cmath>

#include <fmt/format.h>

namespace tagsmith::detail {
namespace {

std::string with_revision(const std::string& name, const std::string& revision) {
  return revision.empty() ? name : name + " revision " + revision;
}

}  // namespace

std::string to_millimetre(double metres) {
  return fmt::format("{:.3f}", std::round(metres * 1000) / 1000 + 0.0);
}

std::string grouped_digits(const PositionCode& code, const Digits& digits) {
  std::string text = to_string(digits);
  std::size_t end = 0;
  for (const int count : code.digit_counts) {
    end += static_cast<std::size_t>(count);
    text.insert(end, " ");
    ++end;
  }
  return text;
}

TagText tag_text(const Survey& survey, const PlacedTag& tag, const std::string& revision) {
  const Eigen::Vector3d& p = tag.p_in_grid;
  return {{tag.name + " " + to_string(tag.side) + "  \u00b7  " +
               grouped_digits(survey.code, tag.digits),
           "chainage " + to_millimetre(tag.chainage) + " m  \u00b7  x " + to_millimetre(p.x()) +
               "  y " + to_millimetre(p.y()) + "  z " + to_millimetre(p.z()) + " m",
           with_revision(survey.name, revision)}};
}

PageNotes page_notes(const Survey& survey, const PlacedTag& tag, const std::string& revision) {
  PageNotes notes{survey.name + " " + tag.name,
                  "template " + survey.tag_template.name + ", digits " +
                      grouped_digits(survey.code, tag.digits) + " (" +
                      to_string(survey.code.check) + ")",
                  survey_keywords(survey, revision)};
  if (!survey.tag_template.material.empty()) notes.more.push_back(survey.tag_template.material);
  return notes;
}

std::string survey_keywords(const Survey& survey, const std::string& revision) {
  return "survey " + with_revision(survey.name, revision);
}

}  // namespace tagsmith::detail
