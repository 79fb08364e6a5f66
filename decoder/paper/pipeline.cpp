// SPDX-License-Identifier: Apache-2.0
#include "decoder/paper/pipeline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/transform.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

using Histogram = std::array<std::int64_t, 256>;

Histogram histogram_of(const GrayView& image) {
  Histogram counts{};
  for (int y = 0; y < image.height; ++y) {
    for (const std::uint8_t sample : std::span(image.row(y), static_cast<std::size_t>(image.width)))
      ++counts[sample];
  }
  return counts;
}

GrayImage binarize(const GrayView& image, int threshold) {
  GrayImage binary{image.width, image.height, {}};
  binary.samples.reserve(static_cast<std::size_t>(image.width) *
                         static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    for (const std::uint8_t sample : std::span(image.row(y), static_cast<std::size_t>(image.width)))
      binary.samples.push_back(sample >= threshold ? 1 : 0);
  }
  return binary;
}

PaperOutline outline_of(const std::vector<cv::Point>& contour) {
  PaperOutline outline;
  outline.area = cv::contourArea(contour);
  outline.points.reserve(contour.size());
  for (const cv::Point& point : contour) outline.points.push_back({point.x, point.y});
  return outline;
}

// RETR_CCOMP gives the outer boundary of every white region, also of one inside another's hole, and
// marks the boundaries of holes by a parent.
std::vector<PaperOutline> outlines_of_regions(const cv::Mat& opened) {
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(opened, contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  constexpr int kParent = 3;
  std::vector<PaperOutline> outlines;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (hierarchy[i][kParent] < 0) outlines.push_back(outline_of(contours[i]));
  }
  std::ranges::stable_sort(outlines, std::ranges::greater{}, &PaperOutline::area);
  return outlines;
}

PixelPoint point_of(const PixelIndex& index) {
  return {static_cast<double>(index.x), static_cast<double>(index.y)};
}

// (4) in the paper's count of pixels, whose first column has X = 1.
double steepness_from(const PixelIndex& p, const PixelIndex& point) {
  return static_cast<double>(point.y - p.y) / (point.x + 1);
}

// P', F', lower right, Q'.
FrameCorners corners_of(const PaperOutline& outline) {
  const auto& points = outline.points;
  const auto sum = [](const PixelIndex& point) { return point.x + point.y; };
  const auto difference = [](const PixelIndex& point) { return point.x - point.y; };
  const PixelIndex p = *std::ranges::min_element(points, {}, sum);  // (3)
  const auto steepness = [&](const PixelIndex& point) { return steepness_from(p, point); };
  const PixelIndex q = *std::ranges::max_element(points, {}, steepness);  // (4)
  return {point_of(p), point_of(*std::ranges::max_element(points, {}, difference)),
          point_of(*std::ranges::max_element(points, {}, sum)), point_of(q)};
}

// The outline's leftmost and rightmost column in each of its rows.
std::map<int, std::pair<int, int>> rows_of(const PaperOutline& outline) {
  std::map<int, std::pair<int, int>> rows;
  for (const PixelIndex& point : outline.points) {
    auto& [left, right] = rows.try_emplace(point.y, point.x, point.x).first->second;
    left = std::min(left, point.x);
    right = std::max(right, point.x);
  }
  return rows;
}

// Element widths in pixels between the columns s and r of a row, both excluded: the distances
// between neighbouring boundaries of black and white.
std::vector<int> elements_of_row(const std::uint8_t* row, int s, int r) {
  std::vector<int> widths;
  int last_boundary = -1;
  for (int x = s + 1; x + 1 < r; ++x) {
    if (row[x] == row[x + 1]) continue;
    if (last_boundary >= 0) widths.push_back(x - last_boundary);
    last_boundary = x;
  }
  return widths;
}

