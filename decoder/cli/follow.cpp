// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/follow.hpp"

#include <cstdio>
#include <iostream>
#include <limits>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "decoder/cli/fix_files.hpp"
#include "decoder/plates/live_drive.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kLongestLine = 1 << 20;

// Nothing for lists and objects, which may be nested without limit.
std::optional<std::string> id_text(const Json& id) {
  if (id.is_structured()) return std::nullopt;
  return id.is_string() ? id.get<std::string>() : json_text(id);
}

Result<void> take(Measurement& measurement, const Rig& rig, const std::string& key,
                  const Json& value) {
  if (key == "id") {
    const auto id = id_text(value);
    if (!id) return fail("id is no text or number");
    measurement.id = *id;
    return {};
  }
  if (value.is_null()) return {};
  if (key == "time") {
    if (!value.is_number()) return fail("time is no number, expected seconds");
    measurement.time = value.get<double>();
    return {};
  }
  if (find_camera(rig, key) != nullptr) {
    if (!value.is_string()) return fail(key + " is no text, expected an image's path");
    measurement.cameras[key].image = value.get<std::string>();
    return {};
  }
  for (const RigRange& range : rig.ranges) {
    if (range.name != key) continue;
    if (!value.is_number()) return fail(key + " is no number, expected metres");
    measurement.ranges[key] = value.get<double>();
    return {};
  }
  return fail("`" + key + "` is no camera or range of the rig, nor id or time");
}

Result<Measurement> measurement_from(const Json& object, const Rig& rig) {
  if (!object.is_object()) {
    return fail("no JSON object, expected one like {\"id\": \"1\", \"left\": \"image.jpg\"}");
  }
  Measurement measurement;
  for (const auto& [key, value] : object.items()) {
    if (auto taken = take(measurement, rig, key, value); !taken) return fail(taken);
  }
  return measurement;
}

// `lacks_picture` becomes true where a photo could not be read.
Fix next_fix(const Measurement& measurement, const FollowInput& input, LiveDrive& drive,
             bool& lacks_picture) {
  const auto one = [&](const std::vector<Survey>& surveys, const std::optional<PosePrior>& prior,
                       Observation& seen) {
    Fix fix = input.localize(measurement, surveys, prior, seen);
    lacks_picture = lacks_picture || seen.lacks_picture;
    return fix;
  };
  Fix fix = drive.next(one, input.track ? measurement.time : std::nullopt);
  for (const std::string& words : drive.set_aside_notes())
    to_stderr("tagsmith localize: {}\n", words);
  return input.confirmed ? if_confirmed(std::move(fix)) : fix;
}

std::string error_line(const Json& object, int number, const std::string& message) {
  const auto id =
      object.is_object() && object.contains("id") ? id_text(object["id"]) : std::nullopt;
  const Json line{{"id", id ? Json(*id) : Json()},
                  {"status", "error"},
                  {"reason", fmt::format("line {}: {}", number, message)}};
  return json_text(line);
}

}  // namespace

int follow(const FollowInput& input) {
  bool all_located = true;
  LiveDrive drive(input.surveys, input.rig);
  int number = 0;
  while (const std::optional<std::string> line = read_line(std::cin, kLongestLine)) {
    ++number;
    const bool too_long = line->size() > kLongestLine;
    if (too_long) std::cin.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    if (line->find_first_not_of(" \t\r") == std::string::npos) continue;
    const Json object = too_long ? Json() : Json::parse(*line, nullptr, false);
    const Result<Measurement> measurement =
        too_long ? fail("longer than a mebibyte") : measurement_from(object, input.rig);
    std::string answer;
    if (measurement) {
      bool lacks_picture = false;
      const Fix fix = next_fix(*measurement, input, drive, lacks_picture);
      all_located = all_located && fix.position_in_grid && fix.doubt.empty() && !lacks_picture;
      answer = fix_json_line(fix, *measurement, input.explain);
    } else {
      all_located = false;
      answer = error_line(object, number, measurement.error().message);
    }
    to_stdout("{}\n", answer);
    std::fflush(stdout);
  }
  return all_located ? kExitOk : kExitFindings;
}

}  // namespace tagsmith::detail
