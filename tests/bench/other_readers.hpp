// SPDX-License-Identifier: Apache-2.0
// Stock barcode readers to compare with, where they are installed. The program does not link them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail::bench {

struct OtherReader {
  std::string name;
  // Codes of the UPC-A symbols found, 12 digits; EAN-13 with a leading 0 is UPC-A, any other is
  // given with its 13.
  std::set<std::string> (*read)(const GrayView& image);
};

// zbar and zxing-cpp with their usual settings, set to UPC-A and EAN-13 alone; those that are
// there. They demand the gs1 check digit. zxing-cpp gives one symbol a picture.
const std::vector<OtherReader>& other_readers();

}  // namespace tagsmith::detail::bench