std::optional<std::uint8_t> digit_of(std::span<const int, kElementsPerDigit> elements) {
  for (std::size_t digit = 0; digit < kDigitElements.size(); ++digit) {
    if (std::ranges::equal(elements, kDigitElements[digit]))
      return static_cast<std::uint8_t>(digit);
  }
  return std::nullopt;
}

// (5) and Table 1.
std::optional<Digits> decode_row(const std::vector<int>& widths, double module_px) {
  std::array<int, kElementCount> modules{};
  for (std::size_t u = 0; u < modules.size(); ++u) {
    modules[u] = static_cast<int>(std::lround(widths[u] / module_px));
  }
  Digits digits{};
  for (int i = 0; i < kDigitCount; ++i) {
    const auto first = static_cast<std::size_t>(first_element_of_digit(i));
    const auto digit = digit_of(std::span(modules).subspan(first).first<kElementsPerDigit>());
    if (!digit) return std::nullopt;
    digits[static_cast<std::size_t>(i)] = *digit;
  }
  return digits;
}

struct RowVotes {
  int rows = 0;
  double module_px_sum = 0;
};

struct Scan {
  int rows = 0;
  int rows_with_59_elements = 0;
  int rows_decoded = 0;
  std::map<Digits, RowVotes> votes;
};

Scan scan_rows(const GrayView& binary, const PaperOutline& outline) {
  Scan scan;
  for (const auto& [y, ends] : rows_of(outline)) {
    ++scan.rows;
    const std::vector<int> widths = elements_of_row(binary.row(y), ends.first, ends.second);
    if (widths.size() != kElementCount) continue;
    ++scan.rows_with_59_elements;
    double total = 0;  // S_B
    for (const int width : widths) total += width;
    const double module_px = total / kModuleCount;
    const std::optional<Digits> digits = decode_row(widths, module_px);
    if (!digits) continue;
    ++scan.rows_decoded;
    RowVotes& votes = scan.votes[*digits];
    ++votes.rows;
    votes.module_px_sum += module_px;
  }
  return scan;
}

tl::unexpected<PaperFailure> fail_at(PaperStep step, std::string message,
                                     std::optional<FrameCorners> corners = std::nullopt) {
  return tl::unexpected(PaperFailure{step, std::move(message), corners});
}

PaperReading reading_of(const Digits& digits, const RowVotes& votes, const Scan& scan,
                        const FrameCorners& corners) {
  PaperReading reading;
  reading.digits = digits;
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, digits);
  reading.p = corners[0];
  reading.upper_right = corners[1];
  reading.lower_right = corners[2];
  reading.q = corners[3];
  reading.module_px = votes.module_px_sum / votes.rows;
  reading.rows_with_59_elements = scan.rows_with_59_elements;
  reading.rows_decoded = scan.rows_decoded;
  reading.rows_agreeing = votes.rows;
  return reading;
}

// Why a reading is not returned; nothing when it is.
std::optional<RejectionReason> refusal(const PaperReading& reading, const ReadOptions& options) {
  const bool check_holds = options.check == CheckDigit::sum10 ? reading.sum10_holds
                           : options.check == CheckDigit::gs1
                               ? reading.gs1_holds
                               : reading.sum10_holds || reading.gs1_holds;
  if (!check_holds) return RejectionReason::check_digit;
  const auto& book = options.code_book;
  if (!book.empty() && std::ranges::find(book, reading.digits) == book.end())
    return RejectionReason::not_in_survey;
  return std::nullopt;
}

}  // namespace

