// SPDX-License-Identifier: Apache-2.0
// Running `localize` and reading what it wrote.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"

namespace tagsmith::detail::test {

// The command line on a shipped survey and its rig.
inline std::string on_survey(const std::string& name, const std::string& run) {
  const std::string folder = "surveys/" + name;
  return "localize " + folder + "/survey.yaml --rig " + folder + "/rig.yaml --run " + run;
}

// Writes the file and returns its path.
inline std::string file_with(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
  return path.string();
}

// A copy of a photo with other noise: one pixel is another grey level.
inline std::string with_other_noise(const std::filesystem::path& folder, const std::string& photo) {
  auto image = load_gray_image(photo);
  REQUIRE(image.has_value());
  image->samples.front() ^= 1U;
  const std::filesystem::path copy =
      folder / (std::filesystem::path(photo).stem().string() + "-later.png");
  REQUIRE(save_gray_image(copy, image->view(), 95).has_value());
  return copy.string();
}

inline std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

}  // namespace tagsmith::detail::test
