// SPDX-License-Identifier: Apache-2.0
// The thresholds of the reader, one struct for each stage. Where no command is named, `./dev bench
// photos` shows what a change does: the dark and dirty photos most of all. tests/house limits their
// number in the three modules: a new one takes the place of another.
#pragma once

#include <cstddef>

namespace tagsmith::detail {

// A symbol's profile from the rows of its bars. Shares of the contrast unless another unit is
// named. Why: docs/decisions/0004-covered-tags.md.
struct ProfileTuning {
  // Rows.
  double row_px = 2.5;  // height of a row, at least: most bins then hold a pixel
  double ends = 0.07;   // of the bars' height, at each end, not used: blur, corners' error
  double ends_px = 2;   // of that, at most, where all rows are looked at
  double beyond = 4;    // modules of quiet zone, at most, on both sides of the bars
  // What rows agree on.
  float model_error = 0.02F;  // an error that averaging cannot remove
  float least_shown = 0.05F;  // of the rows
  double least_used = 0.2;    // of a bin's pixels that agree; of a covered stretch's cells, odd
  double shading = 0.1;       // differences along a clean bar, and the error of a few rows
  double slanted = 0.35;      // of the steepest change: what a slope misses of a bend
  // Stretches of a row that something covers.
  double least_run = 2;  // modules
  double plainer = 0.4;  // variance of covered cells against that of clear ones
  // Rows of their own light, each stretch fitted to what all have in common.
  float most_variance = 3;        // times the usual one
  float model_variance = 0.006F;  // of the contrast squared: 8 % off anywhere
  double odd = 0.3;        // off the expected value, there or on white: blurred bars leave less
  std::size_t bands = 14;  // of rows for a first guess
  // Plain windows, in which something hides the bars.
  double showing = 0.93;  // of the rows at a place, the one taken to show bars
  double plain = 0.08;    // of its variance
  // Of the bright white above and below the bars that the dark one must reach for even light: what
  // falls by less over a plate, its sides' levels follow.
  double least_even = 0.6;
};
inline constexpr ProfileTuning kProfile;

// Things in front of a plate that cross its white and its black.
// Why: docs/decisions/0004-covered-tags.md.
struct OccluderTuning {
  double odd_in_ink = 0.45;  // of the contrast, where only too much light counts; less is noise
  double least_even = 0.85;  // of the places along a strip, as even as that
  double most_way = 1.2;     // over the bars' height, of a strip's width
};
inline constexpr OccluderTuning kOccluder;

// Where bars end. Why: docs/decisions/0004-covered-tags.md.
struct BarEndsTuning {
  std::size_t rows = 9;         // amid the bars, of which the median of each place counts
  double beyond_px = 3;         // of white that must follow
  float dark = 0.15F;           // between the bars' black and white; of their contrast
  double systematic_px = 0.15;  // what neighbouring windows are off by together
  double inside = 0.2;          // of the frame's height, from where the bars should end
  double outside = 0.3;         // the same outwards; inwards where bars were followed
  double followed_outside = 0.8;
  double tolerance_px = 1.2;  // of the frame's sides and the bars' ends: blur
  double layout = 0.003;      // of the frame's height, standard deviation: templates' margins are
                              // rounded, lenses bend lines
  double side = 1.2;          // modules that a side may be off bars that were followed
};
inline constexpr BarEndsTuning kBarEnds;

// Bars followed line by line, with a frame or without.
// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
struct BarLinesTuning {
  // Of a symbol's 30, to look for a frame around them: blurred by two modules, others run together.
  // Twice as many to follow them without a frame.
  int least_bars = 6;
  int most_rows = 24;            // of a thick line
  int most_lean = 8;             // degrees
  double beyond = 0.5;           // of the region's length, on both sides
  std::size_t most_places = 10;  // on the first lines
  double good = 1;               // cost per module: ends the search, and is no stray line's
  double stray = 2.5;            // times the median cost
  int lines = 10;                // of a region
  double off = 0.5;              // modules: boundaries that are farther off count little
  // By how much a first line's modules may be wider or narrower than the region's length says, and
  // its cost per module. Those of covered tags that were read had 0.67 to 1.05 of that width and
  // cost 1.9 at most (`./dev bench troubled`); prints of 18 pixels a module cost 2.6.
  double most_wider = 2, worst_cost = 3;
};
inline constexpr BarLinesTuning kBarLines;

// Where tags are looked for, and when no longer.
// Why: docs/decisions/0008-search-and-its-cost.md.
struct SearchTuning {
  std::size_t least_changes = 20'000;  // of colour that are followed in a level
  int largest_frame = 240;             // pixels; larger ones are seen at half the size
  int least_level = 160;               // pixels of the coarsest level
  // Careful looks, bars followed, and regions read without a frame, in one picture: bounds its
  // time.
  std::size_t most_tries = 6;
  std::size_t most_regions = 24;  // of bars in a picture
  double most_pixels = 2e6;       // of a level in which regions are looked for
  double same_px = 0.4;           // between two frames that are the same
  double clear_direction = 1.5;   // change along the symbol by that across it
  double sagitta_sigma = 0.25;    // pixels, of a coarse fit
};
inline constexpr SearchTuning kSearch;

// Whether to believe a symbol. A symbol of ours explains 95 % and more of its profile when it can
// be read at all; product codes and random stripes reach 88 %. Right digits on the ray-traced
// photos: 0.82 and more; digits with an edge a module off: 0.5.
// Why: docs/decisions/0003-confidence-and-refusal.md.
struct JudgeTuning {
  double explained = 0.9;  // of the profile
  double guards = 0.8;     // of the guard patterns
  // Modules; beyond, digits differ only by the tails of the point spread, of which nothing is
  // known.
  double most_blur = 2.2;
  double most_growth = 0.7;  // modules; beyond, narrow elements vanish
  // Covered tags that were read carefully showed 0.83 and more with even light where slanted light
  // was needed; other plates less, or no guard patterns (`./dev bench troubled`).
  double like_symbol = 0.6;  // explained, and of the guard patterns, at a first look
  // Half the bars' height compared with the whole.
  double beyond_doubt = 1e-8;  // by its whole height: the halves are not asked
  double clearly = 10;         // logarithm of the likelihood ratio
};
inline constexpr JudgeTuning kJudge;

// Tags of which a part is in sight (`./dev bench half`).
// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
struct PartTuning {
  double border_px = 3;       // of the level: corners on the border, outlines that are one
  double usual_focal = 1.25;  // of the picture's longer side, where the camera is not known
  // Lengths of the symbol about the likeliest: from one to the next, how many are tried to either
  // side by their guard patterns with a camera and without.
  double step = 0.005;
  int steps = 5, steps_unknown = 24;
  double bend_sigma = 0.02;  // modules, of the symbol's ends: the sides give the foreshortening
  double most_alike = 1e-3;  // strangers, of each code of the book, that show its digits in sight
};
inline constexpr PartTuning kPart;

// Symbols that are read without a frame (`./dev bench frameless`).
// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
struct FramelessTuning {
  double together = 0.99;      // confidence by the lines' mean: lines may have errors in common
  double most_of_a_line = 30;  // the most that one line can count against a digit: it may be dirty
  double independent = 3;      // lines: they share blur, print and dirt
  double even_parity = 6;      // cost below which digits may be those of an EAN-13
};
inline constexpr FramelessTuning kFrameless;

}  // namespace tagsmith::detail
