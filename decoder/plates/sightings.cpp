// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/sightings.hpp"

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

namespace tagsmith::detail {
namespace {

// FNV-1a, 64 bits: it is the same on every machine, and so is the choice.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 1099511628211ULL;
  }
  return hash;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;

}  // namespace

void SightingPick::count(std::span<const SightedTag> sighted) {
  for (const SightedTag& tag : sighted) {
    const auto number = static_cast<std::uint32_t>(tags_.size());
    seen_.push_back({hash_of(tag.station), tags_.emplace(tag.tag, number).first->second});
  }
}

// Why: docs/decisions/0015-files-and-ledger.md.
void SightingPick::choose() {
  std::ranges::sort(seen_);
  seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
  struct Group {
    std::size_t begin = 0;
    std::size_t size = 0;
  };
  std::vector<Group> stations;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const bool goes_on = i > 0 && seen_[i].station == seen_[i - 1].station;
    if (!goes_on) stations.push_back({i, 0});
    ++stations.back().size;
  }
  std::erase_if(stations, [](const Group& group) { return group.size < 2; });
  std::ranges::sort(stations, [&](const Group& a, const Group& b) {
    return std::tuple(b.size, seen_[a.begin].station) < std::tuple(a.size, seen_[b.begin].station);
  });
  std::map<Pair, std::size_t> together;
  for (const Group& group : stations) {
    const std::span tags(seen_.data() + group.begin, group.size);
    bool is_new = false;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      for (std::size_t j = i + 1; j < tags.size(); ++j) {
        is_new = is_new || together[{tags[i].tag, tags[j].tag}] < most_;
      }
    }
    if (!is_new) continue;
    chosen_.insert(tags.front().station);
    for (std::size_t i = 0; i < tags.size(); ++i) {
      for (std::size_t j = i + 1; j < tags.size(); ++j) ++together[{tags[i].tag, tags[j].tag}];
    }
  }
  seen_.clear();
  seen_.shrink_to_fit();
}

void SightingPick::take(std::span<const SightedTag> sighted) {
  for (const SightedTag& tag : sighted) {
    if (chosen_.contains(hash_of(tag.station))) taken_.push_back(tag);
  }
}

std::vector<SightedTag> SightingPick::taken() const {
  std::vector<SightedTag> sorted = taken_;
  std::ranges::sort(sorted, {}, [](const SightedTag& tag) {
    const auto& p = tag.seen.corners[0];
    return std::tuple(std::string_view(tag.station), tag.camera, std::string_view(tag.tag), p.x,
                      p.y);
  });
  return sorted;
}

}  // namespace tagsmith::detail
