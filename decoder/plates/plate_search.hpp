// SPDX-License-Identifier: Apache-2.0
// The search for what explains pictures of plates that do not all hang as surveyed.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "decoder/plates/plate_adjustment.hpp"

namespace tagsmith::detail {

// Of chi-square.
inline constexpr double kClearlyBetter = 12;  // odds of 400
inline constexpr double kOfPlate = 7;         // parameters of a plate

std::set<std::size_t> plates_of(const Station& station);

// Plates that are seen together with this one, and itself where it is seen.
std::set<std::size_t> plates_near(std::span<const Station> stations, std::size_t plate);

// Two sightings of one station that show different plates.
struct SightedPair {
  std::size_t station = 0;
  std::array<std::size_t, 2> sightings{};  // of the station
  std::array<std::size_t, 2> plates{};
  bool agrees = true;  // both may hang about where the problem has them
};

// All pairs that the problem's stations show.
std::vector<SightedPair> compare_pairs(const AdjustmentProblem& problem);

// How far a plate that should hang as surveyed is from its place, as a multiple of chance: more
// than 1 is rare (once in 400).
double excess(const PlateOffset& offset);

// True when the station's corners are farther from the fit than noise is.
bool fits_badly(const Station& station, double chi_square);

// Plates seen together with this one that are not freed, those that disagree most first.
std::vector<std::size_t> neighbours(const AdjustmentProblem& problem,
                                    const std::vector<PlateFreedom>& freed,
                                    const Adjustment& adjustment, std::size_t plate);

// A second copy of a plate in the place of one that no picture shows.
struct PlateCopy {
  std::size_t plate = 0;  // of the explanation's problem: the copy
  std::size_t of = 0;     // the plate whose code it bears
  std::string place;      // the plate whose place it has
};

// Two stations that have each other's pictures of one camera.
struct MixedStations {
  std::string one;
  std::string other;
  std::size_t camera = 0;
};

struct PlateExplanation {
  // Without the stations left out, and with exchanged plates exchanged; second copies are separate
  // plates behind the others.
  AdjustmentProblem problem;
  std::vector<PlateFreedom> freed;  // any, of the plates that contradict the rest
  std::vector<std::optional<std::size_t>> swapped_with;
  std::vector<PlateCopy> copies;
  std::vector<MixedStations> mixed;      // in the problem each has its own pictures
  std::vector<Station> left_out;         // stations that fit no place of the cameras
  std::optional<Adjustment> adjustment;  // nothing when the fit does not converge

  bool accuses(std::size_t plate) const {
    return freed[plate] != PlateFreedom::none || swapped_with[plate].has_value();
  }
};

// The number of plates taken out, exchanged or there twice, and of stations mixed up or left out.
int faults_of(const PlateExplanation& explanation);

// How badly it explains the pictures: chi-square beyond its expectation, up to a constant that all
// explanations of the same stations share.
double cost_of(const PlateExplanation& explanation);

// Stations with sightings that a rectangle explains, of two plates or more: those that can be
// compared.
void keep_comparable(AdjustmentProblem& problem);

// The pictures of each camera as if they were taken separately, of two plates or more.
std::vector<Station> apart(const Station& station);

// What a search does not question.
struct Given {
  std::optional<std::size_t> plate;  // hangs as surveyed, whatever the pictures say
  bool stations = false;             // none is left out
};

// Assigns sightings of a plate that contradict the rest, while others of it do not, to a second
// copy where that agrees with most. Exchanges pairs of plates, and pictures of two stations, that
// contradict the rest as they are but not after the exchange; then takes out the plate that
// contradicts the others most, or leaves out a station that fits nothing, until those left agree.
// Of a station left out the pictures of each camera are still used separately.
PlateExplanation explain(AdjustmentProblem problem, const Given& given = {});

}  // namespace tagsmith::detail
