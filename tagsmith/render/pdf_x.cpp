// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/pdf_x.hpp"

#include <array>
#include <cairo.h>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <lcms2.h>
#include <memory>
#include <string_view>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

struct CloseProfile {
  void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, CloseProfile>;

// Plain letters only: the text also stands in a PDF string.
std::string description_of(cmsHPROFILE profile) {
  std::array<char, 256> text{};
  cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text.data(), text.size() - 1);
  std::string plain;
  for (const char letter : std::string_view(text.data())) {
    const bool is_plain = letter >= ' ' && letter <= '~';
    if (is_plain && std::string_view("()\\<>&").find(letter) == std::string_view::npos) {
      plain += letter;
    }
  }
  return plain.empty() ? "Custom" : plain;
}

std::string date_now() {
  std::time_t time = std::time(nullptr);
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH"); fixed != nullptr) {
    std::from_chars(fixed, fixed + std::strlen(fixed), time);
  }
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

std::string uuid_of(const std::string& id) {
  return fmt::format("uuid:{}-{}-{}-{}-{}", id.substr(0, 8), id.substr(8, 4), id.substr(12, 4),
                     id.substr(16, 4), id.substr(20, 12));
}

std::string in_language(const char* name, const std::string& text) {
  if (text.empty()) return "";
  return fmt::format(
      "<dc:{0}><rdf:Alt><rdf:li xml:lang=\"x-default\">{1}</rdf:li></rdf:Alt></dc:{0}>\n", name,
      markup_text(printable_text(text)));
}

}  // namespace

Result<OutputIntent> load_output_intent(const std::filesystem::path& file) {
  constexpr std::size_t kMostBytes = 10'000'000;
  const Result<std::string> bytes = read_file(file);
  if (!bytes) return fail(bytes);
  if (bytes->size() > kMostBytes) {
    return fail(file.string() + ": has more than 10 MB, expected an ICC profile");
  }
  cmsSetLogErrorHandler([](cmsContext, cmsUInt32Number, const char*) {});
  const Profile profile(
      cmsOpenProfileFromMem(bytes->data(), static_cast<cmsUInt32Number>(bytes->size())));
  if (profile == nullptr) return fail(file.string() + ": is no ICC profile");
  const cmsColorSpaceSignature inks = cmsGetColorSpace(profile.get());
  const bool has_process = inks == cmsSigCmykData;
  if (cmsGetDeviceClass(profile.get()) != cmsSigOutputClass ||
      (!has_process && inks != cmsSigGrayData)) {
    return fail(file.string() +
                ": is no profile of a press with black ink, or with cyan, magenta, yellow and "
                "black; ask the print shop for the profile of its press and paper");
  }
  return OutputIntent{*bytes, description_of(profile.get()), has_process, date_now()};
}

std::string pdf_x_metadata(const OutputIntent& intent, const PdfDescription& description,
                           const std::string& id) {
  const std::string keywords = description.keywords.empty()
                                   ? ""
                                   : fmt::format("<pdf:Keywords>{}</pdf:Keywords>\n",
                                                 markup_text(printable_text(description.keywords)));
  return fmt::format(
      "<?xpacket begin=\"\xef\xbb\xbf\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n"
      "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n"
      "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
      "<rdf:Description rdf:about=\"\" xmlns:dc=\"http://purl.org/dc/elements/1.1/\" "
      "xmlns:pdf=\"http://ns.adobe.com/pdf/1.3/\" "
      "xmlns:pdfxid=\"http://www.npes.org/pdfx/ns/id/\" "
      "xmlns:xmp=\"http://ns.adobe.com/xap/1.0/\" "
      "xmlns:xmpMM=\"http://ns.adobe.com/xap/1.0/mm/\">\n"
      "<dc:format>application/pdf</dc:format>\n{0}{1}{2}"
      "<pdf:Producer>cairo {3} (https://cairographics.org)</pdf:Producer>\n"
      "<pdf:Trapped>False</pdf:Trapped>\n"
      "<pdfxid:GTS_PDFXVersion>PDF/X-4</pdfxid:GTS_PDFXVersion>\n"
      "<xmp:CreatorTool>tagsmith</xmp:CreatorTool>\n"
      "<xmp:CreateDate>{4}</xmp:CreateDate>\n<xmp:ModifyDate>{4}</xmp:ModifyDate>\n"
      "<xmp:MetadataDate>{4}</xmp:MetadataDate>\n"
      "<xmpMM:DocumentID>{5}</xmpMM:DocumentID>\n<xmpMM:VersionID>1</xmpMM:VersionID>\n"
      "<xmpMM:RenditionClass>default</xmpMM:RenditionClass>\n"
      "</rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>\n<?xpacket end=\"w\"?>",
      in_language("title", description.title), in_language("description", description.subject),
      keywords, cairo_version_string(), intent.date, uuid_of(id));
}

std::string pdf_x_information(const OutputIntent& intent) {
  std::string digits;
  for (const char letter : intent.date) {
    if (letter >= '0' && letter <= '9') digits += letter;
  }
  return fmt::format(
      "\n   /Trapped /False /GTS_PDFXVersion (PDF/X-4) /CreationDate (D:{0}Z) /ModDate (D:{0}Z)",
      digits);
}

std::string pdf_x_catalog(const OutputIntent& intent, std::size_t profile, std::size_t metadata) {
  return fmt::format(
      "\n   /Metadata {} 0 R\n   /OutputIntents [ << /Type /OutputIntent /S /GTS_PDFX "
      "/OutputConditionIdentifier (Custom) /Info ({}) /DestOutputProfile {} 0 R >> ]",
      metadata, intent.condition, profile);
}

std::string pdf_x_profile(const OutputIntent& intent) {
  return fmt::format("<< /N {} /Length {} >>\nstream\n{}\nendstream", intent.has_process ? 4 : 1,
                     intent.profile.size(), intent.profile);
}

}  // namespace tagsmith::detail
