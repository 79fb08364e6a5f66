// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {

// ---- Stored pictures as they must be shown.

bool Upright::mirrors() const {
  return orientation == 2 || orientation == 4 || orientation == 5 || orientation == 7;
}

bool Upright::reverses_rows() const {
  return orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
}

bool Upright::reverses_columns() const {
  return orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
}

PixelPoint Upright::turn(PixelPoint at) const {
  const int across = transposes() ? height : width;
  const int down = transposes() ? width : height;
  if (transposes()) std::swap(at.x, at.y);
  if (reverses_rows()) at.x = across - 1 - at.x;
  if (reverses_columns()) at.y = down - 1 - at.y;
  return at;
}

GrayImage turn_upright(const GrayView& stored, int orientation) {
  const Upright upright{orientation, stored.width, stored.height};
  GrayImage shown{upright.transposes() ? stored.height : stored.width,
                  upright.transposes() ? stored.width : stored.height,
                  {}};
  shown.samples.resize(static_cast<std::size_t>(shown.width) *
                       static_cast<std::size_t>(shown.height));
  for (int y = 0; y < stored.height; ++y) {
    for (int x = 0; x < stored.width; ++x) {
      const PixelPoint at = upright.turn({static_cast<double>(x), static_cast<double>(y)});
      const auto column = static_cast<std::size_t>(std::lround(at.x));
      const auto row = static_cast<std::size_t>(std::lround(at.y));
      shown.samples[row * static_cast<std::size_t>(shown.width) + column] =
          static_cast<std::uint8_t>(stored.at(x, y));
    }
  }
  return shown;
}

// ---- Copies.

GrayImage copy_of(const GrayView& image) {
  GrayImage copy{image.width, image.height, {}, image.is_negative};
  copy.samples.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    copy.samples.insert(copy.samples.end(), image.row(y), image.row(y) + image.width);
  }
  return copy;
}

// ---- Smaller pictures.

namespace {

// Pairs of samples are taken as one 16-bit number, so that the compiler works on eight or more at a
// time; the sum of a pair does not depend on the order of its bytes.
TAGSMITH_WIDE
void halve_rows(const std::uint8_t* upper, const std::uint8_t* lower, std::uint8_t* target,
                std::size_t width) {
  for (std::size_t x = 0; x < width; ++x) {
    std::uint16_t above = 0;
    std::uint16_t below = 0;
    std::memcpy(&above, upper + 2 * x, 2);
    std::memcpy(&below, lower + 2 * x, 2);
    const auto sum = static_cast<std::uint16_t>((above & 0xFFU) + (above >> 8U) + (below & 0xFFU) +
                                                (below >> 8U) + 2U);
    target[x] = static_cast<std::uint8_t>(sum >> 2U);
  }
}

}  // namespace

GrayImage half_size(const GrayView& image) {
  GrayImage half{image.width / 2, image.height / 2, {}, image.is_negative};
  const auto width = static_cast<std::size_t>(half.width);
  half.samples.resize(width * static_cast<std::size_t>(half.height));
  for (int y = 0; y < half.height; ++y) {
    std::uint8_t* target = half.samples.data() + static_cast<std::size_t>(y) * width;
    halve_rows(image.row(2 * y), image.row(2 * y + 1), target, width);
  }
  return half;
}

GrayImage shrunk_to(const GrayView& image, int most) {
  const int longer = std::max(image.width, image.height);
  const int wanted = std::max(1, (longer + most - 1) / most);
  const int square = std::clamp(wanted, 1, std::max(1, std::min(image.width, image.height)));
  const auto width = static_cast<std::size_t>(image.width / square);
  const auto area = static_cast<std::uint32_t>(square) * static_cast<std::uint32_t>(square);
  GrayImage small{image.width / square, image.height / square, {}, image.is_negative};
  small.samples.reserve(width * static_cast<std::size_t>(small.height));
  std::vector<std::uint32_t> sums(width);
  for (int row = 0; row < small.height; ++row) {
    std::ranges::fill(sums, area / 2);
    for (int y = row * square; y < (row + 1) * square; ++y) {
      const std::uint8_t* samples = image.row(y);
      for (std::size_t x = 0; x < width; ++x) {
        for (int i = 0; i < square; ++i) sums[x] += *samples++;
      }
    }
    for (const std::uint32_t sum : sums) {
      small.samples.push_back(static_cast<std::uint8_t>(sum / area));
    }
  }
  return small;
}

// ---- Negatives and tone.

namespace {

// The image with a function of each of its samples.
template <class Function>
GrayImage mapped(const GrayView& image, bool is_negative, const Function& function) {
  const auto width = static_cast<std::size_t>(image.width);
  GrayImage result{image.width, image.height, {}, is_negative};
  result.samples.resize(width * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    std::transform(image.row(y), image.row(y) + width,
                   result.samples.data() + width * static_cast<std::size_t>(y), function);
  }
  return result;
}

}  // namespace

GrayImage exchange_black_and_white(const GrayView& image) {
  return mapped(image, !image.is_negative,
                [](std::uint8_t sample) { return static_cast<std::uint8_t>(255 - sample); });
}

GrayImage linear_as_srgb(const GrayView& image) {
  std::array<std::uint8_t, 256> samples{};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double of_light =
        image.is_negative ? 255.0 - static_cast<double>(i) : static_cast<double>(i);
    const long sample = std::lround(ToneCurve::srgb().sample_of(of_light / 255));
    samples[i] = static_cast<std::uint8_t>(image.is_negative ? 255 - sample : sample);
  }
  return mapped(image, image.is_negative, [&](std::uint8_t sample) { return samples[sample]; });
}

}  // namespace tagsmith::detail
