// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_consensus.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

// Why: docs/decisions/0010-where-plates-hang.md.
// By how much chi-square another explanation with one fault less may be worse: parameters of a
// plate, and its odds.
constexpr double kOfFault = kOfPlate + kClearlyBetter;

// For a rig of unknown calibration, and for frames that all have another size.
Rig any_calibration(Rig rig) {
  for (RigCamera& camera : rig.cameras) {
    CalibrationSigma& sigma = camera.calibration_sigma;
    sigma.position = std::max(sigma.position, 0.03);
    sigma.angle = std::max(sigma.angle, radians(5));
    sigma.focal = std::max(sigma.focal, 0.1);
    sigma.center = std::max(sigma.center, 20.0);
    if (sigma.radial > 0) sigma.radial = std::max(sigma.radial, 0.2);
  }
  return rig;
}
constexpr double kAnyFrame = 0.1;

bool shows(const Station& station, std::size_t plate) { return plates_of(station).contains(plate); }

bool is_of_one_camera(const Station& station) {
  return std::ranges::all_of(station.sightings, [&](const Sighting& sighting) {
    return sighting.camera == station.sightings.front().camera;
  });
}

class Judge {
 public:
  Judge(AdjustmentProblem problem, double tolerance)
      : tolerance_(tolerance), original_(std::move(problem)), found_(explain(original_)) {
    if (faults_of(found_) == 0) return;
    any_rig_ = any_calibration(*original_.rig);
    AdjustmentProblem any = original_;
    any.rig = &any_rig_;
    any.frame_sigma = kAnyFrame;
    of_another_rig_ = explain(std::move(any));
    take_simpler(of_another_rig_);
  }

  Judge(const Judge&) = delete;  // any_rig_ is pointed to
  Judge& operator=(const Judge&) = delete;

  Consensus run() {
    judge_all();
    for (const PlateCopy& copy : found_.copies) take_copy(copy);
    if (!result_.nothing_fits) result_.mixed = found_.mixed;
    for (PlateCheck& check : result_.plates) {
      for (std::size_t& rival : check.rivals) rival = original_plate(rival);
    }
    for (LeftOutStation& station : result_.left_out) {
      for (LeftOutStation::Suspect& suspect : station.suspects) {
        suspect.plate = original_plate(suspect.plate);
      }
    }
    result_.plates.resize(original_.plates.size());
    return std::move(result_);
  }

 private:
  // The plate whose code a copy bears.
  std::size_t original_plate(std::size_t plate) const {
    const auto copy = std::ranges::find(found_.copies, plate, &PlateCopy::plate);
    return copy == found_.copies.end() ? plate : copy->of;
  }

  // Several rows with the same mistake are no coincidence.
  void take_copy(const PlateCopy& copy) {
    FoundCopy found{copy.of, copy.place, {}};
    for (const Station& station : found_.problem.stations) {
      if (shows(station, copy.plate)) found.stations.push_back(station.name);
    }
    if (found.stations.empty() || result_.nothing_fits) return;
    const bool fits = result_.plates[copy.plate].verdict == HangVerdict::fits;
    if (!fits || (found.stations.size() == 1 && mixed_photos_explain(copy))) {
      found.doubt = HangDoubt::row;
    } else if (!is_tied_to_original(copy)) {
      found.doubt = HangDoubt::block;
    }
    result_.copies.push_back(std::move(found));
  }

  // Whether pictures connect the original with tags that hang beside the copy. Otherwise all of
  // these may hang elsewhere because of a slip in the chain, and the apparent copy is the original.
  bool is_tied_to_original(const PlateCopy& copy) const {
    std::vector<bool> counts;
    for (const PlateCheck& check : result_.plates) {
      counts.push_back(check.verdict == HangVerdict::fits);
    }
    counts[copy.plate] = false;
    const std::vector<std::size_t> group = tied_groups(found_.problem.stations, counts);
    return std::ranges::any_of(found_.problem.stations, [&](const Station& station) {
      return shows(station, copy.plate) &&
             std::ranges::any_of(station.sightings, [&](const Sighting& seen) {
               return counts[seen.plate] && group[seen.plate] == group[copy.of];
             });
    });
  }

