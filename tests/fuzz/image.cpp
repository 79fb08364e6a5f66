// SPDX-License-Identifier: Apache-2.0
// Picture files: headers, what cameras write into them, and their pixels where they are few.
#include "decoder/image/exif.hpp"
#include "decoder/image/heif.hpp"
#include "decoder/image/image_header.hpp"
#include "decoder/image/load.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

namespace {

constexpr double kMostPixels = 1e6;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(fuzz::as_text(data, size));
  (void)exif_orientation(bytes);
  (void)shown_orientation(bytes);
  (void)photo_lens(bytes);
  (void)photo_moment(bytes);
  (void)is_video(bytes);
  const auto header = read_image_header(bytes);
  if (header && 1.0 * header->width * header->height > kMostPixels) return 0;
  // What libheif and its decoders make of a broken file is theirs to test.
  if (!is_heif(bytes)) (void)decode_image("fuzz", bytes);
  return 0;
}
