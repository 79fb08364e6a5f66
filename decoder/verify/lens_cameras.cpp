// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/lens_cameras.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {
namespace {

// Why: docs/decisions/0014-camera-calibration.md.
CalibrationSigma sigma_by_lens(int width) {
  CalibrationSigma sigma;
  sigma.edge = usual_calibration(IntrinsicsSource::data_sheet, Camera{}).edge;
  sigma.focal = 0.1;
  sigma.center = 0.02 * width;
  sigma.radial = 0.05;
  sigma.focal_drift = 0.01;
  sigma.center_drift = 0.005 * width;
  sigma.warp = 0.001 * width;
  return sigma;
}

}  // namespace

RigCamera camera_by_lens(int width, int height, double focal_35_mm) {
  constexpr double kFilmDiagonal = 43.267;  // millimetres: 36 x 24
  RigCamera camera;
  const double focal = focal_35_mm / kFilmDiagonal * std::hypot(width, height);
  camera.camera = {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
  camera.vehicle_from_camera = vehicle_from_camera(0, 0, 0, Eigen::Vector3d::Zero());
  camera.calibration_sigma = sigma_by_lens(width);
  return camera;
}

Result<HangingSetup> hanging_by_lenses(const EachFile& files, double tolerance) {
  HangingSetup setup;
  setup.tolerance = tolerance;
  setup.by_lenses = true;
  setup.rig.name = "cameras by EXIF";
  setup.rig.roll_sigma = setup.rig.pitch_sigma = std::numbers::pi;
  std::map<std::tuple<PhotoLens, int, int>, std::size_t> known;
  const auto read = files([&](const VerifiedFile& file) {
    if (!file.is_photo() || !file.lens) return;
    const auto [entry, is_new] =
        known.try_emplace({*file.lens, file.width, file.height}, setup.rig.cameras.size());
    if (is_new) {
      RigCamera camera = camera_by_lens(file.width, file.height, file.lens->focal_35_mm);
      camera.name = fmt::format("{} of {:.0f} mm, {} x {}", file.lens->camera,
                                file.lens->focal_35_mm, file.width, file.height);
      setup.rig.cameras.push_back(std::move(camera));
    }
    setup.cameras.add(file.file, entry->second);
  });
  if (!read) return fail(read);
  return setup;
}

}  // namespace tagsmith::detail
