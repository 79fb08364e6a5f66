// SPDX-License-Identifier: Apache-2.0
// The JSON Schemas that editors use and the parsers judge the structure of a file alike. Good
// documents are changed in one place at a time; a JSON Schema validator and the parser must agree
// on each. Rules of geometry and of meaning, which a schema cannot say, are left out of the
// verdict.
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/board_file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tests/schemas/schema_judge.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using Json = nlohmann::json;

namespace {

const Json& good_survey() {
  static const Json survey = Json::parse(R"({
    "survey": "trial", "grid": { "x_axis": "right" },
    "tunnel": { "width": 4.0, "height": 3.0, "centerline": { "start": [10.0, 20.0, 0.5],
      "heading": 1.5, "elements": [ { "line": 12.0 },
      { "arc": 20.0, "turn": "left", "angle": 30.5, "grade": 1.5 } ] } },
    "tags": { "template": "tag-400x300", "height": 1.4, "spacing": 0.6, "first": 1.0, "pairs": 4,
      "theta": 4.9, "sigma": 0.003, "angle_sigma": 0.5 },
    "code": { "check_digit": "gs1", "resolution": [0.01, 0.01, 0.01], "digits": [4, 4, 3],
      "origin": [0.5, 0.5, -1.5] },
    "placed": [ { "tag": "004L", "side": "left", "p": [8.5, 25.5, 1.4], "digits": "000000000017",
      "sigma": 0.002, "date": "2026-03-31", "design": [8.5, 25.4, 1.4], "control": true } ] })");
  return survey;
}

// A tunnel as surveyed, with what excludes the keys of the one above.
const Json& good_surveyed_tunnel() {
  static const Json survey = [] {
    Json json = good_survey();
    json["tunnel"].erase("width");
    json["tunnel"].erase("height");
    json["tunnel"].update(Json::parse(R"({
      "sections": [ { "at": 0.5, "height": 3.1 }, { "at": 8.5, "height": 3.3 } ],
      "walls": { "left": [ [0.5, 2.1], [9.5, 2.3] ], "right": [ [0.5, 2.1] ] },
      "stand_off": 0.03 })"));
    json["tunnel"]["centerline"]["elements"] = Json::parse(R"([ { "line": 12.0 },
      { "clothoid": 5.5, "turn": "left", "to_radius": 30.5 },
      { "clothoid": 5.5, "turn": "left", "from_radius": 30.5, "to_radius": 20.5, "grade": 1.5 } ])");
    json["grid"]["crs"] = "EPSG:25832";
    json["tags"].erase("pairs");
    json["tags"].update(Json::parse(R"({ "to": 3.5, "tilt": { "left": 2.5, "right": -1.5 },
      "roll": 0.5 })"));
    json["placed"][0].update(Json::parse(R"({ "facing": 88.5, "tilt": 3.5, "roll": -1.5 })"));
    return json;
  }();
  return survey;
}

const Json& good_template() {
  static const Json tag = Json::parse(R"({
    "tag": "trial", "plate": [0.4, 0.3],
    "feature_frame": { "inner": [0.343, 0.168], "stroke": 0.012, "offset": [0.001, 0.02] },
    "symbol": { "quiet_zone": 9.5, "margin": 9.5, "dots_per_inch": 300 },
    "label": { "shown": true, "text_height_mm": 8.5, "lines": [ "{name}" ], "left": "links",
      "right": "rechts" },
    "logo": { "file": "/usr/share/icons/none.svg", "size_mm": [20.5, 5.5] },
    "qr": { "size_mm": 9.5, "content": "{digits}" },
    "patches": { "size_mm": 10.5 }, "material": "aluminium", "white_on_black": true,
    "holes": { "diameter_mm": 5.5, "at": [ [0.185, 0.135], [-0.185, 0.135] ] },
    "cut": { "contour": true, "corner_radius_mm": 4.5 } })");
  return tag;
}

// With what excludes a key of the one above.
const Json& good_holed_template() {
  static const Json tag = [] {
    Json json = good_template();
    json["holes"] = Json::parse(R"({ "diameter_mm": 5.5, "inset_mm": 15.5 })");
    return json;
  }();
  return tag;
}

const Json& good_board() {
  static const Json board = Json::parse(R"({
    "board": "trial", "serial": 7, "sheet": [0.297, 0.21],
    "feature_frame": { "inner": [0.0575, 0.0275], "stroke": 0.0025 },
    "symbol": { "quiet_zone": 9.5, "margin": 9.5, "dots_per_inch": 300 },
    "tags": { "columns": 4, "rows": 5, "first": [0.017, 0.019], "step": [0.071, 0.036] },
    "drawn": { "a_b_mm": 281.5, "a_c_mm": 194.5 },
    "measured": { "a_b_mm": 281.5, "a_c_mm": 194.5, "sigma_mm": 0.5 } })");
  return board;
}

