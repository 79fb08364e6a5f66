// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/pieces.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace tagsmith::detail::bench {
namespace {

constexpr std::uint64_t kChunk = 1000;  // pictures, from a multiple of so many after the first

// What tells this program from one with another reader: a hash of it (FNV-1a).
std::string this_program() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  std::uint64_t hash = 14695981039346656037ULL;
  for (std::istreambuf_iterator<char> at(file), end; at != end; ++at) {
    hash = (hash ^ static_cast<unsigned char>(*at)) * 1099511628211ULL;
  }
  return fmt::format("{:016x}", hash);
}

Sums read_chunk(const Series& series, std::uint64_t first, std::uint64_t size) {
  std::mutex guard;
  Sums sums;
  tbb::parallel_for(std::uint64_t{0}, size, [&](std::uint64_t i) {
    const Sums one = series.read(first + i);
    const std::scoped_lock lock(guard);
    sums += one;
  });
  return sums;
}

// A chunk as lines of text. A host that is killed while it writes leaves one without its end, which
// does not count; the next begins on a line of its own.
std::string to_text(const Sums& sums, const std::string& maker, std::uint64_t first,
                    std::uint64_t size) {
  std::string text = fmt::format("\nchunk {} {} {}\n", first, size, maker);
  for (const auto& [name, count] : sums.counts) text += fmt::format("sum {} {:.9g}\n", name, count);
  for (const std::string& story : sums.stories) text += "story " + story + "\n";
  return text + fmt::format("end {}\n", first);
}

void add_line(const std::string& line, Sums& sums) {
  std::istringstream in(line);
  std::string word, name;
  double count = 0;
  in >> word;
  if (word == "story") sums.stories.push_back(line.substr(word.size() + 1));
  if (word == "sum" && in >> name >> count) sums.counts[name] += count;
}

// The complete chunks that a file holds of a range of pictures; their first pictures join `done`.
void read_file(const std::string& path, const std::string& maker, const Range& range,
               Gathered& gathered, std::set<std::uint64_t>& done) {
  std::ifstream file(path);
  const std::uint64_t end = range.first + range.count;
  bool is_ours = false, counts = false;  // the chunk at hand
  Sums sums;
  for (std::string line; std::getline(file, line);) {
    std::istringstream in(line);
    std::string word, by;
    std::uint64_t number = 0, size = 0;
    in >> word;
    if (word == "chunk" && in >> number >> size && std::getline(in >> std::ws, by)) {
      sums = {};
      is_ours = by == maker;
      counts = number >= range.first && number < end && size == std::min(kChunk, end - number);
    } else if (word == "end" && in >> number && counts) {
      counts = false;
      if (!is_ours) ++gathered.of_others;
      if (is_ours && done.insert(number).second) gathered.sums += sums;
    } else if (counts) {
      add_line(line, sums);
    }
  }
}

}  // namespace

Sums& Sums::operator+=(const Sums& other) {
  for (const auto& [name, count] : other.counts) counts[name] += count;
  stories.insert(stories.end(), other.stories.begin(), other.stories.end());
  return *this;
}

double Sums::operator[](const std::string& name) const {
  const auto at = counts.find(name);
  return at == counts.end() ? 0 : at->second;
}

Gathered gather(const Series& series, const Range& range, std::optional<Piece> piece,
                std::span<const std::string> files) {
  const std::string maker = this_program() + " " + series.name;
  Gathered gathered;
  std::set<std::uint64_t> done;
  for (const std::string& file : files) read_file(file, maker, range, gathered, done);
  for (std::uint64_t at = range.first; at < range.first + range.count; at += kChunk) {
    if (done.contains(at)) continue;
    const std::uint64_t size = std::min(kChunk, range.first + range.count - at);
    if (!piece || (at - range.first) / kChunk % piece->of != piece->number - 1) {
      gathered.missing += size;
      continue;
    }
    const Sums sums = read_chunk(series, at, size);
    gathered.sums += sums;
    gathered.read += size;
    if (files.empty()) continue;
    std::ofstream(files[0], std::ios::app) << to_text(sums, maker, at, size) << std::flush;
  }
  std::ranges::sort(gathered.sums.stories);
  return gathered;
}

}  // namespace tagsmith::detail::bench
