// SPDX-License-Identifier: Apache-2.0
// Which plates a rig's cameras see from a pose, how large, how obliquely, how sharply, and whether
// the reader reads them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/placement/reader_limits.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Blur of a camera whose rig does not state it, a standard deviation. Of tags through the chain
// `mild` of `simulate --camera-chain` (a phone's or webcam's denoising, sharpening and compression)
// 99 % are read from as many pixels a module on as of tags with this blur that are stored plainly.
// Why: docs/decisions/0012-planning.md.
inline constexpr double kUsualBlurPx = 1.0;

// Pixels that must lie between the feature frame's inner edge, which carries the corners, and the
// image's border: the reader does not need the whole stroke. Agreement: `./dev bench plan`.
inline constexpr double kBorderPx = 3;

// No plate farther from the camera than this is considered, whatever the lens: dust, dark and bends
// of the drive hide it long before.
inline constexpr double kFarthestSight = 200;  // metres

// A camera at one moment.
struct CameraStand {
  Pose camera_from_world;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // in the world
  // The camera's motion while the vehicle moves on by a metre, in the camera frame.
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // rotation vector, radians
};

// What may lie between a camera and a plate; nothing where nothing can.
struct Surroundings {
  std::optional<TunnelWalls> walls = {};
  std::optional<FloorAndRoof> floor_and_roof = {};
  std::vector<std::size_t> standing_out =
      {};  // plates that stand out of their wall, of survey.tags
};

// A plate of which all that the feature frame encloses is in the image and in the open, of a size
// that can be read.
struct PlateSight {
  std::size_t camera = 0;  // index in rig.cameras
  std::size_t tag = 0;     // index in survey.tags
  double module_px = 0;    // width of a module at the middle of the frame, pixels
  double cosine = 0;       // of the incidence
  double distance = 0;     // from the camera to the middle of the frame, metres
  // Width of the modules at the farther end of the frame, less where its strokes are thin or its
  // heights foreshortened (frame_share): the reader's limits and noise are looked up by it.
  double effective_px = 0;
  double blur_px = 0;     // lens and focus, standard deviation
  double smear_px = 0;    // path of the picture across the bars for a metre of travel, pixels
  double smear_down = 0;  // along them, in strokes of the frame
  // Metres that the vehicle may move during the exposure for the tag still to be read reliably,
  // without and with the code book; negative when it is not read standing still.
  double travel_plain = -1;
  double travel_book = -1;
};

// How far from the vehicle's centre the farthest camera is mounted, metres.
double arm_length(const Rig& rig);

// A survey's plates and a rig's cameras, prepared for millions of queries. Keeps pointers to both.
class SightModel {
 public:
  SightModel(const Survey& survey, const Rig& rig, ReadShare share = ReadShare::reliable);

  const Survey& survey() const { return *survey_; }
  const Rig& rig() const { return *rig_; }

  // `curvature`: of the vehicle's path, positive to the right.
  CameraStand stand(std::size_t camera, const Pose& world_from_vehicle, double curvature) const;

  // False when the camera cannot possibly see the plate from here, nor from any place within
  // `slack` metres, turned by up to `turn` radians.
  bool may_see(std::size_t camera, const CameraStand& stand, std::size_t tag, double slack,
               double turn) const;

  std::optional<PlateSight> look(std::size_t camera, const CameraStand& stand, std::size_t tag,
                                 const Surroundings& around) const;

  // Whether the image's border leaves so much of a plate in sight, from its begin or its end on,
  // and unhidden, that the reader identifies it with the code book while the vehicle moves by so
  // many metres. Never through a lens that bends straight lines.
  bool shows_part(std::size_t camera, const CameraStand& stand, std::size_t tag,
                  const Surroundings& around, double moved) const;

  // No plate further from the camera than this can be read, metres; at most kFarthestSight.
  double reach() const { return reach_; }

  // Indices in survey.tags by chainage.
  const std::vector<std::size_t>& tags_by_chainage() const { return order_; }

  // Those of them in [low, high].
  std::span<const std::size_t> tags_between(double low, double high) const;

  // The surfaces that may hide a tag from a vehicle between these chainages.
  Surroundings surroundings(double first, double last) const;

 private:
  struct Plate {
    Eigen::Vector3d middle;  // of the feature frame, in the world
    Eigen::Vector3d right;   // unit vectors of the plate
    Eigen::Vector3d down;
    Eigen::Vector3d normal;  // into the wall
    Eigen::Vector3d centre;  // of the plate
    double depth = 0;        // that its corner lies behind its plane of plates
    bool stands_out = false;
  };
  struct Lens {
    bool is_pinhole = true;  // projects straight lines to straight lines
    Eigen::Matrix3d camera_from_vehicle;
    Eigen::Vector3d vehicle_in_camera;
    Eigen::Vector3d forward_in_camera;
    double magnification = 0;                         // pixels per radian at most
    double left = 0, right = 0, top = 0, bottom = 0;  // of what the image shows, as x/z and y/z
    double blur_px = 0;
  };

  Plate make_plate(const PlacedTag& placed) const;
  Lens make_lens(const RigCamera& camera) const;
  bool may_be_hidden_between(double low, double high) const;
  double standoff_between(double low, double high) const;
  // What a camera shows of a plate, wherever the image's border is.
  struct InView {
    PlateSight sight;                     // without the distances that the vehicle may move
    Eigen::Vector3d middle, right, down;  // of the plate, in the camera frame
  };

  std::optional<InView> in_view(std::size_t camera, const CameraStand& stand,
                                std::size_t tag) const;
  double effective_px(std::size_t camera, const InView& view, const Eigen::Vector2d& right,
                      const Eigen::Vector2d& down) const;
  bool fits_in_image(std::size_t camera, const InView& view) const;
  // The frame from one place along it to another, half lengths to the right of its middle, by a
  // lens that bends nothing.
  bool fits_in_image(std::size_t camera, const InView& view, double from, double to) const;
  bool is_hidden(const Surroundings& around, const CameraStand& stand, std::size_t tag) const;
  bool is_behind(const TunnelWalls& walls, const CameraStand& stand, const Plate& plate) const;
  bool is_behind(const FloorAndRoof& floor_and_roof, const CameraStand& stand,
                 const Plate& plate) const;
  bool is_behind(const Plate& other, const CameraStand& stand, const Plate& plate) const;

  const Survey* survey_;
  const Rig* rig_;
  BlurLimits plain_;
  BlurLimits book_;
  BlurLimits parts_ = BlurLimits::of_parts();
  std::vector<Plate> plates_;
  std::vector<Lens> lenses_;
  std::vector<std::size_t> order_;
  double module_ = 0;
  double half_length_ = 0;  // of the feature frame's inner edge
  double half_height_ = 0;
  double reach_ = 0;
};

}  // namespace tagsmith::detail
