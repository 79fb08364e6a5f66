// SPDX-License-Identifier: Apache-2.0
// Maps as GeoPackage, the SQLite file that GIS programs share (OGC 12-128r17).
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct GeoColumn {
  std::string name;
  std::string type;  // TEXT, DOUBLE, BOOLEAN or DATE
};

// Features as GeoJSON has them, with three coordinates for each point.
struct GeoLayer {
  std::string name;
  std::string geometry;  // POINT or LINESTRING
  std::vector<GeoColumn> columns;
  const nlohmann::ordered_json* features = nullptr;  // a list, which must outlive the layer
};

// The file's bytes. `epsg` 0: the layers are in an undefined Cartesian system. `changed` (a day, as
// 2026-03-31; empty = unknown, written as 1970-01-01) is the last change of the content, so that
// one survey always gives one file. Fails when SQLite does, for lack of memory.
Result<std::string> geopackage(const std::vector<GeoLayer>& layers, int epsg,
                               const std::string& changed);

}  // namespace tagsmith::detail
