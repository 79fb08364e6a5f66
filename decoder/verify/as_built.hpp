// SPDX-License-Identifier: Apache-2.0
// The as-built survey: all pictures of a drive in one adjustment, tied to control tags.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/plates/hung_tags.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

enum class AsBuiltStatus {
  control,       // hangs as surveyed, within the survey's sigma
  contradicted,  // a control tag that does not hang where the survey has it
  adjusted,      // its place follows from the control tags
  undetermined,  // nothing connects it with a control tag
};

// "control", "contradicted", "adjusted" or "undetermined".
std::string to_string(AsBuiltStatus status);

// A tag of the survey that was seen. An undetermined one has a reason and no numbers.
struct AsBuiltTag {
  std::string tag;
  AsBuiltStatus status = AsBuiltStatus::undetermined;
  std::string reason;  // in words, of undetermined and contradicted tags
  int stations = 0;    // whose pictures of it were used
  // Where it hangs; for a control tag, where the pictures and all other tags put it, and where they
  // determine nothing, its surveyed place.
  Pose world_from_plate;
  // Of P in world axes, metres, then of the turn about the plate's own axes, radians.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of P from its surveyed place, world axes
  // Standard deviation of a coordinate of P, metres, as a survey states it of each tag by itself:
  // the root mean square of the three or, because tags seen together share errors, what it must be
  // for the mean of an adjusted tag and its neighbours in a picture to be as uncertain as it is.
  double survey_sigma = 0;

  bool has_place() const { return status != AsBuiltStatus::undetermined; }
};

struct LeftOutSighting {
  std::string station;
  std::string tag;
};

// Control tags that are seen together, and where everything else puts them: a mistake that they
// share, such as one of the station that they were surveyed from, contradicts none of them alone.
struct ControlGroup {
  std::vector<std::string> tags;
  double shift = 0;       // mean of all of them from their surveyed places, metres
  double chi_square = 0;  // of this shift, three degrees of freedom
  // How far off all of them may be without being contradicted, metres; infinite where no other
  // control tag determines it.
  double unnoticed = 0;
};

struct AsBuiltSurvey {
  std::vector<AsBuiltTag> tags;           // those seen, in the survey's order
  std::size_t stations = 0;               // used: places from which two tags and more were seen
  std::size_t sightings = 0;              // used: pictures of a tag
  std::vector<LeftOutSighting> left_out;  // contradict the rest
  std::vector<ControlGroup> groups{};
  std::vector<std::string> cut_off;  // tags that only these connected with a control tag
  double chi_square = 0;             // of all corners
  int degrees_of_freedom = 0;
  double sigma_factor = 1;  // by which the corners' stated sigmas were raised; 1 = not raised
};

// Adjusts the places of all tags, of all vehicles and the rig's calibration at once. Control tags
// hang as surveyed within the survey's sigma (at least kLeastSurveySigma); all others hang where
// the pictures say. The uncertainty that the rig states is included. `control`: names of tags of
// the survey. Fails when none of them was seen, or when the adjustment does not converge.
Result<AsBuiltSurvey> adjust_as_built(const Survey& survey, const Rig& rig,
                                      std::span<const SightedTag> sighted,
                                      std::span<const std::string> control);

// Where groups or single control tags contradict the rest, marks those that may hang wrong: the
// likeliest, and all that are not clearly less likely (Baarda 1968, test of one alternative after
// the other). Where none does, the result of each tag's own test stays.
void judge_control(const Survey& survey, AsBuiltSurvey& found);

// Checks whether a single control tag hangs as surveyed, which its own adjustment cannot show: all
// others would be moved instead. The others are assumed to hang about the surveyed places, within
// the scatter among themselves. Returns where the control tag hangs when they contradict it.
// Nothing when they do not, are fewer than three, or differ by more than 0.1 m.
std::optional<AsBuiltTag> contradicted_by_others(const Survey& survey, const Rig& rig,
                                                 std::span<const SightedTag> sighted,
                                                 const std::string& control);

}  // namespace tagsmith::detail
