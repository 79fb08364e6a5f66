// SPDX-License-Identifier: Apache-2.0
// Alignments of LandXML: vertical curves, profiles, curves that contradict themselves, grids.
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/exchange/drift_points.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

const std::string kLine =
    "<Line><Start>1000 500</Start><End>1100 500</End></Line>";  // 100 m to the north
const std::string kAlignedLayout = "--width 4 --tunnel-height 3 --height 1.2 --spacing 2";

std::string profile(const std::string& points, const std::string& name = "p") {
  return "<Profile><ProfAlign name=\"" + name + "\">" + points + "</ProfAlign></Profile>";
}

std::string aligned(const std::string& elements, const std::string& profiles,
                    const std::string& head = "<Units><Metric linearUnit=\"meter\"/></Units>") {
  return "<?xml version=\"1.0\"?>\n"
         "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\">\n" +
         head + "\n<Alignments><Alignment name=\"axis\" staStart=\"0\">\n<CoordGeom>\n" + elements +
         "\n</CoordGeom>\n" + profiles + "</Alignment></Alignments></LandXML>\n";
}

// A quarter circle to the right of 30 m radius.
std::string curve(const std::string& attributes) {
  return "<Curve " + attributes +
         "><Start>1020 500</Start><Center>1020 530</Center><End>1050 530</End></Curve>";
}

}  // namespace

TEST_CASE("vertical curves of a profile are the floor's, to two millimetres") {
  struct Case {
    const char* name;
    std::string points;
    std::function<double(double)> height;
  };
  const double turned = std::atan(0.1);
  const double tangent = 300 * std::tan(turned / 2);
  for (const Case& each :
       {Case{
            "a sag",
            "<PVI>0 100</PVI><ParaCurve length=\"80\">50 100</ParaCurve><PVI>100 105</PVI>",
            [](double s) {
              return 100 + (s < 10 ? 0 : s < 90 ? (s - 10) * (s - 10) * 0.1 / 160 : 0.1 * (s - 50));
            }},
        Case{"a crest, longer behind than before",
             "<PVI>0 100</PVI><UnsymParaCurve lengthIn=\"20\" lengthOut=\"40\">50 105"
             "</UnsymParaCurve><PVI>100 105</PVI>",
             [](double s) {
               // 10 % up, then level; 20 * 40 * -0.1 / (2 * 60) below the corner.
               const double below = -20 * 40 * 0.1 / 120;
               if (s < 30 || s > 90) return s < 30 ? 100 + 0.1 * s : 105.0;
               const double share = s < 50 ? (s - 30) / 20 : (90 - s) / 40;
               return (s < 50 ? 100 + 0.1 * s : 105) + below * share * share;
             }},
        Case{"an arc",
             "<PVI>0 100</PVI><CircCurve length=\"29.9\" radius=\"300\">50 100</CircCurve>"
             "<PVI>100 105</PVI>",
             [&](double s) {
               const double from = s - (50 - tangent);
               if (from < 0) return 100.0;
               if (s > 50 + tangent * std::cos(turned)) return 100 + 0.1 * (s - 50);
               return 400 - std::sqrt(300 * 300 - from * from);
             }}}) {
    CAPTURE(std::string(each.name));
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), aligned(kLine, profile(each.points)), kAlignedLayout);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    for (double s = 0; s <= 100; s += 0.7) {
      CAPTURE(s);
      const double z = survey.tunnel.centerline.at(s).position.z();
      CHECK(std::abs(z - each.height(s)) < 0.002);
    }
  }
}

TEST_CASE("a profile says heights where it is, and which profile is meant is not guessed") {
  const TemporaryFolder folder;
  const std::string short_of_it = profile("<PVI>0 100</PVI><PVI>60 106</PVI>");
  const ProgramOutput ends = draft(folder.path(), aligned(kLine, short_of_it), kAlignedLayout);
  REQUIRE_MESSAGE(ends.exit_code == 0, ends.err);
  CHECK(ends.err.find("from station 0 to 60, the alignment from 0 to 100") != std::string::npos);
  CHECK(ends.err.find("[short-profile]") != std::string::npos);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(std::abs(survey.tunnel.centerline.at(100).position.z() - 110) < 0.002);
  fs::remove_all(folder.path() / "out");

  // Of alignments likewise, also where a second collection has the other.
  std::string others = aligned(kLine, short_of_it);
  others.insert(others.find("</LandXML>"), "<Alignments><Alignment name=\"other\"><CoordGeom>" +
                                               kLine + "</CoordGeom></Alignment></Alignments>");
  const ProgramOutput lines = draft(folder.path(), others, kAlignedLayout);
  CHECK(lines.exit_code == 2);
  CHECK(lines.err.find("axis, other [several-alignments]") != std::string::npos);

  const std::string two =
      profile("<PVI>0 90</PVI><PVI>100 92</PVI>", "existing") +
      "<Profile><ProfSurf name=\"rock\"><PntList2D>0 90 100 92</PntList2D></ProfSurf>"
      "<ProfAlign name=\"design\"><PVI>0 100</PVI><PVI>100 105</PVI></ProfAlign></Profile>";
  const ProgramOutput both = draft(folder.path(), aligned(kLine, two), kAlignedLayout);
  CHECK(both.exit_code == 2);
  CHECK(both.err.find("existing, design [several-alignments]") != std::string::npos);
  const ProgramOutput one =
      draft(folder.path(), aligned(kLine, two), kAlignedLayout + " --ignore existing");
  REQUIRE_MESSAGE(one.exit_code == 0, one.err);
  const Survey design = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(std::abs(design.tunnel.centerline.at(100).position.z() - 105) < 0.002);
}

