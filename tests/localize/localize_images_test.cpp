// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/localize_images.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

struct ShippedRun {
  std::vector<Survey> surveys;
  Rig rig;
  Run run;
};

ShippedRun load_site(const std::string& name) {
  const std::string folder = "surveys/" + name;
  auto survey = load_survey(folder + "/survey.yaml");
  auto rig = load_rig(folder + "/rig.yaml");
  REQUIRE(survey.has_value());
  REQUIRE(rig.has_value());
  auto run = load_run(folder + "/run.csv", *rig);
  REQUIRE(run.has_value());
  return {{std::move(*survey)}, std::move(*rig), std::move(*run)};
}

// A measurement's images, every one read as closely as can be.
struct Images {
  Images(const ShippedRun& site, const Measurement& measurement) {
    for (const RigCamera& camera : site.rig.cameras) {
      auto image = load_gray_image(measurement.cameras.at(camera.name).image);
      REQUIRE(image.has_value());
      loaded.push_back(std::move(*image));
      images.push_back({&camera, loaded.back().view(), camera.name});
    }
  }

  // The fix that spares the closer look where it can.
  Fix fix(const ShippedRun& site, const std::vector<Survey>& surveys) const {
    Observation seen;
    return localize_images(seen, images, surveys, site.rig);
  }

  // The fix by all that the images show.
  Fix full_fix(const ShippedRun& site, const std::vector<Survey>& surveys) const {
    Observation seen;
    for (const CameraImage& image : images) {
      observe_image(seen, *image.camera, image.image, image.name, surveys,
                    {read_tags, kFittedCornerSigmaPx});
    }
    return localize_jointly(seen, surveys, site.rig);
  }

  std::deque<GrayImage> loaded;
  std::vector<CameraImage> images;
};

bool has_read(const TagSearch& search, const Digits& digits) {
  return std::ranges::find(search.tags(), digits, &Reading::digits) != search.tags().end();
}

// A grey strip over a frame's left side: its outline is in pieces then.
void paint_over_left_side(GrayImage& image, const FrameCorners& corners) {
  const auto pixel = [](double at) { return static_cast<int>(at); };
  const int x = pixel(corners[0].x);
  const int top = pixel(corners[0].y) - 60;
  const int bottom = pixel(corners[3].y) + 60;
  for (int row = top; row < bottom; ++row) {
    std::fill_n(image.samples.begin() + row * image.width + x - 25, 35, std::uint8_t{128});
  }
}

}  // namespace

TEST_CASE("sparing the closer look leaves positions as they are") {
  for (const char* name : {"corridor", "curved"}) {
    const ShippedRun site = load_site(name);
    for (const Measurement& measurement : site.run.measurements) {
      CAPTURE(name);
      CAPTURE(measurement.id);
      const Images seen(site, measurement);
      const Fix full = seen.full_fix(site, site.surveys);
      const Fix fix = seen.fix(site, site.surveys);
      REQUIRE(full.position_in_grid.has_value());
      REQUIRE(fix.position_in_grid.has_value());
      CHECK(fix.tags == full.tags);
      CHECK((*fix.position_in_grid - *full.position_in_grid).norm() < 1e-9);
    }
  }
}

TEST_CASE("a tag that hangs elsewhere than surveyed is met by the closer look as without sparing") {
  const ShippedRun site = load_site("corridor");
  for (const std::size_t row : {1U, 2U, 5U, 8U}) {  // with other bars in their photos
    const Images seen(site, site.run.measurements[row]);
    const Fix whole = seen.full_fix(site, site.surveys);
    for (const std::string& name : whole.tags) {
      CAPTURE(row);
      CAPTURE(name);
      std::vector<Survey> moved = site.surveys;
      const auto tag = std::ranges::find(moved[0].tags, name, &PlacedTag::name);
      tag->world_from_plate.translation += 0.3 * tag->world_from_plate.rotation.col(0);
      const Fix full = seen.full_fix(site, moved);
      const Fix fix = seen.fix(site, moved);
      CHECK(fix.position_in_grid.has_value() == full.position_in_grid.has_value());
      CHECK(fix.reason == full.reason);
    }
  }
}

TEST_CASE("a surveyed tag that was not read where it should be is looked for closer") {
  ShippedRun site = load_site("corridor");
  const Measurement& measurement = site.run.measurements.front();
  Images seen(site, measurement);
  // A third camera beside the right one, before which something hides a part of the frame.
  const auto right = std::ranges::find(site.rig.cameras, "right", &RigCamera::name);
  RigCamera third = *right;
  third.name = "third";
  site.rig.cameras.push_back(third);
  for (std::size_t i = 0; i < seen.images.size(); ++i) seen.images[i].camera = &site.rig.cameras[i];
  seen.loaded.push_back(seen.loaded[1]);
  const ReadOptions options = read_options_for(site.surveys);
  const std::vector<Reading> in_right = read_tags(seen.loaded[1].view(), options).tags;
  REQUIRE(in_right.size() == 1);
  paint_over_left_side(seen.loaded.back(), in_right[0].corners);
  seen.images.push_back({&site.rig.cameras[2], seen.loaded.back().view(), "third"});

  TagSearch search(seen.images[2].image, options);
  REQUIRE_FALSE(has_read(search, in_right[0].digits));
  search.look_closer();
  REQUIRE(has_read(search, in_right[0].digits));

  const Fix fix = seen.fix(site, site.surveys);
  REQUIRE(fix.position_in_grid.has_value());
  CHECK(std::ranges::find(fix.corners, "third", &FittedCorners::camera) != fix.corners.end());
}

TEST_CASE("an image without a tag, or of another size, is told") {
  ShippedRun site = load_site("corridor");
  Images seen(site, site.run.measurements.front());
  GrayImage& left = seen.loaded[0];
  std::ranges::fill(left.samples, std::uint8_t{100});
  GrayImage& right = seen.loaded[1];
  const GrayView cut{right.samples.data(), right.width - 1, right.height, right.width};
  seen.images[1].image = cut;
  const Fix fix = seen.fix(site, site.surveys);
  CHECK_FALSE(fix.position_in_grid.has_value());
  CHECK(fix.reason.find("left: no tag read") != std::string::npos);
  const std::size_t of_right = fix.reason.find("right: ");
  CHECK(fix.reason.find("1279 x 960 ", of_right) < fix.reason.find(" 1280 x 960", of_right));
  CHECK(fix.reason.find(" 1280 x 960", of_right) != std::string::npos);
}

}  // namespace tagsmith::detail
