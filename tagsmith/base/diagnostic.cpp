// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/diagnostic.hpp"

#include <algorithm>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

std::string place(const Diagnostic& diagnostic) {
  std::string text = terminal_text(diagnostic.file);
  if (diagnostic.line > 0) {
    text += ":" + std::to_string(diagnostic.line);
    if (diagnostic.column > 0) text += ":" + std::to_string(diagnostic.column);
  }
  return text;
}

}  // namespace

std::string to_string(Severity severity) {
  return severity == Severity::error ? "error" : "warning";
}

std::string to_string(const Diagnostic& diagnostic) {
  std::string text = place(diagnostic) + ": " + to_string(diagnostic.severity) + ": " +
                     terminal_text(diagnostic.message) + " [" + diagnostic.code + "]";
  if (!diagnostic.hint.empty()) text += "\n    " + terminal_text(diagnostic.hint);
  return text;
}

std::string to_string(const std::vector<Diagnostic>& diagnostics, bool errors_only) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (errors_only && diagnostic.severity != Severity::error) continue;
    if (!text.empty()) text += "\n";
    text += to_string(diagnostic);
  }
  return text;
}

bool has_errors(const std::vector<Diagnostic>& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& diagnostic) {
    return diagnostic.severity == Severity::error;
  });
}

}  // namespace tagsmith::detail
