// SPDX-License-Identifier: Apache-2.0
// The tunnel in DXF, read back by its groups of code and value.
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/survey_exchange.hpp"
#include "tests/render/sample_survey.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

struct Entity {
  std::string type;
  std::map<int, std::string> values;  // the last of each code

  double number(int code) const { return std::stod(values.at(code)); }
  Eigen::Vector3d point(int code) const {
    return {number(code), number(code + 10), number(code + 20)};
  }
};

// Those of a layer.
std::vector<Entity> entities_of(const std::string& dxf, const std::string& layer) {
  std::vector<Entity> entities;
  std::istringstream lines(dxf);
  std::string code, value;
  while (std::getline(lines, code) && std::getline(lines, value)) {
    if (value.ends_with('\r')) value.pop_back();
    if (std::stoi(code) == 0) {
      entities.push_back({value, {}});
    } else if (!entities.empty()) {
      entities.back().values[std::stoi(code)] = value;
    }
  }
  std::erase_if(entities, [&](const Entity& entity) {
    const auto on = entity.values.find(8);
    return on == entity.values.end() || on->second != layer;
  });
  return entities;
}

}  // namespace

TEST_CASE("the center line is a line, an arc where it bends on the level, points where it climbs") {
  Survey survey = sample_survey(small_template());
  const double quarter = radians(90);
  survey.tunnel.centerline = Centerline(
      {5, 7, 2}, 0, {{4, 0, 0}, {6 * quarter, 1 / 6.0, 0}, {8 * quarter, -1 / 8.0, 0.1}});
  const Centerline& line = survey.tunnel.centerline;
  int lines = 0, arcs = 0, climbing = 0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Entity& entity : entities_of(render_dxf(survey), "CENTERLINE")) {
    if (entity.type == "LINE") {
      ++lines;
      CHECK((entity.point(10) - Eigen::Vector3d(5, 7, 2)).norm() < 1e-5);
      CHECK((entity.point(11) - Eigen::Vector3d(5, 11, 2)).norm() < 1e-5);
    } else if (entity.type == "ARC") {
      ++arcs;
      // It turns right about a place 6 m to the right, from heading north to heading east.
      CHECK((entity.point(10) - Eigen::Vector3d(11, 11, 2)).norm() < 1e-5);
      CHECK(entity.number(40) == doctest::Approx(6));
      CHECK(entity.number(50) == doctest::Approx(90));
      CHECK(std::abs(entity.number(51)) == doctest::Approx(180));
    } else if (entity.type == "VERTEX") {
      ++climbing;
      last = entity.point(10);
      const CenterlineAddress address = line.locate(last.head<2>());
      CHECK(std::abs(address.offset) < 1e-5);
      CHECK(address.chainage > 4 + 6 * quarter - 1e-5);
      CHECK(last.z() == doctest::Approx(line.at(address.chainage).position.z()).epsilon(1e-5));
    }
  }
  CHECK(lines == 1);
  CHECK(arcs == 1);
  CHECK(climbing > 20);
  CHECK((last - line.at(line.length()).position).norm() < 1e-5);
}
