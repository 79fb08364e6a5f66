// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/tag_list.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <sqlite3.h>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

// ---- Maps as GeoPackage, the SQLite file that GIS programs share (OGC 12-128r17).

namespace {

struct GeoColumn {
  std::string name;
  std::string type;  // TEXT, DOUBLE, BOOLEAN or DATE
};

// Features as GeoJSON has them, with three coordinates for each point.
struct GeoLayer {
  std::string name;
  std::string geometry;  // POINT or LINESTRING
  std::vector<GeoColumn> columns;
  const Json* features = nullptr;  // a list, which must outlive the layer
};

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

// Requirements 2 (application_id "GPKG", version 1.3.0), 10, 11, 13 and 21 of the standard.
constexpr const char* kTables = R"sql(
PRAGMA application_id = 0x47504B47;
PRAGMA user_version = 10300;
BEGIN;
CREATE TABLE gpkg_spatial_ref_sys (
  srs_name TEXT NOT NULL,
  srs_id INTEGER PRIMARY KEY,
  organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL,
  definition TEXT NOT NULL,
  description TEXT
);
CREATE TABLE gpkg_contents (
  table_name TEXT NOT NULL PRIMARY KEY,
  data_type TEXT NOT NULL,
  identifier TEXT UNIQUE,
  description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE,
  min_y DOUBLE,
  max_x DOUBLE,
  max_y DOUBLE,
  srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id)
);
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL,
  column_name TEXT NOT NULL,
  geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL,
  z TINYINT NOT NULL,
  m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id)
);
INSERT INTO gpkg_spatial_ref_sys VALUES
  ('Undefined Cartesian SRS', -1, 'NONE', -1, 'undefined', NULL),
  ('Undefined geographic SRS', 0, 'NONE', 0, 'undefined', NULL),
  ('WGS 84', 4326, 'EPSG', 4326, 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]', NULL);
)sql";

class Bytes {
 public:
  template <class Value>
  void put(Value value) {
    auto raw = std::bit_cast<std::array<char, sizeof(Value)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
    bytes_.append(raw.data(), raw.size());
  }
  const std::string& text() const { return bytes_; }

 private:
  std::string bytes_;
};

// Of a line all, of a point itself.
Json points_of(const Json& geometry) {
  const Json& coordinates = geometry["coordinates"];
  return geometry["type"] == "Point" ? Json::array({coordinates}) : coordinates;
}

// GeoPackageBinary without an envelope, then the geometry as little-endian ISO WKB with Z.
std::string blob_of(const Json& geometry, std::int32_t srs) {
  constexpr std::uint32_t kPointZ = 1001;
  constexpr std::uint32_t kLineStringZ = 1002;
  Bytes bytes;
  for (const char c : {'G', 'P', '\0', '\1'}) bytes.put(c);
  bytes.put(srs);
  bytes.put('\1');
  const Json points = points_of(geometry);
  const bool is_point = geometry["type"] == "Point";
  bytes.put(is_point ? kPointZ : kLineStringZ);
  if (!is_point) bytes.put(static_cast<std::uint32_t>(points.size()));
  for (const Json& point : points) {
    for (const Json& coordinate : point) bytes.put(coordinate.get<double>());
  }
  return bytes.text();
}

// Least x and y of a layer's features, then the greatest; of a layer without features unknown.
std::string extent_sql(const GeoLayer& layer) {
  Eigen::AlignedBox2d extent;
  for (const Json& feature : *layer.features) {
    for (const Json& point : points_of(feature["geometry"])) {
      extent.extend(Eigen::Vector2d(point[0].get<double>(), point[1].get<double>()));
    }
  }
  if (extent.isEmpty()) return "NULL, NULL, NULL, NULL";
  return fmt::format("{}, {}, {}, {}", extent.min().x(), extent.min().y(), extent.max().x(),
                     extent.max().y());
}

// The layer's table, and its entries in the standard's tables.
std::string layer_sql(const GeoLayer& layer, int srs, const std::string& changed) {
  std::string columns;
  for (const GeoColumn& column : layer.columns) {
    columns += fmt::format(", \"{}\" {}", column.name, column.type);
  }
  return fmt::format(
      "CREATE TABLE \"{0}\" (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {1}{2});"
      "INSERT INTO gpkg_contents VALUES ({3}, 'features', {3}, '', '{4}T00:00:00.000Z',"
      " {5}, {6});"
      "INSERT INTO gpkg_geometry_columns VALUES ({3}, 'geom', '{1}', {6}, 1, 0);",
      layer.name, layer.geometry, columns, single_quoted(layer.name),
      changed.empty() ? "1970-01-01" : changed, extent_sql(layer), srs);
}

