// SPDX-License-Identifier: Apache-2.0
// Surveys of placed tags that could be built, and that somebody who drew them would doubt.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/survey/check_together.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

struct Placed {
  int pair;
  bool right;
  double x, y, z;
  std::string comment;
};

// Two walls of tags 0.8 m apart from y = 140 on, each a few millimetres off the regular place, as a
// total station finds them.
std::vector<Placed> surveyed_tags() {
  std::vector<Placed> tags;
  for (int pair = 0; pair < 60; ++pair) {
    const auto off = [&](int seed) { return 0.006 * std::sin(12.9898 * pair + 78.233 * seed); };
    const double y = 140 + 0.8 * pair;
    tags.push_back({pair, false, 1.9 + off(1), y + off(2), 0.4 + off(3), ""});
    tags.push_back({pair, true, 0.0 + off(4), y + 0.343 + off(5), 0.4 + off(6), ""});
  }
  return tags;
}

std::string survey_text_of(const std::vector<Placed>& tags, const std::string& x_axis = "left") {
  std::string text =
      "survey: drawn\n"
      "grid: { x_axis: " +
      x_axis +
      " }\n"
      "tunnel:\n"
      "  width: 1.9\n"
      "  height: 3.0\n"
      "  centerline: { start: [0.95, 138.0, 0.0], heading: 0, elements: [ { line: 60.0 } ] }\n"
      "tags: { template: tag-400x300, height: 0.4 }\n"
      "code: { check_digit: gs1, resolution: 0.01, digits: [3, 5, 3], origin: [-0.5, 0, 0] }\n"
      "placed:\n";
  for (const Placed& tag : tags) {
    text += fmt::format("  - {{ tag: {:03}{}, side: {}, p: [{:.3f}, {:.3f}, {:.3f}] }}{}\n",
                        tag.pair, tag.right ? 'R' : 'L', tag.right ? "right" : "left", tag.x, tag.y,
                        tag.z, tag.comment);
  }
  return text;
}

constexpr int kFirstTagLine = 10;

std::vector<Diagnostic> findings_of(const std::string& text) {
  const TemporaryFolder folder;
  return read_survey(write_text(folder.path() / "s.yaml", text))->diagnostics;
}

std::string hint_of(const std::vector<Diagnostic>& findings, const std::string& code) {
  for (const Diagnostic& finding : findings) {
    if (finding.code == code) return finding.hint;
  }
  return "no finding of " + code;
}

// The findings when the tag of this index is changed.
std::vector<Diagnostic> findings_with(std::size_t index,
                                      const std::function<void(Placed&)>& change) {
  std::vector<Placed> tags = surveyed_tags();
  change(tags[index]);
  return findings_of(survey_text_of(tags));
}

}  // namespace

TEST_CASE("a survey with the scatter of real ones has no findings") {
  CHECK(to_string(findings_of(survey_text_of(surveyed_tags()))) == "");
}

TEST_CASE("two exchanged digits are found, and what was meant") {
  // Pair 43 stands near y = 174.4; its digits exchanged give 147.4, where pair 9 hangs.
  const auto findings = findings_with(2 * 43, [](Placed& tag) { tag.y = 147.397; });
  CHECK(count_findings(findings, "spacing-outlier", kFirstTagLine + 2 * 43) == 1);
  CHECK(count_findings(findings, "spacing-outlier") == 1);
  CHECK(hint_of(findings, "spacing-outlier") ==
        "y = 174.397 instead of 147.397 would fit: two digits exchanged");
}

