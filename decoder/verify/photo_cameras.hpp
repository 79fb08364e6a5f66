// SPDX-License-Identifier: Apache-2.0
// Which camera of a rig took a photo, and which photos were taken together.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {

struct PhotoOrigin {
  std::size_t camera = 0;        // of the rig
  std::string station;           // the same for photos of one moment
  std::optional<double> time{};  // of the run, seconds
};

class PhotoCameras {
 public:
  // By a run: a row's photos were taken together. Other photos, and those that several rows name,
  // have no origin.
  static PhotoCameras by_run(const Rig& rig, const Run& run);

  // All by one camera, each by itself. Fails when the rig has no camera of this name.
  static Result<PhotoCameras> by_camera(const Rig& rig, const std::string& name);

  // By their names: the only camera of the rig, or the one whose name stands in the file's
  // (site4_left.jpg), set off by anything but letters and digits. Photos of one folder whose names
  // are else the same were taken together.
  static PhotoCameras by_names(const Rig& rig);

  // Adds a photo that a camera of the rig took by itself.
  void add(const std::filesystem::path& photo, std::size_t camera);

  // Nothing when it cannot be told.
  std::optional<PhotoOrigin> origin_of(const std::filesystem::path& photo) const;

 private:
  std::map<std::string, std::size_t> cameras_;          // by name, when names tell
  std::optional<std::size_t> only_;                     // the camera of all photos
  std::map<std::filesystem::path, PhotoOrigin> known_;  // by absolute path
};

}  // namespace tagsmith::detail
