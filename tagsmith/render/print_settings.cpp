// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/print_settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <span>
#include <zlib.h>

#include <fmt/format.h>

#include "tagsmith/base/checksum.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::string_view kEndOfObject = "\nendobj\n";
constexpr std::string_view kStream = "\nstream\n";
constexpr std::string_view kEndOfStream = "\nendstream";
constexpr std::string_view kBlanks = " \n\r\t";

constexpr std::string_view kViewerPreferences =
    "\n   /ViewerPreferences << /PrintScaling /None /Enforce [ /PrintScaling ] "
    "/PickTrayByPDFSize true >>";
// PDF/X-4 is a PDF of version 1.6, which has no more.
constexpr std::string_view kViewerPreferences16 =
    "\n   /ViewerPreferences << /PrintScaling /None >>";

// A separation colour that previews as magenta (ISO 32000-2, 8.6.6.4).
constexpr std::string_view kContourColour =
    "\n   /ColorSpace << /CutContour [ /Separation /CutContour /DeviceCMYK << /FunctionType 2 "
    "/Domain [ 0 1 ] /C0 [ 0 0 0 0 ] /C1 [ 0 1 0 0 ] /N 1 >> ] >>";

// The number that follows the key, 5 in `/Root 5 0 R`, or that begins the text; 0 when there is
// none.
std::size_t number_after(std::string_view text, std::string_view key = {}) {
  std::size_t number = 0;
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return 0;
  const std::string_view rest = text.substr(at + key.size());
  std::from_chars(rest.data(), rest.data() + rest.size(), number);
  return number;
}

// `addition` before the brackets that close the dictionary.
std::string with_entry(std::string dictionary, std::string_view addition) {
  return dictionary.insert(std::min(dictionary.rfind("\n>>"), dictionary.size()), addition);
}

// Without Cairo's transparency group, whose brackets stand at the ends of its lines.
std::string without_group(std::string page) {
  constexpr std::string_view kEnd = "\n   >>";
  const std::size_t begin = page.find("\n   /Group <<");
  const std::size_t end = page.find(kEnd, begin);
  return end == std::string::npos ? page : page.erase(begin, end + kEnd.size() - begin);
}

// Only page content has no other keys than its length and its filter; the maps from glyphs to
// characters have the same, and no operators of colour.
bool may_have_colours(std::string_view dictionary) {
  return std::ranges::count(dictionary, '/') == 3 &&
         dictionary.find("/Filter /FlateDecode") != std::string_view::npos;
}

// Position behind the string in brackets that begins at `at`.
std::size_t end_of_text(std::string_view content, std::size_t at) {
  int depth = 0;
  for (; at < content.size(); ++at) {
    if (content[at] == '\\') {
      ++at;
    } else if (content[at] == '(') {
      ++depth;
    } else if (content[at] == ')' && --depth == 0) {
      return at + 1;
    }
  }
  return content.size();
}

std::string zlib_stream_of(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  compress2(reinterpret_cast<Bytef*>(result.data()), &size,
            reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED);
  result.resize(size);
  return result;
}

// Nothing for bytes that are not whole or no such stream (RFC 1950).
std::optional<std::string> inflated(std::string_view bytes) {
  std::string result(16 * bytes.size() + 1024, '\0');
  for (;; result.resize(4 * result.size())) {
    uLongf size = result.size();
    const int status = uncompress(reinterpret_cast<Bytef*>(result.data()), &size,
                                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (status == Z_BUF_ERROR && result.size() < 1200 * bytes.size()) continue;
    if (status != Z_OK) return std::nullopt;
    result.resize(size);
    return result;
  }
}

}  // namespace

std::string with_print_colours(std::string_view content, bool has_contour) {
  using LastWords = std::array<std::string_view, 4>;
  std::string result;
  LastWords last;          // words, the newest at the end
  std::size_t copied = 0;  // so much of the content is in the result
  for (std::size_t at = 0; at < content.size();) {
    if (content[at] == '(') {
      at = end_of_text(content, at);
      last = {};
      continue;
    }
    const std::size_t end = std::min(content.find_first_of(" \n\r\t(", at), content.size());
    const std::string_view word = content.substr(at, end - at);
    at = std::min(content.find_first_not_of(kBlanks, end), content.size());
    if (word.empty()) continue;
    last = {last[1], last[2], last[3], word};
    std::string_view instead;
    if (last == LastWords{"0", "0", "0", "rg"}) instead = "0 g";
    if (last == LastWords{"0", "0", "0", "RG"}) instead = "0 G";
    if (last == LastWords{"1", "1", "1", "rg"}) instead = "1 g";
    if (last == LastWords{"1", "1", "1", "RG"}) instead = "1 G";
    if (has_contour && last == LastWords{"1", "0", "1", "RG"}) instead = "/CutContour CS 1 SCN";
    if (instead.empty()) continue;
    const auto first = static_cast<std::size_t>(last[0].data() - content.data());
    result.append(content, copied, first - copied).append(instead);
    copied = end;
  }
  return result.append(content, copied);
}

void PrintSettingsFilter::add_page(const PdfPageSettings& page) {
  settings_.push_back(page);
  contours_missing_ += page.has_contour ? 1 : 0;
}

