// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/yaml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kLongestText = 200;

// A node in a few words, for "is ..., expected ...".
std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::empty:
      return "empty";
    case YamlNode::Kind::sequence:
      return "a list of " + std::to_string(node.items.size());
    case YamlNode::Kind::map:
      return "a map";
    default: {
      const std::string shown = node.text.size() > 60 ? node.text.substr(0, 60) + "..." : node.text;
      return node.quoted ? "the text \"" + shown + "\"" : "`" + shown + "`";
    }
  }
}

void wrong_type(const YamlNode& node, const std::string& name, const std::string& expected,
                FindingLog& log, std::string hint = {}, std::string code = "wrong-type",
                std::optional<TextEdit> fix = {}) {
  if (node.kind == YamlNode::Kind::broken) return;
  log.error(node.place, std::move(code), name + " is " + describe(node) + ", expected " + expected,
            std::move(hint), std::move(fix));
}

TextEdit rewritten(const YamlNode& scalar, std::string text) {
  const std::string quote = scalar.quoted ? "\"" : "";
  return {quote + scalar.text + quote, std::move(text)};
}

// True for 012 and -007.5: octal to some readers of YAML, decimal to others.
bool looks_octal(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && is_digit(text[1]);
}

bool looks_infinite(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const std::string word = lower_case(text);
  return word == ".inf" || word == ".nan" || word == "inf" || word == "nan" || word == "infinity";
}

bool has_decimal_comma(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return false;
  std::string point = text;
  point[comma] = '.';
  return parse_number(point).has_value();
}

struct NumberFault {
  std::string code;
  std::string hint;
  std::optional<TextEdit> fix = {};
};

// Why a scalar is no number.
NumberFault number_fault(const YamlNode& node, const std::string& unit) {
  const std::string& text = node.text;
  if (node.quoted && parse_number(text)) {
    return {"wrong-type", "remove the quotes", rewritten(node, text)};
  }
  if (has_decimal_comma(text)) {
    std::string point = text;
    point[text.find(',')] = '.';
    return {"decimal-comma", "write " + point + ": the decimal sign is a point",
            rewritten(node, point)};
  }
  if (looks_infinite(text)) return {"not-finite", "give the measured number"};
  const std::size_t end = text.find_first_not_of("+-.0123456789eE");
  if (end != std::string::npos && end > 0 && parse_number(trim(text.substr(0, end)))) {
    const std::string number(trim(text.substr(0, end)));
    const bool same_unit = !unit.empty() && trim(text.substr(end)) == unit;
    return {"wrong-type", "write the number alone: units are fixed by the format",
            same_unit ? std::optional(rewritten(node, number)) : std::nullopt};
  }
  return {"wrong-type", ""};
}

std::string words_of(const NumberRange& range) {
  const std::string unit = range.unit.empty() ? "" : " " + range.unit;
  const bool bounded_below = std::isfinite(range.low);
  const bool bounded_above = std::isfinite(range.high);
  std::string words;
  if (bounded_below) {
    words = (range.low_excluded ? "more than " : "at least ") + format_number(range.low);
  }
  if (bounded_above) {
    words += (bounded_below ? " and at most " : "at most ") + format_number(range.high);
  }
  return words.empty() ? "a number" : words + unit;
}

bool contains(const NumberRange& range, double value) {
  return (range.low_excluded ? value > range.low : value >= range.low) && value <= range.high;
}

}  // namespace

NumberRange above_zero(double high, std::string unit) { return {0, high, true, std::move(unit)}; }

NumberRange between(double low, double high, std::string unit) {
  return {low, high, false, std::move(unit)};
}

std::string either_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += "`" + words[i] + "`";
  }
  return text;
}

std::optional<double> read_number(const YamlNode* node, const std::string& name,
                                  const NumberRange& range, FindingLog& log) {
  if (node == nullptr) return std::nullopt;
  if (node->kind != YamlNode::Kind::scalar) {
    wrong_type(*node, name, "a number", log);
    return std::nullopt;
  }
  const std::optional<double> value = node->quoted ? std::nullopt : parse_number(node->text);
  if (!value) {
    const NumberFault fault = number_fault(*node, range.unit);
    wrong_type(*node, name, "a finite number", log, fault.hint, fault.code, fault.fix);
    return std::nullopt;
  }
  if (looks_octal(node->text)) {
    wrong_type(*node, name, "a number without leading zeros", log,
               "write " + format_number(*value) + ": some programs read leading zeros as octal",
               "leading-zero", rewritten(*node, format_number(*value)));
    return std::nullopt;
  }
  if (!contains(range, *value)) {
    const double from_mm = *value / 1000;
    const bool may_be_mm = range.unit == "m" && contains(range, from_mm);
    log.error(
        node->place, "out-of-range", name + " is " + node->text + ", expected " + words_of(range),
        may_be_mm
            ? "metres are meant: write " + format_number(from_mm) + " for " + node->text + " mm"
            : "");
    return std::nullopt;
  }
  return value;
}

