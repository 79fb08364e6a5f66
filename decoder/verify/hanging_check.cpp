// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hanging_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <unordered_set>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "decoder/localize/plate_pose.hpp"
#include "decoder/verify/hanging.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

namespace {

// A tag that may show where it hangs: in the survey, and in this picture once. What the picture by
// itself makes doubtful is decided by where it hangs.
bool shows_place(const VerifiedTag& tag) {
  const TagStatus status = tag.finding.status;
  return status == TagStatus::ok || status == TagStatus::misplaced || status == TagStatus::doubtful;
}

constexpr const char* kMixedPhotos = "mixed-photos";
constexpr const char* kTurned = "turned";

void forget_hanging(VerifiedFile& file) {
  for (const std::string& words : file.mixed) std::erase(file.findings, words);
  if (!file.mixed.empty()) file.rules.erase(kMixedPhotos);
  file.mixed.clear();
  for (VerifiedTag& tag : file.tags) {
    const bool is_of_hanging = tag.hung && (tag.hung->verdict == HangVerdict::off ||
                                            tag.hung->verdict == HangVerdict::doubtful);
    if (is_of_hanging || tag.finding.rule == kTurned) tag.finding = {};
    tag.hung.reset();
    tag.in_place_of.clear();
  }
}

// The camera of a photo; or nothing, with the reason in `note`.
std::optional<PhotoOrigin> usable_origin(const HangingSetup& setup, const VerifiedFile& file,
                                         std::string& note) {
  const std::string name = file.file.string();
  const Result<PhotoOrigin> origin = setup.cameras.origin_of(file.file);
  if (!origin) {
    const bool is_missed = !setup.by_lenses || std::ranges::count_if(file.tags, shows_place) > 1;
    if (is_missed) {
      note = fmt::format(
          "{}: {}; where its tags hang was not checked", name,
          setup.by_lenses ? "does not name its camera and lens (EXIF)" : origin.error().message);
    }
    return std::nullopt;
  }
  const RigCamera& camera = setup.rig.cameras[origin->camera];
  if (camera.camera.width == file.width && camera.camera.height == file.height) return *origin;
  note = fmt::format(
      "{}: is {} x {} pixels, expected {} x {} as the rig's camera {} has; where its tags hang was "
      "not checked",
      name, file.width, file.height, camera.camera.width, camera.camera.height, camera.name);
  return std::nullopt;
}

bool is_unknown_tag(const VerifiedTag& tag) {
  return tag.digits && tag.tag.empty() &&
         (tag.finding.status == TagStatus::unknown || tag.finding.status == TagStatus::misprinted);
}

// The photo's tags that show where they hang, by its camera, and those that the survey does not
// have.
std::vector<SightedTag> sighted_tags(const Survey& survey, const HangingSetup& setup,
                                     VerifiedFile file, std::string& note) {
  std::vector<SightedTag> sighted;
  forget_hanging(file);
  const auto counts = [](const VerifiedTag& tag) {
    return shows_place(tag) || is_unknown_tag(tag);
  };
  if (std::ranges::none_of(file.tags, counts)) return sighted;
  const std::optional<PhotoOrigin> origin = usable_origin(setup, file, note);
  for (const VerifiedTag& tag : file.tags) {
    const bool is_unknown = is_unknown_tag(tag);
    const bool is_own = shows_place(tag) && tag.digits && find_tag(survey, tag.tag) != nullptr &&
                        std::ranges::count(file.tags, tag.tag, &VerifiedTag::tag) == 1;
    if (!origin || (!is_unknown && !is_own)) continue;
    sighted.push_back({origin->station, origin->camera,
                       is_unknown ? to_string(*tag.digits) : tag.tag,
                       seen_corners(tag.corners, tag.corner_covariance)});
  }
  return sighted;
}

const HungTag* find_in(const std::vector<HungTag>& tags, const std::string& name) {
  const auto found = std::ranges::find(tags, name, &HungTag::tag);
  return found == tags.end() ? nullptr : &*found;
}

// What is said of the tag in the photos of a station, or else in all.
const HungTag* find_hung(const HungTags& hung, const std::optional<PhotoOrigin>& origin,
                         const std::string& name) {
  for (const UnplacedTags& unplaced : hung.unplaced) {
    if (!origin || unplaced.station != origin->station) continue;
    if (const HungTag* here = find_in(unplaced.tags, name)) return here;
  }
  return find_in(hung.tags, name);
}

void judge_place(const HungTag& hung, VerifiedTag& tag) {
  tag.hung = hung;
  Finding& found = tag.finding;
  switch (hung.verdict) {
    case HangVerdict::unchecked:
      return;
    case HangVerdict::fits:
      if (found.status != TagStatus::ok) found = {TagStatus::ok, hung.rule, hung.message};
      return;
    case HangVerdict::off:
      found = {TagStatus::misplaced, hung.rule, hung.message};
      return;
    case HangVerdict::doubtful:
      if (found.status == TagStatus::misplaced) return;  // the photo by itself shows more
      found = {TagStatus::doubtful, hung.rule, hung.message};
  }
}

// True when the tag stands on its head, the vehicle standing level.
bool is_on_head(const RigCamera& camera, const VerifiedTag& tag) {
  constexpr double kFlat = 0.5;  // of the way: less may be a plate seen from above
  // The vehicle's down in the camera's axes.
  const Eigen::Vector3d down = -camera.vehicle_from_camera.rotation.row(2).transpose();
  const auto upper = ray_through(camera.camera, {tag.corners[0].x, tag.corners[0].y});
  const auto lower = ray_through(camera.camera, {tag.corners[3].x, tag.corners[3].y});
  if (!upper || !lower) return false;
  return (lower->normalized() - upper->normalized()).normalized().dot(down) <= -kFlat;
}

// How far a plate is turned clockwise, seen from its front, from where its y axis points down;
// `down` in the axes in which the plate stands so.
double lean(const Eigen::Matrix3d& plate, const Eigen::Vector3d& down) {
  return std::atan2(plate.col(0).dot(down), plate.col(1).dot(down));
}

// How far a plate is turned clockwise in its plane against its surveyed place, the vehicle standing
// on the floor there, by its picture alone, radians. Of the two places that the picture allows it
// takes the one that fits better; from the front, where both do, they are turned alike.
std::optional<double> turned_clockwise(const Survey& survey, const RigCamera& camera,
                                       const VerifiedTag& tag) {
  std::array<Eigen::Vector3d, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray = ray_through(camera.camera, {tag.corners[i].x, tag.corners[i].y});
    if (!ray) return std::nullopt;
    rays[i] = *ray;
  }
  const TagTemplate& plate = survey.tag_template;
  const auto poses = plate_poses(rays, plate.frame_inner_length, plate.frame_inner_height);
  if (!poses) return std::nullopt;
  const PlacedTag& placed = *find_tag(survey, tag.tag);
  const CenterlinePoint floor = survey.tunnel.centerline.at(placed.chainage);
  const Eigen::Vector3d floor_down = Eigen::Vector3d(floor.grade * std::sin(floor.heading),
                                                     floor.grade * std::cos(floor.heading), -1)
                                         .normalized();
  const double surveyed = lean(placed.world_from_plate.rotation, floor_down);
  const auto misfit = [&](const Pose& pose) {
    double squares = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d corner(i == 1 || i == 2 ? plate.frame_inner_length : 0,
                                   i >= 2 ? plate.frame_inner_height : 0, 0);
      squares += ((pose * corner).hnormalized() - rays[i].hnormalized()).squaredNorm();
    }
    return squares;
  };
  const Pose& likelier = std::ranges::min(*poses, {}, misfit);
  const Eigen::Matrix3d on_vehicle = camera.vehicle_from_camera.rotation * likelier.rotation;
  return wrapped_angle(lean(on_vehicle, -Eigen::Vector3d::UnitZ()) - surveyed);
}

