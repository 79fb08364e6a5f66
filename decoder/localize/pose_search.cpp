// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/pose_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "decoder/localize/fix.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {

std::string unlikely_stance(const JointProblem& problem, const JointFit& fit, double gate) {
  const auto row = fit.rows.vehicle_begin;
  const VehiclePose& vehicle = fit.state.vehicle;
  if (std::abs(fit.rows.residual[row]) > gate) {
    const double height =
        problem.rig->vehicle_height + fit.rows.residual[row] * problem.rig->height_sigma;
    return fmt::format(
        "the vehicle would be {:.2f} m above the floor, and the rig says {:.2f} m (vehicle.height)",
        height, problem.rig->vehicle_height);
  }
  for (const Eigen::Index i : {1, 2}) {
    if (std::abs(fit.rows.residual[row + i]) > gate) {
      return fmt::format("the vehicle would have a pitch of {:.1f} and a roll of {:.1f} degrees",
                         degrees(vehicle.pitch), degrees(vehicle.roll));
    }
  }
  return {};
}

std::size_t plate_count(const JointFit& fit) { return fit.rows.plates.size(); }

std::set<std::size_t> plates_of(const JointFit& fit) {
  std::set<std::size_t> plates;
  for (const auto& group : fit.rows.plates) plates.insert(group.plate);
  return plates;
}

namespace {

// Solutions closer than this, in standard deviations, are one.
constexpr double kSame = 1.0;

// --- single tags ---

std::string impossible(const JointProblem& problem, const JointFit& fit) {
  const std::string outside = outside_tunnel(*problem.tunnel, fit.state.vehicle.position);
  return outside.empty() ? unlikely_stance(problem, fit, kStanceGate) : outside;
}

// What one sighting alone allows.
struct SingleFits {
  std::vector<JointFit> fits;  // possible ones
  std::string reason;          // why there is none
};

double squared_distance(const JointFit& a, const JointFit& b) {
  const VehicleCovariance spread = a.vehicle_covariance() + b.vehicle_covariance();
  return squared_mahalanobis(pose_difference(a.state.vehicle, b.state.vehicle), spread) / 2;
}

bool is_same(const JointFit& a, const JointFit& b) {
  return squared_distance(a, b) < kSame * kSame;
}

// The distinct poses that least squares finds from the sighting's two, the best first.
std::vector<JointFit> fits_of(const JointProblem& problem, std::size_t index,
                              const std::array<VehiclePose, 2>& starts) {
  std::vector<JointFit> fits;
  for (const VehiclePose& start : starts) {
    auto fit = fit_jointly(problem, {{index}, {}}, start);
    if (!fit) continue;
    const auto same = [&](const JointFit& other) { return is_same(other, *fit); };
    if (std::ranges::none_of(fits, same)) fits.push_back(std::move(*fit));
  }
  std::ranges::sort(fits, {}, &JointFit::chi_square);
  return fits;
}

double corners_chi_square(const JointFit& fit) {
  return fit.rows.residual.head(fit.rows.ranges_begin).squaredNorm();
}

// Fits each pose that the sighting allows. Where even the better one does not explain the corners,
// their covariance is raised until it does. A pose that still does not explain them is rejected,
// whether or not another remains: where rig or survey are wrong, only the wrong one of the two may
// remain.
SingleFits fit_single(JointProblem& problem, std::size_t index) {
  SingleFits result;
  Sighting& sighting = problem.sightings[index];
  const auto starts = vehicle_poses_from(*problem.rig, problem.plates[sighting.plate], sighting);
  if (!starts) {
    result.reason = "its corners are no picture of a rectangle";
    return result;
  }
  std::vector<JointFit> fits = fits_of(problem, index, *starts);
  if (fits.empty()) {
    result.reason = "no pose explains its corners";
    return result;
  }
  const auto factor = factor_to_explain(corners_chi_square(fits.front()));
  if (!factor) {
    result.reason =
        "its corners do not fit a plate of its template on its wall: it is twisted or bent, "
        "something lies along an edge of its frame, or rig or template are those of others";
    return result;
  }
  if (*factor > 1) {
    sighting.covariance *= *factor;
    fits = fits_of(problem, index, *starts);
  }
  for (JointFit& fit : fits) {
    const std::string reason = corners_chi_square(fit) > kCornersAsStated
                                   ? "its corners do not fit the pose that its wall allows"
                                   : impossible(problem, fit);
    if (reason.empty()) {
      result.fits.push_back(std::move(fit));
    } else if (result.reason.empty()) {
      result.reason = reason;
    }
  }
  if (!result.fits.empty()) result.reason.clear();
  return result;
}

// --- consensus ---

bool agrees(const Disagreement& difference) {
  return difference.shift_chi_square < chi_square_limit(3, kPoseShiftGate) &&
         difference.chi_square < chi_square_limit(difference.degrees_of_freedom, kCornersGate);
}

// The sightings that agree with the fit, including those that it uses. If one image has two of one
// plate (a copy, a reflection), the one that agrees better.
std::vector<std::size_t> supporters(const JointProblem& problem, const JointFit& fit) {
  std::vector<std::size_t> chosen = fit.selection.sightings;
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (std::ranges::find(chosen, i) != chosen.end()) continue;
    const auto difference = disagreement(problem, fit, i);
    if (difference && agrees(*difference)) others.emplace_back(difference->chi_square, i);
  }
  std::ranges::sort(others);
  for (const auto& [chi_square, i] : others) {
    const auto& other = problem.sightings[i];
    const auto is_repeat = [&](std::size_t j) {
      return problem.sightings[j].plate == other.plate &&
             problem.sightings[j].camera == other.camera;
    };
    if (std::ranges::none_of(chosen, is_repeat)) chosen.push_back(i);
  }
  std::ranges::sort(chosen);
  return chosen;
}