std::optional<int> read_integer(const YamlNode* node, const std::string& name, int low, int high,
                                FindingLog& log) {
  const std::optional<double> value = read_number(node, name, between(low, high, ""), log);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) {
    wrong_type(*node, name, "a whole number", log);
    return std::nullopt;
  }
  return static_cast<int>(*value);
}

std::optional<bool> read_bool(const YamlNode* node, const std::string& name, FindingLog& log) {
  if (node == nullptr) return std::nullopt;
  if (node->kind == YamlNode::Kind::scalar && !node->quoted) {
    if (node->text == "true") return true;
    if (node->text == "false") return false;
  }
  wrong_type(*node, name, "true or false", log);
  return std::nullopt;
}

std::optional<std::string> read_text(const YamlNode* node, const std::string& name,
                                     FindingLog& log) {
  if (node == nullptr) return std::nullopt;
  if (node->kind != YamlNode::Kind::scalar) {
    wrong_type(*node, name, "text", log);
    return std::nullopt;
  }
  const std::string word = lower_case(node->text);
  const bool other_type = parse_number(word) || looks_infinite(word) || word == "true" ||
                          word == "false" || word == "null" || word == "~";
  if (!node->quoted && other_type) {
    wrong_type(*node, name, "text", log, "put it in quotes: \"" + node->text + "\"", "wrong-type",
               rewritten(*node, "\"" + node->text + "\""));
    return std::nullopt;
  }
  if (trim(node->text).empty() || node->text.size() > kLongestText || !is_plain_text(node->text)) {
    log.error(node->place, "bad-text",
              name + " is " + describe(*node) + ", expected 1 to " + std::to_string(kLongestText) +
                  " bytes of text on one line");
    return std::nullopt;
  }
  return node->text;
}

std::optional<std::string> read_name(const YamlNode* node, const std::string& name,
                                     FindingLog& log) {
  std::optional<std::string> text = read_text(node, name, log);
  if (!text || is_plain_name(*text)) return text;
  log.error(node->place, "bad-name",
            name + " is " + describe(*node) +
                ", expected a name that begins with a letter or digit and has no / \\ , : or \"");
  return std::nullopt;
}

std::optional<std::string> read_choice(const YamlNode* node, const std::string& name,
                                       const std::vector<std::string>& words, FindingLog& log) {
  if (node == nullptr) return std::nullopt;
  if (node->kind == YamlNode::Kind::scalar && std::ranges::count(words, node->text) > 0) {
    return node->text;
  }
  const auto near =
      node->kind == YamlNode::Kind::scalar ? nearest_word(node->text, words) : std::nullopt;
  wrong_type(*node, name, either_of(words), log, near ? "did you mean `" + *near + "`?" : "",
             "bad-choice", near ? std::optional(rewritten(*node, *near)) : std::nullopt);
  return std::nullopt;
}

std::optional<std::vector<double>> read_numbers(const YamlNode* node, const std::string& name,
                                                std::size_t count, const NumberRange& range,
                                                FindingLog& log) {
  if (node == nullptr) return std::nullopt;
  const std::string expected = "a list of " + std::to_string(count) + " numbers";
  if (node->kind != YamlNode::Kind::sequence) {
    wrong_type(*node, name, expected, log);
    return std::nullopt;
  }
  if (node->items.size() != count) {
    wrong_type(
        *node, name, expected, log,
        node->items.size() > count ? "decimal signs are points; commas separate numbers" : "",
        "wrong-length");
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value =
        read_number(&node->items[i], name + "[" + std::to_string(i) + "]", range, log);
    if (value) values.push_back(*value);
  }
  if (values.size() != count) return std::nullopt;
  return values;
}

std::optional<Eigen::Vector3d> read_point(const YamlNode* node, const std::string& name,
                                          double farthest, FindingLog& log) {
  const auto p = read_numbers(node, name, 3, between(-farthest, farthest, "m"), log);
  if (!p) return std::nullopt;
  return Eigen::Vector3d((*p)[0], (*p)[1], (*p)[2]);
}

const std::vector<YamlNode>* read_list(const YamlNode* node, const std::string& name,
                                       FindingLog& log) {
  if (node == nullptr) return nullptr;
  if (node->kind == YamlNode::Kind::sequence) return &node->items;
  wrong_type(*node, name, "a list", log);
  return nullptr;
}