// A plate that nothing else in the pictures checks, turned farther than the vehicle leans.
std::optional<Finding> find_turned(const Survey& survey, const Rig& rig, const RigCamera& camera,
                                   const VerifiedTag& tag) {
  constexpr double kSurely = 4;  // standard deviations
  const double least = radians(8);
  if (tag.finding.status != TagStatus::ok ||
      (tag.hung && tag.hung->verdict != HangVerdict::unchecked)) {
    return std::nullopt;
  }
  const double sigma = Eigen::Vector4d(rig.roll_sigma, rig.pitch_sigma,
                                       camera.calibration_sigma.angle, survey.angle_sigma)
                           .norm();
  const auto turned = turned_clockwise(survey, camera, tag);
  if (!turned || std::abs(*turned) < std::max(least, kSurely * sigma)) return std::nullopt;
  return Finding{
      TagStatus::doubtful, kTurned,
      fmt::format("{} is turned {} by {:.0f} degrees in its plane, by the camera's mounting on the "
                  "vehicle, or the vehicle leaned so: turn it back, or see another photo of it",
                  tag.tag, *turned > 0 ? "clockwise" : "anticlockwise",
                  degrees(std::abs(*turned)))};
}

void judge_up(const Survey& survey, const HangingSetup& setup, const HungTags& hung,
              VerifiedFile& file) {
  std::string note;
  const auto origin = usable_origin(setup, file, note);
  if (!origin || !stands_level(setup.rig)) return;
  file.up = UpSource::rig;
  std::erase_if(file.notes,
                [](const std::string& one) { return one.find(kDoubtedUp) != std::string::npos; });
  for (VerifiedTag& tag : file.tags) {
    if (!shows_place(tag) || !hangs_upright(survey, tag)) continue;
    const RigCamera& camera = setup.rig.cameras[origin->camera];
    if (is_on_head(camera, tag)) {
      tag.finding = {TagStatus::misprinted, "upside-down",
                     fmt::format("{} is upside down, by the camera's mounting on the vehicle: it "
                                 "hangs upside down, or is a mirrored print",
                                 tag.tag)};
      continue;
    }
    if (tag.finding.doubts_up()) tag.finding = {};
    if (hung.nothing_fits) continue;
    if (auto turned = find_turned(survey, setup.rig, camera, tag)) {
      tag.finding = std::move(*turned);
    }
  }
}

