// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/read_json.hpp"

#include <nlohmann/json.hpp>

#include "tagsmith/cli/json_text.hpp"

namespace tagsmith::detail {
namespace {

Json to_json(const FrameCorners& corners) {
  return json_list(corners, [](const PixelPoint& corner) -> Json {
    return {with_decimals(corner.x, 3), with_decimals(corner.y, 3)};
  });
}

// What readings with and without a frame have in common; `places` are the corners of what was read.
template <class AnyReading>
Json to_json(const AnyReading& reading, const std::vector<Survey>& surveys, const Json& places,
             const std::string& method) {
  Json json{{"digits", to_string(reading.digits)},
            {"check_digit", check_digit_name(reading)},
            {"position", coded_position(reading.digits, surveys)}};
  json.update(places);
  json["module_px"] = with_decimals(reading.module_px, 3);
  json["confidence"] = reading.confidence;
  json["method"] = method;
  return json;
}

Json to_json(const PartReading& part) {
  const auto candidate_json = [](const PartCandidate& candidate) -> Json {
    return {{"digits", to_string(candidate.digits)}, {"odds", candidate.odds}};
  };
  return {{"digits_in_sight", digits_in_sight(part)},
          {"candidates", json_list(part.candidates, candidate_json)},
          {"share", with_decimals(part.share, 3)},
          {"corners", to_json(part.corners)},
          {"corners_in_sight", part.corner_in_sight},
          {"module_px", with_decimals(part.module_px, 3)},
          {"confidence", part.confidence}};
}

}  // namespace

GridPoint coded_position(const Digits& digits, const std::vector<Survey>& surveys) {
  PositionCode code;
  for (const Survey& survey : surveys) {
    if (find_tag(survey, digits) != nullptr) code = survey.code;
  }
  GridPoint position = decode_position(code, digits);
  for (double& coordinate : position) coordinate = with_decimals(coordinate, 6);
  return position;
}

std::string to_json_line(const ImageReadings& readings, const std::vector<Survey>& surveys) {
  Json tags = Json::array();
  for (const Reading& reading : readings.result.tags) {
    tags.push_back(to_json(reading, surveys, {{"corners", to_json(reading.corners)}},
                           to_string(reading.method)));
  }
  for (const FramelessReading& reading : readings.result.frameless.read) {
    tags.push_back(to_json(reading, surveys,
                           {{"corners", nullptr}, {"bars", to_json(reading.bars)}}, "frameless"));
  }
  Json rejected = Json::array();
  for (const Rejection& rejection : readings.result.rejected) {
    rejected.push_back({{"reason", describe(rejection)}, {"corners", to_json(rejection.corners)}});
  }
  for (const FramelessRejection& rejection : readings.result.frameless.rejected) {
    rejected.push_back({{"reason", "no frame: " + describe(rejection)},
                        {"corners", nullptr},
                        {"bars", to_json(rejection.symbol.bars)}});
  }
  Json line = {{"image", readings.image.string()},
               {"width", readings.width},
               {"height", readings.height},
               {"tags", tags}};
  if (!readings.result.parts.empty()) {
    line["parts"] =
        json_list(readings.result.parts, [](const auto& part) { return to_json(part); });
  }
  line["rejected"] = rejected;
  line["time_ms"] = with_decimals(readings.time_ms, 3);
  return json_text(line);
}

}  // namespace tagsmith::detail
