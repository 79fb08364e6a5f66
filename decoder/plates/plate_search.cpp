// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_search.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "decoder/plates/plate_start.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kGate = 3.7;  // normal value that is exceeded once in 10 000
// Of a shift where turns are within the survey's tilt: once in 400. A tilt that is not stated is
// estimated on the large side already; where it is stated well, the tolerance protects. Chosen from
// 2.6, 2.8, 2.9 and 3.1 on `bench displaced 60`, seeds 1 and 2.
constexpr double kShiftGate = 2.8;
constexpr double kStationGate = 6;  // of pictures' corners, whose noise has heavier tails
constexpr double kGross = 0.5;      // frame diagonals: beyond, no linear test is needed
constexpr std::size_t kMostRivals = 6;

bool fit_together(const AdjustmentProblem& problem, const Sighting& a, const Sighting& b) {
  return mismatch(problem, a, b) < kGross || mismatch(problem, b, a) < kGross;
}

bool shows(const SightedPair& pair, std::size_t plate) {
  return pair.plates[0] == plate || pair.plates[1] == plate;
}

// Degrees of freedom of a station's corners, all plates being known.
int corner_degrees(const Station& station) {
  return static_cast<int>(kSightingRows * station.sightings.size()) - 6;
}

class PlateSearch {
 public:
  PlateSearch(AdjustmentProblem problem, const Given& given) : given_(given) {
    found_.freed.resize(problem.plates.size(), PlateFreedom::none);
    found_.swapped_with.resize(problem.plates.size());
    found_.problem = std::move(problem);
  }

  PlateExplanation run() {
    take_copies_apart();
    exchange_swapped();
    exchange_mixed();
    while (take_out_gross()) drop_stations();
    take_out_worst();
    take_back_stations();
    return std::move(found_);
  }

 private:
  // --- second copies ---

  bool agree(const Sighting& a, const Sighting& b) const {
    return fit_together(found_.problem, a, b);
  }

  // Whether a sighting of the station, as one of this plate, agrees with more of the other plates
  // there than it contradicts.
  bool agrees_with_most(const Station& station, const Sighting& seen, std::size_t plate) const {
    Sighting taken = seen;
    taken.plate = plate;
    int more = 0;
    for (const Sighting& other : station.sightings) {
      if (other.plate != seen.plate) more += agree(taken, other) ? 1 : -1;
    }
    return more > 0;
  }

  // The number of the plate when it hangs in a place whose own plate is not seen; a new copy is
  // added when there is none.
  std::size_t copy_in(std::size_t of, const SightedPlate& place) {
    const auto known = std::ranges::find_if(found_.copies, [&](const PlateCopy& copy) {
      return copy.of == of && copy.place == place.name;
    });
    if (known != found_.copies.end()) return known->plate;
    const std::size_t plate = found_.problem.plates.size();
    found_.problem.plates.push_back(place);
    found_.problem.plates.back().name = found_.problem.plates[of].name;
    found_.freed.push_back(PlateFreedom::none);
    found_.swapped_with.emplace_back();
    found_.copies.push_back({plate, of, place.name});
    return plate;
  }

  // The place in which this sighting agrees with most others of its station; null when there is
  // none.
  const SightedPlate* place_that_agrees(const Station& station, const Sighting& seen) {
    for (const SightedPlate& place : found_.problem.unseen) {
      found_.problem.plates.push_back(place);
      const bool agrees = agrees_with_most(station, seen, found_.problem.plates.size() - 1);
      found_.problem.plates.pop_back();
      if (agrees) return &place;
    }
    return nullptr;
  }

  // Plates that agree, in some station, with most others there.
  std::set<std::size_t> plates_in_place() const {
    std::set<std::size_t> in_place;
    for (const Station& station : found_.problem.stations) {
      for (const Sighting& seen : station.sightings) {
        if (agrees_with_most(station, seen, seen.plate)) in_place.insert(seen.plate);
      }
    }
    return in_place;
  }

