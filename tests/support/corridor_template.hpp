// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail::test {

// The plate of the straight corridor experiment (Xu et al. 2017), as templates/tag-400x300.yaml has
// it, for tests of layers that do not read files.
inline TagTemplate corridor_template() {
  TagTemplate tag;
  tag.name = "tag-400x300";
  tag.plate_length = 0.400;
  tag.plate_height = 0.300;
  tag.frame_inner_length = 0.343;
  tag.frame_inner_height = 0.168;
  tag.frame_stroke = 0.012;
  return tag;
}

}  // namespace tagsmith::detail::test
