// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/sightings.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <string>

#include <doctest/doctest.h>

namespace tagsmith::detail {
namespace {

SightedTag sighting(const std::string& station, const std::string& tag) {
  return {station, 0, tag, {}};
}

std::vector<SightedTag> picked(const std::vector<SightedTag>& all, std::size_t most) {
  SightingPick pick(most);
  for (const SightedTag& tag : all) pick.count({&tag, 1});
  pick.choose();
  pick.take(all);
  return pick.taken();
}

std::set<std::string> stations_of(const std::vector<SightedTag>& sighted) {
  std::set<std::string> names;
  for (const SightedTag& tag : sighted) names.insert(tag.station);
  return names;
}

}  // namespace

TEST_CASE("of many stations those are kept that tie tags together, whatever their order") {
  std::vector<SightedTag> all;
  for (int i = 0; i < 100; ++i) {
    const std::string name = std::to_string(i);
    all.push_back(sighting("pair" + name, "a"));
    all.push_back(sighting("pair" + name, "b"));
    all.push_back(sighting("alone" + name, "b"));
  }
  // Two photos of one station, far apart in the archive.
  all.push_back(sighting("three", "a"));
  all.push_back(sighting("three", "b"));
  all.push_back(sighting("link", "c"));
  std::rotate(all.begin(), all.begin() + 50, all.end());
  all.push_back(sighting("three", "c"));
  all.push_back(sighting("link", "d"));

  const std::vector<SightedTag> kept = picked(all, 5);
  const std::set<std::string> stations = stations_of(kept);
  CHECK(stations.size() == 6);  // of a and b three and four pairs
  CHECK(stations.contains("three"));
  CHECK(stations.contains("link"));
  CHECK(kept.size() == 3 + 2 + 4 * 2);
  for (const std::string& name : stations) CHECK(!name.starts_with("alone"));

  std::ranges::shuffle(all, std::mt19937(7));
  CHECK(stations_of(picked(all, 5)) == stations);
  CHECK(stations_of(picked(all, 1000)).size() == 102);
  CHECK(picked({sighting("x", "a"), sighting("x", "a")}, 5).empty());
}

}  // namespace tagsmith::detail
