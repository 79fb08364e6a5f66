// SPDX-License-Identifier: Apache-2.0
// Typed values from a YAML tree; a value that does not fit is logged with its place and a remedy.
// Internal to tagsmith/survey. A null node means that its absence was logged: readers add no
// finding.
#pragma once

#include <limits>
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
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_excluded = false;
  std::string unit;  // for messages: "m"
};

NumberRange above_zero(double high, std::string unit);
NumberRange between(double low, double high, std::string unit);

// The node's value; `name` is its name in messages ("tunnel.width").
std::optional<double> read_number(const YamlNode* node, const std::string& name,
                                  const NumberRange& range, FindingLog& log);
std::optional<int> read_integer(const YamlNode* node, const std::string& name, int low, int high,
                                FindingLog& log);
std::optional<bool> read_bool(const YamlNode* node, const std::string& name, FindingLog& log);

// Text of at most 200 bytes without control characters. Plain words that YAML reads as a number, a
// truth value or nothing need quotes.
std::optional<std::string> read_text(const YamlNode* node, const std::string& name,
                                     FindingLog& log);

// Text that may name files and CSV columns too: begins with a letter or digit and has no / \ , : "
// or control character.
std::optional<std::string> read_name(const YamlNode* node, const std::string& name,
                                     FindingLog& log);

// One of the words.
std::optional<std::string> read_choice(const YamlNode* node, const std::string& name,
                                       const std::vector<std::string>& words, FindingLog& log);

// A list of exactly `count` numbers.
std::optional<std::vector<double>> read_numbers(const YamlNode* node, const std::string& name,
                                                std::size_t count, const NumberRange& range,
                                                FindingLog& log);

// A list of three coordinates, each at most so many metres from zero.
std::optional<Eigen::Vector3d> read_point(const YamlNode* node, const std::string& name,
                                          double farthest, FindingLog& log);

// The items of a list; null with a finding when it is none.
const std::vector<YamlNode>* read_list(const YamlNode* node, const std::string& name,
                                       FindingLog& log);

// A map with a known set of keys. Unknown, repeated and merge keys are logged on construction.
class MapReader {
 public:
  // `name` is the map's name in messages ("tunnel"), empty for the whole file.
  MapReader(const YamlNode* node, std::string name, std::vector<std::string> known_keys,
            FindingLog& log);

  const std::string& name() const { return name_; }
  bool is_map() const { return node_ != nullptr; }
  Place place() const { return node_ != nullptr ? node_->place : Place{}; }

  // The value of the key; null when absent.
  const YamlNode* find(std::string_view key) const;
  // As find, but its absence is an error; `hint` says how to write it.
  const YamlNode* need(std::string_view key, const std::string& hint = {}) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }

  // "tunnel.width" for "width".
  std::string name_of(std::string_view key) const;

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

  FindingLog& log() const { return *log_; }

 private:
  const YamlNode* node_ = nullptr;
  std::string name_;
  FindingLog* log_;
};

// "a, b or c", each in backquotes.
std::string either_of(const std::vector<std::string>& words);

}  // namespace tagsmith::detail
