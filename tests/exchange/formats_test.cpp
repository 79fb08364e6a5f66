// SPDX-License-Identifier: Apache-2.0
// Surveyed points of instruments, field books and CAD become the same survey as a table of them.
#include <cmath>
#include <filesystem>
#include <functional>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/exchange/drift_points.hpp"
#include "tests/exchange/dxf_group.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

using Points = std::vector<PointWriter::Point>;

constexpr double kFoot = 0.3048;
constexpr double kSurveyFoot = 1200.0 / 3937;

Points scaled(Points points, double metres_per_unit) {
  for (auto& point : points) point.p /= metres_per_unit;
  return points;
}

std::string comma(double value) {
  std::string text = fmt::format("{:.4f}", value);
  text[text.find('.')] = ',';
  return text;
}

std::string table(const Points& points, const std::string& separator, bool decimal_comma) {
  std::string text;
  int number = 0;
  for (const auto& [p, code] : points) {
    text += std::to_string(++number);
    for (const double value : p) {
      text += separator + (decimal_comma ? comma(value) : fmt::format("{:.4f}", value));
    }
    text += separator + code + "\n";
  }
  return text;
}

std::string gsi_word(const std::string& index, const std::string& data, std::size_t size) {
  return index + "+" + std::string(size - data.size(), '0') + data + " ";
}

// `unit`: the digit; `scale`: its last digits a metre or foot. Codes in words 71, or in blocks
// before or behind their points; "empty": before them, and empty words 71.
std::string gsi(const Points& points, char unit, double scale, const std::string& codes) {
  std::string text;
  int block = 0;
  const auto length = [&](const char* index, double value) {
    return gsi_word(std::string(index) + "..0" + unit,
                    fmt::format("{}", std::llround(value * scale)), 16);
  };
  for (const auto& [p, full_code] : points) {
    const std::string code = full_code.substr(0, full_code.find(' '));
    const std::string code_block =
        "*" + gsi_word(fmt::format("41{:04}", ++block), code, 16) + "\r\n";
    if (codes == "before" || codes == "empty") text += code_block;
    const std::string name = std::to_string(++block);
    text += "*" + gsi_word(fmt::format("11{:04}", block), name, 16) + length("81", p.x()) +
            length("82", p.y()) + length("83", p.z());
    if (codes == "words") text += gsi_word("71....", code, 16);
    if (codes == "empty") text += gsi_word("71....", "", 16);
    text += "\r\n";
    if (codes == "behind") text += code_block;
  }
  return text;
}

std::string rw5(const Points& points, int unit) {
  std::string text =
      fmt::format("JB,NMDRIFT,DT03-31-2026\nMO,AD0,UN{},SF1.0,EC0\n--a note\n", unit);
  int number = 0;
  for (const auto& [p, code] : points) {
    text += fmt::format("SP,PN{},N {:.4f},E {:.4f},EL{:.4f},--{}\n", ++number, p.y(), p.x(), p.z(),
                        code);
  }
  return text;
}

std::string cg_points(const Points& points) {
  std::string text = "<CgPoints>\n";
  int number = 0;
  for (const auto& [p, code] : points) {
    text += fmt::format("<CgPoint name=\"{}\" desc=\"{}\">{:.4f} {:.4f} {:.4f}</CgPoint>\n",
                        ++number, code, p.y(), p.x(), p.z());
  }
  return text + "</CgPoints>\n";
}

std::string landxml(const std::string& content, const std::string& unit) {
  return "<?xml version=\"1.0\"?>\n<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" "
         "version=\"1.2\">\n<Units>" +
         unit + "</Units>\n<CoordinateSystem epsgCode=\"25832\"/>\n" + content + "</LandXML>\n";
}

std::string place(int code, const Eigen::Vector3d& p) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    text += group(code + 10 * axis, fmt::format("{:.4f}", p[axis]));
  }
  return text;
}

