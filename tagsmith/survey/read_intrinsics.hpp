// SPDX-License-Identifier: Apache-2.0
// The lens and sensor of one of a rig's cameras. Internal to tagsmith/survey.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// The keys of a camera that these functions read.
std::vector<std::string> intrinsics_keys();

// The camera's keys, whether or not they are right.
IntrinsicsSource intrinsics_source(const MapReader& map);

struct Intrinsics {
  Camera camera;
  std::filesystem::path calibration;  // the file that states them; empty = the rig does
};

// By a data sheet, by numbers, or by a calibration file, which is looked for beside the rig in
// `folder`. Nothing when errors were logged; those about the calibration file name that file.
std::optional<Intrinsics> read_intrinsics(const MapReader& map,
                                          const std::filesystem::path& folder);

}  // namespace tagsmith::detail
