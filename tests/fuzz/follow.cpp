// SPDX-License-Identifier: Apache-2.0
// The protocol of `localize --follow`: any lines on standard input, each answered.
#include "decoder/cli/follow.hpp"

#include <cstdio>
#include <iostream>
#include <sstream>

#include "tagsmith/survey/read_survey.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

namespace {

Fix no_position(const Measurement& measurement, const std::vector<Survey>&,
                const std::optional<PosePrior>&, Observation&) {
  Fix fix;
  fix.id = measurement.id;
  fix.method = "joint";
  fix.reason = "no picture is read here";
  return fix;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Survey> surveys{load_survey("surveys/corridor/survey.yaml").value()};
  static const Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  static std::FILE* const silent = std::freopen("/dev/null", "w", stdout);
  if (silent == nullptr) return 0;
  std::istringstream lines(std::string(fuzz::as_text(data, size)));
  std::streambuf* const before = std::cin.rdbuf(lines.rdbuf());
  std::cin.clear();
  follow({surveys, rig, no_position, true, false, true});
  std::cin.rdbuf(before);
  return 0;
}
