// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/xml_document.hpp"

#include <algorithm>
#include <pugixml.hpp>
#include <string>
#include <utility>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kDeepestElement = 32;

// pugixml places an element at its name, one character after its bracket.
Place place_of(const pugi::xml_node& element, const TextPlaces& places) {
  return places.at(element.offset_debug() - 1);
}

YamlNode text_value(std::string_view text, Place place) {
  constexpr auto kScalar = YamlNode::Kind::scalar;
  text = trim(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
    return {.kind = kScalar, .quoted = true, .place = place, .text = std::string(text)};
  }
  const std::vector<std::string> words = split_words(text);
  if (words.empty()) return {.place = place};
  if (words.size() == 1) return {.kind = kScalar, .place = place, .text = words.front()};
  YamlNode list{.kind = YamlNode::Kind::sequence, .place = place};
  for (const std::string& word : words) {
    list.items.push_back({.kind = kScalar, .place = place, .text = word});
  }
  return list;
}

YamlNode value_of(const pugi::xml_node& element, const TextPlaces& places, int depth,
                  FindingLog& log) {
  const Place place = place_of(element, places);
  if (depth > kDeepestElement) {
    log.error(place, "too-deep", "nested more than " + std::to_string(kDeepestElement) + " deep",
              "expected a calibration that OpenCV wrote");
    return {.kind = YamlNode::Kind::broken, .place = place};
  }
  YamlNode node{.place = place};
  bool is_list = true;
  for (const pugi::xml_node& child : element.children()) {
    if (child.type() != pugi::node_element) continue;
    is_list = is_list && std::string_view(child.name()) == "_";
    node.keys.push_back({child.name(), place_of(child, places)});
    node.items.push_back(value_of(child, places, depth + 1, log));
  }
  if (node.items.empty()) return text_value(element.text().get(), place);
  node.kind = is_list ? YamlNode::Kind::sequence : YamlNode::Kind::map;
  if (is_list) node.keys.clear();
  return node;
}

}  // namespace

TextPlaces::TextPlaces(std::string_view text) : size_(text.size()) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') line_starts_.push_back(i + 1);
  }
}

Place TextPlaces::at(std::ptrdiff_t offset) const {
  const std::size_t byte =
      std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)), size_);
  const auto next = std::ranges::upper_bound(line_starts_, byte);
  return {static_cast<int>(next - line_starts_.begin()),
          static_cast<int>(byte - *std::prev(next)) + 1};
}

std::optional<YamlNode> parse_xml(std::string_view text, FindingLog& log) {
  if (!check_utf8(text, log)) return std::nullopt;
  const TextPlaces places(text);
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    return log.error(places.at(result.offset), "syntax",
                     std::string("no valid XML: ") + result.description(),
                     "write the file again with the program that made it");
  }
  YamlNode root = value_of(document.document_element(), places, 0, log);
  if (log.has_errors()) return std::nullopt;
  if (root.kind != YamlNode::Kind::map) {
    return log.error({1, 1}, "empty-file", "no elements within the root, expected a calibration",
                     "write the file again with the program that made it");
  }
  return root;
}

}  // namespace tagsmith::detail
