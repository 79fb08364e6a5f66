// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/calibrate_mounting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "decoder/calibrate/mounting.hpp"
#include "decoder/cli/observe_run.hpp"
#include "decoder/localize/altered_pictures.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/edit_rig.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::array<const char*, 6> kParameters{"x", "y", "z", "yaw", "pitch", "roll"};

Result<void> check_files(const CalibrateMountingOptions& options, const SurveyedRun& input) {
  CommandFiles files;
  files.reads(input.survey);
  files.reads(input.run);
  // The rig's own file may be updated in place.
  for (const RigCamera& camera : input.rig.cameras) {
    files.reads(camera.calibration, "a calibration");
  }
  files.writes(options.output, "--output");
  return files.check();
}

// x, y, z in metres, then yaw, pitch, roll in degrees.
std::array<double, 6> values_of(const Pose& vehicle_from_camera) {
  const MountingAngles angles = mounting_angles(vehicle_from_camera);
  const Eigen::Vector3d& at = vehicle_from_camera.translation;
  std::array<double, 6> values{
      at.x(), at.y(), at.z(), degrees(angles.yaw), degrees(angles.pitch), degrees(angles.roll)};
  // A value that is printed as zero has no sign.
  for (double& value : values) value = std::abs(value) < 5e-5 ? 0 : value;
  return values;
}

double sigma_of(const FittedMounting& mounting, std::size_t parameter) {
  const double sigma = mounting.sigma[static_cast<Eigen::Index>(parameter)];
  return parameter < 3 ? sigma : degrees(sigma);
}

// --- what is printed ---

void print_camera(const FittedMounting& mounting, const RigCamera& stated) {
  to_stdout("{}: {} pictures of tags{}\n", mounting.camera, mounting.tags,
            mounting.left_out == 0 ? std::string()
                                   : fmt::format(", {} more contradict the rest and were left out",
                                                 mounting.left_out));
  const std::array<double, 6> before = values_of(stated.vehicle_from_camera);
  const std::array<double, 6> after = values_of(mounting.vehicle_from_camera);
  for (std::size_t i = 0; i < kParameters.size(); ++i) {
    const bool is_angle = i >= 3;
    const std::string unit = is_angle ? "deg" : "m";
    if (mounting.held[i]) {
      const CalibrationSigma& known = stated.calibration_sigma;
      to_stdout(
          "  {:<5} {:>10.4f} {:<3}  held: the run does not tell it, the rig has it to {:.4f}\n",
          kParameters[i], after[i], unit, is_angle ? degrees(known.angle) : known.position);
    } else {
      to_stdout("  {:<5} {:>10.4f} {:<3}  +-{:.4f}, the rig says {:.4f}\n", kParameters[i],
                after[i], unit, sigma_of(mounting, i), before[i]);
    }
  }
}

void print_words(const MountingFit& fit, const SurveyedRun& input) {
  for (std::size_t c = 0; c < fit.cameras.size(); ++c) {
    print_camera(fit.cameras[c], input.rig.cameras[c]);
  }
  for (const FittedRange& range : fit.ranges) {
    to_stdout("range {}: reads {:+.1f} mm too much, +-{:.1f} mm ({} rows)\n", range.name,
              1e3 * range.offset, 1e3 * range.sigma, range.rows);
  }
  to_stdout(
      "{} of {} rows used, at {} 0.4 m and more apart; residuals {:.2f} times what was stated\n"
      "Forward is the mean direction of these rows along the center line, level their mean stance "
      "on the floor.\n",
      fit.rows, input.run.measurements.size(), counted(fit.places_apart, "place"),
      fit.sigma_factor);
  constexpr std::size_t kEnough = 10;
  if (fit.places_apart >= kEnough) return;
  to_stdout(
      "A vehicle stands alike in rows that are close together: drive past {} places and more, "
      "which "
      "makes forward and level surer.\n",
      kEnough);
}

