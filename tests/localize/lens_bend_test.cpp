// SPDX-License-Identifier: Apache-2.0
// From the camera that bends straight lines to the corners that the localizer takes.
#include "decoder/localize/lens_bend.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"

using namespace tagsmith;

namespace {

Camera fisheye() {
  return {1280, 960, 620, 622, 645, 470, {-0.03, 0.01, -0.004, 0.0007}, LensModel::fisheye};
}

// Its sides bend by up to a pixel. From two on the reader refuses or misjudges frames: it looks for
// straight sides.
Camera wide_angle() { return {1280, 960, 905, 904, 650, 472, {-0.17, 0.09, 0.001, -0.0015}}; }

struct CornerErrors {
  double as_read = 0;  // root mean square over all corners, pixels
  double mended = 0;
  int tags = 0;
};

double square_error(const PixelPoint& seen, const Eigen::Vector2d& truth) {
  return (Eigen::Vector2d(seen.x, seen.y) - truth).squaredNorm();
}

// Over the large tags that a camera at the left reads along the corridor.
CornerErrors errors_along_corridor(const Camera& camera) {
  const auto survey = load_survey("surveys/corridor/survey.yaml");
  REQUIRE(survey.has_value());
  RigCamera rig_camera;
  rig_camera.camera = camera;
  rig_camera.vehicle_from_camera = vehicle_from_side_camera(Side::left, radians(20));
  ViewOptions options;
  options.lighting = tunnel_lighting();
  options.sensor.noise_sigma = 1.5;
  CornerErrors errors;
  for (const double y : {0.3, 1.1, 1.9, 2.7}) {
    const Pose vehicle = vehicle_in_tunnel(*survey, {0.95, y, 0.24}, radians(2));
    const SurveyView seen = render_survey_view(*survey, rig_camera, vehicle, options, 1);
    for (const Reading& reading : read_tags(seen.view.image.view(), {}).tags) {
      const FrameCorners mended = corners_of_bent_sides(camera, reading.corners);
      for (std::size_t i = 0; i < seen.tags.size(); ++i) {
        const PlateTruth& plate = seen.view.plates[i];
        if (survey->tags[seen.tags[i]].digits != reading.digits || plate.module_px < 1.2) continue;
        ++errors.tags;
        for (std::size_t corner = 0; corner < 4; ++corner) {
          errors.as_read += square_error(reading.corners[corner], *plate.corners[corner]);
          errors.mended += square_error(mended[corner], *plate.corners[corner]);
        }
      }
    }
  }
  errors.as_read = std::sqrt(errors.as_read / (4 * errors.tags));
  errors.mended = std::sqrt(errors.mended / (4 * errors.tags));
  return errors;
}

}  // namespace

TEST_CASE("a lens that bends the frame's sides does not shift its corners") {
  for (const Camera& camera : {fisheye(), wide_angle()}) {
    const CornerErrors errors = errors_along_corridor(camera);
    MESSAGE(errors.tags << " tags: " << errors.as_read << " px as read, " << errors.mended
                        << " px mended");
    CHECK(errors.tags >= 4);
    CHECK(errors.as_read > 0.25);
    CHECK(errors.mended < 0.1);
  }
}

TEST_CASE("a lens without distortion, and corners without a ray, stay as they are") {
  const FrameCorners corners{{{100, 100}, {300, 110}, {310, 220}, {90, 200}}};
  const Camera plain = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  Camera narrow = fisheye();
  narrow.fx = narrow.fy = 200;  // the image's corners lie outside of the image circle
  for (const Camera& camera : {plain, narrow}) {
    const FrameCorners same = corners_of_bent_sides(camera, corners);
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(same[i].x == corners[i].x);
      CHECK(same[i].y == corners[i].y);
    }
  }
}
