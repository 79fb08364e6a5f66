// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/render/board_page.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/png.hpp"
#include "tagsmith/render/print_paper.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/board_file.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

struct BoardOptions {
  std::string output;
  std::string paper;
  std::string plate;
  std::string name;  // empty = the output's
  int columns = 0;
  int serial = 0;
  int dots_per_inch = 300;
  bool json = false;
};

fs::path board_file_of(const BoardOptions& options) {
  return fs::path(options.output).replace_extension(".yaml");
}

// Papers are in landscape, like the pictures of most cameras; a plate has the stated orientation.
Result<PrintPaper> sheet_of(const BoardOptions& options) {
  if (!options.plate.empty()) return parse_print_plate(options.plate);
  Result<PrintPaper> paper = parse_print_paper(options.paper.empty() ? "A4" : options.paper);
  if (!paper) return paper;
  if (paper->roll()) {
    return fail("--paper " + options.paper +
                ": a board is one sheet: expected its size, as WIDTHxHEIGHT in millimetres");
  }
  std::swap(paper->width, paper->height);
  return paper;
}

Result<Board> board_of(const BoardOptions& options, const PrintPaper& sheet) {
  BoardRequest request;
  request.name = options.name.empty() ? fs::path(options.output).stem().string() : options.name;
  request.serial = options.serial;
  request.width = sheet.width;
  request.height = sheet.height;
  request.room = board_room(sheet.width, sheet.height);
  request.columns = options.columns;
  request.dots_per_inch = options.dots_per_inch;
  constexpr std::size_t kLongestName = 100;
  if (!is_plain_name(request.name) || request.name.size() > kLongestName) {
    const std::string found = options.name.empty()
                                  ? "--output " + options.output + ": gives the board its name"
                                  : "--name " + request.name;
    return fail(found +
                ": expected at most 100 bytes that begin with a letter or digit, without / \\ , : "
                "or \"");
  }
  return make_board(request);
}

BoardNotes notes_of(const BoardOptions& options, const PrintPaper& sheet) {
  const bool is_size = sheet.name.find_first_of("xX") != std::string::npos;
  const bool to_glue = options.plate.empty();
  return {.sheet = !to_glue  ? "plate"
                   : is_size ? "paper"
                             : sheet.name,
          .program = "tagsmith " TAGSMITH_VERSION,
          .board_file = board_file_of(options).filename().string(),
          .to_glue = to_glue};
}

// The sheet in the format of its name; PNG in the printer's dots.
Result<std::string> render(const Page& page, const BoardOptions& options) {
  const Sheet sheet = sheet_of(page);
  if (sheet_format_of(options.output) == SheetFormat::png) {
    return render_png(sheet, options.dots_per_inch, PngColours::grey);
  }
  Result<std::vector<SheetFile>> files = render_sheets(std::span(&sheet, 1), options.output);
  if (!files) return fail(files);
  return std::move(files->front().bytes);
}

// Whether the board's file must be written. One of the same board stays: it may contain
// measurements. Fails when another file is in its place.
Result<bool> needs_board_file(const fs::path& file, const std::string& text) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return true;
  const Result<Diagnosed<Board>> there = read_board(file);
  if (there && there->value && board_file_text(*there->value) == text) return false;
  return fail(file.string() +
              ": is there already and is no file of this board; it may say what was measured of "
              "another one: give --output another name, or remove it");
}

Result<void> check_files(const BoardOptions& options) {
  CommandFiles files;
  files.writes(options.output, "--output");
  files.writes(board_file_of(options), "the board's file");
  return files.check();
}

std::string board_json(const Board& board, const BoardOptions& options) {
  const auto metres = [](double value) { return with_decimals(value, 9); };
  const auto [right, down] = drawn_distances(board.width, board.height);
  const Json json{{"sheet", options.output},
                  {"board", board_file_of(options).string()},
                  {"name", board.name},
                  {"serial", board.serial},
                  {"width", metres(board.width)},
                  {"height", metres(board.height)},
                  {"columns", board.grid.columns},
                  {"rows", board.grid.rows},
                  {"tags", board.tags.size()},
                  {"module", metres(module_width(board.tag))},
                  {"dots_per_inch", board.tag.dots_per_inch},
                  {"a_b", metres(right)},
                  {"a_c", metres(down)}};
  return json_text(json);
}

