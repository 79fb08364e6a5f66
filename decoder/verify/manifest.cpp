// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/manifest.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/survey/compare.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr std::uintmax_t kMaxManifestBytes = 16U << 20U;

// The value under the key; nothing where there is none, or one of another type.
template <class Value>
std::optional<Value> find_value(const json& object, const char* key) {
  const auto value = object.find(key);
  if (value == object.end()) return std::nullopt;
  try {
    return value->get<Value>();
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

void read_plate(const json& root, PrintManifest& manifest) {
  for (const PrintedLength& length : printed_lengths()) {
    if (!length.index) {
      if (const auto stated = find_value<double>(root, length.key)) {
        manifest.lengths[length.name] = *stated;
      }
    } else if (const auto sizes = find_value<std::array<double, 2>>(root, length.key)) {
      manifest.lengths[length.name] = (*sizes)[*length.index];
    }
  }
  manifest.white_on_black = find_value<bool>(root, "white_on_black");
}

std::optional<ManifestTag> parse_tag(const json& object) {
  const auto name = find_value<std::string>(object, "tag");
  const auto digits = parse_digits(find_value<std::string>(object, "digits").value_or(""));
  const auto files = find_value<std::vector<std::string>>(object, "files");
  if (!name || !digits || !files) return std::nullopt;
  ManifestTag tag{*name, *digits, *files};
  if (const auto p = find_value<std::array<double, 3>>(object, "position")) {
    tag.p_in_grid = Eigen::Vector3d(p->data());
  }
  tag.chainage = find_value<double>(object, "chainage");
  tag.is_kept = object.contains("revision");
  return tag;
}

std::string outdated(const Survey& survey, const ManifestTag& printed) {
  const PlacedTag* placed = find_tag(survey, printed.name);
  if (placed == nullptr) {
    return fmt::format("{} was printed, but survey {} has no such tag: remove the file",
                       printed.name, survey.name);
  }
  if (placed->digits != printed.digits) {
    return fmt::format("{} was printed as {}, but survey {} now says {}: print it again",
                       printed.name, to_string(printed.digits), survey.name,
                       to_string(placed->digits));
  }
  constexpr const char* kRemedy = "print it again, or keep the plate and hang it by the new list";
  const double distance = printed.p_in_grid ? (placed->p_in_grid - *printed.p_in_grid).norm() : 0.0;
  if (distance > kSamePlace) {
    return fmt::format("the label of {} says a place {} mm from where survey {} now has it: {}",
                       printed.name, format_number(distance * 1e3, 1), survey.name, kRemedy);
  }
  if (printed.chainage && std::abs(placed->chainage - *printed.chainage) > kSamePlace) {
    return fmt::format("the label of {} says chainage {:.3f} m, but survey {} now has {:.3f} m: {}",
                       printed.name, *printed.chainage, survey.name, placed->chainage, kRemedy);
  }
  return {};
}

// Why a document of all tags, such as the setting-out list, is outdated; empty when it is not.
std::string outdated_list(const Survey& survey, const PrintManifest& manifest) {
  std::vector<std::string> names;
  for (const ManifestTag& tag : manifest.tags) {
    if (!tag.is_kept && !outdated(survey, tag).empty()) names.push_back(tag.name);
  }
  if (names.empty()) {
    const std::string now = survey_revision(survey);
    if (manifest.revision.empty() || manifest.revision == now) return {};
    return fmt::format("it is of another state of the survey ({}, now {}): print it again",
                       manifest.revision, now);
  }
  return fmt::format("it lists {} as before the survey was changed: print it again", listed(names));
}

// The lengths in which the template differs from the print; empty when there are none.
std::string other_plate(const PrintManifest& printed, const TagTemplate& tag) {
  constexpr double kSameLength = 0.001;  // mm
  if (printed.white_on_black && *printed.white_on_black != tag.white_on_black) {
    return fmt::format("it was printed {}, but {} is {} now: print it again",
                       tag.white_on_black ? "black on white" : "white on black", tag.name,
                       tag.white_on_black ? "white on black" : "black on white");
  }
  for (const PrintedLength& length : printed_lengths()) {
    const auto stated = printed.lengths.find(length.name);
    const double now = length.of(tag) * 1e3;
    if (stated == printed.lengths.end() || std::abs(stated->second - now) < kSameLength) continue;
    return fmt::format("its {} was printed as {} mm, but {} now has {} mm: print it again",
                       length.name, format_number(stated->second, 3), tag.name,
                       format_number(now, 3));
  }
  return {};
}

void add_stale(const std::string& reason, VerifiedFile& file) {
  file.stale = true;
  file.add_finding("stale", "stale: " + reason);
}

// Tables that the manifest lists and that have changed since they were printed.
void find_changed_tables(const PrintManifest& manifest, VerifiedFile& file) {
  for (const std::string& name : manifest.documents) {
    const auto hash = manifest.sha256.find(name);
    if (!name.ends_with(".csv") || hash == manifest.sha256.end()) continue;
    const fs::path table = manifest.file.parent_path() / name;
    std::error_code ignored;
    if (!fs::exists(table, ignored)) continue;
    const Result<std::string> found = sha256_of_file(table);
    if (found && *found == hash->second) continue;
    file.add_finding("changed-file",
                     fmt::format("{} beside it is not the file that was printed", name));
  }
}

PrinterScale parse_scale(const json& root) {
  const auto object = root.find("printer");
  if (object == root.end()) return {};
  const auto scale = find_value<std::array<double, 2>>(*object, "scale");
  if (!scale || !is_usual({(*scale)[0], (*scale)[1]})) return {};
  return {(*scale)[0], (*scale)[1]};
}

std::optional<TilePlan> parse_tiles(const json& root) {
  constexpr int kMostTiles = 100;  // along a side
  const auto object = root.find("tiles");
  if (object == root.end()) return std::nullopt;
  const int columns = find_value<int>(*object, "columns").value_or(0);
  const int rows = find_value<int>(*object, "rows").value_or(0);
  const auto page = find_value<std::array<double, 2>>(root, "page_mm");
  const auto window = find_value<std::array<double, 4>>(*object, "window_mm");
  const auto step = find_value<std::array<double, 2>>(*object, "step_mm");
  if (!page || !window || !step) return std::nullopt;
  TilePlan plan{columns, rows, (*page)[0] / 1e3, (*page)[1] / 1e3};
  plan.window = {(*window)[0] / 1e3, (*window)[1] / 1e3, (*window)[2] / 1e3, (*window)[3] / 1e3};
  plan.step_right = (*step)[0] / 1e3;
  plan.step_down = (*step)[1] / 1e3;
  const bool is_count = columns >= 1 && columns <= kMostTiles && rows >= 1 && rows <= kMostTiles;
  const bool on_page = plan.window.x >= 0 && plan.window.y >= 0 && plan.window.width > 0 &&
                       plan.window.height > 0 &&
                       plan.window.x + plan.window.width <= plan.page_width &&
                       plan.window.y + plan.window.height <= plan.page_height &&
                       plan.page_width <= kLongestPage && plan.page_height <= kLongestPage;
  const bool overlap = plan.step_right > 0 && plan.step_right <= plan.window.width &&
                       plan.step_down > 0 && plan.step_down <= plan.window.height;
  if (!is_count || !on_page || !overlap) return std::nullopt;
  return plan;
}

// Fields that older manifests do not have; unknown content is left out.
void read_details(const json& root, PrintManifest& manifest) {
  constexpr int kMostDotsPerInch = 10'000;
  read_plate(root, manifest);
  manifest.template_revision = find_value<std::string>(root, "template_revision").value_or("");
  manifest.revision = find_value<std::string>(root, "revision").value_or("");
  manifest.documents =
      find_value<std::vector<std::string>>(root, "documents").value_or(std::vector<std::string>{});
  manifest.sha256 = find_value<std::map<std::string, std::string>>(root, "sha256")
                        .value_or(std::map<std::string, std::string>{});
  manifest.tiled = find_value<bool>(root, "tiled").value_or(false);
  manifest.tiles = parse_tiles(root);
  manifest.scale = parse_scale(root);
  const auto dots = [&](const char* key) {
    const double stated = find_value<double>(root, key).value_or(0);
    return stated >= 1 && stated <= kMostDotsPerInch ? static_cast<int>(stated) : 0;
  };
  manifest.dots_per_inch = dots("png_dots_per_inch");
  manifest.printer_dots_per_inch = dots("dots_per_inch");
}

}  // namespace

std::vector<ManifestTag> tags_of_file(const PrintManifest& manifest, const std::string& file) {
  std::vector<ManifestTag> tags;
  std::ranges::copy_if(manifest.tags, std::back_inserter(tags), [&](const ManifestTag& tag) {
    return std::ranges::count(tag.files, file) > 0;
  });
  return tags;
}

Result<std::optional<PrintManifest>> find_manifest(const fs::path& print_file) {
  const fs::path path = print_file.parent_path() / "manifest.json";
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  const Result<std::string> bytes = read_file(path, kMaxManifestBytes);
  if (!bytes) return fail(bytes);
  const json root = parse_json(*bytes);
  if (root.is_discarded()) return fail(path.string() + ": is no JSON");
  if (!root.is_object() || !root.contains("survey") || !root.contains("tags")) return std::nullopt;
  const auto survey = find_value<std::string>(root, "survey");
  if (!survey) return fail(path.string() + ": survey is no text, expected the survey's name");
  if (!root["tags"].is_array()) return fail(path.string() + ": tags is no list");
  PrintManifest manifest{path, sha256(*bytes), *survey, {}};
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
    result = fail(parsed);
  } else if (*parsed) {
    result = std::make_shared<const PrintManifest>(std::move(**parsed));
  }
  if (entries_.size() == kKept) entries_.pop_front();
  entries_.push_back({folder, result});
  return result;
}

