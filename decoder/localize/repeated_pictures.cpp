// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/repeated_pictures.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace tagsmith::detail {
namespace {

constexpr std::size_t kMostRemembered = 64;

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

std::vector<CameraImage> PictureMemory::new_ones(std::span<const CameraImage> images,
                                                 Observation& observation) {
  if (!observation.time) return {images.begin(), images.end()};
  std::vector<CameraImage> kept;
  for (const CameraImage& image : images) {
    const std::uint64_t picture = fingerprint(image.image);
    const auto earlier = std::ranges::find(seen_, picture, &Seen::picture);
    if (earlier == seen_.end()) {
      seen_.push_back({picture, *observation.time});
      if (seen_.size() > kMostRemembered) seen_.pop_front();
    } else if (earlier->time != *observation.time) {
      observation.faults.push_back(
          fmt::format("{}: not used, a measurement of another time has the same picture; does "
                      "camera {} deliver new ones?",
                      image.name, image.camera->name));
      observation.has_left_out = true;
      continue;
    }
    kept.push_back(image);
  }
  return kept;
}

void leave_out_repeated(std::vector<Observation>& rows) {
  struct Place {
    std::size_t row = 0;
    std::string camera;
  };
  std::map<std::uint64_t, std::vector<Place>> places;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row].time) continue;
    for (const auto& [camera, picture] : rows[row].pictures) {
      places[picture].push_back({row, camera});
    }
  }
  for (const auto& [picture, alike] : places) {
    for (const Place& place : alike) {
      const auto other = std::ranges::find_if(
          alike, [&](const Place& at) { return rows[at.row].time != rows[place.row].time; });
      if (other == alike.end()) continue;
      leave_out_pictures(
          rows[place.row], {place.camera},
          fmt::format("the picture of camera {} is not used: camera {} has the same one in row {}",
                      place.camera, other->camera, rows[other->row].id));
    }
  }
}

std::vector<std::string> notes_on_repeated(const std::vector<Observation>& rows) {
  std::map<std::uint64_t, std::vector<std::size_t>> rows_of;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (const auto& [camera, picture] : rows[row].pictures) rows_of[picture].push_back(row);
  }
  std::vector<std::string> notes(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (rows[row].has_left_out) continue;
    for (const auto& [camera, picture] : rows[row].pictures) {
      const std::vector<std::size_t>& alike = rows_of[picture];
      const auto other = std::ranges::find_if(alike, [&](std::size_t at) { return at != row; });
      if (other == alike.end() || !notes[row].empty()) continue;
      notes[row] = fmt::format(
          "camera {} has the same picture as row {}: does it hang? With a time in each row such "
          "pictures are left out",
          camera, rows[*other].id);
    }
  }
  return notes;
}

}  // namespace tagsmith::detail
