// SPDX-License-Identifier: Apache-2.0
// Sums over many pictures that are read in pieces: a run can be broken off and gone on with,
// several hosts can each read a piece of it, and what their files hold is added up.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tagsmith::detail::bench {

// What came of some pictures.
struct Sums {
  std::map<std::string, double> counts;  // by names without spaces
  std::vector<std::string> stories;      // of single pictures, a line each

  Sums& operator+=(const Sums& other);
  double operator[](const std::string& name) const;  // 0 where nothing was counted
};

// Pictures by their numbers; each depends on its number alone.
struct Series {
  std::string name;
  std::function<Sums(std::uint64_t number)> read;  // one picture, from several threads
  std::function<void(const Sums&)> print;
};

struct Range {
  std::uint64_t first = 0;
  std::uint64_t count = 10'000;
};

// The first of one piece is the whole. Pieces share out the chunks of a thousand pictures in turn.
struct Piece {
  std::uint64_t number = 1;
  std::uint64_t of = 1;
};

struct Gathered {
  Sums sums;
  std::uint64_t read = 0;     // pictures that were read now
  std::uint64_t missing = 0;  // pictures of the range that count nowhere yet
  int of_others = 0;          // chunks of files that another program made, which do not count
};

// What the files hold of the range, and what they do not hold of the piece, which is read and added
// to the first file. Without a piece nothing is read. Without files the sums are those of the
// piece alone.
Gathered gather(const Series& series, const Range& range, std::optional<Piece> piece,
                std::span<const std::string> files);

}  // namespace tagsmith::detail::bench