std::string printed_otherwise(const PrintManifest& manifest, const TagTemplate& tag) {
  const int dots = manifest.printer_dots_per_inch;
  std::string other = other_plate(manifest, dots > 0 ? drawn_on_dots(tag, dots) : tag);
  const std::string& printed = manifest.template_revision;
  if (!other.empty() || printed.empty() || printed == template_revision(tag)) return other;
  return fmt::format(
      "its label, holes, contour or other parts beside the frame were printed otherwise than {} "
      "now has them: print it again",
      tag.name);
}

void find_missing(std::span<const ManifestTag> expected, VerifiedFile& file) {
  for (const ManifestTag& tag : expected) {
    const auto is_it = [&](const VerifiedTag& read) { return read.digits == tag.digits; };
    if (std::ranges::any_of(file.tags, is_it)) continue;
    file.add_finding("missing-in-file",
                     fmt::format("{} {} was not read, but manifest.json says it is here", tag.name,
                                 to_string(tag.digits)));
  }
}

void find_unlisted(const PrintManifest& manifest, VerifiedFile& file) {
  file.add_finding("unlisted-file",
                   fmt::format("{} does not list it: it may be of another state of the survey",
                               manifest.file.string()));
}

ManifestEntry entry_of(const PrintManifest& manifest, const std::string& file) {
  if (std::ranges::count(manifest.documents, file) > 0) return ManifestEntry::document;
  if (tags_of_file(manifest, file).empty()) return ManifestEntry::unlisted;
  return manifest.tiled ? ManifestEntry::tiles : ManifestEntry::tags;
}

