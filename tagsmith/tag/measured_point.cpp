// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/measured_point.hpp"

namespace tagsmith::detail {

std::vector<MeasuredPoint> points_besides_p(const TagTemplate& tag) {
  const double length = tag.frame_inner_length, height = tag.frame_inner_height;
  const double stroke = tag.frame_stroke;
  const double plate_right = (length - tag.plate_length) / 2 - tag.frame_offset_right;
  const double plate_down = (height - tag.plate_height) / 2 + tag.frame_offset_up;
  return {{"middle", "the frame's middle", length / 2, height / 2},
          {"top-right", "the frame's top right corner", length, 0},
          {"bottom-left", "the frame's bottom left corner", 0, height},
          {"bottom-right", "the frame's bottom right corner", length, height},
          {"outer", "the frame's outer top left corner", -stroke, -stroke},
          {"plate", "the plate's top left corner", plate_right, plate_down}};
}

}  // namespace tagsmith::detail
