// SPDX-License-Identifier: Apache-2.0
// The library in one program: which tags of a survey does a photo show?
//   read_tag surveys/corridor/survey.yaml surveys/corridor/photos/corridor_01_left.jpg
#include <iostream>

#include <tagsmith/files.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: read_tag SURVEY IMAGE\n";
    return 2;
  }
  const tagsmith::Survey survey = tagsmith::load_survey(argv[1]);
  const tagsmith::Image image = tagsmith::load_image(argv[2]);

  for (const tagsmith::Tag& tag : tagsmith::read(image.view()).tags) {
    const auto known = survey.find(tag.digits);
    std::cout << tag.digits << " is " << (known ? known->name : "not in the survey");
    if (known) {
      const auto& [x, y, z] = known->corner_p;
      std::cout << ", corner P at " << x << " " << y << " " << z << " m";
    }
    std::cout << "\n";
  }
} catch (const tagsmith::Error& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
