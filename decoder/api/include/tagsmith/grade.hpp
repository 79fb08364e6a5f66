// SPDX-License-Identifier: Apache-2.0
// Print quality of a tag in a picture, in the manner of ISO/IEC 15416:2016.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tagsmith/drawing.hpp>
#include <tagsmith/export.hpp>
#include <tagsmith/geometry.hpp>
#include <tagsmith/image.hpp>

namespace tagsmith {

// Reflectances of two places of the picture, 0 to 1. Light is linear, as the picture shows it.
struct ReflectanceReferences {
  double white_light = 1;
  double white_reflectance = 1;
  double black_light = 0;
  double black_reflectance = 0;
};

struct GradeParameter {
  std::string name;             // "decode", "modulation", "quiet zone" and others
  double grade = 0;             // 4 (best) to 0, mean of ten scans
  std::optional<double> value;  // as measured; `decode` has none
};

struct Grade {
  double grade = 0;       // 4.0 (best) to 0.0, in steps of 0.1
  std::string worst;      // the parameter with the lowest grade
  bool absolute = false;  // by references; else parameters that need true reflectances are left out
  std::vector<GradeParameter> parameters;
};

// Grades the symbol in a feature frame (Tag::corners) of this plate. A camera is no reflectance
// instrument: a grade concerns print and picture together. Fails with ErrorCode::failed where a
// module has fewer than 4 pixels or the symbol leaves the picture, with ErrorCode::invalid_argument
// on an empty view.
TAGSMITH_EXPORT Grade grade(const ImageView& image, const Corners& corners,
                            const PlateTemplate& plate = {},
                            const std::optional<ReflectanceReferences>& references = {});

}  // namespace tagsmith
