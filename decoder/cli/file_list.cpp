// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/file_list.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <istream>
#include <iterator>

namespace tagsmith {
namespace fs = std::filesystem;
namespace {

// Print files first, so that the pictures alone are the rest.
constexpr std::array<std::string_view, 13> kExtensions{".pdf",  ".svg", ".jpg",  ".jpeg", ".png",
                                                       ".webp", ".tif", ".tiff", ".bmp",  ".pgm",
                                                       ".ppm",  ".pnm", ".jp2"};

bool has_extension(const fs::path& path, std::span<const std::string_view> extensions) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::find(extensions, extension) != extensions.end();
}

std::string joined(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : " ") + std::string(word);
  return text;
}

Result<std::vector<fs::path>> files_in(const fs::path& folder,
                                       std::span<const std::string_view> extensions) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (has_extension(entry->path(), extensions) && !entry->is_directory(ignored)) {
      files.push_back(entry->path());
    }
  }
  if (error) return fail(folder.string() + ": cannot be listed: " + error.message());
  if (files.empty()) {
    return fail(folder.string() + ": holds no file to read, expected " + joined(extensions));
  }
  std::ranges::sort(files);
  return files;
}

Result<std::vector<fs::path>> files_from(std::istream& stream) {
  std::vector<fs::path> files;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) files.emplace_back(line);
  }
  if (files.empty()) return fail("-: standard input names no file, expected one a line");
  return files;
}

}  // namespace

std::span<const std::string_view> image_extensions() { return std::span(kExtensions).subspan<2>(); }
std::span<const std::string_view> image_and_pdf_extensions() { return kExtensions; }

Result<std::vector<fs::path>> list_files(const std::vector<std::string>& arguments,
                                         std::span<const std::string_view> extensions,
                                         std::istream& standard_input) {
  std::vector<fs::path> files;
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    if (argument != "-" && !fs::is_directory(argument, ignored)) {
      files.emplace_back(argument);
      continue;
    }
    Result<std::vector<fs::path>> more =
        argument == "-" ? files_from(standard_input) : files_in(argument, extensions);
    if (!more) return fail(more.error().message);
    std::ranges::move(*more, std::back_inserter(files));
  }
  return files;
}

}  // namespace tagsmith
