// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/findings.hpp"

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "decoder/verify/verify_merge.hpp"
#include "tests/verify/survey_of_four.hpp"

namespace tagsmith::detail {
namespace {

using test::reading_of;
using test::survey_of_four;

FrameCorners rectangle(double width, double height) {
  return {{{10, 20}, {10 + width, 20}, {10 + width, 20 + height}, {10, 20 + height}}};
}

// What is found in a picture of 1280 x 960 pixels in which the reader says this.
std::vector<VerifiedTag> check_tags(const Survey& survey, const ReadResult& readings,
                                    bool is_photo = false) {
  const GrayImage image{1280, 960, std::vector<std::uint8_t>(1280 * 960)};
  PictureEvidence evidence{survey, image.view()};
  evidence.is_photo = is_photo;
  see_tags([&](auto&, auto&) { return readings; }, evidence);
  find_faults(evidence);
  std::vector<VerifiedTag> tags;
  for (const TagEvidence& seen : evidence.tags) tags.push_back(seen.tag);
  return tags;
}

}  // namespace

TEST_CASE("a reading becomes a finding against the survey") {
  struct Case {
    const char* name;
    const char* digits;
    TagStatus status;
    const char* tag;
    const char* message;  // part of it
  };
  const Case cases[] = {
      {"a code of the survey", "019000000404", TagStatus::ok, "000L", ""},
      {"a valid code that the survey does not have", "019001600401", TagStatus::unknown, "",
       "019001600401 is not in survey little"},
      {"one that is nearest to one tag", "019000000413", TagStatus::misprinted, "",
       "nearest is 000L 019000000404, which differs in digit 11 (found 1, expected 0), digit 12 "
       "(found 3, expected 4)"},
      {"a code of the survey with the other check digit", "019000000408", TagStatus::misprinted,
       "000L",
       "019000000408 ends with check digit 8, expected 4 (sum10); nearest is 000L 019000000404, "
       "which differs in digit 12 (found 8, expected 4)"},
      {"with the other check digit, as near to another", "019000800404", TagStatus::misprinted,
       "001L", "nearest is 001L 019000800402, which differs in digit 12"},
      {"a strange code that neither check digit fits", "123456789013", TagStatus::misprinted, "",
       "123456789013 ends with check digit 3, expected 6 (sum10)"},
      {"a strange code with the other check digit", "123456789012", TagStatus::unknown, "",
       "123456789012 is not in survey little, and right by gs1"},
  };
  for (const Case& one : cases) {
    CAPTURE(one.name);
    const auto findings = check_tags(survey_of_four(), {{reading_of(one.digits)}, {}});
    REQUIRE(findings.size() == 1);
    CHECK(to_string(findings[0].finding.status) == to_string(one.status));
    CHECK(findings[0].tag == one.tag);
    CHECK_MESSAGE(findings[0].finding.message.find(one.message) != std::string::npos,
                  findings[0].finding.message);
    CHECK(to_string(*findings[0].digits) == one.digits);
  }
}

TEST_CASE("a tag seen twice in one picture is a duplicate, and a refusal is unreadable") {
  ReadResult readings;
  readings.tags = {reading_of("019000000404"), reading_of("019000000404", 600)};
  readings.rejected = {{RejectionReason::guard_pattern, rectangle(50, 20)}};
  const auto findings = check_tags(survey_of_four(), readings);
  REQUIRE(findings.size() == 3);
  CHECK(findings[0].finding.status == TagStatus::ok);
  CHECK(findings[1].finding.status == TagStatus::duplicate);
  CHECK(findings[1].corners[0].x == 600);
  CHECK(findings[2].finding.status == TagStatus::unreadable);
  CHECK(findings[2].finding.message.find(describe(readings.rejected[0])) != std::string::npos);
  CHECK(!findings[2].digits);
}

TEST_CASE("a refusal near the edge of a photo is cut off, one in its middle unreadable") {
  const auto status = [](double x, double y, bool is_photo) {
    FrameCorners corners = rectangle(400, 200);
    for (PixelPoint& corner : corners) corner = corner + PixelPoint{x - 10, y - 20};
    const auto findings =
        check_tags(survey_of_four(), {{}, {{RejectionReason::element_widths, corners}}}, is_photo);
    return to_string(findings.at(0).finding.status);
  };
  CHECK(status(400, 300, true) == "unreadable");
  CHECK(status(90, 300, true) == "cut_off");
  CHECK(status(110, 300, true) == "unreadable");
  CHECK(status(790, 300, true) == "cut_off");
  CHECK(status(400, 40, true) == "cut_off");
  CHECK(status(400, 715, true) == "cut_off");
  CHECK(status(0, 0, false) == "unreadable");
}

TEST_CASE("a survey without tags knows no code") {
  Survey survey = survey_of_four();
  survey.tags.clear();
  const auto findings = check_tags(survey, {{reading_of("019000000404")}, {}});
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].finding.status == TagStatus::unknown);
  CHECK(nearest_tag(survey, *findings[0].digits) == nullptr);
}

