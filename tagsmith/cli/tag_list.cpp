// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/tag_list.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/geopackage.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/point_list.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

using Json = nlohmann::ordered_json;

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

// The center line as straight pieces that miss it by at most a millimetre.
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

Json grid_json(const Survey& survey) {
  Json grid{{"x_axis", survey.grid.x_axis_left ? "left" : "right"}};
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

std::string x_axis(const Survey& survey) { return survey.grid.x_axis_left ? "left" : "right"; }

void append(std::vector<std::string>& fields, const Eigen::Vector3d& point) {
  for (const double coordinate : point) fields.push_back(format_number(coordinate));
}

}  // namespace

std::string tags_csv(const Survey& survey) {
  const PositionCode& code = survey.code;
  std::string csv = csv_row(own_columns());
  for (const PlacedTag& tag : survey.tags) {
    std::vector<std::string> row{tag.name, to_string(tag.side), to_string(tag.digits)};
    append(row, tag.p_in_grid);
    for (const double length : {tag.chainage, offset_of_p(survey, tag), height_of_p(survey, tag)}) {
      row.push_back(format_number(length));
    }
    row.push_back(states_sigma_of(survey, tag) ? format_number(tag.sigma) : "");
    row.push_back(tag.date);
    if (tag.design_in_grid) {
      append(row, *tag.design_in_grid);
    } else {
      row.insert(row.end(), 3, "");
    }
    row.insert(row.end(), {survey.tag_template.name, to_string(code.check)});
    for (const int count : code.digit_counts) row.push_back(std::to_string(count));
    for (const double resolution : code.resolution) row.push_back(format_number(resolution));
    for (const double origin : code.origin) row.push_back(format_number(origin));
    row.insert(row.end(), {x_axis(survey), format_number(survey.tunnel.height.at(tag.chainage)),
                           format_number(facing_heading(survey, tag))});
    for (const double angle :
         {tag.attitude ? tag.attitude->tilt : 0, tag.attitude ? tag.attitude->roll : 0}) {
      row.push_back(format_number(degrees(angle)));
    }
    for (const double length : listed_plate(survey.tag_template)) {
      row.push_back(format_number(length));
    }
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