  void take_copies_apart() {
    if (found_.problem.unseen.empty()) return;
    const std::set<std::size_t> in_place = plates_in_place();
    for (Station& station : found_.problem.stations) {
      for (Sighting& seen : station.sightings) {
        if (seen.plate == given_.plate || !in_place.contains(seen.plate)) continue;
        if (agrees_with_most(station, seen, seen.plate)) continue;
        const SightedPlate* place = place_that_agrees(station, seen);
        if (place != nullptr) seen.plate = copy_in(seen.plate, *place);
      }
    }
  }

  // --- exchanged plates ---

  void exchange(std::size_t a, std::size_t b) {
    std::swap(found_.problem.plates[a].world_from_plate, found_.problem.plates[b].world_from_plate);
  }

  // How many pairs of this plate with a third one agree, or contradict each other.
  static std::ptrdiff_t count(const std::vector<SightedPair>& pairs, bool agree, std::size_t plate,
                              std::size_t partner) {
    return std::ranges::count_if(pairs, [&](const SightedPair& pair) {
      return shows(pair, plate) && !shows(pair, partner) && pair.agrees == agree;
    });
  }

  // True when third plates contradict both, and all agree once these two are exchanged.
  bool are_swapped(std::size_t a, std::size_t b) {
    const std::vector<SightedPair> before = compare_pairs(found_.problem);
    if (count(before, false, a, b) == 0 || count(before, false, b, a) == 0) return false;
    exchange(a, b);
    const std::vector<SightedPair> after = compare_pairs(found_.problem);
    exchange(a, b);
    const auto contradicts = [&](const SightedPair& pair) {
      return !pair.agrees && (shows(pair, a) || shows(pair, b));
    };
    return count(after, true, a, b) > 0 && count(after, true, b, a) > 0 &&
           std::ranges::none_of(after, contradicts);
  }

  void exchange_swapped() {
    constexpr std::size_t kMost = 24;  // contradicted plates; with more, no swap is at fault
    std::set<std::size_t> contradicted;
    for (const SightedPair& pair : compare_pairs(found_.problem)) {
      if (!pair.agrees) contradicted.insert(pair.plates.begin(), pair.plates.end());
    }
    if (contradicted.size() > kMost) return;
    for (const std::size_t a : contradicted) {
      for (const std::size_t b : contradicted) {
        if (b <= a || found_.swapped_with[a] || found_.swapped_with[b]) continue;
        if (a == given_.plate || b == given_.plate) continue;
        if (!are_swapped(a, b)) continue;
        exchange(a, b);
        found_.swapped_with[a] = b;
        found_.swapped_with[b] = a;
      }
    }
  }

  // --- pictures of two stations, mixed up ---

  bool agrees(const Station& station) const {
    for (const Sighting& a : station.sightings) {
      for (const Sighting& b : station.sightings) {
        if (a.plate < b.plate && !agree(a, b)) return false;
      }
    }
    return true;
  }

  static bool shows_by(const Station& station, std::size_t camera) {
    return std::ranges::find(station.sightings, camera, &Sighting::camera) !=
           station.sightings.end();
  }

  // The stations after exchanging their pictures of the camera.
  static std::pair<Station, Station> exchanged(Station one, Station other, std::size_t camera) {
    std::vector<Sighting> to_other;
    std::ranges::copy_if(one.sightings, std::back_inserter(to_other),
                         [&](const Sighting& seen) { return seen.camera == camera; });
    std::erase_if(one.sightings, [&](const Sighting& seen) { return seen.camera == camera; });
    std::ranges::copy_if(other.sightings, std::back_inserter(one.sightings),
                         [&](const Sighting& seen) { return seen.camera == camera; });
    std::erase_if(other.sightings, [&](const Sighting& seen) { return seen.camera == camera; });
    std::ranges::copy(to_other, std::back_inserter(other.sightings));
    return {std::move(one), std::move(other)};
  }

  // True when each of the two is consistent after exchanging their pictures of a camera.
  bool unmix(Station& one, Station& other) {
    for (std::size_t camera = 0; camera < found_.problem.rig->cameras.size(); ++camera) {
      if (!shows_by(one, camera) || !shows_by(other, camera)) continue;
      auto [a, b] = exchanged(one, other, camera);
      if (!agrees(a) || !agrees(b)) continue;
      found_.mixed.push_back({one.name, other.name, camera});
      one = std::move(a);
      other = std::move(b);
      return true;
    }
    return false;
  }

