// SPDX-License-Identifier: Apache-2.0
// Looks for wrong readings among feature frames with anything inside, degraded in every way at once
// (mass_picture.hpp), half of them read with a code book of 400 codes; and compares the stated
// confidence with what was right. Every picture depends on its number alone.
// Usage: bench_read_mass [COUNT] [FIRST] [FILE...]
// Without a file, reads the pictures and tables them. With one, adds to it chunk by chunk what is
// not in it yet, so that a long run can be broken off and gone on with, and tables all that the
// files hold of these pictures. Only what this very program added counts: chunks of another
// reader are left out, and said to be.
#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "decoder/reader/reader.hpp"
#include "tests/bench/mass_picture.hpp"

using namespace tagsmith::detail;

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

// What is known of the codes beforehand: the check digit's scheme, not even that, or a code book.
enum class Mode { scheme, either, book, count };
constexpr auto kModes = static_cast<std::size_t>(Mode::count);
constexpr std::array<const char*, kModes> kModeNames{"scheme named", "either scheme", "code book"};

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
Outcome run_one(std::uint64_t number, const std::vector<Digits>& codes) {
  constexpr double kLeastConfidence = 0.3;
  const mass::Picture picture = mass::draw(number);
  std::mt19937_64 random(number ^ 0x9e3779b97f4a7c15ULL);
  Outcome outcome;
  outcome.kind = picture.kind;
  const bool with_book = random() % 2 == 0;
  ReadOptions options;
  if (random() % 2 == 0) options.check = CheckDigit::gs1;
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

constexpr int kDecades = 9;  // of doubt, the last one open

struct KindTally {
  long shown = 0;
  long read = 0;  // and right
  long wrong = 0;
};

struct DoubtTally {
  long right = 0;
  long wrong = 0;
  double stated = 0;  // sum of doubts
};

// What came of some pictures; sums add up.
struct Tables {
  std::array<std::array<KindTally, kModes>, static_cast<std::size_t>(mass::Kind::count)> kinds{};
  std::array<std::array<DoubtTally, kDecades>, kModes> doubts{};  // by mode and -log10
  std::vector<std::string> wrong;                                 // accepted
  std::vector<std::string> nearly;  // wrong, refused, doubt less than 1 %
};

void count(const Outcome& outcome, Tables& tables) {
  constexpr double kNearly = 0.01;
  const auto mode = static_cast<std::size_t>(outcome.mode);
  KindTally& kind = tables.kinds[static_cast<std::size_t>(outcome.kind)][mode];
  ++kind.shown;
  if (!outcome.is_read) return;
  if (outcome.accepted) ++(outcome.right ? kind.read : kind.wrong);
  if (!outcome.right && outcome.accepted) tables.wrong.push_back(outcome.story);
  if (!outcome.right && !outcome.accepted && outcome.doubt < kNearly) {
    tables.nearly.push_back(outcome.story);
  }
  const double decade = std::floor(-std::log10(std::max(outcome.doubt, 1e-16)));
  const auto bin = static_cast<std::size_t>(std::clamp(decade, 0.0, kDecades - 1.0));
  DoubtTally& tally = tables.doubts[mode][bin];
  ++(outcome.right ? tally.right : tally.wrong);
  tally.stated += outcome.doubt;
}

Tables read_chunk(std::uint64_t first, std::uint64_t size, const std::vector<Digits>& codes) {
  std::atomic<std::uint64_t> next = 0;
  std::mutex guard;
  Tables tables;
  const auto work = [&] {
    for (std::uint64_t i = next++; i < size; i = next++) {
      const Outcome outcome = run_one(first + i, codes);
      const std::scoped_lock lock(guard);
      count(outcome, tables);
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    threads.emplace_back(work);
  }
  threads.clear();
  return tables;
}

// A chunk of a run as lines of text.
std::string to_text(const Tables& tables, std::uint64_t first, std::uint64_t size,
                    const std::string& program) {
  std::string text = fmt::format("chunk {} {} {}\n", first, size, program);
  for (std::size_t mode = 0; mode < kModes; ++mode) {
    for (std::size_t kind = 0; kind < tables.kinds.size(); ++kind) {
      const KindTally& tally = tables.kinds[kind][mode];
      if (tally.shown == 0) continue;
      text +=
          fmt::format("kind {} {} {} {} {}\n", kind, mode, tally.shown, tally.read, tally.wrong);
    }
    for (std::size_t decade = 0; decade < kDecades; ++decade) {
      const DoubtTally& tally = tables.doubts[mode][decade];
      if (tally.right + tally.wrong == 0) continue;
      text += fmt::format("doubt {} {} {} {} {:.6g}\n", decade, mode, tally.right, tally.wrong,
                          tally.stated);
    }
  }
  for (const std::string& story : tables.wrong) text += "wrong " + story + "\n";
  for (const std::string& story : tables.nearly) text += "nearly " + story + "\n";
  return text + fmt::format("end {}\n", first);
}

void add(const KindTally& part, KindTally& sum) {
  sum.shown += part.shown;
  sum.read += part.read;
  sum.wrong += part.wrong;
}

void add(const DoubtTally& part, DoubtTally& sum) {
  sum.right += part.right;
  sum.wrong += part.wrong;
  sum.stated += part.stated;
}

void add(const Tables& part, Tables& sum) {
  for (std::size_t mode = 0; mode < kModes; ++mode) {
    for (std::size_t kind = 0; kind < sum.kinds.size(); ++kind) {
      add(part.kinds[kind][mode], sum.kinds[kind][mode]);
    }
    for (std::size_t decade = 0; decade < kDecades; ++decade) {
      add(part.doubts[mode][decade], sum.doubts[mode][decade]);
    }
  }
  sum.wrong.insert(sum.wrong.end(), part.wrong.begin(), part.wrong.end());
  sum.nearly.insert(sum.nearly.end(), part.nearly.begin(), part.nearly.end());
}

constexpr std::uint64_t kChunk = 1000;  // pictures, from a multiple of so many after the first

// The complete chunks that files hold of a range of pictures, added up.
struct Run {
  Tables sum;
  std::set<std::uint64_t> done;  // first pictures of the chunks
  int of_others = 0;             // chunks that another program made
};

void add_line(const std::string& line, Tables& tables) {
  std::istringstream in(line);
  std::string word;
  std::size_t index = 0, mode = 0;
  in >> word;
  if (word == "wrong" || word == "nearly") {
    (word == "wrong" ? tables.wrong : tables.nearly).push_back(line.substr(word.size() + 1));
    return;
  }
  in >> index >> mode;
  if (word == "kind" && index < tables.kinds.size() && mode < kModes) {
    KindTally& tally = tables.kinds[index][mode];
    in >> tally.shown >> tally.read >> tally.wrong;
  } else if (word == "doubt" && index < kDecades && mode < kModes) {
    DoubtTally& tally = tables.doubts[mode][index];
    in >> tally.right >> tally.wrong >> tally.stated;
  }
}

void read_file(const std::string& path, const std::string& program, std::uint64_t first,
               std::uint64_t end, Run& run) {
  std::ifstream file(path);
  std::string line;
  bool is_ours = false, counts = false;  // the chunk at hand
  Tables tables;
  while (std::getline(file, line)) {
    std::istringstream in(line);
    std::string word, by;
    std::uint64_t number = 0, size = 0;
    in >> word >> number;
    if (word == "chunk") {
      in >> size >> by;
      tables = {};
      is_ours = by == program;
      counts = number >= first && number < end && size == std::min(kChunk, end - number);
    } else if (word == "end" && counts) {
      counts = false;
      if (!is_ours) ++run.of_others;
      if (is_ours && run.done.insert(number).second) add(tables, run.sum);
    } else if (counts) {
      add_line(line, tables);
    }
  }
}

// What tells this program from one with another reader: a hash of it (FNV-1a).
std::string this_program() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  std::uint64_t hash = 14695981039346656037ULL;
  for (std::istreambuf_iterator<char> at(file), end; at != end; ++at) {
    hash = (hash ^ static_cast<unsigned char>(*at)) * 1099511628211ULL;
  }
  return fmt::format("{:016x}", hash);
}

void print_kinds(const Tables& tables) {
  fmt::print("| what was in the frame |");
  for (const char* mode : kModeNames) fmt::print(" {}: shown | read | wrong |", mode);
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|\n");
  std::array<KindTally, kModes> all{};
  const auto print_cells = [](const std::array<KindTally, kModes>& tallies) {
    for (const KindTally& tally : tallies) {
      fmt::print(" {} | {} | {} |", tally.shown, tally.read, tally.wrong);
    }
    fmt::print("\n");
  };
  for (std::size_t kind = 0; kind < tables.kinds.size(); ++kind) {
    fmt::print("| {} |", mass::name_of(static_cast<mass::Kind>(kind)));
    print_cells(tables.kinds[kind]);
    for (std::size_t mode = 0; mode < kModes; ++mode) add(tables.kinds[kind][mode], all[mode]);
  }
  fmt::print("| all |");
  print_cells(all);
}

void print_doubts(const Tables& tables) {
  fmt::print("| stated doubt |");
  for (const char* mode : kModeNames)
    fmt::print(" {}: readings | wrong | stated | observed |", mode);
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t decade = 0; decade < kDecades; ++decade) {
    fmt::print("| {} |", decade + 1 < kDecades ? fmt::format("1e-{} to 1e-{}", decade, decade + 1)
                                               : fmt::format("less than 1e-{}", decade));
    for (std::size_t mode = 0; mode < kModes; ++mode) {
      const DoubtTally& tally = tables.doubts[mode][decade];
      const auto readings = static_cast<double>(tally.right + tally.wrong);
      const double per_reading = readings > 0 ? 1 / readings : 0;
      fmt::print(" {} | {} | {:.1e} | {:.2g} |", tally.right + tally.wrong, tally.wrong,
                 per_reading * tally.stated, per_reading * static_cast<double>(tally.wrong));
    }
    fmt::print("\n");
  }
}