// The plate of the fit that disagrees most with the rest; nothing when all agree.
std::optional<std::size_t> worst_plate(const JointProblem& problem, const JointFit& fit) {
  std::optional<std::size_t> worst;
  double most = 1;
  for (std::size_t i = 0; i < fit.rows.plates.size(); ++i) {
    const Disagreement difference = disagreement_within(problem, fit, i);
    const double excess = std::max(
        difference.shift_chi_square / chi_square_limit(3, kPoseShiftGate),
        difference.chi_square / chi_square_limit(difference.degrees_of_freedom, kCornersGate));
    if (excess <= most) continue;
    most = excess;
    worst = i;
  }
  return worst;
}

// Fits the tags together, dropping the worst of those that disagree until all agree, or one is
// left.
std::optional<JointFit> fit_agreeing(const JointProblem& problem,
                                     std::vector<std::size_t> sightings, const VehiclePose& start) {
  for (;;) {
    auto fit = fit_jointly(problem, {sightings, {}}, start);
    if (!fit || plate_count(*fit) < 2) return fit;
    const auto worst = worst_plate(problem, *fit);
    if (!worst) return fit;
    const std::size_t plate = fit->rows.plates[*worst].plate;
    std::erase_if(sightings, [&](std::size_t i) { return problem.sightings[i].plate == plate; });
  }
}

// Adds what agrees: tags that the first search missed, then ranges.
std::optional<Candidate> completed(const JointProblem& problem, JointFit fit) {
  const std::vector<std::size_t> all = supporters(problem, fit);
  if (all.size() > fit.selection.sightings.size()) {
    auto larger = fit_agreeing(problem, all, fit.state.vehicle);
    if (larger && plate_count(*larger) >= plate_count(fit)) fit = std::move(*larger);
  }
  return with_ranges(problem, std::move(fit));
}

// Most tags first, then the better explanation.
bool is_better(const Candidate& a, const Candidate& b) {
  if (plate_count(a.fit) != plate_count(b.fit)) return plate_count(a.fit) > plate_count(b.fit);
  return a.chi_square < b.chi_square;
}

void add_candidate(PoseSearch& search, Candidate candidate) {
  for (Candidate& other : search.candidates) {
    if (!is_same(other.fit, candidate.fit)) continue;
    if (is_better(candidate, other)) other = std::move(candidate);
    return;
  }
  search.candidates.push_back(std::move(candidate));
}

// Largest pictures first: their poses are the most certain.
std::vector<std::size_t> by_size(const JointProblem& problem) {
  std::vector<std::size_t> order(problem.sightings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto size = [&](std::size_t i) {
    const auto& pixels = problem.sightings[i].pixels;
    return -(pixels.segment<2>(4) - pixels.segment<2>(0)).norm();
  };
  std::ranges::stable_sort(order, {}, size);
  return order;
}

}  // namespace

std::optional<Candidate> with_ranges(const JointProblem& problem, JointFit fit) {
  Selection selection = fit.selection;
  double beyond = 0;
  for (std::size_t i = 0; i < problem.ranges.size(); ++i) {
    if (std::abs(range_difference(problem, fit, i).sigmas) < kRangeGate) {
      selection.ranges.push_back(i);
    } else {
      beyond += kRangeGate * kRangeGate;
    }
  }
  if (!selection.ranges.empty()) {
    auto with = fit_jointly(problem, selection, fit.state.vehicle);
    if (!with) return std::nullopt;
    fit = std::move(*with);
  }
  if (!impossible(problem, fit).empty()) return std::nullopt;
  const double chi_square = fit.chi_square + beyond;
  return Candidate{std::move(fit), chi_square};
}

PoseSearch search_poses(JointProblem& problem) {
  PoseSearch search;
  search.reasons.resize(problem.sightings.size());
  for (const std::size_t index : by_size(problem)) {
    SingleFits single = fit_single(problem, index);
    search.reasons[index] = single.reason;
    bool all_agree = false;
    for (const JointFit& fit : single.fits) {
      const std::vector<std::size_t> agreeing = supporters(problem, fit);
      all_agree = all_agree || agreeing.size() == problem.sightings.size();
      auto together = fit_agreeing(problem, agreeing, fit.state.vehicle);
      if (!together) continue;
      auto candidate = completed(problem, std::move(*together));
      if (candidate) add_candidate(search, std::move(*candidate));
      std::ranges::stable_sort(search.candidates, is_better);
    }
    const bool settled =
        !search.candidates.empty() && all_agree &&
        search.candidates.front().fit.selection.sightings.size() == problem.sightings.size();
    if (settled) break;
  }
  return search;
}

}  // namespace tagsmith::detail
