// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_merge.hpp"

#include <algorithm>
#include <functional>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/localize/other_drive.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

// Faults that are listed; all are counted.
constexpr std::size_t kMostListedFaults = 20'000;

// Notes that are listed.
constexpr std::size_t kMostListedNotes = 1'000;

// Bytes of the faults' pictures that a report holds; and of those of whole photos and pages, so
// that many photos without a tag leave space for the pictures of tags.
constexpr std::size_t kMostPictureBytes = 12U << 20U;
constexpr std::size_t kMostWholeBytes = 4U << 20U;

void add_fault(VerifyMerge& merged, FaultRecord fault) {
  ++merged.fault_count;
  if (merged.faults.size() >= kMostListedFaults) return;
  if (std::string jpeg = std::exchange(fault.picture.jpeg, {}); !jpeg.empty()) {
    take_picture(std::move(jpeg), fault, merged);
  }
  merged.faults.push_back(std::move(fault));
}

// The corners begin anywhere: where the fault is in the photo, not how it stands.
FaultRecord fault_of(const VerifiedFile& file, VerifiedTag& tag) {
  FaultRecord fault{file.file.string(), tag.tag, tag.finding.rule, message_of(tag),
                    std::move(tag.picture)};
  fault.sha256 = file.sha256;
  fault.orientation = file.orientation.value_or(1);
  if (file.is_photo()) fault.corners = tag.corners;
  if (tag.digits) fault.code = to_string(*tag.digits);
  fault.is_question = tag.finding.doubts_up();
  return fault;
}

// Of what is wrong with a whole file, whose photo is the fault's picture.
FaultRecord fault_of(const VerifiedFile& file, const std::string& rule) {
  FaultRecord fault{file.file.string(), "", rule, fmt::format("{}", fmt::join(file.findings, "; ")),
                    file.picture};
  const bool is_known = file.is_photo() && !file.sha256.empty();
  fault.shows_whole = is_known || !file.picture.file.empty() || !file.picture.jpeg.empty();
  if (is_known) fault.sha256 = file.sha256;
  fault.orientation = file.orientation.value_or(1);
  return fault;
}

void count_noted_up(NotedUp& noted, UpSource up, const VerifiedTag& tag) {
  const bool in_order = tag.finding.status == TagStatus::ok;
  if (up == UpSource::camera && in_order) ++noted.upright;
  if (up == UpSource::doubted && (in_order || tag.finding.is_upside_down())) ++noted.on_head;
}

void add_grade(TagRecord& record, const SymbolGrade& grade) {
  const std::string blame = grade.grade < 4 ? to_string(grade.worst) : "";
  record.best = std::max(record.best.value_or(0), grade.grade);
  // Of equal grades the first blame by letters, so that the files' order does not matter.
  if (record.worst && std::tie(*record.worst, record.blame) <= std::tie(grade.grade, blame)) return;
  record.worst = grade.grade;
  record.blame = blame;
}

// Of several runs' judgements of a tag that by most places of the cameras, whatever order they come
// in.
void add_hung(const std::string& name, const HungTag& hung, VerifyMerge& merged) {
  const auto rank = [](const HungTag& tag) {
    return std::tuple(tag.stations, static_cast<int>(tag.verdict), tag.odds, tag.offset.value.x(),
                      tag.offset.value.y(), tag.offset.value.z());
  };
  const auto [known, is_new] = merged.hung.try_emplace(name, hung);
  if (!is_new && rank(known->second) < rank(hung)) known->second = hung;
}

void add_faulty(const VerifiedFile& file, VerifiedTag& tag, VerifyMerge& merged) {
  if (!tag.tag.empty()) {
    TagRecord& record = merged.tags[tag.tag];
    ++record.faults;
    record.doubts += tag.finding.status == TagStatus::doubtful ? 1 : 0;
  }
  add_fault(merged, fault_of(file, tag));
}

