// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {
namespace {

struct Place {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0;
};

// Where a clothoid is after `way` metres, by Simpson's rule on the cosine and sine of its heading.
Place on_clothoid(double length, double from, double to, double way) {
  const auto heading = [&](double s) { return from * s + (to - from) * s * s / (2 * length); };
  constexpr int kSteps = 20000;
  const double step = way / kSteps;
  Place place;
  for (int i = 0; i <= kSteps; ++i) {
    const double weight = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
    const double at = heading(step * i);
    place.position += weight * step / 3 * Eigen::Vector2d(std::sin(at), std::cos(at));
  }
  place.heading = heading(way);
  return place;
}

}  // namespace

TEST_CASE("the arcs of a clothoid follow it within a twentieth of a millimetre") {
  struct Case {
    double length, from, to;
  };
  for (const Case& one :
       {Case{30, 0, 1.0 / 50}, Case{30, 1.0 / 50, 0}, Case{12, 0, -1.0 / 8},
        Case{60, 1.0 / 200, 1.0 / 25}, Case{300, 0, 1.0 / 400}, Case{1, 0, 1.0 / 1000}}) {
    CAPTURE(one.length);
    CAPTURE(one.to);
    const Centerline line({0, 0, 0}, 0, arcs_of_clothoid(one.length, one.from, one.to, 1));
    CHECK(line.length() == doctest::Approx(one.length).epsilon(1e-12));
    double farthest = 0;
    for (int i = 1; i <= 200; ++i) {
      const double way = one.length * i / 200;
      const Place place = on_clothoid(one.length, one.from, one.to, way);
      farthest = std::max(farthest, (line.at(way).position.head<2>() - place.position).norm());
    }
    CHECK(farthest < 5e-5);
    const Place end = on_clothoid(one.length, one.from, one.to, one.length);
    CHECK(line.at(one.length).heading == doctest::Approx(end.heading).epsilon(1e-9));
  }
}

TEST_CASE("a clothoid is known again by all of its arcs, and by no fewer") {
  std::vector<CenterlineElement> line{{5, 0}};
  const std::vector<CenterlineElement> arcs = arcs_of_clothoid(30, 0, -1.0 / 50, 7);
  REQUIRE(arcs.size() > 4);
  line.insert(line.end(), arcs.begin(), arcs.end());
  line.push_back({9, -1.0 / 50});
  std::span<const CenterlineElement> rest = line;
  CHECK(leading_part(rest).size() == 1);
  CHECK_FALSE(clothoid_of(leading_part(rest)));
  rest = rest.subspan(1);
  const std::optional<Clothoid> found = clothoid_of(leading_part(rest));
  REQUIRE(found);
  CHECK(leading_part(rest).size() == arcs.size());
  CHECK(found->length == doctest::Approx(30).epsilon(1e-12));
  CHECK(found->from == 0);
  CHECK(found->to == doctest::Approx(-1.0 / 50).epsilon(1e-12));
  CHECK(leading_part(rest.subspan(1)).size() == 1);
  CHECK(leading_part(rest.subspan(arcs.size())).size() == 1);
  CHECK(clothoid_of({}) == std::nullopt);
}

}  // namespace tagsmith::detail