void put_value(sqlite3_stmt* statement, int place, const Json& value) {
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()),
                      SQLITE_TRANSIENT);
  } else if (value.is_boolean()) {
    sqlite3_bind_int(statement, place, value.get<bool>() ? 1 : 0);
  } else if (value.is_number()) {
    sqlite3_bind_double(statement, place, value.get<double>());
  } else {
    sqlite3_bind_null(statement, place);
  }
}

bool insert_features(sqlite3* database, const GeoLayer& layer, int srs) {
  std::string sql = "INSERT INTO \"" + layer.name + "\" VALUES (NULL, ?";
  for (std::size_t i = 0; i < layer.columns.size(); ++i) sql += ", ?";
  sqlite3_stmt* prepared = nullptr;
  sqlite3_prepare_v2(database, (sql + ")").c_str(), -1, &prepared, nullptr);
  const Statement statement(prepared, sqlite3_finalize);
  if (!statement) return false;
  for (const Json& feature : *layer.features) {
    const std::string blob = blob_of(feature["geometry"], srs);
    sqlite3_bind_blob(prepared, 1, blob.data(), static_cast<int>(blob.size()), SQLITE_TRANSIENT);
    int place = 1;
    for (const GeoColumn& column : layer.columns) {
      put_value(prepared, ++place, feature["properties"].value(column.name, Json()));
    }
    if (sqlite3_step(prepared) != SQLITE_DONE) return false;
    sqlite3_reset(prepared);
  }
  return true;
}

// The file's bytes. `epsg` 0: the layers are in an undefined Cartesian system. `changed` (a day, as
// 2026-03-31; empty = unknown, written as 1970-01-01) is the last change of the content, so that
// one survey always gives one file. Fails when SQLite does because memory runs out.
Result<std::string> geopackage(const std::vector<GeoLayer>& layers, int epsg,
                               const std::string& changed) {
  sqlite3* opened = nullptr;
  sqlite3_open(":memory:", &opened);
  const Database database(opened, sqlite3_close);
  const int srs = epsg == 0 ? -1 : epsg;
  std::string sql = kTables;
  if (epsg != 0) {
    sql += fmt::format(
        "INSERT INTO gpkg_spatial_ref_sys VALUES ('EPSG:{0}', {0}, 'EPSG', {0}, 'undefined', "
        "NULL);",
        epsg);
  }
  for (const GeoLayer& layer : layers) sql += layer_sql(layer, srs, changed);
  bool done = sqlite3_exec(opened, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
  for (const GeoLayer& layer : layers) done = done && insert_features(opened, layer, srs);
  done = done && sqlite3_exec(opened, "COMMIT", nullptr, nullptr, nullptr) == SQLITE_OK;
  sqlite3_int64 size = 0;
  const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> bytes(
      done ? sqlite3_serialize(opened, "main", &size, 0) : nullptr, sqlite3_free);
  if (!bytes) return fail(std::string("no GeoPackage can be made: ") + sqlite3_errmsg(opened));
  return std::string(reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size));
}

// ---- The list in its formats.

// Micrometres are finer than anything surveyed; more digits would be rounding noise.
double micrometre(double metres) { return with_decimals(metres, 6) + 0.0; }

Json point_json(const Eigen::Vector3d& p) {
  return {micrometre(p.x()), micrometre(p.y()), micrometre(p.z())};
}

// Of the way the plate faces, degrees in the grid, 0 to 360.
double facing_heading(const Survey& survey, const PlacedTag& tag) {
  const double heading = grid_heading_from_world(survey.grid, facing_of(tag.world_from_plate));
  const double turned = std::fmod(degrees(heading) + 360.0, 360.0);
  return with_decimals(turned, 6);
}

Json tag_json(const Survey& survey, const PlacedTag& tag) {
  Json json{{"tag", tag.name},
            {"side", to_string(tag.side)},
            {"digits", to_string(tag.digits)},
            {"position", point_json(tag.p_in_grid)},
            {"coded_position", point_json(tag.coded_in_grid)},
            {"chainage", micrometre(tag.chainage)},
            {"offset", micrometre(offset_of_p(survey, tag))},
            {"height", micrometre(height_of_p(survey, tag))},
            {"facing_deg", facing_heading(survey, tag)},
            {"tilt_deg", degrees(tag.attitude ? tag.attitude->tilt : 0)},
            {"roll_deg", degrees(tag.attitude ? tag.attitude->roll : 0)},
            {"as_built", tag.surveyed},
            {"sigma", micrometre(tag.sigma)}};
  json["date"] = tag.date.empty() ? Json(nullptr) : Json(tag.date);
  json["design"] = tag.design_in_grid ? point_json(*tag.design_in_grid) : Json(nullptr);
  return json;
}

