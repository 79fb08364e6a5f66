// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/bench/campaign.hpp"
#include "tests/bench/lots.hpp"

namespace tagsmith::detail::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kCuttings = 50;  // of a photo, before the next one's

std::vector<fs::path> photos_below(const fs::path& folder) {
  constexpr std::array<const char*, 6> kEndings{".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff"};
  std::vector<fs::path> photos;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.is_regular_file() && std::ranges::count(kEndings, entry.path().extension()) > 0) {
      photos.push_back(entry.path());
    }
  }
  std::ranges::sort(photos);
  return photos;
}

// The photo loaded last by this thread, which reads several of its cuttings in a row.
const GrayImage& load(const fs::path& path) {
  thread_local fs::path loaded;
  thread_local GrayImage image;
  if (loaded != path) {
    image = load_gray_image(path).value_or(GrayImage());
    loaded = path;
  }
  return image;
}

GrayImage cutting(const GrayImage& photo, mass::Random& random) {
  const cv::Mat whole(photo.height, photo.width, CV_8U,
                      const_cast<std::uint8_t*>(photo.samples.data()));
  const int width = mass::integer(random, 200, 900);
  const int height = mass::integer(random, 200, 900);
  const double scale = mass::log_uniform(random, 0.25, 2);
  cv::Mat sized;
  cv::resize(whole, sized, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  const cv::Point2d at(mass::uniform(random, 0, sized.cols), mass::uniform(random, 0, sized.rows));
  const double turn = mass::uniform(random, 0, 2 * std::numbers::pi);
  const double c = std::cos(turn), s = std::sin(turn);
  const cv::Matx23d photo_from_cutting(c, -s, at.x - c * width / 2 + s * height / 2, s, c,
                                       at.y - s * width / 2 - c * height / 2);
  cv::Mat cut;
  cv::warpAffine(sized, cut, photo_from_cutting, {width, height},
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
  const double contrast = mass::uniform(random, 0.5, 2);
  cut.convertTo(cut, CV_8U, contrast, 128 * (1 - contrast) + mass::uniform(random, -40, 40));
  return {width, height, {cut.datastart, cut.dataend}};
}

// Half of them with a book, which lets parts of tags and smaller symbols be read.
Sums read_cutting(const std::vector<fs::path>& photos, std::uint64_t number) {
  constexpr std::size_t kBookSize = 400;
  const fs::path& path = photos[number / kCuttings % photos.size()];
  Sums sums;
  mass::Random random(number);
  const GrayImage& photo = load(path);
  if (photo.samples.empty()) {
    sums.counts["unreadable"] = 1;
    return sums;
  }
  const GrayImage image = cutting(photo, random);
  ReadOptions options;
  options.frameless = Frameless::always;
  if (random() % 2 == 0) {
    while (options.code_book.size() < kBookSize) {
      options.code_book.push_back(mass::random_code(random));
    }
  }
  const ReadResult result = read_tags(image.view(), options);
  sums.counts["shown"] = 1;
  const auto tell = [&](const char* what, const std::string& digits) {
    ++sums.counts[what];
    sums.stories.push_back(fmt::format("{} {} {} {}", what, number, path.string(), digits));
  };
  for (const Reading& tag : result.tags) tell("tags", to_string(tag.digits));
  for (const PartReading& part : result.parts) tell("parts", digits_in_sight(part));
  for (const auto& symbol : result.frameless.read) tell("frameless", to_string(symbol.digits));
  for (const Rejection& rejection : result.rejected) {
    if (rejection.reason == RejectionReason::doubtful) ++sums.counts["doubtful"];
  }
  return sums;
}

void print_photos(const Sums& sums) {
  fmt::print(
      "{:.0f} cuttings ({:.0f} of photos that could not be loaded): {:.0f} tags, {:.0f} parts of "
      "tags, {:.0f} symbols without a frame; {:.0f} refused for their doubt\n",
      sums["shown"], sums["unreadable"], sums["tags"], sums["parts"], sums["frameless"],
      sums["doubtful"]);
}

}  // namespace

Result<Series> photo_series(const fs::path& folder) {
  const std::vector<fs::path> photos = photos_below(folder);
  if (photos.empty()) return fail(folder.string() + " has no photos");
  return Series{"photos:" + folder.string(),
                [photos](std::uint64_t number) { return read_cutting(photos, number); },
                print_photos};
}

}  // namespace tagsmith::detail::bench
