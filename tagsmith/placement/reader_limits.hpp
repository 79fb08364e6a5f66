// SPDX-License-Identifier: Apache-2.0
// The limits of the reader, as `./dev bench limits` measured them and wrote them into
// reader_limits.inc, so that a plan promises only what the reader achieves.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// How much of what is seen under the stated conditions is read.
enum class ReadShare { reliable, half };  // 99 %, 50 %

// Least width of a module in the image (pixels, at the end of the feature frame that is farther
// away) at which this share of tags is read. `incidence`: radians between the line of sight and the
// plate's normal. `blur_px`: standard deviation of the blur across the bars, the lens's and the
// motion's together. Interpolated; infinite beyond the greatest incidence or blur of the table, and
// where nothing is read. Less blur than the table's least counts as the least.
double least_module_px(bool code_book, double incidence, double blur_px,
                       ReadShare share = ReadShare::reliable);

// The share of the feature frame's inner length that must be in the picture for a plan to count a
// tag as a part that the reader identifies with the code book.
inline constexpr double kPartInSight = 0.6;

// The factor by which a plan reduces the width of a plate's modules: less than 1 where the frame's
// strokes are thin, its inner height is small, or the plate is seen steeply from above or below, so
// that its heights are foreshortened by `foreshortening` compared with its lengths. The limits were
// measured with one template, turned about its vertical axis. Measured by `./dev bench limits
// frames`; why: docs/decisions/0012-planning.md.
double frame_share(const TagTemplate& tag, double foreshortening);

// Standard deviation of a coordinate of a corner of the feature frame, pixels, interpolated by
// logarithms; the module as in least_module_px.
double corner_sigma_px(double module_px, double blur_px);

// The inverse of least_module_px for many look-ups: the greatest blur at which a module this wide
// is still read.
class BlurLimits {
 public:
  explicit BlurLimits(bool code_book, ReadShare share = ReadShare::reliable);

  // Of parts of tags, kPartInSight of which the picture shows from one end on, with the code book.
  static BlurLimits of_parts();

  // Standard deviation in pixels; negative when not even a sharp tag is read. `cosine` is that of
  // the incidence.
  double greatest_blur_px(double cosine, double module_px) const;

  // A module narrower than this is never read, pixels.
  double least_module_px() const { return least_; }

 private:
  // Of a table of least widths by incidence and blur.
  template <class Table>
  explicit BlurLimits(const Table& table);

  struct Row {
    std::array<double, 16> module_px{};  // least, by the blurs of the table; the rest infinite
  };
  std::vector<Row> rows_;  // by cosine in equal steps from 0 to 1
  double least_ = 0;
};

}  // namespace tagsmith::detail
