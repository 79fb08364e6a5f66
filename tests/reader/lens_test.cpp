// SPDX-License-Identifier: Apache-2.0
// Frames whose sides a lens bends.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

Camera fisheye() {
  return {1280, 960, 620, 622, 645, 470, {-0.03, 0.01, -0.004, 0.0007}, LensModel::fisheye};
}

Camera wide_angle() { return {1280, 960, 800, 800, 639.5, 479.5, {-0.28, 0.08, 0.001, -0.0015}}; }

struct CornerErrors {
  double square = 0;  // over all corners, pixels^2
  int tags = 0;

  double mean() const { return std::sqrt(square / (4 * tags)); }
};

const Survey& corridor() {
  static const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  return survey;
}

// What a camera at the left sees along the corridor.
std::vector<SurveyView> views_along_corridor(const Camera& camera) {
  RigCamera rig_camera;
  rig_camera.camera = camera;
  rig_camera.vehicle_from_camera = vehicle_from_side_camera(Side::left, radians(20));
  ViewOptions view;
  view.lighting = tunnel_lighting();
  view.sensor.noise_sigma = 1.5;
  std::vector<SurveyView> views;
  for (const double y : {0.3, 1.1, 1.9, 2.7}) {
    const Pose vehicle = vehicle_in_tunnel(corridor(), {0.95, y, 0.24}, radians(2));
    views.push_back(render_survey_view(corridor(), rig_camera, vehicle, view, 1));
  }
  return views;
}

// Over the large tags that are read in them.
CornerErrors errors_in(const std::vector<SurveyView>& views, const ReadOptions& options) {
  CornerErrors errors;
  for (const SurveyView& seen : views) {
    for (const Reading& reading : read_tags(seen.view.image.view(), options).tags) {
      for (std::size_t i = 0; i < seen.tags.size(); ++i) {
        const PlateTruth& plate = seen.view.plates[i];
        const bool is_this = corridor().tags[seen.tags[i]].digits == reading.digits;
        if (!is_this || plate.module_px < 1.2) continue;
        ++errors.tags;
        for (std::size_t corner = 0; corner < 4; ++corner) {
          const PixelPoint& at = reading.corners[corner];
          errors.square += (Eigen::Vector2d(at.x, at.y) - *plate.corners[corner]).squaredNorm();
        }
      }
    }
  }
  return errors;
}

// The corners of one tag of the corridor, which a camera that the reader does not know sees at a
// pixel with so many pixels a module; nothing where it is not read.
std::optional<bench::CornerFit> read_far_out(const Camera& camera, const Eigen::Vector2d& pixel,
                                             double module_px, double yaw) {
  const Digits& digits = corridor().tags.front().digits;
  ScenePlate plate;
  plate.drawing = draw_tag(corridor().tag_template, digits);
  const double away = camera.fx * plate.drawing.module / module_px;
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, pixel, away, yaw, 0, radians(-8));
  ViewOptions options;
  options.sensor.blur_sigma_px = 0.4;
  options.sensor.noise_sigma = 1.5;
  const View view = render_view(camera, std::span(&plate, 1), options);
  const ReadResult result = read_tags(view.image.view());
  if (result.tags.size() != 1 || result.tags.front().digits != digits) return std::nullopt;
  return bench::corner_fit(result.tags.front(), bench::corners_of(view.plates.front()));
}

std::optional<PixelPoint> there_and_back(const LensDistortion& lens, PixelPoint pixel) {
  const auto straight = lens.straightened(pixel);
  return straight ? lens.bent(*straight) : std::nullopt;
}

}  // namespace

