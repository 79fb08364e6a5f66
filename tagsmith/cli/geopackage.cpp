// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/geopackage.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <sqlite3.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

using Json = nlohmann::ordered_json;
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

// GeoPackageBinary without an envelope, then the geometry as little-endian ISO WKB with Z.
std::string blob_of(const Json& geometry, std::int32_t srs) {
  constexpr std::uint32_t kPointZ = 1001;
  constexpr std::uint32_t kLineStringZ = 1002;
  Bytes bytes;
  for (const char c : {'G', 'P', '\0', '\1'}) bytes.put(c);
  bytes.put(srs);
  bytes.put('\1');
  const Json& coordinates = geometry["coordinates"];
  const bool is_point = geometry["type"] == "Point";
  bytes.put(is_point ? kPointZ : kLineStringZ);
  if (!is_point) bytes.put(static_cast<std::uint32_t>(coordinates.size()));
  const auto put_point = [&](const Json& point) {
    for (const Json& coordinate : point) bytes.put(coordinate.get<double>());
  };
  if (is_point) put_point(coordinates);
  for (std::size_t i = 0; i < coordinates.size() && !is_point; ++i) put_point(coordinates[i]);
  return bytes.text();
}

// x and y of what a layer has: least, then greatest.
std::array<double, 4> extent_of(const GeoLayer& layer) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 4> extent{kInfinity, kInfinity, -kInfinity, -kInfinity};
  const auto extend = [&](const Json& point) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      extent[axis] = std::min(extent[axis], point[axis].get<double>());
      extent[axis + 2] = std::max(extent[axis + 2], point[axis].get<double>());
    }
  };
  for (const Json& feature : *layer.features) {
    const Json& coordinates = feature["geometry"]["coordinates"];
    if (coordinates[0].is_number()) {
      extend(coordinates);
    } else {
      for (const Json& point : coordinates) extend(point);
    }
  }
  return extent;
}

// The layer's table, and what the standard's tables say of it.
std::string layer_sql(const GeoLayer& layer, int srs, const std::string& changed) {
  std::string columns;
  for (const GeoColumn& column : layer.columns) {
    columns += fmt::format(", \"{}\" {}", column.name, column.type);
  }
  const auto [low_x, low_y, high_x, high_y] = extent_of(layer);
  return fmt::format(
      "CREATE TABLE \"{0}\" (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {1}{2});"
      "INSERT INTO gpkg_contents VALUES ({3}, 'features', {3}, '', '{4}T00:00:00.000Z',"
      " {5}, {6}, {7}, {8}, {9});"
      "INSERT INTO gpkg_geometry_columns VALUES ({3}, 'geom', '{1}', {9}, 1, 0);",
      layer.name, layer.geometry, columns, single_quoted(layer.name),
      changed.empty() ? "1970-01-01" : changed, low_x, low_y, high_x, high_y, srs);
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

}  // namespace

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

}  // namespace tagsmith::detail
