// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/drive_plan.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Stretches of the drive that share one list of plates that may be seen.
constexpr double kBlockLength = 0.25;  // metres
constexpr std::size_t kMostInBlock = 256;

// How the vehicle stands in one attitude: in the middle of the drive, and wherever it may stray
// across. All of these share the list of candidates.
struct Attitude {
  FloorStance middle;
  std::vector<FloorStance> strays;
};

bool is_nominal(const FloorStance& stance) {
  return stance.lateral == 0 && stance.yaw == 0 && stance.roll == 0 && stance.pitch == 0;
}

// `count` values from -most to most, 0 among them.
std::vector<double> spread(double most, int count) {
  if (most == 0 || count == 1) return {0};
  std::vector<double> values;
  const int half = count / 2;
  for (int i = -half; i <= half; ++i) values.push_back(most * i / half);
  return values;
}

std::vector<Attitude> attitudes(const Rig& rig, const PlanOptions& options) {
  const VehicleEnvelope envelope = rig.envelope.value_or(VehicleEnvelope{});
  std::vector<std::pair<double, double>> tilts{{0, 0}};  // roll, pitch
  for (const double side : {-1.0, 1.0}) {
    if (envelope.roll > 0) tilts.emplace_back(side * envelope.roll, 0);
    if (envelope.pitch > 0) tilts.emplace_back(0, side * envelope.pitch);
  }
  std::vector<Attitude> all;
  for (const double yaw : spread(envelope.yaw, options.headings)) {
    for (const auto& [roll, pitch] : tilts) {
      Attitude attitude{{rig.vehicle_height, 0, yaw, pitch, roll}, {}};
      for (const double lateral : spread(envelope.lateral, options.lateral_offsets)) {
        attitude.strays.push_back({rig.vehicle_height, lateral, yaw, pitch, roll});
      }
      all.push_back(std::move(attitude));
    }
  }
  return all;
}

// How far apart the angles of the floor's slopes are over a stretch.
double slope_range(const Centerline& line, double low, double high) {
  double least = line.at(low).grade;
  double most = least;
  double start = 0;
  for (const CenterlineElement& element : line.elements()) {
    if (start <= high && start + element.length >= low) {
      least = std::min(least, element.grade);
      most = std::max(most, element.grade);
    }
    start += element.length;
  }
  return std::atan(most) - std::atan(least);
}

ColumnSigma sigmas_along(const Eigen::Matrix3d& covariance, double heading) {
  const Vector3d along = direction_of(heading);
  const Vector3d across = right_of(heading);
  ColumnSigma sigma;
  sigma.along = std::sqrt(along.dot(covariance * along));
  sigma.across = std::sqrt(across.dot(covariance * across));
  sigma.plane = std::hypot(sigma.along, sigma.across);
  sigma.height = std::sqrt(covariance(2, 2));
  return sigma;
}

ColumnSigma sigmas_along(const VehicleCovariance& covariance, double heading) {
  ColumnSigma sigma = sigmas_along(Eigen::Matrix3d(covariance.topLeftCorner<3, 3>()), heading);
  sigma.heading = std::sqrt(covariance(vehicle_parameter::kHeading, vehicle_parameter::kHeading));
  return sigma;
}

// Adopts every greater value; infinite values, which mean no position, are left out.
void raise(ColumnSigma& most, const ColumnSigma& sigma) {
  if (!std::isfinite(sigma.plane)) return;
  for (const auto part : {&ColumnSigma::plane, &ColumnSigma::along, &ColumnSigma::across,
                          &ColumnSigma::height, &ColumnSigma::heading}) {
    double& value = most.*part;
    if (!std::isfinite(value) || sigma.*part > value) value = sigma.*part;
  }
}

// Tags that a pose reads, by wall.
struct Walls {
  bool left = false;
  bool right = false;

  void add(Side side) { (side == Side::left ? left : right) = true; }
  void count(WallCount& counts) const {
    counts.both += left && right ? 1 : 0;
    counts.one += left != right ? 1 : 0;
  }
};

// A worker's own buffers, reused from pose to pose so that no pose needs an allocation.
struct Scratch {
  std::vector<std::vector<std::size_t>> candidates;  // by attitude and camera
  std::vector<PlateSight> sights;
  std::vector<PlateSight> read;
  std::vector<PlateSight> kept;  // of `read`, without a tag that is lost
  std::vector<std::size_t> read_tags;
  LogHistogram travels;
  LogHistogram speeds;
};

