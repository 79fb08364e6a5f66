// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/label_fields.hpp"

#include <string>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

TEST_CASE("the first field that is none of a label's is found, with its braces") {
  CHECK_FALSE(unknown_field(""));
  CHECK_FALSE(unknown_field("no field, a } alone"));
  CHECK_FALSE(unknown_field("{name} at {chainage}"));
  CHECK(unknown_field("{name} {pair} {wall}") == "{pair}");
  CHECK(unknown_field("{Name}") == "{Name}");
  CHECK(unknown_field("{name} {x") == "{x");
}

TEST_CASE("fields are filled in, and what is none stays as it is written") {
  const auto value_of = [](std::string_view field) { return "<" + std::string(field) + ">"; };
  CHECK(filled_in("{name}: {x}, {y}", value_of) == "<name>: <x>, <y>");
  CHECK(filled_in("{pair} of {name} {x", value_of) == "{pair} of <name> {x");
  CHECK(filled_in("none }", value_of) == "none }");
}
