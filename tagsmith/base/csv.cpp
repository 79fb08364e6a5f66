// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/csv.hpp"

#include <utility>

#include "tagsmith/base/text.hpp"

namespace tagsmith {
namespace {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char character : text) quoted += character == '"' ? "\"\"" : std::string(1, character);
  return quoted + "\"";
}

}  // namespace

std::optional<std::vector<std::string>> split_csv(std::string_view line) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos || line[start] != '"') {
      const std::size_t end = line.find(',');
      const std::string_view field = trim(line.substr(0, end));
      if (field.find('"') != std::string_view::npos) return std::nullopt;
      fields.emplace_back(field);
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
    fields.push_back(std::move(field));
    const std::size_t end = line.find(',');
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

}  // namespace tagsmith
