// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/board.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "tagsmith/base/text.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kMillimetreRounding = 1e-6;  // millimetres
constexpr double kGreatestPlace = 9.999;      // metres: four digits of millimetres
constexpr double kLeastModule = 0.000264;     // metres

// In modules, as the shipped templates have them.
constexpr double kInnerLength = kModuleCount + 2 * kQuietZoneModules;
constexpr double kInnerHeight = 55;
constexpr double kStroke = 4;

// Between the frames of neighbours, in strokes. The frame itself has black next to white at one
// stroke's distance; a gap wider than that blurs its edges no more than this already does.
constexpr double kLeastGap = 1.5;

int whole_up(double metres) {
  return static_cast<int>(std::ceil(metres / kMillimetre - kMillimetreRounding));
}

int whole_down(double metres) {
  return static_cast<int>(std::floor(metres / kMillimetre + kMillimetreRounding));
}

TagTemplate tag_of_module(double module, int dots_per_inch) {
  TagTemplate tag;
  tag.frame_inner_length = kInnerLength * module;
  tag.frame_inner_height = kInnerHeight * module;
  tag.frame_stroke = kStroke * module;
  tag.label.shown = false;
  tag.dots_per_inch = dots_per_inch;
  return tag;
}

// Whole millimetres along one side of the sheet: where P may stand, and how far apart.
struct Span {
  int least = 0;
  int greatest = 0;
  int least_step = 0;

  int count() const { return greatest < least ? 0 : 1 + (greatest - least) / least_step; }
};

Span span_of(double from, double length, double inner, const TagTemplate& tag) {
  const double border = board_clearance(tag) + tag.frame_stroke;
  const double step = inner + (2 + kLeastGap) * tag.frame_stroke;
  return {whole_up(from + border), whole_down(from + length - border - inner), whole_up(step)};
}

Span span_right(const Rectangle& room, const TagTemplate& tag) {
  return span_of(room.x, room.width, tag.frame_inner_length, tag);
}

Span span_down(const Rectangle& room, const TagTemplate& tag) {
  return span_of(room.y, room.height, tag.frame_inner_height, tag);
}

// First place and step of so many tags, spread over the span with equal rests at both ends.
struct Spread {
  double first = 0;
  double step = 0;
};

Spread spread(const Span& span, int count) {
  const int length = span.greatest - span.least;
  const int step = count > 1 ? length / (count - 1) : span.least_step;
  const int rest = length - (count - 1) * step;
  const int first = span.least + std::max(rest, 0) / 2;
  return {first * kMillimetre, step * kMillimetre};
}

// The tag of the widest module of whole dots of which so many fit side by side; nothing where a
// module would be too narrow.
std::optional<TagTemplate> widest_tag(const BoardRequest& request, int columns) {
  const double dot = kMetresPerInch / request.dots_per_inch;
  const double widest = request.room.width / (columns * (kInnerLength + 2 * kStroke));
  for (int dots = static_cast<int>(widest / dot); dots * dot >= kLeastModule; --dots) {
    const TagTemplate tag = tag_of_module(dots * dot, request.dots_per_inch);
    const bool fits = span_right(request.room, tag).count() >= columns &&
                      span_down(request.room, tag).count() >= 1;
    if (fits) return tag;
  }
  return std::nullopt;
}

BoardGrid grid_of(const Rectangle& room, const TagTemplate& tag, int columns) {
  const Span down = span_down(room, tag);
  const int rows = down.count();
  const Spread x = spread(span_right(room, tag), columns);
  const Spread y = spread(down, rows);
  return {columns, rows, {x.first, y.first}, x.step, y.step};
}

struct Choice {
  TagTemplate tag;
  BoardGrid grid;
};

std::optional<Choice> choice_of(const BoardRequest& request, int columns) {
  const std::optional<TagTemplate> tag = widest_tag(request, columns);
  if (!tag) return std::nullopt;
  return Choice{*tag, grid_of(request.room, *tag, columns)};
}

