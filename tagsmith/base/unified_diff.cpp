// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/unified_diff.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

namespace tagsmith::detail {
namespace {

// With their line ends.
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return lines;
}

enum class Kind : char { kept = ' ', removed = '-', added = '+' };

struct Line {
  Kind kind;
  std::string_view text;
};

// Myers' greedy search. `furthest[k]`: how far the old text is used on diagonal k (lines used of
// the old one less those of the new one), with so many changes.
class ShortestEdit {
 public:
  ShortestEdit(const std::vector<std::string_view>& old_lines,
               const std::vector<std::string_view>& new_lines)
      : old_(old_lines), new_(new_lines) {}

  std::vector<Line> lines() {
    const int most = size(old_) + size(new_);
    furthest_.assign(2 * static_cast<std::size_t>(most) + 3, 0);
    middle_ = most + 1;
    for (int changes = 0; changes <= most; ++changes) {
      steps_.emplace_back(furthest_.begin() + middle_ - changes - 1,
                          furthest_.begin() + middle_ + changes + 2);
      for (int k = -changes; k <= changes; k += 2) {
        if (advance(changes, k)) return traced(changes);
      }
    }
    return {};
  }

 private:
  static int size(const std::vector<std::string_view>& lines) {
    return static_cast<int>(lines.size());
  }

  static std::size_t index(int at) { return static_cast<std::size_t>(at); }

  // Whether the next change on diagonal k is a line of the new text.
  template <class At>
  static bool is_added(int changes, int k, const At& at) {
    return k == -changes || (k != changes && at(k - 1) < at(k + 1));
  }

  bool advance(int changes, int k) {
    const auto at = [&](int d) { return furthest_[index(middle_ + d)]; };
    int x = is_added(changes, k, at) ? at(k + 1) : at(k - 1) + 1;
    while (x < size(old_) && x - k < size(new_) &&
           old_[static_cast<std::size_t>(x)] == new_[static_cast<std::size_t>(x - k)]) {
      ++x;
    }
    furthest_[index(middle_ + k)] = x;
    return x >= size(old_) && x - k >= size(new_);
  }

  std::vector<Line> traced(int changes) const {
    std::vector<Line> lines;
    int x = size(old_), y = size(new_);
    const auto keep_to = [&](int from_x) {
      while (x > from_x) {
        lines.push_back({Kind::kept, old_[static_cast<std::size_t>(--x)]});
        --y;
      }
    };
    for (; changes > 0; --changes) {
      const auto& before = steps_[static_cast<std::size_t>(changes)];
      const auto at = [&](int d) { return before[index(d + changes + 1)]; };
      const int k = x - y;
      const bool added = is_added(changes, k, at);
      keep_to(added ? at(k + 1) : at(k - 1) + 1);
      if (added) {
        lines.push_back({Kind::added, new_[static_cast<std::size_t>(--y)]});
      } else {
        lines.push_back({Kind::removed, old_[static_cast<std::size_t>(--x)]});
      }
    }
    keep_to(0);
    std::ranges::reverse(lines);
    return lines;
  }

  const std::vector<std::string_view>& old_;
  const std::vector<std::string_view>& new_;
  std::vector<int> furthest_;
  int middle_ = 0;
  std::vector<std::vector<int>> steps_;  // of `furthest`, before each number of changes
};

void append_hunk(std::string& text, const std::vector<Line>& lines, std::size_t from,
                 std::size_t to) {
  const auto count = [&](std::size_t begin, std::size_t end, Kind without) {
    return std::count_if(lines.begin() + static_cast<std::ptrdiff_t>(begin),
                         lines.begin() + static_cast<std::ptrdiff_t>(end),
                         [&](const Line& line) { return line.kind != without; });
  };
  const auto range = [&](Kind without) {
    const auto before = count(0, from, without), inside = count(from, to, without);
    return fmt::format("{},{}", inside == 0 ? before : before + 1, inside);
  };
  text += fmt::format("@@ -{} +{} @@\n", range(Kind::added), range(Kind::removed));
  for (std::size_t i = from; i < to; ++i) {
    text += static_cast<char>(lines[i].kind);
    text += lines[i].text;
    if (!lines[i].text.ends_with('\n')) text += "\n\\ No newline at end of file\n";
  }
}

}  // namespace

std::string unified_diff(std::string_view old_name, std::string_view old_text,
                         std::string_view new_name, std::string_view new_text) {
  constexpr std::size_t kAround = 3;
  if (old_text == new_text) return {};
  const auto old_lines = lines_of(old_text), new_lines = lines_of(new_text);
  const std::vector<Line> lines = ShortestEdit(old_lines, new_lines).lines();
  std::string text = fmt::format("--- {}\n+++ {}\n", old_name, new_name);
  std::size_t i = 0;
  while (i < lines.size()) {
    if (lines[i].kind == Kind::kept) {
      ++i;
      continue;
    }
    const std::size_t from = i < kAround ? 0 : i - kAround;
    std::size_t to = i + 1;  // behind the last change that is no more than six lines further
    for (std::size_t k = to; k < std::min(lines.size(), to + 2 * kAround + 1); ++k) {
      if (lines[k].kind != Kind::kept) to = k + 1;
    }
    i = std::min(lines.size(), to + kAround);
    append_hunk(text, lines, from, i);
  }
  return text;
}

}  // namespace tagsmith::detail
