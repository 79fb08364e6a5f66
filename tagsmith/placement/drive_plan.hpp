// SPDX-License-Identifier: Apache-2.0
// A drive through a surveyed tunnel, before it is driven: at every chainage, from every pose of the
// vehicle's envelope, which tags are read and how accurate the vehicle's position will be.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/placement/expected_accuracy.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The result of the published method at a pose, for the measurements that have a solution: the
// others have no result.
struct PaperExpectation {
  // Mean of the products of the errors in x, y, z about the true place, world frame, metres^2: it
  // includes the errors from the method's own assumptions (level cameras at O, straight walls).
  // Infinite where no measurement has a solution.
  Eigen::Matrix3d mean_square = Eigen::Matrix3d::Zero();
  double magnification = 0;      // 1 / tan(theta): metres along the tunnel for a metre of d
  double no_solution_share = 1;  // of measurements: no real solution, or one below the floor
};

struct PlanOptions {
  std::optional<double> from;             // chainage, metres; absent = the center line's start
  std::optional<double> to;               // absent = its end
  double step = 0.05;                     // of the chainage, metres
  int lateral_offsets = 5;                // spread evenly over the envelope, odd
  int headings = 5;                       // likewise
  std::optional<double> speed;            // metres a second; absent = usual_speed(rig)
  std::optional<double> corner_sigma_px;  // absent = as measured (corner_sigma_px)
  bool accuracy = true;                   // false: only sight, which is faster
  int jobs = 0;                           // threads at most; 0 = all cores
  // The published method at the nominal poses, for comparison; empty = no comparison.
  std::function<std::optional<PaperExpectation>(const VehiclePose&, std::span<const PlateSight>,
                                                const AccuracyOptions&)>
      paper = {};
};

// Longer or finer plans are refused.
inline constexpr int kMostColumns = 5'000'000;

// How many of a column's poses have tags on both walls, and on one wall alone.
struct WallCount {
  int both = 0;
  int one = 0;

  int any() const { return both + one; }
};

// Standard deviations of a position; infinite where there is none.
struct ColumnSigma {
  double plane = std::numeric_limits<double>::infinity();  // of along and across together, metres
  double along = plane;
  double across = plane;
  double height = plane;
  double heading = plane;  // radians
};

// The result of the paper's method at the nominal pose.
struct ColumnPaper {
  ColumnSigma sigma;             // root mean squares about the truth; the heading stays infinite
  double magnification = 0;      // 1 / tan(theta) of the pair; 0 without a pair
  double no_solution_share = 1;  // of measurements that have no real solution
};

// All poses at one chainage.
struct PlanColumn {
  double chainage = 0;
  WallCount seen;        // complete, in the open, of a size that can be read
  WallCount read_plain;  // read without the code book
  WallCount read;        // read with the survey as code book
  int least_tags = 0;    // read at the pose that reads fewest
  int confirmed = 0;     // poses that read a tag and another one, whole or in part
  // Greatest distance that the vehicle may move during the exposure (metres) and speed (metres a
  // second; infinite without an exposure) at which every pose that has a tag standing still still
  // has one.
  double travel = std::numeric_limits<double>::infinity();
  double speed = travel;
  ColumnSigma nominal;  // on the center line, along it, level
  ColumnSigma worst;    // greatest over the poses that have a position
  double nominal_one_lost =
      std::numeric_limits<double>::infinity();  // plane, whichever tag is lost
  ColumnPaper paper;
};

// How a tag is seen where it is read.
struct TagView {
  double chainage = 0;   // of the vehicle
  double distance = 0;   // from the camera, metres
  double module_px = 0;  // width of a module, pixels
  double incidence = 0;  // between the line of sight and the plate's normal, radians
};

// A tag on the nominal drive.
struct TagUse {
  bool is_read = false;
  TagView first;
  TagView last;
};

// A tag without which some pose of the column has no tag.
struct SoleTag {
  std::size_t column = 0;
  std::size_t tag = 0;  // index in survey.tags
};

// Counts of poses by a length or speed, in equal steps of its logarithm.
class LogHistogram {
 public:
  void add(double value);
  void merge(const LogHistogram& other);
  long count() const;

  // The value that all but this share of the counted exceed, to 3 %.
  double quantile(double share) const;

 private:
  static constexpr int kBins = 512;
  std::array<long, kBins> bins_{};
};

struct DrivePlan {
  PlanOptions options;
  double speed = 0;  // that was planned for
  int poses_per_column = 0;
  std::vector<PlanColumn> columns;
  std::vector<TagUse> tags;        // as survey.tags
  std::vector<SoleTag> sole_tags;  // by column
  LogHistogram travels;            // of poses that have a position standing still
  LogHistogram speeds;
};

// Fails when the vehicle does not fit into the tunnel: its envelope beyond a wall, its centre below
// the floor or above the roof, or, naming the first place, a camera on the center line or at the
// sides of the envelope in the rock, the floor or the roof. The places checked are half a metre
// apart. The message does not name the rig's file.
Result<void> check_vehicle(const Survey& survey, const Rig& rig, double from, double to);

// Fails with words for the user when options and files do not fit each other. The time is linear in
// the number of poses.
Result<DrivePlan> plan_drive(const Survey& survey, const Rig& rig, const PlanOptions& options);

}  // namespace tagsmith::detail
