// SPDX-License-Identifier: Apache-2.0
// Where tags hang compared with the survey, from pictures of a calibrated rig, in words for the
// people who hang them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/plates/plate_consensus.hpp"
#include "decoder/plates/sightings.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// "unchecked", "fits", "off" or "doubtful".
std::string to_string(HangVerdict verdict);

// Three numbers and their standard deviations.
struct Measured3 {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

// Offset and turn are as seen by a viewer who faces the surveyed place.
struct HungTag {
  std::string tag;
  HangVerdict verdict = HangVerdict::unchecked;
  int stations = 0;                 // that show it together with another tag
  Measured3 offset;                 // of corner P: to the right, up, out of the wall; metres
  Measured3 turn;                   // clockwise, right edge out, top out; radians
  std::vector<std::string> rivals;  // of a doubtful tag
  std::string rule;                 // docs/verify-rules.md; empty when nothing is wrong
  std::string message;              // what is wrong; for a tag that is off, what to do
  // Of a tag that is off: decimal logarithm of the odds over the next explanation, at most 99.
  double odds{};
  // Of a moved tag: its entry in the survey's `placed` if it stays there.
  std::string placed{};
};

// A plate whose code is not in the survey and that hangs where a tag of the survey should be, which
// no photo shows.
struct UnknownTag {
  std::string station;
  std::string code;
  std::string place;  // that tag
};

// What is true of tags in the pictures of one station, wherever else these tags hang: that the
// pictures fit no place of the cameras (doubtful, rule `no-common-place`, each of their tags), or
// that the tag there is a second copy (off or doubtful, rule `second-copy`).
struct UnplacedTags {
  std::string station;
  std::vector<HungTag> tags;
};

// Neighbours on a wall, by chainage, of the tags that were judged.
struct UntiedPair {
  std::string before;
  std::string after;
};

struct HungTags {
  std::vector<HungTag> tags;  // of the survey that were seen, in its order
  std::vector<UnplacedTags> unplaced;
  std::vector<UnknownTag> unknown_tags{};
  std::vector<MixedStations> mixed{};  // the others are judged after these pictures were exchanged
  // Tags that no picture shows together, nor a chain of pictures by way of other tags: how far all
  // on one side hang from all on the other was not judged.
  std::vector<UntiedPair> untied{};
  std::vector<std::string> notes;    // on pictures that could not be used
  std::vector<std::string> assumed;  // what survey and rig do not state; plates' tilt is estimated
  bool nothing_fits = false;         // rig, survey and pictures do not belong together
  std::string rig_doubt{};  // the value of the rig that is why (rig_suspicion.hpp), or empty
  // In words, how all plates hang otherwise alike (rig_suspicion.hpp), or empty.
  std::string all_alike{};
  std::string revision{};  // of the survey, where files were judged (hanging_check.hpp)
};

// Least standard deviations that are assumed for the survey of plates: a survey that states none
// would make every offset significant. Where it states none of angles, that is attitude_scatter of
// the pictures.
inline constexpr double kLeastSurveySigma = 0.001;        // metres
inline constexpr double kLeastAngleSigma = 0.0008726646;  // radians: 0.05 degrees

// The sightings by station. Plates are the survey's tags that were seen, in its order, each with
// the standard deviations of the survey, or the least ones; the others are `unseen`. Sightings of
// tags that the survey does not have are left out.
AdjustmentProblem problem_for(const Survey& survey, const Rig& rig,
                              std::span<const SightedTag> sighted);

// How far a plate may hang from its surveyed place: metres and radians, of each axis.
void set_survey_sigma(SightedPlate& plate, double sigma, double angle_sigma);

// "row 3 and row 7 are mixed up: ...": it cannot be determined which of a station's cameras has the
// other's photos.
std::string in_words(const MixedStations& mixed, const Rig& rig);

// "no photo ties 003L and 004L, ...": which tags were not judged against each other, and what photo
// would help; nothing when all are connected by photos.
std::optional<std::string> untied_in_words(std::span<const UntiedPair> untied);

struct RigDoubt {
  std::string text;
  // Where only how all plates hang alike is in doubt: the survey with them as they likely hang.
  // Where each plate hangs can be measured with it.
  std::optional<Survey> hung;
};

// What explains that the pictures contradict rig or survey in one and the same way (suspect_rig),
// in words; nothing where nothing does, and for cameras held by hand.
std::optional<RigDoubt> rig_doubt(const Survey& survey, const Rig& rig,
                                  std::span<const SightedTag> sighted);

// find_consensus of the sighted tags, in words. Sightings of codes that the survey does not have
// are not used to judge others; where they hang is determined by the tags that fit.
HungTags hung_as_surveyed(const Survey& survey, const Rig& rig, std::span<const SightedTag> sighted,
                          double tolerance = kHangTolerance);

// The same; but where the pictures contradict the rig (rig_doubt), no tag is judged.
HungTags check_hung_tags(const Survey& survey, const Rig& rig, std::span<const SightedTag> sighted,
                         double tolerance = kHangTolerance);

}  // namespace tagsmith::detail
