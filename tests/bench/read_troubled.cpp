// SPDX-License-Identifier: Apache-2.0
// What the reader manages where cables, dirt, glare, shadows, dust, darkness, motion or a steep
// view make it hard, one cause at a time (mass_picture.hpp), and whether anything is read wrongly
// there; two pictures of three show a tag, the others what must not be read; tags whose bars do not
// stand where their template has them are not counted. Usage: bench_read_troubled
// [PICTURES_PER_CAUSE] [FIRST]
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/reader/reader.hpp"
#include "tests/bench/mass_picture.hpp"
#include "tests/bench/other_readers.hpp"
#include "tests/bench/parts_of_tags.hpp"

using namespace tagsmith::detail;

namespace {

struct Outcome {
  bool is_tag = false;
  bool read = false;
  bool carefully = false;  // by the way for partly covered tags
  bool wrong = false;
  bool astray = false;      // read rightly, with a corner that is not where it is said to be
  bool with_book = false;   // read with a code book
  bool identified = false;  // as a part, with that book
  bool part_astray = false;
  std::string story;
  std::vector<bool> others;
};

// Whether a corner is farther from every true one than its covariance allows: a mirrored picture
// has them in another order.
bool is_astray(const auto& reading, const Quad& corners) {
  constexpr double kAllowed = 0.5;  // pixels
  constexpr double kSigmas = 5;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double off = std::numeric_limits<double>::infinity();
    for (const PixelPoint& corner : corners) {
      off = std::min(off, distance(corner, reading.corners[i]));
    }
    const auto row = static_cast<Eigen::Index>(2 * i);
    const CornerCovariance& covariance = reading.corner_covariance;
    const double sigma = std::sqrt(covariance(row, row) + covariance(row + 1, row + 1));
    if (off > kAllowed && off > kSigmas * sigma) return true;
  }
  return false;
}

// With a book of 400 codes, that of the plate among them.
void read_with_book(const mass::Picture& picture, std::uint64_t number, Outcome& outcome) {
  std::mt19937_64 random(number);
  ReadOptions options;
  while (options.code_book.size() < 400) options.code_book.push_back(mass::random_code(random));
  options.code_book.front() = picture.code;
  const ReadResult result = read_tags(picture.image.view(), options);
  const bool has_digits =
      mass::may_be_read(picture.kind) || picture.kind == mass::Kind::wrong_check;
  for (const Reading& reading : result.tags) {
    const bool right = has_digits && reading.digits == picture.code;
    outcome.with_book = outcome.with_book || (right && outcome.is_tag);
    if (!right) outcome.story = fmt::format("{} with a book", number);
    outcome.wrong = outcome.wrong || !right;
  }
  for (const PartReading& part : result.parts) {
    const bool right =
        bench::may_show_digits(picture.kind) && bench::shows_digits_of(part, picture.code);
    outcome.identified = outcome.identified || (right && outcome.is_tag);
    outcome.part_astray = outcome.part_astray || (right && is_astray(part, picture.corners));
    if (right) continue;
    outcome.wrong = true;
    outcome.story = fmt::format("{} {}: part {} for {}", number, mass::name_of(picture.kind),
                                digits_in_sight(part), to_string(picture.code));
  }
}

Outcome run_one(mass::Trouble trouble, std::uint64_t number) {
  const mass::Picture picture = mass::draw_troubled(trouble, number);
  Outcome outcome;
  outcome.is_tag = picture.kind == mass::Kind::tag && !picture.odd_margins;
  for (const Reading& reading : read_tags(picture.image.view()).tags) {
    const bool right = mass::may_be_read(picture.kind) && reading.digits == picture.code;
    outcome.read = outcome.read || (right && outcome.is_tag);
    outcome.carefully =
        outcome.carefully || (right && outcome.is_tag && reading.method != ReadingMethod::frame);
    outcome.astray = outcome.astray || (right && is_astray(reading, picture.corners));
    if (right) continue;
    outcome.wrong = true;
    outcome.story =
        fmt::format("{} {}, {}: {} for {}, confidence 1 - {:.2g}, {:.2f} px/module", number,
                    mass::name_of(trouble), mass::name_of(picture.kind), to_string(reading.digits),
                    to_string(picture.code), 1 - reading.confidence, picture.module_px);
  }
  read_with_book(picture, number, outcome);
  for (const bench::OtherReader& reader : bench::other_readers()) {
    outcome.others.push_back(outcome.is_tag &&
                             reader.read(picture.image.view()).contains(to_string(picture.code)));
  }
  return outcome;
}

void run_cause(mass::Trouble trouble, std::size_t count, std::uint64_t first) {
  std::vector<Outcome> outcomes(count);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t i) { outcomes[i] = run_one(trouble, first + i); });
  int tags = 0, read = 0, carefully = 0, astray = 0, wrong = 0, book = 0, parts = 0, off = 0;
  std::vector<int> others(bench::other_readers().size());
  for (const Outcome& outcome : outcomes) {
    tags += outcome.is_tag ? 1 : 0;
    read += outcome.read ? 1 : 0;
    carefully += outcome.carefully ? 1 : 0;
    astray += outcome.astray ? 1 : 0;
    wrong += outcome.wrong ? 1 : 0;
    book += outcome.with_book ? 1 : 0;
    parts += outcome.identified ? 1 : 0;
    off += outcome.part_astray ? 1 : 0;
    if (outcome.wrong) fmt::print("WRONG {}\n", outcome.story);
    for (std::size_t r = 0; r < others.size(); ++r) others[r] += outcome.others[r] ? 1 : 0;
  }
  const auto percent = [&](int part) { return 100.0 * part / std::max(1, tags); };
  fmt::print("| {} | {} | {:.0f} % | {:.0f} % | {} | {:.0f} % | {:.0f} % | {} | {} |",
             mass::name_of(trouble), tags, percent(read), percent(carefully), astray, percent(book),
             percent(book + parts), off, wrong);
  for (const int other : others) fmt::print(" {:.0f} % |", percent(other));
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
  if (count < 1) {
    fmt::print(stderr, "usage: bench_read_troubled [PICTURES_PER_CAUSE] [FIRST]\n");
    return 2;
  }
  fmt::print(
      "| cause | tags | read | of them carefully | corners astray | with a book | or a part | "
      "parts astray | wrong |");
  for (const bench::OtherReader& reader : bench::other_readers()) fmt::print(" {} |", reader.name);
  fmt::print("\n|---|---|---|---|---|---|---|---|---|");
  for (std::size_t r = 0; r < bench::other_readers().size(); ++r) fmt::print("---|");
  fmt::print("\n");
  for (int cause = 0; cause < static_cast<int>(mass::Trouble::count); ++cause) {
    run_cause(static_cast<mass::Trouble>(cause), static_cast<std::size_t>(count), first);
  }
  return 0;
}