  void exchange_mixed() {
    constexpr std::size_t kMost = 24;  // stations that contradict themselves; as with plates
    std::vector<Station*> contradicting;
    for (Station& station : found_.problem.stations) {
      if (!agrees(station)) contradicting.push_back(&station);
    }
    if (contradicting.size() > kMost) return;
    for (std::size_t i = 0; i < contradicting.size(); ++i) {
      for (std::size_t j = i + 1; j < contradicting.size(); ++j) {
        if (!unmix(*contradicting[i], *contradicting[j])) continue;
        contradicting.erase(contradicting.begin() + static_cast<std::ptrdiff_t>(j));
        break;
      }
    }
  }

  // Takes out plates that contradict more others than they agree with; when there is none, a
  // station whose pictures contradict each other. True when there are such stations.
  bool take_out_gross() {
    std::vector<SightedPair> pairs = compare_pairs(found_.problem);
    for (;;) {
      std::map<std::size_t, int> agreed;
      std::map<std::size_t, int> contradicted;
      std::map<std::size_t, int> by_station;
      for (const SightedPair& pair : pairs) {
        for (const std::size_t plate : pair.plates) {
          ++(pair.agrees ? agreed : contradicted)[plate];
        }
        if (!pair.agrees) ++by_station[pair.station];
      }
      if (by_station.empty()) break;
      if (given_.plate) contradicted.erase(*given_.plate);
      const auto weight = [&](const auto& entry) { return entry.second - agreed[entry.first]; };
      const auto plate = std::ranges::max_element(contradicted, {}, weight);
      if (weight(*plate) > 0 || given_.stations) {
        const std::size_t worst = plate->first;
        found_.freed[worst] = PlateFreedom::any;
        std::erase_if(pairs, [&](const SightedPair& pair) { return shows(pair, worst); });
        continue;
      }
      const auto station =
          std::ranges::max_element(by_station, {}, [](const auto& entry) { return entry.second; });
      const std::size_t left_out = station->first;
      std::erase_if(pairs, [&](const SightedPair& pair) { return pair.station == left_out; });
      dropped_.insert(left_out);
    }
    return !dropped_.empty();
  }

  // Takes the stations in dropped_ out of the problem, but for their parts.
  void drop_stations() {
    for (auto index = dropped_.rbegin(); index != dropped_.rend(); ++index) {
      const auto station = found_.problem.stations.begin() + static_cast<std::ptrdiff_t>(*index);
      std::vector<Station> parts = apart(*station);
      if (parts.size() == 1 && parts[0].sightings.size() == station->sightings.size())
        parts.clear();
      found_.left_out.push_back(std::move(*station));
      found_.problem.stations.erase(station);
      std::ranges::move(parts, std::back_inserter(found_.problem.stations));
    }
    dropped_.clear();
  }

  // --- the worst, one by one ---

  bool may_be_freed(std::size_t plate) const {
    return found_.freed[plate] == PlateFreedom::none && plate != given_.plate;
  }

  std::optional<std::size_t> most_in_doubt(const Adjustment& adjustment) const {
    std::optional<std::size_t> worst;
    double most = 1;
    for (std::size_t i = 0; i < adjustment.offsets.size(); ++i) {
      if (!may_be_freed(i) || !adjustment.offsets[i] || excess(*adjustment.offsets[i]) <= most)
        continue;
      most = excess(*adjustment.offsets[i]);
      worst = i;
    }
    return worst;
  }

  // The station whose corners fit worst, when that is too bad to be noise.
  std::optional<std::size_t> worst_station(const Adjustment& adjustment) const {
    std::optional<std::size_t> worst;
    if (given_.stations) return worst;
    double most = 1;
    for (std::size_t s = 0; s < found_.problem.stations.size(); ++s) {
      const int degrees = corner_degrees(found_.problem.stations[s]);
      const double share =
          adjustment.station_chi_square[s] / chi_square_limit(degrees, kStationGate);
      if (share <= most) continue;
      most = share;
      worst = s;
    }
    return worst;
  }

