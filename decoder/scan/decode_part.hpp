// SPDX-License-Identifier: Apache-2.0
// Scan profile of a part of a symbol -> the codes of a book that it may belong to.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "decoder/scan/decoding.hpp"
#include "decoder/scan/profile.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// A code of the book that a part of a symbol may belong to.
struct PartCandidate {
  Digits digits{};
  double odds = 1;  // against the likeliest, by the digits in sight
};

// What a profile of a part of a symbol shows. In the decoding, `digits` are the likeliest
// candidate's, and `confidence` and `doubt` concern the certain digits alone: that they are those
// of one of the candidates. They do not say whether another plate with the same certain digits
// stands there.
struct PartDecoding {
  Decoding decoding;
  // The digits of which the profile shows all modules, so clearly that no other character may stand
  // there.
  std::array<bool, kDigitCount> certain{};
  std::vector<PartCandidate> candidates{};  // likeliest first; not empty
};

// As decode_profile, for a profile that begins or ends within the symbol or hides places of it,
// against a code book, which must not be empty. Codes that differ in no digit in sight are equally
// candidates. Why: docs/decisions/0005-parts-and-frameless-symbols.md.
std::optional<PartDecoding> decode_part(const ScanProfile& profile, const ImagingModel& start,
                                        const DecodeOptions& options);

}  // namespace tagsmith::detail