Json element_json(const CenterlineElement& element) {
  Json json;
  if (element.curvature == 0) {
    json["line"] = micrometre(element.length);
  } else {
    json["arc"] = micrometre(1 / std::abs(element.curvature));
    json["turn"] = element.curvature > 0 ? "right" : "left";
    json["angle"] = degrees(element.length * std::abs(element.curvature));
  }
  if (element.grade != 0) json["grade"] = 100 * element.grade;
  return json;
}

// As the survey's key `walls` has them: chainage, distance from the center line.
Json stations_json(const ChainageProfile& offset) {
  return json_list(offset.stations(), [](const ProfileStation& station) -> Json {
    return {micrometre(station.chainage), micrometre(std::abs(station.value))};
  });
}

// The center line as straight pieces that are off it by at most a millimetre.
Json line_json(const Survey& survey) {
  constexpr double kSag = 0.001;
  const Centerline& line = survey.tunnel.centerline;
  return json_list(side_points(line, 0.0, 0, line.length(), kSag), [&](const SidePoint& point) {
    return point_json(grid_from_world(survey.grid, point.position));
  });
}

Json feature_json(const char* type, Json coordinates, Json properties) {
  return {{"type", "Feature"},
          {"geometry", {{"type", type}, {"coordinates", std::move(coordinates)}}},
          {"properties", std::move(properties)}};
}

Json tag_feature(const Survey& survey, const PlacedTag& tag) {
  Json properties = tag_json(survey, tag);
  for (const char* point : {"position", "coded_position", "design"}) properties.erase(point);
  return feature_json("Point", point_json(tag.p_in_grid), std::move(properties));
}

Json line_feature(const Survey& survey) {
  return feature_json("LineString", line_json(survey),
                      {{"survey", survey.name},
                       {"revision", survey_revision(survey)},
                       {"length", micrometre(survey.tunnel.centerline.length())}});
}

std::string x_axis(const Survey& survey) { return survey.grid.x_axis_left ? "left" : "right"; }

Json grid_json(const Survey& survey) {
  Json grid{{"x_axis", x_axis(survey)}};
  if (survey.grid.epsg != 0) grid["crs"] = "EPSG:" + std::to_string(survey.grid.epsg);
  return grid;
}

Json tunnel_json(const Survey& survey) {
  const CenterlinePoint start = survey.tunnel.centerline.at(0);
  const Tunnel& tunnel = survey.tunnel;
  Json json{{"width", micrometre(width_at(tunnel, 0))},
            {"height", micrometre(tunnel.height.at(0))},
            {"centerline",
             {{"start", point_json(grid_from_world(survey.grid, start.position))},
              {"heading", degrees(grid_heading_from_world(survey.grid, start.heading))},
              {"elements", json_list(survey.tunnel.centerline.elements(), element_json)}}}};
  if (!is_plain(tunnel) || tunnel.left.at(0) != -tunnel.right.at(0) || tunnel.stand_off != 0) {
    json["stand_off"] = micrometre(tunnel.stand_off);
    json["walls"] = {{"left", stations_json(rock_of(tunnel, Side::left))},
                     {"right", stations_json(rock_of(tunnel, Side::right))}};
    json["sections"] =
        json_list(tunnel.height.stations(), [](const ProfileStation& station) -> Json {
          return {{"at", micrometre(station.chainage)}, {"height", micrometre(station.value)}};
        });
  }
  return json;
}

Json assumed_json(const Survey& survey) {
  const auto assumed = assumed_sigma(survey);
  return assumed ? Json{*assumed} : Json::array();
}

std::string dump(const Json& json) { return json_text(json, 2) + "\n"; }

}  // namespace

std::string tags_csv(const Survey& survey) {
  const PositionCode& code = survey.code;
  std::string csv = csv_row(own_columns());
  for (const PlacedTag& tag : survey.tags) {
    std::vector<std::string> row{tag.name, to_string(tag.side), to_string(tag.digits)};
    const auto add = [&row](const auto& numbers) {
      for (const double number : numbers) row.push_back(format_number(number));
    };
    add(tag.p_in_grid);
    add(std::array{tag.chainage, offset_of_p(survey, tag), height_of_p(survey, tag)});
    row.push_back(states_sigma_of(survey, tag) ? format_number(tag.sigma) : "");
    row.push_back(tag.date);
    if (tag.design_in_grid) {
      add(*tag.design_in_grid);
    } else {
      row.insert(row.end(), 3, "");
    }
    row.insert(row.end(), {survey.tag_template.name, to_string(code.check)});
    add(code.digit_counts);
    add(code.resolution);
    add(code.origin);
    row.push_back(x_axis(survey));
    add(std::array{survey.tunnel.height.at(tag.chainage), facing_heading(survey, tag),
                   degrees(tag.attitude ? tag.attitude->tilt : 0),
                   degrees(tag.attitude ? tag.attitude->roll : 0)});
    add(listed_plate(survey.tag_template));
    row.push_back(survey.states_angle_sigma ? format_number(degrees(survey.angle_sigma)) : "");
    row.push_back(tag.control ? "yes" : "");
    csv += csv_row(row);
  }
  return csv;
}