  // True when photos that were not taken together explain the pictures of the copy, too: then they
  // show the original.
  bool mixed_photos_explain(const PlateCopy& copy) const {
    PlateExplanation split = found_;
    std::vector<Station> stations;
    for (Station& station : split.problem.stations) {
      if (!shows(station, copy.plate)) {
        stations.push_back(std::move(station));
        continue;
      }
      for (Sighting& seen : station.sightings) {
        if (seen.plate == copy.plate) seen.plate = copy.of;
      }
      std::ranges::move(apart(station), std::back_inserter(stations));
    }
    split.problem.stations = std::move(stations);
    split.adjustment = adjust_plates(split.problem, split.freed);
    return split.problem.stations.empty() || cost_of(split) - cost_of(found_) <= kClearlyBetter;
  }

  void judge_all() {
    result_.plates.resize(found_.problem.plates.size());
    std::set<std::string> reported;
    for (const Station& station : found_.left_out) {
      if (reported.insert(station.name).second) result_.left_out.push_back(suspected(station));
    }
    if (!found_.adjustment) {
      result_.nothing_fits = !found_.problem.stations.empty();
      return;
    }
    take_fitting();
    std::ptrdiff_t accused = 0;
    for (std::size_t i = 0; i < result_.plates.size(); ++i) accused += accuse(i) ? 1 : 0;
    doubt_what_depends_on_doubtful();
    constexpr int kFew = 4;
    const auto checked = std::ranges::count_if(result_.plates, [](const PlateCheck& check) {
      return check.verdict != HangVerdict::unchecked;
    });
    if (is_of_another_rig() || (checked >= kFew && 2 * accused > checked)) {
      result_.nothing_fits = true;
      for (PlateCheck& check : result_.plates) check = PlateCheck{};
    }
  }

  // Plates seen together with this one that are not taken out.
  std::set<std::size_t> judges_of(std::size_t plate) const {
    std::set<std::size_t> judges = plates_near(found_.problem.stations, plate);
    std::erase_if(
        judges, [&](std::size_t i) { return i == plate || found_.freed[i] != PlateFreedom::none; });
    return judges;
  }

  void take_fitting() {
    for (std::size_t i = 0; i < result_.plates.size(); ++i) {
      PlateCheck& check = result_.plates[i];
      check.stations = static_cast<int>(std::ranges::count_if(
          found_.problem.stations, [&](const Station& station) { return shows(station, i); }));
      if (check.stations == 0) continue;
      const bool is_judged = !judges_of(i).empty() && found_.adjustment->offsets[i];
      if (is_judged) {
        check.offset = found_.adjustment->offsets[i];
        check.verdict = HangVerdict::fits;
      } else if (found_.freed[i] != PlateFreedom::none) {
        check.verdict = HangVerdict::doubtful;
        check.doubt = HangDoubt::rest;
      }
    }
  }

  // --- a plate that was taken out ---

  // The fit with this freedom of the plate, and all others as in the explanation.
  static std::optional<Adjustment> with(const PlateExplanation& explanation, std::size_t plate,
                                        PlateFreedom freedom) {
    std::vector<PlateFreedom> freed = explanation.freed;
    freed[plate] = freedom;
    return adjust_plates(explanation.problem, freed);
  }

  // True when a fit with one plate hanging elsewhere, but of its right size, is hardly worse than
  // the explanation that leaves its size free, too.
  static bool explains(const std::optional<Adjustment>& moved, const PlateExplanation& with_size) {
    return moved && moved->chi_square <= with_size.adjustment->chi_square + kClearlyBetter;
  }

  bool is_off(std::size_t plate, const PlateOffset& offset) const {
    return excess(offset) > 1 && farthest_corner(found_.problem.plates[plate], offset) > tolerance_;
  }

