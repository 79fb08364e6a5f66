// SPDX-License-Identifier: Apache-2.0
// The text of a drawing's title block, and the paper of the drawing.
#pragma once

#include <string>
#include <vector>

namespace tagsmith::detail {

enum class Paper { a4, a3, letter };  // landscape

struct TitleField {
  std::string name;
  std::string value;
};

// The block at the lower right (ISO 7200). Scale, unit and sheet number are added.
struct TitleBlock {
  std::string title;
  std::string subject;
  std::vector<TitleField> fields{};
};

// "1 : 50", "2 : 1".
std::string scale_text(double denominator);

// 1, 2 or 5 times a power of ten, at least `least`.
double round_step(double least);

}  // namespace tagsmith::detail
