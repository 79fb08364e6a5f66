// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/annotate.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/codecs.hpp"
#include "decoder/image/exif.hpp"
#include "decoder/image/heif.hpp"
#include "decoder/image/image_header.hpp"
#include "decoder/image/jpeg.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/png_chunks.hpp"
#include "decoder/image/transform.hpp"

namespace tagsmith::detail {
namespace {

cv::Mat turned(const Upright& upright, const cv::Mat& stored) {
  cv::Mat shown = stored;
  if (upright.transposes()) cv::transpose(stored, shown);
  if (!upright.reverses_rows() && !upright.reverses_columns()) return shown;
  const int both = -1;
  const int one = upright.reverses_rows() ? 1 : 0;
  cv::Mat flipped;
  cv::flip(shown, flipped, upright.reverses_rows() && upright.reverses_columns() ? both : one);
  return flipped;
}

std::string ascii(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F) plain += c;
    if (byte >= 0xC0) plain += '?';  // the first byte of a character; the others are left out
  }
  return plain;
}

// Draws in sizes that suit the picture's.
class Annotator {
 public:
  explicit Annotator(cv::Mat canvas)
      : canvas_(std::move(canvas)),
        text_px_(std::clamp(std::max(canvas_.cols, canvas_.rows) / 70.0, 12.0, 90.0)),
        line_px_(std::max(2, static_cast<int>(text_px_ / 7))) {}

  void outline(const PictureMark& mark, const cv::Scalar& colour) {
    std::vector<cv::Point> corners;
    for (const PixelPoint& corner : mark.outline) corners.push_back(at(corner));
    cv::polylines(canvas_, corners, true, colour, line_px_, cv::LINE_AA);
    cv::circle(canvas_, corners.front(), 2 * line_px_, colour, cv::FILLED, cv::LINE_AA);
  }

  // Below the mark, above it where there is more space, clear of the labels drawn before.
  void label(const PictureMark& mark, const cv::Scalar& colour) {
    const cv::Size size = size_of(mark.words);
    std::vector<cv::Point> corners;
    for (const PixelPoint& corner : mark.outline) corners.push_back(at(corner));
    const cv::Rect box = cv::boundingRect(corners);
    const int gap = 2 * line_px_;
    const bool below = box.y + box.height + gap + size.height <= canvas_.rows ||
                       box.y < canvas_.rows - box.y - box.height;
    cv::Rect place(box.x, below ? box.y + box.height + gap : box.y - gap - size.height, size.width,
                   size.height);
    place = clear_place(place, below ? gap : -gap);
    plate(place, mark.words, colour);
  }

  void caption(const std::vector<std::string>& words) {
    const cv::Size size = size_of(words);
    plate({0, 0, size.width, size.height}, words, {30, 30, 30});
  }

 private:
  static constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  static constexpr double kFontPx = 22;  // height of a capital at scale 1

  double scale() const { return text_px_ / kFontPx; }
  int weight() const { return std::max(1, static_cast<int>(std::lround(text_px_ / 10))); }
  int row_px() const { return static_cast<int>(std::lround(1.75 * text_px_)); }

  static cv::Point at(const PixelPoint& point) {
    constexpr double kLimit = 1e5;  // far outside, and within what OpenCV's lines can be
    return {static_cast<int>(std::lround(std::clamp(point.x, -kLimit, kLimit))),
            static_cast<int>(std::lround(std::clamp(point.y, -kLimit, kLimit)))};
  }

  cv::Size size_of(const std::vector<std::string>& words) const {
    int width = 0;
    for (const std::string& line : words) {
      width =
          std::max(width, cv::getTextSize(ascii(line), kFont, scale(), weight(), nullptr).width);
    }
    return {width + row_px(), static_cast<int>(words.size()) * row_px() + row_px() / 3};
  }

  // The place within the picture, moved by steps until it covers no other label.
  cv::Rect clear_place(cv::Rect place, int step) {
    const int lowest = std::max(0, canvas_.rows - place.height);
    place.x = std::clamp(place.x, 0, std::max(0, canvas_.cols - place.width));
    place.y = std::clamp(place.y, 0, lowest);
    cv::Rect moved = place;
    const auto covered = [&](const cv::Rect& other) { return (other & moved).area() > 0; };
    while (moved.y >= 0 && moved.y <= lowest && std::ranges::any_of(taken_, covered)) {
      moved.y += step;
    }
    if (moved.y >= 0 && moved.y <= lowest) place = moved;
    taken_.push_back(place);
    return place;
  }

