// SPDX-License-Identifier: Apache-2.0
// The whole loop as `./dev demo` runs it.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// The table's row that begins with this word.
std::vector<std::string> row_of(const std::string& text, const std::string& first) {
  for (const std::string& line : split(text, '\n')) {
    std::vector<std::string> words = words_of(line);
    if (words.size() > 5 && words[0] == first) return words;
  }
  return {};
}

// The number `from_end` words before the end of the row, the last being 0.
double number_at(const std::vector<std::string>& row, std::size_t from_end) {
  REQUIRE(row.size() > from_end);
  const std::optional<double> number = parse_number(row[row.size() - 1 - from_end]);
  REQUIRE(number.has_value());
  return *number;
}

}  // namespace

TEST_CASE("the demo prints, verifies, reads and localizes, and tells it all") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "demo";
  const ProgramOutput output = run_tagsmith("demo -o '" + folder.string() + "'");
  REQUIRE_MESSAGE(output.exit_code == 0, output.out << output.err);
  CHECK(output.err == "");
  CHECK(output.out.find("prints     16 files read; tags: 16 ok, 0 unknown, 0 misprinted, 0 "
                        "unreadable") != std::string::npos);
  CHECK(output.out.find("photos     20 files read; ") != std::string::npos);
  for (const char* file : {"print/000L.pdf", "print/007R.svg", "print/manifest.json",
                           "prints.jsonl", "photos.jsonl", "positions.txt"}) {
    CHECK_MESSAGE(fs::exists(folder / file), file);
  }
  const std::vector<std::string> lines = split(*read_file(folder / "photos.jsonl"), '\n');
  REQUIRE(lines.size() == 22);  // 20 photos, the summary, and nothing after the last line's end
  const auto summary = parsed_json(lines[20])["summary"];
  CHECK(summary["unknown"] == 0);
  CHECK(summary["missing"] == nlohmann::json{"004L", "004R"});  // no point looks at pair 4

  // The last columns are Table 4 of the paper; before them what our photos give by the closed form
  // with the true d, by the closed form, and by the joint method.
  const std::vector<std::string> table4 = split(*read_file("tests/paper/table4.csv"), '\n');
  REQUIRE(table4.size() >= 11);
  for (std::size_t point = 1; point <= 10; ++point) {
    CAPTURE(point);
    const std::vector<std::string> published = split(table4[point], ',');
    const std::vector<std::string> row = row_of(output.out, std::to_string(point));
    CHECK(number_at(row, 1) == *parse_number(published[14]));
    CHECK(number_at(row, 0) == *parse_number(published[15]));
    CHECK(number_at(row, 3) < 0.005);
    CHECK(number_at(row, 2) < 0.010);
    CHECK(number_at(row, 7) < 0.001);
    CHECK(number_at(row, 6) < 0.0005);
  }
  const std::vector<std::string> located = row_of(output.out, "located");  // N of 10, four times
  CHECK(number_at(located, 11) == 10);
  CHECK(number_at(located, 8) == 3);
  const std::vector<std::string> mean = row_of(output.out, "mean");
  CHECK(number_at(mean, 1) == 0.142);
  CHECK(number_at(mean, 0) == 0.083);
  CHECK(number_at(mean, 7) < 0.0005);
}

TEST_CASE("a folder that cannot be made is an error, and nothing is left behind") {
  const TemporaryFolder temporary;
  const fs::path file = temporary.path() / "file";
  REQUIRE(write_file(file, "x").has_value());
  const ProgramOutput output = run_tagsmith("demo -o '" + (file / "demo").string() + "'");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("tagsmith demo: ") == 0);
  CHECK(*read_file(file) == "x");
}

}  // namespace tagsmith::detail::test