Json camera_json(const FittedMounting& mounting, const RigCamera& stated) {
  Json line{{"camera", mounting.camera}, {"tags", mounting.tags}, {"left_out", mounting.left_out}};
  const std::array<double, 6> before = values_of(stated.vehicle_from_camera);
  const std::array<double, 6> after = values_of(mounting.vehicle_from_camera);
  for (std::size_t i = 0; i < kParameters.size(); ++i) {
    line[kParameters[i]] = {{"value", after[i]},
                            {"sigma", sigma_of(mounting, i)},
                            {"stated", before[i]},
                            {"held", mounting.held[i]}};
  }
  return line;
}

void print_json(const MountingFit& fit, const SurveyedRun& input) {
  for (std::size_t c = 0; c < fit.cameras.size(); ++c) {
    to_stdout("{}\n", json_text(camera_json(fit.cameras[c], input.rig.cameras[c])));
  }
  const auto range_json = [](const FittedRange& range) -> Json {
    return {{"range", range.name},
            {"offset", range.offset},
            {"sigma", range.sigma},
            {"rows", range.rows}};
  };
  to_stdout("{}\n", json_text({{"summary",
                                {{"rows", input.run.measurements.size()},
                                 {"rows_used", fit.rows},
                                 {"places_apart", fit.places_apart},
                                 {"chi_square", fit.chi_square},
                                 {"degrees_of_freedom", fit.degrees_of_freedom},
                                 {"sigma_factor", fit.sigma_factor},
                                 {"ranges", json_list(fit.ranges, range_json)}}}}));
}

// --- the rig that is written ---

// The sigma of a camera's place (parameters 0 to 2) or of its turn (3 to 5) on the vehicle, by the
// one that is known least. What the run does not tell, a camera is held in, and the others are
// known relative to it alone: the rig's own sigma of that camera remains in all of them.
double sigma_on_vehicle(const MountingFit& fit, const Rig& rig, const FittedMounting& mounting,
                        std::size_t first) {
  double largest = 0;
  for (std::size_t i = first; i < first + 3; ++i) {
    double held = 0;
    for (std::size_t c = 0; c < fit.cameras.size(); ++c) {
      const CalibrationSigma& stated = rig.cameras[c].calibration_sigma;
      if (fit.cameras[c].tags == 0 || !fit.cameras[c].held[i]) continue;
      held = std::max(held, i < 3 ? stated.position : stated.angle);
    }
    largest = std::max(largest, std::hypot(mounting.sigma[static_cast<Eigen::Index>(i)], held));
  }
  return largest;
}

Result<void> write_rig(const CalibrateMountingOptions& options, const MountingFit& fit,
                       const Rig& rig) {
  auto text = read_file(options.rig);
  if (!text) return fail(text);
  for (const FittedMounting& mounting : fit.cameras) {
    if (mounting.tags == 0) continue;
    const Pose& pose = mounting.vehicle_from_camera;
    auto changed = rig_with_mounting(
        *text, mounting.camera,
        {mounting_angles(pose), pose.translation, sigma_on_vehicle(fit, rig, mounting, 0),
         sigma_on_vehicle(fit, rig, mounting, 3)});
    if (!changed) return fail(options.rig.string() + ": " + changed.error().message);
    text = std::move(changed);
  }
  const Diagnosed<Rig> reading = read_rig_text(options.output, *text);
  if (!reading.value) {
    return fail(options.rig.string() + ": the mounting cannot be written into it: " +
                to_string(reading.diagnostics, true));
  }
  return write_file(options.output, *text);
}

// A camera that looks in the opposite direction to the rig's; empty where there is none.
std::string camera_of_other_side(const MountingFit& fit, const Rig& rig) {
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    if (!camera.side) continue;
    const double to_the_left = fit.cameras[i].vehicle_from_camera.rotation(1, 2);
    const Side side = to_the_left > 0 ? Side::left : Side::right;
    if (side == *camera.side) continue;
    return fmt::format(
        "camera {} looks to the {} by its photos, and the rig says side: {}; are the photos of two "
        "cameras exchanged?",
        camera.name, to_string(side), to_string(*camera.side));
  }
  return {};
}

