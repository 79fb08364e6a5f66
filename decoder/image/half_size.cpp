// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/half_size.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
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

}  // namespace tagsmith::detail
