// SPDX-License-Identifier: Apache-2.0
// PDF/X-4 as poppler and qpdf see it.
#include "tagsmith/render/pdf_x.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <lcms2.h>
#include <pugixml.hpp>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tests/render/sample_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

std::filesystem::path press(const TemporaryFolder& folder, cmsProfileClassSignature kind,
                            cmsColorSpaceSignature inks) {
  const std::filesystem::path path = folder.path() / "press.icc";
  const cmsHPROFILE profile = cmsCreateProfilePlaceholder(nullptr);
  cmsSetProfileVersion(profile, 2.4);
  cmsSetDeviceClass(profile, kind);
  cmsSetColorSpace(profile, inks);
  cmsSetPCS(profile, cmsSigLabData);
  cmsMLU* name = cmsMLUalloc(nullptr, 1);
  cmsMLUsetASCII(name, "en", "US", "Trial press (coated)");
  cmsWriteTag(profile, cmsSigProfileDescriptionTag, name);
  cmsMLUfree(name);
  REQUIRE(cmsSaveProfileToFile(profile, path.c_str()) != 0);
  cmsCloseProfile(profile);
  return path;
}

Sheet plate_sheet(bool with_contour) {
  TagTemplate tag = small_template();
  tag.cut.contour = with_contour;
  return sheet_of(sample_page(tag, "Grube \u00dc & <7>"));
}

std::string written(const TemporaryFolder& folder, const Result<std::string>& pdf) {
  REQUIRE_MESSAGE(pdf, pdf.error().message);
  const std::filesystem::path path = folder.path() / "plate.pdf";
  std::ofstream(path, std::ios::binary) << *pdf;
  return "'" + path.string() + "'";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("with a press's profile a PDF is PDF/X-4 to poppler, and sound to qpdf") {
  const TemporaryFolder folder;
  OutputIntent intent =
      load_output_intent(press(folder, cmsSigOutputClass, cmsSigCmykData)).value();
  CHECK(intent.condition == "Trial press coated");
  CHECK(intent.has_process);
  for (const bool as_outlines : {false, true}) {
    Sheet sheet = plate_sheet(true);
    sheet.trim.reset();
    sheet.text_as_outlines = as_outlines;
    const std::string file = written(folder, render_pdf({&sheet, 1}, &intent));
    CHECK(run_shell("qpdf --check " + file).exit_code == 0);
    const std::string info = run_shell("pdfinfo -box " + file).out;
    CHECK(has(info, "PDF/X-4"));
    CHECK(has(info, "ISO 15930-7"));
    CHECK(has(info, "PDF version:     1.6"));
    CHECK(has(info, "TrimBox:"));
    // Two lines head the table of fonts.
    const std::string fonts = run_shell("pdffonts " + file).out;
    CHECK((std::count(fonts.begin(), fonts.end(), '\n') > 2) == !as_outlines);
    const std::string metadata = run_shell("pdfinfo -meta " + file).out;
    CHECK(has(metadata, "<pdfxid:GTS_PDFXVersion>PDF/X-4</pdfxid:GTS_PDFXVersion>"));
    CHECK(has(metadata, "Grube \u00dc &amp; &lt;7&gt;"));
    CHECK(pugi::xml_document().load_string(metadata.c_str()));
    const std::string objects =
        run_shell("qpdf --qdf --object-streams=disable " + file + " - | tr -d '\\000'").out;
    CHECK(has(objects, "/DestOutputProfile"));
    CHECK(has(objects, "/Separation"));
    for (const char* colour : {" rg\n", " RG\n"}) CHECK_FALSE(has(objects, colour));
  }
}

TEST_CASE("a press of black ink prints plates, but previews no spot colour") {
  const TemporaryFolder folder;
  const OutputIntent intent =
      load_output_intent(press(folder, cmsSigOutputClass, cmsSigGrayData)).value();
  CHECK_FALSE(intent.has_process);
  const Sheet plain = plate_sheet(false);
  CHECK(has(run_shell("pdfinfo " + written(folder, render_pdf({&plain, 1}, &intent))).out,
            "PDF/X-4"));
  const Sheet cut = plate_sheet(true);
  CHECK_FALSE(render_pdf({&cut, 1}, &intent));
}

TEST_CASE("what is no press's profile is refused by the file's name") {
  const TemporaryFolder folder;
  for (const auto& [kind, inks] :
       {std::pair{cmsSigDisplayClass, cmsSigRgbData}, std::pair{cmsSigInputClass, cmsSigCmykData},
        std::pair{cmsSigOutputClass, cmsSigRgbData}}) {
    const Result<OutputIntent> intent = load_output_intent(press(folder, kind, inks));
    REQUIRE_FALSE(intent);
    CHECK(has(intent.error().message, "press.icc: is no profile of a press"));
  }
  const std::filesystem::path other = folder.path() / "other.icc";
  for (const std::string& bytes : {std::string(), std::string("ICC"), std::string(200, '\xff')}) {
    std::ofstream(other, std::ios::binary | std::ios::trunc) << bytes;
    CHECK_FALSE(load_output_intent(other));
  }
}

TEST_CASE("SOURCE_DATE_EPOCH makes PDF/X the same byte by byte") {
  const TemporaryFolder folder;
  const std::filesystem::path profile = press(folder, cmsSigOutputClass, cmsSigCmykData);
  setenv("SOURCE_DATE_EPOCH", "1774958400", 1);
  const OutputIntent intent = load_output_intent(profile).value();
  unsetenv("SOURCE_DATE_EPOCH");
  CHECK(intent.date == "2026-03-31T12:00:00Z");
  const Sheet sheet = plate_sheet(true);
  const std::string pdf = render_pdf({&sheet, 1}, &intent).value();
  CHECK(pdf == render_pdf({&sheet, 1}, &intent).value());
  CHECK(has(pdf, "/CreationDate (D:20260331120000Z)"));
}
