// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "decoder/reader/reader.hpp"
#include "tests/bench/campaign.hpp"

namespace tagsmith::detail::bench {
namespace {

constexpr std::size_t kFrameBookSize = 400;

// A survey's codes: besides random ones, neighbours that differ in a digit and the check digit.
std::vector<Digits> code_book() {
  std::mt19937_64 random(400);
  std::vector<Digits> book;
  while (book.size() < kFrameBookSize) {
    Digits code = mass::random_code(random);
    for (int k = 0; k < 8; ++k) {
      book.push_back(code);
      code[7] = static_cast<std::uint8_t>((code[7] + 1) % 10);
      code.back() = check_digit(CheckDigit::gs1, std::span(code).first<11>());
    }
  }
  return book;
}

// What is known of the codes beforehand: the check digit's scheme, not even that, or a code book.
enum class Mode { scheme, either, book, count };
constexpr int kModes = static_cast<int>(Mode::count);
constexpr std::array<const char*, kModes> kModeNames{"scheme named", "either scheme", "code book"};
constexpr int kKinds = static_cast<int>(mass::Kind::count);
constexpr int kDecades = 9;  // of doubt, the last one open

// The names of sums: what came of the frames of a kind, and of the readings of a decade of doubt.
std::string of_kind(int kind, int mode, const char* what) {
  return fmt::format("kind/{}/{}/{}", kind, mode, what);
}

std::string of_doubt(int decade, int mode, const char* what) {
  return fmt::format("doubt/{}/{}/{}", decade, mode, what);
}

// The reading that matters of a picture: a wrong one before a right one.
struct Outcome {
  mass::Kind kind = mass::Kind::tag;
  Mode mode = Mode::scheme;
  bool is_read = false;   // at all, believed or not
  bool accepted = false;  // by the thresholds of the reader
  bool right = false;
  double doubt = 1;
  std::string story;  // of a wrong reading
};

// Half of the pictures are read with a book, which holds the code of two tags of three; the others
// are strangers, whose codes must not be taken for one of the book. What the reader refuses for its
// doubt alone is read again without that test, so that doubts above the thresholds are compared
// too.
Outcome run_one(std::uint64_t number, const mass::Picture& picture,
                const std::vector<Digits>& codes, bool nothing_given) {
  constexpr double kLeastConfidence = 0.3;
  std::mt19937_64 random(number ^ 0x9e3779b97f4a7c15ULL);
  Outcome outcome;
  outcome.kind = picture.kind;
  const bool with_book = random() % 2 == 0 && !nothing_given;
  ReadOptions options;
  if (random() % 2 == 0 && !nothing_given) options.check = CheckDigit::gs1;
  outcome.mode = with_book ? Mode::book : options.check ? Mode::scheme : Mode::either;
  bool known = mass::may_be_read(picture.kind);
  if (with_book) {
    options.code_book = codes;
    const bool stranger = random() % 3 == 0;
    known = known && !stranger;
    Digits& entry = options.code_book.front();
    if (!stranger) {
      entry = picture.code;
      entry.back() = check_digit(CheckDigit::gs1, std::span(entry).first<11>());
    }
  }
  ReadResult result = read_tags(picture.image.view(), options);
  outcome.accepted = !result.tags.empty();
  const auto doubted = [](const Rejection& rejection) {
    return rejection.reason == RejectionReason::doubtful;
  };
  if (!outcome.accepted && std::ranges::any_of(result.rejected, doubted)) {
    options.min_confidence = kLeastConfidence;
    result = read_tags(picture.image.view(), options);
  }
  for (const Reading& reading : result.tags) {
    outcome.is_read = true;
    outcome.right = known && reading.digits == picture.code;
    outcome.doubt = 1 - reading.confidence;
    if (outcome.right) continue;
    outcome.story = fmt::format(
        "{} {}, {}: {} for {}, by {}, doubt {:.2g}, {:.2f} px/module, blur {:.2f}, noise {:.1f}, "
        "growth {:.2f}",
        number, mass::name_of(picture.kind), kModeNames[static_cast<std::size_t>(outcome.mode)],
        to_string(reading.digits), to_string(picture.code), to_string(reading.method),
        outcome.doubt, picture.module_px, picture.blur_px, picture.noise, picture.growth);
    break;
  }
  return outcome;
}

Sums counted(const Outcome& outcome) {
  constexpr double kNearly = 0.01;
  const int mode = static_cast<int>(outcome.mode);
  const int kind = static_cast<int>(outcome.kind);
  Sums sums;
  sums.counts[of_kind(kind, mode, "shown")] = 1;
  if (!outcome.is_read) return sums;
  if (outcome.accepted) sums.counts[of_kind(kind, mode, outcome.right ? "read" : "wrong")] = 1;
  if (!outcome.accepted && outcome.right) sums.counts[of_kind(kind, mode, "refused")] = 1;
  if (!outcome.right && outcome.accepted) sums.stories.push_back("WRONG " + outcome.story);
  if (!outcome.right && !outcome.accepted && outcome.doubt < kNearly) {
    sums.stories.push_back("refused " + outcome.story);
  }
  const double places = std::floor(-std::log10(std::max(outcome.doubt, 1e-16)));
  const int decade = static_cast<int>(std::clamp(places, 0.0, kDecades - 1.0));
  sums.counts[of_doubt(decade, mode, outcome.right ? "right" : "wrong")] = 1;
  sums.counts[of_doubt(decade, mode, "stated")] = outcome.doubt;
  return sums;
}

double of_all_kinds(const Sums& sums, int mode, const char* what) {
  double all = 0;
  for (int kind = 0; kind < kKinds; ++kind) all += sums[of_kind(kind, mode, what)];
  return all;
}

double of_all(const Sums& sums, const char* what) {
  double all = 0;
  for (int mode = 0; mode < kModes; ++mode) all += of_all_kinds(sums, mode, what);
  return all;
}

void print_kinds(const Sums& sums) {
  fmt::print("| what was in the frame |");
  for (const char* mode : kModeNames) fmt::print(" {}: shown | read | wrong |", mode);
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (int kind = 0; kind <= kKinds; ++kind) {
    fmt::print("| {} |", kind < kKinds ? mass::name_of(static_cast<mass::Kind>(kind)) : "all");
    for (int mode = 0; mode < kModes; ++mode) {
      for (const char* what : {"shown", "read", "wrong"}) {
        fmt::print(" {:.0f} |", kind < kKinds ? sums[of_kind(kind, mode, what)]
                                              : of_all_kinds(sums, mode, what));
      }
    }
    fmt::print("\n");
  }
}

void print_doubts(const Sums& sums) {
  fmt::print("| stated doubt |");
  for (const char* mode : kModeNames)
    fmt::print(" {}: readings | wrong | stated | observed |", mode);
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (int decade = 0; decade < kDecades; ++decade) {
    fmt::print("| {} |", decade + 1 < kDecades ? fmt::format("1e-{} to 1e-{}", decade, decade + 1)
                                               : fmt::format("less than 1e-{}", decade));
    for (int mode = 0; mode < kModes; ++mode) {
      const double wrong = sums[of_doubt(decade, mode, "wrong")];
      const double readings = sums[of_doubt(decade, mode, "right")] + wrong;
      const double per_reading = readings > 0 ? 1 / readings : 0;
      fmt::print(" {:.0f} | {:.0f} | {:.1e} | {:.2g} |", readings, wrong,
                 per_reading * sums[of_doubt(decade, mode, "stated")], per_reading * wrong);
    }
    fmt::print("\n");
  }
}

void print_frames(const Sums& sums) {
  const double read = of_all(sums, "read");
  const double wrong = of_all(sums, "wrong");
  const double refused = of_all(sums, "refused");
  print_kinds(sums);
  print_bound(of_all(sums, "shown"), read + wrong, wrong);
  fmt::print("Refused for their doubt alone were {:.0f} right readings: {:.1f} % of the right.\n\n",
             refused, 100 * refused / std::max(1.0, read + refused));
  print_doubts(sums);
}

}  // namespace

Series frame_series(const std::string& name, std::function<mass::Picture(std::uint64_t)> draw,
                    bool nothing_given) {
  const auto read = [draw = std::move(draw), codes = code_book(),
                     nothing_given](std::uint64_t number) {
    return counted(run_one(number, draw(number), codes, nothing_given));
  };
  return {name, read, print_frames};
}

}  // namespace tagsmith::detail::bench