// Walls as polylines, floor as lines, roof as points, tags as blocks with attributes.
std::string dxf(const Points& points, int insunits) {
  std::string text = group(0, "SECTION") + group(2, "HEADER") + group(9, "$INSUNITS") +
                     group(70, std::to_string(insunits)) + group(0, "ENDSEC") +
                     group(0, "SECTION") + group(2, "ENTITIES") + group(0, "CIRCLE") +
                     group(8, "WL") + place(10, {0, 0, 0}) + group(0, "POINT") + group(8, "TITLE") +
                     place(10, {0, 0, 0});
  std::string open;
  for (const auto& [p, full_code] : points) {
    const std::string layer = full_code.substr(0, 2);
    const bool is_wall = layer[0] == 'W' || layer[0] == 'w';
    if (open != layer && !open.empty()) text += group(0, "SEQEND");
    if (is_wall && open != layer) text += group(0, "POLYLINE") + group(8, layer) + group(66, "1");
    open = is_wall ? layer : "";
    if (is_wall) text += group(0, "VERTEX") + group(8, layer) + place(10, p);
    if (layer == "FL") text += group(0, "LINE") + group(8, layer) + place(10, p) + place(11, p);
    if (layer == "RF") text += group(0, "POINT") + group(8, layer) + place(10, p);
    if (layer[0] == 'T') {
      text += group(0, "INSERT") + group(8, "PLATES") + group(66, "1") + place(10, p) +
              group(0, "ATTRIB") + group(8, "PLATES") + group(1, layer) + group(2, "code") +
              group(0, "SEQEND");
    }
  }
  return text + group(0, "ENDSEC") + group(0, "EOF");
}

}  // namespace

TEST_CASE("points of every format and unit become the tunnel that they were measured in") {
  const Points points = surveyed_drift(0.002).points;
  const std::string metre = "<Metric linearUnit=\"meter\"/>";
  struct Case {
    const char* name;
    std::string text;
    const char* arguments;
  };
  for (const Case& each :
       {Case{"semicolons, decimal commas", table(points, ";", true), "--order PENZD"},
        Case{"tabs", table(points, "\t", false), "--order PENZD"},
        Case{"tabs and commas", table(points, "\t", true), "--order PENZD"},
        Case{"a header", "a;b;c;d;e\n" + table(points, ";", false), "--order PENZD --header"},
        Case{"feet", table(scaled(points, kFoot), ",", false), "--order PENZD --units ft"},
        Case{"US feet", table(scaled(points, kSurveyFoot), ",", false),
             "--order PENZD --units us-ft"},
        Case{"millimetres", table(scaled(points, 0.001), ",", false), "--order PENZD --units mm"},
        Case{"GSI, words 71", gsi(points, '0', 1e3, "words"), ""},
        Case{"GSI, tenths", gsi(points, '6', 1e4, "before"), ""},
        Case{"GSI, empty remarks", gsi(points, '6', 1e4, "empty"), ""},
        Case{"GSI, hundredths", gsi(points, '8', 1e5, "behind"), ""},
        Case{"GSI, feet", gsi(scaled(points, kFoot), '7', 1e4, "words"), "--units ft"},
        Case{"RW5", rw5(points, 1), ""},
        Case{"RW5, US feet", rw5(scaled(points, kSurveyFoot), 2), ""},
        Case{"LandXML", landxml(cg_points(points), metre), ""},
        Case{"LandXML, US feet",
             landxml(cg_points(scaled(points, kSurveyFoot)),
                     "<Imperial linearUnit=\"USSurveyFoot\"/>"),
             ""},
        Case{"DXF", dxf(points, 6), ""},
        Case{"DXF, mm", dxf(scaled(points, 0.001), 4), "--units mm"},
        Case{"DXF that says inches, wrongly", dxf(points, 1), "--units m"},
        Case{"DXF in inches", dxf(scaled(points, 0.0254), 1), ""},
        Case{"DXF in decimetres", dxf(scaled(points, 0.1), 14), ""},
        Case{"DXF with a byte order mark", "\xEF\xBB\xBF" + dxf(points, 6), ""}}) {
    CAPTURE(std::string(each.name));
    const TemporaryFolder folder;
    const ProgramOutput made = draft(folder.path(), each.text, each.arguments);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    CHECK(std::abs(width_at(survey.tunnel, 0) - 4.2) < 0.005);
    CHECK(std::abs(survey.tunnel.height.at(0) - 3.1) < 0.01);
    REQUIRE(survey.tags.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
      const std::size_t listed = points.size() - 6 + i / 2 + (i % 2) * 3;
      CHECK((survey.tags[i].p_in_grid - points[listed].p).norm() < 0.003);
    }
    CHECK(survey.grid.epsg == (std::string(each.name) == "LandXML" ? 25832 : 0));
  }
}

