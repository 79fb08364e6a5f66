// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/survey/board_file.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

// Of an A4 sheet, measured; nine lines.
const std::string kRightBoard =
    "board: desk\n"
    "serial: 12\n"
    "sheet: [0.297, 0.210]\n"
    "feature_frame: { inner: [0.057404, 0.02794], stroke: 0.002032 }\n"
    "symbol: { quiet_zone: 9, margin: 9, dots_per_inch: 300 }\n"
    "tags: { columns: 4, rows: 5, first: [0.017, 0.019], step: [0.071, 0.036] }\n"
    "drawn: { a_b_mm: 281, a_c_mm: 194 }\n"
    "measured: { a_b_mm: 280.4, a_c_mm: 194.1, sigma_mm: 0.1 }\n";

Diagnosed<Board> read_text_as_board(const std::string& text) {
  const TemporaryFolder folder;
  const auto reading = read_board(write_text(folder.path() / "b.yaml", text));
  REQUIRE(reading.has_value());
  return *reading;
}

const Breakage kBoardErrors[] = {
    {"no name", "board: desk\n", "", "missing-key", 1},
    {"name as a path", "board: desk", "board: ../desk", "bad-name", 1},
    {"serial of four digits", "serial: 12", "serial: 1000", "out-of-range", 2},
    {"negative serial", "serial: 12", "serial: -1", "out-of-range", 2},
    {"serial of half", "serial: 12", "serial: 0.5", "wrong-type", 2},
    {"sheet in millimetres", "[0.297, 0.210]", "[297, 210]", "out-of-range", 3},
    {"sheet of one number", "[0.297, 0.210]", "0.297", "wrong-type", 3},
    {"no stroke", ", stroke: 0.002032", "", "missing-key", 4},
    {"frame off its middle", "stroke:", "offset: [0, 0], stroke:", "unknown-key", 4},
    {"quiet zone below GS1's", "quiet_zone: 9", "quiet_zone: 8", "out-of-range", 5},
    {"margin that leaves no bars", "margin: 9", "margin: 28", "no-bars", 5},
    {"no columns", "columns: 4, ", "", "missing-key", 6},
    {"no tags", "columns: 4", "columns: 0", "out-of-range", 6},
    {"tags without end", "rows: 5", "rows: 1000000000", "out-of-range", 6},
    {"first of half a millimetre", "first: [0.017,", "first: [0.0175,", "off-millimetre", 6},
    {"step of a tenth", "step: [0.071, 0.036]", "step: [0.071, 0.0361]", "off-millimetre", 6},
    {"tags on each other", "step: [0.071,", "step: [0.061,", "tags-overlap", 6},
    {"two columns on each other", "columns: 4, rows: 5, first: [0.017, 0.019], step: [0.071,",
     "columns: 2, rows: 5, first: [0.017, 0.019], step: [0.061,", "tags-overlap", 6},
    {"two rows on each other", "rows: 5, first: [0.017, 0.019], step: [0.071, 0.036]",
     "rows: 2, first: [0.017, 0.019], step: [0.071, 0.031]", "tags-overlap", 6},
    {"rows on each other", "0.036]", "0.031]", "tags-overlap", 6},
    {"right of the sheet", "columns: 4", "columns: 5", "outside-sheet", 6},
    {"below the sheet", "first: [0.017, 0.019]", "first: [0.017, 0.037]", "outside-sheet", 6},
    {"left of the sheet", "first: [0.017,", "first: [0.001,", "outside-sheet", 6},
    {"nothing drawn", "drawn: { a_b_mm: 281, a_c_mm: 194 }\n", "", "missing-key", 1},
    {"one distance", ", a_c_mm: 194.1", "", "missing-key", 8},
    {"fit to page", "280.4, a_c_mm: 194.1", "267.0, a_c_mm: 184.3", "board-scale", 8},
    {"centimetres", "280.4, a_c_mm: 194.1", "28.04, a_c_mm: 19.41", "board-scale", 8},
    {"one slip", "a_b_mm: 280.4", "a_b_mm: 284.4", "board-scale", 8},
    {"sigma of nothing", "sigma_mm: 0.1", "sigma_mm: 0", "out-of-range", 8},
    {"a misspelt key", "sigma_mm", "sigma", "unknown-key", 8},
};

}  // namespace

TEST_CASE("the board that the others break is right, and has its measured scale") {
  const Diagnosed<Board> reading = read_text_as_board(kRightBoard);
  CHECK_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics));
  REQUIRE(reading.value);
  const Board& board = *reading.value;
  CHECK(board.name == "desk");
  CHECK(board.serial == 12);
  CHECK(board.tags.size() == 20);
  CHECK(board.scale[0] == Approx(280.4 / 281));
  CHECK(board.scale[1] == Approx(194.1 / 194));
  CHECK(board.scale_sigma == Approx(0.1 / 194));
  CHECK(to_string(board.tags.back().digits).substr(0, 11) == "02300163012");
}

