// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_annotate.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "decoder/image/annotate.hpp"
#include "decoder/verify/rasterize.hpp"
#include "tagsmith/base/checksum.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kPoor = 1.5;  // grades below it are poor

std::array<std::uint8_t, 3> colour_of(const VerifiedTag& tag) {
  if (tag.status == TagStatus::cut_off) return {96, 104, 112};
  if (tag.status != TagStatus::ok) return {190, 20, 20};
  return tag.grade && tag.grade->grade < kPoor ? std::array<std::uint8_t, 3>{190, 100, 0}
                                               : std::array<std::uint8_t, 3>{10, 120, 50};
}

// The text in lines of about `most` characters, broken at blanks.
std::vector<std::string> wrapped(const std::string& text, std::size_t most) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    at = end + 1;
  }
  return lines;
}

std::vector<std::string> words_of(const VerifiedTag& tag) {
  constexpr std::size_t kLine = 46;
  constexpr std::size_t kMostLines = 4;
  std::string first = tag.tag.empty() ? std::string() : tag.tag + "  ";
  first += to_string(tag.status);
  if (tag.grade) first += "  grade " + to_string(*tag.grade);
  if (!tag.rule.empty()) first += "  " + tag.rule;
  std::vector<std::string> lines{first};
  if (tag.message.empty()) return lines;
  std::vector<std::string> more = wrapped(tag.message, kLine);
  if (more.size() > kMostLines) {
    more.resize(kMostLines);
    more.back() += " ...";
  }
  lines.insert(lines.end(), more.begin(), more.end());
  return lines;
}

}  // namespace

Result<std::optional<SheetFile>> annotated_copy(const std::filesystem::path& folder,
                                                const InputFile& file,
                                                const VerifiedFile& verified) {
  if (is_pdf(file.bytes) || is_svg(file.path)) return std::nullopt;
  std::vector<PictureMark> marks;
  for (const VerifiedTag& tag : verified.tags) {
    marks.push_back({tag.corners, colour_of(tag), words_of(tag)});
  }
  std::vector<std::string> caption{file.path.filename().string()};
  if (verified.tags.empty()) {
    caption.insert(caption.end(), verified.findings.begin(), verified.findings.end());
  }
  const Result<AnnotatedPicture> copy =
      annotate_picture(file.path.string(), file.bytes, marks, caption);
  if (!copy) return fail(copy.error().message);
  const std::string hash = sha256(file.path.string()).substr(0, 8);
  return SheetFile{
      folder / fmt::format("{}-{}{}", file.path.stem().string(), hash, copy->extension),
      copy->bytes};
}

}  // namespace tagsmith::detail
