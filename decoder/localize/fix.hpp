// SPDX-License-Identifier: Apache-2.0
// What localization returns, and how it compares with the truth where that is known.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/image/gray.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The vehicle's attitude, radians.
struct Attitude {
  double heading = 0;  // of its x axis, from +y towards +x of the grid
  double pitch = 0;    // positive nose down
  double roll = 0;     // positive to the right
};

// Of x, y, z, heading, pitch, roll; metres and radians, squared.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

// A tag seen or a range measured that is not used for the position.
struct Dropped {
  std::string name;    // of the tag or the range
  std::string camera;  // that saw the tag; empty for a range
  std::string reason;
};

// A range as measured minus the value that all other measurements give.
struct CheckedRange {
  std::string name;
  double metres = 0;
  double sigmas = 0;  // standard deviations of the difference
};

// Which part of the position's covariance comes from where. Metres^2, grid axes; they add up to the
// covariance.
struct ErrorBudget {
  Eigen::Matrix3d pixels = Eigen::Matrix3d::Zero();       // where edges were found in the images
  Eigen::Matrix3d edges = Eigen::Matrix3d::Zero();        // what the camera may move them by
  Eigen::Matrix3d survey = Eigen::Matrix3d::Zero();       // the plates' surveyed places
  Eigen::Matrix3d coding = Eigen::Matrix3d::Zero();       // rounding of coded positions
  Eigen::Matrix3d ranges = Eigen::Matrix3d::Zero();       // range sensors
  Eigen::Matrix3d calibration = Eigen::Matrix3d::Zero();  // cameras' intrinsics and mounting
  Eigen::Matrix3d vehicle = Eigen::Matrix3d::Zero();      // how level and how high it stands
};

// The corners of one tag in one image, clockwise from P, and where the fix predicts them.
struct FittedCorners {
  std::string camera;
  std::string tag;
  std::array<PixelPoint, 4> seen{};
  std::array<PixelPoint, 4> fitted{};
  bool used = true;
  bool is_part = false;  // only a part of the tag is in sight
};

// A mistake that nothing in the measurement would reveal if it were made.
struct Unchecked {
  enum class Kind {
    plate_place,      // a plate hangs elsewhere than surveyed; `name`: the tag
    wall_places,      // the plates of both walls farther out, or all of them along the drive
    wall_shift,       // the plates of one wall are shifted alike; `name`: the wall
    wall_turn,        // the plates of both walls lean alike, or follow a slope alike
    plate_size,       // plates are of another size than the template
    mounting,         // a camera stands or looks otherwise; `name`: the camera
    lens,             // a camera's focal length, centre or distortion; `name`: the camera
    all_lenses,       // the same for all cameras
    rolling_shutter,  // cameras without a stated readout read their rows one after another
    range,            // a range sensor measures something else; `name`: the range
    vehicle_height,   // the vehicle is higher or lower than the rig says
    // What no single measurement can reveal, so that every position lists it: all cameras are
    // displaced alike on the vehicle, all photos are of another moment, the survey is shifted or
    // turned as a whole.
    all_mountings,
    moment,
    survey_frame,
  };
  Kind kind = Kind::plate_place;
  std::string name;
  double metres = 0;  // how far it could move the position at most; 0 for what is always listed
};

// The kind as JSON has it: "plate_place".
const char* to_string(Unchecked::Kind kind);

// "the place of 003L", "the lens of camera left".
std::string to_string(const Unchecked& unchecked);

// The note of a fix that uses one tag: what moves the plate along its wall, or swaps it with
// another of the same wall, moves the position with it, whatever ranges and priors say.
inline constexpr const char* kOneTagOnly = "one tag only: a wrong plate would go unnoticed";