TEST_CASE("a lens that bends the frame's sides does not shift its corners") {
  for (const Camera& camera : {fisheye(), wide_angle()}) {
    ReadOptions known;
    known.camera = camera;
    const std::vector<SurveyView> views = views_along_corridor(camera);
    const CornerErrors by_camera = errors_in(views, known);
    const CornerErrors by_sides = errors_in(views, {});
    MESSAGE(by_camera.tags << " and " << by_sides.tags << " tags: " << by_camera.mean()
                           << " px with the camera, " << by_sides.mean() << " px without");
    CHECK(by_camera.tags >= 4);
    CHECK(by_sides.tags >= 4);
    CHECK(by_camera.mean() < 0.03);
    CHECK(by_sides.mean() < 0.15);
  }
}

TEST_CASE("sides far from the middle of a strongly bending lens tell which it is, and how surely") {
  const Camera camera{1280, 960, 800, 800, 639.5, 479.5, {-0.35, 0.125}};
  int asked = 0, near = 0;
  double worst = 0;
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(160, 330), Eigen::Vector2d(160, 620),
                                       Eigen::Vector2d(1120, 340), Eigen::Vector2d(1120, 640)}) {
    for (const double module_px : {1.2, 1.6, 2.0}) {
      for (const double yaw : {-30.0, 0.0, 30.0}) {
        const auto seen = read_far_out(camera, pixel, module_px, radians(yaw));
        ++asked;
        if (!seen) continue;
        const auto off = Eigen::Matrix<double, 2, 4>::Map(seen->error.data());
        near += off.colwise().norm().maxCoeff() < 0.5 ? 1 : 0;
        worst = std::max(worst, seen->chi_square);
      }
    }
  }
  MESSAGE(near << " of " << asked << " tags with corners within half a pixel; chi-square over 8 "
               << worst << " at most");
  CHECK(near >= 30);
  CHECK(worst < 4);
}

TEST_CASE("a known fisheye bends the strokes of long plates nearby too") {
  const Survey survey = load_survey("surveys/curved/survey.yaml").value();
  RigCamera seen_by;
  seen_by.camera = {1280, 960, 485.4, 481.4, 620.9, 460.7, {0.0068, 0.0031}, LensModel::fisheye};
  ReadOptions known;
  known.camera = seen_by.camera;
  ViewOptions options;
  options.sensor.noise_sigma = 1.5;
  int read = 0;
  double worst = 0;
  for (const double yaw : {112.0, 130.0, 50.0}) {
    seen_by.vehicle_from_camera = vehicle_from_camera(radians(yaw), radians(9.7), 0, {0, 0.3, 1.2});
    for (const double y : {0.2, 0.6, 1.0, 1.4, 1.8}) {
      const Pose vehicle = vehicle_in_tunnel(survey, {2.15, y, 0.35}, 0);
      const SurveyView seen = render_survey_view(survey, seen_by, vehicle, options, 1);
      for (const Reading& reading : read_tags(seen.view.image.view(), known).tags) {
        for (std::size_t i = 0; i < seen.tags.size(); ++i) {
          const PlateTruth& plate = seen.view.plates[i];
          if (survey.tags[seen.tags[i]].digits != reading.digits || plate.module_px < 1) continue;
          ++read;
          worst = std::max(worst, bench::corner_fit(reading, bench::corners_of(plate)).chi_square);
        }
      }
    }
  }
  MESSAGE(read << " tags, chi-square over 8 " << worst << " at most");
  CHECK(read >= 8);
  CHECK(worst < 2);
}

TEST_CASE("what is straightened is bent back to where it was") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0, 1279), y(0, 959);
  const LensDistortion barrel = LensDistortion::radial({639.5, 479.5}, -6e-7);
  const LensDistortion cushion = LensDistortion::radial({639.5, 479.5}, 3e-7);
  for (const LensDistortion& lens : {barrel, cushion, LensDistortion(fisheye()),
                                     LensDistortion(wide_angle()), LensDistortion()}) {
    for (int i = 0; i < 50; ++i) {
      const PixelPoint pixel{x(random), y(random)};
      const auto back = there_and_back(lens, pixel);
      REQUIRE(back.has_value());
      CHECK(distance(*back, pixel) < 1e-6);
    }
  }
}

