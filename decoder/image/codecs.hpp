// SPDX-License-Identifier: Apache-2.0
// OpenCV's codecs, loaded when the first picture needs them. Their library loads some 100 others
// (GDAL, DICOM and similar ones), whose start takes as long as fifteen photos; photos are JPEG,
// which decode_jpeg() reads without it. Why: docs/decisions/0017-third-party-libraries.md.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace cv {
class Mat;
class _InputArray;
}  // namespace cv

namespace tagsmith::detail {

// Functions of opencv2/imgcodecs.hpp, whose flags and parameters they take; they throw
// cv::Exception.
struct Codecs {
  cv::Mat (*decode)(const cv::_InputArray& bytes, int flags) = nullptr;  // cv::imdecode
  bool (*encode)(const std::string& extension, const cv::_InputArray& image,
                 std::vector<unsigned char>& bytes,
                 const std::vector<int>& parameters) = nullptr;  // cv::imencode
};

// Loads them once, whichever threads ask. Fails when the module tagsmith_codecs.so is not there.
const Result<Codecs>& codecs();

}  // namespace tagsmith::detail

// The one function of that module.
extern "C" const tagsmith::detail::Codecs* tagsmith_opencv_codecs();
