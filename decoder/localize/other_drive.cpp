// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/other_drive.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

// Photos of all measurements, at most so many, evenly spread.
std::vector<std::filesystem::path> sample_of(const std::vector<Measurement>& measurements) {
  constexpr std::size_t kMost = 12;
  return evenly_taken(photos_of(measurements), kMost);
}

bool is_code(const Digits& digits) {
  return has_check_digit(CheckDigit::gs1, digits) || has_check_digit(CheckDigit::sum10, digits);
}

}  // namespace

std::string other_drive_in_words(const std::vector<std::string>& surveys,
                                 const std::set<std::string>& codes) {
  constexpr std::size_t kLeast = 2;
  constexpr std::size_t kMostNamed = 3;
  if (codes.size() < kLeast) return {};
  std::vector<std::string> named(codes.begin(), codes.end());
  named.resize(std::min(named.size(), kMostNamed));
  return fmt::format(
      "None of the {} codes read ({}{}) is of survey {}: are these photos of another drive, or is "
      "it another survey?",
      codes.size(), fmt::join(named, ", "), codes.size() > kMostNamed ? ", ..." : "",
      fmt::join(surveys, " or "));
}

std::string other_drive_in_words(const std::vector<Measurement>& measurements,
                                 const std::vector<Survey>& surveys) {
  ReadOptions options = read_options_for(surveys);
  options.code_book.clear();
  options.check.reset();
  std::set<std::string> codes;
  for (const std::filesystem::path& photo : sample_of(measurements)) {
    const Result<GrayImage> image = load_gray_image(photo);
    if (!image) continue;
    for (const Reading& reading : read_tags(image->view(), options).tags) {
      if (!find_tags(surveys, reading.digits).empty()) return {};
      if (is_code(reading.digits)) codes.insert(to_string(reading.digits));
    }
  }
  std::vector<std::string> names;
  for (const Survey& survey : surveys) names.push_back(survey.name);
  return other_drive_in_words(names, codes);
}

}  // namespace tagsmith::detail
