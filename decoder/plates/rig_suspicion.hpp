// SPDX-License-Identifier: Apache-2.0
// Whether the rows of a drive contradict the rig in one and the same way.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "decoder/localize/observation.hpp"
#include "decoder/plates/plate_trials.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// "yaw", "pitch", ...
const char* to_string(RigParameter parameter);

// A single value of the rig, or a camera's turn about any axis or its place, that would explain
// what the tags show.
struct RigSuspect {
  std::string camera;  // empty = the lenses of all cameras, or what plates have in common
  RigParameter parameter = RigParameter::yaw;
  double stated = 0;  // radians; of focal lengths and plates' size 1, of a distortion its first
                      // coefficient, of a turn, a position, the plates' point and attitudes 0
  double expected = 0;
  double sigma = 0;  // of the expected value
  std::size_t rows_explained = 0;
  MountingAngles mounting{};  // expected, of a turn
  // Of a position: from the stated to the expected one, vehicle axes; metres, as expected and
  // sigma. Of the plates' point: from P to the right and up, as seen by who faces the plate.
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  MeasuredPoint point{};  // of the plates
};

// True of the plates' point, their size and what turns them.
bool is_of_plates(const RigSuspect& suspect);
// True of what turns them.
bool is_of_attitudes(const RigSuspect& suspect);
// True of what turns them and of their point: then the survey says otherwise how all of them hang.
bool is_of_hanging(const RigSuspect& suspect);

// The survey with its plates as the suspect has them; `suspect`: of how they hang.
Survey with_plates_of(const RigSuspect& suspect, Survey survey);

struct RigSuspicion {
  // Those that explain equally many rows, the likeliest first: the rows do not distinguish them.
  std::vector<RigSuspect> suspects;
  std::size_t rows = 0;            // that were compared
  std::size_t rows_as_stated = 0;  // explained by the rig as it is
  // Only one camera sees tags: frames of other proportions than the template's, which other cameras
  // would see alike, look like another focal length.
  bool by_one_camera = false;
};

// Compares the rig as stated with rigs in which one value of one camera is another, or the lenses
// of all are, or one camera is turned about any axis or stands elsewhere, and with plates that are
// all of another size, turned alike, or measured at another point than P. A row is explained when
// all its tags fit. Plates are tilted by what the survey states, or as single pictures show. A rig
// is suspected when another explains three rows and seven in ten, twice as many as the rig as
// stated or all of them so much better that the plates' tolerances would have to absorb the same in
// every row (odds of 270 000), and when that one differs by four standard deviations and more from
// what the rig states; unless one plate that hangs wrong explains them about as well.
std::optional<RigSuspicion> suspect_rig(std::span<const Observation> rows, const Survey& survey,
                                        const Rig& rig);

// "left: alpha 40.0 +-0.1 degrees in place of 35.0 would explain 9 of 10 rows (2 as it is)"; alpha
// of level cameras that look to a side.
// A focal length that only one camera shows has the template as an alternative.
std::string describe(const RigSuspicion& suspicion, const Rig& rig);

// "the rig is in doubt: ..."
std::string doubt_in_words(const RigSuspicion& suspicion, const Rig& rig);

}  // namespace tagsmith::detail