// A camera of which more than a third of the pictures contradict the rest; empty where there is
// none.
std::string camera_of_contradictions(const MountingFit& fit) {
  for (const FittedMounting& camera : fit.cameras) {
    if (2 * camera.left_out <= camera.tags) continue;
    return fmt::format(
        "{} of {} pictures of tags of camera {} contradict the rest: are they of other rows, as of "
        "a camera that lags, or is the survey wrong?",
        camera.left_out, camera.left_out + camera.tags, camera.camera);
  }
  return {};
}

// A camera that certainly stands elsewhere than the rig states; empty where there is none. In
// photos that are mirrored, cameras come out at other heights, and nothing else shows the
// mirroring.
std::string camera_of_other_place(const MountingFit& fit, const Rig& rig) {
  constexpr double kSure = 4;  // standard deviations
  constexpr std::array<std::array<const char*, 2>, 3> kWays{
      {{"behind", "ahead of"}, {"to the right of", "to the left of"}, {"below", "above"}}};
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const FittedMounting& found = fit.cameras[c];
    const RigCamera& stated = rig.cameras[c];
    const Eigen::Vector3d moved =
        found.vehicle_from_camera.translation - stated.vehicle_from_camera.translation;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double known = stated.calibration_sigma.position;
      const bool is_held = found.tags == 0 || found.held[static_cast<std::size_t>(i)];
      if (is_held || std::abs(moved[i]) <= kSure * std::hypot(known, found.sigma[i])) continue;
      return fmt::format(
          "camera {} stands {:.3f} m {} where the rig states it, which is known to {:.3f} m{}: "
          "measure its place with a tape, or state how well it is known (sigma.position); photos "
          "that are mirrored look so",
          stated.name, std::abs(moved[i]), kWays[static_cast<std::size_t>(i)][moved[i] > 0 ? 1 : 0],
          known, stated.assumed_sigma.empty() ? "" : " (assumed)");
    }
  }
  return {};
}

// Says which photos could not be read; whether there are any.
bool report_unread_photos(const std::vector<Observation>& rows) {
  bool lacks = false;
  for (const Observation& row : rows) {
    if (!row.lacks_picture) continue;
    lacks = true;
    for (const std::string& fault : row.faults) {
      to_stderr("tagsmith calibrate: row {}: {}\n", row.id, fault);
    }
  }
  return lacks;
}

}  // namespace

Result<int> calibrate_mounting(const CalibrateMountingOptions& options) {
  const Result<SurveyedRun> input = load_surveyed_run(options.survey, options.rig, options.run);
  if (!input) return fail(input);
  if (auto usable = check_files(options, *input); !usable) return fail(usable);
  const std::vector<Survey> surveys{input->survey};
  const ReaderChoice reader{read_tags, kFittedCornerSigmaPx};
  std::vector<Observation> rows =
      observe_run(input->run, surveys, input->rig, reader, options.jobs);
  const bool lacks_pictures = report_unread_photos(rows);
  const auto refuse = [&](const std::string& why) {
    to_stderr("tagsmith calibrate: {}: {}\n", options.run.string(), why);
    return kExitFindings;
  };
  const std::string exchanged = leave_out_altered(rows, surveys, input->rig);
  if (!exchanged.empty()) return refuse(exchanged);
  const Result<MountingFit> fit = fit_mounting(rows, input->survey, input->rig);
  if (!fit) return refuse(fit.error().message);
  const std::string wrong_side = camera_of_other_side(*fit, input->rig);
  if (!wrong_side.empty()) return refuse(wrong_side);
  options.json ? print_json(*fit, *input) : print_words(*fit, *input);
  if (!options.output.empty()) {
    const auto written = write_rig(options, *fit, input->rig);
    if (!written) return fail(written);
  }
  std::string doubt = camera_of_contradictions(*fit);
  if (doubt.empty()) doubt = camera_of_other_place(*fit, input->rig);
  if (!doubt.empty()) return refuse("do not rely on this mounting: " + doubt);
  return lacks_pictures ? kExitFindings : kExitOk;
}

}  // namespace tagsmith::detail
