// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/survey_options.hpp"

#include <algorithm>
#include <vector>

namespace tagsmith::detail {

ReadOptions read_options_of(std::span<const Survey* const> surveys) {
  ReadOptions options;
  if (surveys.empty()) return options;
  options.layouts.clear();
  for (const Survey* survey : surveys) {
    for (const PlacedTag& tag : survey->tags) options.code_book.push_back(tag.digits);
    const SymbolLayout layout = layout_of(survey->tag_template);
    if (std::ranges::find(options.layouts, layout) == options.layouts.end()) {
      options.layouts.push_back(layout);
    }
  }
  options.white_on_black = surveys.front()->tag_template.white_on_black;
  const CheckDigit check = surveys.front()->code.check;
  const auto agrees = [&](const Survey* survey) { return survey->code.check == check; };
  if (std::ranges::all_of(surveys, agrees)) options.check = check;
  return options;
}

ReadOptions read_options_for(std::span<const Survey> surveys) {
  std::vector<const Survey*> each;
  each.reserve(surveys.size());
  for (const Survey& survey : surveys) each.push_back(&survey);
  return read_options_of(each);
}

}  // namespace tagsmith::detail
