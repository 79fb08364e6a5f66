// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/print_settings.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/print_colours.hpp"

namespace tagsmith {
namespace {

constexpr std::string_view kEndOfObject = "\nendobj\n";
constexpr std::string_view kStream = "\nstream\n";
constexpr std::string_view kEndOfStream = "\nendstream";

constexpr std::string_view kViewerPreferences =
    "\n   /ViewerPreferences << /PrintScaling /None /Enforce [ /PrintScaling ] "
    "/PickTrayByPDFSize true >>";

// A separation colour that previews as magenta (ISO 32000-2, 8.6.6.4).
constexpr std::string_view kContourColour =
    "\n   /ColorSpace << /CutContour [ /Separation /CutContour /DeviceCMYK << /FunctionType 2 "
    "/Domain [ 0 1 ] /C0 [ 0 0 0 0 ] /C1 [ 0 1 0 0 ] /N 1 >> ] >>";

// The number that the text begins with after blanks; 0 when it begins with none.
std::size_t leading_number(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  std::size_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

// The object that a key of the dictionary refers to: 5 in `/Length 5 0 R`; 0 without the key.
std::size_t reference(std::string_view dictionary, std::string_view key) {
  const std::size_t at = dictionary.find(key);
  return at == std::string_view::npos ? 0 : leading_number(dictionary.substr(at + key.size()));
}

// `addition` before the brackets that close the dictionary.
std::string with_entry(std::string_view dictionary, std::string_view addition) {
  const std::size_t end = dictionary.rfind("\n>>");
  return std::string(dictionary.substr(0, end)).append(addition).append("\n>>");
}

// Without the key's line.
std::string without_line(std::string_view dictionary, std::string_view key) {
  const std::size_t line = dictionary.find("\n   " + std::string(key));
  if (line == std::string_view::npos) return std::string(dictionary);
  const std::size_t end = dictionary.find('\n', line + 1);
  return std::string(dictionary.substr(0, line)).append(dictionary.substr(end));
}

// Without Cairo's transparency group, whose brackets stand at the ends of its lines.
std::string without_group(std::string page) {
  constexpr std::string_view kEnd = "\n   >>";
  const std::size_t begin = page.find("\n   /Group <<");
  if (begin == std::string::npos) return page;
  const std::size_t end = page.find(kEnd, begin);
  return end == std::string::npos ? page : page.erase(begin, end + kEnd.size() - begin);
}

std::string box_entry(std::string_view name, const PdfRectangle& box) {
  const auto number = [](double points) { return format_number(points, 5); };
  return fmt::format("\n   /{} [ {} {} {} {} ]", name, number(box.left), number(box.bottom),
                     number(box.right), number(box.top));
}

// Only content of pages has nothing but its length and its filter to say; the maps from glyphs to
// text, which say as little, have no operators of colour.
bool may_have_colours(std::string_view dictionary) {
  return std::ranges::count(dictionary, '/') == 3 &&
         dictionary.find("/Filter /FlateDecode") != std::string_view::npos;
}

}  // namespace

void PrintSettingsFilter::add_page(const PdfPageSettings& page) {
  settings_.push_back(page);
  contours_asked_ += page.has_contour ? 1 : 0;
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
    // In a stream these bytes may stand by chance.
    if (object.find(kStream) != std::string_view::npos && !object.ends_with(kEndOfStream)) continue;
    take_object(object);
    held_.erase(0, end + kEndOfObject.size());
    searched_ = 0;
  }
}

// Why: docs/decisions/0016-printing-and-printer-dots.md.
void PrintSettingsFilter::take_object(std::string_view object) {
  if (position_ == 0) put("%PDF-1.7\n%\xb5\xed\xae\xfb\n");
  while (object.starts_with('%')) object.remove_prefix(object.find('\n') + 1);
  const std::size_t number = leading_number(object);
  const std::string_view body = object.substr(object.find('\n') + 1);
  if (lengths_.erase(number) > 0) return;
  const std::size_t stream = body.find(kStream);
  if (stream != std::string_view::npos) {
    const std::size_t data = stream + kStream.size();
    return put_stream(number, body.substr(0, stream),
                      body.substr(data, body.size() - data - kEndOfStream.size()));
  }
  if (body.starts_with("<< /Type /Page ")) {
    put_object(number, with_page_settings(std::string(body)));
  } else if (body.starts_with("<< /Type /Catalog")) {
    has_catalog_ = true;
    put_object(number, with_entry(body, kViewerPreferences));
  } else if (body.starts_with("<< /Producer ")) {
    put_object(number, without_line(body, "/CreationDate "));
  } else if (body.starts_with("<<\n   /ExtGState ") && !settings_.empty() &&
             settings_.front().has_contour) {
    ++contours_made_;
    put_object(number, with_entry(body, kContourColour));
  } else {
    put_object(number, body);
  }
}

std::string PrintSettingsFilter::with_page_settings(std::string page) {
  page = without_group(std::move(page));
  if (settings_.empty()) return page;
  const PdfPageSettings settings = settings_.front();
  settings_.pop_front();
  if (settings.trim) page = with_entry(page, box_entry("TrimBox", *settings.trim));
  if (settings.bleed) page = with_entry(page, box_entry("BleedBox", *settings.bleed));
  return page;
}

void PrintSettingsFilter::put_stream(std::size_t number, std::string_view dictionary,
                                     std::string_view data) {
  std::string compressed(data);
  if (may_have_colours(dictionary)) {
    const bool has_contour = !settings_.empty() && settings_.front().has_contour;
    if (const Result<std::string> content = inflated(data)) {
      compressed = deflated(with_print_colours(*content, has_contour));
    }
  }
  const std::size_t length = reference(dictionary, "/Length ");
  const std::string refers = fmt::format("/Length {} 0 R", length);
  std::string changed(dictionary);
  if (const std::size_t at = changed.find(refers); at != std::string::npos) {
    lengths_.insert(length);
    changed.replace(at, refers.size(), fmt::format("/Length {}", compressed.size()));
  }
  put_object(number, changed.append(kStream).append(compressed).append(kEndOfStream));
}

void PrintSettingsFilter::put_object(std::size_t number, std::string_view body) {
  if (offsets_.size() <= number) offsets_.resize(number + 1, 0);
  offsets_[number] = position_;
  const std::string object = fmt::format("{} 0 obj\n{}{}", number, body, kEndOfObject);
  id_ = sha256(id_ + object);
  put(object);
}

void PrintSettingsFilter::put(std::string_view bytes) {
  written_ = written_ && sink_(bytes);
  position_ += bytes.size();
}

Result<void> PrintSettingsFilter::finish() {
  const std::size_t root = reference(held_, "/Root ");
  const std::size_t info = reference(held_, "/Info ");
  if (!held_.starts_with("xref\n") || root == 0 || info == 0 || !has_catalog_ ||
      !settings_.empty() || !lengths_.empty() || contours_made_ != contours_asked_) {
    return fail("PDF: this version of Cairo writes its files in another way than 1.16");
  }
  const std::uint64_t start = position_;
  put(fmt::format("xref\n0 {}\n0000000000 65535 f \n", offsets_.size()));
  for (std::size_t number = 1; number < offsets_.size(); ++number) {
    put(fmt::format("{:010} {} \n", offsets_[number],
                    offsets_[number] > 0 ? "00000 n" : "65535 f"));
  }
  const std::string id = id_.substr(0, 32);  // 16 bytes
  put(
      fmt::format("trailer\n<< /Size {0} /Root {1} 0 R /Info {2} 0 R /ID [ <{3}> <{3}> ] >>\n"
                  "startxref\n{4}\n%%EOF\n",
                  offsets_.size(), root, info, id, start));
  return written_ ? Result<void>{} : fail("PDF: cannot be written, is the disk full?");
}

Result<std::string> with_print_settings(std::string_view cairo_pdf) {
  std::string bytes;
  PrintSettingsFilter filter([&](std::string_view part) {
    bytes += part;
    return true;
  });
  filter.take(cairo_pdf);
  const Result<void> finished = filter.finish();
  return finished ? Result<std::string>(std::move(bytes)) : fail(finished.error().message);
}

}  // namespace tagsmith
