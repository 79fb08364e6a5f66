// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/other_readers.hpp"

#if defined(TAGSMITH_BENCH_ZBAR)
#include <zbar.h>
#endif
#if defined(TAGSMITH_BENCH_ZXING)
#define ZX_USE_UTF8 1  // text() as std::string
#include <ZXing/ReadBarcode.h>
#endif

namespace tagsmith::detail::bench {
namespace {

[[maybe_unused]] std::string as_upca(const std::string& digits) {
  return digits.size() == 13 && digits[0] == '0' ? digits.substr(1) : digits;
}

#if defined(TAGSMITH_BENCH_ZBAR)
std::set<std::string> read_zbar(const GrayView& view) {
  zbar::ImageScanner scanner;
  scanner.set_config(zbar::ZBAR_NONE, zbar::ZBAR_CFG_ENABLE, 0);
  scanner.set_config(zbar::ZBAR_EAN13, zbar::ZBAR_CFG_ENABLE, 1);
  scanner.set_config(zbar::ZBAR_UPCA, zbar::ZBAR_CFG_ENABLE, 1);
  zbar::Image image(
      static_cast<unsigned>(view.width), static_cast<unsigned>(view.height), "Y800", view.data,
      static_cast<unsigned long>(view.width) * static_cast<unsigned long>(view.height));
  scanner.scan(image);
  std::set<std::string> codes;
  for (auto symbol = image.symbol_begin(); symbol != image.symbol_end(); ++symbol) {
    codes.insert(as_upca(symbol->get_data()));
  }
  return codes;
}
#endif

#if defined(TAGSMITH_BENCH_ZXING)
std::set<std::string> read_zxing(const GrayView& view) {
  const ZXing::ImageView image(view.data, view.width, view.height, ZXing::ImageFormat::Lum,
                               static_cast<int>(view.stride));
  ZXing::DecodeHints hints;
  hints.setFormats(ZXing::BarcodeFormat::UPCA | ZXing::BarcodeFormat::EAN13);
  hints.setTryHarder(true);
  hints.setTryRotate(true);
  // Its ReadBarcodes, for several symbols, ends the program on some photos (an assertion of 1.4.0).
  const ZXing::Result result = ZXing::ReadBarcode(image, hints);
  if (!result.isValid()) return {};
  return {as_upca(result.text())};
}
#endif

}  // namespace

const std::vector<OtherReader>& other_readers() {
  static const std::vector<OtherReader> readers {
#if defined(TAGSMITH_BENCH_ZBAR)
    {"zbar", read_zbar},
#endif
#if defined(TAGSMITH_BENCH_ZXING)
        {"zxing", read_zxing},
#endif
  };
  return readers;
}

}  // namespace tagsmith::detail::bench
