// SPDX-License-Identifier: Apache-2.0
// The decoder of scan profiles, on any profile, with and without a code book.
#include <cmath>

#include "decoder/scan/decode.hpp"
#include "decoder/scan/decode_part.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

namespace {

// Places in their order; darkness and variance as far off as the pixels allow.
ScanProfile any_profile(fuzz::Numbers& numbers) {
  ScanProfile profile;
  double at = numbers.real(-10, 20);
  const double step = numbers.real(0.05, 2);
  while (!numbers.is_empty() && at < 110 && profile.size() < 1000) {
    ScanBin bin;
    bin.at = at;
    bin.darkness = numbers.real(-3, 4);
    bin.variance = std::pow(10.0, numbers.real(-9, 1));
    profile.push_back(bin);
    at += step;
  }
  return profile;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Numbers numbers(fuzz::as_text(data, size));
  const std::array book{*parse_digits("019000700401"), *parse_digits("019000701408"),
                        *parse_digits("123456789012")};
  ImagingModel start;
  start.blur = numbers.real(0.05, 2);
  start.pixel = numbers.real(0, 3);
  const int choice = numbers.integer(3);
  const ScanProfile profile = any_profile(numbers);
  if (profile.size() < 40) return 0;
  DecodeOptions options;
  if (choice & 1) options.code_book = book;
  if (const auto decoding = decode_profile(profile, start, options)) {
    (void)log_odds_of_another(profile, *decoding);
  }
  options.code_book = book;
  (void)decode_part(profile, start, options);
  return 0;
}