  // By how much leaving the station out lowers chi-square, apart from its own expectation.
  double gain_without(const Adjustment& adjustment, std::size_t station) const {
    AdjustmentProblem rest = found_.problem;
    rest.stations.erase(rest.stations.begin() + static_cast<std::ptrdiff_t>(station));
    const auto without = adjust_plates(rest, found_.freed);
    if (!without) return 0;
    return adjustment.chi_square - without->chi_square -
           corner_degrees(found_.problem.stations[station]);
  }

  struct Choice {
    std::size_t plate = 0;
    Adjustment adjustment;
  };

  // Of the doubtful plate and its neighbours, the one without which the others agree best.
  std::optional<Choice> best_to_free(const Adjustment& adjustment, std::size_t worst) const {
    std::vector<std::size_t> candidates =
        neighbours(found_.problem, found_.freed, adjustment, worst);
    std::erase_if(candidates, [&](std::size_t i) {
      return i == given_.plate ||
             adjustment.offsets[i]->chi_square < adjustment.offsets[worst]->chi_square / 2;
    });
    candidates.insert(candidates.begin(), worst);
    std::optional<Choice> best;
    for (const std::size_t plate : candidates) {
      std::vector<PlateFreedom> freed = found_.freed;
      freed[plate] = PlateFreedom::any;
      auto without = adjust_plates(found_.problem, freed);
      if (!without || (best && without->chi_square >= best->adjustment.chi_square)) continue;
      best = Choice{plate, std::move(*without)};
    }
    return best;
  }

  void take_out_worst() {
    for (;;) {
      found_.adjustment = adjust_plates(found_.problem, found_.freed);
      if (!found_.adjustment) return;
      const Adjustment& adjustment = *found_.adjustment;
      const auto worst = most_in_doubt(adjustment);
      const auto choice = worst ? best_to_free(adjustment, *worst) : std::nullopt;
      const auto station = worst_station(choice ? choice->adjustment : adjustment);
      if (!choice && !station) return;
      const double by_plate =
          choice ? adjustment.chi_square - choice->adjustment.chi_square - kOfPlate : 0;
      if (station && gain_without(adjustment, *station) > by_plate + kClearlyBetter) {
        dropped_.insert(*station);
        drop_stations();
      } else if (choice) {
        found_.freed[choice->plate] = PlateFreedom::any;
      } else {
        return;
      }
    }
  }

  // --- stations that were left out without need ---

  // The explanation with this station in place of the part of it that is used; its parts may have
  // been left out, too.
  std::optional<PlateExplanation> with_station(const Station& station) const {
    PlateExplanation with = found_;
    const auto is_part = [&](const Station& part) { return part.name == station.name; };
    std::erase_if(with.left_out, is_part);
    std::vector<Station>& stations = with.problem.stations;
    std::erase_if(stations, is_part);
    stations.push_back(station);
    with.adjustment = adjust_plates(with.problem, with.freed);
    const bool fits = with.adjustment &&
                      !fits_badly(station, with.adjustment->station_chi_square.back()) &&
                      !most_in_doubt(*with.adjustment);
    return fits ? std::optional(std::move(with)) : std::nullopt;
  }

  // A station may have been left out before the plate was taken out that it contradicts.
  void take_back_stations() {
    if (!found_.adjustment) return;
    std::map<std::string, Station> whole;  // left out before any part of it was
    for (const Station& station : found_.left_out) whole.try_emplace(station.name, station);
    for (const auto& [name, station] : whole) {
      if (auto with = with_station(station)) found_ = std::move(*with);
    }
  }

  Given given_;
  std::set<std::size_t> dropped_;
  PlateExplanation found_;
};

}  // namespace

std::set<std::size_t> plates_of(const Station& station) {
  std::set<std::size_t> plates;
  for (const Sighting& sighting : station.sightings) plates.insert(sighting.plate);
  return plates;
}

