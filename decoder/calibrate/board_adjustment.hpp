// SPDX-License-Identifier: Apache-2.0
// The bundle adjustment of calibration: one camera, the shape of each board and the pose of each
// board in each photo, fitted at once to all corners, each tag weighted by its covariance.
//
// Poses are eliminated sighting by sighting (Triggs et al. 2000, "Bundle Adjustment - A Modern
// Synthesis", 6.1); what is left is a dense system of some twenty unknowns, for which Eigen is
// sufficient: docs/decisions/0014-camera-calibration.md.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "decoder/calibrate/board_view.hpp"
#include "decoder/calibrate/camera_form.hpp"

namespace tagsmith::detail {

// A tag's corners in a photo and on its board.
struct TagObservation {
  std::size_t tag = 0;                        // in Board::tags
  std::array<Eigen::Vector2d, 4> on_board{};  // from the board's middle, metres
  CornerPixels pixels = CornerPixels::Zero();
  CornerCovariance whitening = CornerCovariance::Identity();  // lower triangular; W C W^T = 1
  bool used = true;
};

// One board in one photo.
struct BoardSighting {
  std::size_t view = 0;
  std::size_t board = 0;
  std::vector<TagObservation> tags;
  bool used = true;
};

// A board's size, and how well it is known.
struct BoardPlane {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();     // in the board frame, metres
  Eigen::Vector2d half_size = Eigen::Vector2d::Ones();  // metres
  double scale_sigma = 0;
  double stroke = 0;  // of its feature frames, metres
};

struct CalibrationProblem {
  int width = 0;  // of the photos, pixels
  int height = 0;
  std::vector<BoardPlane> planes;  // by board
  std::vector<BoardSighting> sightings;
};

// All views of one camera; views must be of one size and name boards of the list. A tag whose
// covariance is not positive definite is left out.
CalibrationProblem calibration_problem(std::span<const BoardView> views,
                                       std::span<const Board> boards);

// How a board differs from its drawing, and its frames' images from their drawing.
struct BoardShape {
  double stretch = 0;  // its width over its height, relative to the drawing's
  double growth = 0;   // of the ink outward of the frames' strokes, metres
  // Out of its plane, away from a viewer who faces it: z = bow[0] x^2 + bow[1] y^2 + bow[2] x y
  // metres, x and y from the middle in half sizes of the board.
  Eigen::Vector3d bow = Eigen::Vector3d::Zero();
  // Sharpening moves the sides of a thin stroke differently from those of a thick one: a side whose
  // stroke is w pixels thick lies thin_stroke / w pixels further outward; pixels^2.
  double thin_stroke = 0;
};

inline constexpr Eigen::Index kShapeParameters = 6;  // stretch, growth, bow, thin_stroke

// Of one sighting: six of the pose (shift, then turn, both in camera axes, the turn about the
// board's middle), and how far sharpening and the tone curve move the sides of thick strokes
// outward.
inline constexpr Eigen::Index kSightingParameters = 7;
using SightingMatrix = Eigen::Matrix<double, kSightingParameters, kSightingParameters>;

struct SightingState {
  Pose camera_from_middle;  // of the board frame moved to the board's middle
  double edge_px = 0;
};

struct CalibrationState {
  Camera camera;
  std::vector<BoardShape> shapes;        // by board
  std::vector<SightingState> sightings;  // by sighting
};

struct AdjustmentOptions {
  CameraForm form;
  bool camera_free = true;  // else only poses are fitted
  bool shapes_free = true;
  // Residuals are divided by this in addition to their covariance: large at a rough start.
  double scale = 1;
  // Beyond so many standard deviations a tag counts linearly (Huber 1964); 0 = all count squared.
  double huber = 0;
  int iterations = 50;
};

struct CalibrationFit {
  CalibrationState state;
  double cost = 0;  // chi-square of the tags used and of what was known before, robust, by `scale`
  bool converged = false;
};

// Levenberg and Marquardt from `start`. A tag that the camera cannot see at its place counts as one
// a hundred thousand standard deviations off.
CalibrationFit adjust_calibration(const CalibrationProblem& problem, const CalibrationState& start,
                                  const AdjustmentOptions& options);

// Residuals of one tag: seen minus predicted, pixels; nothing where it cannot be seen from there.
std::optional<CornerPixels> residual_of(const CalibrationProblem& problem,
                                        const CalibrationState& state, std::size_t sighting,
                                        const TagObservation& tag);

// How far, as a mean, the sides of the sighting's frames lie outward of where they were drawn:
// sharpening, tone curve and growth of the ink together, pixels.
double mean_edge(const CalibrationProblem& problem, const CalibrationState& state,
                 std::size_t sighting);

// Squared, whitened; of a tag that cannot be seen 1e10.
double tag_chi_square(const CalibrationProblem& problem, const CalibrationState& state,
                      std::size_t sighting, const TagObservation& tag);

// One sighting with a separate camera, the other parameters unchanged.
struct OwnCamera {
  // Relative change of the focal length alone that fits the sighting best, and its sigma; sigma 0 =
  // not determined.
  double focal_change = 0;
  double focal_sigma = 0;
  // For focal length and principal point together: by how much a separate camera would lower the
  // sighting's chi-square, and how many of the three it determines.
  double chi_square = 0;
  int degrees = 0;
};

// The errors of a finished fit, from the covariances stated.
struct CalibrationPrecision {
  // Of the free parameters of the form, then kShapeParameters for each board.
  Eigen::MatrixXd shared;
  std::vector<SightingMatrix> sightings;  // those not used included
  std::vector<OwnCamera> own_cameras;
};

// Nothing when the system is singular.
std::optional<CalibrationPrecision> precision_of(const CalibrationProblem& problem,
                                                 const CalibrationState& state,
                                                 const CameraForm& form);

// The board frame's pose.
Pose camera_from_board(const BoardPlane& plane, const SightingState& state);

}  // namespace tagsmith::detail
