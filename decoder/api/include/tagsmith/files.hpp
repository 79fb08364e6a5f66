// SPDX-License-Identifier: Apache-2.0
// Files: surveys, rigs, pictures, prints. The component `files`; all other headers are of `core`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tagsmith/error.hpp>
#include <tagsmith/export.hpp>
#include <tagsmith/image.hpp>
#include <tagsmith/read.hpp>
#include <tagsmith/rig.hpp>
#include <tagsmith/survey.hpp>

namespace tagsmith {

// A survey or a rig (YAML, docs/formats.md). Fails with ErrorCode::file_missing, unreadable_file or
// invalid_file, whose message lists all errors, each as file:line:column: error: what is wrong.
TAGSMITH_EXPORT Survey load_survey(const std::filesystem::path& path);
TAGSMITH_EXPORT Rig load_rig(const std::filesystem::path& path);

// A picture that owns its samples.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;  // row by row without padding
  std::string warning;                // damage that the decoder repaired; empty = none

  ImageView view() const { return {samples.data(), width, height, width}; }
};

// A picture (JPEG, PNG, TIFF, HEIC and others) as grey samples as stored. Fails with
// ErrorCode::file_missing, or unreadable_file when it is no picture, is truncated or has more than
// 200 million pixels.
TAGSMITH_EXPORT Image load_image(const std::filesystem::path& path);

enum class Severity { error, warning };

// A fault or an improbable value in a file that people write.
struct FileFinding {
  std::string rule;  // docs/rules.md
  Severity severity = Severity::error;
  std::string file;
  int line = 0;         // from 1; 0 = the whole file
  int column = 0;       // from 1; 0 = the whole line
  std::string message;  // what was found and what is expected
  std::string remedy;   // may be empty
};

// All findings on a survey, rig or template, which are distinguished by their first key; none =
// nothing is wrong. Fails with ErrorCode::file_missing or unreadable_file.
TAGSMITH_EXPORT std::vector<FileFinding> validate(const std::filesystem::path& path);

enum class TagStatus {
  ok,
  unknown,     // a good reading of a code that the survey does not have
  misprinted,  // it reads, and print or plate is wrong: check digit, size, content, bent, turned
  unreadable,  // found and refused
  duplicate,   // a second time in the same picture or print file
  cut_off,     // at the picture's edge; no fault of the tag
  misplaced,   // hangs elsewhere than surveyed
  doubtful,    // contradicts another tag
};

// "ok" and so on.
TAGSMITH_EXPORT const char* to_string(TagStatus status) noexcept;

struct VerifiedTag {
  std::string tag;     // the survey's name for it; empty when it has none
  std::string digits;  // empty when unreadable
  TagStatus status = TagStatus::ok;
  std::string rule;             // docs/verify-rules.md; empty when nothing is wrong
  std::string message;          // what is wrong and what was expected
  Corners corners{};            // pixels of the picture, or of the page as rasterised
  int page = 0;                 // of a print file, from 1; 0 in a picture
  std::optional<double> grade;  // print quality, 4 to 0
};

struct VerifiedFile {
  std::string file;
  std::vector<VerifiedTag> tags;
  std::vector<std::string> findings;  // on the file as a whole
  std::vector<std::string> notes;     // what is no fault
  bool readable = true;               // false: the only finding says why not
  bool stale = false;                 // printed from another state of the survey

  // Whether nothing is wrong with the file and its tags.
  TAGSMITH_EXPORT bool is_ok() const;
};

struct VerifyOptions {
  std::vector<Survey> also;        // other surveys, whose tags do not belong here
  std::optional<double> scan_dpi;  // pictures are flat scans of so many dots an inch, not photos
  int jobs = 0;                    // files at once; 0 = all cores
};

// Verifies photos and print files (PDF, SVG, PNG with their manifest) against the survey that they
// should show, in the order of the paths. A file that cannot be read is a finding, not a failure.
// Fails with ErrorCode::invalid_argument on options out of their range, and on other surveys that
// share a name or a code with this one or have plates of other colours.
TAGSMITH_EXPORT std::vector<VerifiedFile> verify(const Survey& survey,
                                                 const std::vector<std::filesystem::path>& paths,
                                                 const VerifyOptions& options = {});

// Writes the page of one tag at true scale, as `tagsmith print` makes it; .pdf, .svg or .png, as
// the path's extension says. The file appears whole or not at all. Fails with
// ErrorCode::invalid_argument when the survey has no such tag or the extension is another one, with
// ErrorCode::unwritable_file when the file cannot be written.
TAGSMITH_EXPORT void print_tag(const Survey& survey, const std::string& tag,
                               const std::filesystem::path& path);

}  // namespace tagsmith
