// SPDX-License-Identifier: Apache-2.0
// Each parameter of ISO/IEC 15416 on profiles where it is known exactly.
#include <algorithm>

#include <doctest/doctest.h>

#include "decoder/grade/grade.hpp"
#include "tests/grade/synthetic_symbol.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

constexpr GradeOptions kAbsolute{true, 0};

double grade_of(const ScanGrade& scan, GradeParameter parameter) {
  return scan.grades[static_cast<std::size_t>(parameter)].value_or(-1);
}

}  // namespace

TEST_CASE("a perfect symbol has grade 4 in every parameter") {
  const ScanGrade scan = grade_scan(profile_of(edges_of(kDigits)), kAbsolute);
  CHECK(scan.parameters.digits == kDigits);
  CHECK(scan.parameters.symbol_contrast == Approx(0.8));
  CHECK(scan.parameters.modulation == Approx(1));
  CHECK(scan.parameters.defects == Approx(0));
  CHECK(scan.parameters.decodability == Approx(1).epsilon(0.02));
  CHECK(scan.parameters.quiet_zone == Approx(9).epsilon(0.01));
  CHECK(scan.grade == 4);
  for (const auto& grade : scan.grades) CHECK(grade == 4.0);
}

TEST_CASE("every digit decodes in both halves") {
  for (std::uint8_t digit = 0; digit < 10; ++digit) {
    Digits digits;
    digits.fill(digit);
    digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
    CAPTURE(to_string(digits));
    CHECK(grade_scan(profile_of(edges_of(digits)), {}).parameters.digits == digits);
  }
}

TEST_CASE("symbol contrast is graded with references only") {
  std::vector<double> profile = profile_of(edges_of(kDigits));
  for (double& reflectance : profile) reflectance = reflectance > 0.5 ? 0.575 : 0.10;
  const ScanGrade absolute = grade_scan(profile, kAbsolute);
  CHECK(absolute.parameters.symbol_contrast == Approx(0.475));
  CHECK(grade_of(absolute, GradeParameter::symbol_contrast) == Approx(2.5));
  CHECK(absolute.grade == Approx(2.5));
  CHECK(absolute.worst == GradeParameter::symbol_contrast);
  const ScanGrade relative = grade_scan(profile, {});
  CHECK(!relative.grades[static_cast<std::size_t>(GradeParameter::symbol_contrast)].has_value());
  CHECK(relative.grade == 4);
}

TEST_CASE("white bars on black need not be bright, only twice as bright as the plate") {
  const auto graded = [](double white, double black) {
    std::vector<double> negative = profile_of(edges_of(kDigits));
    for (double& reflectance : negative) reflectance = 1 - (reflectance > 0.5 ? black : white);
    return grade_scan(negative, {.is_negative = true});
  };
  const ScanGrade dim = graded(0.3, 0.1);
  CHECK(dim.parameters.least_reflectance == Approx(0.1));
  CHECK(dim.parameters.greatest_reflectance == Approx(0.3));
  CHECK(dim.grade == 4);
  const ScanGrade grey = graded(0.9, 0.5);
  CHECK(grey.grade == 0);
  CHECK(grey.worst == GradeParameter::minimum_reflectance);
}

TEST_CASE("a pale narrow bar lowers modulation as much as it is pale") {
  std::vector<double> profile = profile_of(edges_of(kDigits));
  paint(profile, 0, 1, 0.46);  // the first guard bar
  const ScanGrade scan = grade_scan(profile, kAbsolute);
  CHECK(scan.parameters.minimum_edge_contrast == Approx(0.44));
  CHECK(scan.parameters.modulation == Approx(0.55));
  CHECK(grade_of(scan, GradeParameter::modulation) == Approx(2.5));
  CHECK(scan.worst == GradeParameter::modulation);
}