TEST_CASE("slips of the pen are named") {
  struct Slip {
    const char* name;
    std::function<void(Placed&)> change;
    const char* code;
    const char* hint;
  };
  const std::vector<Slip> slips{
      {"decimal point", [](Placed& tag) { tag.y = 1480.1; }, "spacing-outlier", "decimal point"},
      {"sign", [](Placed& tag) { tag.x = -1.9; }, "likely-slip", "x = 1.9 instead of -1.9"},
      {"axes", [](Placed& tag) { std::swap(tag.x, tag.y); }, "spacing-outlier",
       "x and y exchanged"},
      {"a height", [](Placed& tag) { tag.z = 4.0; }, "height-outlier", "z = 0.4 instead of 4"},
      {"no slip", [](Placed& tag) { tag.y += 0.3; }, "spacing-outlier", "check p"},
      {"no slip in height", [](Placed& tag) { tag.z += 0.35; }, "height-outlier", "check z"}};
  for (const Slip& slip : slips) {
    CAPTURE(std::string(slip.name));
    std::vector<Placed> tags = surveyed_tags();
    tags[20].y = 148.01;
    slip.change(tags[20]);
    const auto findings = findings_of(survey_text_of(tags));
    CHECK(count_findings(findings, slip.code, kFirstTagLine + 20) == 1);
    CAPTURE(to_string(findings));
    CHECK(hint_of(findings, slip.code).find(slip.hint) != std::string::npos);
  }
}

TEST_CASE("a wrong tag spoils none of its neighbours") {
  std::vector<Placed> tags = surveyed_tags();
  tags[40].y += 0.3;
  tags[44].y -= 0.3;
  const auto findings = findings_of(survey_text_of(tags));
  CHECK(findings.size() == 2);
  CHECK(count_findings(findings, "spacing-outlier", kFirstTagLine + 40) == 1);
  CHECK(count_findings(findings, "spacing-outlier", kFirstTagLine + 44) == 1);
}

TEST_CASE("a pair that stands apart otherwise than the others is found on its own") {
  std::vector<Placed> tags = surveyed_tags();
  tags[30].y -= 0.12;  // each within the tolerance of its wall
  tags[31].y += 0.12;
  const auto findings = findings_of(survey_text_of(tags));
  CHECK(findings.size() == 1);
  CHECK(count_findings(findings, "pair-shift", kFirstTagLine + 31) == 1);
}

TEST_CASE("a mirrored grid and exchanged axes are one finding each") {
  const auto mirrored = findings_of(survey_text_of(surveyed_tags(), "right"));
  CHECK(mirrored.size() == 1);
  CHECK(count_findings(mirrored, "mirrored-grid", kFirstTagLine - 1) == 1);
  CHECK(hint_of(mirrored, "mirrored-grid").find("grid.x_axis: left") == 0);
  std::vector<Placed> exchanged = surveyed_tags();
  for (Placed& tag : exchanged) std::swap(tag.x, tag.y);
  const auto findings = findings_of(survey_text_of(exchanged));
  CHECK(findings.size() == 1);
  CHECK(count_findings(findings, "exchanged-axes", kFirstTagLine - 1) == 1);
}

TEST_CASE("a placed tag is compared with the design where there is one") {
  const std::string with_placed = right_survey() + "  - { tag: 002L, side: left, p: ";
  const TemporaryFolder folder;
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", right_survey()));
  REQUIRE(reading->value);
  const PlacedTag* designed = find_tag(*reading->value, "002L");
  REQUIRE(designed != nullptr);
  const auto findings = [&](const Eigen::Vector3d& p) {
    return findings_of(with_placed +
                       fmt::format("[{:.3f}, {:.3f}, {:.3f}] }}\n", p.x(), p.y(), p.z()));
  };
  const Eigen::Vector3d& p = designed->p_in_grid;
  CHECK(findings(p + Eigen::Vector3d(0, 0, 0.05)).empty());
  CHECK(count_findings(findings(p + Eigen::Vector3d(0, 0, 0.3)), "height-outlier") == 1);
}

