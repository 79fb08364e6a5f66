// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/print_settings.hpp"

#include <string>

#include <doctest/doctest.h>

namespace tagsmith::detail {

TEST_CASE("black and cut contours get their colour spaces, whatever the blanks") {
  struct Case {
    const char* content;
    const char* expected;
  };
  for (const Case& example : {
           Case{"0 0 0 rg 1 2 3 4 re f", "0 g 1 2 3 4 re f"},
           Case{"q\n0 0\n0 RG S", "q\n0 G S"},
           Case{"1 1 1 rg 1 1 1 RG B", "1 g 1 G B"},
           Case{"1 0 1 RG S", "/CutContour CS 1 SCN S"},
           Case{"1 0 1 rg f", "1 0 1 rg f"},
           Case{"10 0 0 rg f", "10 0 0 rg f"},
           Case{"0 0 0.5 rg f", "0 0 0.5 rg f"},
           Case{"(0 0 0 rg) Tj", "(0 0 0 rg) Tj"},
           Case{"(a \\) (0 0 0 rg) b) Tj 0 0 0 rg", "(a \\) (0 0 0 rg) b) Tj 0 g"},
           Case{"0 0 (0) rg", "0 0 (0) rg"},
           Case{"(never closed 0 0 0 rg", "(never closed 0 0 0 rg"},
       }) {
    CAPTURE(example.content);
    CHECK(with_print_colours(example.content, true) == example.expected);
  }
  CHECK(with_print_colours("1 0 1 RG S", false) == "1 0 1 RG S");
}

TEST_CASE("a PDF that Cairo did not write is an error, not half a file") {
  for (const char* bytes :
       {"", "%PDF-1.4\n", "%PDF-1.4\n1 0 obj\n<< /Type /Catalog\n>>\nendobj\n"}) {
    CAPTURE(bytes);
    PrintSettingsFilter filter([](std::string_view) { return true; });
    filter.take(bytes);
    CHECK_FALSE(filter.finish());
  }
}

TEST_CASE("a sink that takes no more stops the PDF") {
  std::size_t room = 2000;
  PrintSettingsFilter filter([&](std::string_view bytes) {
    if (bytes.size() > room) return false;
    room -= bytes.size();
    return true;
  });
  CHECK_FALSE(
      filter.take("%PDF-1.4\n1 0 obj\n<< /A (" + std::string(3000, 'a') + ")\n>>\nendobj\n"));
  CHECK_FALSE(filter.finish());
}

}  // namespace tagsmith::detail
