// SPDX-License-Identifier: Apache-2.0
// The PDF and SVG files themselves: reproducible bytes, metadata, print settings.
#include "tagsmith/base/file.hpp"

#include <clocale>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/svg.hpp"
#include "tests/render/sample_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

struct Files {
  std::string pdf;
  std::string svg;
  bool operator==(const Files&) const = default;
};

Files render(const Page& page) {
  const Sheet sheet = sheet_of(page);
  return {render_pdf(std::span(&sheet, 1)).value(), render_svg(sheet)};
}

std::vector<Page> many_pages() {
  const Survey survey = sample_survey(small_template(), CheckDigit::sum10, "\u5317\u7ffc corridor");
  std::vector<Page> pages;
  for (int i = 0; i < 24; ++i) {
    pages.push_back(tag_page(survey, sample_tag(survey, {0.1 * i, 3.0, 0.4}, std::to_string(i))));
  }
  return pages;
}

// Runs a program on the PDF; `program` holds FILE where its path goes.
std::string run_on_pdf(const std::string& pdf, std::string command, const std::string& program) {
  REQUIRE_MESSAGE(has_program(program), (program + " is missing: install poppler-utils"));
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "page.pdf").string();
  REQUIRE(write_file(path, pdf));
  command.replace(command.find("FILE"), 4, "'" + path + "'");
  const ProgramOutput output = run_shell(command);
  REQUIRE(output.exit_code == 0);
  CHECK(output.err == "");
  return output.out;
}

}  // namespace

TEST_CASE("the same tag gives the same bytes, whatever the time zone and language") {
  const Page page = sample_page(small_template(), "\u7164\u77ff corridor");
  const Files first = render(page);
  ::setenv("TZ", "Asia/Kathmandu", 1);
  ::setenv("LANG", "ja_JP.UTF-8", 1);
  ::setenv("SOURCE_DATE_EPOCH", "86400", 1);
  std::setlocale(LC_ALL, "C.utf8");
  CHECK(render(page) == first);
  CHECK(first.pdf.find("CreationDate") == std::string::npos);
}

