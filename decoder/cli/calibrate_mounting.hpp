// SPDX-License-Identifier: Apache-2.0
// `tagsmith calibrate --survey S --rig RIG --run RUN`: where a vehicle's cameras stand and look.
#pragma once

#include <filesystem>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct CalibrateMountingOptions {
  std::filesystem::path survey;
  std::filesystem::path rig;
  std::filesystem::path run;
  std::filesystem::path output;  // the rig file to write; empty = none
  bool json = false;
  int jobs = 0;  // photos read at the same time; 0 = as many as the process may use
};

// Fits the mounting to the run, prints it, and writes the rig with it. Returns the command's exit
// code.
Result<int> calibrate_mounting(const CalibrateMountingOptions& options);

}  // namespace tagsmith::detail
