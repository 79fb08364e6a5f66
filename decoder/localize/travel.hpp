// SPDX-License-Identifier: Apache-2.0
// Whether the positions of a run are consistent: the headings point the way that the vehicle went,
// it stands as high as the rig says, and ranges are about as long as the tags say.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// How far the headings are turned from the way between positions.
struct TurnedHeadings {
  double angle = 0;       // radians, -pi/2 to pi/2, positive to the right
  std::size_t steps = 0;  // from a position to the next that were compared
};

// A vehicle goes forwards or backwards, not sideways: where nearly all of five steps and more lie
// at one and the same angle of over 20 degrees to its heading, a camera looks elsewhere than the
// rig says, or its photos are another camera's. Steps of half a metre and more that the positions'
// errors cannot turn by more than 3 degrees count. Nothing where headings fit, where the steps do
// not agree, and where fewer than five count.
std::optional<TurnedHeadings> turned_headings(std::span<const Fix> fixes);

// By how much the headings of a run differ from the way that the vehicle went straight on.
struct CourseOffset {
  double angle = 0;       // radians, weighted mean, positive: turned to the right of the way
  double sigma = 0;       // standard deviation, with that of a heading
  std::size_t steps = 0;  // that were compared
};

// A vehicle on wheels rolls where it points, so that in steps straight on its headings differ from
// the way by noise: where five steps of half a metre and more differ by one angle of at least 0.2
// degrees and four standard deviations, all cameras are turned on the vehicle alike, which no
// single measurement reveals (Unchecked::Kind::all_mountings), or it was not driven from place to
// place. In a bend the way also depends on where the rear axle is; it is taken to be within a metre
// of O. Nothing where turned_headings says more.
std::optional<CourseOffset> course_offset(std::span<const Fix> fixes);

// How high the vehicle stands in a run, and how far that is from what the rig says.
struct WrongHeight {
  double height = 0;  // of O above the floor, metres, median
  double stated = 0;
  double sigmas = 0;  // standard deviations between the two
};

// Where O is 2.5 of the rig's standard deviations and more from its stated height, as the median of
// three rows and more: the rig is wrong, or the pictures are mirrored top to bottom; a symbol is
// read the same in these, and the world that a level camera sees remains plausible.
std::optional<WrongHeight> wrong_height(std::span<const Fix> fixes,
                                        const std::vector<Survey>& surveys, const Rig& rig);

// By how much a range is longer than the tags of a run say.
struct WrongRange {
  std::string name;
  double metres = 0;     // median of the rows, negative = shorter
  double sigmas = 0;     // standard deviations of the difference, median
  std::size_t rows = 0;  // that were compared
  // Whether in most rows a mistake that the tags do not reveal (Fix::unchecked) is large enough to
  // explain it. Otherwise the tags check each other, and the sensor or the wall is wrong.
  bool tags_may_be_wrong = false;
};

// The range that, as the median of five rows and more, lies 2.5 standard deviations and more to the
// same side of what the tags say. A single row leaves such a range out, since echoes are frequent;
// echoes do not change a median. Tags seen through one lens agree with each other however wrong its
// focal length is: only the range shows it.
std::optional<WrongRange> wrong_range(std::span<const Fix> fixes, const Rig& rig);

// What the positions of a run together say against them.
struct TravelDoubts {
  std::optional<TurnedHeadings> turned{};
  std::optional<WrongHeight> height{};
  std::optional<WrongRange> range{};

  // Why none of the positions should be used; empty = nothing says so. A range counts only where
  // the tags may be wrong.
  std::string why() const;
};

TravelDoubts travel_doubts(std::span<const Fix> fixes, const std::vector<Survey>& surveys,
                           const Rig& rig);

// Rows without a position that have one when the vehicle may move while the cameras' shutters pass
// over their images.
struct RollingShutter {
  std::size_t located = 0;  // of these, with such a motion
  std::size_t rows = 0;     // without a position, in which two tags and more were read
};

// Where that locates three rows and more, and seven of ten, and cameras that stand and look a
// little elsewhere do not locate as many; the rig states no rolling shutter. `rows`: of the fixes.
std::optional<RollingShutter> rolling_shutter(std::span<const Fix> fixes,
                                              std::span<const Observation> rows,
                                              const std::vector<Survey>& surveys, const Rig& rig);

// The same while a vehicle drives.
class LiveDoubts {
 public:
  // The fix. While the last ones together show that they should not be used (TravelDoubts::why),
  // this is added as a note, and nothing confirms the fix.
  Fix judged(Fix fix, const std::vector<Survey>& surveys, const Rig& rig);

 private:
  std::vector<Fix> last_;  // of each only what these checks need
};

// "16 of 19 rows without a position have one when ... (rolling shutters): ..."
std::string to_string(const RollingShutter& rolling);

// "range d is 0.071 m longer than the tags say ..."
std::string to_string(const WrongRange& wrong);

// "the vehicle stands 0.088 m above the floor ..."
std::string to_string(const WrongHeight& wrong);

// "the headings are turned by ... degrees from the way between the positions ..."
std::string to_string(const TurnedHeadings& turned);

// "the headings are turned by 1.03 +-0.05 degrees to the right of the way ..."
std::string to_string(const CourseOffset& offset);

}  // namespace tagsmith::detail