TEST_CASE("a placed tag of either wall is compared with the designed one of its pair") {
  const TemporaryFolder folder;
  const std::string designed =
      replaced(right_survey(), "  - { tag: 001R, side: right, p: [12.0, 22.4, 1.4] }\n", "");
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", designed));
  REQUIRE(reading->value);
  for (const std::string side : {"left", "right"}) {
    CAPTURE(side);
    // The wall's other tags hang as designed, this one within the tolerance of its wall.
    const auto shifts_with = [&](double along) {
      std::string text = designed;
      for (const PlacedTag& tag : reading->value->tags) {
        if (to_string(tag.side) != side || tag.pair > 3) continue;
        const Eigen::Vector3d p = tag.p_in_grid + Eigen::Vector3d(0, tag.pair == 2 ? along : 0, 0);
        text += fmt::format("  - {{ tag: {}, side: {}, p: [{:.4f}, {:.4f}, {:.4f}] }}\n", tag.name,
                            side, p.x(), p.y(), p.z());
      }
      return count_findings(findings_of(text), "pair-shift");
    };
    const auto as_designed = shifts_with(0);
    CHECK(shifts_with(0.2) == as_designed + 1);
  }
}

TEST_CASE("codes of neighbours that blur confuses are found, those of far tags are not") {
  std::string text = survey_text_of(surveyed_tags());
  text = replaced(text, "check_digit: gs1", "check_digit: sum10");
  // With the plain sum, y = 141.xx and 147.xx differ by 1/7, and their check digits by 6.
  std::vector<Placed> tags{{0, false, 1.9, 141.10, 0.45, ""}, {1, false, 1.9, 147.10, 0.45, ""}};
  const auto near = findings_of(replaced(survey_text_of(tags), "gs1", "sum10"));
  CHECK(count_findings(near, "alike-codes", 8) == 1);
  tags[1].y = 171.10;
  CHECK(count_findings(findings_of(replaced(survey_text_of(tags), "gs1", "sum10")),
                       "alike-codes") == 0);
}

TEST_CASE("a code that is nearly used up is told before the next section") {
  const auto findings = findings_of(replaced(
      survey_text_of(surveyed_tags()), "resolution: 0.01, digits: [3, 5, 3], origin: [-0.5, 0, 0]",
      "resolution: [0.01, 0.01, 0.01], digits: [4, 4, 3], origin: [-0.5, 90, 0]"));
  CHECK(count_findings(findings, "code-range-end", 8) == 1);
  // x reaches 1.9 m, and this code 1.95 m.
  const auto across = findings_of(replaced(survey_text_of(surveyed_tags()),
                                           "digits: [3, 5, 3], origin: [-0.5, 0, 0]",
                                           "digits: [3, 5, 3], origin: [-8.04, 0, 0]"));
  CHECK(count_findings(across, "code-range-end", 8) == 1);
  CHECK(count_findings(findings_of(survey_text_of(surveyed_tags())), "code-range-end") == 0);
}

TEST_CASE("a theta too small for the paper's method is told") {
  const auto findings = findings_of(replaced(right_survey(), "width: 4.0", "width: 7.0"));
  CHECK(count_findings(findings, "small-theta") == 1);
}

TEST_CASE("a comment with a reason silences a warning on its line or the next") {
  std::vector<Placed> tags = surveyed_tags();
  tags[40].y += 0.3;
  const std::string allow = "  # tagsmith: allow spacing-outlier: hangs beside the fire door";
  tags[40].comment = allow;
  CHECK(to_string(findings_of(survey_text_of(tags))) == "");
  tags[40].comment.clear();
  tags[39].comment = "\n" + allow;
  CHECK(to_string(findings_of(survey_text_of(tags))) == "");
  tags[39].comment = allow;
  const auto elsewhere = findings_of(survey_text_of(tags));
  CHECK(count_findings(elsewhere, "spacing-outlier") == 1);
  CHECK(count_findings(elsewhere, "unused-allow", kFirstTagLine + 39) == 1);
}

TEST_CASE("a comment that allows must name a rule and a reason, and errors stay") {
  const auto findings_of_comment = [](const std::string& comment) {
    std::vector<Placed> tags = surveyed_tags();
    tags[40].x += 0.4;
    tags[40].comment = comment;
    return findings_of(survey_text_of(tags));
  };
  const auto unknown = findings_of_comment(" # tagsmith: allow of-wall: a niche");
  CHECK(count_findings(unknown, "bad-allow", kFirstTagLine + 40) == 1);
  const auto silent = findings_of_comment(" # tagsmith: allow off-wall");
  CHECK(count_findings(silent, "bad-allow", kFirstTagLine + 40) == 1);
  const auto error = findings_of_comment(" # tagsmith: allow off-wall: a niche");
  CHECK(count_findings(error, "off-wall", kFirstTagLine + 40) == 1);
}