// The vehicle's centre O at one measurement.
struct Fix {
  std::string id;
  std::string method;  // "joint" or "paper"
  std::string survey;  // name of the survey in whose tunnel the position lies
  // Names of the tags used; without a position, of those seen. Of another survey: SURVEY/TAG.
  std::vector<std::string> tags;
  std::vector<std::string> ranges;           // names of the ranges used
  std::vector<CheckedRange> checked_ranges;  // with an attitude, all within their sensors' limits
  std::vector<Dropped> dropped;              // tags and ranges that contradict the position
  // How many agree with the position although one of its plates may be wrong: the tags that it uses
  // minus one, and the motion where that rests on another tag. With 0, a plate that hangs elsewhere
  // than surveyed, or bears another's code, is not noticed, or what `unconfirmed` says.
  int confirmations = 0;
  // Why neither another tag nor the motion confirms the position, though there is one; else empty.
  std::string unconfirmed;
  // In the survey's grid, metres; there exactly when the measurement was located.
  std::optional<Eigen::Vector3d> position_in_grid;
  std::optional<Eigen::Matrix3d> covariance_in_grid;  // of x, y, z, metres^2
  std::optional<Attitude> attitude;                   // not every method determines one
  // There exactly when the attitude is; its upper left block is covariance_in_grid.
  std::optional<PoseCovariance> pose_covariance_in_grid;
  std::optional<ErrorBudget> budget;
  std::vector<FittedCorners> corners;  // with an attitude, of every tag that was looked at
  double chi_square = 0;               // of what the fix uses, weighted residuals squared
  // The factor by which the covariance is raised above the stated one because of chi-square.
  double variance_factor = 1;
  // What would go unnoticed and move the position by more than four standard deviations, and what
  // no single measurement can reveal. Empty without a position.
  std::vector<Unchecked> unchecked;
  int degrees_of_freedom = 0;      // expectation of chi_square; 0 = it cannot be checked
  bool predicted = false;          // from the run's motion: nothing of this row was used
  std::string reason;              // why there is no position; empty with one
  std::vector<std::string> notes;  // what a user of the position should know
  std::string doubt;               // why none of a drive's positions should be used; empty = none
};

// SURVEY/TAG: surveys may have tags of one name.
std::string tag_of_survey(const std::string& survey, const std::string& tag);

// The tags that it names, each as SURVEY/TAG.
std::vector<std::string> unique_tags(const Fix& fix);

// "ok" or "no_position".
std::string status_of(const Fix& fix);

// The survey in whose tunnel the position lies; without one, the first.
const Survey& survey_of(const Fix& fix, const std::vector<Survey>& surveys);

// The pose of a vehicle with a position and an attitude in the world of the survey with this grid.
Pose world_from_vehicle(const Fix& fix, const Grid& grid);

// The position with a note that it should not be used and why, and without confirmations.
Fix doubted(Fix fix, std::string why);

// "do not rely on this position: ..."
std::string note_of_doubt(const std::string& why);

// The fix, or no position with the reason where nothing confirms it.
Fix if_confirmed(Fix fix);

// Xu et al. (2017), (26) and (24).
struct FixError {
  double plane = 0;   // horizontal distance from the truth, metres
  double height = 0;  // difference of z without its sign, metres
};

// Nothing without a position or without a truth.
std::optional<FixError> error_of(const Fix& fix, const Measurement& measurement);

struct FixSummary {
  std::size_t count = 0;
  int located = 0;
  int confirmed = 0;                   // of the located, those with a confirmation
  std::optional<FixError> mean_error;  // (27) and (25), over the measurements that have an error
  std::optional<FixError> error95;     // that 95 % of them do not exceed, each component separately
  std::optional<FixError> max_error;   // each component separately
};

// `fixes[i]` belongs to `measurements[i]`.
FixSummary summarize(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements);

// ---- Solutions in the rock.

// Why a solution cannot be where the vehicle is: it lies in the rock. Empty when it does not.
std::string outside_tunnel(const Tunnel& tunnel, const Eigen::Vector3d& position_in_world);

}  // namespace tagsmith::detail
