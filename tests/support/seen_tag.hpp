// SPDX-License-Identifier: Apache-2.0
// Pictures of a tag on a plane, worked out pixel by pixel from the definition: straight edges under
// a Gaussian point spread, by erf, through a plane projective map that is known exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail::test {

// How a camera sees the plane of the tag. A point of the plane is given in modules from the
// symbol's middle, x along the symbol and y downwards.
struct PlaneView {
  PixelPoint middle{150, 90};  // the symbol's, in the image
  double module_px = 2;        // there
  double turn = 0;             // of the symbol in the image, radians, clockwise
  PixelPoint slant{};          // change of the scale a module, along x and y

  PixelPoint pixel(PixelPoint at) const {
    const double scale = module_px / (1 - dot(slant, at));
    const double c = std::cos(turn), s = std::sin(turn);
    return middle + scale * PixelPoint{c * at.x - s * at.y, s * at.x + c * at.y};
  }

  PixelPoint plane(PixelPoint pixel) const {
    const PixelPoint q = turned_back(pixel);
    return 1 / (1 + dot(slant, q)) * q;
  }

  // Pixels from a line of the plane to a place that is this many modules from it, near `at`.
  double px_per_x(PixelPoint at) const {
    return px_across({1 - at.x * slant.x, -at.x * slant.y}, at);
  }
  double px_per_y(PixelPoint at) const {
    return px_across({-at.y * slant.x, 1 - at.y * slant.y}, at);
  }

  PixelPoint turned_back(PixelPoint pixel) const {
    const PixelPoint d = 1 / module_px * (pixel - middle);
    const double c = std::cos(turn), s = std::sin(turn);
    return {c * d.x + s * d.y, c * d.y - s * d.x};
  }

 private:
  double px_across(PixelPoint gradient, PixelPoint at) const {
    return module_px / (1 - dot(slant, at)) / length(gradient);
  }
};

// A rectangle of the plane that is laid over the tag.
struct PlaneCover {
  double left = 0, top = 0, right = 0, bottom = 0;
  double light = 0.1;
};

struct SeenTag {
  static constexpr double kLeft = -kModuleCount / 2.0 - 9;  // of the frame's inner edge
  static constexpr double kTop = -27.5;

  Digits digits = *parse_digits("019000700401");
  PlaneView view{};
  int width = 300;
  int height = 180;
  double blur_px = 0.7;
  double white = 0.8, black = 0.05, wall = 0.3;  // light
  bool framed = true;
  double stroke = 4;                                // of the frame, modules
  double bars_top = kTop + 0.163 * (-2 * kTop);     // where the bars begin, above
  double bars_bottom = kTop + 0.837 * (-2 * kTop);  // and end, below
  double bars_lean = 0;  // by which both ends are further down, modules a module along x
  double growth = 0;     // of the bars, modules
  std::vector<PlaneCover> covers{};

  double right() const { return -kLeft; }
  double bottom() const { return -kTop; }

  // The frame's inner corners from P on.
  Quad corners() const {
    return {view.pixel({kLeft, kTop}), view.pixel({right(), kTop}), view.pixel({right(), bottom()}),
            view.pixel({kLeft, bottom()})};
  }

  // Black lines without an end along its strokes: the upper, the lower, the left and the right one.
  std::vector<PlaneCover> lines_along_strokes() const {
    constexpr double kFar = 200;
    return {{-kFar, kTop - stroke, kFar, kTop, black},
            {-kFar, bottom(), kFar, bottom() + stroke, black},
            {kLeft - stroke, -kFar, kLeft, kFar, black},
            {right(), -kFar, right() + stroke, kFar, black}};
  }

  BarRegion region() const {
    const double middle = (bars_top + bars_bottom) / 2;
    const PixelPoint left = view.pixel({-47.5, middle}), right = view.pixel({47.5, middle});
    BarRegion region;
    region.centre = 0.5 * (left + right);
    region.length = distance(left, right);
    region.across = 1 / region.length * (right - left);
    region.height = distance(view.pixel({0, bars_top}), view.pixel({0, bars_bottom}));
    return region;
  }

  double light_at(PixelPoint pixel) const {
    const PixelPoint at = view.plane(pixel);
    const double px_x = view.px_per_x(at), px_y = view.px_per_y(at);
    const double sigma = std::sqrt(2 * (blur_px * blur_px + 1.0 / 12));
    const auto from = [&](double place, double edge, double px) {
      const double t = (place - edge) * px / sigma;
      return t > 6 ? 1.0 : t < -6 ? 0.0 : 0.5 * (1 + std::erf(t));
    };
    const auto between = [&](double place, double low, double high, double px) {
      return from(place, low, px) - from(place, high, px);
    };
    const auto box = [&](double left, double top, double right, double bottom) {
      return between(at.x, left, right, px_x) * between(at.y, top, bottom, px_y);
    };
    const auto grown = [&](double by) {
      return box(kLeft - by, kTop - by, right() + by, bottom() + by);
    };
    double light = white;
    if (framed) {
      light = wall + (white - wall) * grown(stroke + 8);
      light -= (white - black) * (grown(stroke) - grown(0));
    }
    double share = 0;
    int module = 0;
    const auto elements = elements_of(digits);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const int end = module + elements[i];
      const double half = growth / 2;
      if (i % 2 == 0) share += between(at.x + 47.5, module - half, end + half, px_x);
      module = end;
    }
    const double lean = bars_lean * at.x;
    light -= (white - black) * share * between(at.y - lean, bars_top, bars_bottom, px_y);
    for (const PlaneCover& cover : covers) {
      light += (cover.light - light) * box(cover.left, cover.top, cover.right, cover.bottom);
    }
    return light;
  }

  // The picture as a camera stores it: with the sRGB curve (IEC 61966-2-1), to the nearest level.
  GrayImage image() const {
    GrayImage image{width, height, {}};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double light =
            std::clamp(light_at({static_cast<double>(x), static_cast<double>(y)}), 0.0, 1.0);
        const double stored =
            light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
        image.samples.push_back(static_cast<std::uint8_t>(std::lround(255 * stored)));
      }
    }
    return image;
  }
};

// The greatest distance between the corners of two quadrilaterals.
inline double farthest_apart(const Quad& a, const Quad& b) {
  double most = 0;
  for (std::size_t i = 0; i < 4; ++i) most = std::max(most, distance(a[i], b[i]));
  return most;
}

}  // namespace tagsmith::detail::test
