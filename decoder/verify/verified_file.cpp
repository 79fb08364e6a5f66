// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verified_file.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace tagsmith::detail {

std::string to_string(TagStatus status) {
  return kTagStatusNames[static_cast<std::size_t>(status)];
}

std::string to_string(UpSource source) {
  constexpr std::array<const char*, kUpSources> kNames{"unknown", "page", "rig", "camera",
                                                       "doubted"};
  return kNames[static_cast<std::size_t>(source)];
}

std::string in_words(const VerifiedTag& tag) {
  return to_string(tag.finding.status) + ": " + message_of(tag);
}

std::string message_of(const VerifiedTag& tag) {
  if (!tag.in_place_of.empty()) {
    return fmt::format("{}; it hangs where {} should, which no photo shows: hang {} there",
                       tag.finding.message, tag.in_place_of, tag.in_place_of);
  }
  if (!tag.hung || tag.hung->placed.empty()) return tag.finding.message;
  return fmt::format("{}; or, when it stays, write it into the survey's `placed`: - {}",
                     tag.finding.message, tag.hung->placed);
}

bool VerifiedFile::only_lacks_tags() const {
  return is_photo() && rules == std::set<std::string>{"no-tag"} &&
         std::ranges::none_of(tags, &Finding::is_fault, &VerifiedTag::finding);
}

void VerifiedFile::add_finding(std::string_view rule, std::string words) {
  rules.emplace(rule);
  findings.push_back(std::move(words));
}

std::vector<std::string> findings_of(const VerifiedFile& file) {
  std::vector<std::string> words = file.findings;
  for (const VerifiedTag& tag : file.tags) {
    if (!tag.finding.is_fault()) continue;
    words.push_back((tag.page == 0 ? "" : fmt::format("page {}: ", tag.page)) + in_words(tag));
  }
  return words;
}

std::set<std::string> rules_of(const VerifiedFile& file) {
  std::set<std::string> rules = file.rules;
  for (const VerifiedTag& tag : file.tags) {
    if (tag.finding.is_fault()) rules.insert(tag.finding.rule);
  }
  return rules;
}

std::string identity_of(const VerifiedFile& file) {
  return file.file.string() + '\n' + file.sha256;
}

}  // namespace tagsmith::detail
