// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/repeated_pictures.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/core.h>

namespace tagsmith::detail {
namespace {

// A minute of eight cameras with eight pictures a second; a picture that is repeated stays.
constexpr std::size_t kMostRemembered = 4096;

struct Place {
  std::size_t row = 0;
  std::string camera;
};

// The rows and cameras that have each picture, by its fingerprint.
std::map<std::uint64_t, std::vector<Place>> places_of_pictures(
    const std::vector<Observation>& rows) {
  std::map<std::uint64_t, std::vector<Place>> places;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (const auto& [camera, picture] : rows[row].pictures) {
      places[picture].push_back({row, camera});
    }
  }
  return places;
}

std::string repeated_in_words(const std::string& camera) {
  return fmt::format(
      "not used, a measurement of another time has the same picture; does camera {} deliver new "
      "ones?",
      camera);
}

}  // namespace

std::uint64_t fingerprint(const GrayView& picture) {
  std::uint64_t all = static_cast<std::uint64_t>(picture.width);
  const auto width = static_cast<std::size_t>(picture.width);
  for (int y = 0; y < picture.height; ++y) {
    const std::string_view row(reinterpret_cast<const char*>(picture.row(y)), width);
    all = 31 * all + std::hash<std::string_view>{}(row);
  }
  return all;
}

bool PictureMemory::is_known(std::uint64_t picture, double time) {
  const auto earlier = std::ranges::find(seen_, picture, &Seen::picture);
  if (earlier == seen_.end()) {
    seen_.push_back({picture, time});
    if (seen_.size() > kMostRemembered) seen_.pop_front();
    return false;
  }
  if (earlier->time == time) return false;
  std::rotate(earlier, std::next(earlier), seen_.end());
  return true;
}

std::vector<CameraImage> PictureMemory::new_ones(std::span<const CameraImage> images,
                                                 Observation& observation) {
  if (!observation.time) return {images.begin(), images.end()};
  std::vector<CameraImage> kept;
  for (const CameraImage& image : images) {
    if (!is_known(fingerprint(image.image), *observation.time)) {
      kept.push_back(image);
      continue;
    }
    observation.faults.push_back(image.name + ": " + repeated_in_words(image.camera->name));
    observation.has_left_out = true;
  }
  return kept;
}

void PictureMemory::leave_out_known(Observation& observation) {
  if (!observation.time) return;
  for (const auto& [camera, picture] : std::map(observation.pictures)) {
    if (!is_known(picture, *observation.time)) continue;
    leave_out_pictures(observation, {camera},
                       "the picture of camera " + camera + ": " + repeated_in_words(camera));
  }
}

void leave_out_repeated(std::vector<Observation>& rows) {
  const auto places = places_of_pictures(rows);
  for (Observation& row : rows) {
    for (const auto& [camera, picture] : row.pictures) {
      const auto other = std::ranges::find_if(places.at(picture), [&](const Place& at) {
        const std::optional<double>& time = rows[at.row].time;
        return row.time && time && *time != *row.time;
      });
      if (other == places.at(picture).end()) continue;
      leave_out_pictures(
          row, {camera},
          fmt::format("the picture of camera {} is not used: camera {} has the same one in row {}",
                      camera, other->camera, rows[other->row].id));
    }
  }
}

std::vector<std::string> notes_on_repeated(const std::vector<Observation>& rows) {
  const auto places = places_of_pictures(rows);
  std::vector<std::string> notes(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (rows[row].has_left_out) continue;
    for (const auto& [camera, picture] : rows[row].pictures) {
      const auto other =
          std::ranges::find_if(places.at(picture), [&](const Place& at) { return at.row != row; });
      if (other == places.at(picture).end()) continue;
      notes[row] = fmt::format(
          "camera {} has the same picture as row {}: does it hang? With a time in each row such "
          "pictures are left out",
          camera, rows[other->row].id);
      break;
    }
  }
  return notes;
}

}  // namespace tagsmith::detail
