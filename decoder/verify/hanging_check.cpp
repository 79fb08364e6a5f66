// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hanging_check.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "decoder/verify/hanging.hpp"

namespace tagsmith {
namespace {

// True when all that is wrong is that the camera's note of its up has the tag on its head.
bool is_doubted_by_camera(const TagFinding& tag) {
  return tag.status == TagStatus::doubtful && tag.rule == "upside-down";
}

// A tag that may tell where it hangs: in the survey, and in this picture once.
bool tells(const TagFinding& tag) {
  return tag.status == TagStatus::ok || tag.status == TagStatus::misplaced ||
         is_doubted_by_camera(tag);
}

bool is_photo(const FileReport& report) { return report.width > 0; }

// The camera of a photo, or why it is not known in `note`.
std::optional<PhotoOrigin> usable_origin(const Rig& rig, const PhotoCameras& cameras,
                                         const FileReport& report, std::string& note) {
  const std::optional<PhotoOrigin> origin = cameras.origin_of(report.file);
  if (!origin) {
    note = fmt::format(
        "{}: which camera of the rig took it is not known; where its tags hang was "
        "not checked",
        report.file.string());
    return std::nullopt;
  }
  const RigCamera& camera = rig.cameras[origin->camera];
  if (camera.camera.width == report.width && camera.camera.height == report.height) return origin;
  note = fmt::format(
      "{}: is {} x {} pixels, expected {} x {} as the rig's camera {} has; where its tags hang was "
      "not checked",
      report.file.string(), report.width, report.height, camera.camera.width, camera.camera.height,
      camera.name);
  return std::nullopt;
}

std::string in_words(const TagFinding& tag) {
  return fmt::format("{}: {}", to_string(tag.status), tag.message);
}

bool is_told(const TagFinding& tag) {
  return tag.status != TagStatus::ok && tag.status != TagStatus::cut_off;
}

// Puts `changed` in place of the report's tag, and of the finding that told of it.
void replace(FileReport& report, TagFinding& tag, const TagFinding& changed) {
  if (is_told(tag)) {
    const auto told = std::ranges::find(report.findings, in_words(tag));
    if (told != report.findings.end()) report.findings.erase(told);
  }
  const std::string rule = tag.rule;
  tag = changed;
  if (std::ranges::find(report.tags, rule, &TagFinding::rule) == report.tags.end()) {
    report.rules.erase(rule);
  }
  if (!is_told(tag)) return;
  report.findings.push_back(in_words(tag));
  report.rules.insert(tag.rule);
}

void write(const HungTag& hung, TagFinding& tag) {
  tag.hung = hung;
  switch (hung.verdict) {
    case HangVerdict::unchecked:
      return;
    case HangVerdict::fits:
      if (tag.status == TagStatus::ok) return;
      tag.status = TagStatus::ok;
      break;
    case HangVerdict::off:
      tag.status = TagStatus::misplaced;
      break;
    case HangVerdict::doubtful:
      if (tag.status == TagStatus::misplaced) return;  // the picture's order tells more
      tag.status = TagStatus::doubtful;
      break;
  }
  tag.rule = hung.rule;
  tag.message = hung.message;
}

using HungByName = std::map<std::string, const HungTag*>;

HungByName by_name(const std::vector<HungTag>& tags) {
  HungByName named;
  for (const HungTag& tag : tags) named[tag.tag] = &tag;
  return named;
}

const HungTag* find_in(const HungByName& tags, const std::string& name) {
  const auto found = tags.find(name);
  return found == tags.end() ? nullptr : found->second;
}

}  // namespace

std::vector<SightedTag> sighted_tags(const Survey& survey, const Rig& rig,
                                     const PhotoCameras& cameras,
                                     std::span<const FileReport> reports,
                                     std::vector<std::string>& notes) {
  std::vector<SightedTag> sighted;
  for (const FileReport& report : reports) {
    if (!is_photo(report) || std::ranges::none_of(report.tags, tells)) continue;
    std::string note;
    const std::optional<PhotoOrigin> origin = usable_origin(rig, cameras, report, note);
    if (!note.empty()) notes.push_back(note);
    if (!origin) continue;
    for (const TagFinding& tag : report.tags) {
      const auto same = [&](const TagFinding& other) { return other.tag == tag.tag; };
      if (!tells(tag) || find_tag(survey, std::string_view(tag.tag)) == nullptr ||
          std::ranges::count_if(report.tags, same) > 1) {
        continue;
      }
      sighted.push_back({origin->station, origin->camera, tag.tag,
                         seen_corners(tag.corners, tag.corner_covariance)});
    }
  }
  return sighted;
}

void report_hung_tags(const HungTags& hung, const PhotoCameras& cameras,
                      std::vector<FileReport>& reports) {
  const HungByName of_all = by_name(hung.tags);
  std::map<std::string, HungByName> of_stations;
  for (const UnplacedTags& unplaced : hung.unplaced) {
    of_stations[unplaced.station] = by_name(unplaced.tags);
  }
  for (FileReport& report : reports) {
    if (!is_photo(report)) continue;
    const std::optional<PhotoOrigin> origin = cameras.origin_of(report.file);
    const auto unplaced = origin ? of_stations.find(origin->station) : of_stations.end();
    for (TagFinding& tag : report.tags) {
      if (!tells(tag)) continue;
      const HungTag* here =
          unplaced == of_stations.end() ? nullptr : find_in(unplaced->second, tag.tag);
      if (here == nullptr) here = find_in(of_all, tag.tag);
      if (here == nullptr) continue;
      TagFinding changed = tag;
      write(*here, changed);
      replace(report, tag, changed);
    }
  }
}

void find_upside_down_in_photos(const Survey& survey, const Rig& rig, const PhotoCameras& cameras,
                                std::vector<FileReport>& reports) {
  if (!stands_level(rig)) return;
  for (FileReport& report : reports) {
    std::string note;
    const auto origin = is_photo(report) ? usable_origin(rig, cameras, report, note) : std::nullopt;
    if (!origin) continue;
    report.up = UpSource::rig;
    std::erase_if(report.notes, [](const std::string& said) {
      return said.find(kDoubtedUp) != std::string::npos;
    });
    const RigCamera& camera = rig.cameras[origin->camera];
    // The vehicle's down in the camera's axes.
    const Eigen::Vector3d down = -camera.vehicle_from_camera.rotation.row(2).transpose();
    for (TagFinding& tag : report.tags) {
      if (!tells(tag) || !hangs_upright(survey, tag)) continue;
      const PixelPoint& p = tag.corners[0];
      const PixelPoint& q = tag.corners[3];
      const auto upper = ray_through(camera.camera, {p.x, p.y});
      const auto lower = ray_through(camera.camera, {q.x, q.y});
      constexpr double kFlat = 0.5;  // of the way: less may be a plate seen from above
      if (!upper || !lower) continue;
      const Eigen::Vector3d way = (lower->normalized() - upper->normalized()).normalized();
      TagFinding changed = tag;
      if (way.dot(down) <= -kFlat) {
        changed.status = TagStatus::misprinted;
        changed.rule = "upside-down";
        changed.message = fmt::format(
            "{} is upside down, by the camera's mounting on the vehicle: it hangs upside down, or "
            "is a mirrored print",
            tag.tag);
      } else if (is_doubted_by_camera(tag)) {
        changed.status = TagStatus::ok;
        changed.rule.clear();
        changed.message.clear();
      } else {
        continue;
      }
      replace(report, tag, changed);
    }
  }
}

}  // namespace tagsmith