TEST_CASE("a speck in a space and a void in a bar are defects") {
  std::vector<double> speck = profile_of(edges_of(kDigits));
  paint(speck, -5, -4.5, 0.90 - 0.18);  // in the quiet zone, above the threshold
  const ScanGrade in_space = grade_scan(speck, kAbsolute);
  CHECK(in_space.parameters.defects == Approx(0.18 / 0.8));
  CHECK(grade_of(in_space, GradeParameter::defects) == Approx(2.5));
  std::vector<double> hole = profile_of(edges_of(kDigits));
  const std::vector<double> edges = edges_of(kDigits);
  std::size_t widest = 0;
  for (std::size_t i = 0; i + 1 < edges.size(); i += 2) {
    if (edges[i + 1] - edges[i] > edges[widest + 1] - edges[widest]) widest = i;
  }
  const double middle = (edges[widest] + edges[widest + 1]) / 2;
  paint(hole, middle - 0.2, middle + 0.2, 0.30);
  CHECK(grade_scan(hole, kAbsolute).parameters.defects == Approx(0.25));
}

TEST_CASE("an edge out of place costs decodability by its shift") {
  std::vector<double> edges = edges_of(kDigits);
  const auto first = static_cast<std::size_t>(first_element_of_digit(2));
  edges[first + 1] += 0.2;  // one of two like edges: their distance is off by 0.2 of half a module
  const ScanGrade scan = grade_scan(profile_of(edges), kAbsolute);
  CHECK(scan.parameters.digits == kDigits);
  CHECK(scan.parameters.decodability == Approx(1 - 0.2 / 0.5).epsilon(0.05));
}

TEST_CASE("growth of the bars costs the digits that are told by their bars alone") {
  const auto with_growth = [](const Digits& digits, double growth) {
    std::vector<double> edges = edges_of(digits);
    for (std::size_t i = 0; i < edges.size(); ++i) edges[i] += (i % 2 == 0 ? -0.5 : 0.5) * growth;
    return grade_scan(profile_of(edges), kAbsolute);
  };
  // Two bars that grow by 0.3 each bring a left 1 (3 modules of bars, 7 has 5) nearer to 4.
  const ScanGrade left = with_growth(*parse_digits("012345678905"), 0.3);
  CHECK(left.parameters.decodability == Approx(1 - 2 * 0.3).epsilon(0.1));
  const ScanGrade right = with_growth(kDigits, -0.3);  // a right 1 (4, and 7 has 2) nearer to 3
  CHECK(right.parameters.decodability == Approx(1 - 2 * 0.3).epsilon(0.1));
  const Digits others = *parse_digits("000000000000");
  CHECK(with_growth(others, 0.3).parameters.decodability == Approx(1).epsilon(0.05));
}

TEST_CASE("a narrow quiet zone, a missing bar and no contrast fail") {
  const ScanGrade narrow = grade_scan(profile_of(edges_of(kDigits), 7), kAbsolute);
  CHECK(grade_of(narrow, GradeParameter::quiet_zone) == 0);
  CHECK(narrow.worst == GradeParameter::quiet_zone);
  std::vector<double> missing = profile_of(edges_of(kDigits));
  paint(missing, 0, 1, kWhite);
  const ScanGrade undecoded = grade_scan(missing, kAbsolute);
  CHECK(!undecoded.parameters.digits.has_value());
  CHECK(undecoded.grade == 0);
  CHECK(undecoded.worst == GradeParameter::decode);
  CHECK(grade_scan(std::vector<double>(1000, 0.5), kAbsolute).grade == 0);
  CHECK(grade_scan({}, kAbsolute).grade == 0);
}

TEST_CASE("the narrower quiet zone counts, on either side") {
  std::vector<double> profile = profile_of(edges_of(kDigits));
  profile.resize(profile.size() - kPerModule);
  const double after = grade_scan(profile, kAbsolute).parameters.quiet_zone;
  CHECK(after == Approx(8).epsilon(0.01));
  std::ranges::reverse(profile);
  CHECK(grade_scan(profile, kAbsolute).parameters.quiet_zone == Approx(after));
}

TEST_CASE("a black that reflects more than half of the white fails") {
  std::vector<double> profile = profile_of(edges_of(kDigits));
  for (double& reflectance : profile) reflectance = reflectance > 0.5 ? 0.90 : 0.50;
  const ScanGrade scan = grade_scan(profile, {});
  CHECK(grade_of(scan, GradeParameter::minimum_reflectance) == 0);
}
