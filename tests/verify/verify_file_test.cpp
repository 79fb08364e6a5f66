// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_file.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/exif_jpeg.hpp"
#include "tests/support/program.hpp"
#include "tests/verify/survey_of_four.hpp"

namespace tagsmith::detail {

using test::reading_of;

TEST_CASE("a refusal that lies on a reading is no finding") {
  ReadResult result;
  result.tags = {reading_of("019000000404", 100)};
  result.rejected = {{RejectionReason::covered, reading_of("019000800402", 110).corners},
                     {RejectionReason::guard_pattern, reading_of("019000800402", 450).corners}};
  result = without_repeats(std::move(result));
  REQUIRE(result.tags.size() == 1);
  REQUIRE(result.rejected.size() == 1);
  CHECK(result.rejected[0].reason == RejectionReason::guard_pattern);
}

TEST_CASE("a photo is read once, and its negative where no tag was read") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const GrayImage photo = load_gray_image("surveys/corridor/photos/corridor_01_left.jpg").value();
  const GrayImage negative = exchange_black_and_white(photo.view());
  int reads = 0;
  VerifyRequest request{survey};
  request.read = [&](const GrayView& image, const ReadOptions& options) {
    ++reads;
    return read_tags(image, options);
  };
  const auto verified = [&](const GrayImage& image) {
    reads = 0;
    const std::string png = encode_gray_image("a.png", image.view()).value();
    return verify_file(request, {"a.png", png, ""}).value();
  };
  CHECK(findings_of(verified(photo)).empty());
  CHECK(reads == 1);
  CHECK(rules_of(verified(negative)) == std::set<std::string>{"inverted"});
  CHECK(reads == 2);
}

TEST_CASE("tags that the border cuts are named by what is in sight, where that fits the survey") {
  const Survey corridor = load_survey("surveys/corridor/survey.yaml").value();
  const Survey curved = load_survey("surveys/curved/survey.yaml").value();
  const auto cut_off = [](const Survey& survey, const std::string& photo) {
    const VerifyRequest request{survey};
    const VerifiedFile file =
        verify_file(request, "surveys/corridor/photos/" + photo + ".jpg").value();
    std::set<std::string> names;
    for (const VerifiedTag& tag : file.tags) {
      if (tag.finding.status == TagStatus::cut_off) names.insert(tag.tag);
    }
    return names;
  };
  CHECK(cut_off(corridor, "corridor_03_left") == std::set<std::string>{"001L", "003L"});
  CHECK(cut_off(corridor, "corridor_06_right") == std::set<std::string>{"004R"});
  // What is in sight fits 000L and 006R.
  CHECK(cut_off(corridor, "corridor_02_left") == std::set<std::string>{""});
  CHECK(cut_off(curved, "corridor_03_left").empty());
}

TEST_CASE("a tag of which a cable hides a digit is unreadable, and named by the other digits") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const std::filesystem::path file = "surveys/corridor/photos/corridor_03_left.jpg";
  GrayImage photo = load_gray_image(file).value();
  const ReadResult clear = read_tags(photo.view());
  REQUIRE(clear.tags.size() == 1);
  const PlacedTag* tag = find_tag(survey, clear.tags.front().digits);
  REQUIRE(tag != nullptr);
  const Homography map = homography_to(clear.tags.front().corners);
  for (int y = 0; y < photo.height; ++y) {
    const auto row = photo.samples.begin() + static_cast<std::ptrdiff_t>(y) * photo.width;
    std::fill(row + static_cast<int>(map(0.35, 0.5).x), row + static_cast<int>(map(0.4, 0.5).x),
              25);
  }
  const std::string png = encode_gray_image("a.png", photo.view()).value();
  const VerifiedFile verified = verify_file({survey}, {"a.png", png, ""}).value();
  const auto found = std::ranges::find(verified.tags, tag->name, &VerifiedTag::tag);
  REQUIRE(found != verified.tags.end());
  CHECK(found->finding.status == TagStatus::unreadable);
  CHECK(found->finding.rule == "covered");
}