TEST_CASE("every way to break a board is reported by its rule and line") {
  for (const Breakage& broken : kBoardErrors) {
    CAPTURE(broken.name);
    const Diagnosed<Board> reading =
        read_text_as_board(replaced(kRightBoard, broken.from, broken.to));
    CHECK_FALSE(reading.value.has_value());
    CHECK_MESSAGE(count_findings(reading.diagnostics, broken.code, broken.line) >= 1,
                  to_string(reading.diagnostics));
  }
}

TEST_CASE("one column or one row of tags may have any step that way") {
  const std::string grid = "columns: 4, rows: 5, first: [0.017, 0.019], step: [0.071, 0.036]";
  const auto reading = [&](const std::string& other) {
    return read_text_as_board(replaced(kRightBoard, grid, other));
  };
  const Diagnosed<Board> column =
      reading("columns: 1, rows: 5, first: [0.017, 0.019], step: [0.001, 0.036]");
  REQUIRE_MESSAGE(column.value, to_string(column.diagnostics));
  CHECK(column.value->tags.size() == 5);
  const Diagnosed<Board> row =
      reading("columns: 4, rows: 1, first: [0.017, 0.019], step: [0.071, 0.001]");
  REQUIRE_MESSAGE(row.value, to_string(row.diagnostics));
  CHECK(row.value->tags.size() == 4);
}

TEST_CASE("a scale that no print has comes with its remedy") {
  const Diagnosed<Board> reading =
      read_text_as_board(replaced(kRightBoard, "280.4, a_c_mm: 194.1", "267.0, a_c_mm: 184.3"));
  REQUIRE(reading.diagnostics.size() == 1);
  CHECK(reading.diagnostics[0].message ==
        "the print is 95.02 % of its drawn size to the right and 95 % down, more than 2 % off");
  CHECK(reading.diagnostics[0].hint.find("print again at 100 %") != std::string::npos);
}

TEST_CASE("a board that nobody measured is as drawn, less surely") {
  const std::size_t measured = kRightBoard.find("measured");
  const Diagnosed<Board> reading = read_text_as_board(kRightBoard.substr(0, measured));
  REQUIRE(reading.value);
  CHECK(reading.value->scale == std::array{1.0, 1.0});
  CHECK(reading.value->scale_sigma == kUnmeasuredScaleSigma);
  const Diagnosed<Board> unsaid = read_text_as_board(replaced(kRightBoard, ", sigma_mm: 0.1", ""));
  REQUIRE(unsaid.value);
  CHECK(unsaid.value->scale_sigma == Approx(0.2 / 194));
}

TEST_CASE("what is written of a board reads back as the board, and measures by removing a #") {
  for (const double width : {0.297, 0.2794, 0.841, 1.189}) {
    for (const int dpi : {50, 300, 720, 10'000}) {
      CAPTURE(width);
      CAPTURE(dpi);
      BoardRequest request{"my board", 999, width, 0.594, {0.013, 0.013, width - 0.02, 0.566}};
      request.dots_per_inch = dpi;
      const Result<Board> board = make_board(request);
      REQUIRE(board);
      const std::string text = board_file_text(*board);
      const Diagnosed<Board> reading = read_text_as_board(text);
      REQUIRE_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics) << text);
      REQUIRE(reading.value->tags.size() == board->tags.size());
      for (std::size_t i = 0; i < board->tags.size(); ++i) {
        CHECK(reading.value->tags[i].digits == board->tags[i].digits);
        const auto expected = corners_of(*board, board->tags[i]);
        const auto found = corners_of(*reading.value, reading.value->tags[i]);
        for (std::size_t corner = 0; corner < 4; ++corner) {
          CHECK(found[corner].x == Approx(expected[corner].x).epsilon(1e-7));
          CHECK(found[corner].y == Approx(expected[corner].y).epsilon(1e-7));
        }
      }
      CHECK(module_width(reading.value->tag) == Approx(module_width(board->tag)).epsilon(1e-6));
      CHECK(reading.value->tag.plate_length == Approx(board->tag.plate_length));
      const Diagnosed<Board> measured =
          read_text_as_board(replaced(text, "# measured:", "measured:"));
      REQUIRE_MESSAGE(measured.value, to_string(measured.diagnostics));
      CHECK(measured.value->scale == std::array{1.0, 1.0});
      CHECK(measured.value->scale_sigma < kUnmeasuredScaleSigma);
    }
  }
}

TEST_CASE("a board in another file's place, or another file in its place, is named") {
  const TemporaryFolder folder;
  const auto as_rig = read_rig(write_text(folder.path() / "b.yaml", kRightBoard));
  REQUIRE(as_rig);
  CHECK(count_findings(as_rig->diagnostics, "wrong-kind") == 1);
  const Diagnosed<Board> as_board = read_text_as_board(right_rig());
  CHECK_FALSE(as_board.value);
  CHECK(count_findings(as_board.diagnostics, "wrong-kind") == 1);
  const Result<Board> loaded = load_board(write_text(folder.path() / "r.yaml", right_rig()));
  REQUIRE_FALSE(loaded);
  CHECK(loaded.error().message.find("expected a calibration board") != std::string::npos);
  CHECK_FALSE(load_board(folder.path() / "none.yaml"));
}
