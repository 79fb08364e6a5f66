// SPDX-License-Identifier: Apache-2.0
// Surveys made by hand, so that the tests of rendering need no files.
#pragma once

#include <string>

#include "tagsmith/render/tag_text.hpp"

namespace tagsmith::detail::test {

inline TagTemplate small_template() {
  return {.name = "tag-400x300",
          .plate_length = 0.4,
          .plate_height = 0.3,
          .frame_inner_length = 0.343,
          .frame_inner_height = 0.168,
          .frame_stroke = 0.012};
}

inline TagTemplate large_template() {
  return {.name = "tag-800x430",
          .plate_length = 0.8,
          .plate_height = 0.43,
          .frame_inner_length = 0.665,
          .frame_inner_height = 0.325,
          .frame_stroke = 0.020};
}

// A survey without tags.
inline Survey sample_survey(const TagTemplate& tag, CheckDigit check = CheckDigit::gs1,
                            const std::string& name = "corridor") {
  Survey survey;
  survey.name = name;
  survey.tag_template = tag;
  survey.code.check = check;
  return survey;
}

inline PlacedTag sample_tag(const Survey& survey, const Eigen::Vector3d& p_in_grid,
                            const std::string& name = "000L") {
  PlacedTag tag;
  tag.name = name;
  tag.p_in_grid = p_in_grid;
  tag.digits = encode_position(survey.code, {p_in_grid.x(), p_in_grid.y(), p_in_grid.z()})->digits;
  return tag;
}

// The page that `print` lays out for one tag, but for the survey's revision.
inline Page tag_page(const Survey& survey, const PlacedTag& tag, const PageStyle& style = {}) {
  const TagDrawing drawing = draw_tag(survey.tag_template, tag.digits, tag_text(survey, tag));
  return lay_out_page(tag.name, drawing, page_notes(survey, tag), style);
}

inline Page sample_page(const TagTemplate& tag, const std::string& survey_name = "corridor") {
  const Survey survey = sample_survey(tag, CheckDigit::gs1, survey_name);
  return tag_page(survey, sample_tag(survey, {1.9, 12.34, 0.4}));
}

}  // namespace tagsmith::detail::test