namespace {

// Whether a key is what follows the comma of the number before it, as in { height: 0,24 }.
bool follows_decimal_comma(const YamlNode& map, std::size_t key) {
  const auto is_digits = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  };
  if (!map.flow || key == 0 || map.items[key].kind != YamlNode::Kind::empty) return false;
  const YamlNode& before = map.items[key - 1];
  const std::size_t sign = before.text.starts_with('-') ? 1 : 0;
  return is_digits(map.keys[key].text) && before.kind == YamlNode::Kind::scalar && !before.quoted &&
         is_digits(before.text.substr(sign));
}

void log_decimal_comma(const YamlNode& map, std::size_t key, FindingLog& log) {
  const YamlNode& before = map.items[key - 1];
  const std::string& decimals = map.keys[key].text;
  const Place& place = map.keys[key].place;
  const bool is_adjacent =
      before.place.line == place.line &&
      before.place.column + static_cast<int>(before.text.size()) + 1 == place.column;
  log.error(
      is_adjacent ? Place{place.line, place.column - 1} : place, "decimal-comma",
      "a comma in the number `" + before.text + "," + decimals + "` of " + map.keys[key - 1].text,
      "write " + before.text + "." + decimals + ": the decimal sign is a point",
      is_adjacent ? std::optional(TextEdit{"," + decimals, "." + decimals}) : std::nullopt);
}

}  // namespace

MapReader::MapReader(const YamlNode* node, std::string name, std::vector<std::string> known_keys,
                     FindingLog& log)
    : name_(std::move(name)), log_(&log) {
  if (node == nullptr) return;
  if (node->kind != YamlNode::Kind::map) {
    wrong_type(*node, name_.empty() ? "the file" : name_,
               "a map with the keys " + either_of(known_keys), log);
    return;
  }
  node_ = node;
  std::set<std::string_view> seen;
  // The right name, unless the map has it already.
  const auto rename_to = [&](const YamlKey& key, const std::optional<std::string>& right) {
    const bool usable = right && std::ranges::count(node->keys, *right, &YamlKey::text) == 0;
    return usable ? std::optional(TextEdit{key.text, *right}) : std::nullopt;
  };
  for (std::size_t i = 0; i < node->keys.size(); ++i) {
    const YamlKey& key = node->keys[i];
    if (key.text == "<<") {
      log.error(key.place, "merge-key", "the merge key <<, expected the keys themselves",
                "write the keys out; merge keys are not supported");
    } else if (follows_decimal_comma(*node, i)) {
      log_decimal_comma(*node, i, log);
    } else if (std::ranges::count(known_keys, key.text) == 0) {
      const auto near = nearest_word(key.text, known_keys);
      log.error(key.place, "unknown-key",
                "unknown key `" + key.text.substr(0, 60) + "`" +
                    (name_.empty() ? "" : " in " + name_) + ", expected " + either_of(known_keys),
                near ? "did you mean `" + *near + "`?" : "remove it", rename_to(key, near));
    } else if (!seen.insert(key.text).second) {
      log.error(key.place, "duplicate-key", "the key `" + name_of(key.text) + "` a second time",
                "remove one of the two");
    }
  }
}

const YamlNode* MapReader::find(std::string_view key) const {
  return node_ != nullptr ? value_at(*node_, key) : nullptr;
}

const YamlNode* MapReader::need(std::string_view key, const std::string& hint) const {
  const YamlNode* value = find(key);
  if (value == nullptr && node_ != nullptr) {
    log_->error(
        node_->place, "missing-key",
        "the key `" + std::string(key) + "` is missing" + (name_.empty() ? "" : " in " + name_),
        hint);
  }
  return value;
}

std::string MapReader::name_of(std::string_view key) const {
  return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
}

std::optional<double> MapReader::number(std::string_view key, const NumberRange& range,
                                        const std::string& hint) const {
  return read_number(need(key, hint), name_of(key), range, *log_);
}

double MapReader::number_or(std::string_view key, double fallback, const NumberRange& range) const {
  return number_if_there(key, range).value_or(fallback);
}

std::optional<double> MapReader::number_if_there(std::string_view key,
                                                 const NumberRange& range) const {
  return read_number(find(key), name_of(key), range, *log_);
}

std::optional<std::string> MapReader::choice(std::string_view key,
                                             const std::vector<std::string>& words,
                                             const std::string& hint) const {
  return read_choice(hint.empty() ? find(key) : need(key, hint), name_of(key), words, *log_);
}

void MapReader::exclude_each_other(const std::vector<std::string>& keys) const {
  std::vector<std::string> found;
  std::ranges::copy_if(keys, std::back_inserter(found), [&](const auto& key) { return has(key); });
  if (found.size() < 2) return;
  log_->error(find(found[1])->place, "conflicting-keys",
              "`" + name_of(found[0]) + "` and `" + found[1] + "` together, expected one of them",
              "remove one of the two");
}

}  // namespace tagsmith::detail
