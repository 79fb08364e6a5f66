// SPDX-License-Identifier: Apache-2.0
// Errors of position in the shipped corridor. Usage: bench_position_errors [N]
//
// First the sensitivity of both methods, from exact corners at the ten points on: position against
// an error of d, of theta, of the corners. Then N rendered pictures a row for the joint method.
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/paper_method.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/run.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;

namespace {

struct Corridor {
  Survey survey;
  Rig rig;
  Run run;
};

using Random = std::mt19937_64;

double normal(Random& random, double sigma) {
  return sigma * std::normal_distribution<double>()(random);
}

double within(Random& random, double most) {
  return std::uniform_real_distribution<double>(-most, most)(random);
}

struct Sum {
  int asked = 0;
  int located = 0;
  double plane = 0;
  double height = 0;
  double square = 0;  // of the whole error
  double forced = 0;  // variance that the survey alone makes, by the fit's budget

  void add(const Fix& fix, const Vector3d& truth_in_grid) {
    ++asked;
    if (!fix.position_in_grid) return;
    ++located;
    const Vector3d error = *fix.position_in_grid - truth_in_grid;
    plane += error.head<2>().norm();
    height += std::abs(error.z());
    square += error.squaredNorm();
    if (fix.budget) forced += fix.budget->survey.trace();
  }
};

// --- sensitivity ---

// The nearest tag of at least a pixel a module in each camera, seen exactly.
Observation seen_from(const Corridor& corridor, const Pose& vehicle, const Vector3d& truth) {
  const Survey& survey = corridor.survey;
  Observation observation;
  for (const RigCamera& camera : corridor.rig.cameras) {
    const Pose camera_from_world = inverse(vehicle * camera.vehicle_from_camera);
    for (const PlacedTag& tag : survey.tags) {
      Survey one = survey;
      one.tags = {tag};
      const auto expected = expected_tags(one, camera.camera, camera_from_world, 0);
      if (expected.empty()) continue;
      if (distance(expected[0].corners[0], expected[0].corners[1]) < 113) continue;
      SeenCorners corners{expected[0].corners, kFittedCornerSigmaPx};
      corners.covariance *= kFittedCornerSigmaPx * kFittedCornerSigmaPx;
      observation.tags.push_back({camera.name, 0, tag, corners, {}});
    }
  }
  for (const RigRange& range : corridor.rig.ranges) {
    observation.ranges[range.name] =
        distance_to_wall(survey, range.wall, world_from_grid(survey.grid, truth));
  }
  return observation;
}

struct Disturbance {
  const char* name;
  double range = 0;   // metres
  double theta = 0;   // radians
  double corner = 0;  // pixels, standard deviation
};

void add_noise(Observation& observation, const Disturbance& by, Random& random) {
  for (auto& [name, distance] : observation.ranges) distance += by.range;
  if (by.corner == 0) return;
  for (SeenTag& tag : observation.tags) {
    SeenCorners& corners = *tag.seen_corners;
    corners.sigma_px = by.corner;
    corners.covariance = by.corner * by.corner * CornerCovariance::Identity();
    for (PixelPoint& corner : corners.corners) {
      corner = corner + PixelPoint{normal(random, by.corner), normal(random, by.corner)};
    }
  }
}

void print_sensitivity(const Corridor& corridor) {
  constexpr int kDraws = 200;  // of the noise, a point
  const std::vector<Disturbance> disturbances{{"nothing"},
                                              {"d + 5 mm", 0.005},
                                              {"d - 5 mm", -0.005},
                                              {"d - 10 mm", -0.01},
                                              {"d - 20 mm", -0.02},
                                              {"theta + 0.1 deg", 0, radians(0.1)},
                                              {"theta - 0.1 deg", 0, radians(-0.1)},
                                              {"corners 0.03 px", 0, 0, 0.03},
                                              {"corners 0.1 px", 0, 0, 0.1},
                                              {"corners 0.3 px", 0, 0, 0.3}};
  fmt::print(
      "| off by | joint: located | plane, mm | z, mm | paper: located | plane, mm | z, mm |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Disturbance& by : disturbances) {
    Random random(1);
    Sum joint;
    Sum paper;
    Corridor off = corridor;
    if (by.theta != 0) {
      off.survey.series->pair_angle = facing_pair_angle(corridor.survey, 0) + by.theta;
    }
    const std::vector<Survey> surveys{off.survey};
    for (const Measurement& point : corridor.run.measurements) {
      const Vector3d truth = *point.truth_in_grid;
      const Pose vehicle = vehicle_in_tunnel(corridor.survey, truth, std::nullopt);
      const Observation exact = seen_from(corridor, vehicle, truth);
      for (int draw = 0; draw < (by.corner > 0 ? kDraws : 1); ++draw) {
        Observation seen = exact;
        add_noise(seen, by, random);
        joint.add(localize_jointly(seen, surveys, corridor.rig), truth);
        paper.add(localize_by_paper(seen, surveys, corridor.rig), truth);
      }
    }
    const auto row = [](const Sum& sum) {
      const double n = std::max(1, sum.located);
      return fmt::format("{:.0f} % | {:.2f} | {:.2f}", 100.0 * sum.located / sum.asked,
                         1000 * sum.plane / n, 1000 * sum.height / n);
    };
    fmt::print("| {} | {} | {} |\n", by.name, row(joint), row(paper));
  }
}

// --- pictures ---

struct Kind {
  const char* name;
  double heading = 0;       // radians to either side
  double lean = 0;          // of pitch and roll, likewise
  double survey_sigma = 0;  // metres, of each plate
  double noise = 1.5;       // grey levels
  double light = 1;         // of the usual exposure
  bool one_camera = false;  // the left one, and no range
};

void disturb(Survey& survey, double sigma, Random& random) {
  for (PlacedTag& tag : survey.tags) {
    tag.world_from_plate.translation +=
        Vector3d(normal(random, sigma), normal(random, sigma), normal(random, sigma));
  }
}

Fix locate_by_pictures(const Corridor& corridor, const Survey& hung, const Kind& kind,
                       const VehiclePose& vehicle, std::uint64_t seed) {
  ViewOptions options;
  options.lighting = tunnel_lighting();
  options.sensor.noise_sigma = kind.noise;
  options.sensor.exposure = kind.light;
  options.seed = seed;
  const ReaderChoice reader{read_tags, kFittedCornerSigmaPx};
  const std::vector<Survey> surveys{corridor.survey};
  Observation seen;
  for (const RigCamera& camera : corridor.rig.cameras) {
    if (kind.one_camera && camera.side != Side::left) continue;
    const SurveyView view =
        render_survey_view(hung, camera, world_from_vehicle(vehicle), options, 1);
    observe_image(seen, camera, view.view.image.view(), camera.name, surveys, reader);
  }
  for (const RigRange& range : corridor.rig.ranges) {
    if (kind.one_camera) continue;
    const auto distance = measured_range(hung, range, vehicle.position, seed);
    if (distance) seen.ranges[range.name] = *distance;
  }
  return localize_jointly(seen, surveys, corridor.rig);
}

void print_pictures(const Corridor& exact, int count) {
  const double turned = radians(8);
  const double leaning = radians(2);
  const std::vector<Kind> kinds{
      {"level, two cameras and d"},
      {"heading within 8 deg, pitch and roll within 2", turned, leaning},
      {"one camera, no d", 0, 0, 0, 1.5, 1, true},
      {"leaning, dark and noisy, survey sigma 2 mm, d 1 cm", turned, leaning, 0.002, 6, 0.3}};
  fmt::print(
      "\n| pictures | located | mean plane, mm | mean z, mm | root mean square, mm | that the "
      "survey forces, mm |\n|---|---|---|---|---|---|\n");
  for (const Kind& kind : kinds) {
    Random random(7);
    Sum sum;
    Corridor corridor = exact;
    for (PlacedTag& tag : corridor.survey.tags) tag.sigma = kind.survey_sigma;
    for (int i = 0; i < count; ++i) {
      const auto& points = corridor.run.measurements;
      const Vector3d truth = *points[static_cast<std::size_t>(i) % points.size()].truth_in_grid;
      Survey hung = corridor.survey;
      disturb(hung, kind.survey_sigma, random);
      VehiclePose vehicle =
          vehicle_pose_of(vehicle_in_tunnel(corridor.survey, truth, std::nullopt));
      vehicle.heading += within(random, kind.heading);
      vehicle.pitch += within(random, kind.lean);
      vehicle.roll += within(random, kind.lean);
      const auto seed = static_cast<std::uint64_t>(i);
      sum.add(locate_by_pictures(corridor, hung, kind, vehicle, seed), truth);
    }
    const double n = std::max(1, sum.located);
    fmt::print("| {} | {} of {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", kind.name, sum.located,
               sum.asked, 1000 * sum.plane / n, 1000 * sum.height / n,
               1000 * std::sqrt(sum.square / n), 1000 * std::sqrt(sum.forced / n));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 100;
  auto survey = load_survey("surveys/corridor/survey.yaml");
  auto rig = load_rig("surveys/corridor/rig.yaml");
  if (!survey || !rig) return 2;
  auto run = load_run("surveys/corridor/run.csv", *rig);
  if (!run) return 2;
  const Corridor corridor{std::move(*survey), std::move(*rig), std::move(*run)};
  print_sensitivity(corridor);
  print_pictures(corridor, count);
  return 0;
}
