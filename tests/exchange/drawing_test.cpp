// SPDX-License-Identifier: Apache-2.0
// Drawings and field books: arcs of polylines, entities in coordinates of their own, flat drawings,
// records that are no points.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/exchange/drift_points.hpp"
#include "tests/exchange/dxf_group.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using Eigen::Vector2d;

namespace {

const std::string kDrawnLayout = "--tunnel-height 3 --height 1.2 --spacing 2";

std::string drawing(const std::string& entities) {
  return group(0, "SECTION") + group(2, "HEADER") + group(9, "$INSUNITS") + group(70, "6") +
         group(0, "ENDSEC") + group(0, "SECTION") + group(2, "ENTITIES") + entities +
         group(0, "ENDSEC") + group(0, "EOF");
}

struct Vertex {
  double x;
  double y;
  double bulge = 0;
};

std::string light(const std::string& layer, const std::vector<Vertex>& vertices, double elevation,
                  const std::string& more = "") {
  std::string text = group(0, "LWPOLYLINE") + group(8, layer) + more + group(38, elevation);
  for (const auto& [x, y, bulge] : vertices) {
    text += group(10, x) + group(20, y) + (bulge != 0 ? group(42, bulge) : "");
  }
  return text;
}

// The polyline alone has its elevation.
std::string heavy(const std::string& layer, const std::vector<Vertex>& vertices, double elevation) {
  std::string text = group(0, "POLYLINE") + group(8, layer) + group(66, "1") + group(10, 0.0) +
                     group(20, 0.0) + group(30, elevation) + group(70, "0");
  for (const auto& [x, y, bulge] : vertices) {
    text += group(0, "VERTEX") + group(8, layer) + group(10, x) + group(20, y) + group(30, 0.0) +
            group(42, bulge);
  }
  return text + group(0, "SEQEND");
}

// 20 m to the north, a quarter circle to the left of 30 m radius, 20 m to the west; so far to the
// right of it.
std::vector<Vertex> bend(double right) {
  const double radius = 30 + right;
  return {{500 + right, 1000},
          {500 + right, 1020, std::tan(std::atan(1.0) / 2)},
          {500 + right - radius, 1020 + radius},
          {500 + right - radius - 20, 1020 + radius}};
}

double off_bend(const Vector2d& p) {
  const Vector2d centre(470, 1020);
  if (p.y() <= 1020) return std::abs(p.x() - 500);
  if (p.x() <= 470) return std::abs(p.y() - 1050);
  return std::abs((p - centre).norm() - 30);
}

}  // namespace

TEST_CASE("arcs of polylines are drawn as arcs") {
  struct Case {
    const char* name;
    std::string entities;
    const char* arguments;
  };
  for (const Case& each :
       {Case{"a center line", light("CL", bend(0), 312), "--width 4 "},
        Case{"a heavy one", heavy("CL", bend(0), 312), "--width 4 "},
        Case{"walls and floor",
             light("CL", bend(0), 312) + light("WL", bend(-2), 312) + light("WR", bend(2), 312),
             ""}}) {
    CAPTURE(std::string(each.name));
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), drawing(each.entities), each.arguments + kDrawnLayout);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    const Centerline& line = survey.tunnel.centerline;
    CHECK(std::abs(width_at(survey.tunnel, 0) - 4) < 0.001);
    CHECK(line.length() > 87);
    for (double s = 0; s <= line.length(); s += 0.5) {
      CHECK(off_bend(line.at(s).position.head<2>()) < 0.003);
      CHECK(std::abs(line.at(s).position.z() - 312) < 0.001);
    }
  }
}

TEST_CASE("vertices of spline frames and meshes are left out, and named") {
  const std::string frame = heavy("CL", {{500, 1000}, {500, 1050}, {500, 1100}}, 312);
  std::string with_frame = frame;
  const std::string vertex = group(0, "VERTEX") + group(8, "CL") + group(10, 540.0) +
                             group(20, 1060.0) + group(30, 312.0) + group(70, "16");
  with_frame.insert(with_frame.find(group(0, "SEQEND")), vertex);
  const std::string mesh = group(0, "POLYLINE") + group(8, "CL") + group(70, "64") +
                           group(0, "VERTEX") + group(8, "CL") + group(10, 700.0) +
                           group(20, 1060.0) + group(0, "SEQEND");
  const TemporaryFolder folder;
  const ProgramOutput made =
      draft(folder.path(), drawing(with_frame + mesh), "--width 4 " + kDrawnLayout);
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  CHECK(made.err.find("POLYLINE of a mesh (1), VERTEX of a spline's frame (1)") !=
        std::string::npos);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(survey.tunnel.centerline.elements().size() == 1);
}

