// SPDX-License-Identifier: Apache-2.0
// Surveys as maps and for surveyors' offices: GeoJSON, GeoPackage, LandXML, GSI.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <pugixml.hpp>
#include <sqlite3.h>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

const char* kMapped = R"(survey: mapped
grid: { crs: EPSG:25832 }
tunnel:
  width: 4.2
  height: 3.4
  centerline:
    start: [452310.0, 5411220.0, 312.0]
    heading: 35
    elements:
      - { line: 20.0, grade: 1.5 }
      - { arc: 60.0, turn: left, angle: 30 }
      - { arc: 40.0, turn: right, angle: 30, grade: -1 }
tags: { template: tag-800x430, height: 1.5, spacing: 9.2, first: 5, to: 60, sigma: 0.003 }
code: { check_digit: gs1, resolution: [0.01, 0.01, 0.01], digits: [4, 4, 3], origin: [452300, 5411215, 311] }
placed:
  - { tag: 001R, side: right, p: [452320.71, 5411231.63, 313.74], sigma: 0.001, date: 2026-03-31 }
)";

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

// The survey, exported to a file of this name.
struct Exported {
  TemporaryFolder folder;
  Survey survey;
  fs::path file;
};

std::unique_ptr<Exported> exported(const std::string& text, const std::string& name) {
  auto result = std::make_unique<Exported>();
  const fs::path survey = result->folder.path() / "survey.yaml";
  result->file = result->folder.path() / name;
  REQUIRE(write_file(survey, text));
  const ProgramOutput made =
      run_tagsmith("export " + quoted(survey) + " -o " + quoted(result->file));
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  result->survey = load_survey(survey).value();
  return result;
}

std::string without_crs() {
  std::string text = kMapped;
  const std::string key = "grid: { crs: EPSG:25832 }\n";
  text.erase(text.find(key), key.size());
  return text;
}

using Row = std::vector<std::string>;

// The rows of a query; blobs as their bytes.
std::vector<Row> rows_of(const fs::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
  sqlite3_stmt* statement = nullptr;
  REQUIRE_MESSAGE(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK,
                  sqlite3_errmsg(database));
  std::vector<Row> rows;
  while (sqlite3_step(statement) == SQLITE_ROW) {
    Row row;
    for (int i = 0; i < sqlite3_column_count(statement); ++i) {
      const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement, i));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, i));
      row.emplace_back(bytes == nullptr ? "" : std::string(bytes, size));
    }
    rows.push_back(row);
  }
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return rows;
}