void add_tag(const VerifiedFile& file, VerifiedTag& tag, VerifyMerge& merged) {
  if (tag.finding.status == TagStatus::cut_off) return;
  merged.shows_tag = merged.shows_tag || file.is_photo();
  if (tag.hung && tag.hung->verdict != HangVerdict::unchecked) add_hung(tag.tag, *tag.hung, merged);
  count_noted_up(merged.noted_up, file.up, tag);
  const bool in_order = tag.finding.status == TagStatus::ok;
  if (!tag.tag.empty()) ++merged.own_tags;
  if (tag.finding.status == TagStatus::unknown && tag.tag.empty() && tag.digits) {
    merged.other_codes.insert(to_string(*tag.digits));
  }
  if (in_order || !tag.tag.empty()) {
    TagRecord& record = merged.tags[tag.tag];
    record.seen += in_order ? 1 : 0;
    record.placed += tag.hung && tag.hung->verdict != HangVerdict::unchecked ? 1 : 0;
    if (in_order && file.is_photo()) {
      const bool fits = tag.hung && tag.hung->verdict == HangVerdict::fits;
      ++record.photos;
      record.upright += is_up_known(file.up) || fits ? 1 : 0;
    }
    if (in_order && tag.grade) add_grade(record, *tag.grade);
  }
  if (!in_order) add_faulty(file, tag, merged);
}

std::uint64_t fault_hash(const std::string& identity, const std::string& words) {
  return std::hash<std::string>{}(identity + "\n" + words);
}

void know_faults(const std::string& identity, const VerifiedFile& file, VerifyMerge& merged) {
  for (const VerifiedTag& tag : file.tags) {
    if (tag.finding.is_fault())
      merged.known.insert(fault_hash(identity, tag.tag + tag.finding.rule));
  }
  for (const std::string& rule : file.rules) merged.known.insert(fault_hash(identity, rule));
}

// What another run did not find in the same file, as one that was given the rig or the resolution
// finds more. Such a file is counted once, but nothing that was found is lost.
void add_new_faults(const std::string& identity, VerifiedFile& file, VerifyMerge& merged) {
  const auto is_new = [&](const std::string& words) {
    return merged.known.insert(fault_hash(identity, words)).second;
  };
  std::set<std::string> rules = file.rules;
  for (VerifiedTag& tag : file.tags) {
    if (!tag.finding.is_fault()) continue;
    rules.erase(tag.finding.rule);
    if (is_new(tag.tag + tag.finding.rule)) add_faulty(file, tag, merged);
  }
  if (file.only_lacks_tags()) return;
  for (const std::string& rule : rules) {
    if (is_new(rule)) add_fault(merged, fault_of(file, rule));
  }
}

void add_unseen(const Survey& survey, const VerifyMerge& merged, Side side,
                std::vector<UnseenStretch>& stretches) {
  bool goes_on = false;
  for (const PlacedTag* tag : tags_along(survey, side)) {
    const bool unseen = status_of(record_of(merged, tag->name)) == "unseen";
    if (unseen && !goes_on) stretches.push_back({side, tag->chainage, tag->chainage, {}});
    goes_on = unseen;
    if (!unseen) continue;
    stretches.back().to = tag->chainage;
    stretches.back().tags.push_back(tag->name);
  }
}

// The first of the names, with dots where they are fewer than `count`.
std::string first_names(std::vector<std::string> names, std::size_t count) {
  constexpr std::size_t kMostNamed = 8;
  names.resize(std::min(names.size(), kMostNamed));
  return fmt::format("{}{}", fmt::join(names, ", "), count > names.size() ? ", ..." : "");
}

// What was not judged for where it hangs; nothing when all was, or nothing photographed.
std::string placement_in_words(const Completeness& covered) {
  const std::size_t count = covered.placement_unchecked.size();
  if (count == 0) return {};
  if (covered.placement_checked == 0) {
    return "Placement not checked: whether the tags in the photos hang where the survey has them, "
           "or were exchanged, is not known. That takes photos of two tags or more by a camera "
           "that names its lens (EXIF, as phones do), or of both walls by a rig that is given as "
           "its cameras are mounted";
  }
  return fmt::format(
      "Placement not checked of {} of {} tags in the photos: never seen together with tags that "
      "judge them: {}",
      count, count + covered.placement_checked, fmt::join(covered.placement_unchecked, " "));
}

// What was left unchecked because up is not known, for who takes the photos; nothing when all was
// checked.
std::string up_in_words(const Completeness& covered) {
  if (covered.upright_unchecked.empty()) return {};
  const std::size_t count = covered.upright_unchecked.size();
  const std::string which = count == covered.photographed
                                ? "No tag in the photos was"
                                : fmt::format("{} of {} tags in the photos {} not", count,
                                              covered.photographed, count == 1 ? "was" : "were");
  return which +
         " checked for hanging upside down: the photos do not say which way is up. Look where the "
         "arrows point, use a camera that notes how it was held (phones do), or give the rig that "
         "took them";
}

}  // namespace

