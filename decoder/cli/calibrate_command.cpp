// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/calibrate_command.hpp"

#include <memory>

#include "decoder/cli/calibrate_board.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kNotes =
    R"(Needs no guess of the lens: perspective cameras and fisheyes are tried, and the simplest form that explains the corners is chosen. Every number comes with its standard deviation, and whatever the photos lack is named with what to do about it.

Example:
  tagsmith board -o board.pdf
  tagsmith calibrate --board board.yaml photos -o left.yaml --html left.html
  tagsmith calibrate --board board.yaml photos -o left.yaml --rig rig.yaml --camera left

Exit: 0 the calibration is good, 1 it is weak, or refused and the camera's file is not written, 2 wrong use or a photo that cannot be read.)";

}  // namespace

Command calibrate_command() {
  const auto options = std::make_shared<BoardCalibrationOptions>();
  return {
      .name = "calibrate",
      .summary = "A camera's lens from photos of calibration boards, and how well it is known",
      .options = board_calibration_options(*options),
      .notes = kNotes,
      .run =
          [options] {
            const Result<int> code = calibrate_by_boards(*options);
            return code ? *code : report_failure("calibrate", code.error());
          },
  };
}

}  // namespace tagsmith::detail
