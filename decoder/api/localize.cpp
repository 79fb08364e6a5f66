// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include <tagsmith/localize.hpp>

#include "decoder/api/data.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/localize_images.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/repeated_pictures.hpp"
#include "decoder/plates/live_drive.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/survey/check_together.hpp"

namespace tagsmith {
namespace {

using detail::throw_invalid;

const detail::RigCamera& camera_of(const detail::Rig& rig, const std::string& name) {
  const detail::RigCamera* camera = find_camera(rig, name);
  if (camera == nullptr) throw_invalid("the rig has no camera `" + name + "`");
  return *camera;
}

void check_ranges(const std::map<std::string, double>& ranges, const detail::Rig& rig) {
  for (const auto& [name, metres] : ranges) {
    const bool known =
        std::ranges::find(rig.ranges, name, &detail::RigRange::name) != rig.ranges.end();
    if (!known) throw_invalid("the rig has no range `" + name + "`");
    if (!std::isfinite(metres)) throw_invalid("range " + name + " is no number");
  }
}

// Refuses a matrix that is no covariance: it would give a position without any information.
detail::CornerCovariance covariance_from(const SeenTag& tag) {
  if (!tag.covariance) return detail::CornerCovariance::Zero();
  detail::CornerCovariance covariance = detail::eigen_from<8>(*tag.covariance);
  const bool symmetric = (covariance - covariance.transpose()).cwiseAbs().maxCoeff() <=
                         1e-9 * covariance.cwiseAbs().maxCoeff();
  if (!covariance.allFinite() || !symmetric || !detail::cholesky_root(covariance)) {
    throw_invalid("the covariance of tag " + tag.digits +
                  " is none: expected a symmetric matrix that is positive definite");
  }
  return covariance;
}

void add_tag(const SeenTag& tag, const std::vector<detail::Survey>& surveys, const detail::Rig& rig,
             detail::Observation& observation) {
  const detail::RigCamera& camera = camera_of(rig, tag.camera);
  const detail::Digits digits = detail::checked_digits(tag.digits, "the digits of a seen tag");
  for (const Point& corner : tag.corners) {
    detail::check_number("a corner of tag " + tag.digits, corner.x, -1e9, 1e9);
    detail::check_number("a corner of tag " + tag.digits, corner.y, -1e9, 1e9);
  }
  const auto found = detail::find_tags(surveys, digits);
  if (found.empty()) observation.faults.push_back("tag " + tag.digits + " is in no survey");
  for (const detail::SurveyedTag& one : found) {
    const auto corners = detail::frame_corners_from(tag.corners);
    observation.tags.push_back({camera.name, one.survey, *one.tag,
                                detail::seen_corners(corners, covariance_from(tag)), std::nullopt});
  }
}

// What is known of a measurement before its images are read.
detail::Observation observation_from(const Measurement& measurement,
                                     const std::vector<detail::Survey>& surveys,
                                     const detail::Rig& rig) {
  check_ranges(measurement.ranges, rig);
  detail::Observation observation{measurement.id, {}, measurement.ranges, {}};
  for (const SeenTag& tag : measurement.tags) add_tag(tag, surveys, rig, observation);
  return observation;
}

std::vector<detail::CameraImage> images_from(const Measurement& measurement,
                                             const detail::Rig& rig) {
  std::vector<detail::CameraImage> images;
  for (const CameraView& view : measurement.images) {
    const detail::RigCamera& camera = camera_of(rig, view.camera);
    images.push_back({&camera, detail::checked(view.image), "image of camera " + view.camera});
  }
  return images;
}

std::vector<Dropped> dropped_from(const std::vector<detail::Dropped>& dropped) {
  std::vector<Dropped> all;
  all.reserve(dropped.size());
  for (const detail::Dropped& one : dropped) all.push_back({one.name, one.camera, one.reason});
  return all;
}

std::vector<Unchecked> unchecked_from(const std::vector<detail::Unchecked>& unchecked) {
  std::vector<Unchecked> all;
  all.reserve(unchecked.size());
  for (const detail::Unchecked& one : unchecked) {
    all.push_back({detail::to_string(one.kind), one.name, one.metres});
  }
  return all;
}

Fix fix_from(const detail::Fix& located) {
  Fix fix;
  fix.id = located.id;
  if (located.position_in_grid) fix.position = detail::vector_from(*located.position_in_grid);
  if (located.covariance_in_grid) {
    fix.covariance = detail::matrix_from<3>(*located.covariance_in_grid);
  }
  if (const auto& stance = located.attitude) {
    fix.attitude = Attitude{stance->heading, stance->pitch, stance->roll};
  }
  if (located.pose_covariance_in_grid) {
    fix.pose_covariance = detail::matrix_from<6>(*located.pose_covariance_in_grid);
  }
  fix.reason = located.reason;
  fix.survey = located.survey;
  fix.tags = located.tags;
  fix.ranges = located.ranges;
  fix.dropped = dropped_from(located.dropped);
  fix.confirmations = located.confirmations;
  fix.chi_square = located.chi_square;
  fix.degrees_of_freedom = located.degrees_of_freedom;
  fix.unchecked = unchecked_from(located.unchecked);
  fix.notes = located.notes;
  return fix;
}

}  // namespace

struct Localizer::State {
  std::vector<detail::Survey> surveys;
  Rig rig;
  LocalizerOptions options;
  detail::LiveDrive drive{surveys, rig.data().rig};
  detail::PictureMemory pictures{};

  Fix answer(detail::Fix fix) const {
    return fix_from(options.confirmed_only ? if_confirmed(std::move(fix)) : fix);
  }
};

Localizer::Localizer(const std::vector<Survey>& surveys, Rig rig, const LocalizerOptions& options)
    : state_(new State{detail::surveys_from(surveys), std::move(rig), options}) {
  if (surveys.empty()) throw_invalid("there is no survey to be located in");
  if (const auto one = check_one_grid(state_->surveys); !one) throw_invalid(one.error().message);
}

Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;
Localizer::~Localizer() = default;

Fix Localizer::locate(const Measurement& measurement) const {
  const std::vector<detail::Survey>& surveys = state_->surveys;
  const detail::Rig& rig = state_->rig.data().rig;
  detail::Observation observation = observation_from(measurement, surveys, rig);
  const detail::ReaderChoice reader{detail::read_tags, detail::kFittedCornerSigmaPx};
  for (const detail::CameraImage& image : images_from(measurement, rig)) {
    observe_image(observation, *image.camera, image.image, image.name, surveys, reader);
  }
  return state_->answer(localize_jointly(observation, surveys, rig));
}

Fix Localizer::track(const Measurement& measurement) {
  if (measurement.time && !std::isfinite(*measurement.time)) throw_invalid("time is no number");
  const detail::Rig& rig = state_->rig.data().rig;
  const auto locate_in = [&](const std::vector<detail::Survey>& surveys,
                             const std::optional<detail::PosePrior>& prior,
                             detail::Observation& seen) {
    seen = observation_from(measurement, surveys, rig);
    seen.time = measurement.time;
    const auto images = state_->pictures.new_ones(images_from(measurement, rig), seen);
    return detail::localize_images(seen, images, surveys, rig, prior);
  };
  return state_->answer(state_->drive.next(locate_in, measurement.time));
}

void Localizer::reset() {
  state_->drive = detail::LiveDrive(state_->surveys, state_->rig.data().rig);
  state_->pictures = {};
}

}  // namespace tagsmith