bool PrintSettingsFilter::take(std::string_view bytes) {
  held_ += bytes;
  for (;;) {
    const std::size_t end = held_.find(kEndOfObject, searched_);
    if (end == std::string::npos) {
      searched_ = held_.size() - std::min(held_.size(), kEndOfObject.size());
      return written_;
    }
    const std::string_view object = std::string_view(held_).substr(0, end);
    searched_ = end + 1;
    // In a stream these bytes may occur by chance.
    if (object.find(kStream) != std::string_view::npos && !object.ends_with(kEndOfStream)) continue;
    take_object(object);
    held_.erase(0, end + kEndOfObject.size());
    searched_ = 0;
  }
}

// Why: docs/decisions/0016-printing.md.
void PrintSettingsFilter::take_object(std::string_view object) {
  if (position_ == 0)
    put(fmt::format("%PDF-1.{}\n%\xb5\xed\xae\xfb\n", intent_ != nullptr ? 6 : 7));
  while (object.starts_with('%')) object.remove_prefix(object.find('\n') + 1);
  const std::size_t number = number_after(object);
  std::string body(object.substr(object.find('\n') + 1));
  const PdfPageSettings page = settings_.empty() ? PdfPageSettings{} : settings_.front();
  const std::size_t stream = body.find(kStream);
  if (!new_length_.empty()) {
    body = std::exchange(new_length_, {});
  } else if (stream != std::string::npos && may_have_colours(body.substr(0, stream))) {
    const std::size_t data = stream + kStream.size();
    const std::size_t size = body.size() - data - kEndOfStream.size();
    if (const auto content = inflated(std::string_view(body).substr(data, size))) {
      const std::string compressed = zlib_stream_of(with_print_colours(*content, page.has_contour));
      new_length_ = fmt::format("   {}", compressed.size());
      body.replace(data, size, compressed);
    }
  } else if (body.starts_with("<< /Type /Page ")) {
    body = with_entry(without_group(std::move(body)), page.boxes);
    if (!settings_.empty()) settings_.pop_front();
  } else if (body.starts_with("<< /Type /Catalog")) {
    catalog_number_ = number;
    catalog_ =
        with_entry(std::move(body), intent_ != nullptr ? kViewerPreferences16 : kViewerPreferences);
    return;
  } else if (body.starts_with("<< /Producer ") && intent_ != nullptr) {
    body = with_entry(std::move(body), pdf_x_information(*intent_));
  } else if (body.starts_with("<<\n   /ExtGState ") && page.has_contour) {
    --contours_missing_;
    body = with_entry(std::move(body), kContourColour);
  }
  put_object(number, body);
}

void PrintSettingsFilter::put_object(std::size_t number, const std::string& body) {
  offsets_.resize(std::max(offsets_.size(), number + 1), 0);
  offsets_[number] = position_;
  const std::string whole = fmt::format("{} 0 obj\n{}{}", number, body, kEndOfObject);
  id_ = sha256(id_ + whole);
  put(whole);
}

void PrintSettingsFilter::put_pdf_x() {
  const std::size_t profile = std::max(offsets_.size(), catalog_number_ + 1);
  put_object(profile, pdf_x_profile(*intent_));
  const std::string metadata = pdf_x_metadata(*intent_, description_, id_.substr(0, 32));
  put_object(profile + 1, fmt::format("<< /Type /Metadata /Subtype /XML /Length {} >>\nstream\n{}"
                                      "\nendstream",
                                      metadata.size(), metadata));
  catalog_ = with_entry(std::move(catalog_), pdf_x_catalog(*intent_, profile, profile + 1));
}

void PrintSettingsFilter::put(std::string_view bytes) {
  written_ = written_ && sink_(bytes);
  position_ += bytes.size();
}

Result<void> PrintSettingsFilter::finish() {
  const std::size_t root = number_after(held_, "/Root ");
  const std::size_t info = number_after(held_, "/Info ");
  if (!held_.starts_with("xref\n") || root == 0 || info == 0 || catalog_.empty() ||
      !settings_.empty() || !new_length_.empty() || contours_missing_ != 0) {
    return fail("PDF: this version of Cairo writes its files in another way than 1.16");
  }
  if (intent_ != nullptr) put_pdf_x();
  put_object(catalog_number_, catalog_);
  const std::uint64_t start = position_;
  put(fmt::format("xref\n0 {}\n0000000000 65535 f \n", offsets_.size()));
  for (const std::uint64_t offset : std::span(offsets_).subspan(1)) {
    put(fmt::format("{:010} {} \n", offset, offset > 0 ? "00000 n" : "65535 f"));
  }
  const std::string id = id_.substr(0, 32);  // 16 bytes
  put(
      fmt::format("trailer\n<< /Size {0} /Root {1} 0 R /Info {2} 0 R /ID [ <{3}> <{3}> ] >>\n"
                  "startxref\n{4}\n%%EOF\n",
                  offsets_.size(), root, info, id, start));
  return written_ ? Result<void>{} : fail("PDF: cannot be written, is the disk full?");
}

}  // namespace tagsmith::detail
