// SPDX-License-Identifier: Apache-2.0
// Print quality of a UPC-A symbol in the manner of ISO/IEC 15416:2016: for one scan, and for a
// symbol in a picture.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// ---- One scan.

enum class GradeParameter {
  decode,
  symbol_contrast,
  minimum_reflectance,
  minimum_edge_contrast,
  modulation,
  defects,
  decodability,
  quiet_zone,
};
inline constexpr std::size_t kGradeParameters = 8;

std::string to_string(GradeParameter parameter);

// Reflectances are shares of perfect white, of the plate itself in a negative too; widths are
// modules.
struct ScanParameters {
  std::optional<Digits> digits;  // by the reference decode: distances between like edges
  double greatest_reflectance = 0;
  double least_reflectance = 0;
  double symbol_contrast = 0;
  double minimum_edge_contrast = 0;
  double modulation = 0;
  double defects = 0;
  double decodability = 0;
  double quiet_zone = 0;  // of the narrower one
};

// The measured value of the parameter; nothing for `decode`, which is no number.
std::optional<double> value_of(const ScanParameters& scan, GradeParameter parameter);

// Of contrast, modulation and decodability the least values for the grades 4, 3, 2 and 1, of
// defects the greatest (ISO/IEC 15416, 5.4); zeros of the others, which are passed or failed.
std::array<double, 4> grade_limits(GradeParameter parameter);

struct GradeOptions {
  // Whether reflectances are true ones, by white and black references in the picture. If not, the
  // parameters that need them (symbol contrast, the edge contrast's 15 %) are left out.
  bool absolute = false;
  // Modules of quiet zone beyond either end of the profile.
  double quiet_beyond = 0;
  // Whether the profile is that of a negative: the symbol is light on dark. Contrasts and widths
  // are the same; which reflectance is the least is not.
  bool is_negative = false;
};

struct ScanGrade {
  ScanParameters parameters;
  // 4 (best) to 0, in continuous steps; nothing for a parameter that is not graded.
  std::array<std::optional<double>, kGradeParameters> grades;
  double grade = 0;  // the least of them
  GradeParameter worst = GradeParameter::decode;
};

// Grades a scan reflectance profile: equally spaced reflectances from the outer end of the left
// quiet zone to that of the right one.
ScanGrade grade_scan(std::span<const double> reflectance, const GradeOptions& options);

// ---- A symbol in a picture. A camera is no reflectance instrument: without white and black
// references in the picture reflectances are relative, and the parameters that need true ones are
// left out.

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
  GradeParameter worst = GradeParameter::decode;  // the one with the lowest grade over all scans
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

// "3.4 (decodability)"; "4.0" without a parameter.
std::string to_string(const SymbolGrade& grade);

}  // namespace tagsmith::detail
