// SPDX-License-Identifier: Apache-2.0
// The scan profile of the symbol inside a feature frame, whatever hides parts of it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/common_darkness.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/reader/symbol_rows.hpp"
#include "decoder/scan/profile.hpp"

namespace tagsmith::detail {

// ---- The scan profile of rows that agree.

// Rows of a symbol with their darkness: 0 = the plate's white, 1 = the frame's black.
struct DarkRows {
  using Cells = Eigen::ArrayXXf;  // bins x rows: a column is a row of the symbol

  Cells darkness;
  Cells place, count;                // as in a RowCell
  std::vector<Eigen::Index> bins{};  // those that pixels fell into; the others are left out
};

// ---- The profile.

struct SymbolProfile {
  ScanProfile bins;
  double module_px = 0;  // width of a module in the middle of the frame
  double blur = 0;       // standard deviation of the point spread, modules, from the frame's sides
  double pixel = 0;      // width of a pixel across the bars, modules: beside it
  bool is_evened = false;  // shadows on the plate were evened out (uneven_light.hpp)
  // Variance of a pixel's darkness, of rows that agree everywhere.
  std::optional<double> pixel_variance{};
};

// A part of the bars' height, from the upper end of the bars (0) to the lower one (1).
struct HeightShare {
  double begin = 0;
  double end = 1;
};

// Middle of the rows of a part of the bars' height that are used, as a share of the frame's inner
// height.
double middle_height(HeightShare part, const SymbolLayout& layout);

// The symbol of a frame, cut out of the picture once, and its scan profile under two assumptions.
// Shadows on the plate are evened out first where that is asked for.
class RobustProfile {
 public:
  // The frame's first corner is treated as P. The image must outlive it.
  RobustProfile(const GrayView& image, const RefinedFrame& frame, const SymbolLayout& layout,
                bool even_out_light = false);

  // Where the rows agree, by the white and black of the frame's sides: for each place the mean of
  // the rows that are near their median. Quick.
  SymbolProfile of_agreeing_rows(HeightShare part = {}) const;
  // Of a part of the bars' height: where all rows agreed in the profile of the whole, the mean of
  // these.
  SymbolProfile of_agreeing_rows(HeightShare part, const SymbolProfile& whole) const;

  // The fine rows of the symbol, without what occluders across the tag (find_occluders) hide.
  SymbolRows rows_in_sight() const;

  // Where rows do not agree, from rows_in_sight. The darkness common to the rows is determined
  // together with each row's own local white and contrast (about ten modules long), so that glare,
  // shadows and thin dust only lessen a row's weight; stretches of rows that do not follow the
  // others do not count at all. Places that no row shows get a variance so large that they carry no
  // information.
  SymbolProfile of_all_rows(SymbolRows in_sight, AddedLight added) const;

  const SymbolLayout& layout() const { return rows_.layout; }

  // Whether it was made of the same image, frame and layout, with light evened out or not.
  bool is_of(const GrayView& image, const RefinedFrame& frame, const SymbolLayout& layout,
             bool evened) const;

 private:
  SymbolProfile finished(ScanProfile bins, const SymbolRows& rows) const;

  GrayView image_;
  RefinedFrame frame_;
  SymbolRows rows_;              // coarse ones
  std::optional<double> white_;  // of rows that were evened out
  DarkRows dark_;                // all of the coarse ones
};

// ---- How the point spread, one in pixels, varies along a symbol that is seen obliquely.

// Sets ScanBin::spread from the widths, across the bars, that modules have in the image at half the
// frame's height. `image_from_frame` maps the unit square to the frame's inner edge, P at (0, 0).
void set_spreads(const FrameHomography& image_from_frame, const SymbolLayout& layout,
                 ScanProfile& profile);

}  // namespace tagsmith::detail
