// SPDX-License-Identifier: Apache-2.0
// What live measurements look back at.
#include "decoder/cli/follow.hpp"

#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::TemporaryFolder;

TEST_CASE("a picture whose file was written anew is not looked back at") {
  const TemporaryFolder folder;
  const auto picture = [&](const char* name) { return (folder.path() / name).string(); };
  const std::vector<Survey> surveys{load_survey("surveys/corridor/survey.yaml").value()};
  const Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  std::string lines;
  for (const char* id : {"1", "2", "3"}) {
    for (const std::string name : {"live", id}) REQUIRE(write_file(picture(name.c_str()), "old"));
    lines += std::string("{\"id\": \"") + id + "\", \"left\": \"" + picture("live") +
             "\", \"right\": \"" + picture(id) + "\"}\n";
  }
  const auto locate = [&](const Measurement& measurement, const std::vector<Survey>&,
                          const std::optional<PosePrior>&) {
    Fix fix;
    fix.id = measurement.id;
    fix.tags = {"000L", "001L"};  // two tags and no position: they contradict each other
    if (measurement.id != "3") fix.position_in_grid = Eigen::Vector3d::Zero();
    // The camera's next picture, before the next line comes.
    if (measurement.id != "3") REQUIRE(write_file(picture("live"), "of the next moment"));
    return fix;
  };
  std::map<std::string, std::size_t> looked_at;
  const auto observe = [&](const Measurement& measurement) {
    looked_at[measurement.id] = measurement.cameras.size();
    return Observation{measurement.id, {}, {}, {}};
  };
  std::istringstream input(lines);
  std::streambuf* const before = std::cin.rdbuf(input.rdbuf());
  std::cin.clear();
  const int code = follow({surveys, rig, locate, observe});
  std::cin.rdbuf(before);
  CHECK(code == 1);
  CHECK(looked_at == std::map<std::string, std::size_t>{{"1", 1}, {"2", 1}, {"3", 2}});
}
