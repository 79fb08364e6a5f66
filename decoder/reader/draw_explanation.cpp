// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/codecs.hpp"
#include "decoder/reader/explain.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kPictureWidth = 1600;  // the picture is shown about this wide
constexpr int kPanelHeight = 250;    // of a symbol's panel
constexpr int kLineHeight = 22;
constexpr std::size_t kMostPanels = 12;
constexpr double kPlotMargin = 4;  // modules of quiet zone shown

const cv::Scalar kRead(40, 160, 0);         // green (OpenCV's order is blue, green, red)
const cv::Scalar kRefused(30, 30, 220);     // red
const cv::Scalar kPassedOver(0, 150, 255);  // orange
const cv::Scalar kMeasured(30, 30, 30);
const cv::Scalar kExpected(220, 120, 0);  // blue
const cv::Scalar kPaper(255, 255, 255);

const cv::Scalar& color_of(const ExplainedSymbol& symbol) {
  return symbol.refusal ? kRefused : kRead;
}

void write(cv::Mat& canvas, const std::string& text, cv::Point at, double size,
           const cv::Scalar& color, bool on_picture = false) {
  const int weight = size >= 0.7 ? 2 : 1;
  if (on_picture) {
    cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kPaper, weight + 3, cv::LINE_AA);
  }
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, size, color, weight, cv::LINE_AA);
}

// The picture's canvas and its scale.
class Overlay {
 public:
  Overlay(cv::Mat canvas, double scale) : canvas_(std::move(canvas)), scale_(scale) {}

  void outline(const std::array<PixelPoint, 4>& corners, const cv::Scalar& color, int width) {
    for (std::size_t i = 0; i < 4; ++i) line(corners[i], corners[(i + 1) % 4], color, width);
  }

  void line(PixelPoint a, PixelPoint b, const cv::Scalar& color, int width) {
    cv::line(canvas_, at(a), at(b), color, width, cv::LINE_AA);
  }

  void cross_at(PixelPoint point, const std::string& name, const cv::Scalar& color) {
    cv::drawMarker(canvas_, at(point), color, cv::MARKER_CROSS, 16, 1, cv::LINE_AA);
    write(canvas_, name, at(point) + cv::Point(5, -6), 0.5, color, true);
  }

  void text(PixelPoint where, cv::Point offset, const std::string& words, double size,
            const cv::Scalar& color) {
    cv::Point place = at(where) + offset;
    const int width = cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, 2, nullptr).width;
    place.x = std::clamp(place.x, 2, std::max(2, canvas_.cols - width - 2));
    place.y = std::clamp(place.y, 16, std::max(16, canvas_.rows - 6));
    write(canvas_, words, place, size, color, true);
  }

  // Letters stand above the outline and its corners, or below where the picture ends there.
  void title(const std::array<PixelPoint, 4>& outline, const std::string& words,
             const cv::Scalar& color) {
    constexpr int kAbove = 26;  // pixels to the baseline: a letter reaches 18 above its corner
    constexpr int kBelow = 34;
    const auto [highest, lowest] = std::ranges::minmax_element(outline, {}, &PixelPoint::y);
    const bool room = at(*highest).y > kAbove + 16;
    text(room ? *highest : *lowest, {0, room ? -kAbove : kBelow}, words, 0.6, color);
  }

  double scale() const { return scale_; }

 private:
  cv::Point at(PixelPoint point) const {
    const double limit = 1e6;
    return {static_cast<int>(std::lround(std::clamp((point.x + 0.5) * scale_, -limit, limit))),
            static_cast<int>(std::lround(std::clamp((point.y + 0.5) * scale_, -limit, limit)))};
  }

  cv::Mat canvas_;
  double scale_;
};

void draw_symbol(Overlay& overlay, const ExplainedSymbol& symbol, std::size_t number) {
  const cv::Scalar& color = color_of(symbol);
  overlay.outline(symbol.outline, color, 2);
  for (const auto& [begin, end] : symbol.lines) overlay.line(begin, end, kExpected, 1);
  if (symbol.framed && !symbol.refusal) {
    constexpr std::array<const char*, 4> kNames{"P", "F", "", "Q"};
    for (std::size_t i = 0; i < 4; ++i) {
      overlay.cross_at(symbol.outline[i], kNames[i], color);
    }
  }
  constexpr double kRoomForDigit = 10;  // pixels
  if (symbol.module_px * kModulesPerDigit * overlay.scale() > kRoomForDigit) {
    for (std::size_t i = 0; i < kDigitCount; ++i) {
      overlay.text(symbol.digit_places[i], {-5, 6}, std::to_string(symbol.digits[i]), 0.55, color);
    }
  }
  overlay.title(symbol.outline,
                fmt::format("{}: {}", number, symbol.refusal.value_or(to_string(symbol.digits))),
                color);
}

