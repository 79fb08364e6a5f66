// SPDX-License-Identifier: Apache-2.0
// Pictures that a measurement of another time has, too. A live camera's noise makes no two pictures
// alike to the last bit: such a picture shows where the vehicle was at another time. A camera that
// hangs repeats its last picture, and the list of a run may have copies. Without times a picture
// that comes twice is told and used.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/localize/locate.hpp"
#include "decoder/localize/observation.hpp"

namespace tagsmith::detail {

// The same for pictures that are alike in all pixels, and for no others in practice.
std::uint64_t fingerprint(const GrayView& picture);

// The pictures of the last measurements while the vehicle drives.
class PictureMemory {
 public:
  // The images that no measurement of another time had. Of the others the observation, which knows
  // its time, gets a fault each.
  std::vector<CameraImage> new_ones(std::span<const CameraImage> images, Observation& observation);

 private:
  struct Seen {
    std::uint64_t picture = 0;
    double time = 0;  // seconds
  };
  std::deque<Seen> seen_;  // the latest last; one that came again counts as late
};

// Takes what was seen in pictures that rows of several times have out of all of these, and adds a
// fault to each: nothing tells when it was taken.
void leave_out_repeated(std::vector<Observation>& rows);

// Of each row, what to say of its pictures that another row has too and that were not left out, for
// want of times; empty where there is nothing.
std::vector<std::string> notes_on_repeated(const std::vector<Observation>& rows);

}  // namespace tagsmith::detail