TEST_CASE("a GSI file names a template with letters of two bytes whole") {
  const TemporaryFolder folder;
  const std::string name = "tafel-grün-für-schächte";
  const fs::path file = folder.path() / "survey.yaml";
  std::string text = contents("surveys/corridor/survey.yaml");
  text.replace(text.find("tag-400x300"), 11, name);
  write_text(file, text);
  std::string plate = contents("templates/tag-400x300.yaml");
  plate.replace(plate.find("tag: tag-400x300"), 16, "tag: " + name);
  write_text(folder.path() / (name + ".yaml"), plate);
  const fs::path list = folder.path() / "tags.gsi";
  REQUIRE(run_tagsmith("export " + quoted(file) + " -o " + quoted(list)).exit_code == 0);
  const ProgramOutput made = run_tagsmith("new " + quoted(folder.path() / "out") + " --from " +
                                          quoted(list) + " --mount-height 0.4 --tunnel-height 3");
  CHECK_MESSAGE(made.err.find("no template `" + name + "`") != std::string::npos, made.err);
}

TEST_CASE("what export writes for surveyors, new reads back, with the digits that are printed") {
  struct Case {
    const char* survey;
    const char* format;
    const char* arguments;
  };
  for (const Case& each :
       {Case{"corridor", "csv", "--order own"}, Case{"corridor", "landxml", "--tunnel-height 3"},
        Case{"corridor", "gsi", "--tunnel-height 3 --mount-height 1"},
        Case{"corridor-table4", "csv", "--order own"},
        Case{"corridor-table4", "landxml", "--tunnel-height 3"},
        Case{"corridor-table4", "gsi", "--tunnel-height 3 --mount-height 1"},
        Case{"curved", "csv", "--order own"}, Case{"curved", "landxml", "--tunnel-height 3"},
        Case{"curved", "gsi", "--tunnel-height 3 --mount-height 0.6"},
        Case{"drift", "csv", "--order own"}}) {
    CAPTURE(std::string(each.survey));
    CAPTURE(std::string(each.format));
    const TemporaryFolder folder;
    const fs::path file = folder.path() / ("tags." + std::string(each.format));
    const std::string original = "surveys/" + std::string(each.survey) + "/survey.yaml";
    REQUIRE(run_tagsmith("export " + original + " -o " + quoted(file)).exit_code == 0);
    const ProgramOutput made = run_tagsmith("new " + quoted(folder.path() / "out") + " --from " +
                                            quoted(file) + " " + each.arguments);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    CHECK(made.err.find("[unknown-digits]") == std::string::npos);
    const fs::path draft = folder.path() / "out" / "survey.yaml";
    const Survey before = load_survey(original).value();
    const Survey after = load_survey(draft).value();
    CHECK(after.code.check == before.code.check);
    CHECK(after.code.digit_counts == before.code.digit_counts);
    CHECK(after.code.resolution == before.code.resolution);
    CHECK(after.code.origin == before.code.origin);
    REQUIRE(after.tags.size() == before.tags.size());
    for (std::size_t i = 0; i < after.tags.size(); ++i) {
      CHECK(after.tags[i].name == before.tags[i].name);
      CHECK((after.tags[i].p_in_grid - before.tags[i].p_in_grid).norm() < 1e-4);
    }
    const ProgramOutput differs = run_tagsmith("diff " + original + " " + quoted(draft));
    CHECK_MESSAGE(differs.err.find("0 to print, 0 to reprint,") != std::string::npos, differs.err);
    // Computed places do not tell how well plates were measured.
    if (std::string(each.survey) == "curved") {
      CHECK(read_file(draft).value().find("of a coordinate") == std::string::npos);
    }
  }
}