const Json& good_rig() {
  static const Json rig = Json::parse(R"({
    "rig": "trial",
    "cameras": {
      "left": { "image_size": [1280, 960], "focal_length_mm": 6.5, "sensor_mm": [4.8, 3.6],
        "alpha": 35.5, "side": "left" },
      "front": { "image_size": [1280, 960], "fx": 1600.5, "fy": 1601.5, "cx": 640.5, "cy": 480.5,
        "distortion": [0.1, 0.1, 0.1, 0.1, 0.1], "yaw": 5.5, "pitch": -2.5, "roll": 0.5,
        "position": [0.5, 0.1, 0.1], "exposure": 0.01, "readout": 0.02, "delay": 0.01, "blur_px": 0.5, "focus": 1.5,
        "aperture_mm": 2.5, "model": "perspective",
        "sigma": { "position": 0.001, "angle": 0.05, "focal": 0.001, "center": 0.5, "distortion": 0.001, "edge": 0.2 } },
      "rear": { "calibration": { "file": "none.yaml", "camera": "cam0" }, "model": "fisheye",
        "yaw": 180.5, "sigma": 0 } },
    "ranges": { "d": { "wall": "left", "min": 0.25, "max": 5.5, "sigma": 0.01 } },
    "vehicle": { "height": 0.24, "roll_sigma": 2.5, "pitch_sigma": 2.5, "height_sigma": 0.05,
      "envelope": { "lateral": 0.4, "yaw": 8.5, "speed": 1.5, "roll": 2.5, "pitch": 1.5 } } })");
  return rig;
}

// The names of all properties in a schema.
std::set<std::string> keys_of(const Json& schema) {
  std::set<std::string> keys;
  for (const auto& [name, part] : schema.items()) {
    if (name == "properties") {
      for (const auto& [key, value] : part.items()) keys.insert(key);
    }
    if (part.is_structured()) keys.merge(keys_of(part));
  }
  return keys;
}

// Rules that look at more than the structure.
bool is_structural(const Diagnostic& finding) {
  static const std::set<std::string> meaning{"bad-station",
                                             "corner-radius",
                                             "hole-misplaced",
                                             "no-dots",
                                             "no-room-for-patches",
                                             "no-room-for-qr",
                                             "no-room-for-logo",
                                             "unknown-field",
                                             "faces-rock",
                                             "bad-digit-counts",
                                             "calibration-file",
                                             "coarse-code",
                                             "code-collision",
                                             "code-range",
                                             "duplicate-tag",
                                             "frame-outside-plate",
                                             "no-bars",
                                             "no-template",
                                             "off-wall",
                                             "outside-tunnel",
                                             "overlap",
                                             "side-mismatch",
                                             "theta",
                                             "tight-arc",
                                             "too-many-tags",
                                             "wrong-check-digit",
                                             "wrong-side",
                                             "board-scale",
                                             "off-millimetre",
                                             "outside-sheet",
                                             "tags-overlap"};
  return finding.severity == Severity::error && !meaning.contains(finding.code);
}

struct Format {
  std::string name;
  std::vector<Diagnostic> (*read)(const fs::path&);
  const Json& good;
};

const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {"survey", [](const fs::path& path) { return read_survey(path).value().diagnostics; },
       good_survey()},
      {"survey", [](const fs::path& path) { return read_survey(path).value().diagnostics; },
       good_surveyed_tunnel()},
      {"template", [](const fs::path& path) { return read_template(path).value().diagnostics; },
       good_template()},
      {"template", [](const fs::path& path) { return read_template(path).value().diagnostics; },
       good_holed_template()},
      {"board", [](const fs::path& path) { return read_board(path).value().diagnostics; },
       good_board()},
      {"rig", [](const fs::path& path) { return read_rig(path).value().diagnostics; }, good_rig()}};
  return all;
}

// JSON is YAML, as long as lines break.
std::string parser_objection(const Format& format, const Json& document) {
  static const TemporaryFolder folder;
  const fs::path file = folder.path() / "document.yaml";
  REQUIRE(write_file(file, document.dump(1)));
  for (const Diagnostic& finding : format.read(file)) {
    if (is_structural(finding)) return to_string(finding);
  }
  return {};
}

struct Change {
  std::string what;
  Json document;
};

