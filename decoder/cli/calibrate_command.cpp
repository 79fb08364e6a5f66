// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "decoder/cli/calibrate_board.hpp"
#include "decoder/cli/calibrate_mounting.hpp"
#include "decoder/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kCalibrateNotes =
    R"(From photos of boards: the lens. Needs no guess of it: perspective cameras and fisheyes are tried, and the simplest form that explains the corners is chosen. Every number comes with its standard deviation, and whatever the photos lack is named with what to do about it.

From a drive past surveyed tags (--survey, --rig, --run): where a rig's cameras stand and look.

Example:
  tagsmith board -o board.pdf
  tagsmith calibrate --board board.yaml photos -o left.yaml --html left.html
  tagsmith calibrate --board board.yaml photos -o left.yaml --rig rig.yaml --camera left
  tagsmith calibrate --survey survey.yaml --rig rig.yaml --run run.csv -o rig-mounted.yaml

Exit: 0 the calibration is good, 1 it is weak, or refused and nothing is written for the rig, 2 wrong use or a file that cannot be read.)";

struct CalibrateOptions {
  BoardCalibrationOptions board;  // with the options that both kinds have
  std::string survey;
  std::string run;
};

std::vector<CommandOption> board_options(BoardCalibrationOptions& options) {
  return {
      argument("PHOTO", &options.photos, ValueKind::picture,
               "Photos of boards by one camera, folders of them, or - for a list of files on "
               "standard input"),
      value_option("--board", &options.boards, "BOARD.yaml",
                   "A board's file, as `tagsmith board` wrote it and you completed it; several "
                   "boards must differ in their serials",
                   ValueKind::file),
      with_default(choice_option(
          "--format", &options.format, {"opencv", "ros", "kalibr"},
          "Of the camera's file: opencv (FileStorage), ros (camera_info) or kalibr (camchain)")),
      value_option(
          "--camera", &options.camera, "NAME",
          "The camera's name, in the rig and in files of ros and kalibr (default: camera)"),
      file_option("--html", &options.html,
                  "A page: verdict, coverage, residuals, distortion, photos"),
      file_option("--drawing", &options.drawing,
                  "The same pictures as a sheet: FILE.pdf, FILE.svg or FILE.png")};
}

std::vector<CommandOption> calibrate_options(CalibrateOptions& options) {
  std::vector<CommandOption> all = board_options(options.board);
  const std::vector<std::string> of_boards{"--board", "--format", "--camera", "--html",
                                           "--drawing"};
  all.push_back(excluding(
      of_boards, needing({"--rig", "--run"}, value_option("--survey", &options.survey, "SURVEY",
                                                          "The survey whose tags the drive passes",
                                                          ValueKind::survey))));
  all.push_back(needing(
      {"--survey"}, value_option("--run", &options.run, "RUN.csv",
                                 "The drive: pictures and ranges, row by row", ValueKind::table)));
  all.push_back(rig_option(&options.board.rig,
                           "With photos: takes the camera's file and its sigmas over, comments "
                           "kept. With a drive: the cameras as they are known"));
  all.push_back(file_option(
      "-o,--output", &options.board.output,
      "With photos: the camera's file. With a drive: the rig with its cameras' mounting"));
  all.push_back(
      json_flag(options.board.json, "One JSON object a photo or camera, then the summary"));
  all.push_back(jobs_option(options.board.jobs, "Photos read at once"));
  return all;
}

Result<int> run(const CalibrateOptions& options) {
  const BoardCalibrationOptions& board = options.board;
  if (options.survey.empty()) return calibrate_by_boards(board);
  if (!board.photos.empty()) return fail("PHOTO is of boards, and --survey of a drive: give one");
  return calibrate_mounting(
      {options.survey, board.rig, options.run, board.output, board.json, board.jobs});
}

}  // namespace

Command calibrate_command() {
  const auto options = std::make_shared<CalibrateOptions>();
  return {
      .name = "calibrate",
      .summary = "A camera's lens from photos of boards, or a rig's mounting from a drive",
      .options = calibrate_options(*options),
      .notes = kCalibrateNotes,
      .run = [options] { return run(*options); },
  };
}

}  // namespace tagsmith::detail