void report(const Board& board, const BoardOptions& options) {
  const std::string file = board_file_of(options).string();
  if (options.json) {
    to_stdout("{}\n", board_json(board, options));
    return;
  }
  to_stdout("{}\n{}\n", options.output, file);
  to_stderr(
      "tagsmith board: {} x {} tags, modules of {:.3f} mm; print at 100 %, keep flat, measure from "
      "cross to cross (A to B, A to C) and write both into {}\n",
      board.grid.columns, board.grid.rows, module_width(board.tag) * 1e3, file);
}

Result<int> make(const BoardOptions& options) {
  if (!sheet_format_of(options.output)) {
    return fail("--output " + options.output + ": expected a name that ends in .pdf, .svg or .png");
  }
  if (!has_glyphs("0")) return fail("no font on this machine: install fonts-dejavu-core");
  const Result<PrintPaper> sheet = sheet_of(options);
  if (!sheet) return fail(sheet);
  const Result<Board> board = board_of(options, *sheet);
  if (!board) return fail(board);
  if (auto usable = check_files(options); !usable) return fail(usable);
  const std::string text = board_file_text(*board);
  const Result<bool> needs_file = needs_board_file(board_file_of(options), text);
  if (!needs_file) return fail(needs_file);
  Result<std::string> bytes = render(lay_out_board(*board, notes_of(options, *sheet)), options);
  if (!bytes) return fail(bytes);
  std::vector<SheetFile> files{{options.output, std::move(*bytes)}};
  if (*needs_file) files.push_back({board_file_of(options), text});
  if (auto written = publish_files(files); !written) return fail(written);
  report(*board, options);
  return kExitOk;
}

std::vector<CommandOption> board_options(BoardOptions& options) {
  return {
      required(file_option("-o,--output", &options.output,
                           "FILE.pdf, FILE.svg or FILE.png; the board's file is FILE.yaml")),
      value_option(
          "--paper", &options.paper, "PAPER",
          "A4, A3, A2, A1, A0, Letter, Tabloid or WIDTHxHEIGHT in mm, laid across (default: A4)"),
      excluding({"--paper"},
                value_option(
                    "--plate", &options.plate, "WIDTHxHEIGHT",
                    "A plate that is printed on, in mm, as it lies: 600x400, or 400x600 upright")),
      number_option("--columns", &options.columns, "N", 1, 1000,
                    "Tags side by side: more are smaller; rows follow (default: the fewest that "
                    "make 16 tags or more)"),
      number_option(
          "--serial", &options.serial, "N", 0, kMostBoardSerial,
          "Tells boards apart that one picture shows: a different one for each (default: 0)"),
      value_option("--name", &options.name, "TEXT",
                   "Of the board, on the sheet and in its file (default: the output's)"),
      number_option("--dpi", &options.dots_per_inch, "DPI", 50, 10'000,
                    "The printer's dots per inch: a module is a whole number of dots; also the "
                    "resolution of PNG (default: 300)"),
      json_flag(options.json, "One JSON object")};
}

}  // namespace

Command board_command() {
  const auto options = std::make_shared<BoardOptions>();
  return {
      .name = "board",
      .summary = "A sheet of tags to calibrate cameras by, and the file that says its size",
      .options = board_options(*options),
      .notes =
          "Every tag's code is its place on the sheet in millimetres, so that any part of a board "
          "tells where it is. Print it at 100 %, glue it on a flat plate, measure from cross A to "
          "B and from A to C, and write both into the board's file. A board's file that is there "
          "already is kept when it is of the same board, and never replaced.\n\n"
          "Example:\n"
          "  tagsmith board -o board.pdf\n"
          "  tagsmith board -o wall.pdf --plate 1200x800 --serial 1",
      .run = [options] { return make(*options); },
  };
}

}  // namespace tagsmith::detail
