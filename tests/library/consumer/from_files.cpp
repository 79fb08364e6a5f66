// SPDX-License-Identifier: Apache-2.0
// from_files CORRIDOR OUT.pdf: reads, verifies and locates what is shipped in the folder CORRIDOR,
// and prints a tag, as OUT.png too. One line for each; ends with 2 on an error of the library.
#include <filesystem>
#include <iostream>
#include <string>

#include <tagsmith/files.hpp>
#include <tagsmith/localize.hpp>

namespace {

namespace fs = std::filesystem;

void show_reading(const tagsmith::Survey& survey, const tagsmith::Image& image) {
  tagsmith::ReadOptions options;
  options.surveys = {survey};
  for (const tagsmith::Tag& tag : tagsmith::read(image.view(), options).tags) {
    std::cout << "tag " << tag.digits << ' ' << tag.name << " of " << tag.survey << '\n';
  }
}

void show_fix(const tagsmith::Survey& survey, const tagsmith::Rig& rig, const fs::path& photos) {
  const tagsmith::Image left = tagsmith::load_image(photos / "corridor_01_left.jpg");
  const tagsmith::Image right = tagsmith::load_image(photos / "corridor_01_right.jpg");
  const tagsmith::Localizer localizer({survey}, rig);
  const tagsmith::Fix fix = localizer.locate(
      {"1", {{"left", left.view()}, {"right", right.view()}}, {}, {{"d", 0.906}}, {}});
  std::cout << "fix";
  if (fix.position) {
    for (const double coordinate : *fix.position) std::cout << ' ' << coordinate;
  }
  for (const std::string& tag : fix.tags) std::cout << ' ' << tag;
  std::cout << ' ' << fix.reason << '\n';
}

// A PNG needs the module of codecs, which the library finds beside itself.
void show_printed(const tagsmith::Survey& survey, const fs::path& png) {
  tagsmith::print_tag(survey, "000L", png);
  for (const tagsmith::Tag& tag : tagsmith::read(tagsmith::load_image(png).view()).tags) {
    std::cout << "printed " << tag.digits << '\n';
  }
}

void show_errors(const fs::path& corridor) {
  for (const fs::path& path : {corridor / "none.yaml", corridor / "rig.yaml"}) {
    try {
      tagsmith::load_survey(path);
    } catch (const tagsmith::Error& error) {
      std::cout << tagsmith::to_string(error.code()) << ": " << error.what() << '\n';
    }
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const fs::path corridor = argv[1];
  const tagsmith::Survey survey = tagsmith::load_survey(corridor / "survey.yaml");
  const fs::path photo = corridor / "photos" / "corridor_01_left.jpg";
  std::cout << "findings " << tagsmith::validate(corridor / "survey.yaml").size() << '\n';
  show_reading(survey, tagsmith::load_image(photo));
  show_fix(survey, tagsmith::load_rig(corridor / "rig.yaml"), corridor / "photos");
  tagsmith::print_tag(survey, "000L", argv[2]);
  for (const tagsmith::VerifiedFile& file : tagsmith::verify(survey, {photo, argv[2]})) {
    std::cout << (file.is_ok() ? "ok" : "WRONG");
    for (const tagsmith::VerifiedTag& tag : file.tags) std::cout << ' ' << tag.tag;
    std::cout << '\n';
  }
  show_printed(survey, fs::path(argv[2]).replace_extension(".png"));
  show_errors(corridor);
} catch (const tagsmith::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
