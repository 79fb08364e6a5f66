// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/file_list.hpp"

#include <algorithm>
#include <array>
#include <istream>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/image/heif.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

// Print files first, so that the extensions of pictures alone are the rest.
constexpr std::array<std::string_view, 15> kExtensions{".pdf",  ".svg", ".jpg", ".jpeg", ".heic",
                                                       ".heif", ".hif", ".png", ".webp", ".tif",
                                                       ".tiff", ".bmp", ".pgm", ".ppm",  ".pnm"};

// In lower case, with its dot.
std::string extension_of(const fs::path& path) { return lower_case(path.extension().string()); }

// The kind of a file that is not read; nothing for one that is read. A name without a file counts
// as one that is read: reading reports the error.
std::optional<std::string> skipped_kind(const fs::directory_entry& entry,
                                        std::span<const std::string_view> extensions) {
  std::error_code ignored;
  const fs::file_status status = entry.status(ignored);
  const std::string type = file_type(status);
  if (type != "file") return type;
  const std::string extension = extension_of(entry.path());
  if (std::ranges::find(extensions, extension) != extensions.end()) return std::nullopt;
  return extension.size() > 1 ? extension.substr(1) : "file without extension";
}

Result<void> add_files_in(const fs::path& folder, std::span<const std::string_view> extensions,
                          FileList& list) {
  std::error_code error;
  std::vector<fs::path> files;
  SkippedFiles skipped;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::optional<std::string> kind = skipped_kind(*entry, extensions);
    if (!kind) files.push_back(entry->path());
    if (kind) ++skipped[*kind];
  }
  if (error) return fail(folder.string() + ": cannot be listed: " + error.message());
  if (files.empty()) {
    return fail(fmt::format("{}: holds no file to read, expected {}{}", folder.string(),
                            fmt::join(extensions, " "),
                            skipped.empty() ? "" : "; found " + skipped_in_words(skipped)));
  }
  std::ranges::sort(files);
  std::ranges::move(files, std::back_inserter(list.files));
  for (const auto& [kind, count] : skipped) list.skipped[kind] += count;
  return {};
}

Result<std::vector<fs::path>> files_from(std::istream& stream) {
  constexpr std::size_t kLongestName = 4096;
  std::vector<fs::path> files;
  while (std::optional<std::string> line = read_line(stream, kLongestName)) {
    if (line->size() > kLongestName || line->find('\0') != std::string::npos) {
      return fail("-: standard input is no list of file names, expected one a line");
    }
    if (line->ends_with('\r')) line->pop_back();
    if (!line->empty()) files.emplace_back(*line);
  }
  if (files.empty()) return fail("-: standard input names no file, expected one a line");
  return files;
}

}  // namespace

std::span<const std::string_view> image_extensions() { return std::span(kExtensions).subspan<2>(); }
std::span<const std::string_view> image_and_pdf_extensions() { return kExtensions; }

Result<FileList> list_files(const std::vector<std::string>& arguments,
                            std::span<const std::string_view> extensions,
                            std::istream& standard_input) {
  FileList list;
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    if (argument == "-") {
      Result<std::vector<fs::path>> more = files_from(standard_input);
      if (!more) return fail(more);
      std::ranges::move(*more, std::back_inserter(list.files));
    } else if (fs::is_directory(argument, ignored)) {
      if (auto added = add_files_in(argument, extensions, list); !added) {
        return fail(added);
      }
    } else {
      list.files.emplace_back(argument);
    }
  }
  return list;
}

std::string skipped_in_words(const SkippedFiles& skipped) {
  constexpr std::array<std::string_view, 9> kVideos{"mp4", "mov",  "m4v", "avi", "mkv",
                                                    "mts", "webm", "3gp", "mpg"};
  std::string text;
  bool video = false;
  for (const auto& [kind, count] : skipped) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
    video = video || std::ranges::find(kVideos, kind) != kVideos.end();
  }
  return text + (video ? "; " + std::string(kFramesOfVideo) : "");
}

}  // namespace tagsmith::detail
