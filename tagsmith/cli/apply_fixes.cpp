// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/apply_fixes.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

bool same_but_for_quotes(std::string_view a, std::string_view b) {
  const auto plain = [](char c) { return c == '\'' ? '"' : c; };
  return std::ranges::equal(a, b, {}, plain, plain);
}

// Replaces the text that the remedy names in the line; false when another text is there.
bool apply(const Diagnostic& diagnostic, std::string& line) {
  const auto column = static_cast<std::size_t>(diagnostic.column) - 1;
  const TextEdit& fix = *diagnostic.fix;
  if (column > line.size()) return false;
  const std::string_view there = std::string_view(line).substr(column, fix.found.size());
  if (!same_but_for_quotes(there, fix.found)) return false;
  line.replace(column, fix.found.size(), fix.text);
  return true;
}

}  // namespace

FixedText apply_fixes(const std::string& text, std::vector<Diagnostic> diagnostics) {
  std::erase_if(diagnostics, [](const Diagnostic& diagnostic) {
    return !diagnostic.fix || diagnostic.line <= 0 || diagnostic.column <= 0;
  });
  // From the end of a line to its beginning, so that columns stay valid.
  std::ranges::sort(diagnostics, [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.line, -a.column) < std::pair(b.line, -b.column);
  });
  std::vector<std::string> lines = split(text, '\n');
  FixedText fixed;
  for (const Diagnostic& diagnostic : diagnostics) {
    const auto index = static_cast<std::size_t>(diagnostic.line) - 1;
    if (index >= lines.size()) continue;
    const std::string before = lines[index];
    if (!apply(diagnostic, lines[index])) continue;
    if (fixed.lines.empty() || fixed.lines.back().line != diagnostic.line) {
      fixed.lines.push_back({diagnostic.line, {}, before, {}});
    }
    fixed.lines.back().codes.push_back(diagnostic.code);
    fixed.lines.back().after = lines[index];
  }
  for (std::size_t i = 0; i < lines.size(); ++i) fixed.text += (i > 0 ? "\n" : "") + lines[i];
  return fixed;
}

Result<std::vector<FixedLine>> fix_file(const std::string& path,
                                        const std::vector<Diagnostic>& diagnostics) {
  const Result<std::string> text = read_file(path);
  if (!text) return fail(text);
  FixedText fixed = apply_fixes(*text, diagnostics);
  if (fixed.lines.empty()) return std::vector<FixedLine>{};
  if (is_write_protected(path)) return fail(path + ": is write-protected, and has not been mended");
  if (Result<void> written = write_file(path, fixed.text); !written) {
    return fail(written);
  }
  return std::move(fixed.lines);
}

}  // namespace tagsmith::detail
