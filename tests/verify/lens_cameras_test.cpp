// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/lens_cameras.hpp"

#include <algorithm>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tests/support/wide_corridor.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kNoise = 0.1;  // pixels

// Photos that a phone took along both walls of the corridor, its lens other than it says.
struct Photos : test::WideCorridor {
  Camera lens;

  Photos() {
    lens = camera_by_lens(4000, 3000, 26).camera;
    lens.fx = lens.fy = 1.04 * lens.fx;
    lens.cx += 30;
    lens.cy -= 20;
    lens.distortion = {0.02, -0.01};
  }

  static VehiclePose held(double y, bool left, double tilt) {
    Pose pose;
    const double yaw = radians(left ? 180 : 0) + tilt;
    pose.rotation = rotation_from_yaw_pitch_roll(yaw, radians(15), 2 * tilt);
    pose.translation = {left ? 0.6 : -0.6, y, 1.0};
    return vehicle_pose_of(pose);
  }

  std::vector<VerifiedFile> taken() const {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, kNoise);
    std::vector<VerifiedFile> files;
    for (int i = 0; i < 12; ++i) {
      VerifiedFile& file = files.emplace_back();
      file.file = fmt::format("IMG_{}.jpg", i);
      file.sha256 = fmt::format("{}", i);
      file.revision = survey_revision(survey);
      file.width = lens.width;
      file.height = lens.height;
      file.lens = PhotoLens{"Maker Phone 7", 5.43, 26};
      RigCamera camera = camera_by_lens(4000, 3000, 26);
      camera.camera = lens;
      camera.camera.fx = camera.camera.fy = lens.fx * (1 + 0.003 * (i % 3));
      Rig phone;
      phone.cameras = {camera};
      photograph(phone, held(0.4 + 1.0 * (i / 2), i % 2 == 0, radians(4.0 * (i % 5) - 8)), file,
                 [&] { return noise(random); });
    }
    return files;
  }

  template <typename Noise>
  void photograph(const Rig& phone, const VehiclePose& from, VerifiedFile& file,
                  Noise noise) const {
    for (std::size_t i = 0; i < survey.tags.size(); ++i) {
      SightedPlate plate = sighted_plate(survey.tags[i], survey);
      plate.world_from_plate = hung[i];
      const auto rows =
          sighting_rows(phone, calibration_layout(phone), {}, vehicle_frame(from), plate, 0);
      if (!rows || rows->predicted.minCoeff() < 0 || rows->predicted.maxCoeff() > 4000) continue;
      const Eigen::Vector2d right = rows->predicted.segment<2>(2) - rows->predicted.head<2>();
      const Eigen::Vector2d down = rows->predicted.segment<2>(6) - rows->predicted.head<2>();
      if (right.x() * down.y() - right.y() * down.x() < 1e4) continue;
      VerifiedTag& tag = file.tags.emplace_back();
      tag.tag = survey.tags[i].name;
      tag.digits = survey.tags[i].digits;
      tag.corner_covariance = kNoise * kNoise * CornerCovariance::Identity();
      for (std::size_t c = 0; c < 4; ++c) {
        const auto row = static_cast<Eigen::Index>(2 * c);
        tag.corners[c] = {rows->predicted[row] + noise(), rows->predicted[row + 1] + noise()};
      }
    }
  }
};

EachFile each_of(const std::vector<VerifiedFile>& files) {
  return [&](const auto& take) -> Result<void> {
    for (const VerifiedFile& file : files) take(file);
    return {};
  };
}

HungTags check(const Survey& survey, const std::vector<VerifiedFile>& files) {
  const HangingSetup setup = hanging_by_lenses(each_of(files), kHangTolerance).value();
  return check_hanging(survey, setup, each_of(files)).value();
}

}  // namespace

TEST_CASE("photos of one phone tell where tags hang, and calibrate it on the way") {
  Photos photos;
  const HungTags right = check(photos.survey, photos.taken());
  CHECK(right.unplaced.empty());
  int fits = 0;
  for (const HungTag& tag : right.tags) {
    CHECK(tag.rule == "");
    fits += tag.verdict == HangVerdict::fits ? 1 : 0;
    if (tag.verdict == HangVerdict::fits) {
      CHECK((tag.offset.value.cwiseAbs() - 4 * tag.offset.sigma).maxCoeff() < 0);
    }
  }
  CHECK(fits >= 8);
  photos.hung[photos.index("003L")].translation.z() += 0.04;
  const HungTags moved = check(photos.survey, photos.taken());
  for (const HungTag& tag : moved.tags) {
    CHECK(tag.rule == (tag.tag == "003L" ? "moved" : ""));
    if (tag.tag != "003L") continue;
    CHECK(tag.offset.value.y() == doctest::Approx(0.04).epsilon(0.1));
    CHECK(tag.message.find("lower it by") != std::string::npos);
  }
}

TEST_CASE("photos by lenses that they do not name are left out, and named if they could tell") {
  Photos photos;
  std::vector<VerifiedFile> files = photos.taken();
  files[0].lens.reset();
  files[1].lens.reset();
  files[1].tags.resize(1);
  REQUIRE(files[0].tags.size() > 1);
  const HangingSetup setup = hanging_by_lenses(each_of(files), kHangTolerance).value();
  REQUIRE(setup.rig.cameras.size() == 1);
  CHECK(setup.rig.cameras[0].name == "Maker Phone 7 of 26 mm, 4000 x 3000");
  const HungTags hung = check_hanging(photos.survey, setup, each_of(files)).value();
  REQUIRE(hung.notes.size() == 1);
  CHECK(hung.notes[0] ==
        "IMG_0.jpg: does not name its camera and lens (EXIF); where its tags hang was not checked");
  // What was said of them by a rig stays.
  files[0].tags[0].hung.emplace();
  judge_hanging(photos.survey, setup, hung, files[0]);
  CHECK(files[0].tags[0].hung);
}

TEST_CASE("photos of another size or zoom are another camera's") {
  Photos photos;
  std::vector<VerifiedFile> files = photos.taken();
  files[0].lens->focal_35_mm = 52;
  files[1].width = 2000;
  CHECK(hanging_by_lenses(each_of(files), kHangTolerance)->rig.cameras.size() == 3);
}

}  // namespace tagsmith::detail
