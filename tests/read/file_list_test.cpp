// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/file_list.hpp"

#include <sstream>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail {

TEST_CASE("files stay as given, folders become their pictures in order, - the list given") {
  const test::TemporaryFolder temporary;
  const auto& folder = temporary.path();
  for (const char* name : {"b.png", "a.JPG", "c.pdf", "notes.txt", "deeper/d.png"}) {
    REQUIRE(write_file(folder / name, "x").has_value());
  }
  std::istringstream input("first image.jpg\r\n\nsecond.jpg");
  const auto files =
      list_files({"no such file.jpg", folder.string(), "-"}, image_extensions(), input);
  REQUIRE(files.has_value());
  CHECK(files->files == std::vector<std::filesystem::path>{"no such file.jpg", folder / "a.JPG",
                                                           folder / "b.png", "first image.jpg",
                                                           "second.jpg"});
  const auto with_pdf = list_files({folder.string()}, image_and_pdf_extensions(), input);
  REQUIRE(with_pdf.has_value());
  CHECK(with_pdf->files.size() == 3);
  CHECK(files->skipped == SkippedFiles{{"pdf", 1}, {"txt", 1}, {"folder", 1}});
}

TEST_CASE("a folder without pictures and an empty list are errors") {
  const test::TemporaryFolder folder;
  std::istringstream input("\n\n");
  const auto none = list_files({folder.path().string()}, image_extensions(), input);
  REQUIRE(!none.has_value());
  CHECK(none.error().message.find(folder.path().string() + ": holds no file to read") == 0);
  CHECK(!list_files({"-"}, image_extensions(), input).has_value());
}

}  // namespace tagsmith::detail
