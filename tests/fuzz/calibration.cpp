// SPDX-License-Identifier: Apache-2.0
// Calibrations of OpenCV (YAML and XML), ROS and kalibr.
#include "tagsmith/survey/read_calibration.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::FileInMemory file(fuzz::as_text(data, size));
  (void)read_calibration({file.path(), "", std::nullopt});
  (void)read_calibration({file.path(), "cam0", LensModel::fisheye});
  return 0;
}
