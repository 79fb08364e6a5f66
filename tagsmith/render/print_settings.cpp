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

// Turns `0 0 0 rg` into `0 g` and `0 0 0 RG` into `0 G`. Holds back the operands until their
// operator is known.
class BlackAsGray : public QPDFObjectHandle::TokenFilter {
 public:
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
    if ((name == "rg" || name == "RG") && operands_are_zero()) {
      held_.clear();
      write(name == "rg" ? "0 g" : "0 G");
    } else {
      release();
    }
  }

  bool operands_are_zero() const {
    int zeros = 0;
    for (const Token& token : held_) {
      if (token.getType() != QPDFTokenizer::tt_integer) continue;
      if (token.getValue() != "0") return false;
      ++zeros;
    }
    return zeros == 3;
  }

  void release() {
    for (const Token& token : held_) writeToken(token);
    held_.clear();
  }

  std::vector<Token> held_;
};

void set_viewer_preferences(QPDF& pdf) {
  pdf.getRoot().replaceKey("/ViewerPreferences",
                           QPDFObjectHandle::parse("<< /PrintScaling /None /Enforce "
                                                   "[ /PrintScaling ] /PickTrayByPDFSize true >>"));
}

void clean_pages(QPDF& pdf) {
  for (QPDFPageObjectHelper& page : QPDFPageDocumentHelper(pdf).getAllPages()) {
    page.getObjectHandle().removeKey("/Group");
    page.addContentTokenFilter(std::make_shared<BlackAsGray>());
  }
}

std::string written(QPDF& pdf) {
  QPDFWriter writer(pdf);
  writer.setOutputMemory();
  writer.setDeterministicID(true);
  writer.setMinimumPDFVersion("1.7");
  writer.write();
  const std::shared_ptr<Buffer> buffer = writer.getBufferSharedPointer();
  return {reinterpret_cast<const char*>(buffer->getBuffer()), buffer->getSize()};
}

}  // namespace

Result<std::string> with_print_settings(const std::string& pdf_bytes) {
  try {
    QPDF pdf;
    pdf.processMemoryFile("rendered PDF", pdf_bytes.data(), pdf_bytes.size());
    set_viewer_preferences(pdf);
    pdf.getTrailer().getKey("/Info").removeKey("/CreationDate");
    clean_pages(pdf);
    return written(pdf);
  } catch (const std::exception& error) {
    return fail(std::string("PDF: ") + error.what());
  }
}

}  // namespace tagsmith