  void plate(const cv::Rect& place, const std::vector<std::string>& words,
             const cv::Scalar& colour) {
    cv::rectangle(canvas_, place, colour, cv::FILLED);
    int baseline = place.y + static_cast<int>(std::lround(1.45 * text_px_));
    for (const std::string& line : words) {
      cv::putText(canvas_, ascii(line), {place.x + row_px() / 2, baseline}, kFont, scale(),
                  {255, 255, 255}, weight(), cv::LINE_AA);
      baseline += row_px();
    }
  }

  cv::Mat canvas_;
  double text_px_;
  int line_px_;
  std::vector<cv::Rect> taken_;
};

cv::Mat annotated(const cv::Mat& stored, int orientation, const std::vector<PictureMark>& marks,
                  const std::vector<std::string>& caption) {
  const Upright upright{orientation, stored.cols, stored.rows};
  cv::Mat canvas = turned(upright, stored);
  Annotator annotator(canvas);
  std::vector<PictureMark> shown = marks;
  for (PictureMark& mark : shown) {
    for (PixelPoint& corner : mark.outline) corner = upright.turn(corner);
  }
  const auto colour_of = [](const PictureMark& mark) {
    return cv::Scalar(mark.colour[2], mark.colour[1], mark.colour[0]);
  };
  for (const PictureMark& mark : shown) annotator.outline(mark, colour_of(mark));
  for (const PictureMark& mark : shown) {
    if (!mark.words.empty()) annotator.label(mark, colour_of(mark));
  }
  if (!caption.empty()) annotator.caption(caption);
  return canvas;
}

// The first bytes show the format.
std::string extension_for(const std::string& bytes) {
  const bool loses = bytes.starts_with("\xFF\xD8") || bytes.starts_with("RIFF") || is_heif(bytes);
  return loses ? ".jpg" : ".png";
}

// The pixels as stored, in colour; empty when they cannot be decoded. Warnings of the decoders were
// reported when the picture was read, and are not printed again.
cv::Mat decode_colour(const Codecs& by, const std::string& bytes) {
  const auto copy_of = [](ColourImage& image) {
    return cv::Mat(image.height, image.width, CV_8UC3, image.samples.data()).clone();
  };
  if (is_heif(bytes)) {
    Result<ColourImage> image = decode_heif_colour(bytes, kMaxImagePixels);
    return image ? copy_of(*image) : cv::Mat();
  }
  if (bytes.starts_with("\xFF\xD8\xFF")) {
    Result<std::optional<ColourImage>> jpeg = decode_jpeg_colour(bytes, kMaxImagePixels);
    if (!jpeg) return {};
    if (*jpeg) return copy_of(**jpeg);
  }
  const Result<std::string> png = is_png(bytes) ? png_of_pixels(bytes) : Result<std::string>("");
  if (!png) return {};
  const std::string rest = without_orientation(png->empty() ? bytes : *png);
  const cv::Mat encoded(1, static_cast<int>(rest.size()), CV_8U, const_cast<char*>(rest.data()));
  return by.decode(encoded, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

}  // namespace

Result<AnnotatedPicture> annotate_picture(const std::string& name, const std::string& bytes,
                                          const std::vector<PictureMark>& marks,
                                          const std::vector<std::string>& caption) {
  const std::optional<ImageHeader> header = read_image_header(bytes);
  const bool fits =
      header && static_cast<double>(header->width) * header->height <= kMaxImagePixels;
  if (!fits && !is_heif(bytes)) {
    return fail(name + ": is no picture that can be marked");
  }
  const Result<Codecs>& by = codecs();
  if (!by) return fail(name + ": cannot be marked: " + by.error().message);
  try {
    const cv::Mat stored = decode_colour(*by, bytes);
    if (stored.empty()) return fail(name + ": cannot be decoded to be marked");
    const cv::Mat canvas = annotated(stored, shown_orientation(bytes).value_or(1), marks, caption);
    std::vector<std::uint8_t> copy;
    AnnotatedPicture picture{extension_for(bytes), {}};
    by->encode(picture.extension, canvas, copy, {cv::IMWRITE_JPEG_QUALITY, 90});
    picture.bytes.assign(copy.begin(), copy.end());
    return picture;
  } catch (const cv::Exception&) {
    return fail(name + ": cannot be marked: it is damaged or too large to be drawn");
  } catch (const std::bad_alloc&) {
    return fail(name + ": is too large for the memory there is");
  }
}

}  // namespace tagsmith::detail
