// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_placed.hpp"

#include <span>
#include <string>
#include <vector>

#include "tagsmith/base/date.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/tunnel_limits.hpp"

namespace tagsmith::detail {
namespace {

// Eleven digits (the check digit is added) or twelve (it must be right, where its scheme is known).
std::optional<Digits> read_digits(const YamlNode* node, const std::string& name,
                                  const std::optional<CheckDigit>& check, FindingLog& log) {
  if (node == nullptr || node->kind == YamlNode::Kind::broken) return std::nullopt;
  const bool scalar = node->kind == YamlNode::Kind::scalar;
  const std::string text = scalar ? node->text : "";
  std::optional<Digits> digits = parse_digits(text.size() == kPayloadDigits ? text + "0" : text);
  if (!digits) {
    log.error(node->place, "bad-digits",
              name + " is " + (scalar ? "`" + text.substr(0, 60) + "`" : "no text") +
                  ", expected 11 digits, or 12 with the check digit, in quotes");
    return std::nullopt;
  }
  if (!node->quoted) {
    log.error(node->place, "bad-digits", name + " is the number `" + text + "`, expected text",
              "put it in quotes: \"" + text + "\"; as a number it loses its leading zeros",
              TextEdit{text, "\"" + text + "\""});
    return std::nullopt;
  }
  if (!check) return digits;
  const std::uint8_t right = check_digit(*check, std::span(*digits).first<11>());
  if (text.size() == kPayloadDigits) digits->back() = right;
  if (digits->back() == right) return digits;
  log.error(node->place, "wrong-check-digit",
            name + " ends in " + std::to_string(digits->back()) + ", the check digit (" +
                to_string(*check) + ") of the other eleven is " + std::to_string(right),
            "check the digits against the plate, and code.check_digit");
  return std::nullopt;
}

std::optional<TagName> read_tag_name(const MapReader& map) {
  FindingLog& log = map.log();
  const YamlNode* node = map.need("tag", "tag: 000L");
  const auto side = map.choice("side", {"left", "right"}, "side: left or side: right");
  if (node == nullptr || node->kind == YamlNode::Kind::broken) return std::nullopt;
  const auto name =
      node->kind == YamlNode::Kind::scalar ? parse_tag_name(node->text) : std::nullopt;
  if (!name) {
    log.error(node->place, "bad-tag-name",
              map.name_of("tag") + " is `" + node->text.substr(0, 60) +
                  "`, expected the pair in at least three digits and L or R, as 000L");
    return std::nullopt;
  }
  if (!side) return std::nullopt;
  if (*side != to_string(name->side)) {
    log.error(map.find("side")->place, "side-mismatch",
              "tag " + node->text + " with side " + *side + ", expected " + to_string(name->side),
              "names end in L on the left wall of the drive and in R on the right one");
    return std::nullopt;
  }
  return name;
}

// A day as ISO 8601 writes it, 2026-03-31; empty when absent or faulty.
std::string read_date(const YamlNode* node, const std::string& name, FindingLog& log) {
  const std::optional<std::string> text = read_text(node, name, log);
  if (!text || parse_day(*text)) return text.value_or("");
  log.error(node->place, "bad-date",
            name + " is `" + text->substr(0, 60) + "`, expected a day as 2026-03-31");
  return {};
}

// Nothing when no key speaks of it.
std::optional<PlateAttitude> read_attitude(const MapReader& map) {
  if (!map.has("facing") && !map.has("tilt") && !map.has("roll")) return std::nullopt;
  PlateAttitude attitude;
  const auto facing = map.number_if_there("facing", between(-360, 360, "degrees"));
  if (facing) attitude.facing = radians(*facing);
  attitude.tilt = radians(map.number_or("tilt", 0, between(-90, 90, "degrees")));
  attitude.roll = radians(map.number_or("roll", 0, between(-180, 180, "degrees")));
  return attitude;
}

std::optional<PlacedEntry> read_placed_entry(const YamlNode& node, const std::string& label,
                                             const std::optional<CheckDigit>& check,
                                             FindingLog& log) {
  const MapReader map(&node, label,
                      {"tag", "side", "p", "digits", "sigma", "date", "design", "control", "facing",
                       "tilt", "roll"},
                      log);
  if (!map.is_map()) return std::nullopt;
  const auto name = read_tag_name(map);
  const auto p =
      read_point(map.need("p", "p: [x, y, z] of corner P"), map.name_of("p"), kFarthest, log);
  PlacedEntry entry;
  entry.digits = read_digits(map.find("digits"), map.name_of("digits"), check, log);
  entry.sigma = map.number_if_there("sigma", between(0, kWorstSigma, "m"));
  entry.date = read_date(map.find("date"), map.name_of("date"), log);
  entry.design_in_grid = read_point(map.find("design"), map.name_of("design"), kFarthest, log);
  entry.control = read_bool(map.find("control"), map.name_of("control"), log).value_or(false);
  entry.attitude = read_attitude(map);
  const bool digits_fit = !map.has("digits") || entry.digits.has_value();
  if (!name || !p || !digits_fit) return std::nullopt;
  entry.name = *name;
  entry.p_in_grid = *p;
  entry.place = node.place;
  return entry;
}

}  // namespace

std::map<TagKey, PlacedEntry> read_placed(const YamlNode* node,
                                          const std::optional<CheckDigit>& check, FindingLog& log) {
  std::map<TagKey, PlacedEntry> placed;
  const std::vector<YamlNode>* list = read_list(node, "placed", log);
  if (list == nullptr) return placed;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto entry =
        read_placed_entry((*list)[i], "placed[" + std::to_string(i) + "]", check, log);
    if (!entry) continue;
    const TagKey key{entry->name.pair, entry->name.side};
    const auto [first, is_new] = placed.emplace(key, *entry);
    if (is_new) continue;
    log.error(entry->place, "duplicate-tag",
              "tag " + tag_name(key.first, key.second) + " a second time in placed, the first is " +
                  "on line " + std::to_string(first->second.place.line),
              "remove one of the two");
  }
  return placed;
}

}  // namespace tagsmith::detail
