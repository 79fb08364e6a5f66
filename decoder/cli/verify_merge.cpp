// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_merge.hpp"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith {
namespace {

void add_fault(VerifyMerge& merged, FaultRecord fault) {
  ++merged.fault_count;
  if (merged.faults.size() < kMostListedFaults) merged.faults.push_back(std::move(fault));
}

void add_grade(TagRecord& record, const VerifiedTag& tag) {
  if (!tag.grade) return;
  record.best = std::max(record.best.value_or(0), *tag.grade);
  if (record.worst && *record.worst <= *tag.grade) return;
  record.worst = tag.grade;
  record.blame = tag.blame;
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", *value) : std::string();
}

}  // namespace

void merge(const std::string& revision, const VerifiedFile& file, VerifyMerge& merged) {
  const std::string identity = file.file + '\n' + file.sha256;
  if (!merged.known.insert(std::hash<std::string>{}(identity)).second) {
    ++merged.repeated;
    return;
  }
  ++merged.files;
  if (!file.revision.empty() && file.revision != revision) ++merged.other_revisions;
  std::vector<std::string> rules = file.rules;
  for (const VerifiedTag& tag : file.tags) {
    if (tag.status == "cut_off") continue;
    if (tag.status == "ok") {
      TagRecord& record = merged.tags[tag.tag];
      ++record.seen;
      add_grade(record, tag);
      continue;
    }
    if (!tag.tag.empty()) ++merged.tags[tag.tag].faults;
    std::erase(rules, tag.rule);
    add_fault(merged, {file.file, tag.tag, tag.rule, tag.message, tag.crop});
  }
  // What is left is wrong with the whole file.
  for (const std::string& rule : rules) {
    const std::string words = file.findings.empty() ? "" : file.findings.front();
    add_fault(merged, {file.file, "", rule, words, ""});
  }
}

std::string status_of(const TagRecord& record) {
  constexpr double kPoor = 1.5;
  if (record.faults > 0) return "faulty";
  if (record.seen == 0) return "unseen";
  return record.worst && *record.worst < kPoor ? "poor" : "ok";
}

std::string report_csv(const Survey& survey, const VerifyMerge& merged) {
  std::string csv = csv_row({"tag", "digits", "chainage_m", "status", "seen", "faults",
                             "best_grade", "worst_grade", "blame"});
  for (const PlacedTag& tag : survey.tags) {
    const auto found = merged.tags.find(tag.name);
    const TagRecord record = found == merged.tags.end() ? TagRecord{} : found->second;
    csv += csv_row({tag.name, to_string(tag.digits), format_number(tag.chainage, 3),
                    status_of(record), std::to_string(record.seen), std::to_string(record.faults),
                    number(record.best), number(record.worst), record.blame});
  }
  return csv;
}

}  // namespace tagsmith
