// SPDX-License-Identifier: Apache-2.0
// The results of many verified files combined, tag by tag.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "decoder/verify/verified_file.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// What all files say about one tag.
struct TagRecord {
  std::size_t seen = 0;  // times it was in order
  std::size_t faults = 0;
  std::size_t doubts = 0;      // of these, times it or another hangs wrong, or the camera did
  std::size_t photos = 0;      // of these, times in a photo
  std::size_t upright = 0;     // and of these, times that one upside down would have been detected
  std::size_t placed = 0;      // times it was judged for where it hangs
  std::optional<double> best;  // grades
  std::optional<double> worst;
  std::string blame;  // of the worst
};

struct FaultRecord {
  std::string file;
  std::string tag;  // empty when it has no name, or the whole file is meant
  std::string rule;
  std::string message;
  FaultPicture picture{};
  std::string no_picture{};  // why it is not available
  bool is_question = false;  // whether it is a fault depends on an up that is in doubt
  bool shows_whole = false;  // its picture is that of a whole photo or page
  // For a photo, where in it the fault is: a picture can be cut out from there.
  std::string sha256{};
  int orientation = 1;
  std::optional<FrameCorners> corners{};
  std::string code{};  // the digits as read, or empty
};

// A note on a file.
struct NoteRecord {
  std::string file;
  std::string note;
};

// By the up that cameras noted in their photos (EXIF): upright tags, and upside-down ones in photos
// without an upright one.
struct NotedUp {
  std::size_t upright = 0;
  std::size_t on_head = 0;
};

struct VerifyMerge {
  std::size_t files = 0;
  std::size_t repeated = 0;         // verified in more than one run, and counted once;
                                    // what any of the runs found wrong is listed
  std::size_t other_revisions = 0;  // verified against another state of the survey
  // Of all files, repeated ones too.
  std::size_t files_with_findings = 0;
  std::array<std::size_t, kTagStatuses> by_status{};
  std::vector<std::string> stale;  // print files to print again
  std::map<std::string, TagRecord> tags;
  std::vector<FaultRecord> faults;
  std::size_t fault_count = 0;
  std::vector<FaultRecord> without_tag;  // photos that only lack tags; see finish()
  std::size_t without_tag_count = 0;
  bool shows_tag = false;               // some photo does
  std::map<std::string, HungTag> hung;  // where tags hang that were judged, by name
  // Sentences that a reader of where tags hang must know: what was not judged, and what is assumed.
  std::vector<std::string> hanging_remarks;
  std::size_t picture_bytes = 0;
  std::size_t whole_bytes = 0;  // of these, of whole photos and pages
  std::vector<NoteRecord> notes;
  std::size_t note_count = 0;
  NotedUp noted_up;
  std::size_t own_tags = 0;                 // seen, whatever is wrong with them
  std::set<std::string> other_codes;        // of tags that are none of the survey's, read well
  std::unordered_set<std::uint64_t> known;  // of file and content
};

// Adds what was found in one file, verified against the survey of this revision.
void merge(const std::string& revision, VerifiedFile file, VerifyMerge& merged);

// The survey's tags on a wall, along the drive.
std::vector<const PlacedTag*> tags_along(const Survey& survey, Side side);

// The survey's tags that no file shows in order, apart from doubts.
std::vector<std::string> missing_tags(const Survey& survey, const VerifyMerge& merged);

// Whether the report has space for one more picture of such a fault, of so many bytes.
bool has_room(const VerifyMerge& merged, const FaultRecord& fault, std::size_t bytes);

// Gives the fault its picture if there is space for it; else the fault says that there is none.
void take_picture(std::string jpeg, FaultRecord& fault, VerifyMerge& merged);

// When all files are merged: photos without a tag are faults where no photo shows any, else notes
// on the set. Puts the faults in one order, by file, tag, rule and words, and the notes, whatever
// order the files came in.
void finish(VerifyMerge& merged);

// "3 photos show no tag: 1.jpg, 2.jpg, 7.jpg"; nothing where every photo does, or where that is a
// fault.
std::string without_tag_in_words(const VerifyMerge& merged);

// The listed faults, one a plate and rule: what several photos show of one plate, or of one code
// that the survey does not have, is one fault with the picture that is available, whose `file`
// names all photos and whose message is the first.
std::vector<FaultRecord> faults_by_plate(const VerifyMerge& merged);

TagRecord record_of(const VerifyMerge& merged, const std::string& tag);

// "unseen", "faulty", "poor" (worst grade below 1.5) or "ok".
std::string status_of(const TagRecord& record);

// Whether a tag was seen in a photo in which an upside-down one would have been detected:
// "checked", "unchecked", or nothing for a tag that was never in order in a photo.
std::string upright_of(const TagRecord& record);

// Whether a tag that was seen in photos was judged for where it hangs: "checked", "unchecked", or
// nothing for a tag that was not.
std::string placement_of(const TagRecord& record);

// What all files together say of the cameras' notes on their up, when some photo doubts it;
// otherwise nothing.
std::string noted_up_in_words(const NotedUp& noted);

// A run of neighbouring tags of one wall that no file shows.
struct UnseenStretch {
  Side side = Side::left;
  double from = 0;  // chainage of the first tag and of the last
  double to = 0;
  std::vector<std::string> tags;
};

// How much of the survey the files cover.
struct Completeness {
  std::size_t tags = 0;
  std::size_t seen = 0;  // in order or faulty
  std::size_t left_tags = 0;
  std::size_t left_seen = 0;
  std::size_t ok = 0;  // by status
  std::size_t poor = 0;
  std::size_t faulty = 0;
  std::size_t photographed = 0;                  // seen in order in a photo
  std::vector<std::string> upright_unchecked;    // of these, those never in one whose up is known
  std::size_t placement_checked = 0;             // judged for where they hang
  std::vector<std::string> placement_unchecked;  // seen in order in a photo and not judged
  std::vector<UnseenStretch> unseen;             // along the drive, the left wall first
  std::string another_drive;                     // why it is another drive's, in words, or empty

  double share() const {
    return tags == 0 ? 1 : static_cast<double>(seen) / static_cast<double>(tags);
  }
};

Completeness completeness_of(const Survey& survey, const VerifyMerge& merged);

// Whether tags in photos were judged for where they hang: "checked", "partly" or "not_checked".
std::string placement_checked(const Completeness& covered);

// What must be known first, in words: that the photos are of another drive; and what was not
// checked: where tags hang, and whether they hang upside down.
std::vector<std::string> unchecked_words(const Completeness& covered, const VerifyMerge& merged);

// "left 12.40 to 18.20 m: 3 tags, 004L to 006L".
std::string describe(const UnseenStretch& stretch);

}  // namespace tagsmith::detail
