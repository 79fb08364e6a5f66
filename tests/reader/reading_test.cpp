// SPDX-License-Identifier: Apache-2.0
// What is told of readings and refusals, in words.
#include "decoder/reader/reading.hpp"

#include <set>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

TEST_CASE("each reason for a refusal has words of its own") {
  std::set<std::string> told;
  constexpr int kReasons = static_cast<int>(RejectionReason::paper_step);
  for (int i = 0; i <= kReasons; ++i) {
    Rejection rejection;
    rejection.reason = static_cast<RejectionReason>(i);
    rejection.step = "the third threshold found no edge";
    CAPTURE(i);
    CHECK(!describe(rejection).empty());
    told.insert(describe(rejection));
  }
  CHECK(told.size() == kReasons + 1);
}

TEST_CASE("each fault of a frame has words of its own") {
  std::set<std::string> told;
  constexpr int kFaults = static_cast<int>(FrameFault::covered);
  for (int i = 0; i <= kFaults; ++i) {
    Rejection rejection;
    rejection.reason = RejectionReason::frame_fault;
    rejection.fault = static_cast<FrameFault>(i);
    CAPTURE(i);
    CHECK(!describe(rejection).empty());
    told.insert(describe(rejection));
  }
  CHECK(told.size() == kFaults + 1);
}

TEST_CASE("a refusal names what it found") {
  Rejection stranger;
  stranger.reason = RejectionReason::stranger;
  stranger.symbol.emplace();
  stranger.symbol->decoding.digits = *parse_digits("019000700418");
  CHECK(describe(stranger).find("019000700418") != std::string::npos);
  Rejection step;
  step.reason = RejectionReason::paper_step;
  step.step = "the third threshold found no edge";
  CHECK(describe(step) == step.step);
  FramelessRejection frameless;
  frameless.reason = RejectionReason::element_widths;
  Rejection framed;
  framed.reason = RejectionReason::element_widths;
  CHECK(describe(frameless) == describe(framed));
}

TEST_CASE("each way of reading has a name of its own") {
  CHECK(to_string(ReadingMethod::frame) == "frame");
  CHECK(to_string(ReadingMethod::partly_covered) == "frame, partly covered");
  CHECK(to_string(ReadingMethod::paper) == "paper");
}
