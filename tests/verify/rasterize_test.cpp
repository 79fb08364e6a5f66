// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/rasterize.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail {
namespace {

// A PDF of one page a media box (points), each with a black square of 72 points at its lower left.
std::string pdf_of(const std::vector<std::string>& pages) {
  std::string kids;
  std::string objects;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const std::string number = std::to_string(i + 4);
    kids += number + " 0 R ";
    objects +=
        number + " 0 obj <</Type /Page /Parent 2 0 R /Contents 3 0 R " + pages[i] + ">> endobj\n";
  }
  return "%PDF-1.4\n1 0 obj <</Type /Catalog /Pages 2 0 R>> endobj\n"
         "2 0 obj <</Type /Pages /Count " +
         std::to_string(pages.size()) + " /Kids [" + kids +
         "]>> endobj\n3 0 obj <</Length 17>> stream\n0 0 72 72 re f   \nendstream endobj\n" +
         objects + "trailer <</Root 1 0 R>>\n%%EOF\n";
}

// Sets an environment variable for its scope.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value, 1);
  }
  ~ScopedVariable() { ::setenv(name_, before_.c_str(), 1); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
  std::string before_;
};

}  // namespace

TEST_CASE("pages come with their size and at 150 dpi") {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "-a 'b' $(c).pdf";
  REQUIRE(
      write_file(path, pdf_of({"/MediaBox [0 0 288 144]", "/MediaBox [0 0 288 144] /Rotate 90"}))
          .has_value());
  CHECK(is_pdf(*read_file(path)));
  const auto pages = pdf_pages(path);
  REQUIRE_MESSAGE(pages.has_value(), pages.error().message);
  REQUIRE(pages->size() == 2);
  CHECK((*pages)[0].width == doctest::Approx(4 * 0.0254));
  CHECK((*pages)[0].height == doctest::Approx(2 * 0.0254));
  CHECK((*pages)[1].width == doctest::Approx(2 * 0.0254));

  const auto page = rasterize_page(path, 1, (*pages)[0]);
  REQUIRE_MESSAGE(page.has_value(), page.error().message);
  CHECK(page->metres_per_pixel == doctest::Approx(0.0254 / 150));
  CHECK(page->image.width == 600);
  CHECK(page->image.height == 300);
  CHECK(page->image.view().at(10, 290) == 0);   // inside the square of 150 pixels
  CHECK(page->image.view().at(148, 152) == 0);  // its far corner
  CHECK(page->image.view().at(155, 290) == 255);
  CHECK(page->image.view().at(10, 10) == 255);
  const auto turned = rasterize_page(path, 2, (*pages)[1]);
  REQUIRE(turned.has_value());
  CHECK(turned->image.width == 300);
}

TEST_CASE("a page of 10 x 10 m is drawn with fewer dots") {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.pdf";
  REQUIRE(write_file(path, pdf_of({"/MediaBox [0 0 28346 28346]"})).has_value());
  const auto pages = pdf_pages(path);
  REQUIRE(pages.has_value());
  const auto page = rasterize_page(path, 1, (*pages)[0]);
  REQUIRE_MESSAGE(page.has_value(), page.error().message);
  const double pixels = static_cast<double>(page->image.samples.size());
  CHECK(pixels < 41e6);
  CHECK(pixels > 39e6);
  CHECK(page->image.width * page->metres_per_pixel == doctest::Approx(10.0).epsilon(0.001));
}

TEST_CASE("what is no PDF, or a broken one, is an error that names the file") {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "broken.pdf";
  CHECK(!is_pdf("PDF-1.4"));
  for (const std::string& text : {std::string("%PDF-1.4\nnothing\n"), std::string("%PDF-"),
                                  pdf_of({}), pdf_of({"/MediaBox [0 0 0 0]"}).substr(0, 90)}) {
    CAPTURE(text);
    REQUIRE(write_file(path, text).has_value());
    const auto pages = pdf_pages(path);
    REQUIRE(!pages.has_value());
    CHECK_MESSAGE(pages.error().message.starts_with(path.string() + ": "), pages.error().message);
  }
}

TEST_CASE("without poppler-utils the error says what to install") {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.pdf";
  REQUIRE(write_file(path, pdf_of({"/MediaBox [0 0 288 144]"})).has_value());
  const ScopedVariable no_programs("PATH", folder.path().c_str());
  const auto pages = pdf_pages(path);
  REQUIRE(!pages.has_value());
  CHECK(pages.error().message.find("PDF files need poppler-utils: pdfinfo: not found") !=
        std::string::npos);
}

}  // namespace tagsmith::detail
