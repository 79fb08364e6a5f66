// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/optimise.hpp"

#include <doctest/doctest.h>

#include "tagsmith/placement/plan_summary.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

PlanOptions first_metres() {
  PlanOptions options;
  options.to = 4;
  options.step = 0.1;
  return options;
}

}  // namespace

TEST_CASE("the chosen layout keeps the promise and costs no more than the given one") {
  const Survey survey = straight_survey(10, 8, 0.4);
  const Rig rig = crawler();
  for (const int lost : {0, 1}) {
    CAPTURE(lost);
    const auto found = optimise(survey, rig, {survey.tag_template}, {0.02, lost}, CostOrder::tags,
                                {}, first_metres());
    REQUIRE_MESSAGE(found.has_value(), found.error().message);
    CHECK(found->chosen.meets);
    CHECK(found->chosen.tags <= found->given.tags);
    CHECK(found->demanded_share == 1);
    // The claim, planned again from the layout alone.
    const auto plan = plan_drive(with_layout(survey, found->chosen.layout),
                                 with_alpha(rig, found->chosen.layout.alpha), first_metres());
    REQUIRE(plan.has_value());
    for (const PlanColumn& column : plan->columns) {
      CHECK(column.least_tags > lost);
      CHECK(column.worst.plane <= 0.02);
    }
  }
}

TEST_CASE("more is asked, more is paid") {
  const Survey survey = straight_survey(10, 8, 0.4);
  const Freedom spacing_alone{false, false, false, false};
  const auto cheap =
      optimise(survey, crawler(), {}, {0.05, 0}, CostOrder::tags, spacing_alone, first_metres());
  const auto safe =
      optimise(survey, crawler(), {}, {0.05, 1}, CostOrder::tags, spacing_alone, first_metres());
  REQUIRE(cheap.has_value());
  REQUIRE(safe.has_value());
  CHECK(cheap->chosen.tags <= safe->chosen.tags);
}

TEST_CASE("the search changes what it may, tells of each by its name, and nothing else") {
  const Survey survey = straight_survey(10, 8, 0.4);
  const auto found_with = [&](const Freedom& freedom) {
    return optimise(survey, crawler(), {survey.tag_template}, {0.05, 0}, CostOrder::tags, freedom,
                    first_metres())
        .value();
  };
  const Optimisation spacing = found_with({false, false, false, false});
  REQUIRE(spacing.alternatives.size() == 1);
  CHECK(spacing.alternatives[0].name == "spacing");
  const Optimisation height = found_with({true, false, false, false});
  REQUIRE(height.alternatives.size() == 2);
  CHECK(height.alternatives[1].name == "height and spacing");
  for (const Optimisation& found : {spacing, height}) {
    for (const LayoutReport& report : found.alternatives) {
      CHECK(report.layout.series.pair_angle == survey.series->pair_angle);
      CHECK(report.layout.alpha == found.given.layout.alpha);
    }
  }
  CHECK(spacing.chosen.layout.series.mount_height == survey.series->mount_height);
}

TEST_CASE("what cannot be had is refused in words") {
  const Survey survey = straight_survey(10, 8, 0.4);
  const auto impossible = optimise(survey, crawler(), {}, {1e-6, 0}, CostOrder::tags,
                                   {false, false, false, false}, first_metres());
  REQUIRE_FALSE(impossible.has_value());
  CHECK(impossible.error().message.find("no layout meets the requirement") != std::string::npos);
  Survey as_built = survey;
  as_built.tags[0].surveyed = true;
  CHECK_FALSE(
      optimise(as_built, crawler(), {}, {}, CostOrder::tags, {}, first_metres()).has_value());
  Survey irregular = survey;
  irregular.series.reset();
  CHECK_FALSE(
      optimise(irregular, crawler(), {}, {}, CostOrder::tags, {}, first_metres()).has_value());
}

TEST_CASE("what another height serves is demanded, and heights without digits are none") {
  Survey survey = straight_survey(10, 8, 0.4);
  survey.series->mount_height = 2.4;  // above the pictures of a camera 0.24 m above the floor
  survey = with_layout(survey, {survey.tag_template, *survey.series, std::nullopt});
  const auto found_with = [&](const Freedom& freedom) {
    return optimise(survey, crawler(), {}, {0.05, 0}, CostOrder::tags, freedom, first_metres());
  };
  const auto held = found_with({false, false, false, false});
  REQUIRE_FALSE(held.has_value());
  CHECK(held.error().message.find("must change first") != std::string::npos);
  const auto varied = found_with({true, false, false, false});
  REQUIRE_MESSAGE(varied.has_value(), varied.error().message);
  CHECK(varied->demanded_share == 1);
  survey.code.digit_counts = {5, 4, 2};
  survey.code.origin[2] = 3;  // no height of this tunnel
  const auto uncoded = found_with({true, false, false, false});
  CHECK_FALSE(uncoded.has_value());
}

TEST_CASE("rounding at the end of a stretch adds no place that nothing is known of") {
  PlanOptions options;
  options.to = 3.1999996;
  options.step = 0.1;
  const Survey survey = straight_survey(10, 8, 0.4);
  CHECK_NOTHROW(optimise(survey, crawler(), {}, {0.05, 0}, CostOrder::tags,
                         {false, false, false, false}, options));
}
