// SPDX-License-Identifier: Apache-2.0
// Symbols without a frame: `bench_product_codes FOLDER...` reads every picture under the folders
// that has a file FILE.txt beside it (its 12 digits, or 13 with a leading 0; or nothing when none
// may be read), and prints right, wrong and unread ones and the time.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/bench/other_readers.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

struct Tally {
  int images = 0;
  int right = 0;
  int wrong = 0;
  std::vector<double> times_ms;
  std::vector<std::array<int, 2>> others;  // right, wrong; as bench::other_readers()
};

std::string expected_digits(const fs::path& image) {
  std::ifstream file(fs::path(image).replace_extension(".txt"));
  std::string text;
  file >> text;
  return text.size() == 13 && text[0] == '0' ? text.substr(1) : text;
}

void read_one(const fs::path& path, Tally& tally) {
  const Result<GrayImage> image = load_gray_image(path);
  if (!image) {
    fmt::print("{}\n", image.error().message);
    return;
  }
  const std::string expected = expected_digits(path);
  const auto start = std::chrono::steady_clock::now();
  const FramelessResult result = read_frameless(image->view());
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  ++tally.images;
  tally.times_ms.push_back(time.count());
  bool right = false;
  std::string words;
  for (const FramelessReading& reading : result.read) {
    const std::string digits = to_string(reading.digits);
    if (digits == expected) {
      right = true;
      continue;
    }
    ++tally.wrong;
    words += " WRONG " + digits;
  }
  tally.right += right;
  for (std::size_t r = 0; r < bench::other_readers().size(); ++r) {
    for (const std::string& code : bench::other_readers()[r].read(image->view())) {
      ++tally.others[r][code == expected ? 0 : 1];
    }
  }
  for (const FramelessRejection& rejection : result.rejected)
    words += " (" + describe(rejection) + ")";
  fmt::print("{:40} {:12} {}{} {:.1f} ms\n",
             path.string().substr(std::max<std::size_t>(40, path.string().size()) - 40), expected,
             right ? "right" : "-", words, time.count());
}

void read_folder(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() != ".txt" &&
        entry.path().extension() != ".json") {
      images.push_back(entry.path());
    }
  }
  std::ranges::sort(images);
  Tally tally;
  tally.others.resize(bench::other_readers().size());
  for (const fs::path& image : images) read_one(image, tally);
  if (tally.times_ms.empty()) return;
  std::ranges::sort(tally.times_ms);
  fmt::print("{}: {} images, {} right, {} wrong, median {:.1f} ms, most {:.1f} ms\n",
             folder.string(), tally.images, tally.right, tally.wrong,
             tally.times_ms[tally.times_ms.size() / 2], tally.times_ms.back());
  for (std::size_t r = 0; r < tally.others.size(); ++r) {
    fmt::print("  {}: {} right, {} wrong\n", bench::other_readers()[r].name, tally.others[r][0],
               tally.others[r][1]);
  }
}

}  // namespace
}  // namespace tagsmith::detail

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) tagsmith::detail::read_folder(argv[i]);
}
