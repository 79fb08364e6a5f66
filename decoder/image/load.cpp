// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/load.hpp"

#include <cstring>
#include <new>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/codecs.hpp"
#include "decoder/image/exif.hpp"
#include "decoder/image/heif.hpp"
#include "decoder/image/image_header.hpp"
#include "decoder/image/png_chunks.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 512U << 20U;

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

// Refuses files that would not decode to a usable picture before the decoder allocates memory for
// them.
Result<void> check_header(const std::string& bytes) {
  const std::optional<ImageHeader> header = read_image_header(bytes);
  if (!header) {
    return fail(
        "is no image this program can read, expected JPEG, HEIC, PNG, WebP, TIFF, PNM or BMP");
  }
  const double pixels = static_cast<double>(header->width) * header->height;
  if (pixels > kMaxImagePixels) {
    return fail("says it has " + std::to_string(header->width) + " x " +
                std::to_string(header->height) + " pixels, expected at most " +
                format_number(kMaxImagePixels / 1e6) + " million");
  }
  if (!header->complete) return fail("is cut short: its end is missing");
  if (header->has_more) {
    return fail(
        "has several pages, and only single pictures are read: save each page as its own "
        "file");
  }
  return {};
}

// Every other format, and JPEG of four components.
Result<GrayImage> decode_by_opencv(const std::string& bytes) {
  const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U,
                        const_cast<char*>(bytes.data()));  // cv::Mat has no view of const data
  const Result<Codecs>& by = codecs();
  if (!by) return fail("cannot be decoded: " + by.error().message);
  try {
    constexpr int kFlags =
        cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
    const cv::Mat image = by->decode(encoded, kFlags);
    if (image.empty()) return fail("cannot be decoded: it is damaged or cut short");
    if (image.depth() != CV_8U && image.depth() != CV_16U) {
      return fail("has samples that are neither 8 nor 16 bits deep");
    }
    return copy_of(to_gray_8bit(image));
  } catch (const cv::Exception&) {
    return fail("cannot be decoded: it is damaged or cut short");
  }
}

DecodedImage undamaged(GrayImage image) { return {std::move(image), ""}; }

GrayImage image_of(DecodedImage decoded) { return std::move(decoded.image); }

Result<DecodedImage> decode(const std::string& bytes) {
  if (is_heif(bytes)) {
    Result<GrayImage> image = decode_heif(bytes, kMaxImagePixels);
    if (!image) return fail("cannot be decoded: " + image.error().message);
    return undamaged(std::move(*image));
  }
  if (auto checked = check_header(bytes); !checked) return fail(checked);
  if (bytes.starts_with("\xFF\xD8\xFF")) {
    Result<std::optional<DecodedImage>> jpeg = decode_jpeg(bytes, kMaxImagePixels);
    if (!jpeg) {
      return fail("cannot be decoded, it is damaged or cut short: " + jpeg.error().message);
    }
    if (*jpeg) return std::move(**jpeg);
  }
  if (is_png(bytes)) {
    const Result<std::string> pixels = png_of_pixels(bytes);
    if (!pixels) {
      return fail("cannot be decoded, it is damaged or cut short: " + pixels.error().message);
    }
    return decode_by_opencv(*pixels).map(undamaged);
  }
  return decode_by_opencv(without_orientation(bytes)).map(undamaged);
}

}  // namespace

Result<DecodedImage> load_image(const std::filesystem::path& path) {
  return read_regular_file(path, kMaxFileBytes).and_then([&](const std::string& bytes) {
    return decode_image(path.string(), bytes);
  });
}

Result<GrayImage> load_gray_image(const std::filesystem::path& path) {
  return load_image(path).map(image_of);
}

Result<DecodedImage> decode_image(const std::string& name, const std::string& bytes) {
  if (bytes.empty()) return fail(name + ": is empty, expected an image");
  if (is_video(bytes)) {
    return fail(name + ": is a video, expected pictures; " + kFramesOfVideo);
  }
  try {
    Result<DecodedImage> image = decode(bytes);
    if (!image) return fail(name + ": " + image.error().message);
    return image;
  } catch (const std::bad_alloc&) {
    return fail(name + ": is too large for the memory there is");
  }
}

Result<GrayImage> decode_gray_image(const std::string& name, const std::string& bytes) {
  return decode_image(name, bytes).map(image_of);
}

Result<std::string> encode_gray_image(const std::filesystem::path& name, const GrayView& image,
                                      int jpeg_quality) {
  if (image.width <= 0 || image.height <= 0) return fail(name.string() + ": an image of no size");
  const cv::Mat mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                    static_cast<std::size_t>(image.stride));
  std::vector<std::uint8_t> encoded;
  const Result<Codecs>& by = codecs();
  if (!by) return fail(name.string() + ": cannot be encoded: " + by.error().message);
  try {
    const std::vector<int> parameters{cv::IMWRITE_JPEG_QUALITY, jpeg_quality};
    if (!by->encode(name.extension().string(), mat, encoded, parameters)) {
      return fail(name.string() + ": cannot be encoded");
    }
  } catch (const cv::Exception&) {
    return fail(name.string() + ": its extension `" + name.extension().string() +
                "` is no image format this program can write, expected .png or .jpg");
  }
  return std::string(encoded.begin(), encoded.end());
}

Result<void> save_gray_image(const std::filesystem::path& path, const GrayView& image,
                             int jpeg_quality) {
  return encode_gray_image(path, image, jpeg_quality).and_then([&](const std::string& bytes) {
    return write_file(path, bytes);
  });
}

}  // namespace tagsmith::detail