  // True when the plate is off, or doubtful.
  bool accuse(std::size_t plate) {
    if (plate >= original_.plates.size()) {  // a copy is judged as a copy
      if (found_.accuses(plate)) result_.plates[plate].verdict = HangVerdict::doubtful;
      return false;
    }
    if (found_.swapped_with[plate] && result_.plates[plate].offset) {
      result_.plates[plate].swapped_with = found_.swapped_with[plate];
      least_deficit_ = std::numeric_limits<double>::infinity();
      judge(plate);
      return false;  // an exchange of plates is no evidence against the rig
    }
    if (found_.freed[plate] == PlateFreedom::none || !result_.plates[plate].offset) return false;
    const auto moved = with(found_, plate, PlateFreedom::place);
    const bool is_moved = explains(moved, found_);
    PlateCheck& check = result_.plates[plate];
    if (is_moved) check.offset = moved->offsets[plate];
    if (is_moved && !is_off(plate, *check.offset)) return false;
    least_deficit_ = std::numeric_limits<double>::infinity();
    const auto rivals = rivals_of(plate);
    // A small turn of one plate can explain a large shift of another.
    const auto hangs_well = [&](const Rival& rival) {
      const bool has_other_size =
          rival.scale && rival.scale->cause != FrameScale::Cause::size_or_place;
      return !has_other_size &&
             farthest_corner(found_.problem.plates[rival.plate], rival.offset) <= tolerance_;
    };
    if (std::ranges::any_of(rivals, hangs_well)) return false;
    check.scale = scale_of(found_, plate, moved);
    if (rivals.empty()) judge(plate);
    for (const Rival& rival : rivals) add_rival(plate, rival);
    return true;
  }

  // A plate that may be the wrong one instead of another, and where it would hang then.
  struct Rival {
    std::size_t plate = 0;
    PlateOffset offset;
    std::optional<FrameScale> scale;
  };

  // The plate in an explanation that takes it out.
  std::optional<Rival> rival_by(const PlateExplanation& instead, std::size_t plate) const {
    const auto moved = with(instead, plate, PlateFreedom::place);
    const auto& offset = (explains(moved, instead) ? moved : instead.adjustment)->offsets[plate];
    if (!offset) return std::nullopt;
    return Rival{plate, *offset, scale_of(instead, plate, moved)};
  }

  std::vector<Rival> rivals_of(std::size_t plate) {
    std::vector<Rival> rivals;
    PlateExplanation instead = found_;
    for (const std::size_t other :
         neighbours(found_.problem, found_.freed, *found_.adjustment, plate)) {
      instead.freed = found_.freed;
      instead.freed[plate] = PlateFreedom::none;
      instead.freed[other] = PlateFreedom::any;
      instead.adjustment = adjust_plates(instead.problem, instead.freed);
      if (!is_close(cost_of(instead) - cost_of(found_))) continue;
      if (const auto rival = rival_by(instead, other)) rivals.push_back(*rival);
    }
    return rivals;
  }

  void add_rival(std::size_t plate, const Rival& rival) {
    for (const auto& [one, other] :
         {std::pair(plate, rival.plate), std::pair(rival.plate, plate)}) {
      PlateCheck& check = result_.plates[one];
      check.verdict = HangVerdict::doubtful;
      check.doubt = HangDoubt::rivals;
      if (std::ranges::find(check.rivals, other) == check.rivals.end()) {
        check.rivals.push_back(other);
      }
    }
    result_.plates[rival.plate].offset = rival.offset;
    result_.plates[rival.plate].scale = rival.scale;
  }

  // The size at which the frame explains the pictures, in its place where that is possible; nothing
  // when an offset explains them clearly better. `moved` is the fit with the plate hanging
  // anywhere.
  std::optional<FrameScale> scale_of(const PlateExplanation& explanation, std::size_t plate,
                                     const std::optional<Adjustment>& moved) const {
    constexpr double kOfPose = 5;  // parameters that an offset has more
    using enum FrameScale::Cause;
    const bool is_moved = explains(moved, explanation);
    const Adjustment& by_both = *explanation.adjustment;
    const double to_beat = is_moved ? moved->chi_square : by_both.chi_square;
    const auto sized = with(explanation, plate, PlateFreedom::size);
    if (sized && sized->chi_square <= to_beat + kOfPose + kClearlyBetter) {
      return FrameScale{sized->size[plate], least_seen(explanation, plate, *sized, moved),
                        is_moved ? size_or_place : size};
    }
    if (is_moved) return std::nullopt;
    return FrameScale{by_both.size[plate], least_seen(explanation, plate, by_both, {}),
                      size_and_place};
  }

