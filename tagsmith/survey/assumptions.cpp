// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/assumptions.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/side_line.hpp"

namespace tagsmith::detail {

double usual_angle_sigma(const Tunnel& tunnel, const TagTemplate& tag) {
  const double rough = std::max(side_roughness(tunnel.left, tag.plate_length),
                                side_roughness(tunnel.right, tag.plate_length));
  return radians(std::round(10 * degrees(std::hypot(kUsualAngleSigma, rough))) / 10);
}

double usual_angle_sigma(const Survey& survey) {
  const bool follow = std::ranges::any_of(
      survey.tags, [](const PlacedTag& tag) { return !tag.attitude || !tag.attitude->facing; });
  return follow ? usual_angle_sigma(survey.tunnel, survey.tag_template) : kUsualAngleSigma;
}

double radial_by_corners(double distortion, const Camera& camera) {
  if (camera.fx <= 0 || camera.fy <= 0) return 0;
  const double corner = std::hypot(camera.width / camera.fx, camera.height / camera.fy) / 2;
  return distortion / (corner * corner);
}

CalibrationSigma usual_calibration(IntrinsicsSource source, const Camera& camera) {
  CalibrationSigma sigma{.position = 0.005, .angle = radians(0.5), .edge = 0.1};
  switch (source) {
    case IntrinsicsSource::data_sheet:
      sigma.focal = 0.02;
      sigma.center = 0.01 * camera.width;
      sigma.radial = radial_by_corners(kUsualDistortion, camera);
      break;
    case IntrinsicsSource::numbers:
      sigma.focal = 0.002;
      sigma.center = 2;
      break;
    case IntrinsicsSource::calibration_file:
      sigma.focal = 0.001;
      sigma.center = 1;
      break;
  }
  return sigma;
}

bool states_sigma_of(const Survey& survey, const PlacedTag& tag) {
  return survey.states_sigma || tag.sigma != survey.sigma;
}

bool states_every_sigma(const Survey& survey) {
  return std::ranges::all_of(survey.tags,
                             [&](const PlacedTag& tag) { return states_sigma_of(survey, tag); });
}

std::optional<std::string> assumed_sigma(const Survey& survey) {
  if (states_every_sigma(survey)) return std::nullopt;
  return fmt::format("survey {} states no sigma: {} mm assumed", survey.name,
                     format_number(1000 * survey.sigma));
}

// Cameras of which nothing is said are assumed to have global shutters, which are triggered
// together: of cameras that drive, or may drive, as nobody says. Cameras whose place is known
// exactly took no real pictures.
std::optional<std::string> assumed_shutter(const Rig& rig, std::optional<double> speed) {
  if (!speed && rig.envelope) speed = rig.envelope->speed;
  if (!speed && (has_rolling_shutter(rig) || has_delay(rig))) {
    return fmt::format("rig {} has a {} and states no speed (vehicle.envelope): {} m/s assumed",
                       rig.name, has_rolling_shutter(rig) ? "readout" : "delay",
                       format_number(kUsualSpeed));
  }
  if (speed == 0) return std::nullopt;
  std::vector<std::string> unread, untimed;
  for (const RigCamera& camera : rig.cameras) {
    const bool drives = speed || camera.calibration_sigma.position > 0;
    if (drives && !camera.readout) unread.push_back(camera.name);
    if (drives && !camera.delay && rig.cameras.size() > 1) untimed.push_back(camera.name);
  }
  if (!unread.empty() && unread == untimed) {
    return fmt::format(
        "rig {} states no readout and no delay of camera {}: global shutters, triggered together, "
        "assumed",
        rig.name, fmt::join(unread, ", "));
  }
  std::vector<std::string> assumed;
  if (!unread.empty()) {
    assumed.push_back(
        fmt::format("no readout of camera {}: a global shutter", fmt::join(unread, ", ")));
  }
  if (!untimed.empty()) {
    assumed.push_back(
        fmt::format("no delay of camera {}: photos of one moment", fmt::join(untimed, ", ")));
  }
  if (assumed.empty()) return std::nullopt;
  return fmt::format("rig {} states {} assumed", rig.name, fmt::join(assumed, ", and "));
}

// Cameras with the same assumption share a sentence.
std::vector<std::string> assumed_calibration(const Rig& rig, std::optional<double> speed) {
  std::vector<std::pair<std::string, std::vector<std::string>>> cameras;
  for (const RigCamera& camera : rig.cameras) {
    if (camera.assumed_sigma.empty()) continue;
    auto same =
        std::ranges::find(cameras, camera.assumed_sigma, [](auto& entry) { return entry.first; });
    if (same == cameras.end()) same = cameras.insert(same, {camera.assumed_sigma, {}});
    same->second.push_back(camera.name);
  }
  std::vector<std::string> sentences;
  for (const auto& [assumed, names] : cameras) {
    sentences.push_back(
        fmt::format("rig {} does not state the whole sigma of camera {}: {} assumed", rig.name,
                    fmt::join(names, ", "), assumed));
  }
  if (auto shutter = assumed_shutter(rig, speed)) sentences.push_back(std::move(*shutter));
  return sentences;
}

std::vector<std::string> assumptions(std::span<const Survey> surveys, const Rig& rig,
                                     std::optional<double> speed) {
  std::vector<std::string> all;
  for (const Survey& survey : surveys) {
    if (auto sigma = assumed_sigma(survey)) all.push_back(std::move(*sigma));
    if (survey.states_angle_sigma) continue;
    all.push_back(fmt::format("survey {} states no angle_sigma: {} degrees assumed", survey.name,
                              format_number(degrees(survey.angle_sigma))));
  }
  std::ranges::move(assumed_calibration(rig, speed), std::back_inserter(all));
  return all;
}

}  // namespace tagsmith::detail