TEST_CASE("a print at the wrong scale is found") {
  const Survey survey = survey_of_four();
  const double metres_per_pixel = 0.0254 / 150;
  struct Case {
    const char* name;
    double length;
    double height;
    bool fits;
  };
  const Case cases[] = {{"exact", 0.343, 0.168, true},
                        {"0.4 % short", 0.343 * 0.996, 0.168 * 0.996, true},
                        {"fitted to a smaller page", 0.343 * 0.97, 0.168 * 0.97, false},
                        {"scaled in height only", 0.343, 0.168 * 1.02, false},
                        {"turned", 0.168, 0.343, false}};
  for (const Case& one : cases) {
    CAPTURE(one.name);
    TagEvidence seen;
    seen.tag.corners = rectangle(one.length / metres_per_pixel, one.height / metres_per_pixel);
    PictureEvidence evidence{survey, {}};
    evidence.metres_per_pixel = metres_per_pixel;
    CHECK(find_wrong_scale(evidence, seen).has_value() != one.fits);
  }
}

TEST_CASE("a frame in a file is to be right to 0.2 %, and to be a rectangle") {
  const Survey survey = survey_of_four();
  PictureEvidence evidence{survey, {}};
  evidence.metres_per_pixel = 0.0254 / 150;
  const double width = 0.343 / evidence.metres_per_pixel;
  const double height = 0.168 / evidence.metres_per_pixel;
  const auto is_found = [&](const FrameCorners& corners) {
    TagEvidence seen;
    seen.tag.corners = corners;
    return find_wrong_scale(evidence, seen).has_value();
  };
  const FrameCorners smaller = rectangle(0.9965 * width, 0.9965 * height);
  CHECK_FALSE(is_found(smaller));
  const auto sheared = [&](double share) {
    FrameCorners corners = rectangle(width, height);
    for (const std::size_t below : {2U, 3U}) corners[below].x += share * height;
    return corners;
  };
  const auto narrowed = [&](double share) {
    FrameCorners corners = rectangle(width, height);
    corners[2].x -= share * width / 2;
    corners[3].x += share * width / 2;
    return corners;
  };
  CHECK_FALSE(is_found(sheared(0.004)));
  CHECK(is_found(sheared(0.02)));
  CHECK_FALSE(is_found(narrowed(0.004)));
  CHECK(is_found(narrowed(0.01)));
  evidence.up = UpSource::page;
  CHECK(is_found(smaller));
  CHECK_FALSE(is_found(rectangle(0.999 * width, 0.999 * height)));
  CHECK(is_found(sheared(0.008)));
}