// A photo of a station that was mixed up with another.
void judge_station(const HangingSetup& setup, const HungTags& hung,
                   const std::optional<PhotoOrigin>& origin, VerifiedFile& file) {
  for (const MixedStations& mixed : hung.mixed) {
    const bool is_of_it =
        origin && (origin->station == mixed.one || origin->station == mixed.other);
    if (!is_of_it) continue;
    file.mixed.push_back(in_words(mixed, setup.rig));
    file.add_finding(kMixedPhotos, file.mixed.back());
  }
}

void judge_unknown_tag(const HungTags& hung, const std::optional<PhotoOrigin>& origin,
                       VerifiedTag& tag) {
  if (!origin || !is_unknown_tag(tag)) return;
  const auto known = std::ranges::find_if(hung.unknown_tags, [&](const UnknownTag& unknown) {
    return unknown.station == origin->station && unknown.code == to_string(*tag.digits);
  });
  if (known != hung.unknown_tags.end()) tag.in_place_of = known->place;
}

// Adds those that were seen, but never together with another; in the survey's order.
void add_unchecked(const Survey& survey, const std::set<std::string>& seen,
                   std::vector<HungTag>& tags) {
  std::vector<HungTag> all;
  for (const PlacedTag& placed : survey.tags) {
    if (const HungTag* hung = find_in(tags, placed.name)) {
      all.push_back(*hung);
    } else if (seen.contains(placed.name)) {
      all.emplace_back().tag = placed.name;
    }
  }
  tags = std::move(all);
}