// A panel's plot: modules across, darkness down.
struct Plot {
  cv::Rect area;

  cv::Point at(double module, double darkness) const {
    const double x = (module + kPlotMargin) / (kModuleCount + 2 * kPlotMargin);
    const double y = std::clamp((darkness + 0.15) / 1.3, 0.0, 1.0);
    return {area.x + static_cast<int>(std::lround(x * area.width)),
            area.y + static_cast<int>(std::lround(y * area.height))};
  }
};

void draw_modules(cv::Mat& panel, const Plot& plot, const Digits& digits) {
  const auto modules = modules_of(digits);
  for (int m = 0; m < kModuleCount; ++m) {
    if (modules[static_cast<std::size_t>(m)] == 0) continue;
    cv::rectangle(panel, {plot.at(m, -1).x, plot.area.y},
                  {plot.at(m + 1, -1).x, plot.area.y + plot.area.height}, {225, 225, 225},
                  cv::FILLED);
  }
}

void draw_curve(cv::Mat& panel, const Plot& plot, const ScanProfile& profile,
                const std::vector<double>& expected) {
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const auto& a = profile[i - 1];
    const auto& b = profile[i];
    cv::line(panel, plot.at(a.at, expected[i - 1]), plot.at(b.at, expected[i]), kExpected, 2,
             cv::LINE_AA);
    cv::line(panel, plot.at(a.at, a.darkness), plot.at(b.at, b.darkness),
             b.agreement < 0.85 ? kRefused : kMeasured, 1, cv::LINE_AA);
  }
}

void draw_margins(cv::Mat& panel, const Plot& plot, const ExplainedSymbol& symbol) {
  constexpr double kWeak = 3;  // decades
  const int below = plot.area.y + plot.area.height;
  for (int i = 0; i < kDigitCount; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const int x = plot.at(first_module_of_digit(i), 0).x;
    const double margin = symbol.margins[index];
    const cv::Scalar& color = margin < kWeak ? kRefused : kMeasured;
    write(panel, std::to_string(symbol.digits[index]), {x + 20, below + 24}, 0.8, color);
    write(panel, fmt::format("{:.0f}", margin), {x + 44, below + 24}, 0.45, color);
  }
}

std::string facts_of(const ExplainedSymbol& symbol) {
  const Decoding& decoding = symbol.decoding;
  const double doubt = std::max(1e-16, 1 - symbol.confidence);
  return fmt::format(
      "{:.2f} px/module   explained {:.3f}   guards {:.2f}   worst digit {:.2f}   "
      "blur {:.2f}   growth {:+.2f} modules   confidence 1 - {:.0e}",
      symbol.module_px, decoding.fit.explained, decoding.guards, decoding.worst_digit,
      decoding.fit.image.blur, decoding.fit.image.growth, doubt);
}

void draw_panel(cv::Mat panel, const ExplainedSymbol& symbol, std::size_t number) {
  const std::string what = symbol.refusal ? "refused: " + *symbol.refusal + ", best guess " : "";
  const std::string where =
      symbol.proposer.empty() ? "" : fmt::format("  (proposer: {})", symbol.proposer);
  write(panel,
        fmt::format("{}: {}{}{}", number, what, to_string(symbol.digits),
                    symbol.framed ? where : "  (no frame)"),
        {20, 28}, 0.7, color_of(symbol));
  write(panel, facts_of(symbol), {20, 52}, 0.48, kMeasured);
  if (symbol.profile.empty()) {
    write(panel, "no scan profile: its reader measures none", {20, 110}, 0.5, kRefused);
    return;
  }
  const Plot plot{{20, 64, panel.cols - 40, 140}};
  draw_modules(panel, plot, symbol.digits);
  draw_curve(panel, plot, symbol.profile, symbol.expected);
  draw_margins(panel, plot, symbol);
}

