// SPDX-License-Identifier: Apache-2.0
// What a vehicle saw at one moment, in terms of the survey: the input of every localization method.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/localize/live_track.hpp"
#include "decoder/localize/sighting_model.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/reading.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Where a tag's corners lie in an image.
struct SeenCorners {
  FrameCorners corners{};  // in the image as taken, distortion included
  double sigma_px = 0;     // standard deviation of a corner's coordinate
  CornerCovariance covariance = CornerCovariance::Identity();  // of all of them, pixels^2
};

// A tag of the survey as one camera saw it: by its corners, or by a distance measured elsewhere.
struct SeenTag {
  std::string camera;      // of the rig
  std::size_t survey = 0;  // index of the survey that has the tag
  PlacedTag tag;
  std::optional<SeenCorners> seen_corners;
  std::optional<double> distance;  // from the camera to corner P, metres
  bool at_coded_place = false;     // in no survey: hangs where its digits say, to their rounding
  bool is_part = false;            // only a part of it is in sight
};

// A tag and the index of the survey that has it.
struct SurveyedTag {
  std::size_t survey = 0;
  const PlacedTag* tag = nullptr;
};

// A tag of which a camera's picture shows a part: one of these of the surveys.
struct SeenPart {
  std::string camera;  // of the rig
  std::vector<SurveyedTag> candidates;
  SeenCorners seen_corners;
  double share = 0;  // of the bars' length in sight
};

struct Observation {
  std::string id;
  std::vector<SeenTag> tags;
  std::map<std::string, double> ranges;  // by the rig's range names, metres
  std::vector<std::string> faults;       // unreadable images, images without a tag, unknown tags
  std::vector<SeenPart> parts{};         // of use only together with other tags
  std::optional<double> time{};          // seconds, where it is known
  bool lacks_picture = false;            // one that was named could not be read
  bool has_left_out = false;             // a picture was read but is not used; a fault says why
  std::map<std::string, std::uint64_t> pictures{};  // fingerprint (repeated_pictures.hpp) by camera
};

// Whether two measurements are of one place: all tags that both show with the same camera, at least
// one, lie less than a quarter of their frame's length from where they lay, a decimetre of a plate
// of 0.4 m. From one place the same errors come again and again.
bool are_of_one_place(const Observation& first, const Observation& second);

// How images are read.
struct ReaderChoice {
  std::function<ReadResult(const GrayView&, const ReadOptions&)> read;
  double corner_sigma_px = 0;  // of corners that the reader gives no covariance of
  // Tags that are in no survey are used too, at their coded positions (one survey only).
  bool unsurveyed = false;
};

// Standard deviations of corners. Fitted edges: larger than the errors that noise and lens blur
// leave; the closed form weighs its corners by it. The paper's pipeline: an outermost whole pixel,
// beside a border that the opening moves.
inline constexpr double kFittedCornerSigmaPx = 0.3;
inline constexpr double kOutlineCornerSigmaPx = 1.0;

// The tags with these digits, or of this name, in all surveys.
std::vector<SurveyedTag> find_tags(const std::vector<Survey>& surveys, const Digits& digits);
std::vector<SurveyedTag> find_tags(const std::vector<Survey>& surveys, std::string_view name);

// A reading's corners; by a reader that knew the camera, where its lens bends straight lines.
// `covariance` zero = not estimated: `sigma_px` is used instead.
SeenCorners seen_corners(const FrameCorners& corners, const CornerCovariance& covariance,
                         double sigma_px = kFittedCornerSigmaPx);

// A tag of the survey at its surveyed place, with the uncertainty of that.
SightedPlate sighted_plate(const PlacedTag& tag, const Survey& survey);

// `camera` (of the rig) and `plate`: indices in the problem that it is for.
Sighting sighting_of(const SeenCorners& seen, const Rig& rig, std::size_t camera,
                     std::size_t plate);

// Loads and reads the measurement's images, one after the other, with the surveys' codes as code
// book, and looks up the tags. With a prior they are looked for where they should be, and all over
// the image when some of them are missing there. Never fails: what could not be used is a fault.
Observation observe(const Measurement& measurement, const std::vector<Survey>& surveys,
                    const Rig& rig, const ReaderChoice& reader,
                    const std::optional<PosePrior>& prior = std::nullopt);

// How to read a camera's image: with the surveys' codes as code book, and the tags that the prior
// expects there. Fails when the image is not of the camera's size. `name` is for messages.
Result<ReadOptions> read_options_for_image(const GrayView& image, const std::string& name,
                                           const RigCamera& camera,
                                           const std::vector<Survey>& surveys,
                                           const std::optional<PosePrior>& prior);

// Adds the tags read in a camera's image, or the fault that there are none.
void add_result(Observation& observation, const ReadResult& result, const std::string& name,
                const RigCamera& camera, const std::vector<Survey>& surveys,
                const ReaderChoice& reader);

// Removes what the pictures of these cameras show, and adds the fault that says why.
void leave_out_pictures(Observation& observation, const std::set<std::string>& cameras,
                        std::string fault);

// Does what observe() does with one image that has been loaded.
void observe_image(Observation& observation, const RigCamera& camera, const GrayView& image,
                   const std::string& name, const std::vector<Survey>& surveys,
                   const ReaderChoice& reader,
                   const std::optional<PosePrior>& prior = std::nullopt);

}  // namespace tagsmith::detail
