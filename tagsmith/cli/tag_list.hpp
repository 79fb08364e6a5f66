// SPDX-License-Identifier: Apache-2.0
// A survey's tags in formats for other programs.
#pragma once

#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// RFC 4180, a tag a row: address, position of P, as-built data and, the same in every row, what the
// codes need. `tagsmith new --from FILE --order own` reads it back. Lengths to the micrometre.
std::string tags_csv(const Survey& survey);

// One object: the survey, its template, tunnel and code, and each tag.
std::string tags_json(const Survey& survey);

// GeoJSON: the tags as points with what tags_json says of them, and the center line, in the grid's
// coordinates. `crs` names the grid as GeoJSON 2008 did, which RFC 7946 leaves to prior agreement;
// null where the survey does not.
std::string tags_geojson(const Survey& survey);

// The bytes of a GeoPackage (OGC 12-128r17) with the layers `tags` (POINT Z) and `centerline`
// (LINESTRING Z) of the same content. Fails when SQLite does.
Result<std::string> tags_geopackage(const Survey& survey);

// WPILib's AprilTagFieldLayout: pose of the feature frame's middle, x out of the plate, z up, in
// the right-handed world (x to the right of the drive's +y; a grid with x to the left is mirrored).
// ID = 2 * pair, and 1 more on the right.
std::string field_layout_json(const Survey& survey);

}  // namespace tagsmith::detail