// The contribution of one block to the plan.
struct BlockResult {
  std::vector<SoleTag> sole_tags;
  std::vector<std::pair<std::size_t, TagUse>> uses;
};

class Sweep {
 public:
  Sweep(const Survey& survey, const Rig& rig, const PlanOptions& options, DrivePlan& plan)
      : survey_(survey),
        rig_(rig),
        options_(options),
        plan_(plan),
        model_(survey, rig),
        attitudes_(attitudes(rig, options)),
        accuracy_{options.corner_sigma_px, plan.speed} {
    for (const RigCamera& camera : rig.cameras) {
      moved_.push_back(plan.speed * camera.exposure.value_or(0));
    }
    for (const Attitude& attitude : attitudes_) {
      plan.poses_per_column += static_cast<int>(attitude.strays.size());
    }
  }

  // Columns [begin, end) of the plan.
  BlockResult run(std::size_t begin, std::size_t end, Scratch& scratch) const {
    BlockResult result;
    const double first = plan_.columns[begin].chainage;
    const double last = plan_.columns[end - 1].chainage;
    gather_candidates(first, last, scratch);
    const Surroundings around = model_.surroundings(first, last);
    for (std::size_t i = begin; i < end; ++i) assess(i, around, scratch, result);
    return result;
  }

 private:
  void gather_candidates(double first, double last, Scratch& scratch) const {
    const CenterlinePoint middle = survey_.tunnel.centerline.at((first + last) / 2);
    const CenterlinePoint start = survey_.tunnel.centerline.at(first);
    const CenterlinePoint end = survey_.tunnel.centerline.at(last);
    const double turn =
        std::max(std::abs(start.heading - middle.heading), std::abs(end.heading - middle.heading)) +
        slope_range(survey_.tunnel.centerline, first, last);
    const double half = std::max((start.position - middle.position).norm(),
                                 (end.position - middle.position).norm());
    const double lateral = rig_.envelope ? rig_.envelope->lateral : 0;
    const double slack = std::hypot(half, lateral) + turn * arm_length(rig_);
    const double reach = model_.reach() + arm_length(rig_) + slack;
    const std::span<const std::size_t> near = model_.tags_between(first - reach, last + reach);
    scratch.candidates.resize(attitudes_.size() * rig_.cameras.size());
    std::size_t list = 0;
    for (const Attitude& attitude : attitudes_) {
      const Pose pose = world_from_vehicle(vehicle_on_floor(middle, attitude.middle));
      for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera, ++list) {
        const CameraStand stand = model_.stand(camera, pose, middle.curvature);
        scratch.candidates[list].clear();
        std::ranges::copy_if(
            near, std::back_inserter(scratch.candidates[list]),
            [&](std::size_t tag) { return model_.may_see(camera, stand, tag, slack, turn); });
      }
    }
  }

  void assess(std::size_t index, const Surroundings& around, Scratch& scratch,
              BlockResult& result) const {
    PlanColumn& column = plan_.columns[index];
    const CenterlinePoint point = survey_.tunnel.centerline.at(column.chainage);
    column.least_tags = std::numeric_limits<int>::max();
    const std::size_t first_sole = result.sole_tags.size();
    for (std::size_t a = 0; a < attitudes_.size(); ++a) {
      for (const FloorStance& stance : attitudes_[a].strays) {
        const VehiclePose pose = vehicle_on_floor(point, stance);
        const VehicleFrame vehicle = vehicle_frame(pose);
        look(vehicle.world_from_vehicle, point.curvature, a, around, scratch);
        count_sights(column, scratch);
        if (is_confirmed(vehicle.world_from_vehicle, point.curvature, a, around, scratch)) {
          ++column.confirmed;
        }
        note_sole_tag(index, first_sole, scratch, result);
        if (is_nominal(stance)) note_uses(column.chainage, scratch, result);
        if (options_.accuracy) expect(column, point, pose, vehicle, is_nominal(stance), scratch);
      }
    }
  }

  // All that the pose sees into scratch.sights, what it reads at the planned speed into
  // scratch.read, and those tags, each once, into scratch.read_tags.
  void look(const Pose& vehicle, double curvature, std::size_t attitude, const Surroundings& around,
            Scratch& scratch) const {
    scratch.sights.clear();
    scratch.read.clear();
    scratch.read_tags.clear();
    for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      const auto& candidates = scratch.candidates[attitude * rig_.cameras.size() + camera];
      if (candidates.empty()) continue;
      const CameraStand stand = model_.stand(camera, vehicle, curvature);
      for (const std::size_t tag : candidates) {
        const std::optional<PlateSight> sight = model_.look(camera, stand, tag, around);
        if (!sight) continue;
        scratch.sights.push_back(*sight);
        if (sight->travel_book < moved_[camera]) continue;
        scratch.read.push_back(*sight);
        if (std::ranges::find(scratch.read_tags, tag) == scratch.read_tags.end()) {
          scratch.read_tags.push_back(tag);
        }
      }
    }
  }

  // Whether another tag, whole or in part, confirms the position by a tag that was read.
  bool is_confirmed(const Pose& vehicle, double curvature, std::size_t attitude,
                    const Surroundings& around, const Scratch& scratch) const {
    if (scratch.read_tags.size() != 1) return scratch.read_tags.size() > 1;
    for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      const auto& candidates = scratch.candidates[attitude * rig_.cameras.size() + camera];
      if (candidates.empty()) continue;
      const CameraStand stand = model_.stand(camera, vehicle, curvature);
      const auto confirms = [&](std::size_t tag) {
        return tag != scratch.read_tags.front() &&
               model_.shows_part(camera, stand, tag, around, moved_[camera]);
      };
      if (std::ranges::any_of(candidates, confirms)) return true;
    }
    return false;
  }

  void count_sights(PlanColumn& column, Scratch& scratch) const {
    Walls seen;
    Walls plain;
    Walls read;
    double travel = -1;
    double speed = -1;
    for (const PlateSight& sight : scratch.sights) {
      const Side side = survey_.tags[sight.tag].side;
      const double moved = moved_[sight.camera];
      seen.add(side);
      if (sight.travel_plain >= moved) plain.add(side);
      if (sight.travel_book >= moved) read.add(side);
      travel = std::max(travel, sight.travel_book);
      const std::optional<double> exposure = rig_.cameras[sight.camera].exposure;
      if (sight.travel_book >= 0) {
        speed = std::max(speed, exposure ? sight.travel_book / *exposure : kInfinity);
      }
    }
    seen.count(column.seen);
    plain.count(column.read_plain);
    read.count(column.read);
    column.least_tags = std::min(column.least_tags, static_cast<int>(scratch.read_tags.size()));
    if (travel < 0) return;
    column.travel = std::min(column.travel, travel);
    column.speed = std::min(column.speed, speed);
    scratch.travels.add(travel);
    scratch.speeds.add(speed);
  }

  static void note_sole_tag(std::size_t column, std::size_t first, const Scratch& scratch,
                            BlockResult& result) {
    if (scratch.read_tags.size() != 1) return;
    const std::size_t tag = scratch.read_tags.front();
    const auto known = std::span(result.sole_tags).subspan(first);
    if (std::ranges::find(known, tag, &SoleTag::tag) != known.end()) return;
    result.sole_tags.push_back({column, tag});
  }

  static void note_uses(double chainage, const Scratch& scratch, BlockResult& result) {
    for (const PlateSight& sight : scratch.read) {
      const auto known =
          std::ranges::find(result.uses, sight.tag, [](const auto& use) { return use.first; });
      const TagView view{chainage, sight.distance, sight.module_px, std::acos(sight.cosine)};
      if (known == result.uses.end()) {
        result.uses.emplace_back(sight.tag, TagUse{true, view, view});
      } else if (known->second.last.chainage < chainage ||
                 known->second.last.module_px < view.module_px) {
        known->second.last = view;  // of two cameras, the one that sees it larger
      }
    }
  }

  // All information about the pose: its stance, its ranges, and these tags.
  std::optional<VehicleCovariance> covariance(const CenterlinePoint& floor, const VehiclePose& pose,
                                              const VehicleFrame& frame,
                                              std::span<const PlateSight> sights) const {
    return covariance_from(rig_information(survey_, rig_, floor, pose) +
                           sights_information(survey_, rig_, frame, sights, accuracy_));
  }

  void expect(PlanColumn& column, const CenterlinePoint& point, const VehiclePose& pose,
              const VehicleFrame& frame, bool is_nominal, Scratch& scratch) const {
    if (scratch.read.empty()) return;
    const auto known = covariance(point, pose, frame, scratch.read);
    if (!known) return;
    const ColumnSigma sigma = sigmas_along(*known, point.heading);
    raise(column.worst, sigma);
    if (!is_nominal) return;
    column.nominal = sigma;
    column.nominal_one_lost = one_lost(point, pose, frame, scratch);
    expect_paper(column, point, pose, scratch);
  }

  // The plane's sigma when the tag that costs most is lost; infinite when it is the only one.
  double one_lost(const CenterlinePoint& point, const VehiclePose& pose, const VehicleFrame& frame,
                  Scratch& scratch) const {
    if (scratch.read_tags.size() < 2) return kInfinity;
    double most = 0;
    for (const std::size_t lost : scratch.read_tags) {
      scratch.kept.clear();
      std::ranges::copy_if(scratch.read, std::back_inserter(scratch.kept),
                           [&](const PlateSight& sight) { return sight.tag != lost; });
      const auto known = covariance(point, pose, frame, scratch.kept);
      most = std::max(most, known ? sigmas_along(*known, point.heading).plane : kInfinity);
    }
    return most;
  }

  void expect_paper(PlanColumn& column, const CenterlinePoint& point, const VehiclePose& pose,
                    const Scratch& scratch) const {
    if (!options_.paper) return;
    const auto expected = options_.paper(pose, scratch.read, accuracy_);
    if (!expected) return;
    column.paper.sigma = sigmas_along(expected->mean_square, point.heading);
    column.paper.magnification = expected->magnification;
    column.paper.no_solution_share = expected->no_solution_share;
  }

  const Survey& survey_;
  const Rig& rig_;
  const PlanOptions& options_;
  DrivePlan& plan_;
  SightModel model_;
  std::vector<Attitude> attitudes_;
  AccuracyOptions accuracy_;
  std::vector<double> moved_;  // by camera: metres during the exposure at the planned speed
};