TEST_CASE("tags that hang, with digits that nobody knows or a code that nobody knows, are told") {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "tags.landxml";
  REQUIRE(run_tagsmith("export surveys/curved/survey.yaml -o " + quoted(file)).exit_code == 0);
  const std::string whole = read_file(file).value();
  const auto without = [&](const std::string& what) {
    return std::regex_replace(whole, std::regex(what), "");
  };
  const std::string arguments = "--tunnel-height 3 --template tag-800x430";
  const std::string feature = "<Feature [^]*</Feature>";
  const ProgramOutput no_code = draft(folder.path(), without(feature), arguments);
  REQUIRE_MESSAGE(no_code.exit_code == 0, no_code.err);
  CHECK(no_code.err.find("not the code that they follow") != std::string::npos);
  const Survey before = load_survey("surveys/curved/survey.yaml").value();
  const Survey after = load_survey(folder.path() / "out" / "survey.yaml").value();
  for (std::size_t i = 0; i < after.tags.size(); ++i) {
    CHECK(after.tags[i].digits == before.tags[i].digits);
  }
  fs::remove_all(folder.path() / "out");
  CHECK(draft(folder.path(), without(feature), arguments + " --split").exit_code == 2);
  const ProgramOutput no_digits =
      draft(folder.path(), without("(" + feature + "| desc=\"[0-9]*\")"), arguments);
  REQUIRE_MESSAGE(no_digits.exit_code == 0, no_digits.err);
  CHECK_MESSAGE(no_digits.err.find("does not say its digits (12 such in all)") != std::string::npos,
                no_digits.err);
  // Options may repeat what the list says of all tags, and not contradict it.
  fs::remove_all(folder.path() / "out");
  for (const char* option : {"--template tag-400x300", "--check-digit sum10", "--x-axis left"}) {
    const ProgramOutput refused =
        draft(folder.path(), whole, "--tunnel-height 3 " + std::string(option));
    CHECK(refused.exit_code == 2);
    CHECK_MESSAGE(refused.err.find("the list says") != std::string::npos, refused.err);
  }
  CHECK(draft(folder.path(), whole, arguments + " --check-digit gs1").exit_code == 0);
}

TEST_CASE("a list of export that a spreadsheet wrote with semicolons and commas reads back") {
  const TemporaryFolder folder;
  const fs::path csv = folder.path() / "tags.csv";
  REQUIRE(run_tagsmith("export surveys/curved/survey.yaml -o " + quoted(csv)).exit_code == 0);
  std::string text = read_file(csv).value();
  for (char& c : text) c = c == ',' ? ';' : c == '.' ? ',' : c;
  const ProgramOutput made = draft(folder.path(), text, "--order own");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Survey before = load_survey("surveys/curved/survey.yaml").value();
  const Survey after = load_survey(folder.path() / "out" / "survey.yaml").value();
  REQUIRE(after.tags.size() == before.tags.size());
  for (std::size_t i = 0; i < after.tags.size(); ++i) {
    CHECK(after.tags[i].digits == before.tags[i].digits);
    CHECK((after.tags[i].p_in_grid - before.tags[i].p_in_grid).norm() < 2e-6);
  }
  fs::remove_all(folder.path() / "out");
  CHECK(draft(folder.path(), text, "--order own --split").exit_code == 2);
  CHECK(draft(folder.path(), text, "--order own --units ft").exit_code == 2);
}

