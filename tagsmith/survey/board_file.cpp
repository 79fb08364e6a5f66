// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/board_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/yaml_file.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// ---- Reading.

namespace fs = std::filesystem;
namespace {

constexpr double kLongestSide = 9.999;  // metres: four digits of millimetres
constexpr int kMostTagsASide = 600;     // modules of 0.264 mm make 550 rows of 9.999 m

// To a nanometre.
std::string metres(double value) { return format_number(value, 9); }

std::string pair_text(double right, double down) {
  return "[" + metres(right) + ", " + metres(down) + "]";
}

// A pair of lengths of the sheet, metres.
std::optional<std::vector<double>> read_lengths(const YamlValue& value) {
  return read_numbers(value, 2, above_zero(kLongestSide, "m"));
}

// Places that codes can represent.
void check_millimetres(const YamlValue& value, const std::vector<double>& lengths) {
  const auto is_whole = [](double metres) {
    constexpr double kRounding = 1e-6;  // millimetres
    const double millimetres = metres / kMillimetre;
    return std::abs(millimetres - std::round(millimetres)) < kRounding;
  };
  if (std::ranges::all_of(lengths, is_whole)) return;
  value.error(
      "off-millimetre",
      value.name + " is " + pair_text(lengths[0], lengths[1]) + " m, expected whole millimetres",
      "the codes say places in millimetres: take the numbers that `tagsmith board` wrote");
}

// Whole millimetres, which decimals of metres miss by a rounding of doubles.
double whole_millimetres(double metres) { return std::round(metres / kMillimetre) * kMillimetre; }

void read_grid(const MapReader& tags, BoardGrid& grid) {
  grid.columns = read_integer(tags.need("columns", "columns: 4"), 1, kMostTagsASide).value_or(0);
  grid.rows = read_integer(tags.need("rows", "rows: 5"), 1, kMostTagsASide).value_or(0);
  const YamlValue firsts = tags.need("first", "first: [x, y] of the first tag's P in metres");
  const YamlValue steps = tags.need("step", "step: [right, down] from tag to tag in metres");
  const auto first = read_lengths(firsts);
  const auto step = read_lengths(steps);
  if (!first || !step) return;
  check_millimetres(firsts, *first);
  check_millimetres(steps, *step);
  grid.first = {whole_millimetres((*first)[0]), whole_millimetres((*first)[1])};
  grid.step_right = whole_millimetres((*step)[0]);
  grid.step_down = whole_millimetres((*step)[1]);
}

// The frames are apart from each other and on the sheet.
void check_places(const Board& board, const MapReader& file) {
  constexpr double kRounding = 1e-9;
  const TagTemplate& tag = board.tag;
  const BoardGrid& grid = board.grid;
  const YamlValue tags = file.at("tags");
  const double length = tag.frame_inner_length + 2 * tag.frame_stroke;
  const double height = tag.frame_inner_height + 2 * tag.frame_stroke;
  const bool apart = (grid.columns == 1 || grid.step_right > length - kRounding) &&
                     (grid.rows == 1 || grid.step_down > height - kRounding);
  if (!apart) {
    tags.error("tags-overlap",
               "tags.step is [" + format_number(grid.step_right) + ", " +
                   format_number(grid.step_down) + "] m, but a feature frame takes " +
                   format_number(length) + " x " + format_number(height) + " m",
               "take the numbers that `tagsmith board` wrote");
  }
  const double right = grid.first.x + (grid.columns - 1) * grid.step_right + length;
  const double lower = grid.first.y + (grid.rows - 1) * grid.step_down + height;
  const double stroke = tag.frame_stroke;
  const bool inside = grid.first.x > stroke - kRounding && grid.first.y > stroke - kRounding &&
                      right - stroke < board.width + kRounding &&
                      lower - stroke < board.height + kRounding;
  if (!inside) {
    tags.error("outside-sheet",
               "the tags reach to " + format_number(right - stroke) + ", " +
                   format_number(lower - stroke) + " m, the sheet is " +
                   format_number(board.width) + " x " + format_number(board.height) + " m",
               "take the numbers that `tagsmith board` wrote");
  }
}

struct Distances {
  double right = 0;  // A to B, millimetres
  double down = 0;   // A to C
};

std::optional<Distances> read_distances(const MapReader& map) {
  const NumberRange range = above_zero(kLongestSide / kMillimetre, "mm");
  const auto right = map.number("a_b_mm", range, "a_b_mm: from cross A to cross B");
  const auto down = map.number("a_c_mm", range, "a_c_mm: from cross A to cross C");
  if (!right || !down) return std::nullopt;
  return Distances{*right, *down};
}

void check_scale(const Board& board, const MapReader& measured) {
  const auto percent = [](double scale) { return format_number(100 * scale, 2) + " %"; };
  const auto [right, down] = board.scale;
  const std::string found = "the print is " + percent(right) +
                            " of its drawn size to the right and " + percent(down) + " down";
  const double rounding = 1e-9;
  const auto fits = [&](double scale) {
    return std::abs(scale - 1) <= kMostPrinterScale + rounding;
  };
  if (!fits(right) || !fits(down)) {
    const char* remedy = fits(right * down) ? "are a_b_mm and a_c_mm exchanged?"
                         : fits(right / down) && right < 0.2
                             ? "write millimetres"
                             : "measure from cross to cross, in millimetres; if that is right, "
                               "print again at 100 %, "
                               "without \"fit to page\"";
    measured.value().error("board-scale", found + ", more than 2 % off", remedy);
  } else if (std::abs(right - down) > kMostUnequalScale) {
    measured.value().error("board-scale", found + ", expected both within 1 % of each other",
                           "measure both distances again; if they are right, another printer or "
                           "paper");
  }
}

void read_measured(const MapReader& file, Board& board) {
  const MapReader drawn_map(file.need("drawn", "drawn: { a_b_mm: 281, a_c_mm: 194 }"),
                            {"a_b_mm", "a_c_mm"});
  const auto drawn = read_distances(drawn_map);
  board.scale_sigma = kUnmeasuredScaleSigma;
  const MapReader measured_map(file.at("measured"), {"a_b_mm", "a_c_mm", "sigma_mm"});
  const auto measured = read_distances(measured_map);
  const double sigma =
      measured_map.number_or("sigma_mm", kUsualMeasuringSigma / kMillimetre, above_zero(10, "mm"));
  if (!drawn || !measured) return;
  board.scale = {measured->right / drawn->right, measured->down / drawn->down};
  board.scale_sigma = sigma / std::min(drawn->right, drawn->down);
  check_scale(board, measured_map);
}

Board read_board_tree(const YamlValue& root, const fs::path& path) {
  const FindingLog& log = *root.log;
  const MapReader file(
      root, {"board", "serial", "sheet", "feature_frame", "symbol", "tags", "drawn", "measured"});
  Board board;
  board.file = path;
  board.name = read_name(file.need("board", "board: NAME")).value_or("");
  board.serial =
      read_integer(file.need("serial", "serial: 0, to 999"), 0, kMostBoardSerial).value_or(0);
  const auto sheet = read_lengths(file.need("sheet", "sheet: [width, height] in metres"));
  if (sheet) {
    board.width = (*sheet)[0];
    board.height = (*sheet)[1];
  }
  read_feature_frame(
      {file.need("feature_frame", "feature_frame: { inner: [0.0574, 0.0279], stroke: 0.002 }"),
       {"inner", "stroke"}},
      board.tag);
  read_symbol({file.need("symbol", "symbol: { quiet_zone: 9, margin: 9 }"),
               {"quiet_zone", "margin", "dots_per_inch"}},
              board.tag);
  board.tag.label.shown = false;
  board.tag.name = board.name;
  read_grid({file.need("tags",
                       "tags: { columns: 4, rows: 5, first: [0.017, 0.019], "
                       "step: [0.071, 0.036] }"),
             {"columns", "rows", "first", "step"}},
            board.grid);
  read_measured(file, board);
  if (!log.has_errors()) check_symbol(board.tag, file);
  if (!log.has_errors()) check_places(board, file);
  if (log.has_errors()) return board;
  board.tag.plate_length = board.grid.step_right;
  board.tag.plate_height = board.grid.step_down;
  board.tags = tags_on_grid(board.grid, board.serial);
  return board;
}

}  // namespace

