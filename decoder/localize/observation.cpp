// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/observation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "decoder/reader/read_options.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {
namespace {

std::vector<SurveyedTag> find_by(const std::vector<Survey>& surveys, const auto& key) {
  std::vector<SurveyedTag> found;
  for (std::size_t i = 0; i < surveys.size(); ++i) {
    if (const PlacedTag* tag = find_tag(surveys[i], key)) found.push_back({i, tag});
  }
  return found;
}

std::string no_tag_read(const std::string& image, const ReadResult& result) {
  const std::vector<Rejection>& rejected = result.rejected;
  std::string text = image + ": no tag read";
  if (!rejected.empty()) text += " (" + describe(rejected.front());
  if (rejected.size() > 1) text += fmt::format(", and {} more candidates", rejected.size() - 1);
  if (!rejected.empty()) text += ")";
  return text;
}

SeenCorners corners_in(const Reading& reading, const ReaderChoice& reader) {
  return seen_corners(reading.corners, reading.corner_covariance, reader.corner_sigma_px);
}

// A tag that no survey has, hung where its digits say: on the wall nearest to that place. Nothing
// when that is on no wall.
std::optional<PlacedTag> at_coded_place(const Survey& survey, const Digits& digits) {
  constexpr double kFromWall = 0.1;  // metres; coding rounds by less
  const GridPoint coded = decode_position(survey.code, digits);
  const Eigen::Vector3d p_in_grid(coded[0], coded[1], coded[2]);
  const Eigen::Vector3d p = world_from_grid(survey.grid, p_in_grid);
  const CenterlineAddress address = survey.tunnel.centerline.locate(p.head<2>());
  const Side side = address.offset < 0 ? Side::left : Side::right;
  if (std::abs(behind_wall(survey.tunnel, side, address)) > kFromWall) return std::nullopt;
  PlacedTag tag = with_digits(place_surveyed(survey, {0, side}, p_in_grid), survey.code, digits);
  tag.name = to_string(digits);
  tag.surveyed = false;
  return tag;
}

void add_unsurveyed(Observation& observation, const RigCamera& camera, const Survey& survey,
                    const Reading& reading, const ReaderChoice& reader) {
  const std::optional<PlacedTag> tag = at_coded_place(survey, reading.digits);
  if (!tag) {
    observation.faults.push_back(
        fmt::format("tag {} is not in the survey, and its coded position is on no wall",
                    to_string(reading.digits)));
    return;
  }
  observation.tags.push_back(
      {camera.name, 0, *tag, corners_in(reading, reader), std::nullopt, true});
}

void add_parts(Observation& observation, const ReadResult& result, const RigCamera& camera,
               const std::vector<Survey>& surveys) {
  for (const PartReading& reading : result.parts) {
    const SeenCorners seen = seen_corners(reading.corners, reading.corner_covariance);
    if (reading.shows_all_bars) {
      for (const auto& [survey, tag] : find_tags(surveys, reading.candidates.front().digits)) {
        observation.tags.push_back({camera.name, survey, *tag, seen, std::nullopt});
      }
      continue;
    }
    SeenPart part{camera.name, {}, seen, reading.share};
    for (const PartCandidate& candidate : reading.candidates) {
      std::ranges::copy(find_tags(surveys, candidate.digits), std::back_inserter(part.candidates));
    }
    if (!part.candidates.empty()) observation.parts.push_back(std::move(part));
  }
}

}  // namespace

bool are_of_one_place(const Observation& first, const Observation& second) {
  bool shown = false;
  for (const SeenTag& seen : first.tags) {
    if (!seen.seen_corners) continue;
    const auto again = std::ranges::find_if(second.tags, [&](const SeenTag& other) {
      return other.seen_corners && other.camera == seen.camera && other.survey == seen.survey &&
             other.tag.name == seen.tag.name;
    });
    if (again == second.tags.end()) continue;
    const FrameCorners& before = seen.seen_corners->corners;
    const FrameCorners& after = again->seen_corners->corners;
    const double limit =
        std::max(distance(before[0], before[1]), distance(before[0], before[3])) / 4;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (distance(before[i], after[i]) > limit) return false;
    }
    shown = true;
  }
  return shown;
}

std::vector<SurveyedTag> find_tags(const std::vector<Survey>& surveys, const Digits& digits) {
  return find_by(surveys, digits);
}

std::vector<SurveyedTag> find_tags(const std::vector<Survey>& surveys, std::string_view name) {
  return find_by(surveys, name);
}

SeenCorners seen_corners(const FrameCorners& corners, const CornerCovariance& covariance,
                         double sigma_px) {
  SeenCorners seen{corners, sigma_px, covariance};
  if (covariance.isZero()) seen.covariance = sigma_px * sigma_px * CornerCovariance::Identity();
  return seen;
}

SightedPlate sighted_plate(const PlacedTag& tag, const Survey& survey) {
  SightedPlate plate;
  plate.name = tag.name;
  plate.side = tag.side;
  plate.world_from_plate = tag.world_from_plate;
  plate.length = survey.tag_template.frame_inner_length;
  plate.height = survey.tag_template.frame_inner_height;
  plate.survey_variance.head<3>().setConstant(tag.sigma * tag.sigma);
  plate.survey_variance.tail<3>().setConstant(survey.angle_sigma * survey.angle_sigma);
  return plate;
}

