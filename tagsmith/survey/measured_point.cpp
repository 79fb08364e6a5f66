// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/measured_point.hpp"

namespace tagsmith::detail {

std::vector<MeasuredPoint> points_besides_p(const TagTemplate& tag) {
  const double length = tag.frame_inner_length, height = tag.frame_inner_height;
  const double stroke = tag.frame_stroke;
  const Eigen::Vector2d corner_of_plate((length - tag.plate_length) / 2 - tag.frame_offset_right,
                                        (height - tag.plate_height) / 2 + tag.frame_offset_up);
  return {{"middle", "the frame's middle", {length / 2, height / 2}},
          {"top-right", "the frame's top right corner", {length, 0}},
          {"bottom-left", "the frame's bottom left corner", {0, height}},
          {"bottom-right", "the frame's bottom right corner", {length, height}},
          {"outer", "the frame's outer top left corner", {-stroke, -stroke}},
          {"plate", "the plate's top left corner", corner_of_plate}};
}

}  // namespace tagsmith::detail
