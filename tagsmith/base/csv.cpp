// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/csv.hpp"

#include <algorithm>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

// Text that spreadsheets evaluate instead of showing it (OWASP, "CSV injection").
bool is_formula(std::string_view text) {
  return !text.empty() && std::string_view("=+-@\t\r").find(text.front()) != text.npos &&
         !parse_number(text);
}

std::string_view without_apostrophes(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of('\''), text.size()));
  return text;
}

std::string unmarked(std::string_view field) {
  const bool marked = field.starts_with('\'') && is_formula(without_apostrophes(field));
  return std::string(field.substr(marked ? 1 : 0));
}

}  // namespace

std::string csv_field(const std::string& text) {
  std::string shown = (is_formula(without_apostrophes(text)) ? "'" : "") + text;
  if (shown.find_first_of(",\"\t\r\n") == std::string::npos) return shown;
  std::string quoted = "\"";
  for (const char character : shown) {
    quoted += character == '"' ? "\"\"" : std::string(1, character);
  }
  return quoted + "\"";
}

std::optional<std::vector<std::string>> split_csv(std::string_view line, char separator) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t start = line.find_first_not_of(separator == '\t' ? " " : " \t");
    if (start == std::string_view::npos || line[start] != '"') {
      const std::size_t end = line.find(separator);
      const std::string_view field = trim(line.substr(0, end));
      if (field.find('"') != std::string_view::npos) return std::nullopt;
      fields.push_back(unmarked(field));
      if (end == std::string_view::npos) return fields;
      line.remove_prefix(end + 1);
      continue;
    }
    line.remove_prefix(start + 1);
    std::string field;
    while (true) {
      const std::size_t quote = line.find('"');
      if (quote == std::string_view::npos) return std::nullopt;
      field += line.substr(0, quote);
      line.remove_prefix(quote + 1);
      if (line.empty() || line.front() != '"') break;
      field += '"';
      line.remove_prefix(1);
    }
    fields.push_back(unmarked(field));
    const std::size_t end = line.find(separator);
    if (!trim(line.substr(0, end)).empty()) return std::nullopt;
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

std::string csv_row(const std::vector<std::string>& fields) {
  std::string row;
  for (std::size_t i = 0; i < fields.size(); ++i) row += (i == 0 ? "" : ",") + csv_field(fields[i]);
  return row + "\r\n";
}

}  // namespace tagsmith::detail
