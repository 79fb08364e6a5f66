// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/board.hpp"

#include <cmath>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/tag/printer.hpp"

using namespace tagsmith::detail;
using doctest::Approx;

namespace {

// What a sheet's borders leave, some millimetres inside of its edges.
BoardRequest request_of(double width, double height) {
  BoardRequest request;
  request.name = "desk";
  request.serial = 7;
  request.width = width;
  request.height = height;
  request.room = {0.0125, 0.0135, width - 0.0175, height - 0.0265};
  return request;
}

struct NamedSheet {
  const char* name;
  double width;
  double height;
};

const NamedSheet kSheets[] = {
    {"A4", 0.297, 0.210}, {"A4 upright", 0.210, 0.297}, {"Letter", 0.2794, 0.2159},
    {"A3", 0.420, 0.297}, {"A2", 0.594, 0.420},         {"A1", 0.841, 0.594},
    {"A0", 1.189, 0.841}, {"plate", 0.600, 0.400},      {"strip", 1.5, 0.2}};

bool is_whole(double value) { return std::abs(value - std::round(value)) < 1e-6; }

}  // namespace

TEST_CASE("a board's tags stand inside their room, clear of each other, P on whole millimetres") {
  for (const NamedSheet& sheet : kSheets) {
    CAPTURE(sheet.name);
    const BoardRequest request = request_of(sheet.width, sheet.height);
    const Result<Board> board = make_board(request);
    REQUIRE(board);
    const TagTemplate& tag = board->tag;
    const double stroke = tag.frame_stroke;
    const auto tags = static_cast<int>(board->tags.size());
    CHECK(tags == board->grid.columns * board->grid.rows);
    CHECK(tags >= 16);
    CHECK(tags <= 40);
    for (const BoardTag& each : board->tags) {
      CHECK(is_whole(each.corner.x * 1e3));
      CHECK(is_whole(each.corner.y * 1e3));
      const double clear = 2 * stroke - 1e-9;
      CHECK(each.corner.x - clear >= request.room.x);
      CHECK(each.corner.y - clear >= request.room.y);
      CHECK(each.corner.x + tag.frame_inner_length + clear <= request.room.x + request.room.width);
      CHECK(each.corner.y + tag.frame_inner_height + clear <= request.room.y + request.room.height);
    }
    CHECK(board->grid.step_right >= tag.frame_inner_length + 3.5 * stroke - 1e-9);
    CHECK(board->grid.step_down >= tag.frame_inner_height + 3.5 * stroke - 1e-9);
    CHECK(tag.plate_length == board->grid.step_right);
    CHECK(tag.plate_height == board->grid.step_down);
  }
}

TEST_CASE("a board's tags have the shipped templates' proportions on whole printer dots") {
  for (const int dpi : {300, 600, 1200}) {
    for (const NamedSheet& sheet : kSheets) {
      CAPTURE(dpi);
      CAPTURE(sheet.name);
      BoardRequest request = request_of(sheet.width, sheet.height);
      request.dots_per_inch = dpi;
      const Result<Board> board = make_board(request);
      REQUIRE(board);
      const double module = module_width(board->tag);
      CHECK(is_whole(module * dpi / kMetresPerInch));
      CHECK(module >= 0.000264);
      CHECK(board->tag.frame_inner_length == Approx(113 * module));
      CHECK(board->tag.frame_inner_height == Approx(55 * module));
      CHECK(board->tag.frame_stroke == Approx(4 * module));
      CHECK(bar_height(board->tag) == Approx(37 * module));
    }
  }
}

TEST_CASE("a board on A4 has four columns and five rows of tags some 60 mm wide") {
  const Result<Board> board = make_board(request_of(0.297, 0.210));
  REQUIRE(board);
  CHECK(board->grid.columns == 4);
  CHECK(board->grid.rows == 5);
  const double outside = board->tag.frame_inner_length + 2 * board->tag.frame_stroke;
  CHECK(outside == Approx(0.0615).epsilon(0.01));
  const double module = 6 * kMetresPerInch / 300;
  CHECK(module_width(board->tag) == Approx(module));
  CHECK(board->scale[0] == 1);
  CHECK(board->scale_sigma == kUnmeasuredScaleSigma);
}