TEST_CASE("an alignment of lines, clothoids and arcs becomes the center line as it is") {
  // 20 m straight, a clothoid of 20 m to a radius of 40 m to the right, 30 m of arc.
  constexpr double kRadius = 40;
  constexpr double kSpiral = 20;
  Eigen::Vector2d p(500, 1000);
  double heading = 0.3;
  double curvature = 0;
  std::vector<Eigen::Vector3d> line;  // x, y, heading every centimetre
  std::vector<double> chainages;
  for (int i = 0; i <= 7000; ++i) {
    const double s = 0.01 * i + 0.005;  // the middle of the step
    line.emplace_back(p.x(), p.y(), heading);
    curvature = s < 20 ? 0 : s < 40 ? (s - 20) / kSpiral / kRadius : 1 / kRadius;
    const double middle = heading + 0.005 * curvature;
    p += 0.01 * Eigen::Vector2d(std::sin(middle), std::cos(middle));
    heading += 0.01 * curvature;
  }
  const auto ne = [](const Eigen::Vector2d& at) {
    return fmt::format("{:.5f} {:.5f}", at.y(), at.x());
  };
  const auto at = [&](int i) -> Eigen::Vector2d {
    return line[static_cast<std::size_t>(i)].head<2>();
  };
  const Eigen::Vector3d end_of_spiral = line[4000];
  const Eigen::Vector2d centre =
      end_of_spiral.head<2>() + kRadius * right_of(end_of_spiral.z()).head<2>();
  const Eigen::Vector2d corner = at(2000) + 13 * direction_of(0.3).head<2>();
  const std::string xml = fmt::format(
      "<Alignments><Alignment name=\"axis\" length=\"70\" staStart=\"0\"><CoordGeom>\n"
      "<Line><Start>{}</Start><End>{}</End></Line>\n"
      "<Spiral length=\"20\" radiusStart=\"INF\" radiusEnd=\"40\" rot=\"cw\" spiType=\"clothoid\">"
      "<Start>{}</Start><PI>{}</PI><End>{}</End></Spiral>\n"
      "<Curve rot=\"cw\" radius=\"40\"><Start>{}</Start><Center>{}</Center><End>{}</End></Curve>\n"
      "</CoordGeom><Profile name=\"p\"><ProfAlign name=\"p\"><PVI>0 10</PVI><PVI>70 11.4</PVI>"
      "</ProfAlign></Profile></Alignment></Alignments>\n",
      ne(at(0)), ne(at(2000)), ne(at(2000)), ne(corner), ne(at(4000)), ne(at(4000)), ne(centre),
      ne(at(7000)));
  Points walls;
  for (int i = 100; i < 7000; i += 300) {
    const Eigen::Vector3d& on = line[static_cast<std::size_t>(i)];
    const double z = 10 + 0.02 * 0.01 * i;
    for (const int side : {-1, 1}) {
      const Eigen::Vector2d wall = on.head<2>() + 2.0 * side * right_of(on.z()).head<2>();
      walls.push_back({{wall.x(), wall.y(), z + 1.5}, side < 0 ? "WL" : "WR"});
    }
  }
  const std::string metre = "<Metric linearUnit=\"meter\"/>";
  const TemporaryFolder folder;
  const std::string arguments = "--height 1.2 --spacing 2 --tunnel-height 3 --json";
  const ProgramOutput made =
      draft(folder.path(), landxml(xml + cg_points(walls), metre), arguments);
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const auto last = made.out.rfind('\n', made.out.size() - 2);
  const auto summary = parsed_json(made.out.substr(last + 1))["summary"];
  CHECK(summary["alignment_off"].get<double>() < 1e-4);
  CHECK(summary["width"].get<double>() == Approx(4).epsilon(2e-5));
  CHECK(summary["length"].get<double>() == Approx(70).epsilon(1e-6));
  const std::string text = *read_file(folder.path() / "out" / "survey.yaml");
  CHECK_MESSAGE(
      text.find("{ clothoid: 20, turn: right, to_radius: 40, grade: ") != std::string::npos, text);
  const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
  for (std::size_t i = 0; i < line.size(); i += 500) {
    const auto address = survey.tunnel.centerline.locate(line[i].head<2>());
    CHECK(std::abs(address.offset) < 1e-4);
    CHECK(address.chainage == Approx(0.01 * static_cast<double>(i)).epsilon(1e-5));
    CHECK(survey.tunnel.centerline.at(address.chainage).position.z() ==
          Approx(10 + 0.02 * 0.01 * static_cast<double>(i)).epsilon(1e-5));
  }

  // What is exported is read as the same line: the clothoid is one spiral.
  const fs::path exported = folder.path() / "again.xml";
  REQUIRE(run_tagsmith("export '" + (folder.path() / "out" / "survey.yaml").string() + "' -o '" +
                       exported.string() + "' --format landxml")
              .exit_code == 0);
  const std::string spirals = *read_file(exported);
  CHECK(spirals.find("<Spiral length=\"20\"") != std::string::npos);
  CHECK(spirals.find("radiusEnd=\"40\" radiusStart=\"INF\" rot=\"cw\"") != std::string::npos);
  fs::remove_all(folder.path() / "out");
  const ProgramOutput again = draft(folder.path(), spirals, "--tunnel-height 3");
  REQUIRE_MESSAGE(again.exit_code == 0, again.err);
  const Centerline same =
      load_survey(folder.path() / "out" / "survey.yaml").value().tunnel.centerline;
  for (double s = 0; s <= 70; s += 3.5) {
    CHECK((same.at(s).position - survey.tunnel.centerline.at(s).position).norm() < 1e-4);
  }

  // The alignment alone: its walls are said to be so far apart.
  fs::remove_all(folder.path() / "out");
  const ProgramOutput alone = draft(folder.path(), landxml(xml, metre), arguments + " --width 4");
  REQUIRE_MESSAGE(alone.exit_code == 0, alone.err);
  const Survey designed = load_survey(folder.path() / "out" / "survey.yaml").value();
  CHECK(designed.tunnel.right.at(30) - designed.tunnel.left.at(30) == Approx(4).epsilon(1e-4));
  for (std::size_t i = 0; i < line.size(); i += 500) {
    CHECK(std::abs(designed.tunnel.centerline.locate(line[i].head<2>()).offset) < 1e-4);
  }
  fs::remove_all(folder.path() / "out");
  const ProgramOutput both =
      draft(folder.path(), landxml(xml + cg_points(walls), metre), arguments + " --width 4");
  CHECK(both.exit_code == 2);
  CHECK(both.err.find("--width is for lists without points of walls") != std::string::npos);

  // A spiral whose end contradicts its length; two alignments.
  std::string broken = xml;
  broken.replace(broken.find("length=\"20\""), 11, "length=\"25\"");
  fs::remove_all(folder.path() / "out");
  const ProgramOutput refused =
      draft(folder.path(), landxml(broken + cg_points(walls), metre), arguments);
  CHECK(refused.exit_code == 2);
  CHECK_MESSAGE(refused.err.find("points.csv:7: error:") != std::string::npos, refused.err);
  CHECK(refused.err.find("[bad-element]") != std::string::npos);
  const std::size_t from = xml.find("<Alignment name");
  const std::string one = xml.substr(from, xml.find("</Alignments>") - from);
  std::string other = one;
  other.replace(other.find("axis"), 4, "old");
  const std::string two = "<Alignments>" + one + other + "</Alignments>" + cg_points(walls);
  CHECK(draft(folder.path(), landxml(two, metre), arguments).err.find("[several-alignments]") !=
        std::string::npos);
  CHECK_FALSE(fs::exists(folder.path() / "out"));
  CHECK(draft(folder.path(), landxml(two, metre), arguments + " --ignore old").exit_code == 0);
}

