// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/finding_log.hpp"

#include <algorithm>
#include <tuple>

namespace tagsmith::detail {
namespace {

constexpr int kMostOfOneRule = 100;

}  // namespace

std::nullopt_t FindingLog::error(Place place, std::string code, std::string message,
                                 std::string hint, std::optional<TextEdit> fix) {
  add({file_, place.line, place.column, Severity::error, std::move(code), std::move(message),
       std::move(hint), std::move(fix)});
  return std::nullopt;
}

void FindingLog::warning(Place place, std::string code, std::string message, std::string hint) {
  add({file_, place.line, place.column, Severity::warning, std::move(code), std::move(message),
       std::move(hint)});
}

void FindingLog::append(const std::vector<Diagnostic>& diagnostics) {
  diagnostics_.insert(diagnostics_.end(), diagnostics.begin(), diagnostics.end());
}

std::vector<Diagnostic> FindingLog::sorted() const {
  std::vector<Diagnostic> diagnostics = diagnostics_;
  std::ranges::stable_sort(diagnostics, [](const Diagnostic& a, const Diagnostic& b) {
    return std::tie(a.file, a.line, a.column) < std::tie(b.file, b.line, b.column);
  });
  for (const auto& [rule, count] : counts_) {
    if (count <= kMostOfOneRule) continue;
    diagnostics.push_back({file_, 0, 0, rule.second, rule.first,
                           std::to_string(count - kMostOfOneRule) + " more of this kind not shown",
                           "mend the first ones and validate again"});
  }
  return diagnostics;
}

void FindingLog::add(Diagnostic diagnostic) {
  if (++counts_[{diagnostic.code, diagnostic.severity}] > kMostOfOneRule) return;
  diagnostics_.push_back(std::move(diagnostic));
}

}  // namespace tagsmith::detail