TEST_CASE("a board's codes are its tags' places, and no two are alike") {
  std::set<std::string> codes;
  std::size_t count = 0;
  for (const int serial : {0, 7, 999}) {
    BoardRequest request = request_of(1.189, 0.841);
    request.serial = serial;
    request.columns = 12;
    const Result<Board> board = make_board(request);
    REQUIRE(board);
    CHECK(board->grid.columns == 12);
    for (const BoardTag& tag : board->tags) {
      const GridPoint place = decode_position(board_code(), tag.digits);
      CHECK(place[0] == Approx(tag.corner.x).epsilon(1e-9));
      CHECK(place[1] == Approx(tag.corner.y).epsilon(1e-9));
      CHECK(place[2] == serial);
      CHECK(has_check_digit(CheckDigit::gs1, tag.digits));
      codes.insert(to_string(tag.digits));
    }
    count += board->tags.size();
  }
  CHECK(codes.size() == count);
}

TEST_CASE("digits of a place, by hand") {
  const BoardGrid grid{2, 2, {0.017, 0.018}, 0.065, 0.036};
  const std::vector<BoardTag> tags = tags_on_grid(grid, 12);
  REQUIRE(tags.size() == 4);
  CHECK(to_string(tags[0].digits).substr(0, 11) == "00170018012");
  CHECK(to_string(tags[1].digits).substr(0, 11) == "00820018012");
  CHECK(to_string(tags[3].digits).substr(0, 11) == "00820054012");
  // 3 (0 + 1 + 0 + 1 + 0 + 2) + (0 + 7 + 0 + 8 + 1) = 12 + 16 = 28, to 30.
  CHECK(to_string(tags[0].digits).back() == '2');
}

TEST_CASE("corners are where the sheet was measured to have them") {
  Board board;
  board.tag.frame_inner_length = 0.06;
  board.tag.frame_inner_height = 0.03;
  board.scale = {1.01, 0.99};
  const auto corners = corners_of(board, {{}, {0.1, 0.2}});
  CHECK(corners[0].x == Approx(0.101));
  CHECK(corners[0].y == Approx(0.198));
  CHECK(corners[1].x == Approx(1.01 * 0.16));
  CHECK(corners[1].y == Approx(0.198));
  CHECK(corners[2].x == Approx(1.01 * 0.16));
  CHECK(corners[2].y == Approx(0.99 * 0.23));
  CHECK(corners[3].x == Approx(0.101));
  CHECK(corners[3].y == Approx(0.99 * 0.23));
}

TEST_CASE("marks stand 8 mm inside, whole millimetres apart") {
  const auto marks = board_marks(0.2794, 0.2159);  // Letter: 263.4 and 199.9 mm to spare
  CHECK(marks[0].x == Approx(0.008));
  CHECK(marks[0].y == Approx(0.008));
  CHECK(marks[3].x == Approx(0.008 + 0.263));
  CHECK(marks[3].y == Approx(0.008 + 0.199));
  const auto distances = drawn_distances(0.2794, 0.2159);
  CHECK(distances[0] == Approx(0.263));
  CHECK(distances[1] == Approx(0.199));
}

TEST_CASE("boards that cannot be printed well are refused, with what could be") {
  BoardRequest request = request_of(0.297, 0.210);
  request.columns = 30;
  const Result<Board> narrow = make_board(request);
  REQUIRE_FALSE(narrow);
  CHECK(narrow.error().message ==
        "a board of 297 x 210 mm has room for at most 6 columns, not 30: in more, modules would be "
        "narrower than 0.264 mm and hard to print");
  request.columns = 6;
  CHECK(make_board(request));
  const Result<Board> tiny = make_board(request_of(0.05, 0.05));
  REQUIRE_FALSE(tiny);
  CHECK(tiny.error().message.find("take a larger sheet") != std::string::npos);
  const Result<Board> huge = make_board(request_of(12, 0.5));
  REQUIRE_FALSE(huge);
  CHECK(huge.error().message.find("9999 mm") != std::string::npos);
  CHECK(make_board(request_of(9.999, 0.5)));
  const Result<Board> small = make_board(request_of(0.13, 0.13));
  REQUIRE(small);
  CHECK(small->tags.size() >= 4);
}
