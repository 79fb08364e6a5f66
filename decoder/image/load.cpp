// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/load.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cstring>
#include <string>

#include "tagsmith/base/file.hpp"

namespace tagsmith {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 512U << 20U;
constexpr double kMaxPixels = 200e6;

cv::Mat to_gray_8bit(cv::Mat image) {
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 255.0 / 65535.0);
  return image;
}

GrayImage copy_of(const cv::Mat& mat) {
  GrayImage image{mat.cols, mat.rows, {}};
  const auto width = static_cast<std::size_t>(mat.cols);
  image.samples.resize(width * static_cast<std::size_t>(mat.rows));
  for (int y = 0; y < mat.rows; ++y) {
    std::memcpy(image.samples.data() + static_cast<std::size_t>(y) * width, mat.ptr(y), width);
  }
  return image;
}

}  // namespace

Result<GrayImage> load_gray_image(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_file(path, kMaxFileBytes);
  if (!bytes) return fail(bytes.error().message);
  if (bytes->empty()) return fail(path.string() + ": is empty, expected an image");
  const cv::Mat encoded(1, static_cast<int>(bytes->size()), CV_8U,
                        const_cast<char*>(bytes->data()));  // cv::Mat has no view of const data
  try {
    constexpr int kFlags =
        cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
    const cv::Mat image = cv::imdecode(encoded, kFlags);
    if (image.empty()) {
      return fail(path.string() +
                  ": is no image this program can read (expected JPEG, PNG, WebP, TIFF or PNM)");
    }
    if (static_cast<double>(image.total()) > kMaxPixels) {
      return fail(path.string() + ": has more than 200 million pixels");
    }
    if (image.depth() != CV_8U && image.depth() != CV_16U) {
      return fail(path.string() + ": has samples that are neither 8 nor 16 bits deep");
    }
    return copy_of(to_gray_8bit(image));
  } catch (const cv::Exception& error) {
    return fail(path.string() + ": cannot be decoded: " + error.err);
  }
}

Result<void> save_gray_image(const std::filesystem::path& path, const GrayView& image) {
  const cv::Mat mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                    static_cast<std::size_t>(image.stride));
  std::vector<std::uint8_t> encoded;
  try {
    const std::vector<int> parameters{cv::IMWRITE_JPEG_QUALITY, 95};
    if (!cv::imencode(path.extension().string(), mat, encoded, parameters)) {
      return fail(path.string() + ": its extension is no image format this program can write");
    }
  } catch (const cv::Exception& error) {
    return fail(path.string() + ": cannot be encoded: " + error.err);
  }
  return write_file(path, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
}

}  // namespace tagsmith