Result<Diagnosed<Board>> read_board(const fs::path& path) {
  return read_yaml_file<Board>(path, "board",
                               [&](const YamlValue& root) { return read_board_tree(root, path); });
}

Result<Board> load_board(const fs::path& path) { return value_without_errors(read_board(path)); }

// ---- Writing.

std::string board_file_text(const Board& board) {
  const TagTemplate& tag = board.tag;
  const BoardGrid& grid = board.grid;
  const std::array<double, 2> drawn = drawn_distances(board.width, board.height);
  const std::string right = format_number(drawn[0] * 1e3);
  const std::string down = format_number(drawn[1] * 1e3);
  std::string text =
      "# A calibration board: tags whose codes are their places on the sheet. Keep this file with\n"
      "# it: `measured` says how large it came out. Lengths in metres; the origin is the sheet's\n"
      "# upper left corner, x to the right, y down.\n";
  text += fmt::format("board: \"{}\"\nserial: {}\nsheet: {}\n", board.name, board.serial,
                      pair_text(board.width, board.height));
  text += fmt::format(
      "feature_frame: {{ inner: {}, stroke: {} }}\n"
      "symbol: {{ quiet_zone: {}, margin: {}, dots_per_inch: {} }}\n",
      pair_text(tag.frame_inner_length, tag.frame_inner_height), metres(tag.frame_stroke),
      format_number(tag.quiet_zone_modules), format_number(tag.margin_modules), tag.dots_per_inch);
  text += fmt::format(
      "# P, the upper left inner corner of a frame: of the first tag, and from tag to tag.\n"
      "tags: {{ columns: {}, rows: {}, first: {}, step: {} }}\n",
      grid.columns, grid.rows, pair_text(grid.first.x, grid.first.y),
      pair_text(grid.step_right, grid.step_down));
  text += fmt::format(
      "# From cross to cross as drawn: A to B, A to C.\n"
      "drawn: {{ a_b_mm: {}, a_c_mm: {} }}\n"
      "# Glue the print on a flat plate, measure the same two distances, write them here with how\n"
      "# exactly you could measure (sigma), and remove the # before `measured`.\n"
      "# measured: {{ a_b_mm: {}, a_c_mm: {}, sigma_mm: 0.2 }}\n",
      right, down, right, down);
  return text;
}

}  // namespace tagsmith::detail
