// SPDX-License-Identifier: Apache-2.0
// Print quality of a symbol in a picture, in the manner of ISO/IEC 15416:2016. A camera is no
// reflectance instrument: without white and black references in the picture reflectances are
// relative, and the parameters that need true ones are left out.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/grade/scan_grade.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// True reflectances of two places of the picture, linear in light.
struct ReflectanceReferences {
  double white_light = 1;        // light that the white reference shows, 0..1
  double white_reflectance = 1;  // and what it reflects
  double black_light = 0;
  double black_reflectance = 0;
};

// Of one parameter, over all scans.
struct ParameterMean {
  double grade = 0;
  std::optional<double> value{};  // what was measured; `decode` has no number
};

struct SymbolGrade {
  double grade = 0;  // mean of the scans' grades in steps of 0.1; 0 if they decode differently
  GradeParameter worst = GradeParameter::decode;  // the one that costs most over all scans
  bool absolute = false;
  // By parameter; nothing for one that was not graded.
  std::array<std::optional<ParameterMean>, kGradeParameters> means{};
};

// Fewer pixels a module than this show the camera's blur rather than the print.
inline constexpr double kLeastGradedModule = 4;

// Grades ten scans, evenly spread over the inner 80 % of the bars' height. `corners` are the
// feature frame's inner ones in pixels, clockwise from P. Light is averaged over an aperture of
// 0.5 module. Fails, saying what is missing, when a module has fewer than kLeastGradedModule
// pixels or the symbol leaves the picture.
Result<SymbolGrade> grade_symbol(const GrayView& image, const Quad& corners,
                                 const SymbolLayout& layout,
                                 const std::optional<ReflectanceReferences>& references = {});

// "3.4 (decodability)"; "4.0" without a blame.
std::string to_string(const SymbolGrade& grade);

}  // namespace tagsmith::detail
