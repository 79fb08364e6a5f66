// SPDX-License-Identifier: Apache-2.0
// The light that a picture's grey levels stand for, for those who sample much of it.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// The light (0-1, of the sRGB tone curve) of an image's pixels, row by row, each row made when it
// is first wanted. The image's samples must outlive it.
class SampledLight {
 public:
  explicit SampledLight(const GrayView& image);

  const GrayView& image() const { return image_; }
  int width() const { return image_.width; }
  int height() const { return image_.height; }

  // Makes the rows from `first` to `last`, as far as there are such.
  void make_rows(int first, int last);

  // A row that was made.
  const float* row(int y) const {
    return light_.get() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width);
  }

 private:
  GrayView image_;
  std::unique_ptr<float[]> light_;  // of all rows, once one was wanted
  std::vector<bool> made_;
};

}  // namespace tagsmith::detail