namespace {

// The covariance of corners in an image that is warped smoothly: over distances that are small
// compared with the image, points are moved alike.
CornerCovariance covariance_of_warp(const Sighting& sighting, const Camera& camera, double warp) {
  constexpr double kAlike = 0.3;  // of the distance from the centre to a corner of the image
  const Eigen::Vector2d center(camera.cx, camera.cy);
  const double radius = std::hypot(camera.width, camera.height) / 2;
  CornerCovariance covariance = CornerCovariance::Zero();
  for (Eigen::Index i = 0; i < 8; i += 2) {
    for (Eigen::Index j = 0; j < 8; j += 2) {
      const Eigen::Vector2d a = (sighting.pixels.segment<2>(i) - center) / radius;
      const Eigen::Vector2d b = (sighting.pixels.segment<2>(j) - center) / radius;
      const double grown = std::pow(a.norm() * b.norm(), 3);
      const double alike = std::exp(-(a - b).squaredNorm() / (2 * kAlike * kAlike));
      covariance.block<2, 2>(i, j) = warp * warp * grown * alike * Eigen::Matrix2d::Identity();
    }
  }
  return covariance;
}

}  // namespace

Sighting sighting_of(const SeenCorners& seen, const Rig& rig, std::size_t camera,
                     std::size_t plate) {
  Sighting sighting;
  sighting.camera = camera;
  sighting.plate = plate;
  for (std::size_t i = 0; i < 4; ++i) {
    sighting.pixels.segment<2>(static_cast<Eigen::Index>(2 * i)) << seen.corners[i].x,
        seen.corners[i].y;
  }
  sighting.covariance = seen.covariance;
  const Camera& by = rig.cameras[camera].camera;
  const CalibrationSigma& sigma = rig.cameras[camera].calibration_sigma;
  if (sigma.edge > 0) sighting.by_edges = sigma.edge * by_outward_edges(sighting.pixels);
  if (sigma.warp > 0) sighting.covariance += covariance_of_warp(sighting, by, sigma.warp);
  for (Eigen::Index row = 0; row < 8; ++row) {
    const bool is_u = row % 2 == 0;
    const double from_center = sighting.pixels[row] - (is_u ? by.cx : by.cy);
    sighting.by_drift.row(row) << sigma.focal_drift * from_center, is_u ? sigma.center_drift : 0,
        is_u ? 0 : sigma.center_drift;
  }
  return sighting;
}

Result<ReadOptions> read_options_for_image(const GrayView& image, const std::string& name,
                                           const RigCamera& camera,
                                           const std::vector<Survey>& surveys,
                                           const std::optional<PosePrior>& prior) {
  if (image.width != camera.camera.width || image.height != camera.camera.height) {
    return fail(fmt::format("{}: is {} x {} pixels, expected {} x {} as the rig's camera {} has",
                            name, image.width, image.height, camera.camera.width,
                            camera.camera.height, camera.name));
  }
  ReadOptions options = read_options_for(surveys);
  options.camera = camera.camera;
  if (prior) options.expected = expected_tags(*prior, surveys, camera);
  return options;
}

void add_result(Observation& observation, const ReadResult& result, const std::string& name,
                const RigCamera& camera, const std::vector<Survey>& surveys,
                const ReaderChoice& reader) {
  add_parts(observation, result, camera, surveys);
  if (result.tags.empty() && result.parts.empty()) {
    observation.faults.push_back(no_tag_read(name, result));
  }
  for (const Reading& reading : result.tags) {
    const auto found = find_tags(surveys, reading.digits);
    if (found.empty() && reader.unsurveyed) {
      add_unsurveyed(observation, camera, surveys.front(), reading, reader);
    }
    for (const auto& [survey, tag] : found) {
      observation.tags.push_back(
          {camera.name, survey, *tag, corners_in(reading, reader), std::nullopt});
    }
  }
}

void observe_image(Observation& observation, const RigCamera& camera, const GrayView& image,
                   const std::string& name, const std::vector<Survey>& surveys,
                   const ReaderChoice& reader, const std::optional<PosePrior>& prior) {
  auto options = read_options_for_image(image, name, camera, surveys, prior);
  if (!options) {
    observation.faults.push_back(options.error().message);
    return;
  }
  if (reader.unsurveyed) options->code_book.clear();
  if (surveys.front().tags.empty()) options->check.reset();  // no survey says which
  add_result(observation, reader.read(image, *options), name, camera, surveys, reader);
}

void leave_out_pictures(Observation& observation, const std::set<std::string>& cameras,
                        std::string fault) {
  std::erase_if(observation.tags, [&](const SeenTag& seen) {
    return seen.seen_corners && cameras.contains(seen.camera);
  });
  std::erase_if(observation.parts,
                [&](const SeenPart& seen) { return cameras.contains(seen.camera); });
  observation.faults.push_back(std::move(fault));
  observation.has_left_out = true;
}

}  // namespace tagsmith::detail