void merge(const std::string& revision, VerifiedFile file, VerifyMerge& merged) {
  const bool only_lacks_tags = file.only_lacks_tags();
  if (!only_lacks_tags && !findings_of(file).empty()) ++merged.files_with_findings;
  if (file.stale) merged.stale.push_back(file.file.string());
  for (const VerifiedTag& tag : file.tags) {
    ++merged.by_status[static_cast<std::size_t>(tag.finding.status)];
  }
  const std::string identity = identity_of(file);
  const bool is_new = merged.known.insert(std::hash<std::string>{}(identity)).second;
  if (!is_new) {
    ++merged.repeated;
    add_new_faults(identity, file, merged);
    return;
  }
  know_faults(identity, file, merged);
  ++merged.files;
  if (!file.revision.empty() && file.revision != revision) ++merged.other_revisions;
  for (const std::string& note : file.notes) {
    ++merged.note_count;
    if (merged.notes.size() < kMostListedNotes) merged.notes.push_back({file.file.string(), note});
  }
  std::set<std::string> rules = file.rules;
  for (VerifiedTag& tag : file.tags) {
    if (tag.finding.is_fault()) rules.erase(tag.finding.rule);
    add_tag(file, tag, merged);
  }
  if (only_lacks_tags) {
    ++merged.without_tag_count;
    if (merged.without_tag.size() < kMostListedFaults) {
      merged.without_tag.push_back(fault_of(file, "no-tag"));
    }
    return;
  }
  // What is left is wrong with the whole file.
  for (const std::string& rule : rules) add_fault(merged, fault_of(file, rule));
}

std::vector<const PlacedTag*> tags_along(const Survey& survey, Side side) {
  std::vector<const PlacedTag*> wall;
  for (const PlacedTag& tag : survey.tags) {
    if (tag.side == side) wall.push_back(&tag);
  }
  std::ranges::stable_sort(wall, {}, &PlacedTag::chainage);
  return wall;
}

std::vector<std::string> missing_tags(const Survey& survey, const VerifyMerge& merged) {
  std::vector<std::string> missing;
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    if (record.seen + record.doubts == 0) missing.push_back(tag.name);
  }
  return missing;
}

bool has_room(const VerifyMerge& merged, const FaultRecord& fault, std::size_t bytes) {
  return merged.picture_bytes + bytes <= kMostPictureBytes &&
         (!fault.shows_whole || merged.whole_bytes + bytes <= kMostWholeBytes);
}

void take_picture(std::string jpeg, FaultRecord& fault, VerifyMerge& merged) {
  if (!has_room(merged, fault, jpeg.size())) {
    fault.no_picture = "a report holds no more pictures";
    return;
  }
  merged.picture_bytes += jpeg.size();
  if (fault.shows_whole) merged.whole_bytes += jpeg.size();
  fault.picture.jpeg = std::move(jpeg);
  fault.no_picture.clear();
}

void finish(VerifyMerge& merged) {
  if (!merged.shows_tag) {
    merged.files_with_findings += std::exchange(merged.without_tag_count, 0);
    for (FaultRecord& fault : std::exchange(merged.without_tag, {})) {
      add_fault(merged, std::move(fault));
    }
  }
  std::ranges::stable_sort(merged.faults, {}, [](const FaultRecord& fault) {
    return std::tie(fault.file, fault.tag, fault.rule, fault.message);
  });
  std::ranges::stable_sort(merged.notes, {},
                           [](const NoteRecord& note) { return std::tie(note.file, note.note); });
}

std::vector<FaultRecord> faults_by_plate(const VerifyMerge& merged) {
  std::vector<FaultRecord> plates;
  std::vector<std::vector<std::string>> files;
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  for (const FaultRecord& fault : merged.faults) {
    const std::string& plate_name = fault.tag.empty() ? fault.code : fault.tag;
    const auto [place, is_new] = known.try_emplace({fault.rule, plate_name}, plates.size());
    if (is_new || plate_name.empty()) {
      plates.push_back(fault);
      files.push_back({fault.file});
      continue;
    }
    FaultRecord& plate = plates[place->second];
    if (plate.picture.jpeg.empty() && !fault.picture.jpeg.empty()) {
      plate.picture = fault.picture;
      plate.no_picture.clear();
    }
    std::vector<std::string>& of_plate = files[place->second];
    if (of_plate.back() != fault.file) of_plate.push_back(fault.file);
  }
  for (std::size_t i = 0; i < plates.size(); ++i) {
    const std::size_t count = files[i].size();
    if (count == 1) continue;
    plates[i].file = fmt::format("in {} files: {}", count, first_names(files[i], count));
  }
  return plates;
}

