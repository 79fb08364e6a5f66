// SPDX-License-Identifier: Apache-2.0
// Lines of text, and tables whose columns have names. Internal to tagsmith/survey and
// tagsmith/draft.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tagsmith/survey/finding_log.hpp"

namespace tagsmith::detail {

// The text without the byte order mark that it may begin with.
inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

// Calls `use(number, line)` for each line that is not blank, until it returns false. Numbers count
// from 1; a byte order mark is left out.
template <class Use>
void for_each_line(std::string_view text, Use use) {
  text = without_mark(text);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (line.find_first_not_of(" \t\r") != std::string_view::npos && !use(number, line)) return;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

// One line of a table, its fields by the names of their columns, which must outlive it.
class TableRow {
 public:
  TableRow(const std::vector<std::string>& columns, std::vector<std::string> fields, int line,
           FindingLog& log)
      : columns_(columns), fields_(std::move(fields)), line_(line), log_(log) {}

  int line() const { return line_; }

  // The field; empty when the column does not exist.
  const std::string& text(const std::string& column) const {
    static const std::string kNone;
    const std::size_t index = index_of(column);
    return index < fields_.size() ? fields_[index] : kNone;
  }

  // Line and number of the column.
  Place place(const std::string& column) const {
    return {line_, static_cast<int>(index_of(column)) + 1};
  }

  // Returns nothing, for readers to return.
  std::nullopt_t error(const std::string& column, std::string code, std::string message,
                       std::string hint = {}) const {
    return log_.error(place(column), std::move(code), std::move(message), std::move(hint));
  }

 private:
  std::size_t index_of(const std::string& column) const {
    return static_cast<std::size_t>(std::ranges::find(columns_, column) - columns_.begin());
  }

  const std::vector<std::string>& columns_;
  std::vector<std::string> fields_;
  int line_;
  FindingLog& log_;
};

}  // namespace tagsmith::detail
