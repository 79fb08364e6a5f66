// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reading.hpp"

#include <fmt/format.h>

namespace tagsmith::detail {
namespace {

std::string describe(FrameFault fault) {
  switch (fault) {
    case FrameFault::not_framed:
      return "no white, black, white across its sides";
    case FrameFault::no_edge:
      return "feature frame: a side shows no edge along most of its length";
    case FrameFault::side_too_short:
      return "feature frame: a side is too short";
    case FrameFault::no_fit:
      return "feature frame: a side's edge cannot be fitted";
    case FrameFault::not_closed:
      return "feature frame: its sides do not close";
    case FrameFault::covered:
      return "feature frame: most of it is covered";
    case FrameFault::crossed:
      return "feature frame: its sides go on beyond the corners";
  }
  return {};
}

std::string describe(RejectionReason reason) {
  switch (reason) {
    case RejectionReason::side_hidden:
      return "feature frame: a side is hidden";
    case RejectionReason::no_guards:
      return "no guard patterns inside";
    case RejectionReason::guard_pattern:
      return "guard pattern";
    case RejectionReason::element_widths:
      return "element widths";
    case RejectionReason::covered:
      return "bars covered";
    case RejectionReason::growth:
      return "bars grown or shrunk";
    case RejectionReason::blur:
      return "too blurred";
    case RejectionReason::doubtful:
      return "not certain enough";
    case RejectionReason::lines_disagree:
      return "lines disagree";
    case RejectionReason::ean13:
      return "even parity: EAN-13";
    case RejectionReason::check_digit:
      return "check digit";
    case RejectionReason::not_in_survey:
      return "not in survey";
    case RejectionReason::frame_fault:
    case RejectionReason::stranger:
    case RejectionReason::paper_step:
      break;  // describe(const Rejection&) says these with what was found
  }
  return {};
}

}  // namespace

std::string to_string(ReadingMethod method) {
  switch (method) {
    case ReadingMethod::frame:
      return "frame";
    case ReadingMethod::partly_covered:
      return "frame, partly covered";
    case ReadingMethod::paper:
      return "paper";
  }
  return {};
}

std::string describe(const Rejection& rejection) {
  if (rejection.reason == RejectionReason::frame_fault) return describe(rejection.fault);
  if (rejection.reason == RejectionReason::paper_step) return rejection.step;
  if (rejection.reason == RejectionReason::stranger) {
    const Digits digits = rejection.symbol ? rejection.symbol->decoding.digits : Digits{};
    return "the digits " + to_string(digits) + " are in none of the given surveys";
  }
  return describe(rejection.reason);
}

std::string describe_measured(const Rejection& rejection) {
  if (rejection.limit == 0) return describe(rejection);
  if (rejection.reason == RejectionReason::doubtful) {
    return fmt::format("{} (1 - {:.0e}, at least 1 - {:.0e})", describe(rejection),
                       1 - rejection.measured, 1 - rejection.limit);
  }
  const bool is_low = rejection.measured < rejection.limit;
  return fmt::format("{} ({:.2f}, {} {:.2f})", describe(rejection), rejection.measured,
                     is_low ? "at least" : "at most", rejection.limit);
}

std::string describe(const FramelessRejection& rejection) { return describe(rejection.reason); }

}  // namespace tagsmith::detail