std::string without_tag_in_words(const VerifyMerge& merged) {
  const std::size_t count = merged.without_tag_count;
  if (count == 0) return {};
  std::vector<std::string> names;
  for (const FaultRecord& photo : merged.without_tag) names.push_back(photo.file);
  std::ranges::sort(names);
  return fmt::format("{} without a tag: {}", counted(count, "photo"), first_names(names, count));
}

TagRecord record_of(const VerifyMerge& merged, const std::string& tag) {
  const auto found = merged.tags.find(tag);
  return found == merged.tags.end() ? TagRecord{} : found->second;
}

std::string status_of(const TagRecord& record) {
  constexpr double kPoor = 1.5;
  if (record.faults > 0) return "faulty";
  if (record.seen == 0) return "unseen";
  return record.worst && *record.worst < kPoor ? "poor" : "ok";
}

std::string upright_of(const TagRecord& record) {
  if (record.photos == 0) return {};
  return record.upright > 0 ? "checked" : "unchecked";
}

std::string placement_of(const TagRecord& record) {
  if (record.placed > 0) return "checked";
  return record.photos > 0 ? "unchecked" : "";
}

std::string placement_checked(const Completeness& covered) {
  if (covered.placement_checked == 0) return "not_checked";
  return covered.placement_unchecked.empty() ? "checked" : "partly";
}

std::string noted_up_in_words(const NotedUp& noted) {
  if (noted.on_head == 0) return {};
  const std::size_t all = noted.upright + noted.on_head;
  if (noted.upright == 0 && all > 1) {
    return fmt::format(
        "All {} tags in photos with an EXIF orientation are upside down by it: the camera was "
        "mounted upside down, rather than all tags. Up is not known from these photos; give the "
        "rig that took "
        "them",
        all);
  }
  return fmt::format(
      "By the EXIF orientation of their photos, {} of {} tags are upside down: {}", noted.on_head,
      all,
      noted.on_head < noted.upright
          ? "those plates hang wrong, or a camera was held upside down and did not note it"
          : "a camera that is mounted upside down notes a wrong orientation; its photos need "
            "the rig");
}

Completeness completeness_of(const Survey& survey, const VerifyMerge& merged) {
  Completeness result;
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    const std::string status = status_of(record);
    const std::size_t seen = status == "unseen" ? 0 : 1;
    ++result.tags;
    result.seen += seen;
    result.ok += status == "ok" ? 1 : 0;
    result.poor += status == "poor" ? 1 : 0;
    result.faulty += status == "faulty" ? 1 : 0;
    result.photographed += record.photos > 0 ? 1 : 0;
    const std::string placement = placement_of(record);
    result.placement_checked += placement == "checked" ? 1 : 0;
    if (placement == "unchecked") result.placement_unchecked.push_back(tag.name);
    if (upright_of(record) == "unchecked") result.upright_unchecked.push_back(tag.name);
    if (tag.side != Side::left) continue;
    ++result.left_tags;
    result.left_seen += seen;
  }
  if (merged.own_tags == 0) {
    result.another_drive = other_drive_in_words({survey.name}, merged.other_codes);
  }
  add_unseen(survey, merged, Side::left, result.unseen);
  add_unseen(survey, merged, Side::right, result.unseen);
  return result;
}

std::vector<std::string> unchecked_words(const Completeness& covered, const VerifyMerge& merged) {
  std::vector<std::string> words{covered.another_drive, placement_in_words(covered),
                                 up_in_words(covered), noted_up_in_words(merged.noted_up)};
  words.push_back(without_tag_in_words(merged));
  std::erase(words, "");
  return words;
}

std::string describe(const UnseenStretch& stretch) {
  const std::string place = stretch.from == stretch.to
                                ? fmt::format("at {:.2f} m", stretch.from)
                                : fmt::format("from {:.2f} to {:.2f} m", stretch.from, stretch.to);
  const std::string names = stretch.tags.size() == 1
                                ? stretch.tags.front()
                                : fmt::format("{} tags, {} to {}", stretch.tags.size(),
                                              stretch.tags.front(), stretch.tags.back());
  return fmt::format("{} wall {}: {}", to_string(stretch.side), place, names);
}

}  // namespace tagsmith::detail