TEST_CASE("what a later run finds in a file is listed, and the file counted once") {
  VerifiedFile plain{"photo.jpg"};
  plain.sha256 = "ab";
  plain.tags.resize(1);
  plain.tags[0].tag = "000L";
  VerifiedFile strict = plain;
  strict.tags[0].finding.status = TagStatus::misplaced;
  strict.tags[0].finding.rule = "moved";
  strict.add_finding("stale", "stale: because");
  VerifiedTag& unnamed = strict.tags.emplace_back();
  unnamed.finding.status = TagStatus::unreadable;
  unnamed.finding.rule = "glare";
  for (const bool strict_first : {true, false}) {
    VerifyMerge merged;
    merge("", strict_first ? strict : plain, merged);
    merge("", strict_first ? plain : strict, merged);
    merge("", strict, merged);
    CHECK(merged.files == 1);
    CHECK(merged.repeated == 2);
    CHECK(merged.fault_count == 3);
    CHECK_FALSE(merged.tags.contains(""));
    CHECK(merged.tags["000L"].faults == 1);
    CHECK(status_of(merged.tags["000L"]) == "faulty");
  }
}

TEST_CASE("a frame that is too small alike both ways has one scale, a stretched one two") {
  const Survey survey = survey_of_four();
  PictureEvidence evidence{survey, {}};
  evidence.metres_per_pixel = 0.0254 / 150;
  const auto percentages = [&](double wide, double high) {
    TagEvidence seen;
    seen.tag.corners = rectangle(0.343 * wide / evidence.metres_per_pixel,
                                 0.168 * high / evidence.metres_per_pixel);
    const auto found = find_wrong_scale(evidence, seen);
    REQUIRE(found);
    return std::ranges::count(found->message, '%');
  };
  CHECK(percentages(0.97, 0.97) == 1);
  CHECK(percentages(1.04, 1.04) == 1);
  CHECK(percentages(0.97, 1 / 0.97) == 2);
  CHECK(percentages(1, 0.97) == 2);
}

TEST_CASE(
    "what several photos show of one plate, or of one strange code, is one fault of a report") {
  const Survey survey = survey_of_four();
  VerifyMerge merged;
  for (const char* photo : {"a.jpg", "b.jpg", "c.jpg"}) {
    VerifiedFile file{photo};
    file.width = 1280;
    file.tags = check_tags(survey, {{reading_of("019000000408"), reading_of("123456789012", 600)},
                                    {{RejectionReason::guard_pattern, rectangle(50, 20)}}});
    merge("", file, merged);
  }
  REQUIRE(merged.faults.size() == 9);
  const std::vector<FaultRecord> plates = faults_by_plate(merged);
  REQUIRE(plates.size() == 5);  // nothing tells whether what cannot be read is one plate
  const auto of = [&](const std::string& rule) {
    return *std::ranges::find(plates, rule, &FaultRecord::rule);
  };
  CHECK(of("check-scheme").tag == "000L");
  for (const char* rule : {"check-scheme", "not-in-survey"}) {
    CHECK(of(rule).file == "in 3 files: a.jpg, b.jpg, c.jpg");
  }
}

TEST_CASE("of several judgements of where a tag hangs that by most places counts, in any order") {
  const auto judged = [](int stations) {
    VerifiedTag tag;
    tag.tag = "000L";
    tag.hung = HungTag{"000L", HangVerdict::fits, stations, {}, {}, {}, {}, {}};
    VerifiedFile file{std::to_string(stations) + ".jpg"};
    file.tags = {tag};
    return file;
  };
  for (const auto& [first, second] : {std::pair(2, 5), std::pair(5, 2)}) {
    VerifyMerge merged;
    merge("", judged(first), merged);
    merge("", judged(second), merged);
    CHECK(merged.hung.at("000L").stations == 5);
  }
}

