// SPDX-License-Identifier: Apache-2.0
// Which camera of a rig took a photo, and which photos were taken together.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

  // All by one camera, each taken separately. Fails when the rig has no camera of this name.
  static Result<PhotoCameras> by_camera(const Rig& rig, const std::string& name);

  // By their names: the only camera of the rig, or the one whose name stands in the file's
  // (site4_left.jpg), delimited by anything but letters and digits, and not as a part of another's
  // (front-left). Photos of one folder whose names are otherwise the same were taken together. A
  // file whose name has two cameras' names (right-wall_left.jpg) has no origin.
  static PhotoCameras by_names(const Rig& rig);

  // Adds a photo that a camera of the rig took separately.
  void add(const std::filesystem::path& photo, std::size_t camera);

  // Fails with the reason when it cannot be determined, as "which camera of the rig took it is not
  // known".
  Result<PhotoOrigin> origin_of(const std::filesystem::path& photo) const;

 private:
  std::vector<std::string> cameras_;                      // names in lower case, when they are used
  std::optional<std::size_t> only_;                       // the camera of all photos
  std::map<std::filesystem::path, PhotoOrigin> known_;    // by absolute path
  std::map<std::filesystem::path, std::string> unknown_;  // photos without an origin, and why
};

}  // namespace tagsmith::detail
