// SPDX-License-Identifier: Apache-2.0
// Where the vehicle is, from what its cameras saw.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tagsmith/export.hpp>
#include <tagsmith/geometry.hpp>
#include <tagsmith/image.hpp>
#include <tagsmith/rig.hpp>
#include <tagsmith/survey.hpp>

namespace tagsmith {

// What one camera saw.
struct CameraView {
  std::string camera;  // of the rig
  ImageView image;     // of the camera's size
};

// A tag that was read before, by read() with the rig's camera (ReadOptions::camera) or by another
// reader.
struct SeenTag {
  std::string camera;  // of the rig
  std::string digits;  // twelve
  Corners corners{};   // in the image as taken, distortion included
  std::optional<CornerCovariance>
      covariance{};  // positive definite; absent = 0.3 pixels a coordinate
};

// What the vehicle saw at one moment.
struct Measurement {
  std::string id;
  std::vector<CameraView> images;
  std::vector<SeenTag> tags;
  std::map<std::string, double> ranges;  // metres, by the names of the rig's sensors
  std::optional<double> time;            // seconds; Localizer::track needs it
};

// How the vehicle stands.
struct Attitude {
  double heading = 0;  // of its x axis, from +y towards +x of the grid
  double pitch = 0;    // positive nose down
  double roll = 0;     // positive to the right
};

// A tag seen or a range measured that is not used for the position.
struct Dropped {
  std::string name;
  std::string camera;  // that saw the tag; empty for a range
  std::string reason;
};

// A mistake that nothing in the measurement would reveal if it were made.
struct Unchecked {
  std::string kind;   // "plate_place", "lens" and others, as `localize --json` has them
  std::string name;   // of the tag, camera or range; may be empty
  double metres = 0;  // how far it could move the position at most; 0 for what is always listed
};

// The vehicle's centre O at one measurement.
struct Fix {
  std::string id;
  std::optional<Vector3> position;      // grid; absent = there is none, and `reason` says why
  std::optional<Matrix<3>> covariance;  // of x, y, z, metres squared
  std::optional<Attitude> attitude;
  std::optional<Matrix<6>> pose_covariance;  // of x, y, z, heading, pitch, roll
  std::string reason;                        // why there is no position; empty with one
  std::string survey;                        // in whose tunnel the position lies
  std::vector<std::string> tags;             // used; without a position, seen
  std::vector<std::string> ranges;           // used
  std::vector<Dropped> dropped;              // tags and ranges that contradict the position
  // How many agree with the position although one of its plates may be wrong. With 0 a plate that
  // hangs elsewhere than surveyed is not noticed, or a photo of another moment (see notes).
  int confirmations = 0;
  double chi_square = 0;       // weighted residuals squared
  int degrees_of_freedom = 0;  // expectation of chi_square; 0 = it cannot be checked
  std::vector<Unchecked> unchecked;
  std::vector<std::string> notes;  // what a user of the position should know
};

struct LocalizerOptions {
  // No position where nothing confirms it (Fix::confirmations is 0).
  bool confirmed_only = false;
};

// Locates measurements of one rig among the tags of one or more surveys by one least-squares fit to
// all corners, ranges and priors of the rig; tags and ranges that contradict are dropped and named.
class TAGSMITH_EXPORT Localizer {
 public:
  // Fails with ErrorCode::invalid_argument without a survey, and on surveys that share a name or a
  // code or have plates of different colours.
  Localizer(const std::vector<Survey>& surveys, Rig rig, const LocalizerOptions& options = {});
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;
  ~Localizer();

  // The position by this measurement alone, the same as `tagsmith localize --run` gives. A
  // measurement without a position is no failure: the fix says why. Fails with
  // ErrorCode::invalid_argument on names that the rig does not have, digits that are not twelve,
  // and views of nothing. Threads may call it at once.
  Fix locate(const Measurement& measurement) const;

  // The position while the vehicle drives, the same as `tagsmith localize --follow` gives: tags are
  // looked for where the motion so far predicts them, which is faster, and a position that
  // contradicts the motion is doubted. Tags that the last measurements show to hang elsewhere than
  // surveyed are set aside from there on, with a note. While the last measurements show that rig or
  // positions cannot be trusted, a position has a note that says why and no confirmations.
  // Measurements come in the order of their times; without a time the motion does not judge one.
  // One thread at a time.
  Fix track(const Measurement& measurement);

  // Forgets the drive so far: the vehicle was moved.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tagsmith
