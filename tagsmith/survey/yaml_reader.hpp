// SPDX-License-Identifier: Apache-2.0
// Typed values from a YAML tree; a value that does not fit is logged with its place and a remedy.
// Internal to tagsmith/survey.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {

// The limits of a number.
struct NumberRange {
  double low = 0;
  double high = 0;
  bool low_excluded = false;
  std::string unit;  // for messages: "m"
};

NumberRange above_zero(double high, std::string unit);
NumberRange between(double low, double high, std::string unit);

// A value of a file, and where findings about it go. Without a node it is absent, which was logged
// or is allowed: readers then return nothing and add no finding.
struct YamlValue {
  const YamlNode* node = nullptr;
  std::string name;  // in messages: "tunnel.width"; empty for the whole file
  FindingLog* log = nullptr;

  explicit operator bool() const { return node != nullptr; }
  bool is(YamlNode::Kind kind) const { return node != nullptr && node->kind == kind; }
  Place place() const { return node != nullptr ? node->place : Place{}; }

  // Of a list.
  YamlValue item(std::size_t index) const;

  // Returns nothing, for readers to return.
  std::nullopt_t error(std::string code, std::string message, std::string hint = {},
                       std::optional<TextEdit> fix = {}) const;
  void warning(std::string code, std::string message, std::string hint = {}) const;
};

std::optional<double> read_number(const YamlValue& value, const NumberRange& range);
std::optional<int> read_integer(const YamlValue& value, int low, int high);
std::optional<bool> read_bool(const YamlValue& value);

// Text of at most 200 bytes without control characters. Plain words that YAML reads as a number, a
// truth value or nothing need quotes.
std::optional<std::string> read_text(const YamlValue& value);

// Text that may name files and CSV columns too: begins with a letter or digit and has no / \ , : "
// or control character.
std::optional<std::string> read_name(const YamlValue& value);

// One of the words.
std::optional<std::string> read_choice(const YamlValue& value,
                                       const std::vector<std::string>& words);

// A list of exactly `count` numbers.
std::optional<std::vector<double>> read_numbers(const YamlValue& value, std::size_t count,
                                                const NumberRange& range);

// A list of three coordinates, each at most so many metres from zero.
std::optional<Eigen::Vector3d> read_point(const YamlValue& value, double farthest);

// The values of a list; nothing, with a finding, when it is none.
std::optional<std::vector<YamlValue>> read_list(const YamlValue& value);

// A map with a known set of keys. Unknown, repeated and merge keys are logged on construction.
class MapReader {
 public:
  MapReader(YamlValue value, const std::vector<std::string>& known_keys);

  bool is_map() const { return static_cast<bool>(value_); }

  // The map itself.
  const YamlValue& value() const { return value_; }

  // The value of the key, absent or not.
  YamlValue at(std::string_view key) const;

  // As `at`, but its absence is an error; `hint` says how to write it.
  YamlValue need(std::string_view key, const std::string& hint = {}) const;

  bool has(std::string_view key) const { return value_ && index_of_key(*value_.node, key); }

  // The number at the key: required, or `fallback` when absent or faulty.
  std::optional<double> number(std::string_view key, const NumberRange& range,
                               const std::string& hint = {}) const;
  double number_or(std::string_view key, double fallback, const NumberRange& range) const;

  // The number at the key; nothing when absent or faulty.
  std::optional<double> number_if_there(std::string_view key, const NumberRange& range) const;

  // The word at the key, one of these; nothing when absent or faulty. With a hint it is required.
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& words,
                                    const std::string& hint = {}) const;

  // Logs when more than one of the keys is there.
  void exclude_each_other(const std::vector<std::string>& keys) const;

  FindingLog& log() const { return *value_.log; }

 private:
  YamlValue value_;
};

// "a, b or c", each in backquotes.
std::string either_of(const std::vector<std::string>& words);

}  // namespace tagsmith::detail
