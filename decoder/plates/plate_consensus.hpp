// SPDX-License-Identifier: Apache-2.0
// Which plates do not hang where the survey has them, determined from all pictures together.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "decoder/plates/plate_adjustment.hpp"
#include "decoder/plates/plate_search.hpp"

namespace tagsmith::detail {

enum class HangVerdict {
  unchecked,  // never seen together with another plate that hangs as surveyed
  fits,       // hangs as surveyed, to the tolerance
  off,        // hangs elsewhere
  doubtful,   // it hangs elsewhere, or something else is wrong: no picture shows which
};

// What else may be wrong instead of a doubtful plate.
enum class HangDoubt {
  none,
  rivals,  // other plates
  row,     // pictures that were not taken together, or another copy of the plate in some of them
  rig,     // the rig's calibration, or the size of all frames
  block,   // a slip in the survey's chain, after which all plates hang elsewhere
  rest,    // too little is left that judges it, or it is chance
};

// Of a frame that was printed at another size.
struct FrameScale {
  // What explains the pictures: one of the two, the size alone, or only both together.
  enum class Cause { size_or_place, size, size_and_place };

  double share = 1;  // of the template's size
  double least = 0;  // difference from 1 that would have been detected in 95 of 100
  Cause cause = Cause::size_or_place;
};

struct PlateCheck {
  HangVerdict verdict = HangVerdict::unchecked;
  std::optional<PlateOffset> offset;  // of a doubtful plate: if it is the wrong one
  HangDoubt doubt = HangDoubt::none;  // of a doubtful plate
  std::vector<std::size_t> rivals;    // of a doubtful plate
  // Of a plate that is off: natural logarithm of the odds over the next explanation of all that
  // were tried (other plates, rows, copies, the rig), in which the plate hangs as surveyed.
  // Infinite where none explains the pictures at all.
  double log_odds = 0;
  int stations = 0;  // that saw it together with another
  // Of a plate that is off: each hangs where the other should, and `offset` is from there.
  std::optional<std::size_t> swapped_with;
  // Of a plate that is off or doubtful: the size of its frame, where that explains the pictures.
  std::optional<FrameScale> scale;
};

// A station whose pictures fit no place of the cameras, and what would explain it.
struct LeftOutStation {
  struct Suspect {
    std::size_t plate = 0;
    std::optional<Pose> world_from_plate;  // where it, or a copy of it, would have to hang
  };
  std::string name;
  std::vector<Suspect> suspects;  // the plates in its pictures
  bool fits_apart = false;        // the pictures of each camera fit separately
};

// A second copy of a plate in the place of one that no picture shows.
struct FoundCopy {
  std::size_t plate = 0;  // the plate whose code it bears
  std::string place;      // the plate whose place it has
  std::vector<std::string> stations;
  HangDoubt doubt = HangDoubt::none;  // what else would explain it
};

struct Consensus {
  std::vector<PlateCheck> plates;
  std::vector<FoundCopy> copies;
  std::vector<MixedStations> mixed;  // every other verdict is based on their exchanged pictures
  std::vector<LeftOutStation> left_out;
  // More than half of the plates disagree, or another calibration explains three plates and more:
  // the rig, the template or the survey is not that of these pictures. No plate is accused then.
  bool nothing_fits = false;
};

// Farthest that a corner of a plate's frame may be from its surveyed place.
inline constexpr double kHangTolerance = 0.010;

// A corner of the plate's frame that hangs at this offset, from its surveyed place at most, metres.
double farthest_corner(const SightedPlate& plate, const PlateOffset& offset);

// The search of plate_search.hpp, and which of its results are certain. A plate that was taken out
// is off when nothing else explains the pictures nearly as well (odds of 400) with no more faults:
// neither a neighbour instead, nor any other plates, nor a row of pictures that were not taken
// together, nor another calibration of the rig or size of all frames. Otherwise it is doubtful, and
// so are its rivals. A plate that disagrees by less than the tolerance fits.
Consensus find_consensus(AdjustmentProblem problem, double tolerance = kHangTolerance);

// The plates by the pictures that connect them, directly or by way of others: each has the number
// of its group. Sightings of plates that do not count connect nothing. `counts`: by plate.
std::vector<std::size_t> tied_groups(std::span<const Station> stations,
                                     const std::vector<bool>& counts);

}  // namespace tagsmith::detail