std::set<std::size_t> plates_near(std::span<const Station> stations, std::size_t plate) {
  std::set<std::size_t> near;
  for (const Station& station : stations) {
    const std::set<std::size_t> seen = plates_of(station);
    if (seen.contains(plate)) near.insert(seen.begin(), seen.end());
  }
  return near;
}

std::vector<SightedPair> compare_pairs(const AdjustmentProblem& problem) {
  std::vector<SightedPair> pairs;
  for (std::size_t s = 0; s < problem.stations.size(); ++s) {
    const std::vector<Sighting>& seen = problem.stations[s].sightings;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t j = i + 1; j < seen.size(); ++j) {
        if (seen[i].plate == seen[j].plate) continue;
        pairs.push_back(
            {s, {i, j}, {seen[i].plate, seen[j].plate}, fit_together(problem, seen[i], seen[j])});
      }
    }
  }
  return pairs;
}

// The rest of all six after subtracting the turn belongs to the shift: where two tags turn alike,
// little of a shift can be the tilt of one of them.
double excess(const PlateOffset& offset) {
  const double by_shift = offset.chi_square - offset.turn_chi_square;
  return std::max({by_shift / chi_square_limit(3, kShiftGate),
                   offset.shift_chi_square / chi_square_limit(3, kGate),
                   offset.turn_chi_square / chi_square_limit(3, kGate),
                   offset.chi_square / chi_square_limit(6, kGate)});
}

bool fits_badly(const Station& station, double chi_square) {
  return chi_square > chi_square_limit(corner_degrees(station), kStationGate);
}

std::vector<std::size_t> neighbours(const AdjustmentProblem& problem,
                                    const std::vector<PlateFreedom>& freed,
                                    const Adjustment& adjustment, std::size_t plate) {
  const std::set<std::size_t> seen = plates_near(problem.stations, plate);
  std::vector<std::size_t> list(seen.begin(), seen.end());
  std::erase_if(list, [&](std::size_t i) {
    return i == plate || freed[i] != PlateFreedom::none || !adjustment.offsets[i];
  });
  std::ranges::stable_sort(list, std::ranges::greater{},
                           [&](std::size_t i) { return adjustment.offsets[i]->chi_square; });
  if (list.size() > kMostRivals) list.resize(kMostRivals);
  return list;
}

int faults_of(const PlateExplanation& explanation) {
  int faults = static_cast<int>(explanation.left_out.size() + explanation.copies.size() +
                                explanation.mixed.size());
  for (std::size_t i = 0; i < explanation.freed.size(); ++i) {
    faults += explanation.accuses(i) ? 1 : 0;
  }
  return faults;
}

double cost_of(const PlateExplanation& explanation) {
  if (!explanation.adjustment) return std::numeric_limits<double>::infinity();
  double cost = explanation.adjustment->chi_square;
  for (const Station& station : explanation.problem.stations) cost -= corner_degrees(station);
  return cost;
}

void keep_comparable(AdjustmentProblem& problem) {
  for (Station& station : problem.stations) {
    std::erase_if(station.sightings,
                  [&](Sighting& sighting) { return !make_consistent(problem, sighting); });
  }
  std::erase_if(problem.stations,
                [](const Station& station) { return plates_of(station).size() < 2; });
}

std::vector<Station> apart(const Station& station) {
  std::map<std::size_t, Station> by_camera;
  for (const Sighting& sighting : station.sightings) {
    by_camera[sighting.camera].sightings.push_back(sighting);
  }
  std::vector<Station> parts;
  for (auto& [camera, part] : by_camera) {
    part.name = station.name;
    if (plates_of(part).size() > 1) parts.push_back(std::move(part));
  }
  return parts;
}

PlateExplanation explain(AdjustmentProblem problem, const Given& given) {
  PlateExplanation found = PlateSearch(problem, given).run();
  if (found.adjustment || found.copies.empty()) return found;
  // A plate in the place of another also looks as if the one beside it were a second copy.
  problem.unseen.clear();
  return PlateSearch(std::move(problem), given).run();
}

}  // namespace tagsmith::detail
