// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/label_fields.hpp"

#include <algorithm>

namespace tagsmith::detail {
namespace {

bool is_field(std::string_view name) { return std::ranges::count(kLabelFields, name) > 0; }

}  // namespace

std::optional<std::string> unknown_field(std::string_view text) {
  for (std::size_t at = text.find('{'); at != std::string_view::npos; at = text.find('{', at + 1)) {
    const std::size_t end = text.find('}', at);
    if (end == std::string_view::npos) return std::string(text.substr(at));
    if (!is_field(text.substr(at + 1, end - at - 1))) {
      return std::string(text.substr(at, end - at + 1));
    }
  }
  return std::nullopt;
}

std::string filled_in(std::string_view text,
                      const std::function<std::string(std::string_view)>& value_of) {
  std::string result;
  while (!text.empty()) {
    const std::size_t begin = text.find('{');
    const std::size_t end = text.find('}', std::min(begin, text.size()));
    result += text.substr(0, begin);
    if (end == std::string_view::npos) {
      return begin == std::string_view::npos ? result : result.append(text.substr(begin));
    }
    const std::string_view name = text.substr(begin + 1, end - begin - 1);
    result += is_field(name) ? value_of(name) : std::string(text.substr(begin, end - begin + 1));
    text.remove_prefix(end + 1);
  }
  return result;
}

}  // namespace tagsmith::detail
