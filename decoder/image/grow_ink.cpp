// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/grow_ink.hpp"

#include <cstdlib>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace tagsmith::detail {

GrayImage grow_ink(const GrayView& image, int pixels) {
  GrayImage result{image.width, image.height, {}, image.is_negative};
  result.samples.resize(static_cast<std::size_t>(image.width) *
                        static_cast<std::size_t>(image.height));
  const cv::Mat source(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                       static_cast<std::size_t>(image.stride));
  cv::Mat target(image.height, image.width, CV_8U, result.samples.data());
  const int side = std::abs(pixels) + 1;
  const cv::Mat square = cv::Mat::ones(side, side, CV_8U);
  if (pixels >= 0) {
    cv::erode(source, target, square);
  } else {
    cv::dilate(source, target, square);
  }
  return result;
}

}  // namespace tagsmith::detail
