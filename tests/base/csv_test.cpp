// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/csv.hpp"

#include <string>
#include <vector>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

TEST_CASE("text that a spreadsheet would compute gets an apostrophe, numbers get none") {
  const struct {
    const char* text;
    const char* field;
  } cases[] = {
      {"000L", "000L"},
      {"-1.5", "-1.5"},
      {"+2e3", "+2e3"},
      {"a=b", "a=b"},
      {"it's", "it's"},
      {"'000L'", "'000L'"},
      {"=HYPERLINK(\"http://x\",\"y\")", "\"'=HYPERLINK(\"\"http://x\"\",\"\"y\"\")\""},
      {"@SUM(A1)", "'@SUM(A1)"},
      {"-1+cmd|' /C calc'!A0", "'-1+cmd|' /C calc'!A0"},
      {"+", "'+"},
      {"\t=1", "\"'\t=1\""},
      {"\r=1", "\"'\r=1\""},
      {"'=1", "''=1"},
  };
  for (const auto& one : cases) {
    CAPTURE(one.text);
    CHECK(csv_field(one.text) == one.field);
  }
}

TEST_CASE("what is written as CSV is read back as it was") {
  const std::vector<std::string> fields{"",     "a,b", "say \"x\"", "=1+1", "'=1", "''@x",
                                        "-0.5", "+",   "'",         "it's", "-",   "\t=1"};
  std::string row = csv_row(fields);
  REQUIRE(row.ends_with("\r\n"));
  row.resize(row.size() - 2);
  const auto read = split_csv(row);
  REQUIRE(read.has_value());
  CHECK(*read == fields);
}
