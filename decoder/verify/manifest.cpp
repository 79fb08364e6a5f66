// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/manifest.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/compare.hpp"

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

// The numbers of a list; empty when it is none, or holds anything else.
std::vector<double> numbers_of(const json& list) {
  std::vector<double> numbers;
  if (!list.is_array()) return numbers;
  for (const json& item : list) {
    if (!item.is_number()) return {};
    numbers.push_back(item.get<double>());
  }
  return numbers;
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
  if (const auto position = object.find("position"); position != object.end()) {
    const std::vector<double> p = numbers_of(*position);
    if (p.size() == 3) tag.p_in_grid = Eigen::Vector3d(p[0], p[1], p[2]);
  }
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

std::string outdated(const Survey& survey, const ManifestTag& printed) {
  const PlacedTag* placed = find_tag(survey, printed.name);
  if (placed == nullptr) {
    return fmt::format("{} was printed, but survey {} has no such tag", printed.name, survey.name);
  }
  if (placed->digits != printed.digits) {
    return fmt::format("{} was printed as {}, but survey {} now says {}: print it again",
                       printed.name, to_string(printed.digits), survey.name,
                       to_string(placed->digits));
  }
  if (!printed.p_in_grid) return {};
  const double distance = (placed->p_in_grid - *printed.p_in_grid).norm();
  if (distance <= kSamePlace) return {};
  return fmt::format(
      "the label of {} says a place {} mm from where survey {} now has it: print it "
      "again, or keep the plate and hang it by the new list",
      printed.name, format_number(distance * 1e3, 1), survey.name);
}

// Why a document of all tags, such as the setting-out list, no longer holds; empty when it does.
std::string outdated_list(const Survey& survey, const PrintManifest& manifest) {
  std::string names;
  std::size_t count = 0;
  constexpr std::size_t kMostNamed = 8;
  for (const ManifestTag& tag : manifest.tags) {
    if (outdated(survey, tag).empty()) continue;
    if (++count <= kMostNamed) names += (names.empty() ? "" : " ") + tag.name;
  }
  if (count == 0) return {};
  if (count > kMostNamed) names += fmt::format(" and {} more", count - kMostNamed);
  return fmt::format("it lists {} as before the survey was changed: print it again", names);
}

// What the survey's template has otherwise than it was printed; empty when nothing.
std::string other_plate(const PrintManifest& manifest, const TagTemplate& tag) {
  struct Size {
    const char* key;
    const char* words;
    double width;
    double height;
  };
  const Size sizes[] = {
      {"plate_mm", "a plate", tag.plate_length, tag.plate_height},
      {"feature_frame_inner_mm", "a feature frame inside", tag.frame_inner_length,
       tag.frame_inner_height},
  };
  constexpr double kSameSize = 0.001;  // mm
  for (const Size& size : sizes) {
    const auto printed = manifest.sizes.find(size.key);
    if (printed == manifest.sizes.end() || printed->second.size() != 2) continue;
    const double width = size.width * 1e3;
    const double height = size.height * 1e3;
    if (std::abs(printed->second[0] - width) < kSameSize &&
        std::abs(printed->second[1] - height) < kSameSize) {
      continue;
    }
    return fmt::format(
        "it was printed with {} of {} x {} mm, but {} now has {} x {} mm: print it "
        "again",
        size.words, format_number(printed->second[0], 3), format_number(printed->second[1], 3),
        tag.name, format_number(width, 3), format_number(height, 3));
  }
  return {};
}

// The millimetres under the key as metres; nothing unless they are `count` numbers.
std::optional<std::vector<double>> lengths_of(const json& object, const char* key,
                                              std::size_t count) {
  const auto list = object.find(key);
  if (list == object.end()) return std::nullopt;
  std::vector<double> lengths = numbers_of(*list);
  if (lengths.size() != count) return std::nullopt;
  for (double& length : lengths) length /= 1000;
  return lengths;
}

// How many tiles there are along a side; nothing when that is no sensible number.
std::optional<int> count_of(const json& object, const char* key) {
  constexpr std::int64_t kMost = 100;
  const auto value = object.find(key);
  if (value == object.end() || !value->is_number_integer()) return std::nullopt;
  const auto count = value->get<std::int64_t>();
  if (count < 1 || count > kMost) return std::nullopt;
  return static_cast<int>(count);
}

std::optional<TilePlan> parse_tiles(const json& root) {
  const auto object = root.find("tiles");
  if (object == root.end() || !object->is_object()) return std::nullopt;
  const auto columns = count_of(*object, "columns");
  const auto rows = count_of(*object, "rows");
  const auto page = lengths_of(root, "page_mm", 2);
  const auto window = lengths_of(*object, "window_mm", 4);
  const auto step = lengths_of(*object, "step_mm", 2);
  if (!columns || !rows || !page || !window || !step) return std::nullopt;
  TilePlan plan{*columns, *rows, (*page)[0], (*page)[1]};
  plan.window = {(*window)[0], (*window)[1], (*window)[2], (*window)[3]};
  plan.step_right = (*step)[0];
  plan.step_down = (*step)[1];
  const bool on_page = plan.window.x >= 0 && plan.window.y >= 0 && plan.window.width > 0 &&
                       plan.window.height > 0 &&
                       plan.window.x + plan.window.width <= plan.page_width &&
                       plan.window.y + plan.window.height <= plan.page_height &&
                       plan.page_width <= kLongestPage && plan.page_height <= kLongestPage;
  const bool overlap = plan.step_right > 0 && plan.step_right <= plan.window.width &&
                       plan.step_down > 0 && plan.step_down <= plan.window.height;
  if (!on_page || !overlap) return std::nullopt;
  return plan;
}

// Fields that older manifests lack; whatever is not understood is left out.
void read_details(const json& root, PrintManifest& manifest) {
  for (const char* key : {"plate_mm", "feature_frame_inner_mm"}) {
    if (root.contains(key)) manifest.sizes[key] = numbers_of(root[key]);
  }
  if (root.contains("documents") && root["documents"].is_array()) {
    for (const json& file : root["documents"]) {
      if (file.is_string()) manifest.documents.push_back(file.get<std::string>());
    }
  }
  if (root.contains("sha256") && root["sha256"].is_object()) {
    for (const auto& [file, hash] : root["sha256"].items()) {
      if (hash.is_string()) manifest.sha256[file] = hash.get<std::string>();
    }
  }
  manifest.tiled =
      root.contains("tiled") && root["tiled"].is_boolean() && root["tiled"].get<bool>();
  manifest.tiles = parse_tiles(root);
  constexpr int kMostDotsPerInch = 10'000;
  const auto dots = root.find("png_dots_per_inch");
  if (dots == root.end() || !dots->is_number()) return;
  const double value = dots->get<double>();
  if (value >= 1 && value <= kMostDotsPerInch) manifest.dots_per_inch = static_cast<int>(value);
}

}  // namespace

