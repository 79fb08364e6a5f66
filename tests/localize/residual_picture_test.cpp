// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/residual_picture.hpp"

#include <array>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

namespace {

// x1, y1, x2 and y2 of all arrows, in their order.
std::vector<std::array<double, 4>> arrows_in(const std::string& svg) {
  static const std::regex kLine("<line x1='([^']+)' y1='([^']+)' x2='([^']+)' y2='([^']+)'");
  std::vector<std::array<double, 4>> arrows;
  for (std::sregex_iterator found(svg.begin(), svg.end(), kLine), end; found != end; ++found) {
    arrows.push_back({std::stod((*found)[1]), std::stod((*found)[2]), std::stod((*found)[3]),
                      std::stod((*found)[4])});
  }
  return arrows;
}

}  // namespace

TEST_CASE("an arrow goes from where a corner is expected towards where it was seen, enlarged") {
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].name = "left";
  rig.cameras[0].camera.width = 1200;
  rig.cameras[0].camera.height = 900;
  Fix fix;
  FittedCorners corners{"left", "000L", {}, {{{100, 100}, {400, 100}, {400, 300}, {100, 300}}}};
  corners.seen = {{{103, 96}, {400, 101}, {398, 300}, {100, 300}}};
  fix.corners = {corners};
  // The greatest residual, 5 pixels, is to become a twelfth of the width: 20 times.
  const std::vector<std::array<double, 4>> expected{
      {100, 100, 160, 20}, {400, 100, 400, 120}, {400, 300, 360, 300}, {100, 300, 100, 300}};
  CHECK(arrows_in(residual_picture(fix, rig)) == expected);
}