int otsu_threshold(const GrayView& image) {
  const Histogram counts = histogram_of(image);
  double total = 0;
  double total_sum = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    total += static_cast<double>(counts[value]);
    total_sum += static_cast<double>(value) * static_cast<double>(counts[value]);
  }
  int best = 0;
  double greatest = 0;
  double black = 0;  // samples < t
  double black_sum = 0;
  for (int t = 1; t < 256; ++t) {
    const auto below = static_cast<std::size_t>(t - 1);
    black += static_cast<double>(counts[below]);
    black_sum += static_cast<double>(below) * static_cast<double>(counts[below]);
    const double white = total - black;
    if (black == 0 || white == 0) continue;
    // (1) and (2) with n_b + n_w = 1 reduce to n_b n_w (mu_b - mu_w)^2.
    const double difference = black_sum / black - (total_sum - black_sum) / white;
    const double variance = black * white * difference * difference;
    if (variance > greatest) {
      greatest = variance;
      best = t;
    }
  }
  return best;
}

PaperSegmentation segment_paper(const GrayView& image) {
  PaperSegmentation segmentation;
  if (image.width <= 0 || image.height <= 0) return segmentation;
  segmentation.threshold = otsu_threshold(image);
  segmentation.binary = binarize(image, segmentation.threshold);
  GrayImage& binary = segmentation.binary;
  const cv::Mat i2(binary.height, binary.width, CV_8U, binary.samples.data());
  cv::Mat i3;
  cv::morphologyEx(i2, i3, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U));
  segmentation.outlines = outlines_of_regions(i3);
  return segmentation;
}

std::string to_string(PaperStep step) {
  constexpr std::array kNames{"locate the feature frame", "scan the rows", "agree on the digits"};
  static_assert(kNames.size() == static_cast<std::size_t>(PaperStep::vote) + 1);
  return kNames[static_cast<std::size_t>(step)];
}

tl::expected<PaperReading, PaperFailure> read_paper(const PaperSegmentation& segmentation) {
  if (segmentation.outlines.size() < 2) {
    return fail_at(PaperStep::locate_frame,
                   fmt::format("{} white regions in the image, expected at least 2: the plate and "
                               "the inside of its feature frame",
                               segmentation.outlines.size()));
  }
  const PaperOutline& frame = segmentation.outlines[1];
  const FrameCorners corners = corners_of(frame);
  const Scan scan = scan_rows(segmentation.binary.view(), frame);
  if (scan.votes.empty()) {
    return fail_at(
        PaperStep::scan_rows,
        fmt::format("{} rows inside the second largest white outline, {} of them with 59 "
                    "elements, none with twelve digits of the table",
                    scan.rows, scan.rows_with_59_elements),
        corners);
  }
  const auto rows = [](const auto& vote) { return vote.second.rows; };
  const auto most = std::ranges::max_element(scan.votes, {}, rows);
  const auto draws = std::ranges::count(scan.votes, most->second.rows, rows);
  if (draws > 1) {
    return fail_at(
        PaperStep::vote,
        fmt::format("{} rows decoded, {} numbers found equally often", scan.rows_decoded, draws),
        corners);
  }
  return reading_of(most->first, most->second, scan, corners);
}

ReadResult read_tags_paper(const GrayView& image, const ReadOptions& options) {
  if (options.white_on_black && !image.is_negative) {
    return read_tags_paper(exchange_black_and_white(image).view(), options);
  }
  const auto reading = read_paper(segment_paper(image));
  ReadResult result;
  if (!reading) {
    const PaperFailure& failure = reading.error();
    Rejection rejection{RejectionReason::paper_step, failure.corners.value_or(FrameCorners{})};
    rejection.step = to_string(failure.step) + ": " + failure.message;
    result.rejected.push_back(std::move(rejection));
    return result;
  }
  const FrameCorners corners{reading->p, reading->upper_right, reading->lower_right, reading->q};
  if (const auto reason = refusal(*reading, options)) {
    result.rejected.push_back({*reason, corners});
    return result;
  }
  result.tags.push_back({reading->digits, reading->sum10_holds, reading->gs1_holds, corners,
                         reading->module_px,
                         static_cast<double>(reading->rows_agreeing) / reading->rows_decoded,
                         ReadingMethod::paper, CornerCovariance::Zero()});
  return result;
}

}  // namespace tagsmith::detail