TEST_CASE("digits that say another tag's place are told, with the tag") {
  std::vector<Placed> tags = surveyed_tags();
  const auto digits_of = [&](int pair, const std::string& resolution) {
    const TemporaryFolder folder;
    const std::string text = replaced(survey_text_of(tags), "resolution: 0.01", resolution);
    const auto reading = read_survey(write_text(folder.path() / "s.yaml", text));
    REQUIRE_MESSAGE(reading->value, to_string(reading->diagnostics));
    return to_string(reading->value->tags[static_cast<std::size_t>(2 * pair)].digits);
  };
  const auto exchange = [&](const std::string& resolution, int one, int another) {
    std::string text = replaced(survey_text_of(tags), "resolution: 0.01", resolution);
    for (const auto& [pair, other] : {std::pair{one, another}, std::pair{another, one}}) {
      const std::string name = fmt::format("{{ tag: {:03}L, ", pair);
      text = replaced(text, name, name + "digits: \"" + digits_of(other, resolution) + "\", ");
    }
    return findings_of(text);
  };
  const auto findings = exchange("resolution: 0.01", 10, 12);
  CHECK(count_findings(findings, "exchanged-code") == 2);
  CHECK(count_findings(findings, "exchanged-code", kFirstTagLine + 20) == 1);
  for (const Diagnostic& finding : findings) {
    if (finding.line != kFirstTagLine + 20) continue;
    const std::size_t own = finding.message.find("010L");
    CHECK(own != std::string::npos);
    CHECK(finding.message.find("012L", own) != std::string::npos);
  }
  CHECK(count_findings(findings_of(survey_text_of(tags)), "exchanged-code") == 0);
  // 0.8 m apart: codes of 0.7 m, which are different, cannot tell.
  const auto coarse = exchange("resolution: [0.5, 0.7, 0.5]", 10, 11);
  CHECK(count_findings(coarse, "exchanged-code") == 0);
}

TEST_CASE("digits that say the place of another survey's tag are told") {
  const TemporaryFolder folder;
  const auto tags_from = [](int first) {
    std::vector<Placed> tags = surveyed_tags();
    std::erase_if(tags,
                  [&](const Placed& tag) { return tag.pair < first || tag.pair >= first + 20; });
    return tags;
  };
  const auto digits_of = [&](const Survey& survey, const std::string& name) {
    for (const PlacedTag& tag : survey.tags) {
      if (tag.name == name) return to_string(tag.digits);
    }
    return std::string();
  };
  const std::string low = replaced(survey_text_of(tags_from(0)), "survey: drawn", "survey: low");
  const std::string high = replaced(survey_text_of(tags_from(30)), "survey: drawn", "survey: high");
  const auto loaded = [&](const std::string& file, const std::string& text) {
    return *read_survey(write_text(folder.path() / file, text))->value;
  };
  const Survey below = loaded("low.yaml", low);
  const Survey above = loaded("high.yaml", high);
  CHECK(check_together({below, above}).empty());
  const auto with = [&](const std::string& text, const std::string& name, const std::string& digits,
                        const std::string& comment) {
    const std::string head = "{ tag: " + name + ", ";
    return replaced(replaced(text, head, head + "digits: \"" + digits + "\", "), "  - " + head,
                    comment + "  - " + head);
  };
  const Survey wrong = loaded("low.yaml", with(low, "003L", digits_of(above, "035L"), ""));
  const Survey other = loaded("high.yaml", with(high, "035L", digits_of(below, "003L"), ""));
  CHECK(count_findings(check_together({wrong, other}), "exchanged-code") == 2);
  const Survey allowed =
      loaded("low.yaml", with(low, "003L", digits_of(above, "035L"),
                              "  # tagsmith: allow exchanged-code: hung so on purpose\n"));
  CHECK(count_findings(check_together({allowed, other}), "exchanged-code") == 1);
}