// How often outlines were passed over for each reason, in lines as wide as the picture at most.
std::vector<std::string> passed_over_lines(const Explanation& explanation) {
  std::map<std::string, int> reasons;
  for (const Rejection& passed : explanation.passed_over) ++reasons[describe(passed)];
  if (reasons.empty()) return {"no outline passed over"};
  std::vector<std::string> lines{"passed over:"};
  for (const auto& [reason, count] : reasons) {
    const std::string words = fmt::format(" {} x {};", count, reason);
    const cv::Size size =
        cv::getTextSize(lines.back() + words, cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, nullptr);
    if (size.width > kPictureWidth - 40) lines.emplace_back();
    lines.back() += words;
  }
  lines.back().pop_back();
  return lines;
}

void draw_legend(cv::Mat panel, const std::vector<std::string>& passed_over) {
  write(panel,
        "green: read   red: refused   orange: framed outlines without a symbol   blue in the "
        "picture: scan "
        "lines",
        {20, 24}, 0.5, kMeasured);
  write(panel,
        "panels: black = measured darkness along the symbol (red where its height disagrees), "
        "blue = expected of the digits, grey = their bars; digits with their margin in decades",
        {20, 46}, 0.5, kMeasured);
  int y = 70;
  for (const std::string& line : passed_over) {
    write(panel, line, {20, y}, 0.5, kPassedOver);
    y += kLineHeight;
  }
}

cv::Mat enlarged(const GrayView& image, double scale) {
  const cv::Mat gray(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  cv::Mat resized;
  cv::resize(gray, resized, {}, scale, scale, scale > 1 ? cv::INTER_LINEAR : cv::INTER_AREA);
  cv::Mat colored;
  cv::cvtColor(resized, colored, cv::COLOR_GRAY2BGR);
  return colored;
}

cv::Mat drawn(const GrayView& image, const Explanation& explanation) {
  const std::vector<std::string> passed_over = passed_over_lines(explanation);
  const int legend_height = 62 + kLineHeight * static_cast<int>(passed_over.size());
  constexpr double kMostEnlarged = 6;
  const double scale = std::min(kMostEnlarged, static_cast<double>(kPictureWidth) / image.width);
  const cv::Mat picture = enlarged(image, scale);
  const std::size_t panels = std::min(kMostPanels, explanation.symbols.size());
  const int height = picture.rows + legend_height + static_cast<int>(panels) * kPanelHeight;
  cv::Mat canvas(height, kPictureWidth, CV_8UC3, kPaper);
  cv::Mat top = canvas(cv::Rect(0, 0, picture.cols, picture.rows));
  picture.copyTo(top);
  Overlay overlay(top, scale);
  for (const Rejection& passed : explanation.passed_over) {
    const bool is_frame_like =
        passed.reason != RejectionReason::frame_fault || passed.fault != FrameFault::not_framed;
    if (is_frame_like) overlay.outline(passed.corners, kPassedOver, 1);
  }
  for (std::size_t i = 0; i < explanation.symbols.size(); ++i) {
    draw_symbol(overlay, explanation.symbols[i], i + 1);
  }
  draw_legend(canvas(cv::Rect(0, picture.rows, kPictureWidth, legend_height)), passed_over);
  for (std::size_t i = 0; i < panels; ++i) {
    const int y = picture.rows + legend_height + static_cast<int>(i) * kPanelHeight;
    draw_panel(canvas(cv::Rect(0, y, kPictureWidth, kPanelHeight)), explanation.symbols[i], i + 1);
  }
  return canvas;
}

}  // namespace

Result<std::string> draw_explanation(const GrayView& image, const Explanation& explanation) {
  if (image.width <= 0 || image.height <= 0) return fail("an image of no size cannot be drawn");
  constexpr int kMostTimesHigher = 20;
  if (image.height > kMostTimesHigher * image.width) {
    return fail("the image is too narrow and high to be drawn");
  }
  const Result<Codecs>& by = codecs();
  if (!by) return fail("the explanation cannot be drawn: " + by.error().message);
  try {
    std::vector<std::uint8_t> encoded;
    by->encode(".png", drawn(image, explanation), encoded, {});
    return std::string(encoded.begin(), encoded.end());
  } catch (const cv::Exception&) {
    return fail("the explanation cannot be drawn: the image is too large");
  }
}

}  // namespace tagsmith::detail
