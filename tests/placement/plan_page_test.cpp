// SPDX-License-Identifier: Apache-2.0
// The plan's web page in a browser: phone and desk.
#include <algorithm>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/browser.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

using nlohmann::json;

constexpr const char* kLook = R"js(
const curves = [...doc.querySelectorAll('#profile path')].map(p => p.getTotalLength());
const seen = {};
seen.overflow = doc.documentElement.scrollWidth - doc.documentElement.clientWidth;
seen.profile = doc.getElementById('profile').getBoundingClientRect().width;
seen.curves = curves.filter(length => length > 100).length;
seen.slopes = [...doc.querySelectorAll('#profile path')].filter(
  path => /L/.test(path.getAttribute('d'))).length;
seen.cells = [...doc.querySelectorAll('#profile rect')].length;
seen.tags = doc.querySelectorAll('#map circle').length;
const dots = [...doc.querySelectorAll('#map circle')].map(
  dot => ({x: +dot.getAttribute('cx'), y: +dot.getAttribute('cy')}));
const tags = JSON.parse(doc.getElementById('data').textContent).tags;
const range = (points, axis) =>
  Math.max(...points.map(p => p[axis])) - Math.min(...points.map(p => p[axis]));
seen.across = range(dots, 'x') / range(tags, 'x');
seen.along = range(dots, 'y') / range(tags, 'y');
seen.walls = doc.querySelectorAll('#map polyline').length;
seen.text = doc.body.textContent;
const box = doc.getElementById('profile').getBoundingClientRect();
doc.getElementById('profile').dispatchEvent(new page.PointerEvent('pointermove',
  {clientX: box.left + box.width / 2, clientY: box.top + 20, bubbles: true}));
seen.read = doc.getElementById('read').textContent;
return seen;
)js";

}  // namespace

TEST_CASE("the plan's page has its chart and its numbers, fits a phone, and reports no error") {
  const TemporaryFolder folder;
  const ProgramOutput output = run_tagsmith(
      "plan surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --to 5 --json -o '" +
      folder.path().string() + "'");
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  for (const int width : {390, 1280}) {
    CAPTURE(width);
    const PageVisit visit = visit_page(folder.path() / "plan.html", width, 844, kLook);
    const json seen = parsed_json(visit.result);
    CHECK_MESSAGE(visit.console.empty(), visit.console.front());
    CHECK(seen["overflow"] <= 0);
    CHECK(seen["profile"] > 0.7 * std::min(width, 1100));
    CHECK(seen["curves"] >= 2);
    CHECK(seen["slopes"] == 0);  // steps are drawn as steps
    CHECK(seen["cells"] > 10);
    CHECK(seen["tags"] == 16);
    CHECK(seen["walls"] >= 3);
    // Pixels a metre: the map is true to scale.
    const double along = seen["along"];
    CHECK(along > 20);
    CHECK(seen["across"].get<double>() == doctest::Approx(along).epsilon(1e-3));
    const std::string text = seen["text"];
    CHECK(text.find("read with the survey") != std::string::npos);
    CHECK(text.find("100.0 %") != std::string::npos);
    const std::string read = seen["read"];
    CHECK_MESSAGE(read.find(" m: center line ") != std::string::npos, read);
    CHECK_MESSAGE(read.find(" mm") != std::string::npos, read);
    CHECK_MESSAGE(read.find(" 0.00 mm") == std::string::npos, read);
  }
}

}  // namespace tagsmith::detail::test