  // The least error of size that would be detected: a smaller one is within chance, looks like an
  // offset that the survey's variances explain, or like one within the tolerance. An offset that
  // looks like the error grows with it.
  double least_seen(const PlateExplanation& explanation, std::size_t plate, const Adjustment& sized,
                    const std::optional<Adjustment>& moved) const {
    constexpr double kSeen = 5.5;  // standard deviations that pass the test in 95 of 100
    const double error = std::abs(sized.size[plate] - 1);
    double least = kSeen * sized.size_sigma[plate];
    if (!moved || !moved->offsets[plate]) return least;
    const PlateOffset& offset = *moved->offsets[plate];
    const SightedPlate& frame = explanation.problem.plates[plate];
    least = std::max(least, error * tolerance_ / farthest_corner(frame, offset));
    const double by_shift = offset.chi_square - offset.turn_chi_square;
    return std::max(least, error * kSeen / std::sqrt(std::max(by_shift, 1e-9)));
  }

  // --- verdicts ---

  // Off when nothing else explains it, otherwise doubtful.
  void judge(std::size_t plate) {
    PlateCheck& check = result_.plates[plate];
    check.doubt = doubt_of(plate);
    if (check.doubt == HangDoubt::rivals) return;
    // Another size and another place are two mistakes. A block of plates that hang elsewhere is one
    // mistake, and where its first plate is seen with plates on both sides, it is pulled both ways
    // as if it were larger or smaller.
    const bool takes_two = check.scale && check.scale->cause == FrameScale::Cause::size_and_place;
    if (check.doubt == HangDoubt::none && takes_two) check.doubt = HangDoubt::block;
    check.verdict = check.doubt == HangDoubt::none ? HangVerdict::off : HangVerdict::doubtful;
    check.log_odds = least_deficit_ / 2;
  }

  HangDoubt doubt_of(std::size_t plate) {
    const auto shows_it = [&](const Station& station) { return shows(station, plate); };
    if (std::ranges::any_of(found_.left_out, shows_it)) return HangDoubt::row;
    for (std::size_t s = 0; s < found_.problem.stations.size(); ++s) {
      const Station& station = found_.problem.stations[s];
      if (shows_it(station) && fits_badly(station, found_.adjustment->station_chi_square[s])) {
        return HangDoubt::rest;
      }
    }
    if (!of_another_rig_.accuses(plate) && is_close(deficit_of(of_another_rig_, found_))) {
      return HangDoubt::rig;
    }
    const PlateExplanation near = around(plate);
    if (!near.adjustment) return HangDoubt::rest;
    const bool rows_are_right = !could_be_a_row(plate);
    const bool is_swapped = found_.swapped_with[plate].has_value();
    if (!rows_are_right && !is_swapped &&
        (fits_apart(near, plate) || fits_beside_copy(near, plate))) {
      return HangDoubt::row;
    }
    return doubt_by_others(near, {plate, rows_are_right});
  }

  // Pictures that were not taken together are as far apart as the vehicle moved in between.
  bool could_be_a_row(std::size_t plate) const {
    constexpr double kLeastWay = 0.1;  // metres
    const PlateCheck& check = result_.plates[plate];
    return check.swapped_with ||
           farthest_corner(found_.problem.plates[plate], *check.offset) > kLeastWay;
  }

  static bool explains_as_well(const PlateExplanation& other, const PlateExplanation& found) {
    return deficit_of(other, found) <= kClearlyBetter;
  }

  // By how much chi-square is worse than that of the explanation found, minus the allowance for
  // fewer faults; infinite with more faults.
  static double deficit_of(const PlateExplanation& other, const PlateExplanation& found) {
    const int fewer = faults_of(found) - faults_of(other);
    if (fewer < 0) return std::numeric_limits<double>::infinity();
    return cost_of(other) - cost_of(found) - kOfFault * fewer;
  }

  // Whether an explanation with this deficit is close enough to matter. The least deficit of the
  // others determines how certain the verdict is.
  bool is_close(double deficit) {
    least_deficit_ = std::min(least_deficit_, deficit);
    return deficit <= kClearlyBetter;
  }

  // Takes the faults of the other explanation in place of those found, when fewer of them explain
  // the pictures of the rig as it is.
  void take_simpler(PlateExplanation other) {
    other.problem.rig = original_.rig;
    other.problem.frame_sigma = 0;
    other.adjustment = adjust_plates(other.problem, other.freed);
    if (faults_of(other) >= faults_of(found_) || !explains_as_well(other, found_)) return;
    found_ = std::move(other);
  }

  bool is_of_another_rig() const {
    constexpr int kMany = 3;  // faults that are not a coincidence
    return faults_of(found_) >= kMany && explains_as_well(of_another_rig_, found_) &&
           faults_of(found_) - faults_of(of_another_rig_) >= kMany;
  }