// One camera at one place: on the center line, or so far to the right of it.
Result<void> check_camera(const Survey& survey, const Rig& rig, const RigCamera& camera,
                          double chainage, double lateral) {
  const Tunnel& tunnel = survey.tunnel;
  const CenterlinePoint point = tunnel.centerline.at(chainage);
  const VehiclePose pose = vehicle_on_floor(point, {rig.vehicle_height, lateral, 0, 0, 0});
  const Vector3d place = (world_from_vehicle(pose) * camera.vehicle_from_camera).translation;
  // Before and behind the center line the walls are unknown.
  const double at = tunnel.centerline.locate(place.head<2>()).chainage;
  if (at <= 0 || at >= tunnel.centerline.length()) return {};
  const Result<void> inside = check_in_tunnel(tunnel, place);
  if (inside) return {};
  const std::string aside =
      lateral == 0 ? ""
                   : fmt::format(", the vehicle {} m aside", format_number(std::abs(lateral), 3));
  return fail(fmt::format("at chainage {} m of {}{}, camera {} is {}: check its `position`{}",
                          format_number(chainage, 3), survey.file.string(), aside, camera.name,
                          inside.error().message,
                          lateral == 0 ? "" : " and vehicle.envelope.lateral"));
}

}  // namespace

Result<void> check_vehicle(const Survey& survey, const Rig& rig, double from, double to) {
  constexpr double kStep = 0.5;  // metres
  constexpr double kMostPlaces = 20000;
  const double lateral = rig.envelope ? rig.envelope->lateral : 0;
  const double narrowest = least_distance(survey.tunnel);
  if (lateral >= narrowest) {
    return fail(fmt::format(
        "vehicle.envelope.lateral is {} m, expected less than the nearest wall's distance from "
        "the center line of {}, {} m",
        format_number(lateral, 3), survey.file.string(), format_number(narrowest, 3)));
  }
  if (rig.vehicle_height <= 0 || rig.vehicle_height >= survey.tunnel.height.least()) {
    return fail(fmt::format(
        "vehicle.height is {} m, expected between 0 and the height of the tunnel of {}, {} m",
        format_number(rig.vehicle_height, 3), survey.file.string(),
        format_number(survey.tunnel.height.least(), 3)));
  }
  const double first = std::max(from, 0.0);
  const double last = std::min(to, survey.tunnel.centerline.length());
  const double step = std::max(kStep, (last - first) / kMostPlaces);
  const int steps = static_cast<int>(std::floor((last - first) / step));
  for (int i = 0; i <= steps; ++i) {
    const double chainage = first + i * step;
    for (const double aside : {0.0, -lateral, lateral}) {
      for (const RigCamera& camera : rig.cameras) {
        auto checked = check_camera(survey, rig, camera, chainage, aside);
        if (!checked) return checked;
      }
      if (lateral == 0) break;
    }
  }
  return {};
}

