// SPDX-License-Identifier: Apache-2.0
// Which plates do not hang where the survey has them, by all pictures together.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "decoder/localize/plate_adjustment.hpp"

namespace tagsmith {

enum class HangVerdict {
  unchecked,  // never seen together with another plate
  fits,       // hangs as surveyed, to the tolerance
  off,        // hangs elsewhere
  doubtful,   // it or a rival hangs elsewhere: nothing seen tells which
};

// Of a frame that hangs as surveyed and was printed at another size.
struct FrameScale {
  double share = 1;  // of the template's size
  double least = 0;  // difference from 1 that would have been seen in 95 of 100
};

struct PlateCheck {
  HangVerdict verdict = HangVerdict::unchecked;
  std::optional<PlateOffset> offset;  // of a doubtful plate: were it the one
  std::vector<std::size_t> rivals;    // of a doubtful plate
  int stations = 0;                   // that saw it together with another
  // Of a plate that is off: each hangs where the other should, and `offset` is from there.
  std::optional<std::size_t> swapped_with;
  // Of a plate that is off or doubtful: that it hangs in its place and its frame is of this size
  // explains the pictures as well.
  std::optional<FrameScale> scale;
};

struct Consensus {
  std::vector<PlateCheck> plates;
  // Pictures that fit no other plates and places: taken at another moment or by another camera.
  std::vector<std::string> stations_left_out;
  // More than half of the plates disagree: the rig or the survey is not that of these pictures. No
  // plate is accused then.
  bool nothing_fits = false;
};

// Farthest that a corner of a plate's frame may be from its surveyed place.
inline constexpr double kHangTolerance = 0.010;

// A corner of the plate's frame that hangs at this offset, from its surveyed place at most, metres.
double farthest_corner(const SightedPlate& plate, const PlateOffset& offset);

// Exchanges two plates that contradict the rest and in each other's place do not. Then
// tests each plate against all others (PlateOffset) and takes the one that disagrees most out of
// the survey, until those left agree; a plate seldom disagrees by chance (once in 400). Where
// taking out one of its neighbours instead explains the pictures nearly as well (odds of 400),
// either may be the one, and both are doubtful. A plate that disagrees by less than the tolerance
// fits.
Consensus find_consensus(AdjustmentProblem problem, double tolerance = kHangTolerance);

}  // namespace tagsmith
