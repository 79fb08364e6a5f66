// SPDX-License-Identifier: Apache-2.0
// The parts of a survey and a rig that callers see, made once together with them.
#include <algorithm>
#include <iterator>
#include <utility>

#include "decoder/api/data.hpp"

namespace tagsmith {
namespace {

Side side_from(detail::Side side) { return side == detail::Side::left ? Side::left : Side::right; }

SurveyTag tag_from(const detail::PlacedTag& tag) {
  return {tag.name,
          detail::to_string(tag.digits),
          side_from(tag.side),
          detail::vector_from(tag.p_in_grid),
          detail::vector_from(tag.coded_in_grid),
          tag.chainage,
          tag.sigma,
          tag.surveyed};
}

PlateTemplate plate_from(const detail::TagTemplate& tag) {
  return {tag.name,
          tag.plate_length,
          tag.plate_height,
          tag.frame_inner_length,
          tag.frame_inner_height,
          tag.frame_stroke,
          tag.frame_offset_right,
          tag.frame_offset_up,
          tag.quiet_zone_modules,
          tag.margin_modules,
          tag.white_on_black};
}

CameraModel model_from(const detail::Camera& camera) {
  return {camera.width,
          camera.height,
          camera.fx,
          camera.fy,
          camera.cx,
          camera.cy,
          camera.distortion,
          camera.lens == detail::LensModel::fisheye ? LensModel::fisheye : LensModel::perspective};
}

CalibrationSigma sigma_from(const detail::CalibrationSigma& sigma) {
  return {sigma.position, sigma.angle, sigma.focal, sigma.center, sigma.edge};
}

RigCamera camera_from(const detail::RigCamera& camera) {
  RigCamera seen;
  seen.name = camera.name;
  seen.model = model_from(camera.camera);
  seen.vehicle_from_camera = {detail::matrix_from<3>(camera.vehicle_from_camera.rotation),
                              detail::vector_from(camera.vehicle_from_camera.translation)};
  if (camera.side) seen.side = side_from(*camera.side);
  seen.exposure = camera.exposure;
  seen.sigma = sigma_from(camera.calibration_sigma);
  return seen;
}

RigDescription description_of(const detail::Rig& rig) {
  RigDescription description;
  description.name = rig.name;
  for (const detail::RigCamera& camera : rig.cameras) {
    description.cameras.push_back(camera_from(camera));
  }
  for (const detail::RigRange& range : rig.ranges) {
    description.ranges.push_back(
        {range.name, side_from(range.wall), range.min, range.max, range.sigma});
  }
  description.vehicle_height = rig.vehicle_height;
  description.height_sigma = rig.height_sigma;
  description.roll_sigma = rig.roll_sigma;
  description.pitch_sigma = rig.pitch_sigma;
  if (const auto& stray = rig.envelope) {
    description.envelope =
        Envelope{stray->lateral, stray->yaw, stray->speed, stray->roll, stray->pitch};
  }
  return description;
}

}  // namespace

Survey::Data::Data(detail::Survey of)
    : survey(std::move(of)), plate(plate_from(survey.tag_template)) {
  std::ranges::transform(survey.tags, std::back_inserter(tags), tag_from);
}

Rig::Data::Data(detail::Rig of) : rig(std::move(of)), description(description_of(rig)) {}

}  // namespace tagsmith
