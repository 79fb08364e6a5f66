// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/rules.hpp"

#include <algorithm>
#include <ranges>

namespace tagsmith::detail {
namespace {

constexpr std::string_view kDocument =
#include "docs/rules.md.inc"
    ;

}  // namespace

std::vector<Rule> rules_in(std::string_view document) {
  constexpr std::string_view begin = "| `", end = " |", between = " | ";
  std::vector<Rule> rules;
  for (const auto& part : std::views::split(document, '\n')) {
    std::string_view row(part.begin(), part.end());
    if (!row.starts_with(begin) || !row.ends_with(end)) continue;
    row = row.substr(begin.size(), row.size() - begin.size() - end.size());
    std::vector<std::string_view> columns;
    for (const auto& column : std::views::split(row, between)) {
      columns.emplace_back(column.begin(), column.end());
    }
    if (columns.size() < 3 || !columns[0].ends_with('`')) continue;
    columns[0].remove_suffix(1);
    columns.resize(4);
    rules.push_back({columns[0], columns[1], columns[2], columns[3]});
  }
  return rules;
}

const Rule* find_rule(std::string_view code, std::span<const Rule> among) {
  const auto found = std::ranges::find(among, code, &Rule::code);
  return found == among.end() ? nullptr : &*found;
}

std::span<const Rule> rules() {
  static const std::vector<Rule> all = rules_in(kDocument);
  return all;
}

const Rule* find_rule(std::string_view code) { return find_rule(code, rules()); }

}  // namespace tagsmith::detail