  // All stations that show plates which are seen together with this one.
  std::vector<Station> stations_near(const std::vector<Station>& stations,
                                     std::size_t plate) const {
    const std::set<std::size_t> with_it = plates_near(original_.stations, plate);
    std::vector<Station> near;
    std::ranges::copy_if(stations, std::back_inserter(near), [&](const Station& station) {
      return std::ranges::any_of(plates_of(station),
                                 [&](std::size_t other) { return with_it.contains(other); });
    });
    return near;
  }

  // The explanation, limited to pictures near the plate.
  PlateExplanation around(std::size_t plate) const {
    PlateExplanation near = found_;
    near.problem.stations = stations_near(found_.problem.stations, plate);
    near.left_out = stations_near(found_.left_out, plate);
    std::set<std::size_t> seen;
    for (const auto* stations : {&near.problem.stations, &near.left_out}) {
      for (const Station& station : *stations) {
        const std::set<std::size_t> here = plates_of(station);
        seen.insert(here.begin(), here.end());
      }
    }
    for (std::size_t i = 0; i < near.freed.size(); ++i) {
      if (seen.contains(i)) continue;
      near.freed[i] = PlateFreedom::none;
      near.swapped_with[i].reset();
    }
    std::erase_if(near.mixed, [&](const MixedStations& mixed) {
      return std::ranges::none_of(near.problem.stations, [&](const Station& station) {
        return station.name == mixed.one || station.name == mixed.other;
      });
    });
    std::erase_if(near.copies, [&](const PlateCopy& copy) { return !seen.contains(copy.plate); });
    near.adjustment = adjust_plates(near.problem, near.freed);
    return near;
  }

  // True when one row of pictures, not taken together, explains the evidence against the plate.
  bool fits_apart(const PlateExplanation& near, std::size_t plate) {
    for (std::size_t s = 0; s < near.problem.stations.size(); ++s) {
      if (!shows(near.problem.stations[s], plate)) continue;
      PlateExplanation split = near;
      std::vector<Station>& stations = split.problem.stations;
      if (is_of_one_camera(stations[s])) continue;
      std::vector<Station> parts = apart(stations[s]);
      stations.erase(stations.begin() + static_cast<std::ptrdiff_t>(s));
      std::ranges::move(parts, std::back_inserter(stations));
      split.freed[plate] = PlateFreedom::none;
      split.adjustment = adjust_plates(split.problem, split.freed);
      if (is_close(cost_of(split) - cost_of(near))) return true;
    }
    return false;
  }

  // True when a second copy of one plate that is seen with it explains the evidence against the
  // plate.
  bool fits_beside_copy(const PlateExplanation& near, std::size_t plate) {
    for (const std::size_t judge : judges_of(plate)) {
      PlateExplanation copied = near;
      AdjustmentProblem& problem = copied.problem;
      problem.plates.push_back(problem.plates[judge]);
      for (Station& station : problem.stations) {
        if (!shows(station, plate)) continue;
        for (Sighting& sighting : station.sightings) {
          if (sighting.plate == judge) sighting.plate = problem.plates.size() - 1;
        }
      }
      copied.freed[plate] = PlateFreedom::none;
      copied.freed.push_back(PlateFreedom::any);
      copied.adjustment = adjust_plates(problem, copied.freed);
      if (is_close(cost_of(copied) - cost_of(near))) return true;
    }
    return false;
  }

  // Whether other plates and stations explain the pictures when this plate hangs as surveyed.
  HangDoubt doubt_by_others(const PlateExplanation& near, const Given& given) {
    const std::size_t plate = *given.plate;
    AdjustmentProblem problem = original_;
    problem.stations = stations_near(original_.stations, plate);
    const PlateExplanation others = explain(std::move(problem), given);
    if (!is_close(deficit_of(others, near))) return HangDoubt::none;
    HangDoubt doubt =
        others.left_out.size() > near.left_out.size() ? HangDoubt::row : HangDoubt::rest;
    for (std::size_t i = 0; i < original_.plates.size(); ++i) {
      if (others.freed[i] == PlateFreedom::none || found_.accuses(i)) continue;
      const auto rival = rival_by(others, i);
      if (!rival) continue;
      add_rival(plate, *rival);
      doubt = HangDoubt::rivals;
    }
    return doubt;
  }