TEST_CASE("each page of a PDF is drawn by its own size") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  // A page so large that it is drawn with fewer dots, and one of 1500 x 1000 points.
  const std::string pdf =
      "%PDF-1.4\n1 0 obj <</Type /Catalog /Pages 2 0 R>> endobj\n"
      "2 0 obj <</Type /Pages /Count 2 /Kids [3 0 R 4 0 R]>> endobj\n"
      "3 0 obj <</Type /Page /Parent 2 0 R /MediaBox [0 0 12000 12000]>> endobj\n"
      "4 0 obj <</Type /Page /Parent 2 0 R /MediaBox [0 0 1500 1000]>> endobj\n"
      "trailer <</Root 1 0 R>>\n%%EOF\n";
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.pdf";
  REQUIRE(write_file(path, pdf));
  std::vector<int> widths;
  VerifyRequest request{survey};
  request.read = [&](const GrayView& image, const ReadOptions&) {
    if (widths.empty() || widths.back() != image.width) widths.push_back(image.width);
    return ReadResult{};
  };
  const auto file = verify_file(request, path);
  REQUIRE_MESSAGE(file, file.error().message);
  CHECK(file->pages == 2);
  REQUIRE(widths.size() == 2);
  CHECK(widths[0] < 12000 * 150 / 72 / 3);
  CHECK(widths[1] == 1500 * 150 / 72);
}

TEST_CASE("of refusals that lie on each other one is kept, that which came nearest to a reading") {
  const Rejection outer{RejectionReason::element_widths, reading_of("019000000404", 100).corners};
  const Rejection doubtful{RejectionReason::doubtful, outer.corners};
  const Rejection elsewhere{RejectionReason::guard_pattern,
                            reading_of("019000000404", 900).corners};
  const auto kept = [](std::vector<Rejection> rejected) {
    std::string reasons;
    for (const Rejection& one : without_repeats({{}, std::move(rejected)}).rejected) {
      reasons += describe(one) + "; ";
    }
    return reasons;
  };
  CHECK(kept({outer, doubtful, elsewhere}) == "not certain enough; guard pattern; ");
  CHECK(kept({doubtful, elsewhere, outer}) == "not certain enough; guard pattern; ");
}

// The photo as a camera stores it that was held so.
std::string photo_held(const std::string& photo, int orientation, bool noted = true) {
  const int back = orientation == 6 ? 8 : orientation == 8 ? 6 : orientation;
  const GrayImage upright = load_gray_image(photo).value();
  const std::string jpeg =
      encode_gray_image("a.jpg", turn_upright(upright.view(), back).view()).value();
  return noted ? test::with_orientation(jpeg, orientation) : jpeg;
}

TEST_CASE("photos of a phone are verified however it was held, and shown upright") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const VerifyRequest request{survey, {}, true};
  const auto verified = [&](const std::string& bytes) {
    return verify_file(request, {"phone.jpg", bytes, ""}).value();
  };
  const std::string good = "surveys/corridor/photos/corridor_01_left.jpg";
  const std::string stranger = "surveys/curved/photos/curved_01_left.jpg";
  const VerifiedFile reference = verified(photo_held(stranger, 1));
  REQUIRE(reference.tags.size() == 1);
  REQUIRE(reference.tags[0].picture.image);
  for (const int orientation : {1, 3, 6, 8}) {
    CAPTURE(orientation);
    CHECK(findings_of(verified(photo_held(good, orientation))).empty());
    const VerifiedFile report = verified(photo_held(stranger, orientation));
    CHECK(report.orientation == orientation);
    REQUIRE(report.tags.size() == 1);
    CHECK(report.tags[0].finding.rule == reference.tags[0].finding.rule);
    REQUIRE(report.tags[0].picture.image);
    const GrayImage& crop = *report.tags[0].picture.image;
    CHECK(std::abs(crop.width - reference.tags[0].picture.image->width) <= 2);
    CHECK(std::abs(crop.height - reference.tags[0].picture.image->height) <= 2);
  }
  // The camera stood on its head, and notes nothing; then, that it stood upright.
  CHECK(findings_of(verified(photo_held(good, 3, false))).empty());
  const VerifiedFile head = verified(test::with_orientation(photo_held(good, 3, false), 1));
  CHECK(rules_of(head) == std::set<std::string>{"upside-down"});
  CHECK(findings_of(head).at(0).starts_with("doubtful: 000L is upside down by the photo's EXIF"));
  CHECK(findings_of(head).at(0).find("no other tag in the photo shows") != std::string::npos);
  CHECK(head.notes.empty());  // that all tags are on their head is no more than that
  CHECK(head.up == UpSource::doubted);
  CHECK(verified(photo_held(good, 1)).up == UpSource::camera);
  CHECK(verified(photo_held(good, 3, false)).up == UpSource::unknown);
}

}  // namespace tagsmith::detail