template <class Value>
Value value_at(const std::string& bytes, std::size_t at) {
  Value value{};
  REQUIRE(at + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("grid.crs is a grid in metres, to the east and north") {
  struct Case {
    const char* grid;
    bool good;
  };
  for (const auto& [grid, good] :
       {Case{"{ crs: EPSG:25832 }", true}, Case{"{ crs: EPSG:2056, x_axis: right }", true},
        Case{"{ crs: EPSG:4326 }", false}, Case{"{ crs: EPSG:4283 }", false},
        Case{"{ crs: EPSG:4490 }", false}, Case{"{ crs: EPSG:7844 }", false},
        Case{"{ crs: EPSG:2225 }", false}, Case{"{ crs: EPSG:26941 }", true},
        Case{"{ crs: UTM32 }", false}, Case{"{ crs: \"EPSG:12x\" }", false},
        Case{"{ crs: EPSG:25832, x_axis: left }", false}}) {
    CAPTURE(std::string(grid));
    const Diagnosed<Survey> reading =
        read_survey_text("survey.yaml", "grid: " + std::string(grid) + "\n" + without_crs());
    CHECK(reading.value.has_value() == good);
    const bool named = std::ranges::any_of(
        reading.diagnostics, [](const Diagnostic& finding) { return finding.code == "bad-crs"; });
    CHECK(named == !good);
  }
}

TEST_CASE("GeoJSON has every tag where it is surveyed, and the grid's name") {
  const auto made = exported(kMapped, "tags.geojson");
  const auto json = parsed_json(read_file(made->file).value());
  CHECK(json["type"] == "FeatureCollection");
  CHECK(json["crs"]["properties"]["name"] == "urn:ogc:def:crs:EPSG::25832");
  REQUIRE(json["features"].size() == made->survey.tags.size() + 1);
  for (std::size_t i = 0; i < made->survey.tags.size(); ++i) {
    const auto& feature = json["features"][i];
    CHECK(feature["geometry"]["type"] == "Point");
    CHECK(feature["properties"]["tag"] == made->survey.tags[i].name);
    CHECK(feature["properties"]["digits"] == to_string(made->survey.tags[i].digits));
    for (int axis = 0; axis < 3; ++axis) {
      const double value = feature["geometry"]["coordinates"][static_cast<std::size_t>(axis)];
      CHECK(std::abs(value - made->survey.tags[i].p_in_grid[axis]) < 1e-6);
    }
  }
  const auto& line = json["features"].back();
  CHECK(line["geometry"]["type"] == "LineString");
  CHECK(line["geometry"]["coordinates"].size() > 10);
  CHECK(
      parsed_json(read_file(exported(without_crs(), "a.geojson")->file).value())["crs"].is_null());
}

TEST_CASE("a GeoPackage has what the standard requires, with points in space") {
  for (const bool named : {true, false}) {
    CAPTURE(named);
    const auto made = exported(named ? kMapped : without_crs(), "tags.gpkg");
    const fs::path& file = made->file;
    const std::string srs = named ? "25832" : "-1";
    CHECK(rows_of(file, "PRAGMA application_id")[0][0] == std::to_string(0x47504B47));
    CHECK(rows_of(file, "PRAGMA integrity_check")[0][0] == "ok");
    CHECK(rows_of(file, "PRAGMA foreign_key_check").empty());
    CHECK(std::stoi(rows_of(file, "PRAGMA user_version")[0][0]) >= 10200);
    CHECK(rows_of(file, "SELECT srs_id FROM gpkg_spatial_ref_sys WHERE srs_id IN (-1, 0, 4326)")
              .size() == 3);
    CHECK(
        rows_of(file, "SELECT organization_coordsys_id FROM gpkg_spatial_ref_sys WHERE srs_id = " +
                          srs)[0][0] == srs);
    CHECK(rows_of(file,
                  "SELECT table_name, geometry_type_name, srs_id, z, m "
                  "FROM gpkg_geometry_columns ORDER BY 1") ==
          std::vector<Row>{{"centerline", "LINESTRING", srs, "1", "0"},
                           {"tags", "POINT", srs, "1", "0"}});
    CHECK(
        rows_of(file, "SELECT table_name, data_type, last_change FROM gpkg_contents ORDER BY 1") ==
        std::vector<Row>{{"centerline", "features", "2026-03-31T00:00:00.000Z"},
                         {"tags", "features", "2026-03-31T00:00:00.000Z"}});
    const auto tags = rows_of(file, "SELECT tag, digits, geom, as_built, sigma FROM tags");
    REQUIRE(tags.size() == made->survey.tags.size());
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const PlacedTag& tag = made->survey.tags[i];
      CHECK(tags[i][0] == tag.name);
      CHECK(tags[i][1] == to_string(tag.digits));
      CHECK(tags[i][3] == (tag.surveyed ? "1" : "0"));
      CHECK(std::stod(tags[i][4]) == Approx(tag.sigma));
      const std::string& blob = tags[i][2];
      REQUIRE(blob.size() == 8 + 1 + 4 + 24);
      CHECK(blob.substr(0, 4) == std::string("GP\0\1", 4));
      CHECK(value_at<std::int32_t>(blob, 4) == std::stoi(srs));
      CHECK(value_at<std::uint32_t>(blob, 9) == 1001);  // ISO WKB: Point Z
      for (int axis = 0; axis < 3; ++axis) {
        const auto value = value_at<double>(blob, 13 + 8 * static_cast<std::size_t>(axis));
        CHECK(std::abs(value - tag.p_in_grid[axis]) < 1e-6);
      }
    }
    const auto line = rows_of(file, "SELECT geom FROM centerline");
    CHECK(value_at<std::uint32_t>(line[0][0], 9) == 1002);
  }
  // One survey gives one file.
  CHECK(read_file(exported(kMapped, "a.gpkg")->file).value() ==
        read_file(exported(kMapped, "b.gpkg")->file).value());
}

TEST_CASE("a survey that has no tags yet makes a GeoPackage, too") {
  const std::string series = ", height: 1.5, spacing: 9.2, first: 5, to: 60";
  std::string text = kMapped;
  text.erase(text.find(series), series.size());
  text.erase(text.find("  - { tag:"));
  text.insert(text.size() - 1, " []");
  const auto made = exported(text, "tags.gpkg");
  CHECK(made->survey.tags.empty());
  CHECK(rows_of(made->file, "SELECT fid FROM tags").empty());
  CHECK(rows_of(made->file, "SELECT min_x IS NULL FROM gpkg_contents ORDER BY table_name") ==
        std::vector<Row>{{"0"}, {"1"}});
}

TEST_CASE("LandXML has the center line's elements end to end, its heights, and north before east") {
  const auto made = exported(kMapped, "tags.landxml");
  pugi::xml_document document;
  REQUIRE(document.load_file(made->file.c_str()));
  const pugi::xml_node root = document.child("LandXML");
  CHECK(std::string(root.attribute("version").value()) == "1.2");
  CHECK(std::string(root.child("Units").child("Metric").attribute("linearUnit").value()) ==
        "meter");
  CHECK(root.child("CoordinateSystem").attribute("epsgCode").as_int() == 25832);
  const auto numbers = [](const pugi::xml_node& node) {
    std::vector<double> values;
    for (const std::string& word : split(node.text().get(), ' ')) {
      values.push_back(parse_number(word).value());
    }
    return values;
  };
  const pugi::xml_node geometry = root.child("Alignments").child("Alignment").child("CoordGeom");
  std::vector<double> end{5411220, 452310};
  std::vector<std::string> kinds;
  for (const pugi::xml_node& element : geometry.children()) {
    kinds.emplace_back(element.name() + std::string(element.attribute("rot").value()));
    const auto start = numbers(element.child("Start"));
    CHECK(std::hypot(start[0] - end[0], start[1] - end[1]) < 2e-6);
    end = numbers(element.child("End"));
    if (element.name() != std::string("Curve")) continue;
    const auto centre = numbers(element.child("Center"));
    const double radius = element.attribute("radius").as_double();
    for (const auto& at : {start, end}) {
      CHECK(std::hypot(at[0] - centre[0], at[1] - centre[1]) == Approx(radius).epsilon(1e-6));
    }
  }
  CHECK(kinds == std::vector<std::string>{"Line", "Curveccw", "Curvecw"});
  const pugi::xml_node first = root.child("CgPoints").child("CgPoint");
  CHECK(std::string(first.attribute("code").value()) == "000L");
  const auto p = numbers(first);
  CHECK(p[0] == Approx(made->survey.tags[0].p_in_grid.y()).epsilon(1e-12));
  CHECK(p[1] == Approx(made->survey.tags[0].p_in_grid.x()).epsilon(1e-12));
}

TEST_CASE("GSI-16 has words of sixteen characters, tenths of millimetres") {
  const auto made = exported(kMapped, "tags.gsi");
  std::vector<std::string> lines = split(read_file(made->file).value(), '\n');
  // First the template, the code and the grid, in blocks of codes.
  const auto codes =
      std::erase_if(lines, [](const std::string& line) { return line.starts_with("*41"); });
  CHECK(codes == 16);
  REQUIRE(lines.size() == made->survey.tags.size() + 1);
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const PlacedTag& tag = made->survey.tags[i];
    REQUIRE(lines[i].size() == 1 + 6 * 24 + 1);
    CHECK(lines[i].front() == '*');
    std::map<std::string, std::string> words;
    for (std::size_t at = 1; at + 24 < lines[i].size(); at += 24) {
      words[lines[i].substr(at, 2)] = lines[i].substr(at + 6, 17);
    }
    CHECK(words["71"].ends_with(tag.name));
    CHECK(words["72"].ends_with(to_string(tag.digits)));
    CHECK(std::abs(std::stod(words["81"]) / 1e4 - tag.p_in_grid.x()) < 6e-5);
    CHECK(std::abs(std::stod(words["82"]) / 1e4 - tag.p_in_grid.y()) < 6e-5);
    CHECK(std::abs(std::stod(words["83"]) / 1e4 - tag.p_in_grid.z()) < 6e-5);
  }
}