void find_stale(const PrintManifest& manifest, const Survey& survey, VerifiedFile& file) {
  const std::string name = file.file.filename().string();
  const auto hash = manifest.sha256.find(name);
  if (hash != manifest.sha256.end() && file.sha256 != hash->second) {
    file.add_finding("changed-file",
                     "it is not the file that was printed: its SHA-256 is not that of "
                     "manifest.json");
  }
  std::vector<std::string> reasons;
  const std::vector<ManifestTag> tags = tags_of_file(manifest, name);
  if (!tags.empty()) reasons.push_back(printed_otherwise(manifest, survey.tag_template));
  for (const ManifestTag& tag : tags) reasons.push_back(outdated(survey, tag));
  if (tags.empty() && std::ranges::count(manifest.documents, name) > 0) {
    find_changed_tables(manifest, file);
    reasons.push_back(outdated_list(survey, manifest));
  }
  std::erase(reasons, "");
  // When it is another survey's print, that is the only reason of use.
  if (!reasons.empty() && manifest.survey != survey.name) {
    file.add_finding("other-survey",
                     fmt::format("it was printed from survey {}, expected {} (manifest.json)",
                                 manifest.survey, survey.name));
    return;
  }
  for (const std::string& reason : reasons) add_stale(reason, file);
}

void find_stale(const ManifestTag& stated, const Survey& survey, VerifiedFile& file) {
  if (const std::string reason = outdated(survey, stated); !reason.empty()) add_stale(reason, file);
}

}  // namespace tagsmith::detail
