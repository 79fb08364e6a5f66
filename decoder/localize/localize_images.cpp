// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/localize_images.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <Eigen/Core>

#include "decoder/localize/joint_method.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// An image and how far it has been searched.
struct Look {
  const CameraImage* image = nullptr;
  TagSearch search;
  bool closer = false;
};

// The images that can be read; for the others a fault is added.
std::vector<Look> begin_looks(std::span<const CameraImage> images,
                              const std::vector<Survey>& surveys,
                              const std::optional<PosePrior>& prior, Observation& observation) {
  std::vector<Look> looks;
  for (const CameraImage& image : images) {
    const auto options =
        read_options_for_image(image.image, image.name, *image.camera, surveys, prior);
    if (options) {
      looks.push_back({&image, TagSearch(image.image, *options)});
    } else {
      observation.faults.push_back(options.error().message);
    }
  }
  return looks;
}

// What is known already together with what these searches found.
Observation observed(Observation observation, const std::vector<Look>& looks,
                     const std::vector<Survey>& surveys) {
  const ReaderChoice reader{read_tags, kFittedCornerSigmaPx};
  for (const Look& look : looks) {
    add_result(observation, look.search.result(), look.image->name, *look.image->camera, surveys,
               reader);
  }
  return observation;
}

// Whether what was dropped is a range outside its sensor's limits (no echo), which says nothing.
bool is_no_echo(const Dropped& dropped, const std::map<std::string, double>& ranges,
                const Rig& rig) {
  if (!dropped.camera.empty()) return false;
  const auto range = std::ranges::find(rig.ranges, dropped.name, &RigRange::name);
  const auto measured = ranges.find(dropped.name);
  return range != rig.ranges.end() && measured != ranges.end() &&
         !(measured->second >= range->min && measured->second <= range->max);
}

// Whether everything measured agrees on a position by several tags.
// Why: docs/decisions/0008-search-and-its-cost.md.
bool is_settled(const Fix& fix, const std::vector<Look>& looks,
                const std::map<std::string, double>& ranges, const Rig& rig) {
  const auto says_nothing = [&](const Dropped& dropped) {
    return is_no_echo(dropped, ranges, rig);
  };
  if (!fix.position_in_grid || fix.tags.size() < 2) return false;
  if (!std::ranges::all_of(fix.dropped, says_nothing)) return false;
  std::size_t seen = 0;
  for (const Look& look : looks) seen += look.search.tags().size();
  const auto whole = std::ranges::count(fix.corners, false, &FittedCorners::is_part);
  return seen == static_cast<std::size_t>(whole);  // none that the fix does not know of
}

// Whether a point lies in the image, as far from its border as the reader needs bars to be.
bool is_well_inside(const Camera& camera, const Eigen::Vector2d& pixel) {
  constexpr double kBorder = 12;  // pixels
  const Eigen::Vector2d margin(kBorder, kBorder);
  return in_image(camera, pixel - margin) && in_image(camera, pixel + margin);
}

// Whether a camera has a plate's bars, and the white beside them that the reader needs, wholly in
// its image, from the front and large enough to be read with certainty.
bool is_readable(const Camera& camera, const Pose& camera_from_plate, const TagTemplate& tag) {
  constexpr double kLeastModule = 0.7;  // pixels
  constexpr double kBeside = 0.08;      // of the bars' length
  // The plate's z axis points into the wall: its printed side is seen from where z is negative.
  if (inverse(camera_from_plate).translation.z() >= 0) return false;
  const SymbolLayout layout = layout_of(tag);
  const double left = layout.width_share(-kBeside * kModuleCount) * tag.frame_inner_length;
  const double right = tag.frame_inner_length - left;
  const double top = layout.bars_top * tag.frame_inner_height;
  const double bottom = layout.bars_bottom * tag.frame_inner_height;
  const std::array<Eigen::Vector3d, 4> bars{
      {{left, top, 0}, {right, top, 0}, {right, bottom, 0}, {left, bottom, 0}}};
  std::array<Eigen::Vector2d, 4> pixels;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = project(camera, camera_from_plate * bars[i]);
    if (!pixel || !is_well_inside(camera, *pixel)) return false;
    pixels[i] = *pixel;
  }
  const double length = std::min((pixels[1] - pixels[0]).norm(), (pixels[2] - pixels[3]).norm());
  return length >= kLeastModule * (1 + 2 * kBeside) * kModuleCount;
}

// Whether a survey has a tag that should have been read in an image and was not.
bool misses_any(const Look& look, const Fix& fix, const std::vector<Survey>& surveys) {
  const RigCamera& camera = *look.image->camera;
  const Pose camera_from_world =
      inverse(world_from_vehicle(fix, surveys.front().grid) * camera.vehicle_from_camera);
  return std::ranges::any_of(surveys, [&](const Survey& survey) {
    return std::ranges::any_of(survey.tags, [&](const PlacedTag& tag) {
      const auto is_it = [&](const Reading& reading) { return reading.digits == tag.digits; };
      return is_readable(camera.camera, camera_from_world * tag.world_from_plate,
                         survey.tag_template) &&
             std::ranges::none_of(look.search.tags(), is_it);
    });
  });
}

// Looks closer at the images that may hold more than this fix knows of; whether there were any.
bool look_closer(std::vector<Look>& looks, const Fix& fix, bool settled,
                 const std::vector<Survey>& surveys) {
  bool any = false;
  for (Look& look : looks) {
    const bool enough = settled && !misses_any(look, fix, surveys);
    if (look.closer || enough) continue;
    look.search.look_closer();
    look.closer = true;
    any = true;
  }
  return any;
}

}  // namespace

Fix localize_images(Observation& known, std::span<const CameraImage> images,
                    const std::vector<Survey>& surveys, const Rig& rig,
                    const std::optional<PosePrior>& prior) {
  std::vector<Look> looks = begin_looks(images, surveys, prior, known);
  Observation seen;
  Fix fix;
  do {
    seen = observed(known, looks, surveys);
    fix = localize_jointly(seen, surveys, rig);
  } while (look_closer(looks, fix, is_settled(fix, looks, known.ranges, rig), surveys));
  known = std::move(seen);
  return fix;
}

}  // namespace tagsmith::detail
