// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

double module_width(const TagTemplate& tag) {
  return tag.frame_inner_length / (kModuleCount + 2.0 * tag.quiet_zone_modules);
}

double bar_height(const TagTemplate& tag) {
  return tag.frame_inner_height - 2.0 * tag.margin_modules * module_width(tag);
}

}  // namespace tagsmith::detail
