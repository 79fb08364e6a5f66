// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/print_colours.hpp"

#include <array>
#include <zlib.h>

namespace tagsmith {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

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

// The last three words before an operator.
class Operands {
 public:
  void add(std::string_view word) { last_ = {last_[1], last_[2], word}; }
  void clear() { last_ = {}; }
  bool are(const char* a, const char* b, const char* c) const {
    return last_[0] == a && last_[1] == b && last_[2] == c;
  }
  const char* begin() const { return last_[0].data(); }

 private:
  std::array<std::string_view, 3> last_{};
};

// What to write for the operator and its operands; empty = what is there.
std::string_view replacement(const Operands& operands, std::string_view name, bool has_contour) {
  if (name != "rg" && name != "RG") return {};
  if (operands.are("0", "0", "0")) return name == "rg" ? "0 g" : "0 G";
  if (has_contour && name == "RG" && operands.are("1", "0", "1")) return "/CutContour CS 1 SCN";
  return {};
}

}  // namespace

std::string with_print_colours(std::string_view content, bool has_contour) {
  std::string result;
  result.reserve(content.size());
  Operands operands;
  std::size_t copied = 0;  // so much of the content is in the result
  for (std::size_t at = 0; at < content.size();) {
    if (is_blank(content[at])) {
      ++at;
      continue;
    }
    if (content[at] == '(') {
      at = end_of_text(content, at);
      operands.clear();
      continue;
    }
    const std::size_t start = at;
    while (at < content.size() && !is_blank(content[at]) && content[at] != '(') ++at;
    const std::string_view word = content.substr(start, at - start);
    const std::string_view instead = replacement(operands, word, has_contour);
    if (!instead.empty()) {
      const auto first = static_cast<std::size_t>(operands.begin() - content.data());
      result.append(content, copied, first - copied).append(instead);
      copied = at;
    }
    operands.add(word);
  }
  return result.append(content, copied);
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  compress2(reinterpret_cast<Bytef*>(result.data()), &size,
            reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED);
  result.resize(size);
  return result;
}

Result<std::string> inflated(std::string_view bytes) {
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  if (inflateInit(&stream) != Z_OK) return fail("zlib: no memory");
  std::string result;
  std::array<char, 16384> part{};
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    status = inflate(&stream, Z_NO_FLUSH);
    result.append(part.data(), part.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return status == Z_STREAM_END ? Result<std::string>(std::move(result)) : fail("zlib: no stream");
}

}  // namespace tagsmith
