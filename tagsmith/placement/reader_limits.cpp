// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/reader_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

#include "tagsmith/placement/reader_limits.inc"

constexpr int kCosines = 256;  // rows of BlurLimits, less one

// A place between two entries of an ascending axis; the nearest end outside of it.
struct Between {
  std::size_t low = 0;
  std::size_t high = 0;
  double share = 0;  // of `high`
};

template <std::size_t Size>
Between between(const std::array<double, Size>& axis, double value) {
  if (!(value > axis.front())) return {0, 0, 0};
  if (value >= axis.back()) return {Size - 1, Size - 1, 0};
  const auto next = std::upper_bound(axis.begin(), axis.end(), value);
  const auto high = static_cast<std::size_t>(next - axis.begin());
  return {high - 1, high, (value - axis[high - 1]) / (axis[high] - axis[high - 1])};
}

double mix(double low, double high, double share) {
  return share == 0 ? low : (1 - share) * low + share * high;
}

const auto& table_of(bool code_book, ReadShare share) {
  return (share == ReadShare::reliable ? kReliableModulePx : kHalfModulePx)[code_book ? 1 : 0];
}

// The table's value at an entry of its blurs.
template <class Table>
double at_incidence(const Table& table, double incidence, std::size_t blur) {
  if (!(incidence <= radians(kIncidencesDeg.back()))) return kNever;
  const Between row = between(kIncidencesDeg, degrees(incidence));
  return mix(table[row.low][blur], table[row.high][blur], row.share);
}

}  // namespace

// Why: docs/decisions/0012-planning.md.
double least_module_px(bool code_book, double incidence, double blur_px, ReadShare share) {
  if (!(blur_px <= kBlursPx.back())) return kNever;
  const auto& table = table_of(code_book, share);
  const Between column = between(kBlursPx, blur_px);
  return mix(at_incidence(table, incidence, column.low),
             at_incidence(table, incidence, column.high), column.share);
}

double frame_share(const TagTemplate& tag, double foreshortening) {
  // In modules, for a plate seen squarely; a leaning one needs more, where both are scarce.
  constexpr double kStroke = 3.4, kLeaningStroke = 1.6;
  constexpr double kHeight = 48, kLeaningHeight = 6;
  const double seen = std::min(foreshortening, 1.0);
  const double module = module_width(tag);
  const double stroke = tag.frame_stroke / module / (kStroke + kLeaningStroke * (1 - seen));
  // Where margins are wider than those measured, 9 modules, the bars count by what frame they fill.
  constexpr double kMargins = 18;
  const double inner =
      std::min(tag.frame_inner_height / module, bar_height(tag) / module + kMargins);
  const double height = inner / (kHeight + kLeaningHeight * (1 - seen));
  return std::min(1.0, seen * std::min(stroke, height));
}

double corner_sigma_px(double module_px, double blur_px) {
  const Between row = between(kSigmaModulesPx, module_px);
  const Between column = between(kSigmaBlursPx, blur_px);
  const auto along = [&](std::size_t i) {
    return std::log(
        mix(kCornerSigmaPx[i][column.low], kCornerSigmaPx[i][column.high], column.share));
  };
  // Between two modules the noise follows a power of their width.
  const double low = std::log(kSigmaModulesPx[row.low]), high = std::log(kSigmaModulesPx[row.high]);
  const double share = row.share == 0 ? 0 : (std::log(module_px) - low) / (high - low);
  return std::exp(mix(along(row.low), along(row.high), share));
}

BlurLimits::BlurLimits(bool code_book, ReadShare share) : BlurLimits(table_of(code_book, share)) {}

BlurLimits BlurLimits::of_parts() { return BlurLimits(kPartModulePx); }

template <class Table>
BlurLimits::BlurLimits(const Table& table) : rows_(kCosines + 1), least_(kNever) {
  static_assert(kBlursPx.size() <= std::tuple_size_v<decltype(Row::module_px)>);
  for (int i = 0; i <= kCosines; ++i) {
    Row& row = rows_[static_cast<std::size_t>(i)];
    row.module_px.fill(kNever);
    const double incidence = std::acos(static_cast<double>(i) / kCosines);
    // More blur never helps: the table's small ups and downs are the measurement's noise.
    double least = 0;
    for (std::size_t blur = 0; blur < kBlursPx.size(); ++blur) {
      least = std::max(least, at_incidence(table, incidence, blur));
      row.module_px[blur] = least;
    }
    least_ = std::min(least_, row.module_px.front());
  }
}

double BlurLimits::greatest_blur_px(double cosine, double module_px) const {
  if (!(cosine > 0)) return -1;
  const auto index = static_cast<std::size_t>(std::min(cosine, 1.0) * kCosines);
  const auto& least = rows_[index].module_px;
  if (module_px < least[0]) return -1;
  std::size_t blur = 1;
  while (blur < kBlursPx.size() && module_px >= least[blur]) ++blur;
  if (blur == kBlursPx.size()) return kBlursPx.back();
  if (!std::isfinite(least[blur])) return kBlursPx[blur - 1];
  const double share = (module_px - least[blur - 1]) / (least[blur] - least[blur - 1]);
  return mix(kBlursPx[blur - 1], kBlursPx[blur], share);
}

}  // namespace tagsmith::detail
