// SPDX-License-Identifier: Apache-2.0
// Looks for wrong readings among pictures that are made to break the reader. Every picture depends
// on its number alone.
// Usage: bench_campaign SERIES [COUNT [FIRST [FILE...]]] [--piece K/M | --merge]
// SERIES: frames (with anything inside, degraded in every way at once, mass_picture.hpp), misprints
// (those of them that leave most doubt: one digit of arbitrary widths, nothing given), chains
// (frames through the chains of phones), troubles (one strong trouble each), shadows (that trouble
// alone), halves (cut by the picture's border), hidden (something hides digits), photos:FOLDER
// (photos without a tag). With a file, what is read joins it chunk by chunk, so that a long run can
// be broken off and gone on with. --piece reads the K-th of M pieces, so that hosts share the work;
// --merge reads nothing and tables what all the files hold: exit code 1 where pictures are missing.
// Only what this very program added counts: chunks of another reader are left out, and said to be.
#include "tests/bench/campaign.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

namespace tagsmith::detail::bench {

void print_bound(double pictures, double believed, double wrong) {
  // Half the 95 % quantile of chi-square with 2 (wrong + 1) degrees of freedom (Wilson, Hilferty).
  const double half = wrong + 1;
  const double root = 1 - 1 / (9 * half) + 1.645 / std::sqrt(9 * half);
  const double most = wrong == 0 ? 3.0 : half * root * root * root;
  fmt::print(
      "\n{:.0f} frames: {:.0f} readings were believed, {:.0f} of them wrong. At 95 % no more than "
      "{:.2g} of the readings and {:.2g} of the frames are.\n\n",
      pictures, believed, wrong, most / std::max(1.0, believed), most / std::max(1.0, pictures));
}

namespace {

Result<Series> series_of(const std::string& name) {
  constexpr std::string_view kPhotos = "photos:";
  if (name == "frames") return frame_series(name, mass::draw);
  if (name == "misprints") return frame_series(name, mass::draw_misprinted, true);
  if (name == "chains") return frame_series(name, mass::draw_chained);
  if (name == "troubles") {
    return frame_series(name, [](std::uint64_t number) {
      const auto count = static_cast<std::uint64_t>(mass::Trouble::count);
      return mass::draw_troubled(static_cast<mass::Trouble>(number % count), number);
    });
  }
  if (name == "shadows") {
    return frame_series(name, [](std::uint64_t number) {
      return mass::draw_troubled(mass::Trouble::shadow, number);
    });
  }
  if (name == "halves") return half_series();
  if (name == "hidden") return hidden_series();
  if (name.starts_with(kPhotos)) return photo_series(name.substr(kPhotos.size()));
  return fail("no series '" + name + "'");
}

bool is_number(std::string_view text, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

struct Arguments {
  std::string series;
  Range range;
  std::optional<Piece> piece = Piece();
  std::vector<std::string> files;
};

Result<Piece> parse_piece(std::string_view text) {
  const std::size_t slash = text.find('/');
  Piece piece;
  if (slash == std::string_view::npos || !is_number(text.substr(0, slash), piece.number) ||
      !is_number(text.substr(slash + 1), piece.of) || piece.number < 1 || piece.number > piece.of) {
    return fail(fmt::format("'{}' is no piece such as 3/8", text));
  }
  return piece;
}

Result<Arguments> parse(std::span<const std::string> words) {
  Arguments arguments;
  std::vector<std::string> plain;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--merge") {
      arguments.piece.reset();
    } else if (words[i] == "--piece") {
      const Result<Piece> piece = parse_piece(i + 1 < words.size() ? words[++i] : "");
      if (!piece) return tl::unexpected(piece.error());
      arguments.piece = *piece;
    } else {
      plain.push_back(words[i]);
    }
  }
  if (plain.empty())
    return fail(
        "which series: frames, misprints, chains, troubles, shadows, halves, hidden, "
        "photos:FOLDER?");
  arguments.series = plain[0];
  if (plain.size() > 1 && (!is_number(plain[1], arguments.range.count) || plain[1] == "0")) {
    return fail("'" + plain[1] + "' is no number of pictures");
  }
  if (plain.size() > 2 && !is_number(plain[2], arguments.range.first)) {
    return fail("'" + plain[2] + "' is not the number of a picture");
  }
  if (plain.size() > 3) arguments.files.assign(plain.begin() + 3, plain.end());
  return arguments;
}

Result<int> run(std::span<const std::string> words) {
  const Result<Arguments> arguments = parse(words);
  if (!arguments) return tl::unexpected(arguments.error());
  const Result<Series> series = series_of(arguments->series);
  if (!series) return tl::unexpected(series.error());
  const std::clock_t start = std::clock();
  const Gathered gathered = gather(*series, arguments->range, arguments->piece, arguments->files);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  series->print(gathered.sums);
  for (const std::string& story : gathered.sums.stories) fmt::print("{}\n", story);
  if (gathered.of_others > 0) {
    fmt::print(stderr, "{} chunks were made by another program or series and do not count\n",
               gathered.of_others);
  }
  if (gathered.missing > 0) fmt::print(stderr, "{} pictures are missing\n", gathered.missing);
  fmt::print(stderr, "{} pictures read, {:.2f} ms of one processor each\n", gathered.read,
             1e3 * seconds / std::max(1.0, static_cast<double>(gathered.read)));
  return !arguments->piece && gathered.missing > 0 ? 1 : 0;
}

}  // namespace
}  // namespace tagsmith::detail::bench

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto code = tagsmith::detail::bench::run(words);
  if (code) return *code;
  fmt::print(stderr,
             "bench_campaign: {}\nusage: bench_campaign SERIES [COUNT [FIRST [FILE...]]] "
             "[--piece K/M | --merge]\n",
             code.error().message);
  return 2;
}
