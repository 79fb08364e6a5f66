// SPDX-License-Identifier: Apache-2.0
// What a check of pictures against a survey finds.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/grade/symbol_grade.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/verify/hung_tags.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith {

enum class TagStatus {
  ok,          // the survey has this tag
  unknown,     // a good reading of a code that the survey does not have
  misprinted,  // the print is wrong: check digit, content other than the manifest says, size
  unreadable,  // a tag was found and refused
  duplicate,   // the same tag stands elsewhere in the same picture or print file
  cut_off,     // a tag at the picture's edge, not wholly in view; no fault of the tag
  misplaced,   // a tag in order that does not hang where the survey has it
  doubtful,    // a tag in order that contradicts another, or the camera: one of them is wrong
};

std::string to_string(TagStatus status);

// What tells which way is up in a file's pictures: whether its tags were checked for standing on
// their head.
enum class UpSource {
  unknown,  // nothing
  page,     // a print file's pages
  rig,      // a photo by a camera of a rig that stands on its wheels
  camera,   // the camera noted how it was held (EXIF)
  doubted,  // so it did, but all tags of the photo stand on their head by that
};

std::string to_string(UpSource source);

// True when a tag on its head would have been told.
inline bool tells_up(UpSource source) {
  return source != UpSource::unknown && source != UpSource::doubted;
}

// What the message of an unreadable tag begins with.
inline constexpr std::string_view kUnread = "a tag was found and could not be read: ";

// One tag in one picture.
struct TagFinding {
  TagStatus status = TagStatus::ok;
  std::string tag;               // the survey's name for it; empty when it has none
  std::optional<Digits> digits;  // as read; nothing when unreadable
  FrameCorners corners{};        // pixels of the picture, or of the page as rasterised
  double module_px = 0;
  double confidence = 0;
  int page = 0;                              // 1-based page of a print file; 0 in a picture
  std::string message;                       // what is wrong and what was expected; empty when ok
  std::string rule{};                        // of docs/verify-rules.md; empty when ok
  std::optional<RejectionReason> refused{};  // why the reader refused it
  std::optional<SymbolGrade> grade{};        // print quality; only of a tag that reads as it should
  std::string grade_reason{};                // why such a tag has no grade
  std::optional<GrayImage> crop{};           // the tag and its surroundings, when asked for
  std::string crop_file{};                   // where it was saved
  CornerCovariance corner_covariance = CornerCovariance::Zero();  // pixels^2; zero = not estimated
  std::optional<HungTag> hung{};  // where it hangs; with a calibrated camera
};

// One file.
struct FileReport {
  std::filesystem::path file;
  int pages = 0;  // 0 for a picture
  int width = 0;  // of a photo, pixels; 0 for print files
  int height = 0;
  std::optional<int> orientation{};  // of a photo (EXIF, 1 to 8); nothing = it is not noted
  std::vector<TagFinding> tags;
  std::string sha256{};               // of the file; empty when it cannot be read
  std::string revision{};             // of the survey it was verified against
  std::vector<std::string> findings;  // whatever is wrong, in words; empty = all well
  std::set<std::string> rules{};      // that the findings are of (docs/verify-rules.md)
  bool stale = false;                 // printed from another state of the survey: print it again
  UpSource up = UpSource::unknown;
  std::vector<std::string> notes{};  // what should be known of the file and is no fault
  // The photo, or the first page, in which no tag was found, small and upright; when asked for.
  std::optional<GrayImage> picture{};
  std::string picture_file{};  // where it was saved
};

// All files together.
struct VerifySummary {
  int files = 0;
  int files_with_findings = 0;
  int ok = 0;  // tags by status, over all files
  int unknown = 0;
  int misprinted = 0;
  int unreadable = 0;
  int duplicate = 0;
  int cut_off = 0;
  int misplaced = 0;
  int doubtful = 0;
  std::vector<std::string> stale;    // print files to print again
  std::vector<std::string> missing;  // names of the survey's tags that no file shows in order
};

}  // namespace tagsmith
