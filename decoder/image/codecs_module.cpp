// SPDX-License-Identifier: Apache-2.0
// The module that links OpenCV's codecs, so that the program can load them late (codecs.hpp).
#include <opencv2/imgcodecs.hpp>

#include "decoder/image/codecs.hpp"

extern "C" __attribute__((visibility("default"))) const tagsmith::detail::Codecs*
tagsmith_opencv_codecs() {
  static constexpr tagsmith::detail::Codecs kCodecs{&cv::imdecode, &cv::imencode};
  return &kCodecs;
}
