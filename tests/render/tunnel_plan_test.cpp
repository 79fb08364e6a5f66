// SPDX-License-Identifier: Apache-2.0
// The plan of the tunnel: every tag once, true lengths, never mirrored.
#include "tagsmith/render/tunnel_plan.hpp"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;
using Eigen::Vector2d;

namespace {

Survey winding_survey(double line, int pairs) {
  Survey survey;
  survey.name = "winding";
  survey.tag_template = corridor_template();
  survey.tunnel.left = -2.0;
  survey.tunnel.right = 2.0;
  survey.tunnel.height = 3;
  survey.tunnel.centerline =
      Centerline({500, 1000, -30}, radians(35),
                 {{line, 0, 0}, {40, 1 / 15.0, 0.02}, {line, 0, 0}, {30, -1 / 25.0, 0}});
  survey.series = TagSeries{1.2, 0.6, 1, pairs, {}};
  for (int pair = 0; pair < pairs; ++pair) {
    for (const Side side : {Side::left, Side::right}) {
      survey.tags.push_back(place_in_series(survey, pair, side));
    }
  }
  return survey;
}

std::map<std::string, int> names_in(const std::vector<Sketch>& sketches) {
  std::map<std::string, int> names;
  for (const Sketch& sketch : sketches) {
    for (const SketchLayer& layer : sketch.layers) {
      if (layer.name != "names") continue;
      for (const SketchItem& item : layer.items) ++names[std::get<Words>(item).text];
    }
  }
  return names;
}

}  // namespace

TEST_CASE("strips join, and show every tag once") {
  for (const double line : {5.0, 900.0}) {
    CAPTURE(line);
    const Survey survey = winding_survey(line, static_cast<int>(2 * line + 60));
    const std::vector<PlanStrip> strips = plan_strips(survey);
    CHECK(strips.size() >= (line > 100 ? 20 : 1));
    std::vector<Sketch> sketches;
    for (std::size_t i = 0; i < strips.size(); ++i) {
      if (i > 0) CHECK(strips[i].from == strips[i - 1].to);
      sketches.push_back(tunnel_plan(survey, strips[i]));
    }
    CHECK(strips.front().from <= 0);
    CHECK(strips.back().to >= survey.tunnel.centerline.length());
    const auto names = names_in(sketches);
    CHECK(names.size() == survey.tags.size());
    for (const auto& [name, count] : names) CHECK(count == 1);
  }
}

TEST_CASE("a strip's view is a rotation and its drive runs from left to right") {
  const Survey survey = winding_survey(300, 10);
  for (const PlanStrip& strip : plan_strips(survey)) {
    CHECK(strip.view_from_world.linear().determinant() == Approx(1));
    const Centerline& line = survey.tunnel.centerline;
    const Vector2d from = strip.view_from_world * Vector2d(line.at(strip.from).position.head<2>());
    const Vector2d to = strip.view_from_world * Vector2d(line.at(strip.to).position.head<2>());
    CHECK(to.x() - from.x() > 0);
    CHECK(to.y() - from.y() == Approx(0));
  }
}

TEST_CASE("axes show a grid with x to the left as it is") {
  Survey survey = winding_survey(20, 3);
  const PlanStrip strip = plan_strips(survey).front();
  const auto turn = [&] {
    const ViewAxes axes = plan_axes(survey, strip);
    return axes.x.x() * axes.y.y() - axes.x.y() * axes.y.x();
  };
  CHECK(turn() == Approx(1));  // y is to the left of x
  survey.grid.x_axis_left = true;
  CHECK(turn() == Approx(-1));
}

TEST_CASE("the walls are as far apart as the tunnel is wide, on lines and arcs") {
  const Survey survey = winding_survey(20, 3);
  const PlanStrip strip = plan_strips(survey).front();
  const Sketch sketch = tunnel_plan(survey, strip);
  std::vector<std::vector<SketchPoint>> walls;
  for (const SketchLayer& layer : sketch.layers) {
    if (layer.name != "walls") continue;
    for (const SketchItem& item : layer.items) walls.push_back(std::get<Polyline>(item).points);
  }
  REQUIRE(walls.size() == 2);
  REQUIRE(walls[0].size() == walls[1].size());
  CHECK(walls[0].size() > 20);
  for (std::size_t i = 0; i < walls[0].size(); ++i) {
    CHECK((walls[0][i].model - walls[1][i].model).norm() == Approx(4));
  }
}

TEST_CASE("a tunnel of a hundred kilometres keeps to a bounded number of strips") {
  const Survey survey = winding_survey(50'000, 4);
  CHECK(plan_strips(survey).size() <= kMostStrips);
}
