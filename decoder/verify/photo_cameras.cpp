// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/photo_cameras.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <system_error>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

// Where the word begins in the text, set off on both sides.
std::optional<std::size_t> find_word(const std::string& text, const std::string& word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool begins = at == 0 || !is_word(text[at - 1]);
    const bool ends = end == text.size() || !is_word(text[end]);
    if (begins && ends) return at;
  }
  return std::nullopt;
}

// One name for one file, however it is written.
fs::path absolute_name(const fs::path& path) {
  std::error_code failed;
  const fs::path name = fs::weakly_canonical(path, failed);
  return failed ? path.lexically_normal() : name;
}

}  // namespace

PhotoCameras PhotoCameras::by_run(const Rig& rig, const Run& run) {
  PhotoCameras result;
  std::set<std::filesystem::path> named_twice;
  for (const Measurement& row : run.measurements) {
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
      const auto seen = row.cameras.find(rig.cameras[i].name);
      if (seen == row.cameras.end() || seen->second.image.empty()) continue;
      const PhotoOrigin origin{i, "row " + row.id, row.time};
      const std::filesystem::path photo = absolute_name(seen->second.image);
      if (!result.known_.emplace(photo, origin).second) named_twice.insert(photo);
    }
  }
  for (const std::filesystem::path& photo : named_twice) result.known_.erase(photo);
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
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    result.cameras_[lower_case(rig.cameras[i].name)] = i;
  }
  return result;
}

void PhotoCameras::add(const fs::path& photo, std::size_t camera) {
  known_[absolute_name(photo)] = {camera, photo.string()};
}

std::optional<PhotoOrigin> PhotoCameras::origin_of(const fs::path& photo) const {
  if (only_) return PhotoOrigin{*only_, photo.string()};
  const auto known = known_.find(absolute_name(photo));
  if (known != known_.end()) return known->second;
  const std::string stem = lower_case(photo.stem().string());
  std::optional<PhotoOrigin> origin;
  std::size_t longest = 0;
  bool several = false;
  for (const auto& [name, camera] : cameras_) {
    const std::optional<std::size_t> at = find_word(stem, name);
    if (!at || name.size() < longest) continue;
    several = name.size() == longest;
    longest = name.size();
    const std::string rest = stem.substr(0, *at) + "*" + stem.substr(*at + name.size());
    origin = PhotoOrigin{camera, (photo.parent_path() / rest).string()};
  }
  return several ? std::nullopt : origin;
}

}  // namespace tagsmith::detail
