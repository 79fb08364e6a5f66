// SPDX-License-Identifier: Apache-2.0
// Looks for wrong readings among feature frames with anything inside, degraded in every way at once
// (mass_picture.hpp), half of them read with a code book of 400 codes; and compares the stated
// confidence with what was right. Every picture depends on its number alone, so that a long run can
// be made in parts. Usage: bench_read_mass [COUNT] [FIRST] [-v]
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "decoder/reader/reader.hpp"
#include "tests/bench/mass_picture.hpp"

using namespace tagsmith;

namespace {

constexpr std::size_t kBookSize = 400;

// A survey's codes: besides random ones, neighbours that differ in a digit and the check digit.
std::vector<Digits> code_book() {
  std::mt19937_64 random(400);
  std::vector<Digits> book;
  while (book.size() < kBookSize) {
    Digits code = mass::random_code(random);
    for (int k = 0; k < 8; ++k) {
      book.push_back(code);
      code[7] = static_cast<std::uint8_t>((code[7] + 1) % 10);
      code.back() = check_digit(CheckDigit::gs1, std::span(code).first<11>());
    }
  }
  return book;
}

struct Outcome {
  mass::Kind kind = mass::Kind::tag;
  bool with_book = false;
  bool right = false;
  bool wrong = false;
  double confidence = 0;
  std::string story;
};

// What may be read in the picture: the tag's code, and that of a spoilt symbol which still looks
// most like what it was. A character that is no digit must not be read at all.
bool may_be_read(const mass::Picture& picture) {
  return picture.kind == mass::Kind::tag || picture.kind == mass::Kind::misshapen ||
         picture.kind == mass::Kind::moved_edge;
}

// Half of the pictures are read with a book, which holds the code of two tags of three; the others
// are strangers, whose codes must not be taken for one of the book.
Outcome run_one(std::uint64_t number, const std::vector<Digits>& codes) {
  const mass::Picture picture = mass::draw(number);
  std::mt19937_64 random(number ^ 0x9e3779b97f4a7c15ULL);
  Outcome outcome;
  outcome.kind = picture.kind;
  outcome.with_book = random() % 2 == 0;
  ReadOptions options;
  if (random() % 2 == 0) options.check = CheckDigit::gs1;
  options.min_confidence = 0.3;
  bool known = may_be_read(picture);
  if (outcome.with_book) {
    options.code_book = codes;
    const bool stranger = random() % 3 == 0;
    known = known && !stranger;
    Digits& entry = options.code_book.front();
    if (!stranger) {
      entry = picture.code;
      entry.back() = check_digit(CheckDigit::gs1, std::span(entry).first<11>());
    }
  }
  for (const Reading& reading : read_tags(picture.image.view(), options).tags) {
    const bool right = known && reading.digits == picture.code;
    outcome.right = outcome.right || right;
    if (!right) outcome.wrong = true;
    if (right || reading.confidence > outcome.confidence) outcome.confidence = reading.confidence;
    if (right) continue;
    outcome.confidence = reading.confidence;
    outcome.story = fmt::format(
        "{} {}{}: {} for {}, confidence 1 - {:.2g}, {:.2f} px/module, blur {:.2f}, noise {:.1f}, "
        "growth {:.2f}",
        number, mass::name_of(picture.kind), outcome.with_book ? " with a book" : "",
        to_string(reading.digits), to_string(picture.code), 1 - reading.confidence,
        picture.module_px, picture.blur_px, picture.noise, picture.growth);
    break;
  }
  return outcome;
}

struct Tally {
  int shown = 0;
  int right = 0;
  int wrong = 0;
};

struct Tables {
  std::map<std::pair<int, bool>, Tally> kinds;
  std::array<std::map<int, Tally>, 2> doubts;  // without and with a book; by -log10 of the doubt
};

void count(const Outcome& outcome, bool verbose, Tables& tables) {
  Tally& kind = tables.kinds[{static_cast<int>(outcome.kind), outcome.with_book}];
  ++kind.shown;
  const bool sure = outcome.confidence >= (outcome.with_book ? kSureWithBook : kSureAlone);
  kind.right += outcome.right && !outcome.wrong && sure ? 1 : 0;
  kind.wrong += outcome.wrong && sure ? 1 : 0;
  if (outcome.wrong && (sure || (verbose && outcome.confidence > 0.99))) {
    fmt::print("{} {}\n", sure ? "WRONG" : "doubted", outcome.story);
    std::fflush(stdout);
  }
  if (!outcome.right && !outcome.wrong) return;
  const double doubt = -std::log10(std::max(1 - outcome.confidence, 1e-8));
  Tally& bin = tables.doubts[outcome.with_book ? 1 : 0][static_cast<int>(std::floor(doubt))];
  bin.right += outcome.wrong ? 0 : 1;
  bin.wrong += outcome.wrong ? 1 : 0;
}

void print(const Tables& tables) {
  fmt::print(
      "| what was in the frame | code book | shown | read | wrong, stated as sure |\n"
      "|---|---|---|---|---|\n");
  Tally all;
  for (const auto& [key, tally] : tables.kinds) {
    fmt::print("| {} | {} | {} | {} | {} |\n", mass::name_of(static_cast<mass::Kind>(key.first)),
               key.second ? "400" : "none", tally.shown, tally.right, tally.wrong);
    all.shown += tally.shown;
    all.right += tally.right;
    all.wrong += tally.wrong;
  }
  fmt::print("| all | | {} | {} | {} |\n", all.shown, all.right, all.wrong);
  for (std::size_t book = 0; book < 2; ++book) {
    fmt::print(
        "\n| stated doubt, {} code book | readings | wrong | observed |\n|---|---|---|---|\n",
        book == 1 ? "with a" : "no");
    for (const auto& [doubt, tally] : tables.doubts[book]) {
      const int readings = tally.right + tally.wrong;
      fmt::print("| 1e-{} to 1e-{} | {} | {} | {:.2g} |\n", doubt, doubt + 1, readings, tally.wrong,
                 static_cast<double>(tally.wrong) / readings);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool verbose = std::erase(arguments, "-v") > 0;
  const int total = !arguments.empty() ? std::atoi(arguments[0].c_str()) : 10000;
  const std::uint64_t first =
      arguments.size() > 1 ? std::strtoull(arguments[1].c_str(), nullptr, 10) : 0;
  if (total < 1) {
    fmt::print(stderr, "usage: bench_read_mass [COUNT] [FIRST] [-v]\n");
    return 2;
  }
  std::atomic<int> next = 0;
  std::mutex guard;
  Tables tables;
  const std::vector<Digits> codes = code_book();
  const auto work = [&] {
    for (int i = next++; i < total; i = next++) {
      const Outcome outcome = run_one(first + static_cast<std::uint64_t>(i), codes);
      const std::scoped_lock lock(guard);
      count(outcome, verbose, tables);
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    threads.emplace_back(work);
  }
  threads.clear();
  print(tables);
  return 0;
}
