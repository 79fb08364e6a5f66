// SPDX-License-Identifier: Apache-2.0
// Scan profile -> digits, by maximum likelihood over whole symbols.
#pragma once

#include <optional>

#include "decoder/scan/decoding.hpp"
#include "decoder/scan/profile.hpp"

namespace tagsmith::detail {

// Starts from the given picture of the symbol (its blur is what matters) and alternates between the
// most likely digits, exact by dynamic programming over neighbouring digits, and the adjustment of
// the picture to them. The profile must have at least 40 places.
std::optional<Decoding> decode_profile(const ScanProfile& profile, const ImagingModel& start,
                                       const DecodeOptions& options);

// By what logarithm of the likelihood ratio another symbol, of any characters, explains a profile
// of the same symbol better than these digits, by the decoding's noise: 0 where none does.
double log_odds_of_another(const ScanProfile& profile, const Decoding& decoding);

}  // namespace tagsmith::detail
