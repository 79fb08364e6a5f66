// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/follow.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "decoder/cli/fix_json.hpp"
#include "decoder/localize/repeated_pictures.hpp"
#include "decoder/localize/travel.hpp"
#include "decoder/verify/set_aside.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"

namespace tagsmith::detail {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestLine = 1 << 20;

// Nothing for lists and objects, which may be nested without end.
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
    if (auto taken = take(measurement, rig, key, value); !taken) return fail(taken.error().message);
  }
  return measurement;
}

// Whether tags contradict each other, or the motion.
bool is_contradicted(const Fix& fix) {
  const auto is_tag = [](const Dropped& dropped) { return !dropped.camera.empty(); };
  const bool refused = !fix.position_in_grid && fix.tags.size() > 1;
  return refused || std::ranges::any_of(fix.dropped, is_tag);
}

// What tells whether a file is still the one that it was.
using FileState = std::array<std::int64_t, 5>;

std::optional<FileState> state_of(const std::filesystem::path& file) {
  struct stat found {};
  if (file.empty() || ::stat(file.c_str(), &found) != 0) return std::nullopt;
  return FileState{static_cast<std::int64_t>(found.st_dev), static_cast<std::int64_t>(found.st_ino),
                   found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

// Of each camera that has a picture.
std::map<std::string, FileState> picture_states(const Measurement& measurement) {
  std::map<std::string, FileState> states;
  for (const auto& [name, camera] : measurement.cameras) {
    if (const auto state = state_of(camera.image)) states.emplace(name, *state);
  }
  return states;
}

// The last measurements, and which tags they show to hang elsewhere than surveyed.
class RunSoFar {
 public:
  explicit RunSoFar(const FollowInput& input) : input_(input), surveys_(input.surveys) {}

  // The surveys without the tags that are set aside.
  const std::vector<Survey>& surveys() const { return surveys_; }

  // `pictures`: the states of its files before they were read.
  void remember(const Measurement& measurement, std::map<std::string, FileState> pictures,
                bool contradicted) {
    constexpr std::size_t kMost = 40;
    last_.push_back({measurement, std::move(pictures), contradicted, std::nullopt});
    if (last_.size() > kMost) last_.pop_front();
  }

  // Sets aside what the last measurements are certain of where one of them is contradicted, and
  // says what is new.
  std::vector<std::string> set_aside() {
    if (std::ranges::none_of(last_, &Past::contradicted)) return {};
    std::vector<Observation> rows;
    for (Past& past : last_) {
      if (!past.seen) past.seen = input_.observe(still_there(past));
      rows.push_back(*past.seen);
      // Two lines are two moments, whether or not they say when.
      if (!rows.back().time) rows.back().time = -static_cast<double>(rows.size());
    }
    leave_out_repeated(rows);
    std::vector<std::string> told;
    for (const SetAside& tag : set_aside_misplaced(rows, input_.surveys, input_.rig).aside) {
      const auto removed = std::erase_if(surveys_[tag.survey].tags, [&](const PlacedTag& placed) {
        return placed.name == tag.tag;
      });
      if (removed > 0) told.push_back("set aside from here on: " + tag.message);
    }
    if (!told.empty()) {
      for (Past& past : last_) past.contradicted = false;
    }
    return told;
  }

 private:
  struct Past {
    Measurement measurement;
    std::map<std::string, FileState> pictures;
    bool contradicted = false;  // and nothing was set aside since
    std::optional<Observation> seen;
  };

  // Without the pictures whose files were written anew or removed: what they hold now is of another
  // moment.
  static Measurement still_there(const Past& past) {
    Measurement left = past.measurement;
    std::erase_if(left.cameras, [&](const auto& camera) {
      const auto then = past.pictures.find(camera.first);
      return then == past.pictures.end() || state_of(camera.second.image) != then->second;
    });
    return left;
  }

  const FollowInput& input_;
  std::vector<Survey> surveys_;
  std::deque<Past> last_;
};

// The position of one measurement, by what the ones before it say of the tags and of the motion.
Fix locate(const Measurement& measurement, const FollowInput& input, RunSoFar& run,
           std::optional<LiveTrack>& track, LiveDoubts& doubts) {
  const bool tracked = input.track && measurement.time.has_value();
  const auto prior = tracked && track
                         ? prior_at(*track, *measurement.time, input.surveys, MotionModel{})
                         : std::nullopt;
  std::map<std::string, FileState> pictures = picture_states(measurement);
  Fix fix = input.locate(measurement, run.surveys(), prior);
  if (input.observe) {
    run.remember(measurement, std::move(pictures), is_contradicted(fix));
    const std::vector<std::string> told = run.set_aside();
    if (!told.empty()) fix = input.locate(measurement, run.surveys(), prior);
    for (const std::string& words : told) {
      to_stderr("localize: {}\n", words);
      fix.notes.push_back(words);
    }
  }
  if (tracked) fix = follow_track(track, std::move(fix), *measurement.time, input.surveys);
  fix = doubts.judged(std::move(fix), input.surveys, input.rig);
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
  std::optional<LiveTrack> track;
  RunSoFar run(input);
  LiveDoubts doubts;
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
      const Fix fix = locate(*measurement, input, run, track, doubts);
      all_located = all_located && fix.position_in_grid && fix.doubt.empty();
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