// How many readings were believed, how many of them were wrong, and what share of wrong ones that
// leaves possible (Clopper and Pearson's upper bound at 95 %, by its approximation for few).
void print_bound(const Tables& tables) {
  long read = 0, wrong = 0, shown = 0;
  for (const auto& modes : tables.kinds) {
    for (const KindTally& tally : modes) {
      shown += tally.shown;
      read += tally.read;
      wrong += tally.wrong;
    }
  }
  const long believed = read + wrong;
  // Half the 95 % quantile of chi-square with 2 (wrong + 1) degrees of freedom (Wilson, Hilferty).
  const auto half = static_cast<double>(wrong + 1);
  const double root = 1 - 1 / (9 * half) + 1.645 / std::sqrt(9 * half);
  const double most = wrong == 0 ? 3.0 : half * root * root * root;
  fmt::print(
      "\n{} frames: {} readings were believed, {} of them wrong. At 95 % no more than {:.2g} of "
      "the "
      "readings and {:.2g} of the frames are.\n\n",
      shown, believed, wrong, most / static_cast<double>(std::max(1L, believed)),
      most / static_cast<double>(std::max(1L, shown)));
}

void print(const Tables& tables) {
  print_kinds(tables);
  print_bound(tables);
  print_doubts(tables);
  for (const std::string& story : tables.wrong) fmt::print("WRONG {}\n", story);
  for (const std::string& story : tables.nearly) fmt::print("refused {}\n", story);
}