std::vector<Json> replacements(const Json& value) {
  std::vector<Json> all{"text",        true,           nullptr,
                        Json::array(), Json::object(), Json::array({1.5, 2.5}),
                        -1e9,          1e12,           ""};
  if (value.is_number()) all.push_back(value.dump());  // a number in quotes
  if (value.is_array() && !value.empty()) {
    Json longer = value;
    longer.push_back(value.back());
    if (value.front().is_number()) all.push_back(longer);
  }
  return all;
}

void change_everywhere(const Json& root, const Json::json_pointer& at,
                       std::vector<Change>& changes) {
  const Json& value = root[at];
  for (const Json& other : replacements(value)) {
    if (other == value) continue;
    Change change{at.to_string() + " = " + other.dump(), root};
    change.document[at] = other;
    changes.push_back(change);
  }
  if (value.is_object()) {
    Change unknown{at.to_string() + " with an unknown key", root};
    unknown.document[at / "colour"] = 1.5;
    changes.push_back(unknown);
    for (const auto& [key, item] : value.items()) {
      Change without{at.to_string() + " without " + key, root};
      without.document[at].erase(key);
      changes.push_back(without);
      change_everywhere(root, at / key, changes);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) change_everywhere(root, at / i, changes);
  }
}

}  // namespace

TEST_CASE("schema and parser give the same verdict on every changed document") {
  for (const Format& format : formats()) {
    SchemaJudge judge(schema_json(format.name));
    CHECK(judge.accepts(format.good));
    CHECK(parser_objection(format, format.good).empty());
    std::vector<Change> changes;
    change_everywhere(format.good, Json::json_pointer(), changes);
    CHECK(changes.size() > 150);
    for (const Change& change : changes) {
      const std::string objection = parser_objection(format, change.document);
      const bool accepted = judge.accepts(change.document);
      CHECK_MESSAGE(accepted == objection.empty(), format.name << ": " << change.what << ": schema "
                                                               << (accepted ? "accepts" : "refuses")
                                                               << ", parser: " << objection);
    }
  }
}

