// SPDX-License-Identifier: Apache-2.0
// A survey with the rig that drives there, as benches load them.
#pragma once

#include <string>
#include <utility>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail::bench {

struct Site {
  Survey survey;
  Rig rig;
};

inline Result<Site> load_site(const std::string& survey_file, const std::string& rig_file) {
  Result<Survey> survey = load_survey(survey_file);
  if (!survey) return fail(survey.error().message);
  Result<Rig> rig = load_rig(rig_file);
  if (!rig) return fail(rig.error().message);
  return Site{std::move(*survey), std::move(*rig)};
}

// One of surveys/.
inline Result<Site> load_shipped_site(const std::string& name) {
  const std::string folder = "surveys/" + name;
  return load_site(folder + "/survey.yaml", folder + "/rig.yaml");
}

}  // namespace tagsmith::detail::bench