std::vector<ManifestTag> tags_of_file(const PrintManifest& manifest, const std::string& file) {
  std::vector<ManifestTag> tags;
  std::ranges::copy_if(manifest.tags, std::back_inserter(tags),
                       [&](const ManifestTag& tag) { return is_in(tag, file); });
  return tags;
}

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
  read_details(root, manifest);
  return manifest;
}

Result<std::shared_ptr<const PrintManifest>> ManifestCache::find(const fs::path& print_file) {
  constexpr std::size_t kKept = 8;  // files are listed folder by folder
  const fs::path folder = print_file.parent_path();
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find(entries_, folder, &Entry::folder);
  if (known != entries_.end()) return known->manifest;
  Result<std::shared_ptr<const PrintManifest>> result = nullptr;
  Result<std::optional<PrintManifest>> parsed = find_manifest(print_file);
  if (!parsed) {
    result = fail(parsed.error().message);
  } else if (*parsed) {
    result = std::make_shared<const PrintManifest>(std::move(**parsed));
  }
  if (entries_.size() == kKept) entries_.pop_front();
  entries_.push_back({folder, result});
  return result;
}

FileReport check_against_manifest(const PrintManifest& manifest, FileReport report) {
  const std::vector<ManifestTag> expected = tags_of_file(manifest, report.file.filename().string());
  if (expected.empty()) return report;
  std::vector<bool> found(expected.size(), false);
  for (TagFinding& tag : report.tags) {
    if (!tag.digits) continue;
    const auto match = std::ranges::find(expected, *tag.digits, &ManifestTag::digits);
    if (match != expected.end()) {
      found[static_cast<std::size_t>(match - expected.begin())] = true;
      if (tag.rule != "not-in-survey") continue;
      tag.tag = match->name;
      tag.rule = "stale";
      tag.message = fmt::format("{} {} is what was printed, but no longer in the survey",
                                match->name, to_string(*tag.digits));
    } else if (tag.status == TagStatus::ok) {
      tag.status = TagStatus::misprinted;
      tag.rule = "other-file";
      tag.message = fmt::format("{} {} stands in this file, expected {} (manifest.json)", tag.tag,
                                to_string(*tag.digits), names_of(expected));
    }
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!found[i]) {
      report.rules.insert("missing-in-file");
      report.findings.push_back(fmt::format("{} {} was not read, but manifest.json says it is here",
                                            expected[i].name, to_string(expected[i].digits)));
    }
  }
  return report;
}

ManifestEntry entry_of(const PrintManifest& manifest, const std::string& file) {
  if (std::ranges::count(manifest.documents, file) > 0) return ManifestEntry::document;
  if (tags_of_file(manifest, file).empty()) return ManifestEntry::stranger;
  return manifest.tiled ? ManifestEntry::tiles : ManifestEntry::tags;
}

FileReport check_freshness(const PrintManifest& manifest, const Survey& survey, FileReport report) {
  const std::string file = report.file.filename().string();
  const auto hash = manifest.sha256.find(file);
  if (hash != manifest.sha256.end() && report.sha256 != hash->second) {
    report.rules.insert("changed-file");
    report.findings.emplace_back(
        "it is not the file that was printed: its SHA-256 is not that of "
        "manifest.json");
  }
  std::vector<std::string> reasons;
  const std::vector<ManifestTag> tags = tags_of_file(manifest, file);
  if (!tags.empty()) reasons.push_back(other_plate(manifest, survey.tag_template));
  for (const ManifestTag& tag : tags) reasons.push_back(outdated(survey, tag));
  if (tags.empty() && std::ranges::count(manifest.documents, file) > 0) {
    reasons.push_back(outdated_list(survey, manifest));
  }
  std::erase(reasons, "");
  // Every reason but one is of no use when it is another survey's print.
  if (!reasons.empty() && manifest.survey != survey.name) {
    report.rules.insert("other-survey");
    report.findings.push_back(
        fmt::format("it was printed from survey {}, expected {} (manifest.json)", manifest.survey,
                    survey.name));
    return report;
  }
  for (const std::string& reason : reasons) {
    report.stale = true;
    report.rules.insert("stale");
    report.findings.push_back("stale: " + reason);
  }
  return report;
}

}  // namespace tagsmith
