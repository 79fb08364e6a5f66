// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/frame_bow.hpp"

#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

namespace tagsmith::detail {
namespace {

const Camera kCamera{1280, 960, 1600, 1600, 639.5, 479.5};

struct BowedPicture {
  GrayImage image;
  FrameCorners corners{};
};

BowedPicture rendered(const Camera& camera, const Eigen::Vector2d& middle, double yaw,
                      double pitch) {
  ScenePlate plate{draw_tag(test::corridor_template(), *parse_digits("019000000404")), {}, {}};
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, middle, 1.2, yaw, pitch, 0.1);
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  const View view = render_view(camera, std::span(&plate, 1), options);
  BowedPicture picture{view.image, {}};
  const ReadResult read = read_tags(picture.image.view());
  REQUIRE(read.tags.size() == 1);
  picture.corners = read.tags[0].corners;
  return picture;
}

// The picture as a plate bent about its upright axis shows from above: its columns shifted by a
// parabola with this height in the middle of the frame.
BowedPicture bent(const BowedPicture& flat, double pixels) {
  BowedPicture result = flat;
  const double from = flat.corners[0].x;
  const double to = flat.corners[1].x;
  for (int y = 0; y < flat.image.height; ++y) {
    for (int x = 0; x < flat.image.width; ++x) {
      const double t = (x - from) / (to - from);
      const double shift = pixels * 4 * t * (1 - t);
      result.image.samples[static_cast<std::size_t>(y * flat.image.width + x)] =
          static_cast<std::uint8_t>(sample_bilinear(
              flat.image.view(), {static_cast<double>(x), y - std::max(shift, -60.0)}));
    }
  }
  return result;
}

// The rule of what is found; empty when nothing is.
std::string judged(const BowedPicture& picture, const Camera* camera) {
  Survey survey;
  survey.tag_template = test::corridor_template();
  PictureEvidence evidence{survey, picture.image.view()};
  evidence.is_photo = true;
  evidence.camera = camera;
  TagEvidence seen;
  seen.tag.corners = picture.corners;
  const auto found = find_bent(evidence, seen);
  CHECK((!found || found->status == TagStatus::misprinted));
  return found ? found->rule : "";
}

}  // namespace

TEST_CASE("the sides of a flat plate are straight from wherever they are seen") {
  for (const double yaw : {-50.0, -20.0, 0.0, 35.0}) {
    for (const double pitch : {-25.0, 0.0, 20.0}) {
      CAPTURE(yaw);
      CAPTURE(pitch);
      const BowedPicture flat = rendered(kCamera, {500, 600}, radians(yaw), radians(pitch));
      const auto bow = measure_bow(flat.image.view(), test::corridor_template(), flat.corners);
      if (bow) {
        for (const double side : *bow) CHECK(std::abs(side) < 0.3);
      }
      CHECK((bow || yaw == -50));  // the upright strokes are too thin to be followed there
      CHECK(judged(flat, &kCamera) == "");
      CHECK(judged(flat, nullptr) == "");
    }
  }
}

TEST_CASE("a bent plate is told by the bow of its frame") {
  const BowedPicture flat = rendered(kCamera, {600, 500}, radians(10), radians(-20));
  const double length = distance(flat.corners[0], flat.corners[1]);
  for (const double share : {-0.03, 0.03}) {
    const BowedPicture picture = bent(flat, share * length);
    const auto bow = measure_bow(picture.image.view(), test::corridor_template(), picture.corners);
    REQUIRE(bow);
    CHECK(share_of_bend(*bow, picture.corners) == doctest::Approx(0.03).epsilon(0.15));
    for (const Camera* camera : {&kCamera, static_cast<const Camera*>(nullptr)}) {
      CHECK(judged(picture, camera) == "bent");
    }
  }
  const BowedPicture slight = bent(flat, 0.015 * length);
  CHECK(judged(slight, &kCamera) == "bent");
  CHECK(judged(slight, nullptr) == "");
}

TEST_CASE("what a lens bends is no bent plate, whether the lens is known or not") {
  Camera barrel = kCamera;
  barrel.distortion[0] = -0.15;
  for (const Eigen::Vector2d& middle :
       {Eigen::Vector2d(350, 300), Eigen::Vector2d(640, 480), Eigen::Vector2d(950, 700)}) {
    CAPTURE(middle.transpose());
    const BowedPicture picture = rendered(barrel, middle, radians(20), radians(5));
    const auto bow = measure_bow(picture.image.view(), test::corridor_template(), picture.corners);
    REQUIRE(bow);
    const FrameBow of_lens = bow_of_lens(barrel, picture.corners);
    for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs((*bow)[i] - of_lens[i]) < 0.5);
    CHECK(judged(picture, &barrel) == "");
    CHECK(judged(picture, nullptr) == "");
  }
}

}  // namespace tagsmith::detail