TEST_CASE("alignments and profiles that contradict themselves are refused") {
  const std::string level = profile("<PVI>0 100</PVI><PVI>200 100</PVI>");
  struct Case {
    const char* name;
    std::string elements;
    std::string profile;
    const char* told;
  };
  for (const Case& each :
       {Case{"no rotation", curve(""), level, "rot=\"cw\""},
        Case{"the other rotation, by the length", curve("rot=\"ccw\" length=\"47.12389\""), level,
             "contradict"},
        Case{"the other rotation, by the angle", curve("rot=\"ccw\" delta=\"90\""), level,
             "contradict"},
        Case{"another radius", curve("rot=\"cw\" radius=\"300\""), level, "contradict"},
        Case{"a line of another length",
             "<Line length=\"150\"><Start>1000 500</Start><End>1100 500</End></Line>", level,
             "contradict"},
        Case{"a profile elsewhere", kLine, profile("<PVI>1000 100</PVI><PVI>1100 105</PVI>"),
             "from station 1000 to 1100, the alignment from 0 to 100 [short-profile]"},
        Case{"an unknown curve", kLine,
             profile("<PVI>0 100</PVI><Spline>50 100</Spline><PVI>100 100</PVI>"),
             "Spline of profile p"},
        Case{"a curve without its length", kLine,
             profile("<PVI>0 100</PVI><ParaCurve>50 100</ParaCurve><PVI>100 105</PVI>"),
             "ParaCurve of profile p"},
        Case{"curves that overlap", kLine,
             profile("<PVI>0 100</PVI><ParaCurve length=\"50\">40 100</ParaCurve>"
                     "<ParaCurve length=\"50\">60 105</ParaCurve><PVI>100 105</PVI>"),
             "vertical curves overlap"},
        Case{"stations that do not rise", kLine, profile("<PVI>0 100</PVI><PVI>0 105</PVI>"),
             "does not lie behind"},
        Case{"an arc of another length", kLine,
             profile("<PVI>0 100</PVI><CircCurve length=\"60\" radius=\"300\">50 100</CircCurve>"
                     "<PVI>100 105</PVI>"),
             "its radius makes"}}) {
    CAPTURE(std::string(each.name));
    const TemporaryFolder folder;
    const ProgramOutput refused =
        draft(folder.path(), aligned(each.elements, each.profile), kAlignedLayout);
    CHECK(refused.exit_code == 2);
    CHECK_MESSAGE(refused.err.find(each.told) != std::string::npos, refused.err);
    CHECK_FALSE(fs::exists(folder.path() / "out"));
  }
  for (const char* good : {"rot=\"cw\" length=\"47.124\" radius=\"30\" delta=\"90\"",
                           "rot=\"cw\" delta=\"1.570796\"", "rot=\"cw\" delta=\"100.0000\""}) {
    CAPTURE(std::string(good));
    const TemporaryFolder folder;
    const ProgramOutput made = draft(folder.path(), aligned(curve(good), level), kAlignedLayout);
    CHECK_MESSAGE(made.exit_code == 0, made.err);
  }
}

TEST_CASE("a curve that is nearly a line is taken as it is") {
  // 100 m of 200 km radius between lines: 6 mm of sagitta.
  const double angle = 100 / 2e5;
  const double y = 1020 + 2e5 * std::sin(angle);
  const double x = 500 + 2e5 * (1 - std::cos(angle));
  const std::string elements = fmt::format(
      "<Line><Start>1000 500</Start><End>1020 500</End></Line>"
      "<Curve rot=\"cw\" radius=\"200000\" length=\"100\"><Start>1020 500</Start>"
      "<Center>1020 200500</Center><End>{0:.6f} {1:.6f}</End></Curve>"
      "<Line><Start>{0:.6f} {1:.6f}</Start><End>{2:.6f} {3:.6f}</End></Line>",
      y, x, y + 20 * std::cos(angle), x + 20 * std::sin(angle));
  const TemporaryFolder folder;
  const ProgramOutput made =
      draft(folder.path(), aligned(elements, profile("<PVI>0 100</PVI><PVI>200 100</PVI>")),
            kAlignedLayout);
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(survey.tunnel.centerline.elements().size() == 3);
  CHECK((survey.tunnel.centerline.at(120).position.head<2>() - Eigen::Vector2d(x, y)).norm() <
        1e-4);
}

TEST_CASE("a grid in feet is left out, with a word, where a file in feet becomes metres") {
  const auto head = [](const char* unit, int epsg) {
    return fmt::format(
        "<Units><Imperial linearUnit=\"{}\"/></Units><CoordinateSystem "
        "epsgCode=\"{}\"/>",
        unit, epsg);
  };
  const std::string feet = "<Line><Start>3280 6561</Start><End>3600 6561</End></Line>";
  const std::string level = profile("<PVI>0 100</PVI><PVI>320 100</PVI>");
  for (const int epsg : {2225, 25832}) {  // a grid in feet, and one that says nothing of its feet
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), aligned(feet, level, head("USSurveyFoot", epsg)), kAlignedLayout);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    CHECK_MESSAGE(made.err.find(fmt::format("EPSG:{} is left out", epsg)) != std::string::npos,
                  made.err);
    CHECK(made.out.find("in units of 0.30480061 m") != std::string::npos);
    CHECK(load_survey(folder.path() / "out" / "survey.yaml").value().grid.epsg == 0);
  }
  const TemporaryFolder folder;
  const ProgramOutput metres =
      draft(folder.path(), aligned(kLine, level, head("meter", 26941)), kAlignedLayout);
  REQUIRE_MESSAGE(metres.exit_code == 0, metres.err);
  CHECK(load_survey(folder.path() / "out" / "survey.yaml").value().grid.epsg == 26941);
}