TEST_CASE("tags that cameras noted on their head are counted, those with another fault are not") {
  VerifyMerge merged;
  for (const char* rule : {"upside-down", "mirrored"}) {
    VerifiedTag tag;
    tag.tag = "000L";
    tag.finding.status = TagStatus::misprinted;
    tag.finding.rule = rule;
    VerifiedFile file{std::string(rule) + ".jpg"};
    file.up = UpSource::doubted;
    file.tags = {tag, tag};
    if (tag.finding.rule == "mirrored") file.tags.pop_back();
    merge("", file, merged);
  }
  CHECK(merged.noted_up.on_head == 2);
  CHECK(merged.noted_up.upright == 0);
}

TEST_CASE(
    "plates are said to hang wrong only where cameras note more tags upright than on the head") {
  const auto advice = [](std::size_t upright, std::size_t on_head) {
    const std::string words = noted_up_in_words({upright, on_head});
    return words.substr(words.find(": "));
  };
  CHECK(advice(3, 2) == advice(9, 1));
  CHECK(advice(2, 2) == advice(1, 9));
  CHECK(advice(2, 2) != advice(3, 2));
}

TEST_CASE("the summary counts by status and names the tags that nobody saw") {
  const Survey survey = survey_of_four();
  VerifiedFile good{"good.jpg"};
  good.tags = check_tags(survey, {{reading_of("019000000404")}, {}});
  VerifiedFile bad{"bad.jpg"};
  bad.tags = check_tags(survey, {{reading_of("000000340401"), reading_of("000000340401", 600),
                                  reading_of("123456789013"), reading_of("019001600401")},
                                 {{RejectionReason::guard_pattern, rectangle(50, 20)}}});
  VerifyMerge merged;
  merge("", good, merged);
  merge("", bad, merged);
  const auto count = [&](TagStatus status) {
    return merged.by_status[static_cast<std::size_t>(status)];
  };
  CHECK(merged.files == 2);
  CHECK(merged.files_with_findings == 1);
  CHECK_FALSE(merged.tags.at("000L").best);  // its print was not graded
  CHECK(count(TagStatus::ok) == 2);
  CHECK(count(TagStatus::duplicate) == 1);
  CHECK(count(TagStatus::misprinted) == 1);
  CHECK(count(TagStatus::unknown) == 1);
  CHECK(count(TagStatus::unreadable) == 1);
  CHECK(missing_tags(survey, merged) == std::vector<std::string>{"001L", "001R"});
}

TEST_CASE("a photo without a tag is a fault only where no photo shows one") {
  const Survey survey = survey_of_four();
  VerifiedFile wall{"wall.jpg"};
  wall.width = wall.height = 500;
  wall.add_finding("no-tag", "no tag was found");
  VerifiedFile page{"page.pdf"};
  page.tags = check_tags(survey, {{reading_of("019000000404")}, {}});
  VerifiedFile photo = page;
  photo.file = "photo.jpg";
  photo.width = photo.height = 500;

  VerifyMerge alone;
  merge("", wall, alone);
  merge("", page, alone);  // a print file is no photo
  finish(alone);
  CHECK(alone.files_with_findings == 1);
  CHECK(alone.fault_count == 1);
  CHECK(alone.faults.at(0).rule == "no-tag");
  CHECK(alone.without_tag_count == 0);

  for (const bool is_first : {true, false}) {
    VerifyMerge among;
    merge("", is_first ? wall : photo, among);
    merge("", is_first ? photo : wall, among);
    finish(among);
    CHECK(among.files_with_findings == 0);
    CHECK(among.fault_count == 0);
    CHECK(among.without_tag_count == 1);
    CHECK(without_tag_in_words(among) == "1 photo without a tag: wall.jpg");
  }

  VerifiedFile dark = wall;
  dark.rules = {"too-dark"};  // might hold any tag
  VerifyMerge with_dark;
  merge("", photo, with_dark);
  merge("", dark, with_dark);
  finish(with_dark);
  CHECK(with_dark.files_with_findings == 1);
}

}  // namespace tagsmith::detail
