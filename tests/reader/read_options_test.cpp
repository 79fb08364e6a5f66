// SPDX-License-Identifier: Apache-2.0
// What each option lets the detector believe of one and the same clear tag.
#include "decoder/reader/read_options.hpp"

#include <doctest/doctest.h>

#include "decoder/reader/detector.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::SeenTag;

namespace {

ReadResult read_in_outline(const SeenTag& tag, const ReadOptions& options) {
  const GrayImage image = tag.image();
  SearchedImage picture(image.view());
  Detector detector(picture, options);
  detector.consider(Outline{{image.view()}, tag.corners()});
  return detector.result();
}

// Why the tag is refused.
RejectionReason refused(const SeenTag& tag, const ReadOptions& options) {
  const ReadResult result = read_in_outline(tag, options);
  CHECK(result.tags.empty());
  REQUIRE(result.rejected.size() == 1);
  return result.rejected[0].reason;
}

void check_read(const SeenTag& tag, const ReadOptions& options) {
  const ReadResult result = read_in_outline(tag, options);
  REQUIRE(result.tags.size() == 1);
  CHECK(result.tags[0].digits == tag.digits);
}

}  // namespace

TEST_CASE("without a word a tag of the published layout is read with any code") {
  const SeenTag tag;
  const ReadOptions options;
  check_read(tag, options);
  CHECK(options.layouts == std::vector{SymbolLayout{}});
  CHECK(read_in_outline(tag, options).tags[0].confidence > kSureInFrame);
}

TEST_CASE("the surer a reading must be, the fewer codes it may be confused with") {
  CHECK(kSureInFrame > 0.999);
  CHECK(kSureWithoutFrame > kSureWithBook);
  CHECK(kSureWithBook > kSureInFrame);
  CHECK(kSureIfCovered > kSureWithBook);
}

TEST_CASE("a check digit that is asked for must hold") {
  const SeenTag tag;  // of the paper's scheme
  ReadOptions options;
  options.check = CheckDigit::sum10;
  check_read(tag, options);
  options.check = CheckDigit::gs1;
  CHECK(read_in_outline(tag, options).tags.empty());
}

TEST_CASE("with a book of codes a clear symbol of another code is a stranger") {
  const SeenTag tag;
  ReadOptions options;
  options.code_book = {*parse_digits("019000900403"), tag.digits};
  check_read(tag, options);
  options.code_book.pop_back();
  CHECK(refused(tag, options) == RejectionReason::stranger);
}

TEST_CASE("a reading below the confidence that is asked for is refused") {
  const SeenTag tag;
  ReadOptions options;
  options.min_confidence = 0.9;
  check_read(tag, options);
  options.min_confidence = 1.1;
  CHECK(refused(tag, options) == RejectionReason::doubtful);
}

TEST_CASE("the layouts say where symbols may stand in their frames") {
  SeenTag tag;
  tag.bars_top += 5;
  tag.bars_bottom += 5;
  const double lower = 5 / (-2 * SeenTag::kTop);
  const SymbolLayout own{9, 0.163 + lower, 0.837 + lower, {}};
  ReadOptions options;
  CHECK(refused(tag, options) == RejectionReason::side_hidden);
  options.layouts = {own};
  check_read(tag, options);
  options.layouts = {SymbolLayout{20, 0.163, 0.837, {}}, own};
  check_read(tag, options);
  options.layouts = {SymbolLayout{}, own};  // differs only in where the bars end
  check_read(tag, options);
}

TEST_CASE("the camera's lens is taken into account where it is known") {
  const SeenTag tag;
  ReadOptions options;
  options.camera = Camera{tag.width, tag.height, 250, 250, 149.5, 89.5};
  check_read(tag, options);
  // Sides that are straight in the picture are not, through a lens that bends.
  options.camera->distortion = {-0.5, 0, 0, 0};
  const ReadResult bent = read_in_outline(tag, options);
  CHECK((bent.tags.empty() || farthest_apart(bent.tags[0].corners, tag.corners()) > 0.2));
}