// The fewest columns that make enough tags; where none do, the most that there is room for.
std::optional<Choice> usual_choice(const BoardRequest& request) {
  std::optional<Choice> best;
  for (int columns = 1;; ++columns) {
    const std::optional<Choice> choice = choice_of(request, columns);
    if (!choice) return best;
    best = choice;
    if (choice->grid.columns * choice->grid.rows >= kWantedBoardTags) return best;
  }
}

int most_columns(const BoardRequest& request) {
  int columns = 0;
  while (widest_tag(request, columns + 1)) ++columns;
  return columns;
}

std::string size_text(const BoardRequest& request) {
  return format_number(request.width * 1e3, 3) + " x " + format_number(request.height * 1e3, 3) +
         " mm";
}

Error no_room(const BoardRequest& request) {
  const int most = most_columns(request);
  const std::string where = "a board of " + size_text(request);
  if (most == 0) {
    return {where +
            " has no room for a tag whose modules are 0.264 mm wide or more: take a larger "
            "sheet"};
  }
  return {where + " has room for at most " + std::to_string(most) + " columns, not " +
          std::to_string(request.columns) +
          ": in more, modules would be narrower than 0.264 mm and hard to print"};
}

}  // namespace

PositionCode board_code() {
  return {CheckDigit::gs1, {4, 4, 3}, {kMillimetre, kMillimetre, 1}, {0, 0, 0}};
}

std::vector<BoardTag> tags_on_grid(const BoardGrid& grid, int serial) {
  std::vector<BoardTag> tags;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const PlatePoint corner{grid.first.x + column * grid.step_right,
                              grid.first.y + row * grid.step_down};
      const auto code =
          encode_position(board_code(), {corner.x, corner.y, static_cast<double>(serial)});
      assert(code);
      if (code) tags.push_back({code->digits, corner});
    }
  }
  return tags;
}

std::array<PlatePoint, 4> corners_of(const Board& board, const BoardTag& tag) {
  std::array<PlatePoint, 4> corners = corners_of(
      {tag.corner.x, tag.corner.y, board.tag.frame_inner_length, board.tag.frame_inner_height});
  for (auto& [x, y] : corners) {
    x *= board.scale[0];
    y *= board.scale[1];
  }
  return corners;
}

double board_clearance(const TagTemplate& tag) { return tag.frame_stroke; }

std::array<PlatePoint, 4> board_marks(double width, double height) {
  constexpr double kInset = 0.008;  // where every printer prints
  const double right = kInset + whole_down(width - 2 * kInset) * kMillimetre;
  const double lower = kInset + whole_down(height - 2 * kInset) * kMillimetre;
  return {{{kInset, kInset}, {right, kInset}, {kInset, lower}, {right, lower}}};
}

std::array<double, 2> drawn_distances(double width, double height) {
  const auto marks = board_marks(width, height);
  return {marks[1].x - marks[0].x, marks[2].y - marks[0].y};
}

Result<Board> make_board(const BoardRequest& request) {
  if (std::max(request.width, request.height) > kGreatestPlace) {
    return fail("a board of " + size_text(request) +
                " reaches beyond 9999 mm, where its codes end: take a smaller one");
  }
  const std::optional<Choice> choice =
      request.columns == 0 ? usual_choice(request) : choice_of(request, request.columns);
  if (!choice) return tl::unexpected(no_room(request));
  Board board{request.name, request.serial, request.width, request.height, choice->tag, {}};
  board.grid = choice->grid;
  board.tag.name = request.name;
  board.tag.plate_length = board.grid.step_right;
  board.tag.plate_height = board.grid.step_down;
  board.tags = tags_on_grid(board.grid, request.serial);
  board.scale_sigma = kUnmeasuredScaleSigma;
  return board;
}

}  // namespace tagsmith::detail
