// SPDX-License-Identifier: Apache-2.0
// `tagsmith board` as its users run it.
#include <cmath>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/board_file.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

ProgramOutput run_board(const fs::path& output, const std::string& options = "") {
  return run_tagsmith("board -o '" + output.string() + "' " + options);
}

void replace_in_file(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = read_file(file).value();
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  REQUIRE(write_file(file, text.replace(at, from.size(), to)));
}

}  // namespace

TEST_CASE("a board is a sheet and a file that reads back, named after its output") {
  const TemporaryFolder folder;
  for (const char* extension : {".pdf", ".svg", ".png"}) {
    CAPTURE(extension);
    const fs::path sheet = folder.path() / (std::string("desk-") + (extension + 1) + extension);
    const ProgramOutput output = run_board(sheet, "--serial 7");
    CHECK_MESSAGE(output.exit_code == 0, output.err);
    CHECK(fs::file_size(sheet) > 5000);
    const Result<Board> board = load_board(fs::path(sheet).replace_extension(".yaml"));
    REQUIRE(board);
    CHECK(board->name == sheet.stem());
    CHECK(board->serial == 7);
    CHECK(board->tags.size() == 20);
  }
}

TEST_CASE("--json says what was made") {
  const TemporaryFolder folder;
  const fs::path sheet = folder.path() / "big.pdf";
  const ProgramOutput output = run_board(sheet, "--plate 600x400 --columns 5 --dpi 600 --json");
  REQUIRE(output.exit_code == 0);
  const nlohmann::json json = json_lines(output.out).at(0);
  const Board board = load_board(json["board"].get<std::string>()).value();
  CHECK(json["width"] == 0.6);
  CHECK(json["height"] == 0.4);
  CHECK(json["columns"] == 5);
  CHECK(json["tags"] == board.tags.size());
  CHECK(json["dots_per_inch"] == 600);
  const double dots = json["module"].get<double>() / 0.0254 * 600;
  CHECK(std::abs(dots - std::round(dots)) < 1e-4);
  CHECK(json["a_b"] == 0.584);
  CHECK(json["a_c"] == 0.384);
}

TEST_CASE("a plate lies as it is said, paper lies across") {
  const TemporaryFolder folder;
  const auto size_of = [&](const std::string& options) {
    const fs::path sheet = folder.path() / "b.pdf";
    fs::remove(folder.path() / "b.yaml");
    REQUIRE(run_board(sheet, options).exit_code == 0);
    const Board board = load_board(folder.path() / "b.yaml").value();
    return std::array{board.width, board.height};
  };
  CHECK(size_of("") == std::array{0.297, 0.210});
  CHECK(size_of("--paper letter") == std::array{0.2794, 0.2159});
  CHECK(size_of("--paper 200x300") == std::array{0.3, 0.2});
  CHECK(size_of("--plate 200x300") == std::array{0.2, 0.3});
  CHECK(size_of("--plate 300x200") == std::array{0.3, 0.2});
}

TEST_CASE("what was measured of a board stays; another board's file is never replaced") {
  const TemporaryFolder folder;
  const fs::path pdf = folder.path() / "desk.pdf";
  const fs::path file = folder.path() / "desk.yaml";
  REQUIRE(run_board(pdf).exit_code == 0);
  replace_in_file(file, "# measured: { a_b_mm: 281,", "measured: { a_b_mm: 281.5,");
  const std::string measured = read_file(file).value();
  CHECK(run_board(folder.path() / "desk.svg").exit_code == 0);
  CHECK(read_file(file).value() == measured);
  CHECK(load_board(file)->scale[0] == doctest::Approx(281.5 / 281));

  fs::remove(pdf);
  const ProgramOutput other = run_board(pdf, "--serial 1");
  CHECK(other.exit_code == 2);
  CHECK(other.err.find("desk.yaml: is there already") != std::string::npos);
  CHECK(read_file(file).value() == measured);
  CHECK_FALSE(fs::exists(pdf));
}

TEST_CASE("equal calls make equal bytes") {
  const TemporaryFolder folder;
  REQUIRE(run_board(folder.path() / "a" / "desk.pdf").exit_code == 0);
  REQUIRE(run_board(folder.path() / "b" / "desk.pdf").exit_code == 0);
  for (const char* name : {"desk.pdf", "desk.yaml"}) {
    CHECK(read_file(folder.path() / "a" / name).value() ==
          read_file(folder.path() / "b" / name).value());
  }
}

TEST_CASE("boards that cannot be are refused with what can, and nothing is written") {
  const TemporaryFolder folder;
  struct Row {
    const char* output;
    const char* options;
    const char* words;
  };
  for (const Row& row :
       {Row{"b.txt", "", ".pdf, .svg or .png"}, Row{"b.pdf", "--paper A9", "expected A4"},
        Row{"b.pdf", "--paper roll:300", "a board is one sheet"},
        Row{"b.pdf", "--plate A4", "expected WIDTHxHEIGHT"},
        Row{"b.pdf", "--plate 50x50", "expected sides from 129 mm"},
        Row{"b.pdf", "--plate 6000x3000", "to 5000 mm"},
        Row{"b.pdf", "--plate nanx300", "expected WIDTHxHEIGHT"},
        Row{"b.pdf", "--plate 300x200 --paper A4", "excludes"},
        Row{"b.pdf", "--columns 12", "at most 6 columns"}, Row{"b.pdf", "--columns 0", "1 to 1000"},
        Row{"b.pdf", "--serial 1000", "0 to 999"}, Row{"b.pdf", "--dpi 10", "50 to 10000"},
        Row{"b.pdf", "--name a/b", "--name a/b"},
        Row{"-b.pdf", "", "/-b.pdf: gives the board its name"}}) {
    CAPTURE(row.options);
    const ProgramOutput output = run_board(folder.path() / row.output, row.options);
    CHECK(output.exit_code == 2);
    CHECK_MESSAGE(output.err.find(row.words) != std::string::npos, output.err);
    CHECK(fs::is_empty(folder.path()));
  }
}
