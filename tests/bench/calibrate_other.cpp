// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibrate_other.hpp"

#ifdef TAGSMITH_BENCH_OPENCV_CALIB
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#endif

namespace tagsmith::detail::bench {

#ifdef TAGSMITH_BENCH_OPENCV_CALIB

namespace {

constexpr int kColumns = 12;  // squares
constexpr int kRows = 7;
constexpr int kBits = 8;  // cells of a square: a marker of 6 with one of white at each side

// As large as leaves a white border of half a square.
double square_of(double width, double height) {
  return std::min(width / (kColumns + 1), height / (kRows + 1));
}

cv::Mat gray_of(const GrayImage& image) {
  return cv::Mat(image.height, image.width, CV_8UC1,
                 const_cast<std::uint8_t*>(image.samples.data()));
}

// The black cells of a picture of a target as rectangles of the drawing.
TagDrawing drawing_of(const cv::Mat& cells, double width, double height) {
  const double cell = square_of(width, height) / kBits;
  const double left = (width - cells.cols * cell) / 2, top = (height - cells.rows * cell) / 2;
  TagDrawing drawing;
  drawing.plate = {0, 0, width, height};
  drawing.frame_inner = drawing.frame_outer = {width / 2, height / 2, 0, 0};
  drawing.module = cell;
  cv::Mat left_black = cells == 0;
  const auto is_black = [&](int x, int y) {
    return x < cells.cols && y < cells.rows && left_black.at<std::uint8_t>(y, x) != 0;
  };
  for (int y = 0; y < cells.rows; ++y) {
    for (int x = 0; x < cells.cols; ++x) {
      int right = x, down = y;
      while (is_black(right, y)) ++right;
      if (right == x) continue;
      const auto whole_row = [&](int row) {
        for (int i = x; i < right; ++i) {
          if (!is_black(i, row)) return false;
        }
        return true;
      };
      while (whole_row(down)) ++down;
      left_black(cv::Rect(x, y, right - x, down - y)) = 0;
      drawing.bars.push_back(
          {left + x * cell, top + y * cell, (right - x) * cell, (down - y) * cell});
    }
  }
  return drawing;
}

TagDrawing draw_chessboard(double width, double height) {
  cv::Mat cells(kRows * kBits, kColumns * kBits, CV_8UC1, 255.0);
  for (int y = 0; y < kRows; ++y) {
    for (int x = y % 2; x < kColumns; x += 2) {
      cells(cv::Rect(x * kBits, y * kBits, kBits, kBits)) = 0;
    }
  }
  return drawing_of(cells, width, height);
}

cv::Ptr<cv::aruco::CharucoBoard> charuco_board(double width, double height) {
  const double square = square_of(width, height);
  return cv::aruco::CharucoBoard::create(
      kColumns, kRows, static_cast<float>(square), static_cast<float>(square * 6 / kBits),
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
}

TagDrawing draw_charuco(double width, double height) {
  // OpenCV rounds markers to pixels: it draws many a cell, of which the middle one is taken.
  constexpr int kPixels = 21;
  cv::Mat large;
  charuco_board(width, height)
      ->draw(cv::Size(kColumns * kBits * kPixels, kRows * kBits * kPixels), large, 0, 1);
  cv::Mat cells(kRows * kBits, kColumns * kBits, CV_8UC1);
  for (int y = 0; y < cells.rows; ++y) {
    for (int x = 0; x < cells.cols; ++x) {
      cells.at<std::uint8_t>(y, x) =
          large.at<std::uint8_t>(y * kPixels + kPixels / 2, x * kPixels + kPixels / 2);
    }
  }
  return drawing_of(cells, width, height);
}

using Corners = std::vector<std::vector<cv::Point2f>>;
using Points = std::vector<std::vector<cv::Point3f>>;

std::optional<Camera> camera_of(const Points& points, const Corners& corners,
                                const GrayImage& photo) {
  if (points.size() < 3) return std::nullopt;
  cv::Mat matrix, distortion, rotations, translations;
  try {
    cv::calibrateCamera(
        points, corners, cv::Size(photo.width, photo.height), matrix, distortion, rotations,
        translations, 0,
        cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12));
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  Camera camera{photo.width, photo.height};
  camera.fx = matrix.at<double>(0, 0);
  camera.fy = matrix.at<double>(1, 1);
  camera.cx = matrix.at<double>(0, 2);
  camera.cy = matrix.at<double>(1, 2);
  for (int i = 0; i < 5; ++i) {
    camera.distortion[static_cast<std::size_t>(i)] = distortion.at<double>(i);
  }
  return camera;
}

using FindCorners = bool (*)(const cv::Mat&, const cv::Size&, std::vector<cv::Point2f>&);

bool find_by_sectors(const cv::Mat& image, const cv::Size& size,
                     std::vector<cv::Point2f>& corners) {
  return cv::findChessboardCornersSB(image, size, corners,
                                     cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY);
}

bool find_by_quads(const cv::Mat& image, const cv::Size& size, std::vector<cv::Point2f>& corners) {
  if (!cv::findChessboardCorners(image, size, corners)) return false;
  cv::cornerSubPix(image, corners, cv::Size(7, 7), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4));
  return true;
}

std::optional<Camera> by_chessboard(const std::vector<GrayImage>& photos, double width,
                                    double height, FindCorners find) {
  const cv::Size size(kColumns - 1, kRows - 1);
  std::vector<cv::Point3f> board;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      board.emplace_back(static_cast<float>(square_of(width, height) * x),
                         static_cast<float>(square_of(width, height) * y), 0.0F);
    }
  }
  Points points;
  Corners all;
  for (const GrayImage& photo : photos) {
    std::vector<cv::Point2f> corners;
    if (!find(gray_of(photo), size, corners)) continue;
    points.push_back(board);
    all.push_back(corners);
  }
  return camera_of(points, all, photos.front());
}

std::optional<Camera> by_charuco(const std::vector<GrayImage>& photos, double width,
                                 double height) {
  const auto board = charuco_board(width, height);
  Points points;
  Corners all;
  for (const GrayImage& photo : photos) {
    const cv::Mat image = gray_of(photo);
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> ids;
    cv::aruco::detectMarkers(image, board->dictionary, markers, ids);
    if (ids.empty()) continue;
    std::vector<cv::Point2f> corners;
    std::vector<int> corner_ids;
    cv::aruco::interpolateCornersCharuco(markers, ids, image, board, corners, corner_ids);
    if (corners.size() < 8) continue;
    points.emplace_back();
    for (const int id : corner_ids) {
      points.back().push_back(board->chessboardCorners[static_cast<std::size_t>(id)]);
    }
    all.push_back(corners);
  }
  return camera_of(points, all, photos.front());
}

}  // namespace

const std::vector<OtherTarget>& other_targets() {
  static const std::vector<OtherTarget> targets{
      {"chessboard, SB", draw_chessboard,
       [](const std::vector<GrayImage>& photos, double width, double height) {
         return by_chessboard(photos, width, height, find_by_sectors);
       }},
      {"chessboard, cornerSubPix", draw_chessboard,
       [](const std::vector<GrayImage>& photos, double width, double height) {
         return by_chessboard(photos, width, height, find_by_quads);
       }},
      {"ChArUco", draw_charuco, by_charuco}};
  return targets;
}

#else

const std::vector<OtherTarget>& other_targets() {
  static const std::vector<OtherTarget> none;
  return none;
}

#endif

}  // namespace tagsmith::detail::bench
