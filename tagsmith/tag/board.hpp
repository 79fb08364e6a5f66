// SPDX-License-Identifier: Apache-2.0
// Calibration boards: sheets of many tags whose codes are their places on the sheet.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/position_code.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// A tag of a calibration board. Board frame: origin at the sheet's upper left corner, x to the
// right, y down, metres, z away from a viewer who faces it; as drawn, before `scale`.
struct BoardTag {
  Digits digits{};
  PlatePoint corner{};  // its P: the upper left inner corner of its feature frame
};

// Where the tags' corners P stand: equal steps in both directions.
struct BoardGrid {
  int columns = 0;
  int rows = 0;
  PlatePoint first{};     // P of the upper left tag, whole millimetres
  double step_right = 0;  // whole millimetres
  double step_down = 0;
};

// A sheet of many tags whose codes are their places on it.
struct Board {
  std::string name;
  int serial = 0;    // 0 to 999: distinguishes boards in one picture
  double width = 0;  // of the sheet or plate, metres
  double height = 0;
  TagTemplate tag;             // the geometry of each tag: plate = its share of the sheet
  std::vector<BoardTag> tags;  // row by row
  // Measured over drawn, to the right and down; 1 = as drawn.
  std::array<double, 2> scale{1, 1};
  double scale_sigma = 0;        // relative, of both scales
  std::filesystem::path file{};  // the file that it was read from; empty = from none
  BoardGrid grid{};              // from which `tags` follow
};

// How far a print that nobody measured may be off its size: one part in 500. Paper changes by that
// with the moisture of the air, and printers are no more accurate when they feed it.
inline constexpr double kUnmeasuredScaleSigma = 0.002;

inline constexpr int kMostBoardSerial = 999;

// The code of a board's tags: P's x and y in whole millimetres, four digits each, then the serial
// as three; check digit gs1.
PositionCode board_code();

// The tags of a grid, row by row. Needs every P within 0 to 9.999 m and the serial within 0 to 999.
std::vector<BoardTag> tags_on_grid(const BoardGrid& grid, int serial);

// The inner corners P, F, lower right, Q of a tag (clockwise from the upper left as printed) in the
// board frame, metres, as printed (scale applied).
std::array<PlatePoint, 4> corners_of(const Board& board, const BoardTag& tag);

// The white that ink keeps from a board's feature frames, metres: a stroke, as at plates.
double board_clearance(const TagTemplate& tag);

// The marks to which a tape or a caliper is laid: the crosses A, B, C and D near the sheet's upper
// left, upper right, lower left and lower right corner; board frame. Their distances are whole
// millimetres.
std::array<PlatePoint, 4> board_marks(double width, double height);

// From A to B and from A to C, metres.
std::array<double, 2> drawn_distances(double width, double height);

// The requested properties of a board. Lengths in metres.
struct BoardRequest {
  std::string name;
  int serial = 0;  // 0 to 999
  double width = 0;
  double height = 0;
  Rectangle room{};         // of the sheet: where tags and their clearance may stand
  int columns = 0;          // 0 = the fewest that make kWantedBoardTags
  int dots_per_inch = 300;  // a module is a whole number of this printer's dots
};

// So many tags, 64 corners, cover a picture: more tags are smaller and must be photographed from
// nearer.
inline constexpr int kWantedBoardTags = 16;

// Tags as large as the columns allow and as many rows as fit, spread evenly over the room. Each tag
// is one of the shipped templates in small: inner frame 113 by 55 modules, stroke 4, quiet zones
// and margins 9. The frames keep board_clearance from the room's edges and one and a half strokes
// or more from each other. Fails where a module would be narrower than 0.264 mm (the least
// X-dimension for retail in the GS1 General Specifications), and on sheets that exceed the range of
// four digits, 9.999 m.
Result<Board> make_board(const BoardRequest& request);

}  // namespace tagsmith::detail
