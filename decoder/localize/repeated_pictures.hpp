// SPDX-License-Identifier: Apache-2.0
// Pictures that another measurement has, too. A live camera's noise makes no two pictures alike to
// the last bit: such a picture shows where the vehicle was at another time. A camera that hangs
// repeats its last picture, and the list of a run may have copies.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
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
  // The images that no earlier measurement had. Of the others the observation gets a fault each.
  // `measurement`: its number, by which it may be asked for again.
  std::vector<CameraImage> new_ones(std::span<const CameraImage> images, std::size_t measurement,
                                    Observation& observation);

 private:
  struct Seen {
    std::uint64_t picture = 0;
    std::size_t measurement = 0;
  };
  std::deque<Seen> seen_;  // the latest last
};

// Takes what was seen in pictures that several rows of a run or several cameras have out of all of
// them, and adds a fault to each: nothing tells whose picture it is.
void leave_out_repeated(std::vector<Observation>& rows);

}  // namespace tagsmith::detail