  // True when no plate that judges this one is beyond doubt; or when another that was taken out is
  // seen with it and doubtful: what else explains that one may explain this one as well.
  bool depends_on_doubtful(std::size_t plate) const {
    bool is_judged = false;
    for (const std::size_t other : plates_near(found_.problem.stations, plate)) {
      if (other == plate) continue;
      const HangVerdict verdict = result_.plates[other].verdict;
      if (found_.accuses(other) && verdict == HangVerdict::doubtful) return true;
      is_judged = is_judged || verdict == HangVerdict::fits;
    }
    return !is_judged;
  }

  void doubt_what_depends_on_doubtful() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < result_.plates.size(); ++i) {
        PlateCheck& check = result_.plates[i];
        if (check.verdict != HangVerdict::off || !depends_on_doubtful(i)) continue;
        check.verdict = HangVerdict::doubtful;
        check.doubt = HangDoubt::rest;
        changed = true;
      }
    }
  }

  // --- stations left out ---

  // The fit to this station alone; nothing where it fits badly, or where a plate contradicts it
  // that may not hang anywhere.
  std::optional<Adjustment> fit_alone(const Station& station,
                                      std::optional<std::size_t> anywhere = {}) const {
    AdjustmentProblem problem = found_.problem;
    problem.stations = {station};
    std::vector<PlateFreedom> freed = found_.freed;
    if (anywhere) freed[*anywhere] = PlateFreedom::place;
    auto fit = adjust_plates(problem, freed);
    if (!fit || fits_badly(station, fit->station_chi_square[0])) return std::nullopt;
    const auto contradicts = [&](std::size_t plate) {
      return plate != anywhere && fit->offsets[plate] && excess(*fit->offsets[plate]) > 1;
    };
    if (std::ranges::any_of(plates_of(station), contradicts)) return std::nullopt;
    return fit;
  }

  // Where a plate would have to hang to explain the station; nothing when no place does.
  std::optional<Pose> place_that_explains(const Station& station, std::size_t plate) const {
    const auto fit = fit_alone(station, plate);
    if (!fit || !fit->offsets[plate]) return std::nullopt;
    return fit->world_from_plate[plate];
  }

  LeftOutStation suspected(const Station& station) const {
    LeftOutStation left_out{station.name, {}, false};
    for (const std::size_t plate : plates_of(station)) {
      left_out.suspects.push_back({plate, place_that_explains(station, plate)});
    }
    left_out.fits_apart =
        !is_of_one_camera(station) && std::ranges::all_of(apart(station), [&](const Station& part) {
          return fit_alone(part).has_value();
        });
    return left_out;
  }

  double tolerance_;
  double least_deficit_ = 0;  // of what was tried in place of the plate that is judged
  AdjustmentProblem original_;
  PlateExplanation found_;
  Rig any_rig_;
  PlateExplanation of_another_rig_;  // by other calibrations and another size of all frames
  Consensus result_;
};

}  // namespace

double farthest_corner(const SightedPlate& plate, const PlateOffset& offset) {
  const Eigen::Matrix3d& rotation = plate.world_from_plate.rotation;
  const Eigen::Matrix3d turned = rotation_of(offset.turn);
  double farthest = 0;
  for (const double x : {0.0, plate.length}) {
    for (const double y : {0.0, plate.height}) {
      const Vector3d corner(x, y, 0);
      const Vector3d moved = offset.shift + rotation * (turned * corner - corner);
      farthest = std::max(farthest, moved.norm());
    }
  }
  return farthest;
}

Consensus find_consensus(AdjustmentProblem problem, double tolerance) {
  keep_comparable(problem);
  return Judge(std::move(problem), tolerance).run();
}

std::vector<std::size_t> tied_groups(std::span<const Station> stations,
                                     const std::vector<bool>& counts) {
  std::vector<std::size_t> parent(counts.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root_of = [&parent](std::size_t plate) {
    while (parent[plate] != plate) plate = parent[plate] = parent[parent[plate]];
    return plate;
  };
  for (const Station& station : stations) {
    std::optional<std::size_t> first;
    for (const Sighting& seen : station.sightings) {
      if (!counts[seen.plate]) continue;
      if (!first) first = root_of(seen.plate);
      parent[root_of(seen.plate)] = *first;
    }
  }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root_of(i);
  return parent;
}

}  // namespace tagsmith::detail
