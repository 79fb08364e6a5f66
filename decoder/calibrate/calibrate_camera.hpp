// SPDX-License-Identifier: Apache-2.0
// A camera from photos of calibration boards.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/calibrate/board_adjustment.hpp"
#include "decoder/calibrate/board_view.hpp"
#include "decoder/calibrate/camera_form.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"

namespace tagsmith::detail {

// One form of camera that was fitted to the corners.
struct TriedForm {
  CameraForm form;
  Camera camera;
  CameraCovariance covariance = CameraCovariance::Zero();  // raised as CameraCalibration's
  double chi_square = 0;
  // Bayesian information criterion (Schwarz 1978): chi-square over the sigma factor's square, plus
  // ln(residuals) a parameter; the least is chosen.
  double bic = 0;
  // Weight in the uncertainty of rays: exp(-aic / 2), normalised (Burnham and Anderson 2002, "Model
  // Selection and Multimodel Inference", 2.9), where a parameter costs 2. A form that the corners
  // seen do not need counts where none was seen.
  double weight = 0;
};

// A board in a photo, as fitted.
struct CalibratedSighting {
  std::size_t view = 0;
  std::size_t board = 0;
  bool used = false;  // else the photo contradicts the others, and the rest is from its own fit
  Pose camera_from_board;
  // Of its shift and its turn about the board's middle, both in camera axes. Without the error of
  // the board's scale, which changes the distances of all sightings of the board in proportion.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  // How far, as a mean, the frames' sides lie outward of where they were drawn: sharpening, tone
  // curve and growth of the ink together, pixels.
  double edge_px = 0;
  std::size_t tags_used = 0;
  double chi_square = 0;  // of the tags used, by the covariances that the reader stated
  // Radians between the board's normal and the camera's axis: a board parallel to the picture tells
  // no focal length, wherever in the picture it is.
  double tilt = 0;
  OwnCamera own_camera;  // its sigma and chi-square by the residuals' size (sigma_factor)
};

// The residuals of one tag.
struct TagResidual {
  std::size_t view = 0;
  std::size_t board = 0;
  std::size_t tag = 0;                           // in Board::tags
  CornerPixels seen = CornerPixels::Zero();      // pixels
  CornerPixels residual = CornerPixels::Zero();  // seen minus predicted; zero where not predictable
  double chi_square = 0;                         // eight residuals, by the reader's covariance
  bool used = false;                             // else left out: it fits worse than chance allows
};

// A board as the photos show it, with standard deviations.
struct CalibratedBoard {
  BoardShape shape;
  BoardShape sigma;
};

struct CameraCalibration {
  Camera camera;
  CameraForm form;
  // Of fx, fy, cx, cy and the eight coefficients; zero in rows of those that are held at zero.
  CameraCovariance covariance = CameraCovariance::Zero();
  // With `form` among them. Forms whose chi-square is ten times the least are not tried with two
  // focal lengths, and of a lens model that is clearly wrong none is.
  std::vector<TriedForm> tried;
  std::vector<CalibratedSighting> sightings;
  std::vector<TagResidual> residuals;
  std::vector<CalibratedBoard> boards;  // in the order given
  double edge_px = 0;                   // mean over the tags used
  double chi_square = 0;                // of everything that was used, by the covariances stated
  int degrees_of_freedom = 0;
  // Root of chi-square over the degrees of freedom, at least 1. All covariances here are multiplied
  // by its square: residuals larger than stated raise them, smaller ones lower nothing.
  double sigma_factor = 1;
  // The camera's covariance is multiplied by this one's square, too: root of camera_scatter's
  // chi-square over its degrees of freedom, at least 1. Where photos differ by more than chance
  // (CameraScatter::limit), the variance from photo to photo is added: the next photo is of one
  // camera, not of the mean of all.
  double photo_factor = 1;
};

// Views of one camera at one focus and zoom. Needs no initial guess: perspective cameras from
// telephoto to wide angle and fisheyes up to 180 degrees are tried, and the simplest lens model
// that explains the corners is chosen (TriedForm::bic).
//
// Tags that fit worse than one in a hundred sets of photos would show by chance, photos three times
// as bad as the median photo, and photos of another focal length (unless these are more than a
// third) are left out and stay in the result as not used.
//
// Does not say whether the photos are enough: assess.hpp does. Fails, naming the file, where views
// are of different sizes, and where fewer than four tags were seen in all.
Result<CameraCalibration> calibrate_camera(std::span<const BoardView> views,
                                           std::span<const Board> boards);

// Whether the photos used, each on its own, have the calibrated focal length and principal point.
struct CameraScatter {
  double chi_square = 0;
  int degrees = 0;
  std::size_t photos = 0;

  // Of chi-square, which is exceeded by chance once in 30 000.
  double limit() const;
};

CameraScatter camera_scatter(std::span<const CalibratedSighting> sightings);

// Whether the sighting on its own certainly has another focal length than the calibration.
bool has_other_focal(const CalibratedSighting& sighting);

// ---- From photo files' pixels: read, calibrate, read again knowing the camera, calibrate.

// Photos by their number, loaded when they are needed: twice each. Several threads call it at once.
struct PhotoSource {
  std::vector<std::string> files;  // names, for messages and results
  std::function<Result<GrayImage>(std::size_t)> load;
};

struct PhotoCalibrationOptions {
  int jobs = 0;  // photos read at once; 0 = as many as cores
  // Called after each photo of either reading, one call at a time: progress.
  std::function<void(std::size_t done, std::size_t of)> on_read;
};

struct PhotoCalibration {
  CameraCalibration calibration;
  std::vector<BoardView> views;  // as read last; calibration's view numbers count these
};

// Fails as calibrate_camera does, and where a photo cannot be loaded.
Result<PhotoCalibration> calibrate_photos(const PhotoSource& photos, std::span<const Board> boards,
                                          const PhotoCalibrationOptions& options = {});

}  // namespace tagsmith::detail
