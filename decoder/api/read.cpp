// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <tagsmith/read.hpp>

#include "decoder/api/data.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"

namespace tagsmith {
namespace {

using detail::throw_invalid;

// The name of each reason of the reader in the interface.
struct ReasonName {
  detail::RejectionReason reason;
  RefusalReason refusal;
  const char* name;
};

using Rejected = detail::RejectionReason;
using Refused = RefusalReason;
constexpr auto kReasonNames = std::to_array<ReasonName>(
    {{Rejected::frame_fault, Refused::frame_fault, "frame_fault"},
     {Rejected::side_hidden, Refused::side_hidden, "side_hidden"},
     {Rejected::no_guards, Refused::no_guards, "no_guards"},
     {Rejected::guard_pattern, Refused::guard_pattern, "guard_pattern"},
     {Rejected::element_widths, Refused::element_widths, "element_widths"},
     {Rejected::covered, Refused::covered, "covered"},
     {Rejected::growth, Refused::growth, "growth"},
     {Rejected::blur, Refused::blur, "blur"},
     {Rejected::doubtful, Refused::doubtful, "doubtful"},
     {Rejected::stranger, Refused::stranger, "stranger"},
     {Rejected::lines_disagree, Refused::lines_disagree, "lines_disagree"},
     {Rejected::ean13, Refused::ean13, "ean13"},
     {Rejected::check_digit, Refused::doubtful, "doubtful"},
     {Rejected::not_in_survey, Refused::stranger, "stranger"},
     {Rejected::paper_step, Refused::doubtful, "doubtful"}});
static_assert(kReasonNames.size() == static_cast<std::size_t>(Rejected::paper_step) + 1);

RefusalReason reason_from(Rejected reason) {
  return std::ranges::find(kReasonNames, reason, &ReasonName::reason)->refusal;
}

// The meaning of a code: by the survey that has it, else by the code of the paper.
struct Meaning {
  Vector3 position{};
  std::string survey;
  std::string name;
};

Meaning meaning_of(const detail::Digits& digits, const std::vector<Survey>& surveys) {
  for (const Survey& survey : surveys) {
    const detail::Survey& known = survey.data().survey;
    const detail::PlacedTag* tag = find_tag(known, digits);
    if (tag == nullptr) continue;
    return {decode_position(known.code, digits), known.name, tag->name};
  }
  return {decode_position(detail::PositionCode{}, digits), {}, {}};
}

Tag tag_from(const detail::Reading& reading, const std::vector<Survey>& surveys) {
  Meaning meaning = meaning_of(reading.digits, surveys);
  Tag tag;
  tag.digits = detail::to_string(reading.digits);
  tag.sum10_holds = reading.sum10_holds;
  tag.gs1_holds = reading.gs1_holds;
  tag.position = meaning.position;
  tag.survey = std::move(meaning.survey);
  tag.name = std::move(meaning.name);
  tag.corners = detail::corners_from(reading.corners);
  if (!reading.corner_covariance.isZero()) {
    tag.corner_covariance = detail::matrix_from<8>(reading.corner_covariance);
  }
  tag.module_px = reading.module_px;
  tag.confidence = reading.confidence;
  tag.method = reading.method == detail::ReadingMethod::partly_covered
                   ? ReadingMethod::partly_covered
                   : ReadingMethod::frame;
  return tag;
}

FramelessTag tag_from(const detail::FramelessReading& reading, const std::vector<Survey>& surveys) {
  Meaning meaning = meaning_of(reading.digits, surveys);
  return {detail::to_string(reading.digits),
          reading.sum10_holds,
          reading.gs1_holds,
          meaning.position,
          std::move(meaning.survey),
          std::move(meaning.name),
          detail::corners_from(reading.bars),
          reading.module_px,
          reading.confidence};
}

Refusal refusal_from(const detail::Rejection& rejection) {
  return {reason_from(rejection.reason),           describe(rejection), true,
          detail::corners_from(rejection.corners), rejection.measured,  rejection.limit};
}

Refusal refusal_from(const detail::FramelessRejection& rejection) {
  return {reason_from(rejection.reason),
          describe(rejection),
          false,
          detail::corners_from(rejection.symbol.bars),
          0,
          0};
}

detail::Frameless frameless_from(Frameless frameless) {
  switch (frameless) {
    case Frameless::fallback:
      return detail::Frameless::fallback;
    case Frameless::always:
      return detail::Frameless::always;
    case Frameless::never:
      break;
  }
  return detail::Frameless::never;
}

detail::ReadOptions options_for(const std::vector<Survey>& surveys) {
  std::vector<const detail::Survey*> each;
  each.reserve(surveys.size());
  for (const Survey& survey : surveys) each.push_back(&survey.data().survey);
  return detail::read_options_of(each);
}

detail::ReadOptions options_from(const ReadOptions& options, const detail::GrayView& image) {
  detail::ReadOptions read = options_for(options.surveys);
  if (!options.surveys.empty() && read.code_book.empty()) {
    throw_invalid("the surveys have no tags, expected at least one");
  }
  if (options.camera) {
    read.camera = detail::camera_from(*options.camera);
    if (image.width != read.camera->width || image.height != read.camera->height) {
      throw_invalid("the image is " + std::to_string(image.width) + " x " +
                    std::to_string(image.height) + " pixels, expected " +
                    std::to_string(read.camera->width) + " x " +
                    std::to_string(read.camera->height) + " as the camera has");
    }
  }
  if (options.check_digit) {
    read.check = *options.check_digit == CheckDigit::gs1 ? detail::CheckDigit::gs1
                                                         : detail::CheckDigit::sum10;
  }
  if (options.min_confidence) {
    detail::check_number("min_confidence", *options.min_confidence, 0, 1);
    read.min_confidence = options.min_confidence;
  }
  read.white_on_black = read.white_on_black || options.white_on_black;
  read.frameless = frameless_from(options.frameless);
  return read;
}

}  // namespace

const char* to_string(ReadingMethod method) noexcept {
  switch (method) {
    case ReadingMethod::partly_covered:
      return "partly_covered";
    case ReadingMethod::frameless:
      return "frameless";
    case ReadingMethod::frame:
      break;
  }
  return "frame";
}

const char* to_string(RefusalReason reason) noexcept {
  return std::ranges::find(kReasonNames, reason, &ReasonName::refusal)->name;
}

ReadResult read(const ImageView& image, const ReadOptions& options) {
  const detail::GrayView view = detail::checked(image);
  const detail::ReadResult read = read_tags(view, options_from(options, view));
  ReadResult result;
  for (const detail::Reading& reading : read.tags) {
    result.tags.push_back(tag_from(reading, options.surveys));
  }
  for (const detail::FramelessReading& reading : read.frameless.read) {
    result.frameless.push_back(tag_from(reading, options.surveys));
  }
  for (const detail::Rejection& one : read.rejected) result.refusals.push_back(refusal_from(one));
  for (const detail::FramelessRejection& one : read.frameless.rejected) {
    result.refusals.push_back(refusal_from(one));
  }
  return result;
}

}  // namespace tagsmith
