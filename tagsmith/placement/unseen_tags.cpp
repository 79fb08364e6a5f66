// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/unseen_tags.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/placement/floor_and_roof.hpp"
#include "tagsmith/placement/sight.hpp"

namespace tagsmith {
namespace {

constexpr double kStep = 0.25;   // metres between two places of the vehicle
constexpr double kBlock = 10.0;  // metres of drive that share one set of walls

// How the vehicle stands at a chainage; the nominal way first, since most tags are seen from it.
std::vector<VehiclePose> strays(const VehicleEnvelope& envelope) {
  const auto edges = [](double most) {
    return most > 0 ? std::vector<double>{0, -most, most} : std::vector<double>{0};
  };
  std::vector<VehiclePose> all;
  for (const double roll : edges(envelope.roll)) {
    for (const double pitch : edges(envelope.pitch)) {
      for (const double yaw : edges(envelope.yaw)) {
        for (const double lateral : edges(envelope.lateral)) {
          VehiclePose stray;
          stray.position.x() = lateral;  // to the right
          stray.heading = yaw;
          stray.pitch = pitch;
          stray.roll = roll;
          all.push_back(stray);
        }
      }
    }
  }
  return all;
}

VehiclePose strayed(const CenterlinePoint& point, double vehicle_height, const VehiclePose& stray) {
  VehiclePose pose = stray;
  pose.position = point.position + stray.position.x() * right_of(point.heading) +
                  vehicle_height * Eigen::Vector3d::UnitZ();
  pose.heading = point.heading + stray.heading;
  return pose;
}

class Search {
 public:
  Search(const Survey& survey, const Rig& rig)
      : survey_(survey),
        rig_(rig),
        model_(survey, rig),
        envelope_(rig.envelope.value_or(VehicleEnvelope{})),
        strays_(strays(envelope_)) {
    for (const RigCamera& camera : rig.cameras) {
      arm_ = std::max(arm_, camera.vehicle_from_camera.translation.norm());
    }
  }

  bool sees(std::size_t tag) {
    const double chainage = survey_.tags[tag].chainage;
    const double reach = model_.reach() + envelope_.lateral + arm_;
    const int steps = static_cast<int>(std::ceil(reach / kStep));
    // Outwards from the tag: what is seen at all is mostly seen from near by.
    for (int i = 0; i <= steps; ++i) {
      for (const double side : {-1.0, 1.0}) {
        if (sees_from(tag, chainage + side * i * kStep)) return true;
        if (i == 0) break;
      }
    }
    return false;
  }

 private:
  bool sees_from(std::size_t tag, double chainage) {
    const CenterlinePoint point = survey_.tunnel.centerline.at(chainage);
    const Pose nominal = world_from_vehicle(strayed(point, rig_.vehicle_height, {}));
    const double turn = std::hypot(envelope_.yaw, envelope_.roll, envelope_.pitch);
    const double slack = envelope_.lateral + turn * arm_ + 1e-3;
    for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      const CameraStand stand = model_.stand(camera, nominal, point.curvature);
      if (!model_.may_see(camera, stand, tag, slack, turn)) continue;
      for (const VehiclePose& stray : strays_) {
        const Pose pose = world_from_vehicle(strayed(point, rig_.vehicle_height, stray));
        const auto sight =
            model_.look(camera, model_.stand(camera, pose, point.curvature), tag, around(chainage));
        if (sight && sight->travel_book >= 0) return true;
      }
    }
    return false;
  }

  // What may stand in the way within a block of the drive.
  struct Room {
    std::unique_ptr<TunnelWalls> walls;  // null where they hide nothing
    FloorAndRoof floor_and_roof;
  };

  // What may stand in the way near this chainage. Rooms of the blocks behind are given up, so that
  // a long drive takes no more memory than a short one.
  Surroundings around(double chainage) {
    const Room& room = room_at(chainage);
    return {room.walls.get(), room.floor_and_roof.is_even() ? nullptr : &room.floor_and_roof};
  }

  const Room& room_at(double chainage) {
    const int block = static_cast<int>(std::floor(chainage / kBlock));
    const auto known = rooms_.find(block);
    if (known != rooms_.end()) return known->second;
    constexpr std::size_t kMostKept = 64;
    if (rooms_.size() >= kMostKept) rooms_.clear();
    const double middle = (block + 0.5) * kBlock;
    const double reach = model_.reach() + kBlock;
    std::unique_ptr<TunnelWalls> made;
    if (model_.may_be_hidden_between(middle - reach, middle + reach)) {
      const double standoff = model_.standoff_between(middle - reach, middle + reach);
      made = std::make_unique<TunnelWalls>(survey_.tunnel, standoff, middle, reach);
    }
    Room room{std::move(made), FloorAndRoof(survey_.tunnel, middle, reach)};
    return rooms_.emplace(block, std::move(room)).first->second;
  }

  const Survey& survey_;
  const Rig& rig_;
  SightModel model_;
  VehicleEnvelope envelope_;
  std::vector<VehiclePose> strays_;
  double arm_ = 0;
  std::map<int, Room> rooms_;
};

}  // namespace

std::vector<std::size_t> unseen_tags(const Survey& survey, const Rig& rig) {
  std::vector<std::size_t> unseen;
  if (survey.tags.empty()) return unseen;
  Search search(survey, rig);
  std::vector<std::size_t> along(survey.tags.size());
  for (std::size_t i = 0; i < along.size(); ++i) along[i] = i;
  std::ranges::stable_sort(along, {}, [&](std::size_t i) { return survey.tags[i].chainage; });
  for (const std::size_t i : along) {
    if (!search.sees(i)) unseen.push_back(i);
  }
  std::ranges::sort(unseen);
  return unseen;
}

}  // namespace tagsmith
