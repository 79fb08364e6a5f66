// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/sharpening.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/tone_curve.hpp"

namespace tagsmith::detail {
namespace {

constexpr Quad kInner{{{60, 60}, {240, 60}, {240, 148}, {60, 148}}};
constexpr double kStroke = 6.3;

// How far a point is inside a rectangle of so many pixels beyond the inner edge, negative outside.
double inside(double x, double y, double beyond) {
  return std::min(std::min(x - (kInner[0].x - beyond), kInner[2].x + beyond - x),
                  std::min(y - (kInner[0].y - beyond), kInner[2].y + beyond - y));
}

// A frame on a white plate, its edges blurred in light.
cv::Mat frame_picture() {
  constexpr double kBlur = 0.7, kWhite = 0.5, kBlack = 0.04;
  const auto step = [](double depth) { return 0.5 * std::erfc(-depth / (kBlur * std::sqrt(2.0))); };
  cv::Mat levels(208, 300, CV_32F);
  for (int y = 0; y < levels.rows; ++y) {
    for (int x = 0; x < levels.cols; ++x) {
      const double ink = step(inside(x, y, kStroke)) - step(inside(x, y, 0));
      levels.at<float>(y, x) =
          static_cast<float>(ToneCurve::srgb().sample_of(kWhite + (kBlack - kWhite) * ink));
    }
  }
  return levels;
}

GrayImage stored(const cv::Mat& levels) {
  cv::Mat whole;
  levels.convertTo(whole, CV_8U);
  return {whole.cols, whole.rows, {whole.datastart, whole.dataend}};
}

cv::Mat sharpened(const cv::Mat& levels, double amount, double sigma_px) {
  cv::Mat smooth;
  cv::GaussianBlur(levels, smooth, {}, sigma_px);
  return levels * (1 + amount) - smooth * amount;
}

RefinedFrame fitted(const GrayImage& image) {
  const auto frame = refine_frame(image.view(), kInner);
  REQUIRE(frame);
  return *frame;
}

TEST_CASE("The sides of a frame tell amount and width of an unsharp mask") {
  for (const double sigma : {1.2, 1.6}) {
    for (const double amount : {0.8, 1.6}) {
      CAPTURE(sigma);
      CAPTURE(amount);
      const GrayImage image = stored(sharpened(frame_picture(), amount, sigma));
      const auto told = sharpening_of(image.view(), fitted(image));
      REQUIRE(told);
      CHECK(std::abs(told->amount / amount - 1) < 0.1);
      CHECK(std::abs(told->sigma_px / sigma - 1) < 0.1);
    }
  }
}

TEST_CASE("Plain and noisy frames show no sharpening") {
  CHECK(!sharpening_of(stored(frame_picture()).view(), fitted(stored(frame_picture()))));
  cv::Mat noisy = frame_picture();
  cv::Mat noise(noisy.size(), CV_32F);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::NORMAL, 0, 4);
  const GrayImage image = stored(noisy + noise);
  CHECK(!sharpening_of(image.view(), fitted(image)));
}

TEST_CASE("Undone, sharpening leaves the picture as it was, and nothing is touched elsewhere") {
  const GrayImage before = stored(frame_picture());
  const GrayImage sharp = stored(sharpened(frame_picture(), 1.2, 1.6));
  UnsharpenedImage image(sharp.view());
  image.undo({1.2, 1.6, 50, 190}, kInner);
  int most = 0;
  for (std::size_t i = 0; i < before.samples.size(); ++i) {
    most = std::max(most, std::abs(image.view().data[i] - before.samples[i]));
  }
  CHECK(most <= 3);
  UnsharpenedImage elsewhere(sharp.view());
  elsewhere.undo({1.2, 1.6, 50, 190}, Quad{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}});
  CHECK(std::equal(sharp.samples.begin() + 100 * 300, sharp.samples.end(),
                   elsewhere.view().data + 100 * 300));
  elsewhere.restore(Quad{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}});
  CHECK(std::equal(sharp.samples.begin(), sharp.samples.end(), elsewhere.view().data));
  image.restore(kInner);  // with samples that are clipped, or nearly
  CHECK(std::equal(sharp.samples.begin(), sharp.samples.end(), image.view().data));
}

TEST_CASE("A broad mask is undone as exactly as a narrow one") {
  const GrayImage before = stored(frame_picture());
  for (const double sigma : {0.8, 3.0}) {
    CAPTURE(sigma);
    const GrayImage sharp = stored(sharpened(frame_picture(), 0.8, sigma));
    UnsharpenedImage image(sharp.view());
    image.undo({0.8, sigma, 50, 190}, kInner);
    int most = 0;
    for (std::size_t i = 0; i < before.samples.size(); ++i) {
      most = std::max(most, std::abs(image.view().data[i] - before.samples[i]));
    }
    CHECK(most <= 3);
  }
}

TEST_CASE("What was clipped is taken for black, not for the grey that clipping left") {
  cv::Mat dark = frame_picture() - 45;
  cv::Mat sharp = sharpened(dark, 1.6, 2.0);
  const GrayImage before = stored(dark), clipped = stored(sharp);
  REQUIRE(std::ranges::count(clipped.samples, 0) > 500);
  UnsharpenedImage by_black(clipped.view()), without(clipped.view());
  by_black.undo({1.6, 2.0, 12, 145}, kInner);
  without.undo({1.6, 2.0, 255, 0}, kInner);
  const auto off = [&](const UnsharpenedImage& image) {
    double sum = 0;
    for (std::size_t i = 0; i < before.samples.size(); ++i) {
      sum += std::abs(image.view().data[i] - before.samples[i]);
    }
    return sum;
  };
  CHECK(off(by_black) < 0.8 * off(without));
}

TEST_CASE("The more undoing moves the corners, the less certain is where each side is as a whole") {
  RefinedFrame frame;
  frame.corners = kInner;
  const auto added_by = [&](double moved_px) {
    RefinedFrame doubtful = frame;
    for (PixelPoint& corner : doubtful.corners) corner.y += moved_px;
    add_halo_doubt(kInner, doubtful);
    for (const FrameSide& side : doubtful.sides) {
      CHECK(side.covariance == doubtful.sides[0].covariance);
    }
    return doubtful.sides[0].covariance;
  };
  const Eigen::Matrix2d one = added_by(1), two = added_by(2);
  CHECK(added_by(0) == Eigen::Matrix2d::Zero());
  CHECK(one(0, 0) > 0);
  CHECK(one(0, 1) == one(0, 0));  // both ends by the same
  CHECK(one(1, 1) == one(0, 0));
  CHECK((two - 4 * one).norm() < 1e-12);
}

}  // namespace
}  // namespace tagsmith::detail
