// SPDX-License-Identifier: Apache-2.0
// The part of observation.hpp that loads pictures: who has them in memory needs no decoder.
#include <utility>

#include <fmt/core.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/repeated_pictures.hpp"

namespace tagsmith::detail {
namespace {

void add_distance(Observation& observation, const RigCamera& camera, const CameraMeasurement& seen,
                  const std::vector<Survey>& surveys) {
  const std::string& name = seen.tag.value();
  const std::optional<Digits> digits = parse_digits(name);
  auto found = find_tags(surveys, std::string_view(name));
  if (found.empty() && digits) found = find_tags(surveys, *digits);
  if (found.size() != 1) {
    observation.faults.push_back(fmt::format("{}_tag is {}, {}", camera.name, name,
                                             found.empty()
                                                 ? "expected a tag of the survey"
                                                 : "which several surveys have: give digits"));
    return;
  }
  const auto& [survey, tag] = found.front();
  observation.tags.push_back({camera.name, survey, *tag, std::nullopt, seen.distance});
}

}  // namespace

std::optional<GrayImage> load_observed(const std::filesystem::path& file,
                                       Observation& observation) {
  Result<DecodedImage> loaded = load_image(file);
  if (!loaded) {
    observation.faults.push_back(loaded.error().message);
    observation.lacks_picture = true;
    return std::nullopt;
  }
  if (!loaded->warning.empty()) {
    observation.faults.push_back(file.string() + ": " + damaged_in_words(loaded->warning));
  }
  return std::move(loaded->image);
}

Observation observe(const Measurement& measurement, const std::vector<Survey>& surveys,
                    const Rig& rig, const ReaderChoice& reader,
                    const std::optional<PosePrior>& prior) {
  Observation observation{measurement.id, {}, measurement.ranges, {}};
  observation.time = measurement.time;
  for (const RigCamera& camera : rig.cameras) {
    const auto seen = measurement.cameras.find(camera.name);
    if (seen == measurement.cameras.end()) continue;
    const std::filesystem::path& file = seen->second.image;
    if (!file.empty()) {
      const std::optional<GrayImage> image = load_observed(file, observation);
      if (image) {
        observation.pictures[camera.name] = fingerprint(image->view());
        observe_image(observation, camera, image->view(), file.string(), surveys, reader, prior);
      }
    }
    if (seen->second.tag && seen->second.distance) {
      add_distance(observation, camera, seen->second, surveys);
    }
  }
  return observation;
}

}  // namespace tagsmith::detail
