// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/print_settings.hpp"

#include <memory>
#include <vector>

// qpdf 11: only std::shared_ptr, no PointerHolder of its own (qpdf/PointerHolder.hh asks for this).
#define POINTERHOLDER_TRANSITION 4
#include <qpdf/Buffer.hh>
#include <qpdf/JSON.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFObjectHandle.hh>
#include <qpdf/QPDFPageDocumentHelper.hh>
#include <qpdf/QPDFPageObjectHelper.hh>
#include <qpdf/QPDFTokenizer.hh>
#include <qpdf/QPDFWriter.hh>

namespace tagsmith {
namespace {

using Token = QPDFTokenizer::Token;

// Turns `0 0 0 rg` into `0 g` and `0 0 0 RG` into `0 G`, and with a contour `1 0 1 RG` into the
// spot colour. Holds back the operands until their operator is known.
class PrintColours : public QPDFObjectHandle::TokenFilter {
 public:
  explicit PrintColours(bool has_contour) : has_contour_(has_contour) {}

  void handleToken(const Token& token) override {
    const QPDFTokenizer::token_type_e type = token.getType();
    if (held_.empty() && type == QPDFTokenizer::tt_space) return writeToken(token);
    held_.push_back(token);
    if (type == QPDFTokenizer::tt_word) {
      finish_operator(token.getValue());
    } else if (type != QPDFTokenizer::tt_integer && type != QPDFTokenizer::tt_space) {
      release();
    }
  }

  void handleEOF() override { release(); }

 private:
  void finish_operator(const std::string& name) {
    const std::string operands = (name == "rg" || name == "RG") ? whole_operands() : "";
    if (operands == "0 0 0 ") {
      held_.clear();
      write(name == "rg" ? "0 g" : "0 G");
    } else if (has_contour_ && operands == "1 0 1 " && name == "RG") {
      held_.clear();
      write("/CutContour CS 1 SCN");
    } else {
      release();
    }
  }

  // The operands when all are integers, each with a blank after it.
  std::string whole_operands() const {
    std::string text;
    for (const Token& token : held_) {
      if (token.getType() == QPDFTokenizer::tt_integer) text += token.getValue() + " ";
    }
    return text;
  }

  void release() {
    for (const Token& token : held_) writeToken(token);
    held_.clear();
  }

  bool has_contour_;
  std::vector<Token> held_;
};

void set_viewer_preferences(QPDF& pdf) {
  pdf.getRoot().replaceKey("/ViewerPreferences",
                           QPDFObjectHandle::parse("<< /PrintScaling /None /Enforce "
                                                   "[ /PrintScaling ] /PickTrayByPDFSize true >>"));
}

QPDFObjectHandle box_of(const PdfRectangle& box) {
  return QPDFObjectHandle::newFromRectangle({box.left, box.bottom, box.right, box.top});
}

// A separation colour that previews as magenta (ISO 32000-2, 8.6.6.4).
void add_contour_colour(QPDFObjectHandle page) {
  QPDFObjectHandle resources = page.getKey("/Resources");
  resources.replaceKey(
      "/ColorSpace",
      QPDFObjectHandle::parse("<< /CutContour [ /Separation /CutContour /DeviceCMYK << "
                              "/FunctionType 2 /Domain [ 0 1 ] /C0 [ 0 0 0 0 ] /C1 [ 0 1 0 0 ] "
                              "/N 1 >> ] >>"));
}

void set_page(QPDFPageObjectHelper& page, const PdfPageSettings& settings) {
  QPDFObjectHandle object = page.getObjectHandle();
  object.removeKey("/Group");
  if (settings.trim) object.replaceKey("/TrimBox", box_of(*settings.trim));
  if (settings.bleed) object.replaceKey("/BleedBox", box_of(*settings.bleed));
  if (settings.has_contour) add_contour_colour(object);
  page.addContentTokenFilter(std::make_shared<PrintColours>(settings.has_contour));
}

void set_up(QPDF& pdf, const std::vector<PdfPageSettings>& settings) {
  set_viewer_preferences(pdf);
  pdf.getTrailer().getKey("/Info").removeKey("/CreationDate");
  std::size_t number = 0;
  for (QPDFPageObjectHelper& page : QPDFPageDocumentHelper(pdf).getAllPages()) {
    set_page(page, number < settings.size() ? settings[number] : PdfPageSettings{});
    ++number;
  }
}

void write_with(QPDFWriter& writer) {
  writer.setDeterministicID(true);
  writer.setMinimumPDFVersion("1.7");
  writer.write();
}

}  // namespace

Result<std::string> with_print_settings(const std::string& pdf_bytes,
                                        const std::vector<PdfPageSettings>& pages) {
  try {
    QPDF pdf;
    pdf.processMemoryFile("rendered PDF", pdf_bytes.data(), pdf_bytes.size());
    set_up(pdf, pages);
    QPDFWriter writer(pdf);
    writer.setOutputMemory();
    write_with(writer);
    const std::shared_ptr<Buffer> buffer = writer.getBufferSharedPointer();
    return std::string(reinterpret_cast<const char*>(buffer->getBuffer()), buffer->getSize());
  } catch (const std::exception& error) {
    return fail(std::string("PDF: ") + error.what());
  }
}

Result<void> add_print_settings(const std::filesystem::path& from, const std::filesystem::path& to,
                                const std::vector<PdfPageSettings>& pages) {
  try {
    QPDF pdf;
    pdf.processFile(from.c_str());
    set_up(pdf, pages);
    QPDFWriter writer(pdf, to.c_str());
    write_with(writer);
    return {};
  } catch (const std::exception& error) {
    return fail(std::string("PDF: ") + error.what());
  }
}

}  // namespace tagsmith
