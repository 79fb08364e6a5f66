// SPDX-License-Identifier: Apache-2.0
// The result of `verify` for one file. It is a line of `verify --json` (docs/formats.md), and what
// --resume and `report` read back.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/grade/grade.hpp"
#include "decoder/image/exif.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/plates/hung_tags.hpp"
#include "decoder/reader/reading.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// Every status except `ok` and `cut_off` is a fault; what should be known and is no fault is a note
// of the file. Tags `ok` and `misplaced` also show where they hang (hanging_check.hpp), so that all
// photos together may clear what one photo found `misplaced`.
enum class TagStatus {
  ok,          // the survey has this tag
  unknown,     // a good reading of a code that the survey does not have
  misprinted,  // it reads, and print or plate is wrong: size, check digit, file, bent, upside down
  unreadable,  // a tag was found and refused
  duplicate,   // the same tag stands elsewhere in the same picture or print file
  cut_off,     // a tag at the picture's edge, not wholly in view; no fault of the tag
  misplaced,   // a tag in order that does not hang where the survey has it
  doubtful,    // a tag in order that contradicts another, or the camera: one of them is wrong
};
inline constexpr std::array kTagStatusNames{"ok",        "unknown", "misprinted", "unreadable",
                                            "duplicate", "cut_off", "misplaced",  "doubtful"};
inline constexpr std::size_t kTagStatuses = kTagStatusNames.size();

std::string to_string(TagStatus status);

// How the up of a file's pictures is known: whether its tags could be checked for hanging upside
// down.
enum class UpSource {
  unknown,  // nothing
  page,     // a print file's pages
  rig,      // a photo by a camera of a rig that stands on its wheels
  camera,   // the camera noted how it was held (EXIF)
  doubted,  // the same, but all tags of the photo are upside down by that
};

inline constexpr std::size_t kUpSources = 5;

std::string to_string(UpSource source);

// True when a tag that is upside down would have been detected.
inline bool is_up_known(UpSource source) {
  return source != UpSource::unknown && source != UpSource::doubted;
}

// What is wrong with a tag; nothing while it is `ok`.
struct Finding {
  TagStatus status = TagStatus::ok;
  std::string rule;     // of docs/verify-rules.md
  std::string message;  // what is wrong and what was expected

  // `cut_off` is no fault.
  bool is_fault() const { return status != TagStatus::ok && status != TagStatus::cut_off; }
  bool is_upside_down() const { return rule == "upside-down"; }
  // Upside down by the camera's note alone (EXIF): the tag hangs so, or the note is wrong.
  bool doubts_up() const { return status == TagStatus::doubtful && is_upside_down(); }
};

// The picture of a fault, for people: a tag and its surroundings, or a photo or page without any
// tag.
struct FaultPicture {
  std::optional<GrayImage> image{};  // until it is saved
  std::string jpeg{};                // small, for a report; empty = not available
  std::string file{};                // where it was saved; empty = nowhere
};

// One tag in one picture.
struct VerifiedTag {
  Finding finding;
  std::string tag;               // the survey's name for it; empty when it has none
  std::optional<Digits> digits;  // as read; nothing when unreadable
  FrameCorners corners{};        // pixels of the picture, or of the page as rasterised
  double module_px = 0;
  double confidence = 0;
  int page = 0;                        // 1-based page of a print file; 0 in a picture
  std::optional<SymbolGrade> grade{};  // print quality; only of a tag that is `ok`
  std::string grade_reason{};          // why such a tag has no grade
  FaultPicture picture{};
  CornerCovariance corner_covariance = CornerCovariance::Zero();  // pixels^2; zero = not estimated
  std::optional<HungTag> hung{};                                  // where it hangs, by all photos
  // Of a tag that the survey does not have: the tag in whose place it hangs, by all photos.
  std::string in_place_of{};
};

struct VerifiedFile {
  std::filesystem::path file;
  std::string sha256{};    // empty when it cannot be read
  std::string revision{};  // of the survey it was verified against
  // What the result depends on besides content and survey (verify_file.hpp); empty = nothing.
  std::string conditions{};
  int pages = 0;  // 0 for a picture
  int width = 0;  // of a photo, pixels; 0 for print files
  int height = 0;
  std::optional<int> orientation{};  // of a photo (EXIF, 1 to 8); nothing = it is not noted
  std::optional<PhotoLens> lens{};   // of a photo (EXIF)
  std::string taken{};               // when a photo was taken (date.hpp); empty = not known
  std::vector<VerifiedTag> tags{};
  std::vector<std::string> findings{};  // on the file as a whole, in words
  std::set<std::string> rules{};        // of these findings
  std::vector<std::string> mixed{};     // of these, what judge_hanging found of mixed stations
  bool stale = false;                   // printed from another state of the survey: print it again
  UpSource up = UpSource::unknown;
  std::vector<std::string> notes{};  // what should be known of the file and is no fault
  FaultPicture picture{};            // of a file without a tag

  bool is_photo() const { return width > 0; }
  // A photo in which nothing is wrong except that it shows no whole tag: in a set whose other
  // photos show tags it is a picture of the wall, in a set without any it is a finding.
  bool only_lacks_tags() const;
  void add_finding(std::string_view rule, std::string words);
};

// "unknown: 001001920601 is not in survey corridor; it hangs where 003R should, ..."
std::string in_words(const VerifiedTag& tag);

// The same without the status; empty when nothing is wrong.
std::string message_of(const VerifiedTag& tag);

// All that is wrong, in words: with the file, then with each tag. Empty = nothing is wrong.
std::vector<std::string> findings_of(const VerifiedFile& file);

// The rules of all findings.
std::set<std::string> rules_of(const VerifiedFile& file);

// The file and its content: the same in two runs.
std::string identity_of(const VerifiedFile& file);

}  // namespace tagsmith::detail
