// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/write_calibration.hpp"

#include <array>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <opencv2/core.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_calibration.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;

namespace {

// Numbers whose decimals do not end.
std::vector<Camera> cameras() {
  return {
      {1280, 960, 1000, 1000, 640, 480, {}},
      {1280, 960, 1000.0 / 3, 1001.0 / 7, 639.5, 1e-7, {-1.0 / 3, 0.1, 1e-5, -2e-4}},
      {1920, 1080, 1e5 / 7, 1e5 / 7, 960.1, 540.2, {-0.1, 0.2, 0, 0, 1.0 / 9}},
      {640, 480, 500, 501, 320, 240, {0.6, -0.02, 1e-4, 0, 0.001, 0.95, 0.12, 1.0 / 7}},
      {1280, 960, 400.7, 400.7, 641, 478, {-0.02, 0.004, -0.001, 1e-4 / 3}, LensModel::fisheye}};
}

CalibrationNotes notes() { return {"left", {"by a test", "two: # lines"}, 0.1}; }

bool are_equal(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy &&
         a.cx == b.cx && a.cy == b.cy && a.distortion == b.distortion && a.lens == b.lens;
}

}  // namespace

TEST_CASE("what is written reads back to the last bit, without being told anything") {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "camera.yaml";
  int written = 0;
  for (const auto format :
       {CalibrationFormat::opencv, CalibrationFormat::ros, CalibrationFormat::kalibr}) {
    for (const Camera& camera : cameras()) {
      const auto text = calibration_text(format, camera, notes());
      if (!text) continue;
      CAPTURE(*text);
      REQUIRE(write_file(file, *text));
      const auto reading = read_calibration({file, "", std::nullopt});
      REQUIRE(reading.has_value());
      CHECK_MESSAGE(reading->diagnostics.empty(), to_string(reading->diagnostics, true));
      REQUIRE(reading->value.has_value());
      CHECK(are_equal(*reading->value, camera));
      ++written;
    }
  }
  CHECK(written == 13);
}

TEST_CASE("kalibr's file is refused a lens that kalibr does not have") {
  const auto refused = calibration_text(CalibrationFormat::kalibr, cameras()[2], notes());
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().message.find("opencv or ros") != std::string::npos);
}

TEST_CASE("the matrices of a file for ROS have the sizes that sensor_msgs gives them") {
  const std::string text = calibration_text(CalibrationFormat::ros, cameras()[1], notes()).value();
  for (const char* head : {"camera_matrix:\n   rows: 3\n   cols: 3\n",
                           "rectification_matrix:\n   rows: 3\n   cols: 3\n",
                           "projection_matrix:\n   rows: 3\n   cols: 4\n",
                           "distortion_coefficients:\n   rows: 1\n   cols: 5\n"}) {
    CAPTURE(std::string(head));
    CHECK(text.find(head) != std::string::npos);
  }
}

TEST_CASE("OpenCV reads its file") {
  const test::TemporaryFolder folder;
  for (const Camera& camera : cameras()) {
    const std::string text = calibration_text(CalibrationFormat::opencv, camera, notes()).value();
    CAPTURE(text);
    const cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    REQUIRE(storage.isOpened());
    cv::Mat matrix, distortion;
    storage["camera_matrix"] >> matrix;
    storage["distortion_coefficients"] >> distortion;
    CHECK(static_cast<int>(storage["image_width"]) == camera.width);
    CHECK(static_cast<int>(storage["image_height"]) == camera.height);
    CHECK(static_cast<int>(storage["fisheye_model"]) ==
          (camera.lens == LensModel::fisheye ? 1 : 0));
    CHECK(static_cast<double>(storage["avg_reprojection_error"]) == 0.1);
    REQUIRE(matrix.type() == CV_64F);
    REQUIRE(matrix.size() == cv::Size(3, 3));
    CHECK(matrix.at<double>(0, 0) == doctest::Approx(camera.fx).epsilon(1e-14));
    CHECK(matrix.at<double>(1, 1) == doctest::Approx(camera.fy).epsilon(1e-14));
    CHECK(matrix.at<double>(0, 2) == doctest::Approx(camera.cx).epsilon(1e-14));
    CHECK(matrix.at<double>(1, 2) == doctest::Approx(camera.cy).epsilon(1e-14));
    REQUIRE(distortion.type() == CV_64F);
    REQUIRE(distortion.cols == 1);
    REQUIRE((distortion.rows == 4 || distortion.rows == 5 || distortion.rows == 8));
    for (int i = 0; i < distortion.rows; ++i) {
      CHECK(distortion.at<double>(i) ==
            doctest::Approx(camera.distortion[static_cast<std::size_t>(i)]).epsilon(1e-14));
    }
  }
}
