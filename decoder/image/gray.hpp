// SPDX-License-Identifier: Apache-2.0
// Grey images as plain memory, so that the reader can be called without OpenCV.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tagsmith::detail {

// A view of 8-bit grey samples, row by row; does not own them. Pixel (0, 0) is the upper left one.
struct GrayView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes from one row to the next
  bool is_negative = false;   // samples are 255 less what the camera stored (ToneCurve::of)

  const std::uint8_t* row(int y) const { return data + y * stride; }
  std::uint8_t at(int x, int y) const { return row(y)[x]; }
};

// An image that owns its samples, without padding between rows.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;
  bool is_negative = false;  // as GrayView's

  GrayView view() const { return {samples.data(), width, height, width, is_negative}; }
};

}  // namespace tagsmith::detail
