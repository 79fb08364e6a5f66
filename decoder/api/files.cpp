// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string_view>
#include <utility>

#include <tagsmith/files.hpp>

#include "decoder/api/data.hpp"
#include "decoder/image/load.hpp"
#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"

namespace tagsmith {
namespace {

namespace fs = std::filesystem;

// Fails on a missing file, so that callers can distinguish it from one that cannot be read.
void require_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return;
  throw Error(ErrorCode::file_missing, path.string() + ": there is no such file");
}

// The value read from a file, or an error.
template <class Reading>
Reading value_of(const fs::path& path, detail::Result<Reading> (*read)(const fs::path&)) {
  require_file(path);
  detail::Result<Reading> reading = read(path);
  if (!reading) throw Error(ErrorCode::unreadable_file, reading.error().message);
  return std::move(*reading);
}

template <class Value>
Value valid(std::optional<Value> value, const std::vector<detail::Diagnostic>& diagnostics) {
  if (!value) throw Error(ErrorCode::invalid_file, to_string(diagnostics, true));
  return std::move(*value);
}

// The first key of a YAML file at the beginning of a line: it shows what kind of file it is.
std::string_view first_key(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    const std::size_t colon = line.find(':');
    const bool is_key = colon != std::string_view::npos && line.front() != '#' &&
                        line.front() != ' ' && !line.starts_with("---");
    if (is_key) return line.substr(0, colon);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return {};
}

std::vector<detail::Diagnostic> diagnostics_of(const fs::path& path) {
  const std::string text = value_of(
      path, +[](const fs::path& file) { return detail::read_file(file); });
  const std::string_view kind = first_key(text);
  if (kind == "rig") return value_of(path, detail::read_rig).diagnostics;
  if (kind == "tag") return value_of(path, detail::read_template).diagnostics;
  return value_of(path, detail::read_survey).diagnostics;
}

}  // namespace

Survey load_survey(const fs::path& path) {
  detail::Diagnosed<detail::Survey> reading = value_of(path, detail::read_survey);
  return Survey(
      std::make_shared<const Survey::Data>(valid(std::move(reading.value), reading.diagnostics)));
}

Rig load_rig(const fs::path& path) {
  detail::Diagnosed<detail::Rig> reading = value_of(path, detail::read_rig);
  return Rig(
      std::make_shared<const Rig::Data>(valid(std::move(reading.value), reading.diagnostics)));
}

Image load_image(const fs::path& path) {
  detail::DecodedImage decoded = value_of(path, detail::load_image);
  return {decoded.image.width, decoded.image.height, std::move(decoded.image.samples),
          std::move(decoded.warning)};
}

std::vector<FileFinding> validate(const fs::path& path) {
  std::vector<FileFinding> findings;
  for (const detail::Diagnostic& one : diagnostics_of(path)) {
    const bool is_error = one.severity == detail::Severity::error;
    findings.push_back({one.code, is_error ? Severity::error : Severity::warning, one.file,
                        one.line, one.column, one.message, one.hint});
  }
  return findings;
}

}  // namespace tagsmith