TEST_CASE("a bent side is described by its bow to a hundredth of a pixel over half the image") {
  const Quad corners{PixelPoint{350, 120}, PixelPoint{1020, 180}, PixelPoint{980, 520},
                     PixelPoint{330, 440}};
  for (const LensDistortion& lens : {LensDistortion(fisheye()), LensDistortion(wide_angle())}) {
    const SideSagittas bows = sagittas_of(lens, corners);
    const PixelPoint from = *lens.straightened(corners[0]);
    const PixelPoint to = *lens.straightened(corners[1]);
    const SideLine side = side_of(corners, 0);
    CHECK(std::abs(bows[0].middle()) > 5);
    for (double part = 0; part <= 1; part += 0.05) {
      const PixelPoint off = *lens.bent((1 - part) * from + part * to) - side.begin;
      const double s = 2 * dot(off, side.along) / distance(side.begin, side.end) - 1;
      CHECK(std::abs(dot(off, side.outward) - bows[0].at(s)) < 0.01);
    }
  }
  CHECK(sagittas_of(LensDistortion(), corners)[0].middle() == 0);
}

TEST_CASE("places in a bent frame are found from its pixels") {
  const Quad corners{PixelPoint{700, 120}, PixelPoint{1210, 160}, PixelPoint{1180, 420},
                     PixelPoint{690, 400}};
  const FrameHomography map(corners, LensDistortion(wide_angle()));
  const Homography frame_from_image = inverse(map.flat());
  double farthest_flat = 0;
  for (double u = 0; u <= 1; u += 0.1) {
    for (double v = 0; v <= 1; v += 0.1) {
      const PixelPoint pixel = map(u, v);
      const PixelPoint flat = frame_from_image(pixel.x, pixel.y);
      auto found_u = static_cast<float>(flat.x), found_v = static_cast<float>(flat.y);
      map.correct(found_u, found_v);
      farthest_flat = std::max(farthest_flat, std::abs(flat.x - u));
      CHECK(std::abs(static_cast<double>(found_u) - u) < 6e-4);  // a fifteenth of a module
      CHECK(std::abs(static_cast<double>(found_v) - v) < 6e-4);
    }
  }
  CHECK(farthest_flat > 5e-3);
}

TEST_CASE("a stroke is thicker at the side's nearer end") {
  const Quad level{PixelPoint{100, 100}, PixelPoint{300, 100}, PixelPoint{300, 200},
                   PixelPoint{100, 200}};
  CHECK(std::abs(taper_of(level, side_of(level, 0), 0)) < 1e-12);
  // Height halves from left to right, so the plate's right end is twice as far away.
  const Quad oblique{PixelPoint{100, 100}, PixelPoint{200, 125}, PixelPoint{200, 175},
                     PixelPoint{100, 200}};
  const Homography map = homography_to(oblique);
  const SideLine upper = side_of(oblique, 0);
  const double begin = dot(map(0, -0.05) - upper.begin, upper.outward);
  const double end = dot(map(1, -0.05) - upper.end, upper.outward);
  CHECK(begin > 1.5 * end);
  const double taper = taper_of(oblique, upper, 0);
  CHECK(std::abs((1 + taper) / (1 - taper) - end / begin) < 0.01);
  CHECK(std::abs(taper_of(oblique, side_of(oblique, 2), 2) + taper) < 1e-9);
}

TEST_CASE("corners without a ray bend nothing") {
  const Quad corners{PixelPoint{20, 20}, PixelPoint{300, 30}, PixelPoint{310, 220},
                     PixelPoint{30, 200}};
  Camera narrow = fisheye();
  narrow.fx = narrow.fy = 200;  // the image's corners lie outside of the image circle
  const LensDistortion lens(narrow);
  REQUIRE(lens.bends());
  for (const SideSagitta& bow : sagittas_of(lens, corners)) CHECK(bow.middle() == 0);
  CHECK_FALSE(FrameHomography(corners, lens).bends());
}
