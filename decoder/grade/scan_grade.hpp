// SPDX-License-Identifier: Apache-2.0
// Print quality of one scan of a UPC-A symbol in the manner of ISO/IEC 15416:2016.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

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

// What was measured of the parameter; nothing of `decode`, which is no number.
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

}  // namespace tagsmith::detail
