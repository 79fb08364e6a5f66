// SPDX-License-Identifier: Apache-2.0
// Tags of a run that its rows together show to hang elsewhere than surveyed, or to be of another
// size: they are not used for positions.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/plates/rig_suspicion.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct SetAside {
  std::size_t survey = 0;  // index of the survey that has the tag
  std::string tag;
  std::string rule;               // docs/verify-rules.md
  std::string message;            // what is wrong, and what to do
  std::vector<std::size_t> rows;  // in which it is set aside, by index
};

struct RunCheck {
  std::vector<SetAside> aside;
  std::vector<std::string> mixed;           // rows that have each other's photos, in words
  std::optional<RigSuspicion> suspicion{};  // of the rig, or of all plates
  std::string contradicted{};               // the survey that most tags contradict, in words
};

// Whether the rows contradict the rig (suspect_rig, by the survey whose tags are seen most); if
// they do not, whether most tags contradict a survey, and what hung_as_surveyed reports as certain,
// survey by survey, then by all surveys' tags together: removes these tags from the rows, and adds
// a fault to each that says so. Doubtful tags stay.
RunCheck set_aside_misplaced(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                             const Rig& rig);

// Why the rows together are not to be relied on: the suspicion, or the survey that is contradicted;
// empty = nothing says so.
std::string doubt_in_words(const RunCheck& check, const Rig& rig);

// The same while the vehicle drives, from the last measurements.
class LiveSetAside {
 public:
  explicit LiveSetAside(std::vector<Survey> surveys)
      : surveys_(std::move(surveys)), left_(surveys_) {}

  // The surveys as they are, and without the tags that are set aside.
  const std::vector<Survey>& all() const { return surveys_; }
  const std::vector<Survey>& surveys() const { return left_; }

  // Takes what a measurement showed of tags of surveys() and the position computed from it. While
  // tags of the last measurements contradict each other, or the motion, these are compared each
  // time, else once a quarter of them is new; those of a vehicle that stands still count once.
  // Returns the tags that are set aside from here on, and the suspicion of the rig, which ends when
  // two comparisons in succession do not find it.
  RunCheck learn(Observation seen, const Fix& fix, const Rig& rig);

 private:
  struct Past {
    Observation seen;
    bool contradicted = false;  // and nothing was set aside since
  };

  // Adds it to the last measurements; whether it is time to compare these.
  bool take(Observation seen, const Fix& fix);

  std::vector<Survey> surveys_;
  std::vector<Survey> left_;
  std::deque<Past> last_;
  std::size_t since_compared_ = 0;           // measurements
  bool found_none_ = false;                  // the last comparison, of suspicions
  std::optional<RigSuspicion> suspicion_{};  // that lasts
  std::string contradicted_{};               // of the last comparison
};

}  // namespace tagsmith::detail
