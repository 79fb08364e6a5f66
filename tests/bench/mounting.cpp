// SPDX-License-Identifier: Apache-2.0
// bench_mounting [N] [SEED]: mountings fitted to simulated drives through the shipped corridor, and
// whether wrong rigs are told and right ones are not doubted. Plates hang within 2 mm of the
// survey, corners have a noise of 0.05 pixels.
#include "decoder/calibrate/mounting.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "decoder/plates/plate_trials.hpp"
#include "decoder/plates/rig_suspicion.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/calibrate/seen_drive.hpp"

namespace tagsmith::detail::test {
namespace {

constexpr double kPlateSigma = 0.002;  // metres
constexpr std::size_t kRows = 10;

Site surveyed_corridor() {
  Site site = site_named("corridor");
  site.survey.sigma = kPlateSigma;
  for (PlacedTag& tag : site.survey.tags) tag.sigma = kPlateSigma;
  return site;
}

// What the site's rig sees, named and placed as the survey has it.
std::vector<Observation> rows_of(const Site& site, const Survey& survey, Draws& draws,
                                 bool is_level) {
  std::vector<Observation> rows = seen_from(site, drive_past(site, kRows, draws, is_level), draws);
  for (Observation& row : rows) {
    for (SeenTag& tag : row.tags) tag.tag = *find_tag(survey, tag.tag.name);
  }
  return rows;
}

Site hung(Site site, Draws& draws) {
  for (PlacedTag& tag : site.survey.tags) {
    tag.world_from_plate.translation += draws.normals(kPlateSigma);
  }
  return site;
}

// --- mountings ---

struct Errors {
  std::vector<double> angles;   // degrees, of each camera's attitude
  std::vector<double> between;  // degrees, of the right camera's attitude against the left's
  double nees = 0;
  int failed = 0;
};

void add_draw(const Site& surveyed, Draws& draws, Errors& errors) {
  Site site = hung(surveyed, draws);
  for (std::size_t c = 0; c < 2; ++c) {
    mount(site.rig, c, (c == 0 ? 55 : -55) + draws.uniform(-8, 8), draws.uniform(-5, 5),
          draws.uniform(-5, 5), Eigen::Vector3d::Zero());
  }
  const auto rows = rows_of(site, surveyed.survey, draws, false);
  const auto fit = fit_mounting(rows, surveyed.survey, surveyed.rig);
  if (!fit) {
    ++errors.failed;
    return;
  }
  const auto between = [](const Pose& left, const Pose& right) -> Eigen::Matrix3d {
    return left.rotation.transpose() * right.rotation;
  };
  const Eigen::Matrix3d is_between =
      between(fit->cameras[0].vehicle_from_camera, fit->cameras[1].vehicle_from_camera);
  const Eigen::Matrix3d was_between =
      between(site.rig.cameras[0].vehicle_from_camera, site.rig.cameras[1].vehicle_from_camera);
  errors.between.push_back(
      degrees(Eigen::AngleAxisd(was_between.transpose() * is_between).angle()));
  for (std::size_t c = 0; c < 2; ++c) {
    const Pose& truth = site.rig.cameras[c].vehicle_from_camera;
    const FittedMounting& found = fit->cameras[c];
    const MountingAngles is = mounting_angles(found.vehicle_from_camera);
    const MountingAngles was = mounting_angles(truth);
    const Eigen::Vector3d off(is.yaw - was.yaw, is.pitch - was.pitch, is.roll - was.roll);
    errors.nees += off.cwiseQuotient(found.sigma.tail<3>()).squaredNorm() / 3;
    errors.angles.push_back(
        degrees(Eigen::AngleAxisd(truth.rotation.transpose() * found.vehicle_from_camera.rotation)
                    .angle()));
  }
}

void print_mountings(int count, std::uint64_t seed) {
  const Site surveyed = surveyed_corridor();
  Draws draws(seed);
  Errors errors;
  for (int i = 0; i < count; ++i) add_draw(surveyed, draws, errors);
  const auto number = static_cast<double>(errors.angles.size());
  const auto print = [](const char* what, std::vector<double> angles) {
    fmt::print("  {}: median {:.4f}, 95 % {:.4f}, greatest {:.4f} degrees\n", what,
               quantile(angles, 0.5), quantile(angles, 0.95), quantile(angles, 1));
  };
  fmt::print("mountings: {} drives of {} rows, {} without a result; NEES {:.2f}\n", count, kRows,
             errors.failed, errors.nees / number);
  print("error of an attitude on the vehicle", errors.angles);
  print("error between the two cameras", errors.between);
}

// --- suspicion ---

// A way in which what really is differs from what rig and survey say.
struct Mistake {
  std::string name;
  std::function<void(Site&, Draws&)> happens;
  // Empty where the rig is right.
  std::string camera;
  RigParameter parameter = RigParameter::yaw;
};

void turn(Site& site, std::size_t camera, RigParameter parameter, double by) {
  Pose& pose = site.rig.cameras[camera].vehicle_from_camera;
  MountingAngles angles = mounting_angles(pose);
  (parameter == RigParameter::yaw     ? angles.yaw
   : parameter == RigParameter::pitch ? angles.pitch
                                      : angles.roll) += radians(by);
  pose = vehicle_from_camera(angles.yaw, angles.pitch, angles.roll, pose.translation);
}

void shift(Site& site, std::size_t camera, double by, Draws& draws) {
  site.rig.cameras[camera].vehicle_from_camera.translation += by * draws.normals(1).normalized();
}

void turn_plates(Site& site, RigParameter how) {
  site.survey = with_turned_plates(std::move(site.survey), how, radians(2));
}

// The survey as it is has the positions of this point.
void move_plates(Site& site, const MeasuredPoint& point) {
  site.survey = with_plates_measured_at(std::move(site.survey), point);
}

void zoom(Site& site, std::size_t camera, double factor) {
  site.rig.cameras[camera].camera.fx *= factor;
  site.rig.cameras[camera].camera.fy *= factor;
}

std::vector<Mistake> mistakes() {
  return {
      {"rig and survey right", [](Site&, Draws&) {}, ""},
      {"a plate 20 to 150 mm off",
       [](Site& site, Draws& draws) {
         const std::size_t plate = draws.index(site.survey.tags.size());
         site.survey.tags[plate].world_from_plate.translation +=
             draws.uniform(0.02, 0.15) * draws.normals(1).normalized();
       },
       ""},
      {"left yaw off by 1 degree", [](Site& site, Draws&) { turn(site, 0, RigParameter::yaw, 1); },
       "left"},
      {"right pitch off by 1 degree",
       [](Site& site, Draws&) { turn(site, 1, RigParameter::pitch, 1); }, "right",
       RigParameter::pitch},
      {"left roll off by 1 degree",
       [](Site& site, Draws&) { turn(site, 0, RigParameter::roll, 1); }, "left",
       RigParameter::roll},
      {"right focal length off by 2 %", [](Site& site, Draws&) { zoom(site, 1, 1.02); }, "right",
       RigParameter::focal},
      {"left camera 3 cm elsewhere", [](Site& site, Draws& draws) { shift(site, 0, 0.03, draws); },
       "left", RigParameter::position},
      {"right camera 6 cm elsewhere", [](Site& site, Draws& draws) { shift(site, 1, 0.06, draws); },
       "right", RigParameter::position},
      {"all lenses bend by 1 % at the corners",
       [](Site& site, Draws&) {
         for (RigCamera& camera : site.rig.cameras) camera.camera.distortion[0] = -0.04;
       },
       "", RigParameter::distortion},
      {"plates along a slope of 2 degrees",
       [](Site& site, Draws&) { turn_plates(site, RigParameter::plate_slope); }, "",
       RigParameter::plate_slope},
      {"both walls lean by 2 degrees",
       [](Site& site, Draws&) { turn_plates(site, RigParameter::plate_tilt); }, "",
       RigParameter::plate_tilt},
      {"left wall leans by 2 degrees",
       [](Site& site, Draws&) { turn_plates(site, RigParameter::left_plate_tilt); }, "",
       RigParameter::left_plate_tilt},
      {"plates surveyed at the plate's corner",
       [](Site& site, Draws&) {
         move_plates(site, points_besides_p(site.survey.tag_template).back());
       },
       "", RigParameter::plate_point}};
}

void print_suspicion(const Site& surveyed, const Mistake& mistake, int count, std::uint64_t seed) {
  Draws draws(seed);
  int told = 0;
  int named = 0;
  for (int i = 0; i < count; ++i) {
    Site site = hung(surveyed, draws);
    mistake.happens(site, draws);
    const auto rows = rows_of(site, surveyed.survey, draws, true);
    const auto suspicion = suspect_rig(rows, surveyed.survey, surveyed.rig);
    if (!suspicion) continue;
    ++told;
    const bool right = std::ranges::any_of(suspicion->suspects, [&](const RigSuspect& suspect) {
      return suspect.camera == mistake.camera && suspect.parameter == mistake.parameter;
    });
    if (right) ++named;
  }
  fmt::print("{:<32} {:>6.1f} % told, {:>6.1f} % with the right value among the named\n",
             mistake.name, 100.0 * told / count, 100.0 * named / count);
}

}  // namespace
}  // namespace tagsmith::detail::test

int main(int argc, char** argv) {
  using namespace tagsmith::detail;
  using namespace tagsmith::detail::test;
  const int count = argc > 1 ? std::atoi(argv[1]) : 200;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  print_mountings(count, seed);
  Site surveyed = surveyed_corridor();
  for (const Mistake& mistake : mistakes()) print_suspicion(surveyed, mistake, count, seed + 1);
  for (RigCamera& camera : surveyed.rig.cameras) {
    camera.calibration_sigma.position = 0.005;
    camera.calibration_sigma.angle = radians(0.3);
    camera.calibration_sigma.focal = 0.003;
  }
  const Mistake none{"cameras as unsure as the rig says",
                     [](Site& site, Draws& draws) { site.rig = disturbed(site.rig, draws); }, ""};
  print_suspicion(surveyed, none, count, seed + 1);
  return 0;
}