bool is_number(std::string_view text, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  std::uint64_t total = 10'000, first = 0;
  if ((!arguments.empty() && !is_number(arguments[0], total)) || total < 1 ||
      (arguments.size() > 1 && !is_number(arguments[1], first))) {
    fmt::print(stderr, "usage: bench_read_mass [COUNT] [FIRST] [FILE...]\n");
    return 2;
  }
  const std::span files(arguments.begin() + std::min<std::ptrdiff_t>(2, std::ssize(arguments)),
                        arguments.end());
  const std::string program = this_program();
  Run run;
  for (const std::string& file : files) read_file(file, program, first, first + total, run);
  if (run.of_others > 0) {
    fmt::print(stderr, "{} chunks were made by another program and do not count\n", run.of_others);
  }
  const std::vector<Digits> codes = code_book();
  const std::clock_t start = std::clock();
  std::uint64_t read = 0;
  for (std::uint64_t at = first; at < first + total; at += kChunk) {
    if (run.done.contains(at)) continue;
    const std::uint64_t size = std::min(kChunk, first + total - at);
    const Tables tables = read_chunk(at, size, codes);
    add(tables, run.sum);
    read += size;
    if (files.empty()) continue;
    std::ofstream(files[0], std::ios::app) << to_text(tables, at, size, program) << std::flush;
  }
  print(run.sum);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  fmt::print(stderr, "{} pictures read, {:.2f} ms of one processor each\n", read,
             1e3 * seconds / static_cast<double>(std::max<std::uint64_t>(1, read)));
  return 0;
}
