// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/manifest.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"

namespace tagsmith {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr std::uintmax_t kMaxManifestBytes = 16U << 20U;

std::optional<std::string> text_of(const json& object, const char* key) {
  const auto value = object.find(key);
  if (value == object.end() || !value->is_string()) return std::nullopt;
  return value->get<std::string>();
}

std::optional<ManifestTag> parse_tag(const json& object) {
  if (!object.is_object()) return std::nullopt;
  const std::optional<std::string> name = text_of(object, "tag");
  const std::optional<std::string> digits = text_of(object, "digits");
  const auto files = object.find("files");
  if (!name || !digits || files == object.end() || !files->is_array()) return std::nullopt;
  const std::optional<Digits> parsed = parse_digits(*digits);
  if (!parsed) return std::nullopt;
  ManifestTag tag{*name, *parsed, {}};
  for (const json& file : *files) {
    if (!file.is_string()) return std::nullopt;
    tag.files.push_back(file.get<std::string>());
  }
  return tag;
}

bool is_in(const ManifestTag& tag, const std::string& file) {
  return std::ranges::find(tag.files, file) != tag.files.end();
}

std::string names_of(const std::vector<ManifestTag>& tags) {
  std::string text;
  for (const ManifestTag& tag : tags) text += (text.empty() ? "" : ", ") + tag.name;
  return text;
}

std::vector<ManifestTag> tags_of_file(const PrintManifest& manifest, const std::string& file) {
  std::vector<ManifestTag> tags;
  std::ranges::copy_if(manifest.tags, std::back_inserter(tags),
                       [&](const ManifestTag& tag) { return is_in(tag, file); });
  return tags;
}

std::string outdated(const Survey& survey, const ManifestTag& printed) {
  const PlacedTag* placed = find_tag(survey, printed.name);
  if (placed == nullptr) {
    return fmt::format("{} was printed, but survey {} has no such tag", printed.name, survey.name);
  }
  if (placed->digits == printed.digits) return {};
  return fmt::format("{} was printed as {}, but survey {} now says {}: print it again",
                     printed.name, to_string(printed.digits), survey.name,
                     to_string(placed->digits));
}

}  // namespace

Result<std::optional<PrintManifest>> find_manifest(const fs::path& print_file) {
  const fs::path path = print_file.parent_path() / "manifest.json";
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  const Result<std::string> bytes = read_file(path, kMaxManifestBytes);
  if (!bytes) return fail(bytes.error().message);
  const json root = json::parse(*bytes, nullptr, false);
  if (root.is_discarded()) return fail(path.string() + ": is no JSON");
  if (!root.is_object() || !root.contains("survey") || !root.contains("tags")) return std::nullopt;
  const std::optional<std::string> survey = text_of(root, "survey");
  if (!survey) return fail(path.string() + ": survey is no text, expected the survey's name");
  if (!root["tags"].is_array()) return fail(path.string() + ": tags is no list");
  PrintManifest manifest{path, *survey, {}};
  for (const json& object : root["tags"]) {
    std::optional<ManifestTag> tag = parse_tag(object);
    if (!tag) {
      return fail(fmt::format("{}: tags[{}] is not understood, expected tag, digits and files",
                              path.string(), manifest.tags.size()));
    }
    manifest.tags.push_back(std::move(*tag));
  }
  return manifest;
}

FileReport check_against_manifest(const PrintManifest& manifest, const Survey& survey,
                                  FileReport report) {
  const std::vector<ManifestTag> expected = tags_of_file(manifest, report.file.filename().string());
  if (expected.empty()) return report;
  std::vector<bool> found(expected.size(), false);
  for (TagFinding& tag : report.tags) {
    if (!tag.digits) continue;
    const auto match = std::ranges::find(expected, *tag.digits, &ManifestTag::digits);
    if (match != expected.end()) {
      found[static_cast<std::size_t>(match - expected.begin())] = true;
    } else if (tag.status == TagStatus::ok) {
      tag.status = TagStatus::misprinted;
      tag.message = fmt::format("{} {} stands in this file, expected {} (manifest.json)", tag.tag,
                                to_string(*tag.digits), names_of(expected));
    }
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!found[i]) {
      report.findings.push_back(fmt::format("{} {} was not read, but manifest.json says it is here",
                                            expected[i].name, to_string(expected[i].digits)));
    }
    const std::string old = outdated(survey, expected[i]);
    if (!old.empty()) report.findings.push_back(old);
  }
  return report;
}

}  // namespace tagsmith
