// SPDX-License-Identifier: Apache-2.0
// The shipped photos give the same digits and corners whatever compiler built the reader, and
// whether it was built to be fast or to be watched by sanitizers.
//
// readings.txt has a line for each tag: photo, digits, corners P, F, lower right, Q. After a change
// to the reader that is meant to move corners, TAGSMITH_WRITE_READINGS=1 has this test write it
// anew.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;

const fs::path kReference = "tests/same_results/readings.txt";

struct SeenTag {
  std::string name;  // photo and digits
  FrameCorners corners{};
};

std::vector<fs::path> shipped_photos() {
  std::vector<fs::path> photos;
  for (const char* folder : {"surveys/corridor/photos", "surveys/curved/photos"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".jpg") photos.push_back(entry.path());
    }
  }
  std::ranges::sort(photos);
  return photos;
}

std::vector<SeenTag> read_shipped_photos() {
  std::vector<SeenTag> tags;
  for (const fs::path& photo : shipped_photos()) {
    const auto image = load_gray_image(photo);
    REQUIRE_MESSAGE(image.has_value(), photo.string());
    for (const Reading& reading : read_tags(image->view()).tags) {
      tags.push_back({photo.string() + " " + to_string(reading.digits), reading.corners});
    }
  }
  return tags;
}

void write_reference(const std::vector<SeenTag>& tags) {
  std::ofstream file(kReference);
  for (const SeenTag& tag : tags) {
    file << tag.name;
    for (const PixelPoint& corner : tag.corners) {
      file << fmt::format(" {:.9f} {:.9f}", corner.x, corner.y);
    }
    file << "\n";
  }
}

std::vector<SeenTag> reference() {
  std::vector<SeenTag> tags;
  std::ifstream file(kReference);
  for (std::string photo, digits; file >> photo >> digits;) {
    SeenTag tag{photo + " " + digits};
    for (PixelPoint& corner : tag.corners) file >> corner.x >> corner.y;
    REQUIRE_MESSAGE(file.good(), tag.name);
    tags.push_back(tag);
  }
  return tags;
}

std::string names_of(const std::vector<SeenTag>& tags) {
  std::string names;
  for (const SeenTag& tag : tags) names += tag.name + "\n";
  return names;
}

double greatest_distance(const FrameCorners& a, const FrameCorners& b) {
  double greatest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) greatest = std::max(greatest, distance(a[i], b[i]));
  return greatest;
}

// The instructions of the program under test that match an extended regular expression, each
// followed by the function that it is in.
std::string instructions_like(const std::string& expression) {
  const ProgramOutput listed = run_shell(
      "objdump --disassemble --demangle --no-show-raw-insn \"$TAGSMITH_PROGRAM\" | "
      "sed -nE '/^[0-9a-f]+ </h; /[[:space:]](" +
      expression + ")[[:space:]]/{G;p}'");
  REQUIRE_MESSAGE(listed.exit_code == 0, listed.err);
  return listed.out;
}

}  // namespace

// Processors of different makers approximate reciprocals and their square roots differently; Eigen
// uses such instructions for the square roots of several floats at once.
TEST_CASE("no instruction of the program gives a result that the processor's maker chooses") {
  CHECK(!instructions_like("v?sqrt[ps][sd]|fsqrt").empty());
  CHECK(instructions_like("v?r(cp|sqrt)(14|28)?[ps][sdh]|frecpe|frsqrte") == "");
}

TEST_CASE("every build reads the same digits, and corners to a millionth of a pixel") {
  const std::vector<SeenTag> tags = read_shipped_photos();
  if (std::getenv("TAGSMITH_WRITE_READINGS") != nullptr) write_reference(tags);
  const std::vector<SeenTag> expected = reference();
  REQUIRE(expected.size() >= 32);
  REQUIRE(names_of(tags) == names_of(expected));
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const double moved = greatest_distance(tags[i].corners, expected[i].corners);
    CHECK_MESSAGE(moved <= 1e-6, tags[i].name << ": a corner is " << moved << " pixels off");
  }
}

}  // namespace tagsmith::detail::test
