// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/unseen_tags.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/sight.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kStep = 0.25;   // metres between two places of the vehicle
constexpr double kBlock = 10.0;  // metres of drive that share one set of walls

// How the vehicle may stand on the floor; the nominal way first, since most tags are seen from it.
std::vector<FloorStance> stances(const Rig& rig, const VehicleEnvelope& envelope) {
  const auto edges = [](double most) {
    return most > 0 ? std::vector<double>{0, -most, most} : std::vector<double>{0};
  };
  std::vector<FloorStance> all;
  for (const double roll : edges(envelope.roll)) {
    for (const double pitch : edges(envelope.pitch)) {
      for (const double yaw : edges(envelope.yaw)) {
        for (const double lateral : edges(envelope.lateral)) {
          all.push_back({rig.vehicle_height, lateral, yaw, pitch, roll});
        }
      }
    }
  }
  return all;
}

class Search {
 public:
  Search(const Survey& survey, const Rig& rig)
      : survey_(survey),
        rig_(rig),
        model_(survey, rig),
        envelope_(rig.envelope.value_or(VehicleEnvelope{})),
        stances_(stances(rig, envelope_)),
        arm_(arm_length(rig)) {}

  const std::vector<std::size_t>& tags_by_chainage() const { return model_.tags_by_chainage(); }

  bool sees(std::size_t tag) {
    const double chainage = survey_.tags[tag].chainage;
    const double reach = model_.reach() + envelope_.lateral + arm_;
    const int steps = static_cast<int>(std::ceil(reach / kStep));
    // Outwards from the tag: a tag that is seen at all is usually seen from near by.
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
    const auto stand = [&](std::size_t camera, const FloorStance& stance) {
      return model_.stand(camera, world_from_vehicle(vehicle_on_floor(point, stance)),
                          point.curvature);
    };
    const double turn = std::hypot(envelope_.yaw, envelope_.roll, envelope_.pitch);
    const double slack = envelope_.lateral + turn * arm_ + 1e-3;
    for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      if (!model_.may_see(camera, stand(camera, stances_.front()), tag, slack, turn)) continue;
      for (const FloorStance& stance : stances_) {
        const auto sight = model_.look(camera, stand(camera, stance), tag, around(chainage));
        if (sight && sight->travel_book >= 0) return true;
      }
    }
    return false;
  }

  // The surfaces that may hide tags near this chainage. A limited number of them is kept, so that a
  // long drive takes no more memory than a short one.
  const Surroundings& around(double chainage) {
    const int block = static_cast<int>(std::floor(chainage / kBlock));
    const auto known = surroundings_.find(block);
    if (known != surroundings_.end()) return known->second;
    constexpr std::size_t kMostKept = 64;
    if (surroundings_.size() >= kMostKept) surroundings_.clear();
    const double first = block * kBlock;
    return surroundings_.emplace(block, model_.surroundings(first, first + kBlock)).first->second;
  }

  const Survey& survey_;
  const Rig& rig_;
  SightModel model_;
  VehicleEnvelope envelope_;
  std::vector<FloorStance> stances_;
  double arm_ = 0;
  std::map<int, Surroundings> surroundings_;  // by block
};

}  // namespace

std::vector<std::size_t> unseen_tags(const Survey& survey, const Rig& rig) {
  Search search(survey, rig);
  std::vector<std::size_t> unseen;
  std::ranges::copy_if(search.tags_by_chainage(), std::back_inserter(unseen),
                       [&](std::size_t tag) { return !search.sees(tag); });
  std::ranges::sort(unseen);
  return unseen;
}

}  // namespace tagsmith::detail