// Why photos could not be used: the first by name, whatever order they came in.
class UnusedPhotos {
 public:
  void add(const std::string& note) {
    ++count_;
    first_.insert(note);
    if (first_.size() > kMost) first_.erase(std::prev(first_.end()));
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> all(first_.begin(), first_.end());
    if (count_ > kMost) all.push_back(fmt::format("{} more photos likewise", count_ - kMost));
    return all;
  }

 private:
  static constexpr std::size_t kMost = 20;
  std::multiset<std::string> first_;
  std::size_t count_ = 0;
};

}  // namespace

Result<void> for_each_sighted(
    const Survey& survey, const HangingSetup& setup, const EachFile& files,
    const std::function<void(const std::vector<SightedTag>&, const std::string&)>& take) {
  const std::string revision = survey_revision(survey);
  std::unordered_set<std::size_t> known;
  return files([&](const VerifiedFile& file) {
    if (!file.is_photo() || file.revision != revision) return;
    // A copy of a photo measures nothing anew.
    const std::string content = file.sha256.empty() ? identity_of(file) : file.sha256;
    if (!known.insert(std::hash<std::string>{}(content)).second) return;
    std::string note;
    const std::vector<SightedTag> sighted = sighted_tags(survey, setup, file, note);
    take(sighted, note);
  });
}

Result<HungTags> check_hanging(const Survey& survey, const HangingSetup& setup,
                               const EachFile& files) {
  SightingPick pick;
  std::set<std::string> seen;
  UnusedPhotos unused;
  const auto counted =
      for_each_sighted(survey, setup, files, [&](const auto& sighted, const std::string& note) {
        pick.count(sighted);
        for (const SightedTag& tag : sighted) seen.insert(tag.tag);
        if (!note.empty()) unused.add(note);
      });
  if (!counted) return fail(counted);
  pick.choose();
  const auto taken = for_each_sighted(survey, setup, files,
                                      [&](const auto& sighted, auto&) { pick.take(sighted); });
  if (!taken) return fail(taken);
  HungTags hung = check_hung_tags(survey, setup.rig, pick.taken(), setup.tolerance);
  hung.revision = survey_revision(survey);
  add_unchecked(survey, seen, hung.tags);
  hung.notes = unused.notes();
  for (const MixedStations& mixed : hung.mixed) hung.notes.push_back(in_words(mixed, setup.rig));
  if (auto words = untied_in_words(hung.untied)) hung.notes.push_back(std::move(*words));
  if (!hung.all_alike.empty()) {
    hung.notes.push_back(
        "the plates are in doubt, and each tag is compared with plates that all hang so: " +
        hung.all_alike);
  }
  if (!hung.rig_doubt.empty()) {
    hung.notes.push_back("the rig is in doubt, and no tag was judged by where it hangs: " +
                         hung.rig_doubt);
  } else if (hung.nothing_fits) {
    hung.notes.push_back(
        "more than half of the tags seen contradict the survey: are these its photos, and is the "
        "rig's calibration right? No tag was accused");
  }
  return hung;
}

void judge_hanging(const Survey& survey, const HangingSetup& setup, const HungTags& hung,
                   VerifiedFile& file) {
  if (!file.is_photo() || file.revision != hung.revision) return;
  const Result<PhotoOrigin> known = setup.cameras.origin_of(file.file);
  const std::optional<PhotoOrigin> origin = known ? std::optional(*known) : std::nullopt;
  if (setup.by_lenses && !origin) return;
  forget_hanging(file);
  for (VerifiedTag& tag : file.tags) {
    const HungTag* here = shows_place(tag) ? find_hung(hung, origin, tag.tag) : nullptr;
    if (here != nullptr) judge_place(*here, tag);
    judge_unknown_tag(hung, origin, tag);
  }
  judge_station(setup, hung, origin, file);
  judge_up(survey, setup, hung, file);
}

}  // namespace tagsmith::detail
