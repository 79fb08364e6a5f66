// SPDX-License-Identifier: Apache-2.0
// Does the reader read what the plan says it will? Poses drawn at random over the vehicle's
// envelope are rendered and read, and every plate in a picture is compared with its prediction.
// Usage: bench_plan_agreement [POSES [SURVEY RIG]...]
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/survey/read_survey.hpp"

using namespace tagsmith::detail;

namespace {

// Wider than either paper's vehicle strayed, so that plates are cut and oblique often enough.
constexpr double kStray = 0.25;  // of the tunnel's width, to either side
constexpr double kYaw = 12;      // degrees
constexpr double kTilt = 3;
constexpr double kNoise = 4;  // grey levels, that of the reader's limits
constexpr std::size_t kListed = 25;

struct Comparison {
  int cut = 0;       // by the image's border: the plan does not count on them
  int cut_read = 0;  // of these, read all the same
  int plates = 0;    // all others in view
  int read = 0;
  int agree = 0;        // with the level that 50 % of tags reach
  int promised = 0;     // reliable
  int kept = 0;         // promised and read
  int poses_agree = 0;  // both walls, one or none
  int poses = 0;
  std::vector<std::string> disagreements;
};

VehiclePose random_pose(const Survey& survey, const Rig& rig, std::mt19937_64& random) {
  std::uniform_real_distribution<double> either(-1, 1);
  std::uniform_real_distribution<double> along(0, survey.tunnel.centerline.length());
  const CenterlinePoint point = survey.tunnel.centerline.at(along(random));
  VehiclePose pose;
  pose.position = point.position +
                  kStray * width_at(survey.tunnel, 0) * either(random) * right_of(point.heading) +
                  rig.vehicle_height * Eigen::Vector3d::UnitZ();
  pose.heading = point.heading + radians(kYaw) * either(random);
  pose.pitch = radians(kTilt) * either(random);
  pose.roll = radians(kTilt) * either(random);
  return pose;
}

// Predictions for one camera, by the level of certainty.
std::vector<PlateSight> look(const SightModel& model, std::size_t camera, const Pose& pose) {
  const CameraStand stand = model.stand(camera, pose, 0);
  const double chainage = model.survey().tunnel.centerline.locate(stand.centre.head<2>()).chainage;
  const Surroundings around = model.surroundings(chainage, chainage);
  std::vector<PlateSight> sights;
  for (std::size_t tag = 0; tag < model.survey().tags.size(); ++tag) {
    const auto sight = model.look(camera, stand, tag, around);
    if (sight && sight->travel_book >= 0) sights.push_back(*sight);
  }
  return sights;
}

bool has(const std::vector<PlateSight>& sights, std::size_t tag) {
  return std::ranges::find(sights, tag, &PlateSight::tag) != sights.end();
}

// Where the plate is truly seen.
PlateTruth truth_of(const Survey& survey, const RigCamera& camera, const Pose& pose,
                    std::size_t tag) {
  const Pose camera_from_plate =
      inverse(pose * camera.vehicle_from_camera) * survey.tags[tag].world_from_plate;
  const ScenePlate plate{
      draw_tag(survey.tag_template, survey.tags[tag].digits), camera_from_plate, {}};
  return plate_truths(camera.camera, std::span(&plate, 1)).front();
}

// From the inner corner that comes nearest to the image's border, or lies farthest beyond it.
double border_px(const Camera& camera, const PlateTruth& truth) {
  double border = 1e9;
  for (const auto& corner : truth.corners) {
    if (!corner) return -1e9;
    border = std::min({border, corner->x(), corner->y(), camera.width - 1 - corner->x(),
                       camera.height - 1 - corner->y()});
  }
  return border;
}

std::string describe(const Survey& survey, const RigCamera& camera, const Pose& pose,
                     std::size_t tag, bool predicted, const ReadResult& result) {
  const PlateTruth truth = truth_of(survey, camera, pose, tag);
  std::string reasons;
  for (const Rejection& rejection : result.rejected) reasons += " " + describe(rejection);
  return fmt::format(
      "{} {} {}: predicted {}, was {}; {:.2f} px/module, {:.1f} deg, inner corner {:.1f} px from "
      "the border;{}",
      survey.name, camera.name, survey.tags[tag].name, predicted ? "read" : "not read",
      predicted ? "not read" : "read", truth.module_px, degrees(truth.incidence),
      border_px(camera.camera, truth), reasons);
}

int walls_of(const Survey& survey, const std::vector<std::size_t>& tags) {
  bool left = false;
  bool right = false;
  for (const std::size_t tag : tags) {
    (survey.tags[tag].side == Side::left ? left : right) = true;
  }
  return (left ? 1 : 0) + (right ? 1 : 0);
}

void compare_pose(const SightModel& likely, const SightModel& sure, std::uint64_t seed,
                  Comparison& total, std::mutex& mutex) {
  const Survey& survey = likely.survey();
  std::mt19937_64 random(seed);
  const Pose pose = world_from_vehicle(random_pose(survey, likely.rig(), random));
  Comparison own;
  std::vector<std::size_t> predicted_tags;
  std::vector<std::size_t> read_tags_of_pose;
  for (std::size_t c = 0; c < likely.rig().cameras.size(); ++c) {
    const RigCamera& camera = likely.rig().cameras[c];
    ViewOptions options;
    options.lighting = tunnel_lighting();
    options.sensor.blur_sigma_px = camera.blur_px.value_or(kUsualBlurPx);
    options.sensor.noise_sigma = kNoise;
    options.seed = seed * 16 + c;
    const SurveyView view = render_survey_view(survey, camera, pose, options, 7);
    const ReadResult result =
        read_tags(view.view.image.view(), read_options_for(std::vector<Survey>{survey}));
    const auto expected = look(likely, c, pose);
    const auto promised = look(sure, c, pose);
    for (const std::size_t tag : view.tags) {
      const bool read = std::ranges::any_of(result.tags, [&](const Reading& reading) {
        return reading.digits == survey.tags[tag].digits;
      });
      if (border_px(camera.camera, truth_of(survey, camera, pose, tag)) < kBorderPx) {
        ++own.cut;
        own.cut_read += read ? 1 : 0;
        continue;
      }
      const bool predicted = has(expected, tag);
      ++own.plates;
      own.read += read ? 1 : 0;
      own.agree += read == predicted ? 1 : 0;
      own.promised += has(promised, tag) ? 1 : 0;
      own.kept += has(promised, tag) && read ? 1 : 0;
      if (read) read_tags_of_pose.push_back(tag);
      if (predicted) predicted_tags.push_back(tag);
      if (read != predicted) {
        own.disagreements.push_back(describe(survey, camera, pose, tag, predicted, result));
      }
    }
  }
  const std::lock_guard lock(mutex);
  ++total.poses;
  total.poses_agree +=
      walls_of(survey, predicted_tags) == walls_of(survey, read_tags_of_pose) ? 1 : 0;
  total.cut += own.cut;
  total.cut_read += own.cut_read;
  total.plates += own.plates;
  total.read += own.read;
  total.agree += own.agree;
  total.promised += own.promised;
  total.kept += own.kept;
  total.disagreements.insert(total.disagreements.end(), own.disagreements.begin(),
                             own.disagreements.end());
}

int compare(const std::string& survey_file, const std::string& rig_file, int poses,
            std::vector<std::string>& disagreements) {
  const Result<Survey> survey = load_survey(survey_file);
  const Result<Rig> rig = load_rig(rig_file);
  if (!survey || !rig) {
    fmt::print(stderr, "{}\n", (survey ? rig.error() : survey.error()).message);
    return 2;
  }
  const SightModel likely(*survey, *rig, ReadShare::half);
  const SightModel sure(*survey, *rig, ReadShare::reliable);
  Comparison total;
  std::mutex mutex;
  tbb::parallel_for(0, poses, [&](int pose) {
    compare_pose(likely, sure, static_cast<std::uint64_t>(1000 + pose), total, mutex);
  });
  fmt::print("| {} | {} | {} | {} | {:.2f} % | {} of {} | {:.2f} % | {} of {} |\n", survey->name,
             poses, total.plates, total.read, 100.0 * total.agree / std::max(1, total.plates),
             total.kept, total.promised, 100.0 * total.poses_agree / std::max(1, total.poses),
             total.cut_read, total.cut);
  std::fflush(stdout);
  disagreements.insert(disagreements.end(), total.disagreements.begin(), total.disagreements.end());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int poses = argc > 1 ? std::atoi(argv[1]) : 300;
  std::vector<std::string> files(argv + std::min(argc, 2), argv + argc);
  if (poses < 1 || files.size() % 2 != 0) {
    fmt::print(stderr, "usage: bench_plan_agreement [POSES [SURVEY RIG]...]\n");
    return 2;
  }
  if (files.empty()) {
    files = {"surveys/corridor/survey.yaml", "surveys/corridor/rig.yaml",
             "surveys/curved/survey.yaml", "surveys/curved/rig.yaml"};
  }
  fmt::print(
      "| survey | poses | plates in view | read | as predicted | promised and read | walls as "
      "predicted | cut by the border, read |\n|---|---|---|---|---|---|---|---|\n");
  std::vector<std::string> disagreements;
  for (std::size_t i = 0; i + 1 < files.size(); i += 2) {
    if (const int failed = compare(files[i], files[i + 1], poses, disagreements)) return failed;
  }
  std::ranges::sort(disagreements);
  fmt::print("\ndisagreements: {}\n", disagreements.size());
  for (std::size_t i = 0; i < std::min(kListed, disagreements.size()); ++i) {
    fmt::print("- {}\n", disagreements[i]);
  }
  return 0;
}