TEST_CASE("threads rendering at once give the bytes of one after the other") {
  const std::vector<Page> pages = many_pages();
  std::vector<Files> serial;
  for (const Page& page : pages) serial.push_back(render(page));
  std::vector<Files> parallel(pages.size());
  std::vector<std::thread> threads;
  constexpr std::size_t kThreads = 8;
  for (std::size_t first = 0; first < kThreads; ++first) {
    threads.emplace_back([&, first] {
      for (std::size_t i = first; i < pages.size(); i += kThreads) parallel[i] = render(pages[i]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(parallel == serial);
}

TEST_CASE("the PDF forbids scaling and asks for paper of its size") {
  const std::string pdf = render(sample_page(small_template())).pdf;
  CHECK(pdf.find("/PrintScaling /None") != std::string::npos);
  CHECK(pdf.find("/Enforce [ /PrintScaling ]") != std::string::npos);
  CHECK(pdf.find("/PickTrayByPDFSize true") != std::string::npos);
}

TEST_CASE("the PDF has the page's size, a title and a subject") {
  const std::string info =
      run_on_pdf(render(sample_page(small_template())).pdf, "pdfinfo FILE", "pdfinfo");
  CAPTURE(info);
  CHECK(info.find("corridor 000L\n") != std::string::npos);
  CHECK(info.find("template tag-400x300, digits 0190 1234 040 0 (gs1)\n") != std::string::npos);
  CHECK(info.find("1275.59 x 992.126 pts") != std::string::npos);  // 450 x 350 mm
  CHECK(info.find("Pages:           1\n") != std::string::npos);
}

TEST_CASE("the PDF embeds its fonts and holds no raster images") {
  for (const char* name : {"corridor", "\u7164\u77ff\u5df7\u9053"}) {
    const std::string pdf = render(sample_page(small_template(), name)).pdf;
    const std::string fonts = run_on_pdf(pdf, "pdffonts FILE | tail -n +3", "pdffonts");
    CAPTURE(fonts);
    CHECK(fonts.find("DejaVuSans") != std::string::npos);
    CHECK(fonts.find(" no ") == std::string::npos);  // columns: embedded, subset, unicode
    CHECK(run_on_pdf(pdf, "pdfimages -list FILE | tail -n +3", "pdfimages") == "");
  }
}

TEST_CASE("the PDF's text can be searched") {
  const std::string pdf = render(sample_page(small_template())).pdf;
  const std::string text = run_on_pdf(pdf, "pdftotext -layout FILE -", "pdftotext");
  CAPTURE(text);
  CHECK(text.find("0190 1234 040 0") != std::string::npos);
  CHECK(text.find("100 mm") != std::string::npos);
}

TEST_CASE("black is the grey 0 of the black ink alone") {
  REQUIRE_MESSAGE(has_program("qpdf"), "qpdf is missing: install qpdf");
  const std::string pdf = render(sample_page(small_template())).pdf;
  const std::string plain =
      run_on_pdf(pdf, "qpdf --qdf --object-streams=disable FILE - | strings", "qpdf");
  CHECK(plain.find("0 g ") != std::string::npos);
  CHECK(plain.find(" rg") == std::string::npos);
  CHECK(plain.find(" RG") == std::string::npos);
}

TEST_CASE("names that look like PDF stay names") {
  REQUIRE_MESSAGE(has_program("qpdf"), "qpdf is missing: install qpdf");
  const Page page = sample_page(small_template(), "0 0 0 rg /Type /Page endobj /CreationDate (D:");
  const std::string pdf = render(page).pdf;
  CHECK(run_on_pdf(pdf, "qpdf --check FILE", "qpdf").find("No syntax or stream encoding errors") !=
        std::string::npos);
  const std::string text = run_on_pdf(pdf, "pdftotext -layout FILE -", "pdftotext");
  CHECK(text.find("0 0 0 rg /Type /Page endobj /CreationDate (D:") != std::string::npos);
  const std::string info = run_on_pdf(pdf, "pdfinfo FILE", "pdfinfo");
  CHECK(info.find("CreationDate: ") == std::string::npos);
}

TEST_CASE("several pages make one PDF") {
  std::vector<Sheet> sheets;
  for (const Page& page : many_pages()) sheets.push_back(sheet_of(page));
  sheets.front().subject = "24 position tags";
  const Result<std::string> pdf = render_pdf(sheets);
  REQUIRE(pdf);
  const std::string info = run_on_pdf(*pdf, "pdfinfo FILE", "pdfinfo");
  CHECK(info.find("Pages:           24\n") != std::string::npos);
  CHECK(info.find("24 position tags") != std::string::npos);
}

TEST_CASE("no page and pages larger than PDF can say are errors") {
  CHECK(render_pdf({}).error().message == "PDF: no page to print, expected at least one");
  TagTemplate huge = small_template();
  huge.plate_length = 6;
  const Sheet sheet = sheet_of(sample_page(huge));
  CHECK(render_pdf(std::span(&sheet, 1)).error().message.find("6.05 x 0.35 m") !=
        std::string::npos);
}

TEST_CASE("the SVG's unit is the millimetre and its names are escaped") {
  const std::string svg = render(sample_page(small_template(), "<a> & \"b\"\n\x01\xff")).svg;
  CHECK(svg.find("width=\"450mm\" height=\"350mm\" viewBox=\"0 0 450 350\"") != std::string::npos);
  CHECK(svg.find("<title>&lt;a&gt; &amp; &quot;b&quot;  \ufffd 000L</title>") != std::string::npos);
  CHECK(svg.find("<text") == std::string::npos);
  CHECK(svg.find("<image") == std::string::npos);
}
