// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/tag_text.hpp"

#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "tagsmith/tag/label_fields.hpp"

namespace tagsmith::detail {
namespace {

using FieldValue = std::function<std::string(std::string_view)>;

std::string with_revision(const std::string& name, const std::string& revision) {
  return revision.empty() ? name : name + " revision " + revision;
}

FieldValue field_values(const Survey& survey, const PlacedTag& tag, const std::string& revision) {
  return [&survey, &tag, revision](std::string_view field) -> std::string {
    const LabelStyle& label = survey.tag_template.label;
    if (field == "name") return tag.name;
    if (field == "side") return tag.side == Side::left ? label.left : label.right;
    if (field == "digits") return to_string(tag.digits);
    if (field == "chainage") return to_millimetre(tag.chainage);
    if (field == "survey") return survey.name;
    if (field == "revision") return revision;
    return to_millimetre(tag.p_in_grid[field == "x" ? 0 : field == "y" ? 1 : 2]);
  };
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
  std::vector<std::string> lines = survey.tag_template.label.lines;
  if (lines.empty()) {
    lines = {"{name} {side}  \u00b7  {digits}",
             "chainage {chainage} m  \u00b7  x {x}  y {y}  z {z} m",
             revision.empty() ? "{survey}" : "{survey} revision {revision}"};
  }
  const FieldValue value_of = field_values(survey, tag, revision);
  for (std::string& line : lines) {
    line = filled_in(line, [&](std::string_view field) {
      return field == "digits" ? grouped_digits(survey.code, tag.digits) : value_of(field);
    });
  }
  return {lines};
}

std::string qr_content(const Survey& survey, const PlacedTag& tag, const std::string& revision) {
  return filled_in(survey.tag_template.qr.content, field_values(survey, tag, revision));
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
