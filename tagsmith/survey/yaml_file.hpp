// SPDX-License-Identifier: Apache-2.0
// A YAML file of one kind as a whole: from its text to its content and all findings about it.
// Internal to tagsmith/survey.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rules.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// Whether a file whose first key should be `key` (survey, rig, tag or board) is of another
// kind. Then that is logged, as one error instead of one for each of its keys.
bool is_other_kind(const YamlNode& root, std::string_view key, FindingLog& log);

// Of text that is or will be the content of the file at `path`, whose first key is `key`: what
// `read_root` makes of its root, unless there is an error.
template <class T, class ReadRoot>
Diagnosed<T> read_yaml_text(const std::filesystem::path& path, std::string_view text,
                            std::string_view key, const ReadRoot& read_root) {
  FindingLog log(path.string());
  Diagnosed<T> reading;
  const std::optional<YamlNode> root = parse_yaml(text, log);
  if (root && !is_other_kind(*root, key, log)) {
    reading.value = read_root(YamlValue{&*root, "", &log});
  }
  if (log.has_errors()) reading.value.reset();
  reading.diagnostics = without_allowed(log.sorted(), text, path.string());
  return reading;
}

// The same of the file. Fails only when it cannot be read at all.
template <class T, class ReadRoot>
Result<Diagnosed<T>> read_yaml_file(const std::filesystem::path& path, std::string_view key,
                                    const ReadRoot& read_root) {
  return read_file(path).map(
      [&](const std::string& text) { return read_yaml_text<T>(path, text, key, read_root); });
}

// The value of a file without errors; fails with all of its findings.
template <class T>
Result<T> value_without_errors(Result<Diagnosed<T>> reading) {
  if (!reading) return fail(reading);
  if (!reading->value) return fail(to_string(reading->diagnostics, true));
  return *std::move(reading->value);
}

}  // namespace tagsmith::detail
