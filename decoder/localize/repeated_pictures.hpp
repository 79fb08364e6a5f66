// SPDX-License-Identifier: Apache-2.0
// Pictures that a measurement of another time has, too. A live camera's noise makes no two pictures
// identical in every bit: such a picture shows where the vehicle was at another time. A camera that
// hangs repeats its last picture, and the list of a run may have copies. Without times a picture
// that is repeated is reported and used.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/localize/localize_images.hpp"
#include "decoder/localize/observation.hpp"

namespace tagsmith::detail {

// The same for pictures that are alike in all pixels, and for no others in practice.
std::uint64_t fingerprint(const GrayView& picture);

// The pictures of the last measurements while the vehicle drives.
class PictureMemory {
 public:
  // The images that no measurement of another time had. For each of the others the observation,
  // which knows its time, gets a fault.
  std::vector<CameraImage> new_ones(std::span<const CameraImage> images, Observation& observation);

  // Removes from the observation what was seen in pictures that a measurement of another time had,
  // and adds a fault for each.
  void leave_out_known(Observation& observation);

 private:
  // Whether a measurement of another time had it; remembers it otherwise.
  bool is_known(std::uint64_t picture, double time);

  struct Seen {
    std::uint64_t picture = 0;
    double time = 0;  // seconds
  };
  std::deque<Seen> seen_;  // the latest last; one that came again counts as late
};

// Removes from all of these what was seen in pictures that rows of several times have, and adds a
// fault to each: it cannot be determined when the picture was taken.
void leave_out_repeated(std::vector<Observation>& rows);

// For each row, what to say of its pictures that another row has too and that were kept because
// there are no times; empty where there are none.
std::vector<std::string> notes_on_repeated(const std::vector<Observation>& rows);

}  // namespace tagsmith::detail
