// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/qr_symbol.hpp"

#include <cmath>
#include <memory>
#include <qrencode.h>

#include <fmt/format.h>

namespace tagsmith::detail {
namespace {

constexpr int kQuietModules = 4;         // ISO/IEC 18004, 5.3.8
constexpr double kLeastModule = 0.0004;  // metres: two pixels of a phone that reads from 0.25 m

}  // namespace

Result<QrDrawing> qr_symbol(const std::string& content, const Rectangle& box) {
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(content.c_str(), 0, QR_ECLEVEL_M, QR_MODE_8, 1), QRcode_free);
  if (code == nullptr) return fail("the QR symbol cannot carry \"" + content + "\"");
  const int across = code->width + 2 * kQuietModules;
  const double module = box.width / across;
  if (module < kLeastModule) {
    return fail(
        fmt::format("the QR symbol of \"{}\" has {} modules across with its quiet zone: "
                    "phones need a size_mm of {} or more, or a shorter content",
                    content, across, std::ceil(across * kLeastModule * 1e3)));
  }
  QrDrawing drawing{box};
  for (int row = 0; row < code->width; ++row) {
    const unsigned char* cells = code->data + static_cast<std::ptrdiff_t>(row) * code->width;
    for (int first = 0, last = 0; first < code->width; first = last + 1) {
      for (last = first; last < code->width && (cells[last] & 1) != 0;) ++last;
      if (last == first) continue;
      drawing.modules.push_back({box.x + (kQuietModules + first) * module,
                                 box.y + (kQuietModules + row) * module, (last - first) * module,
                                 module});
    }
  }
  return drawing;
}

}  // namespace tagsmith::detail