namespace {

Result<void> check(const Survey& survey, const Rig& rig, const PlanOptions& options, double from,
                   double to) {
  if (!(to > from)) {
    return fail(fmt::format("the plan ends at chainage {} m, expected more than its start, {} m",
                            format_number(to, 3), format_number(from, 3)));
  }
  const double length = survey.tunnel.centerline.length();
  if (to <= 0 || from >= length) {
    return fail(
        fmt::format("the plan from chainage {} to {} m lies outside of the center line of "
                    "{}, 0 to {} m",
                    format_number(from, 3), format_number(to, 3), survey.file.string(),
                    format_number(length, 3)));
  }
  if (auto checked = check_vehicle(survey, rig, from, to); !checked) {
    return fail(rig.file.string() + ": " + checked.error().message);
  }
  const double columns = (to - from) / options.step;
  if (columns > kMostColumns) {
    return fail(fmt::format(
        "{} m in steps of {} m are {:.0f} places, expected at most {}: take longer steps or a "
        "shorter stretch",
        format_number(to - from, 1), format_number(options.step, 6), columns, kMostColumns));
  }
  return {};
}

// Neighbouring columns that one worker processes together.
std::vector<std::pair<std::size_t, std::size_t>> blocks_of(const DrivePlan& plan) {
  const auto size = static_cast<std::size_t>(
      std::clamp(kBlockLength / plan.options.step, 1.0, static_cast<double>(kMostInBlock)));
  std::vector<std::pair<std::size_t, std::size_t>> blocks;
  for (std::size_t begin = 0; begin < plan.columns.size(); begin += size) {
    blocks.emplace_back(begin, std::min(begin + size, plan.columns.size()));
  }
  return blocks;
}

// Blocks in the order of the drive.
void gather(const std::vector<BlockResult>& results, DrivePlan& plan) {
  for (const BlockResult& result : results) {
    plan.sole_tags.insert(plan.sole_tags.end(), result.sole_tags.begin(), result.sole_tags.end());
    for (const auto& [tag, use] : result.uses) {
      TagUse& known = plan.tags[tag];
      if (!known.is_read) known = use;
      known.last = use.last;
    }
  }
}

}  // namespace

