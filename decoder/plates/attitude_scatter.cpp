// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/attitude_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// What the pictures of two plates of one station show of their turn against each other: for each
// plate the one or two poses that a plane's picture allows.
struct TurnOfPair {
  struct Possible {
    Vector3d turn;
    Matrix3d covariance;  // of the corners' noise alone
    double likelihood = 1;
  };
  std::vector<Possible> possible;
  double weight = 1;  // all pairs of a plate together count as one plate
};

struct SeenAttitude {
  std::size_t plate = 0;
  std::size_t camera = 0;
  std::vector<SinglePose> poses;
};

std::vector<SeenAttitude> attitudes_of(const AdjustmentProblem& problem, const Station& station) {
  std::vector<SeenAttitude> attitudes;
  for (const Sighting& sighting : station.sightings) {
    std::vector<SinglePose> poses = single_poses(problem, sighting);
    if (!poses.empty()) attitudes.push_back({sighting.plate, sighting.camera, std::move(poses)});
  }
  return attitudes;
}

std::vector<TurnOfPair::Possible> turns_between(const SeenAttitude& a, const SeenAttitude& b) {
  std::vector<TurnOfPair::Possible> possible;
  for (const SinglePose& from_a : a.poses) {
    for (const SinglePose& from_b : b.poses) {
      const Eigen::AngleAxisd turn(world_from_vehicle(from_a.vehicle).rotation.transpose() *
                                   world_from_vehicle(from_b.vehicle).rotation);
      const double worse =
          from_a.chi_square - a.poses[0].chi_square + from_b.chi_square - b.poses[0].chi_square;
      possible.push_back({turn.angle() * turn.axis(),
                          from_a.turn_covariance + from_b.turn_covariance, std::exp(-worse / 2)});
    }
  }
  return possible;
}

// The plates that are compared with each other, station by station or picture by picture.
std::vector<std::vector<SeenAttitude>> compared_attitudes(const AdjustmentProblem& problem,
                                                          ComparedPlates compared) {
  std::vector<std::vector<SeenAttitude>> groups;
  for (const Station& station : problem.stations) {
    std::map<std::size_t, std::vector<SeenAttitude>> by_camera;
    for (SeenAttitude& attitude : attitudes_of(problem, station)) {
      const bool one = compared == ComparedPlates::of_station;
      by_camera[one ? 0 : attitude.camera].push_back(std::move(attitude));
    }
    for (auto& [camera, attitudes] : by_camera) groups.push_back(std::move(attitudes));
  }
  return groups;
}

std::vector<TurnOfPair> turns_of_pairs(const std::vector<std::vector<SeenAttitude>>& groups) {
  std::map<std::size_t, int> times_seen;
  for (const std::vector<SeenAttitude>& attitudes : groups) {
    for (const SeenAttitude& attitude : attitudes) ++times_seen[attitude.plate];
  }
  std::vector<TurnOfPair> pairs;
  for (const std::vector<SeenAttitude>& attitudes : groups) {
    for (std::size_t i = 0; i < attitudes.size(); ++i) {
      for (std::size_t j = i + 1; j < attitudes.size(); ++j) {
        const SeenAttitude& a = attitudes[i];
        const SeenAttitude& b = attitudes[j];
        if (a.plate == b.plate) continue;
        // Of n plates n - 1 turns are independent; n (n - 1) / 2 pairs are listed.
        const double weight = 2.0 / static_cast<double>(attitudes.size()) /
                              std::sqrt(times_seen[a.plate] * times_seen[b.plate]);
        pairs.push_back({turns_between(a, b), weight});
      }
    }
  }
  return pairs;
}

// The density of a turn about one axis, up to a constant.
double density(double turn, double variance) {
  return std::exp(-turn * turn / variance / 2) / std::sqrt(variance);
}

// Likelihood of a turn, up to a constant, when plates are turned by `sigma` about each axis. It may
// be the turn of a plate that hangs quite wrong, or that was measured wrong about one axis of the
// corners' noise, as happens with steep frames.
double likelihood_of(const TurnOfPair::Possible& turn, double sigma) {
  constexpr double kWrong = 0.05;         // of each of the two
  const double wrong_sigma = radians(5);  // of which
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(turn.covariance);
  const Vector3d along = axes.eigenvectors().transpose() * turn.turn;
  Vector3d right;
  Vector3d wrong;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double variance = std::max(axes.eigenvalues()[i], 0.0) + 2 * sigma * sigma;
    right[i] = density(along[i], variance);
    wrong[i] = density(along[i], variance + wrong_sigma * wrong_sigma);
  }
  double of_one = 0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    of_one += wrong[i] * right[(i + 1) % 3] * right[(i + 2) % 3] / 3;
  }
  return (1 - 2 * kWrong) * right.prod() + kWrong * of_one + kWrong * wrong.prod();
}

double log_likelihood(const TurnOfPair& pair, double sigma) {
  double sum = 0;
  for (const TurnOfPair::Possible& turn : pair.possible) {
    sum += turn.likelihood * likelihood_of(turn, sigma);
  }
  return std::log(std::max(sum, 1e-300));
}

// The prior of the magnitude's logarithm, up to a constant.
double log_prior(double sigma) {
  constexpr double kFalls = 8;  // power by which it falls beyond the scatter of plates hung by eye
  return -kFalls * std::max(0.0, std::log(sigma / radians(0.5)));
}

}  // namespace

// Why: docs/decisions/0010-where-plates-hang.md.
double attitude_scatter(const AdjustmentProblem& problem, ComparedPlates compared) {
  constexpr std::size_t kSteps = 61;
  constexpr double kQuantile = 0.975;
  const double least = radians(0.05);
  const double most = radians(3);
  const double step = std::log(most / least) / (kSteps - 1);
  const auto sigma_at = [&](double place) { return least * std::exp(place * step); };

  const std::vector<TurnOfPair> pairs = turns_of_pairs(compared_attitudes(problem, compared));
  std::array<double, kSteps> posterior{};
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double sigma = sigma_at(static_cast<double>(i));
    posterior[i] = log_prior(sigma);
    for (const TurnOfPair& pair : pairs) posterior[i] += pair.weight * log_likelihood(pair, sigma);
  }
  const double highest = *std::ranges::max_element(posterior);
  double sum = 0;
  for (double& value : posterior) sum += value = std::exp(value - highest);
  double passed = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (passed + posterior[i] < kQuantile * sum) {
      passed += posterior[i];
      continue;
    }
    return sigma_at(static_cast<double>(i) + (kQuantile * sum - passed) / posterior[i] - 0.5);
  }
  return most;
}

}  // namespace tagsmith::detail
