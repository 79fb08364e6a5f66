// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "decoder/reader/reader.hpp"
#include "tests/bench/campaign.hpp"
#include "tests/bench/crop.hpp"
#include "tests/bench/parts_of_tags.hpp"

namespace tagsmith::detail::bench {
namespace {

std::vector<Digits> random_book(std::mt19937_64& random) {
  constexpr std::size_t kSize = 400;
  std::vector<Digits> book;
  while (book.size() < kSize) book.push_back(mass::random_code(random));
  return book;
}

// How the book's first code is related to the picture's.
enum class Entry {
  same,
  other_digit,  // it differs in one digit
  other_end,    // the digits of the end that is cut off are others
  count
};

Entry draw_entry(Digits& entry, bool keeps_left, std::mt19937_64& random) {
  const auto way = static_cast<Entry>(random() % static_cast<int>(Entry::count));
  const auto change = [&](std::uint8_t& digit) {
    digit = static_cast<std::uint8_t>((digit + 1 + random() % 9) % 10);
  };
  if (way == Entry::other_digit) change(entry[(keeps_left ? 0 : 8) + random() % 4]);
  if (way == Entry::other_end) {
    for (std::size_t i = 0; i < 4; ++i) change(entry[(keeps_left ? 8 : 0) + i]);
  }
  return way;
}

// Counts what was read of a picture; whether that was anything.
bool count_read(std::uint64_t number, const mass::Picture& picture, const ReadResult& result,
                double share, bool in_book, Sums& sums) {
  sums.counts["shown"] = 1;
  for (const PartReading& part : result.parts) {
    const bool is_right = may_show_digits(picture.kind) && shows_digits_of(part, picture.code);
    const bool single = part.candidates.size() == 1;
    const char* what = !is_right ? "wrong" : !in_book ? "alike" : single ? "identified" : "listed";
    ++sums.counts[what];
    if (is_right) continue;
    sums.stories.push_back(fmt::format(
        "WRONG {} {} share {:.2f} code {} read {} ({} candidates), doubt {:.2g}, "
        "{:.2f} px a module, blur {:.2f}",
        number, mass::name_of(picture.kind), share, to_string(picture.code), digits_in_sight(part),
        part.candidates.size(), 1 - part.confidence, picture.module_px, picture.blur_px));
  }
  return !result.tags.empty() || !result.parts.empty();
}

void count_missed(const mass::Picture& picture, bool in_book, bool is_found, Sums& sums) {
  const bool is_whole_kind = picture.kind == mass::Kind::tag && !picture.odd_margins;
  if (!in_book || !is_whole_kind || picture.module_px < kLeastCroppedModule) return;
  sums.counts["tags"] = 1;
  sums.counts["missed"] = is_found ? 0 : 1;
}

Sums read_half(std::uint64_t number) {
  constexpr double kCounts = 0.4;  // of the bars in sight
  const mass::Picture picture = mass::draw(number);
  std::mt19937_64 random(number ^ 0x517cc1b727220a95ULL);
  ReadOptions options;
  options.code_book = random_book(random);
  const GrayView view = picture.image.view();
  const Crop crop = random_crop(picture.corners, view.width, random);
  const GrayView half = cropped(view, crop);
  const FrameCorners corners = moved(picture.corners, {static_cast<double>(-crop.first), 0});
  const double share = share_in_sight(corners, half.width, half.height);
  options.code_book.front() = picture.code;
  const bool keeps_left = corners[0].x >= 0 && corners[0].x < half.width;
  const bool in_book = draw_entry(options.code_book.front(), keeps_left, random) == Entry::same;
  Sums sums;
  const bool is_found = count_read(number, picture, read_tags(half, options), share, in_book, sums);
  if (share >= kCounts) count_missed(picture, in_book, is_found, sums);
  return sums;
}

// Whole frames: every other one with any trouble, every other one with one or three, so that
// something hides digits more often.
Sums read_hidden(std::uint64_t number) {
  constexpr int kTroubles = static_cast<int>(mass::Trouble::count);
  std::mt19937_64 random(number ^ 0x2545f4914f6cdd1dULL);
  const auto trouble = static_cast<mass::Trouble>(random() % kTroubles);
  const mass::Picture picture =
      number % 2 == 0 ? mass::draw(number) : mass::draw_troubled(trouble, number);
  ReadOptions options;
  options.code_book = random_book(random);
  options.code_book.front() = picture.code;
  const bool keeps_left = random() % 2 == 0;
  const bool in_book = draw_entry(options.code_book.front(), keeps_left, random) == Entry::same;
  Sums sums;
  const ReadResult result = read_tags(picture.image.view(), options);
  count_missed(picture, in_book, count_read(number, picture, result, 1, in_book, sums), sums);
  return sums;
}

void print_parts(const Sums& sums) {
  fmt::print(
      "{:.0f} frames: {:.0f} parts identified, {:.0f} among several candidates, {:.0f} strangers "
      "that show a code's digits, {:.0f} wrong. Of {:.0f} tags of the book with 40 % in sight at "
      "{} "
      "px a module {:.0f} were not read.\n",
      sums["shown"], sums["identified"], sums["listed"], sums["alike"], sums["wrong"], sums["tags"],
      kLeastCroppedModule, sums["missed"]);
  const double right = sums["identified"] + sums["listed"] + sums["alike"];
  print_bound(sums["shown"], right + sums["wrong"], sums["wrong"]);
}

}  // namespace

Series half_series() { return {"halves", read_half, print_parts}; }

Series hidden_series() { return {"hidden", read_hidden, print_parts}; }

}  // namespace tagsmith::detail::bench