TEST_CASE("an alignment of many elements keeps each, in feet and in grids with x to the left") {
  std::vector<CenterlineElement> elements;
  for (int i = 0; i < 15; ++i) elements.push_back({12, i % 2 == 0 ? 0 : i % 4 == 1 ? 0.02 : -0.03});
  const Centerline truth({300, 700, 0}, 0.4, elements);
  const auto ne = [](const Eigen::Vector2d& p) {
    return fmt::format("{:.7f} {:.7f}", p.y() / kFoot, p.x() / kFoot);
  };
  std::string geometry;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const CenterlinePoint from = truth.at(12.0 * static_cast<double>(i));
    const Eigen::Vector2d start = from.position.head<2>();
    const Eigen::Vector2d end = truth.at(12.0 * static_cast<double>(i + 1)).position.head<2>();
    const double curvature = elements[i].curvature;
    if (curvature == 0) {
      geometry += "<Line><Start>" + ne(start) + "</Start><End>" + ne(end) + "</End></Line>\n";
      continue;
    }
    const Eigen::Vector2d centre = start + right_of(from.heading).head<2>() / curvature;
    geometry += fmt::format(
        "<Curve rot=\"{}\"><Start>{}</Start><Center>{}</Center><End>{}</End>"
        "</Curve>\n",
        curvature > 0 ? "cw" : "ccw", ne(start), ne(centre), ne(end));
  }
  const auto pvi = [](double chainage, double height) {
    return fmt::format("<PVI>{:.7f} {:.7f}</PVI>", chainage / kFoot, height / kFoot);
  };
  const std::string xml = "<Alignments><Alignment name=\"axis\"><CoordGeom>\n" + geometry +
                          "</CoordGeom><Profile><ProfAlign>" + pvi(0, 5) + pvi(100, 6) +
                          pvi(180, 5.2) + "</ProfAlign></Profile></Alignment></Alignments>\n";
  const std::string feet = "<Imperial linearUnit=\"foot\"/>";
  for (const bool x_left : {false, true}) {
    CAPTURE(x_left);
    const TemporaryFolder folder;
    const ProgramOutput made =
        draft(folder.path(), landxml(xml, feet),
              "--width 3 --height 1.2 --spacing 2 --tunnel-height 3 --x-axis " +
                  std::string(x_left ? "left" : "right"));
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const Survey survey = load_survey(folder.path() / "out" / "survey.yaml").value();
    const Centerline& line = survey.tunnel.centerline;
    CHECK(line.elements().size() == 16);  // one is cut where the grade changes
    CHECK(line.length() == Approx(180).epsilon(1e-7));
    for (double s = 0; s <= 180; s += 7.5) {
      Eigen::Vector3d expected = truth.at(s).position;
      if (x_left) expected.x() *= -1;
      expected.z() = s < 100 ? 5 + 0.01 * s : 6 - 0.01 * (s - 100);
      CHECK((line.at(s).position - expected).norm() < 1e-4);
    }
  }
}

