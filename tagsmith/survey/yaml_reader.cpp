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

// Returns nothing, for readers to return.
std::nullopt_t wrong_type(const YamlValue& value, const std::string& expected,
                          std::string hint = {}, std::string code = "wrong-type",
                          std::optional<TextEdit> fix = {}) {
  if (value.node->kind == YamlNode::Kind::broken) return std::nullopt;
  return value.error(std::move(code),
                     value.name + " is " + describe(*value.node) + ", expected " + expected,
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
  return (range.low_excluded ? "more than " : "at least ") + format_number(range.low) +
         " and at most " + format_number(range.high) + (range.unit.empty() ? "" : " ") + range.unit;
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

YamlValue YamlValue::item(std::size_t index) const {
  return {&node->items[index], name + "[" + std::to_string(index) + "]", log};
}

std::nullopt_t YamlValue::error(std::string code, std::string message, std::string hint,
                                std::optional<TextEdit> fix) const {
  return log->error(place(), std::move(code), std::move(message), std::move(hint), std::move(fix));
}

void YamlValue::warning(std::string code, std::string message, std::string hint) const {
  log->warning(place(), std::move(code), std::move(message), std::move(hint));
}

std::optional<double> read_number(const YamlValue& value, const NumberRange& range) {
  if (!value) return std::nullopt;
  if (!value.is(YamlNode::Kind::scalar)) return wrong_type(value, "a number");
  const YamlNode& node = *value.node;
  const std::optional<double> number = node.quoted ? std::nullopt : parse_number(node.text);
  if (!number) {
    const NumberFault fault = number_fault(node, range.unit);
    return wrong_type(value, "a finite number", fault.hint, fault.code, fault.fix);
  }
  if (looks_octal(node.text)) {
    return wrong_type(
        value, "a number without leading zeros",
        "write " + format_number(*number) + ": some programs read leading zeros as octal",
        "leading-zero", rewritten(node, format_number(*number)));
  }
  if (contains(range, *number)) return number;
  const double from_mm = *number / 1000;
  const bool may_be_mm = range.unit == "m" && contains(range, from_mm);
  return value.error(
      "out-of-range", value.name + " is " + node.text + ", expected " + words_of(range),
      may_be_mm ? "metres are meant: write " + format_number(from_mm) + " for " + node.text + " mm"
                : "");
}

std::optional<int> read_integer(const YamlValue& value, int low, int high) {
  const std::optional<double> number = read_number(value, between(low, high, ""));
  if (!number) return std::nullopt;
  if (*number != std::floor(*number)) return wrong_type(value, "a whole number");
  return static_cast<int>(*number);
}

std::optional<bool> read_bool(const YamlValue& value) {
  if (!value) return std::nullopt;
  if (value.is(YamlNode::Kind::scalar) && !value.node->quoted) {
    if (value.node->text == "true") return true;
    if (value.node->text == "false") return false;
  }
  return wrong_type(value, "true or false");
}

std::optional<std::string> read_text(const YamlValue& value) {
  if (!value) return std::nullopt;
  if (!value.is(YamlNode::Kind::scalar)) return wrong_type(value, "text");
  const YamlNode& node = *value.node;
  const std::string word = lower_case(node.text);
  const bool other_type = parse_number(word) || looks_infinite(word) || word == "true" ||
                          word == "false" || word == "null" || word == "~";
  if (!node.quoted && other_type) {
    const std::string quoted = "\"" + node.text + "\"";
    return wrong_type(value, "text", "put it in quotes: " + quoted, "wrong-type",
                      rewritten(node, quoted));
  }
  if (trim(node.text).empty() || node.text.size() > kLongestText || !is_plain_text(node.text)) {
    return value.error("bad-text", value.name + " is " + describe(node) + ", expected 1 to " +
                                       std::to_string(kLongestText) + " bytes of text on one line");
  }
  return node.text;
}

std::optional<std::string> read_name(const YamlValue& value) {
  std::optional<std::string> text = read_text(value);
  if (!text || is_plain_name(*text)) return text;
  return value.error(
      "bad-name",
      value.name + " is " + describe(*value.node) +
          ", expected a name that begins with a letter or digit and has no / \\ , : or \"");
}

std::optional<std::string> read_choice(const YamlValue& value,
                                       const std::vector<std::string>& words) {
  if (!value) return std::nullopt;
  const bool is_word = value.is(YamlNode::Kind::scalar);
  const std::string& word = value.node->text;
  if (is_word && std::ranges::count(words, word) > 0) return word;
  const auto near = is_word ? nearest_word(word, words) : std::nullopt;
  return wrong_type(value, either_of(words), near ? "did you mean `" + *near + "`?" : "",
                    "bad-choice",
                    near ? std::optional(rewritten(*value.node, *near)) : std::nullopt);
}

std::optional<std::vector<double>> read_numbers(const YamlValue& value, std::size_t count,
                                                const NumberRange& range) {
  if (!value) return std::nullopt;
  const std::string expected = "a list of " + std::to_string(count) + " numbers";
  if (!value.is(YamlNode::Kind::sequence)) return wrong_type(value, expected);
  const std::size_t size = value.node->items.size();
  if (size != count) {
    return wrong_type(value, expected,
                      size > count ? "decimal signs are points; commas separate numbers" : "",
                      "wrong-length");
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    if (const auto number = read_number(value.item(i), range)) numbers.push_back(*number);
  }
  return numbers.size() == count ? std::optional(numbers) : std::nullopt;
}

std::optional<Eigen::Vector3d> read_point(const YamlValue& value, double farthest) {
  const auto p = read_numbers(value, 3, between(-farthest, farthest, "m"));
  if (!p) return std::nullopt;
  return Eigen::Vector3d((*p)[0], (*p)[1], (*p)[2]);
}

std::optional<std::vector<YamlValue>> read_list(const YamlValue& value) {
  if (!value) return std::nullopt;
  if (!value.is(YamlNode::Kind::sequence)) return wrong_type(value, "a list");
  std::vector<YamlValue> items;
  for (std::size_t i = 0; i < value.node->items.size(); ++i) items.push_back(value.item(i));
  return items;
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

MapReader::MapReader(YamlValue value, const std::vector<std::string>& known_keys)
    : value_(std::move(value)) {
  if (!value_) return;
  const std::string& name = value_.name;
  if (!value_.is(YamlNode::Kind::map)) {
    wrong_type({value_.node, name.empty() ? "the file" : name, value_.log},
               "a map with the keys " + either_of(known_keys));
    value_.node = nullptr;
    return;
  }
  const YamlNode& node = *value_.node;
  std::set<std::string_view> seen;
  // The right name, unless the map has it already.
  const auto rename_to = [&](const YamlKey& key, const std::optional<std::string>& right) {
    const bool usable = right && !index_of_key(node, *right);
    return usable ? std::optional(TextEdit{key.text, *right}) : std::nullopt;
  };
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const YamlKey& key = node.keys[i];
    if (key.text == "<<") {
      log().error(key.place, "merge-key", "the merge key <<, expected the keys themselves",
                  "write the keys out; merge keys are not supported");
    } else if (follows_decimal_comma(node, i)) {
      log_decimal_comma(node, i, log());
    } else if (std::ranges::count(known_keys, key.text) == 0) {
      const auto near = nearest_word(key.text, known_keys);
      log().error(key.place, "unknown-key",
                  "unknown key `" + key.text.substr(0, 60) + "`" +
                      (name.empty() ? "" : " in " + name) + ", expected " + either_of(known_keys),
                  near ? "did you mean `" + *near + "`?" : "remove it", rename_to(key, near));
    } else if (!seen.insert(key.text).second) {
      log().error(key.place, "duplicate-key", "the key `" + at(key.text).name + "` a second time",
                  "remove one of the two");
    }
  }
}

YamlValue MapReader::at(std::string_view key) const {
  const std::string prefix = value_.name.empty() ? "" : value_.name + ".";
  return {value_ ? value_at(*value_.node, key) : nullptr, prefix + std::string(key), value_.log};
}

YamlValue MapReader::need(std::string_view key, const std::string& hint) const {
  YamlValue value = at(key);
  if (!value && value_) {
    value_.error("missing-key",
                 "the key `" + std::string(key) + "` is missing" +
                     (value_.name.empty() ? "" : " in " + value_.name),
                 hint);
  }
  return value;
}

std::optional<double> MapReader::number(std::string_view key, const NumberRange& range,
                                        const std::string& hint) const {
  return read_number(need(key, hint), range);
}

double MapReader::number_or(std::string_view key, double fallback, const NumberRange& range) const {
  return number_if_there(key, range).value_or(fallback);
}

std::optional<double> MapReader::number_if_there(std::string_view key,
                                                 const NumberRange& range) const {
  return read_number(at(key), range);
}

std::optional<std::string> MapReader::choice(std::string_view key,
                                             const std::vector<std::string>& words,
                                             const std::string& hint) const {
  return read_choice(hint.empty() ? at(key) : need(key, hint), words);
}

void MapReader::exclude_each_other(const std::vector<std::string>& keys) const {
  std::vector<std::string> found;
  std::ranges::copy_if(keys, std::back_inserter(found), [&](const auto& key) { return has(key); });
  if (found.size() < 2) return;
  at(found[1]).error(
      "conflicting-keys",
      "`" + at(found[0]).name + "` and `" + found[1] + "` together, expected one of them",
      "remove one of the two");
}

}  // namespace tagsmith::detail
