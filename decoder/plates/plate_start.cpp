// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_start.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace tagsmith::detail {
namespace {

constexpr double kMostMismatch = 0.25;  // frame diagonals; beyond, a start is no worse

SightedPlate at(SightedPlate plate, const Pose& world_from_plate) {
  plate.world_from_plate = world_from_plate;
  return plate;
}

// The corners' distance from where they are seen, root mean square, in diagonals of the frame.
double mismatch_from(const Rig& rig, const SightedPlate& plate, const Sighting& sighting,
                     const VehiclePose& vehicle) {
  const auto rows = sighting_rows(rig, calibration_layout(rig), {}, vehicle_frame(vehicle), plate,
                                  sighting.camera);
  if (!rows) return std::numeric_limits<double>::infinity();
  const double diagonal = (sighting.pixels.segment<2>(4) - sighting.pixels.segment<2>(0)).norm();
  return (rows->predicted - sighting.pixels).norm() / (2 * diagonal);
}

// The vehicle's pose that most of the plates with a known pose agree with.
std::optional<VehiclePose> start_vehicle(const AdjustmentProblem& problem, const Station& station,
                                         const std::vector<std::optional<Pose>>& known) {
  std::optional<VehiclePose> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Sighting& sighting : station.sightings) {
    if (!known[sighting.plate]) continue;
    const auto poses = vehicle_poses_from(
        *problem.rig, at(problem.plates[sighting.plate], *known[sighting.plate]), sighting);
    if (!poses) continue;
    for (const VehiclePose& pose : *poses) {
      double cost = 0;
      for (const Sighting& other : station.sightings) {
        if (!known[other.plate]) continue;
        const double apart = mismatch_from(
            *problem.rig, at(problem.plates[other.plate], *known[other.plate]), other, pose);
        cost += std::min(apart * apart, kMostMismatch * kMostMismatch);
      }
      if (cost >= least) continue;
      least = cost;
      best = pose;
    }
  }
  return best;
}

// The place of a plate by the sightings from placed vehicles.
std::optional<Pose> start_plate(const AdjustmentProblem& problem, std::size_t plate,
                                const std::vector<std::optional<VehiclePose>>& vehicles) {
  std::vector<std::pair<const Sighting*, VehiclePose>> seen;
  for (std::size_t s = 0; s < problem.stations.size(); ++s) {
    if (!vehicles[s]) continue;
    for (const Sighting& sighting : problem.stations[s].sightings) {
      if (sighting.plate == plate) seen.emplace_back(&sighting, *vehicles[s]);
    }
  }
  std::optional<Pose> best;
  double least = std::numeric_limits<double>::infinity();
  const SightedPlate at_origin = at(problem.plates[plate], Pose{});
  for (const auto& [sighting, vehicle] : seen) {
    const auto plate_from_vehicle = vehicle_poses_from(*problem.rig, at_origin, *sighting);
    if (!plate_from_vehicle) continue;
    for (const VehiclePose& in_plate : *plate_from_vehicle) {
      const Pose pose = world_from_vehicle(vehicle) * inverse(world_from_vehicle(in_plate));
      double cost = 0;
      for (const auto& [other, from] : seen) {
        const double apart = mismatch_from(*problem.rig, at(at_origin, pose), *other, from);
        cost += std::min(apart * apart, kMostMismatch * kMostMismatch);
      }
      if (cost >= least) continue;
      least = cost;
      best = pose;
    }
  }
  return best;
}

}  // namespace

bool hangs_anywhere(PlateFreedom freedom) {
  return freedom == PlateFreedom::place || freedom == PlateFreedom::any;
}

AdjustmentStart start_of(const AdjustmentProblem& problem, const std::vector<PlateFreedom>& freed) {
  std::vector<std::optional<Pose>> plates(problem.plates.size());
  for (std::size_t i = 0; i < plates.size(); ++i) {
    if (!hangs_anywhere(freed[i])) plates[i] = problem.plates[i].world_from_plate;
  }
  AdjustmentStart start;
  start.vehicles.resize(problem.stations.size());
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t s = 0; s < start.vehicles.size(); ++s) {
      if (start.vehicles[s]) continue;
      start.vehicles[s] = start_vehicle(problem, problem.stations[s], plates);
      changed = changed || start.vehicles[s];
    }
    for (std::size_t i = 0; i < plates.size(); ++i) {
      if (plates[i]) continue;
      plates[i] = start_plate(problem, i, start.vehicles);
      changed = changed || plates[i];
    }
  }
  for (std::size_t i = 0; i < plates.size(); ++i) {
    start.world_from_plate.push_back(plates[i].value_or(problem.plates[i].world_from_plate));
  }
  return start;
}

double mismatch(const AdjustmentProblem& problem, const Sighting& a, const Sighting& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto poses = vehicle_poses_from(*problem.rig, problem.plates[a.plate], a);
  if (!poses) return least;
  for (const VehiclePose& pose : *poses) {
    least = std::min(least, mismatch_from(*problem.rig, problem.plates[b.plate], b, pose));
  }
  return least;
}

}  // namespace tagsmith::detail