TEST_CASE("broken files and doubtful units are refused with their line and a remedy") {
  const Points points = surveyed_drift(0.002).points;
  const std::string metre = "<Metric linearUnit=\"meter\"/>";
  const std::string good_gsi = gsi(points, '0', 1e3, "words");
  const std::string two_units =
      std::regex_replace(gsi(points, '7', 1e4, "words"), std::regex("83\\.\\.07"), "83..06");
  struct Case {
    const char* name;
    std::string text;
    const char* arguments;
    const char* told;
  };
  for (const Case& each :
       {Case{"feet taken for metres", table(scaled(points, kFoot), ",", false), "--order PENZD",
             "--units"},
        Case{"millimetres taken for metres", table(scaled(points, 0.001), ";", true),
             "--order PENZD", "--units"},
        Case{"a drawing in mm", dxf(scaled(points, 0.001), 6), "", "--units"},
        Case{"GSI in some feet", gsi(scaled(points, kFoot), '1', 1e3, "words"), "",
             "--units us-ft"},
        Case{"RW5 in some feet", rw5(scaled(points, kFoot), 0), "", "--units us-ft"},
        Case{"another unit than the file's", rw5(points, 1), "--units ft", "leave --units out"},
        Case{"a drawing in a unit of its own", dxf(points, 77), "", "$INSUNITS 77"},
        Case{"a drawing in inches that is in metres", dxf(points, 1), "", "a unit of 0.0254 m"},
        Case{"LandXML in a unit of its own",
             landxml(cg_points(points), "<Imperial linearUnit=\"internationalFoot\"/>"), "",
             "`internationalFoot`"},
        Case{"GSI in two units", two_units, "", "point 2 are in feet and in metres"},
        Case{"RW5 in two units", rw5(points, 1) + "MO,AD0,UN2,SF1.0,EC0\n", "",
             "says UN2, one before it UN1"},
        Case{"blanks for separators", "1 2 3 4 WL\n2 3 4 5 WR\n", "--order PENZD",
             "points.csv:1: error:"},
        Case{"a table without an order", table(points, ",", false), "", "--order"},
        Case{"an order for GSI", good_gsi, "--order PENZD", "--order"},
        Case{"half a GSI word", good_gsi.substr(0, good_gsi.size() - 20), "", "[bad-gsi]"},
        Case{"GSI without height", "*" + gsi_word("110001", "7", 16) + gsi_word("81..00", "1", 16),
             "", "points.csv:1: error:"},
        Case{"RW5 without height", "JB,NMX\nSP,PN1,N 1,E 2,--WL\n", "", "points.csv:2: error:"},
        Case{"LandXML cut off", landxml(cg_points(points), metre).substr(0, 900), "", "[syntax]"},
        Case{"LandXML without height",
             landxml("<CgPoints>\n<CgPoint name=\"7\" code=\"WL\">1 2</CgPoint></CgPoints>", metre),
             "", "points.csv:6: error:"},
        Case{"other XML", "<?xml version=\"1.0\"?><kml></kml>", "", "LandXML"},
        Case{"DXF with a word for a code", dxf(points, 6).substr(0, 900) + "\nword\n", "",
             "[bad-dxf]"},
        Case{"a binary drawing", "AC1027 and so on", "", "DXF"},
        Case{"UTF-16",
             std::string("\xFF\xFE"
                         "1\0,\0",
                         6),
             "--order PENZD", "UTF-8"}}) {
    CAPTURE(std::string(each.name));
    const TemporaryFolder folder;
    const ProgramOutput refused = draft(folder.path(), each.text, each.arguments);
    CHECK(refused.exit_code == 2);
    CHECK_MESSAGE(refused.err.find(each.told) != std::string::npos, refused.err);
    CHECK(split(refused.err, '\n').size() < 20);
    CHECK_FALSE(fs::exists(folder.path() / "out"));
  }
  // A tunnel that is 13 m wide is one, once the unit is said.
  PointWriter wide(0.002, 1);
  for (int i = 0; i < 24; ++i) wide.add(1 + 3 * i, -6.5, 1.3, "WL");
  for (int i = 0; i < 24; ++i) wide.add(1 + 3 * i, 6.5, 1.3, "WR");
  for (int i = 0; i < 12; ++i) wide.add(2 + 6 * i, 0.3, 0, "FL");
  const std::string arguments = "--order PENZD --tunnel-height 6 --height 1.5 --spacing 4";
  const TemporaryFolder folder;
  CHECK(draft(folder.path(), wide.text("PENZD"), arguments).exit_code == 2);
  CHECK(draft(folder.path(), wide.text("PENZD"), arguments + " --units m").exit_code == 0);
}
