// SPDX-License-Identifier: Apache-2.0
// The reader on pictures of any size and any pixels: beside noise, a tag that is drawn somewhere
// with anything over it. Nothing is read but what was drawn.
#include <cstdlib>

#include "decoder/reader/reader.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;

namespace {

// A picture of up to 240 x 160 pixels, a tag in it or beside its border.
GrayImage drawn(fuzz::Numbers& numbers, const Digits& digits) {
  test::SeenTag tag;
  tag.digits = digits;
  tag.width = numbers.integer(240);
  tag.height = numbers.integer(160);
  tag.view.middle = {numbers.real(-50, 290), numbers.real(-50, 210)};
  tag.view.module_px = numbers.real(0.3, 2);
  tag.view.turn = numbers.real(0, 6.3);
  tag.view.slant = {numbers.real(-0.004, 0.004), numbers.real(-0.004, 0.004)};
  tag.blur_px = numbers.real(0.2, 2);
  tag.white = numbers.real(0, 1);
  tag.black = numbers.real(0, 1);
  tag.framed = numbers.integer(7) != 0;
  return tag.image();
}

void spoil(fuzz::Numbers& numbers, GrayImage& image) {
  while (!numbers.is_empty() && !image.samples.empty()) {
    const auto at = static_cast<std::size_t>(numbers.integer(65535)) % image.samples.size();
    image.samples[at] = static_cast<std::uint8_t>(numbers.integer(255));
  }
}

void require_only(const std::vector<Reading>& readings, const Digits& digits) {
  for (const Reading& reading : readings) {
    if (reading.digits != digits) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Numbers numbers(fuzz::as_text(data, size));
  static const Digits digits = *parse_digits("019000700401");
  static const Digits other = *parse_digits("019000701408");
  const int choice = numbers.integer(3);
  ReadOptions options;
  if (choice & 1) options.code_book = {digits, other};
  if (choice & 2) options.frameless = Frameless::always;
  GrayImage image = drawn(numbers, digits);
  spoil(numbers, image);
  if (image.width == 0 || image.height == 0) return 0;
  require_only(read_tags(image.view(), options).tags, digits);
  return 0;
}