void LogHistogram::add(double value) {
  // 1e-5 to 1e4 in 512 steps of 4 %.
  const double place = (std::log10(std::clamp(value, 1e-5, 1e4)) + 5) / 9 * (kBins - 1);
  ++bins_[static_cast<std::size_t>(place)];
}

void LogHistogram::merge(const LogHistogram& other) {
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
}

long LogHistogram::count() const { return std::accumulate(bins_.begin(), bins_.end(), 0L); }

double LogHistogram::quantile(double share) const {
  const double wanted = share * static_cast<double>(count());
  long sum = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    sum += bins_[i];
    if (static_cast<double>(sum) > wanted) {
      return i + 1 == bins_.size() ? kInfinity
                                   : std::pow(10.0, 9.0 * static_cast<double>(i) / (kBins - 1) - 5);
    }
  }
  return 0;
}

Result<DrivePlan> plan_drive(const Survey& survey, const Rig& rig, const PlanOptions& options) {
  const double from = options.from.value_or(0);
  const double to = options.to.value_or(survey.tunnel.centerline.length());
  if (auto good = check(survey, rig, options, from, to); !good) return fail(good);
  DrivePlan plan;
  plan.options = options;
  plan.speed = options.speed.value_or(usual_speed(rig));
  const auto count = static_cast<std::size_t>(std::floor((to - from) / options.step + 1e-6)) + 1;
  plan.columns.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    plan.columns[i].chainage = from + static_cast<double>(i) * options.step;
  }
  plan.tags.resize(survey.tags.size());
  const Sweep sweep(survey, rig, plan.options, plan);
  const auto blocks = blocks_of(plan);
  std::vector<BlockResult> results(blocks.size());
  const int cores = tbb::info::default_concurrency();  // TBB warns on stderr of more than these
  tbb::task_arena arena(options.jobs > 0 ? std::min(options.jobs, cores) : cores);
  tbb::enumerable_thread_specific<Scratch> scratches;
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size()), [&](const auto& range) {
      Scratch& scratch = scratches.local();
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        results[i] = sweep.run(blocks[i].first, blocks[i].second, scratch);
      }
    });
  });
  gather(results, plan);
  for (const Scratch& scratch : scratches) {
    plan.travels.merge(scratch.travels);
    plan.speeds.merge(scratch.speeds);
  }
  return plan;
}

}  // namespace tagsmith::detail
