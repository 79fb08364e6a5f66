// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/rules.hpp"

#include <algorithm>
#include <optional>
#include <ranges>
#include <string>

#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {

// ---- The catalogue.

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

// ---- Comments that allow.

namespace {

constexpr std::string_view kMark = "# tagsmith:";

struct Allowance {
  int line = 0;  // of the comment
  int column = 0;
  int about_line = 0;  // the line whose findings it allows
  std::string rule;
  bool used = false;
};

bool is_comment(std::string_view line) { return trim(line).starts_with('#'); }

// The line that a comment on a line of its own refers to: the next one that is no comment.
int next_line_of_content(const std::vector<std::string>& lines, std::size_t index) {
  std::size_t next = index + 1;
  while (next < lines.size() && (is_comment(lines[next]) || trim(lines[next]).empty())) ++next;
  return static_cast<int>(next) + 1;
}

Diagnostic fault(const std::string& file, const Allowance& at, std::string code,
                 std::string message, std::string hint) {
  return {
      file,           at.line, at.column, Severity::warning, std::move(code), std::move(message),
      std::move(hint)};
}

// The rule that the words after the mark allow; nothing, with a finding, when they don't say.
std::optional<std::string> allowed_rule(std::string_view words, const std::string& file,
                                        const Allowance& at, std::vector<Diagnostic>& faults) {
  constexpr std::string_view kAllow = "allow ";
  const std::string_view after =
      words.starts_with(kAllow) ? words.substr(kAllow.size()) : std::string_view{};
  const std::size_t colon = after.find(':');
  const std::string rule(trim(after.substr(0, colon)));
  const std::string_view reason =
      colon == std::string_view::npos ? std::string_view{} : trim(after.substr(colon + 1));
  if (find_rule(rule) == nullptr) {
    faults.push_back(fault(file, at, "bad-allow",
                           fmt::format("the comment allows `{}`, expected a rule", rule),
                           "# tagsmith: allow RULE: REASON, with a rule as it stands in brackets "
                           "behind a finding"));
    return std::nullopt;
  }
  if (reason.empty()) {
    faults.push_back(fault(file, at, "bad-allow",
                           "the comment allows " + rule + " without a reason",
                           "# tagsmith: allow " + rule + ": REASON"));
    return std::nullopt;
  }
  return rule;
}

std::vector<Allowance> read_allowances(std::string_view text, const std::string& file,
                                       std::vector<Diagnostic>& faults) {
  std::vector<Allowance> allowances;
  if (text.find(kMark) == std::string_view::npos) return allowances;
  const std::vector<std::string> lines = split(text, '\n');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t mark = lines[i].find(kMark);
    if (mark == std::string::npos) continue;
    Allowance allowance;
    allowance.line = static_cast<int>(i) + 1;
    allowance.column = static_cast<int>(mark) + 1;
    allowance.about_line = is_comment(lines[i]) ? next_line_of_content(lines, i) : allowance.line;
    const std::string_view words = trim(std::string_view(lines[i]).substr(mark + kMark.size()));
    const auto rule = allowed_rule(words, file, allowance, faults);
    if (!rule) continue;
    allowance.rule = *rule;
    allowances.push_back(std::move(allowance));
  }
  return allowances;
}

void remove_allowed(std::vector<Diagnostic>& diagnostics, const std::string& file,
                    std::vector<Allowance>& allowances) {
  std::erase_if(diagnostics, [&](const Diagnostic& diagnostic) {
    if (diagnostic.severity == Severity::error || diagnostic.file != file) return false;
    bool allowed = false;
    for (Allowance& allowance : allowances) {
      if (allowance.rule != diagnostic.code) continue;
      if (diagnostic.line != 0 && diagnostic.line != allowance.about_line) continue;
      allowance.used = true;
      allowed = true;
    }
    return allowed;
  });
}

}  // namespace

std::vector<Diagnostic> allowed_removed(std::vector<Diagnostic> diagnostics,
                                        const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text || diagnostics.empty()) return diagnostics;
  std::vector<Diagnostic> faults;
  std::vector<Allowance> allowances = read_allowances(*text, file.string(), faults);
  remove_allowed(diagnostics, file.string(), allowances);
  return diagnostics;
}

std::vector<Diagnostic> without_allowed(std::vector<Diagnostic> diagnostics, std::string_view text,
                                        const std::string& file) {
  std::vector<Diagnostic> faults;
  std::vector<Allowance> allowances = read_allowances(text, file, faults);
  remove_allowed(diagnostics, file, allowances);
  // With errors some rules were not checked.
  const bool complete = !has_errors(diagnostics);
  for (const Allowance& allowance : allowances) {
    const bool needs_other_file =
        allowance.rule == kUnseenTagRule || allowance.rule == kExchangedCodeRule;
    if (allowance.used || !complete || needs_other_file) continue;
    faults.push_back(fault(file, allowance, "unused-allow",
                           "nothing here is warned of by " + allowance.rule,
                           "remove the comment; errors cannot be allowed"));
  }
  diagnostics.insert(diagnostics.end(), faults.begin(), faults.end());
  return diagnostics;
}

}  // namespace tagsmith::detail
