// SPDX-License-Identifier: Apache-2.0
// A picture of one symbol in its frame, drawn pixel by pixel: no lens, no blur, upright.
#pragma once

#include <cmath>
#include <cstdint>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail::test {

inline const Digits kDrawnDigits = *parse_digits("019000700401");

struct DrawnSymbol {
  static constexpr int kMargin = 30;  // pixels around the frame's inside
  static constexpr int kStroke = 12;

  // `module_px` is a whole number, so that the edges of bars are those of pixels.
  explicit DrawnSymbol(const Digits& digits, int module_px) : module(module_px) {
    const auto modules = modules_of(digits);
    const int width = module * (kModuleCount + 18), height = width / 2;
    image = {width + 2 * kMargin, height + 2 * kMargin, {}};
    image.samples.assign(static_cast<std::size_t>(image.width * image.height), kWhite);
    fill(-kStroke, -kStroke, width + kStroke, height + kStroke, kBlack);
    fill(0, 0, width, height, kWhite);
    const int top = static_cast<int>(std::lround(layout.bars_top * height));
    const int bottom = static_cast<int>(std::lround(layout.bars_bottom * height));
    layout.bars_top = static_cast<double>(top) / height;
    layout.bars_bottom = static_cast<double>(bottom) / height;
    for (int i = 0; i < kModuleCount; ++i) {
      if (modules[static_cast<std::size_t>(i)] == 0) continue;
      fill(module * (9 + i), top, module * (10 + i), bottom, kBlack);
    }
  }

  // Fills a rectangle given in pixels from the frame's inner corner P.
  void fill(int left, int top, int right, int bottom, std::uint8_t sample) {
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        image.samples[static_cast<std::size_t>((y + kMargin) * image.width + x + kMargin)] = sample;
      }
    }
  }

  int width() const { return image.width - 2 * kMargin; }
  int height() const { return image.height - 2 * kMargin; }

  // The frame as an exact fit gives it. Pixels have their centres at whole numbers.
  RefinedFrame frame() const {
    const double left = kMargin - 0.5, right = left + width();
    const double top = kMargin - 0.5, bottom = top + height();
    RefinedFrame frame;
    frame.corners = {{{left, top}, {right, top}, {right, bottom}, {left, bottom}}};
    const double white = ToneCurve::srgb().light_of(kWhite);
    const double black = ToneCurve::srgb().light_of(kBlack);
    for (FrameSide& side : frame.sides) {
      side = {0.3, white, white, black, black, kStroke, Eigen::Matrix2d::Identity() * 1e-4};
    }
    return frame;
  }

  static constexpr std::uint8_t kWhite = 220, kBlack = 40;
  int module;
  GrayImage image;
  SymbolLayout layout;  // bars end between pixels
};

}  // namespace tagsmith::detail::test