TEST_CASE("schema and parser agree on keys that exclude or need each other") {
  struct Row {
    const char* format;
    const char* patch;  // JSON Patch (RFC 6902)
    bool good;
  };
  const std::vector<Row> rows{
      {"survey", R"([{"op":"add","path":"/tags/to","value":5.0}])", false},
      {"survey",
       R"([{"op":"remove","path":"/tags/pairs"},{"op":"add","path":"/tags/to","value":5.0}])",
       true},
      {"survey", R"([{"op":"remove","path":"/tags/pairs"}])", true},
      {"survey", R"([{"op":"remove","path":"/tags/pairs"},{"op":"remove","path":"/placed"}])",
       false},
      {"survey", R"([{"op":"remove","path":"/placed"}])", true},
      {"survey", R"([{"op":"replace","path":"/code/resolution","value":0.02}])", true},
      {"survey", R"([{"op":"add","path":"/tunnel/centerline/elements/0/arc","value":5.0}])", false},
      {"survey", R"([{"op":"add","path":"/tunnel/centerline/elements/0/turn","value":"left"}])",
       false},
      {"survey", R"([{"op":"replace","path":"/placed/0/tag","value":"04L"}])", false},
      {"survey", R"([{"op":"replace","path":"/placed/0/tag","value":"1004L"}])", true},
      {"survey", R"([{"op":"replace","path":"/placed/0/date","value":"31.03.2026"}])", false},
      {"survey", R"([{"op":"replace","path":"/survey","value":"a/b"}])", false},
      {"survey", R"([{"op":"replace","path":"/survey","value":"Strecke \u00c4 7"}])", true},
      {"survey", R"([{"op":"replace","path":"/survey","value":"\u00c4 7"}])", true},
      {"rig", R"([{"op":"add","path":"/cameras/left/yaw","value":5.5}])", false},
      {"rig", R"([{"op":"add","path":"/cameras/left/fx","value":5.5}])", false},
      {"rig", R"([{"op":"add","path":"/cameras/left/distortion","value":[0.1,0.1,0.1,0.1,0.1]}])",
       false},
      {"rig", R"([{"op":"add","path":"/cameras/front/side","value":"left"}])", true},
      {"rig", R"([{"op":"move","from":"/cameras/left","path":"/cameras/time"}])", false},
      {"rig", R"([{"op":"move","from":"/cameras/left","path":"/cameras/7th"}])", false},
      {"rig", R"([{"op":"remove","path":"/ranges"}])", true},
      {"rig", R"([{"op":"replace","path":"/cameras/rear/sigma","value":0.5}])", false},
      {"rig", R"([{"op":"replace","path":"/cameras/rear/sigma","value":{"focal":0}}])", true},
      {"rig", R"([{"op":"replace","path":"/cameras/rear/calibration","value":"none.yaml"}])", true},
      {"rig", R"([{"op":"add","path":"/cameras/rear/image_size","value":[1280,960]}])", true},
      {"rig", R"([{"op":"add","path":"/cameras/rear/fx","value":900.5}])", false},
      {"rig", R"([{"op":"add","path":"/cameras/left/calibration","value":"none.yaml"}])", false},
      {"rig", R"([{"op":"replace","path":"/cameras/front/model","value":"fisheye"}])", false},
      {"rig", R"([{"op":"replace","path":"/cameras/front/model","value":"fisheye"},
        {"op":"remove","path":"/cameras/front/distortion/4"}])",
       true},
      {"rig", R"([{"op":"add","path":"/cameras/front/distortion","value":[0,0,0,0,0,0,0,0]}])",
       true},
      {"survey", R"([{"op":"remove","path":"/tunnel/width"}])", false},
      {"survey", R"([{"op":"add","path":"/tunnel/sections","value":[{"at":0.5,"width":4.5}]}])",
       false},
      {"survey",
       R"([{"op":"add","path":"/tunnel/sections","value":[{"at":0.5,"width":4.5}]},
         {"op":"remove","path":"/tunnel/width"}])",
       true},
      {"survey", R"([{"op":"add","path":"/tunnel/walls","value":{"left":[[0.5,2.5]]}}])", true},
      {"survey",
       R"([{"op":"add","path":"/tunnel/walls","value":{"left":[[0.5,2.5]],"right":[[0.5,2.5]]}}])",
       false},
      {"survey",
       R"([{"op":"add","path":"/tunnel/walls","value":{"left":[[0.5,2.5]],"right":[[0.5,2.5]]}},
         {"op":"remove","path":"/tunnel/width"}])",
       true},
      {"survey", R"([{"op":"add","path":"/tunnel/walls","value":{"left":[[0.5,-2.5]]}}])", false},
      {"rig", R"([{"op":"add","path":"/cameras/rear/sensor_mm","value":[4.8,3.6]}])", false},
      {"rig", R"([{"op":"add","path":"/cameras/front/sensor_mm","value":[4.8,3.6]}])", false},
      {"rig", R"([{"op":"add","path":"/cameras/rear/cy","value":480.5}])", false},
      {"template", R"([{"op":"add","path":"/holes/inset_mm","value":12.5}])", false},
      {"template",
       R"([{"op":"replace","path":"/holes","value":{"diameter_mm":5.5,"inset_mm":12.5}}])", true},
      {"board", R"([{"op":"remove","path":"/measured"}])", true},
      {"board", R"([{"op":"remove","path":"/measured/sigma_mm"}])", true},
      {"board", R"([{"op":"remove","path":"/drawn"}])", false},
      {"board", R"([{"op":"replace","path":"/serial","value":1000}])", false},
      {"template", R"([{"op":"remove","path":"/label"}])", true},
      {"template", R"([{"op":"replace","path":"/symbol/quiet_zone","value":8.5}])", false},
  };
  for (const Format& format : formats()) {
    // The patches are of the others.
    if (&format.good == &good_surveyed_tunnel() || &format.good == &good_holed_template()) continue;
    SchemaJudge judge(schema_json(format.name));
    for (const Row& row : rows) {
      if (row.format != format.name) continue;
      CAPTURE(row.patch);
      const Json document = format.good.patch(Json::parse(row.patch));
      CHECK(judge.accepts(document) == row.good);
      const std::string objection = parser_objection(format, document);
      CAPTURE(objection);
      CHECK(objection.empty() == row.good);
    }
  }
}

TEST_CASE("every key of a schema is in a good document and in docs/formats.md") {
  const std::string formats_text = *read_file("docs/formats.md");
  std::map<std::string, std::string> good;  // all good documents of a schema
  for (const Format& format : formats()) good[format.name] += format.good.dump();
  for (const auto& [name, documents] : good) {
    for (const std::string& key : keys_of(schema_json(name))) {
      CAPTURE(name);
      CAPTURE(key);
      CHECK(documents.find("\"" + key + "\":") != std::string::npos);
      CHECK(formats_text.find(key) != std::string::npos);
    }
  }
}

TEST_CASE("every key of a schema has a text to show in an editor") {
  for (const Format& format : formats()) {
    for (const std::string& key : undescribed_keys(schema_json(format.name))) {
      FAIL_CHECK(format.name << key << " has no description");
    }
  }
}
