// SPDX-License-Identifier: Apache-2.0
// Collects the findings about one file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"

namespace tagsmith::detail {

// Line and column in a file, 1-based; 0 = the whole file, the whole line.
struct Place {
  int line = 0;
  int column = 0;
};

// The findings of one file. Of one rule the first hundred are kept and the others counted, so that
// a file with a million equal faults stays readable.
class FindingLog {
 public:
  explicit FindingLog(std::string file) : file_(std::move(file)) {}

  // Returns nothing, for readers to return.
  std::nullopt_t error(Place place, std::string code, std::string message, std::string hint = {},
                       std::optional<TextEdit> fix = {});
  void warning(Place place, std::string code, std::string message, std::string hint = {});

  // Adds the findings of another file (a template that the survey names) unchanged.
  void append(const std::vector<Diagnostic>& diagnostics);

  bool has_errors() const { return tagsmith::detail::has_errors(diagnostics_); }

  // In the order of the file; the number left out comes last.
  std::vector<Diagnostic> sorted() const;

 private:
  void add(Diagnostic diagnostic);

  std::string file_;
  std::vector<Diagnostic> diagnostics_;
  std::map<std::pair<std::string, Severity>, int> counts_;  // by rule
};

}  // namespace tagsmith::detail