std::string tags_json(const Survey& survey) {
  const TagTemplate& plate = survey.tag_template;
  const auto one_tag = [&](const PlacedTag& tag) { return tag_json(survey, tag); };
  const PositionCode& code = survey.code;
  return dump({{"survey", survey.name},
               {"revision", survey_revision(survey)},
               {"assumed", assumed_json(survey)},
               {"grid", grid_json(survey)},
               {"template",
                {{"name", plate.name},
                 {"plate", {plate.plate_length, plate.plate_height}},
                 {"feature_frame_inner", {plate.frame_inner_length, plate.frame_inner_height}}}},
               {"tunnel", tunnel_json(survey)},
               {"code",
                {{"check_digit", to_string(code.check)},
                 {"digits", code.digit_counts},
                 {"resolution", code.resolution},
                 {"origin", code.origin}}},
               {"tags", json_list(survey.tags, one_tag)}});
}

std::string tags_geojson(const Survey& survey) {
  const std::string urn = "urn:ogc:def:crs:EPSG::" + std::to_string(survey.grid.epsg);
  const Json crs{{"type", "name"}, {"properties", {{"name", urn}}}};
  Json features = Json::array();
  for (const PlacedTag& tag : survey.tags) features.push_back(tag_feature(survey, tag));
  features.push_back(line_feature(survey));
  return dump({{"type", "FeatureCollection"},
               {"name", survey.name},
               {"crs", survey.grid.epsg == 0 ? Json(nullptr) : crs},
               {"features", std::move(features)}});
}

Result<std::string> tags_geopackage(const Survey& survey) {
  Json features = Json::array();
  GeoLayer tags{"tags", "POINT", {}, &features};
  tags.columns = {{"tag", "TEXT"},          {"side", "TEXT"},       {"digits", "TEXT"},
                  {"chainage", "DOUBLE"},   {"offset", "DOUBLE"},   {"height", "DOUBLE"},
                  {"facing_deg", "DOUBLE"}, {"tilt_deg", "DOUBLE"}, {"roll_deg", "DOUBLE"},
                  {"as_built", "BOOLEAN"},  {"sigma", "DOUBLE"},    {"date", "DATE"}};
  std::string newest;
  for (const PlacedTag& tag : survey.tags) {
    features.push_back(tag_feature(survey, tag));
    newest = std::max(newest, tag.date);
  }
  const Json lines = Json::array({line_feature(survey)});
  const GeoLayer line{"centerline",
                      "LINESTRING",
                      {{"survey", "TEXT"}, {"revision", "TEXT"}, {"length", "DOUBLE"}},
                      &lines};
  return geopackage({tags, line}, survey.grid.epsg, newest);
}

std::string field_layout_json(const Survey& survey) {
  Json tags = Json::array();
  Eigen::AlignedBox2d box;
  for (const PlacedTag& tag : survey.tags) {
    const Pose& pose = tag.world_from_plate;
    const TagTemplate& plate = survey.tag_template;
    const Eigen::Vector3d middle =
        pose * Eigen::Vector3d(plate.frame_inner_length / 2, plate.frame_inner_height / 2, 0);
    Eigen::Matrix3d world_from_tag;
    world_from_tag << -pose.rotation.col(2), pose.rotation.col(0), -pose.rotation.col(1);
    const Eigen::Quaterniond turn(world_from_tag);
    box.extend(Eigen::Vector2d(middle.head<2>()));
    tags.push_back(
        {{"ID", 2 * tag.pair + (tag.side == Side::right ? 1 : 0)},
         {"pose",
          {{"translation",
            {{"x", micrometre(middle.x())},
             {"y", micrometre(middle.y())},
             {"z", micrometre(middle.z())}}},
           {"rotation",
            {{"quaternion",
              {{"W", turn.w()}, {"X", turn.x()}, {"Y", turn.y()}, {"Z", turn.z()}}}}}}}});
  }
  const Eigen::Vector2d size = box.isEmpty() ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(box.sizes());
  return dump({{"tags", tags},
               {"field", {{"length", micrometre(size.x())}, {"width", micrometre(size.y())}}}});
}

}  // namespace tagsmith::detail
