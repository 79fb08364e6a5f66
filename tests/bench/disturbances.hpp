// SPDX-License-Identifier: Apache-2.0
// What happens to plates, lamps, lenses and cameras underground, done to stored pictures by OpenCV
// alone: nothing here shares the reader's or the simulator's model of how a picture comes about.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

namespace tagsmith::detail::bench {

// The inner frame of the photos' plates, modules (Xu et al. 2017).
inline constexpr double kFrameLength = 113, kFrameHeight = 55.3;

// A grey picture, 8 bits, and for each of its plates what maps its pixels to modules from the upper
// left corner of the inner frame, to the right and downward.
struct Scene {
  cv::Mat picture;
  std::vector<cv::Matx33d> to_modules;
};

struct Disturbance {
  std::string_view name;
  std::string_view what;
  void (*apply)(Scene& scene, cv::RNG& draws);
};

std::span<const Disturbance> disturbances();

}  // namespace tagsmith::detail::bench