TEST_CASE("entities in coordinates of their own lie where the drawing shows them") {
  const Eigen::Vector3d start(500, 1000, 100);
  const Eigen::Vector3d end(520, 1100, 100);
  const auto normal = [](double x, double y, double z) {
    return group(210, x) + group(220, y) + group(230, z);
  };
  struct Case {
    const char* name;
    std::string entities;
  };
  // By the arbitrary axis algorithm: of 0, 0, -1 the x axis is -1, 0, 0; of 0, -1, 0 (a drawing of
  // the front) it is 1, 0, 0, and y is up.
  for (const Case& each :
       {Case{"seen from below", light("CL", {{-500, 1000}, {-520, 1100}}, -100, normal(0, 0, -1))},
        Case{"seen from the front, a line alone",
             group(0, "LINE") + group(8, "CL") + normal(0, -1, 0) + group(10, 500.0) +
                 group(20, 1000.0) + group(30, 100.0) + group(11, 520.0) + group(21, 1100.0) +
                 group(31, 100.0)},
        Case{"blocks seen from the front",
             group(0, "INSERT") + group(8, "CL") + normal(0, -1, 0) + group(10, 500.0) +
                 group(20, 100.0) + group(30, -1000.0) + group(0, "INSERT") + group(8, "CL") +
                 normal(0, -1, 0) + group(10, 520.0) + group(20, 100.0) + group(30, -1100.0)}}) {
    CAPTURE(std::string(each.name));
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), drawing(each.entities), "--width 4 " + kDrawnLayout);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    const Centerline& line = survey.tunnel.centerline;
    for (const Eigen::Vector3d& p : {start, end}) {
      const CenterlineAddress address = line.locate(p.head<2>());
      CHECK(std::abs(address.offset) < 0.001);
      CHECK((line.at(address.chainage).position - p).norm() < 0.001);
    }
  }
  const TemporaryFolder folder;
  const std::string none = light("CL", {{500, 1000}, {520, 1100}}, 100, normal(0, 0, 0));
  const ProgramOutput refused = draft(folder.path(), drawing(none), "--width 4 " + kDrawnLayout);
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("extrusion direction") != std::string::npos);
}

TEST_CASE("a list without heights is told") {
  const TemporaryFolder folder;
  const std::string flat = light("CL", {{500, 1000}, {520, 1100}}, 0);
  const ProgramOutput made = draft(folder.path(), drawing(flat), "--width 4 " + kDrawnLayout);
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  CHECK(made.err.find("[flat-list]") != std::string::npos);
  const TemporaryFolder other;
  const ProgramOutput table = draft(other.path(), "1,500,1000,0,CL\n2,520,1100,0,CL\n",
                                    "--order PENZD --width 4 " + kDrawnLayout);
  REQUIRE_MESSAGE(table.exit_code == 0, table.err);
  CHECK(table.err.find("[flat-list]") != std::string::npos);
}

TEST_CASE("a drawing in which nothing is a point of the list says which layers were left out") {
  const TemporaryFolder folder;
  const std::string walls = light("WALL_LEFT", {{500, 1000}, {520, 1100}}, 100);
  const ProgramOutput refused = draft(folder.path(), drawing(walls), "--width 4 " + kDrawnLayout);
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("left out: WALL_LEFT (1)") != std::string::npos);
  CHECK(refused.err.find("[no-points]") != std::string::npos);
}

TEST_CASE("a drawing in metres that says millimetres is asked for its unit in its own numbers") {
  const TemporaryFolder folder;
  std::string in_mm = drawing(light("WL", {{498, 1000}, {498, 1100}}, 100) +
                              light("WR", {{502, 1000}, {502, 1100}}, 100) +
                              light("FL", {{500, 1000}, {500, 1100}}, 99));
  const std::string metres = group(9, "$INSUNITS") + group(70, "6");
  in_mm.replace(in_mm.find(metres), metres.size(), group(9, "$INSUNITS") + group(70, "4"));
  const ProgramOutput refused = draft(folder.path(), in_mm, kDrawnLayout);
  CHECK(refused.exit_code == 2);
  CHECK_MESSAGE(refused.err.find("the walls lie 4 apart: say in which unit the list is, --units m "
                                 "(4 m), ft (1.22 m)") != std::string::npos,
                refused.err);
}

TEST_CASE("points that only other records of a field book describe are named") {
  std::string book = "JB,NMDRIFT,DT03-31-2026\nMO,AD0,UN1,SF1.0,EC0\n";
  int number = 0;
  for (int y = 0; y <= 40; y += 10) {
    for (const auto& [x, code] : {std::pair(498.0, "WL"), {502.0, "WR"}, {500.0, "CL"}}) {
      book += fmt::format("SS,OP1,FP{},AR10.0,ZE90.0,SD5.0,--{}\n", ++number, code);
      book += fmt::format("SP,PN{},N {:.4f},E {:.4f},EL100.0,--{}\n", number, 1000.0 + y, x, code);
    }
  }
  book += "GS,PN77,N 1010.0,E 498.0,EL101.2,--TL\n--TL of another shift\n";
  const TemporaryFolder folder;
  const ProgramOutput made = draft(folder.path(), book, kDrawnLayout);
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  CHECK_MESSAGE(made.err.find("left out: GS (1) [left-out]") != std::string::npos, made.err);
}
