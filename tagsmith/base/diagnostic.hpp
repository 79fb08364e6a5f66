// SPDX-License-Identifier: Apache-2.0
// A finding about a file the user wrote: the place, what was found, what is expected, the remedy.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tagsmith::detail {

enum class Severity { error, warning };

// A mechanical remedy: the text at the finding's place, and its replacement.
struct TextEdit {
  std::string found;  // quotes of both kinds count as equal
  std::string text;

  bool operator==(const TextEdit&) const = default;
};

struct Diagnostic {
  std::string file;
  int line = 0;    // 1-based; 0 = the whole file
  int column = 0;  // 1-based; 0 = the whole line
  Severity severity = Severity::error;
  std::string code;                  // short stable name of the rule, e.g. "unknown-key"
  std::string message;               // what was found and what is expected
  std::string hint;                  // how to correct it; may be empty
  std::optional<TextEdit> fix = {};  // what a program may change without asking
};

// A value that a file says, with all findings about the file. `value` is there exactly when no
// finding is an error.
template <class T>
struct Diagnosed {
  std::optional<T> value;
  std::vector<Diagnostic> diagnostics;
};

std::string to_string(Severity severity);

// `file:line:column: error: message [code]`, and the hint on an indented line of its own.
std::string to_string(const Diagnostic& diagnostic);

// One text of all errors (or all findings, when `errors_only` is false), a finding a line.
std::string to_string(const std::vector<Diagnostic>& diagnostics, bool errors_only = false);

bool has_errors(const std::vector<Diagnostic>& diagnostics);

}  // namespace tagsmith::detail
