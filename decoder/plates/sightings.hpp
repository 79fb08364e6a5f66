// SPDX-License-Identifier: Apache-2.0
// Tags as pictures show them, and which of many pictures determine where tags hang.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "decoder/localize/observation.hpp"

namespace tagsmith::detail {

// A tag in a picture: its name in the survey, or its digits if the survey does not have the code.
// Pictures with one station name were taken together.
struct SightedTag {
  std::string station;
  std::size_t camera = 0;  // of the rig
  std::string tag;
  SeenCorners seen;
};

// Stations kept of any two tags that are seen together. More of them add little: the remaining
// errors are those of the survey and the rig.
inline constexpr std::size_t kMostStationsOfAPair = 16;

// Takes all sightings twice, in any order and in portions of any size: first to count, then to keep
// those of the stations that were chosen. The choice does not depend on the order. In between, 16
// bytes are kept for each sighting; the memory kept in the end grows with the pairs of neighbouring
// tags, not with the photos.
class SightingPick {
 public:
  explicit SightingPick(std::size_t most = kMostStationsOfAPair) : most_(most) {}

  // The first time.
  void count(std::span<const SightedTag> sighted);

  // Stations of many tags first; a station is chosen when two of its tags were not yet seen
  // together at `most` others.
  void choose();

  // The second time.
  void take(std::span<const SightedTag> sighted);

  // By station, camera and tag, in whatever order they came.
  std::vector<SightedTag> taken() const;

 private:
  struct Seen {
    std::uint64_t station = 0;  // hash of its name
    std::uint32_t tag = 0;
    auto operator<=>(const Seen&) const = default;
  };

  std::size_t most_;
  std::map<std::string, std::uint32_t> tags_;
  std::vector<Seen> seen_;
  std::set<std::uint64_t> chosen_;
  std::vector<SightedTag> taken_;
};

}  // namespace tagsmith::detail
