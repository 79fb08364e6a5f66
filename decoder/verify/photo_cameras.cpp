// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/photo_cameras.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

// A camera's name in the name of a file.
struct NameInName {
  std::size_t camera = 0;
  std::size_t begin = 0;
  std::size_t end = 0;

  bool lies_in(const NameInName& other) const {
    const bool is_longer = other.end - other.begin > end - begin;
    return is_longer && other.begin <= begin && end <= other.end;
  }
};

// Adds each place where the word stands in the text, delimited on both sides.
void add_words(const std::string& text, const std::string& word, std::size_t camera,
               std::vector<NameInName>& found) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool begins = at == 0 || !is_word(text[at - 1]);
    const bool ends = end == text.size() || !is_word(text[end]);
    if (begins && ends) found.push_back({camera, at, end});
  }
}

// One name for one file, in whatever way it is written.
fs::path absolute_name(const fs::path& path) {
  std::error_code failed;
  const fs::path name = fs::weakly_canonical(path, failed);
  return failed ? path.lexically_normal() : name;
}

}  // namespace

PhotoCameras PhotoCameras::by_run(const Rig& rig, const Run& run) {
  PhotoCameras result;
  for (const Measurement& row : run.measurements) {
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
      const auto seen = row.cameras.find(rig.cameras[i].name);
      if (seen == row.cameras.end() || seen->second.image.empty()) continue;
      const std::filesystem::path photo = absolute_name(seen->second.image);
      const auto [known, is_new] =
          result.known_.try_emplace(photo, PhotoOrigin{i, "row " + row.id, row.time});
      if (is_new) continue;
      result.unknown_[photo] =
          fmt::format("{} and row {} of the run both have it", known->second.station, row.id);
    }
  }
  for (const auto& [photo, why] : result.unknown_) result.known_.erase(photo);
  return result;
}

Result<PhotoCameras> PhotoCameras::by_camera(const Rig& rig, const std::string& name) {
  const auto camera = std::ranges::find(rig.cameras, name, &RigCamera::name);
  if (camera == rig.cameras.end()) {
    std::string names;
    for (const RigCamera& known : rig.cameras) names += (names.empty() ? "" : ", ") + known.name;
    return fail("--camera " + name + ": the rig " + rig.name + " has no such camera, expected " +
                names);
  }
  PhotoCameras result;
  result.only_ = static_cast<std::size_t>(camera - rig.cameras.begin());
  return result;
}

PhotoCameras PhotoCameras::by_names(const Rig& rig) {
  PhotoCameras result;
  if (rig.cameras.size() == 1) result.only_ = 0;
  for (const RigCamera& camera : rig.cameras) result.cameras_.push_back(lower_case(camera.name));
  return result;
}

void PhotoCameras::add(const fs::path& photo, std::size_t camera) {
  known_[absolute_name(photo)] = {camera, photo.string()};
}

Result<PhotoOrigin> PhotoCameras::origin_of(const fs::path& photo) const {
  if (only_) return PhotoOrigin{*only_, photo.string()};
  const fs::path name = absolute_name(photo);
  if (const auto known = known_.find(name); known != known_.end()) return known->second;
  if (const auto unknown = unknown_.find(name); unknown != unknown_.end()) {
    return fail(unknown->second);
  }
  const std::string stem = lower_case(photo.stem().string());
  std::vector<NameInName> all;
  for (std::size_t i = 0; i < cameras_.size(); ++i) add_words(stem, cameras_[i], i, all);
  std::vector<NameInName> found;
  std::ranges::copy_if(all, std::back_inserter(found), [&](const NameInName& one) {
    return std::ranges::none_of(all, [&](const auto& other) { return one.lies_in(other); });
  });
  if (found.empty()) return fail("which camera of the rig took it is not known");
  const NameInName& last = found.back();
  for (const NameInName& other : found) {
    if (other.camera == last.camera) continue;
    return fail(fmt::format("its name has the names of the cameras {} and {}",
                            cameras_[other.camera], cameras_[last.camera]));
  }
  const std::string rest = stem.substr(0, last.begin) + "*" + stem.substr(last.end);
  return PhotoOrigin{last.camera, (photo.parent_path() / rest).string()};
}

}  // namespace tagsmith::detail
