// SPDX-License-Identifier: Apache-2.0
// The libraries behind the commands: which tags of a survey does a photo show?
//   read_tag surveys/corridor/survey.yaml surveys/corridor/photos/corridor_01_left.jpg
#include <iostream>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/survey/read_survey.hpp"

int stop(const std::string& message) {
  std::cerr << message << "\n";
  return 2;
}

int main(int argc, char** argv) {
  if (argc != 3) return stop("usage: read_tag SURVEY IMAGE");
  const auto survey = tagsmith::detail::load_survey(argv[1]);
  if (!survey) return stop(survey.error().message);
  const auto image = tagsmith::detail::load_gray_image(argv[2]);
  if (!image) return stop(image.error().message);

  for (const tagsmith::detail::Reading& reading : tagsmith::detail::read_tags(image->view()).tags) {
    const tagsmith::detail::PlacedTag* tag = tagsmith::detail::find_tag(*survey, reading.digits);
    std::cout << tagsmith::detail::to_string(reading.digits) << " is "
              << (tag ? tag->name : "not in the survey");
    if (tag) std::cout << ", corner P at " << tag->p_in_grid.transpose() << " m";
    std::cout << "\n";
  }
}
