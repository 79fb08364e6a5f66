// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/hung_tags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/plates/attitude_scatter.hpp"
#include "decoder/plates/drive_fit.hpp"
#include "decoder/plates/plate_start.hpp"
#include "decoder/plates/plate_trials.hpp"
#include "decoder/plates/rig_suspicion.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/as_built_place.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

SightedPlate plate_for(const Survey& survey, const PlacedTag& tag) {
  SightedPlate plate = sighted_plate(tag, survey);
  const double sigma =
      std::max({survey.states_sigma ? survey.sigma : 0, tag.sigma, kLeastSurveySigma});
  set_survey_sigma(plate, sigma, std::max(survey.angle_sigma, kLeastAngleSigma));
  return plate;
}

// The stations as rows of a run.
std::vector<Observation> rows_of(const Survey& survey, const Rig& rig,
                                 std::span<const SightedTag> sighted) {
  std::vector<Observation> rows;
  std::map<std::string, std::size_t> places;
  for (const SightedTag& seen : sighted) {
    const PlacedTag* tag = find_tag(survey, seen.tag);
    if (tag == nullptr) continue;
    const auto [place, is_new] = places.emplace(seen.station, rows.size());
    if (is_new) rows.emplace_back().id = seen.station;
    rows[place->second].tags.push_back(
        {rig.cameras[seen.camera].name, 0, *tag, seen.seen, std::nullopt});
  }
  return rows;
}

// Where the survey does not say how plates are turned, their pictures do.
void take_scatter(const Survey& survey, AdjustmentProblem& problem) {
  if (survey.angle_sigma > 0 && survey.states_angle_sigma) return;
  const double sigma = std::max(attitude_scatter(problem), kLeastAngleSigma);
  for (auto* plates : {&problem.plates, &problem.unseen}) {
    for (SightedPlate& plate : *plates) {
      plate.survey_variance.tail<3>().setConstant(sigma * sigma);
    }
  }
}

// The offset in the axes of who faces the plate. The plate's own are right, down, into the wall.
void measure(const SightedPlate& plate, const PlateOffset& offset, HungTag& tag) {
  const Eigen::Matrix3d& rotation = plate.world_from_plate.rotation;
  Eigen::Matrix3d facing = rotation.transpose();
  facing.row(1) *= -1;
  facing.row(2) *= -1;
  tag.offset.value = facing * offset.shift;
  tag.offset.sigma = (facing * offset.covariance.topLeftCorner<3, 3>() * facing.transpose())
                         .diagonal()
                         .cwiseMax(0)
                         .cwiseSqrt();
  const Eigen::Matrix3d& of_turn = offset.covariance.bottomRightCorner<3, 3>();
  tag.turn.value = {offset.turn.z(), offset.turn.y(), offset.turn.x()};
  tag.turn.sigma = of_turn.diagonal().cwiseMax(0).cwiseSqrt().reverse();
}

// What to do about one of the six, its value positive or negative.
struct Instruction {
  const char* positive;
  const char* negative;
};
constexpr std::array<Instruction, 6> kInstructions{
    {{"move it left by", "move it right by"},
     {"lower it by", "raise it by"},
     {"set it back by", "bring it out from the wall by"},
     {"turn it anticlockwise by", "turn it clockwise by"},
     {"press its right edge back by", "press its left edge back by"},
     {"tilt its top back by", "tilt its foot back by"}}};

// All corrections that are significant and large enough to be worth making; when none is
// significant by itself, those that are large enough.
std::string instruction(const HungTag& tag) {
  constexpr double kSurely = 3;         // standard deviations
  constexpr double kLeastMove = 0.002;  // metres
  constexpr double kLeastTurn = radians(0.5);
  std::vector<std::string> surely;
  std::vector<std::string> all;
  for (std::size_t i = 0; i < kInstructions.size(); ++i) {
    const bool is_move = i < 3;
    const Measured3& measured = is_move ? tag.offset : tag.turn;
    const auto axis = static_cast<Eigen::Index>(i % 3);
    const double value = measured.value[axis];
    if (std::abs(value) < (is_move ? kLeastMove : kLeastTurn)) continue;
    const char* words = value > 0 ? kInstructions[i].positive : kInstructions[i].negative;
    all.push_back(is_move ? fmt::format("{} {:.0f} mm", words, 1e3 * std::abs(value))
                          : fmt::format("{} {:.1f} degrees", words, degrees(std::abs(value))));
    if (std::abs(value) > kSurely * measured.sigma[axis]) surely.push_back(all.back());
  }
  return fmt::format("{}", fmt::join(surely.empty() ? all : surely, ", "));
}

std::string millimetres(double metres) { return fmt::format("{:.0f} mm", 1e3 * metres); }

Pose hung_pose(const SightedPlate& plate, const PlateOffset& offset) {
  Pose pose = plate.world_from_plate;
  pose.translation += offset.shift;
  pose.rotation *= rotation_of(offset.turn);
  return pose;
}

// The tag in whose place the pose is: a plate's gap or a hand away, much less than a plate.
const PlacedTag* place_of(const Survey& survey, const Pose& pose) {
  constexpr double kNear = 0.1;   // metres
  constexpr double kAlike = 0.4;  // radians
  for (const PlacedTag& tag : survey.tags) {
    const bool near_to = (tag.world_from_plate.translation - pose.translation).norm() < kNear;
    if (near_to && angle_between(tag.world_from_plate.rotation, pose.rotation) < kAlike) {
      return &tag;
    }
  }
  return nullptr;
}

// True when the plate stands on its head in its place.
bool is_upside_down(const SightedPlate& plate, const Pose& pose) {
  constexpr double kMost = 0.5;  // radians from half a turn
  const Eigen::Matrix3d half_turn =
      plate.world_from_plate.rotation * Vector3d(-1, -1, 1).asDiagonal();
  return angle_between(half_turn, pose.rotation) < kMost;
}

bool is_on_other_wall(const Survey& survey, const PlacedTag& tag, const Pose& pose) {
  const CenterlineAddress address = survey.tunnel.centerline.locate(pose.translation.head<2>());
  const double side = tag.side == Side::left ? -1 : 1;
  const Side other = tag.side == Side::left ? Side::right : Side::left;
  return side * address.offset < -wall_distance(survey.tunnel, other, address.chainage) / 2;
}

std::string frame_of(const FrameScale& scale) {
  return fmt::format(
      "a frame of {:.1f} % of the template's size (here errors of {:.1f} % and more can be seen)",
      100 * scale.share, 100 * scale.least);
}

// The plate's entry in `placed`, were it to stay where it hangs.
std::string entry_of(const Survey& survey, const PlacedTag& tag, const Pose& pose,
                     const PlateOffset& offset) {
  const Eigen::Matrix3d of_shift = offset.covariance.topLeftCorner<3, 3>();
  return placed_entry(
      survey, {tag.name, grid_from_world(survey.grid, pose.translation),
               attitude_of(survey.grid, pose), std::sqrt(std::max(0.0, of_shift.trace() / 3)), ""});
}

// Names what is wrong with a plate that is off.
void name_mistake(const Survey& survey, const SightedPlate& plate, const PlateCheck& check,
                  HungTag& tag) {
  const PlacedTag& surveyed = *find_tag(survey, tag.tag);
  const Pose pose = hung_pose(plate, *check.offset);
  if (const PlacedTag* other = place_of(survey, pose); other != nullptr && other != &surveyed) {
    tag.rule = other->side != surveyed.side ? "wrong-wall" : "swapped";
    tag.message =
        fmt::format("{} hangs in the place of {}: hang it where the setting-out list says", tag.tag,
                    other->name);
  } else if (is_upside_down(plate, pose)) {
    tag.rule = "upside-down";
    tag.message = fmt::format(
        "{} hangs upside down against the tags seen with it, or is a mirrored print: turn it by "
        "180 "
        "degrees",
        tag.tag);
  } else if (is_on_other_wall(survey, surveyed, pose)) {
    tag.rule = "wrong-wall";
    tag.message = fmt::format("{} hangs on the {} wall, expected on the {}", tag.tag,
                              to_string(surveyed.side == Side::left ? Side::right : Side::left),
                              to_string(surveyed.side));
  } else if (check.scale && check.scale->cause == FrameScale::Cause::size) {
    tag.rule = "wrong-scale";
    tag.message = fmt::format("{} in its surveyed place has {}: measure the frame", tag.tag,
                              frame_of(*check.scale));
  } else if (check.scale && check.scale->cause == FrameScale::Cause::size_or_place) {
    tag.rule = "wrong-scale";
    tag.message = fmt::format(
        "{} in its surveyed place has {} (printed to fit a page?), or it hangs elsewhere: measure "
        "the frame; if its size is right, {}",
        tag.tag, frame_of(*check.scale), instruction(tag));
  } else {
    tag.rule = "moved";
    tag.message = fmt::format("{} hangs {} from its surveyed place: {}", tag.tag,
                              millimetres(farthest_corner(plate, *check.offset)), instruction(tag));
    if (check.scale) {
      tag.message += fmt::format("; and it has {}: measure the frame", frame_of(*check.scale));
    }
    if (check.verdict == HangVerdict::off) {
      tag.placed = entry_of(survey, surveyed, pose, *check.offset);
    }
  }
}

// What the message of a doubtful tag that has no rivals ends with.
std::string uncertainty(HangDoubt doubt) {
  switch (doubt) {
    case HangDoubt::row:
      return ". Not certain: photos that were not taken together, or a second copy of one of the "
             "tags "
             "in them, would explain it, too";
    case HangDoubt::rig:
      return ". Not certain: another calibration of the rig, or frames that are all of another "
             "size, would explain it, too";
    case HangDoubt::block:
      return ". Not certain: a slip in the tape or the traverse, from which on all plates hang "
             "elsewhere, would explain it, too: measure the distance to the next plates on either "
             "side";
    case HangDoubt::rest:
      return ". Not certain: too few tags beyond doubt were seen with it. Photograph it once more "
             "together with two others";
    case HangDoubt::none:
    case HangDoubt::rivals:
      break;
  }
  return {};
}

HungTag hung_tag(const Survey& survey, const AdjustmentProblem& problem, std::size_t index,
                 const PlateCheck& check) {
  const SightedPlate& plate = problem.plates[index];
  HungTag tag;
  tag.tag = plate.name;
  tag.verdict = check.verdict;
  tag.stations = check.stations;
  if (check.verdict == HangVerdict::off) {
    constexpr double kMostOdds = 99;
    tag.odds = std::min(kMostOdds, check.log_odds * std::numbers::log10e);
  }
  for (const std::size_t rival : check.rivals) tag.rivals.push_back(problem.plates[rival].name);
  if (!check.offset) {
    if (check.verdict != HangVerdict::doubtful) return tag;
    tag.rule = "contradiction";
    tag.message = tag.tag + " contradicts tags seen with it" + uncertainty(check.doubt);
    return tag;
  }
  if (!check.swapped_with) measure(plate, *check.offset, tag);
  if (check.swapped_with) {
    const std::string& other = problem.plates[*check.swapped_with].name;
    tag.rule = "swapped";
    tag.message =
        fmt::format("{} and {} hang in each other's place: exchange them", tag.tag, other);
  } else if (check.verdict == HangVerdict::off || check.verdict == HangVerdict::doubtful) {
    name_mistake(survey, plate, check, tag);
  }
  tag.message += uncertainty(check.doubt);
  return tag;
}

// What to do about a doubtful tag, were it the one.
std::string cure(const AdjustmentProblem& problem, const HungTag& tag, const PlateCheck& check) {
  if (check.swapped_with) {
    return fmt::format("if it is {}, exchange it with {}", tag.tag,
                       problem.plates[*check.swapped_with].name);
  }
  if (!check.scale) return fmt::format("if it is {}, {}", tag.tag, instruction(tag));
  const std::string frame = frame_of(*check.scale);
  switch (check.scale->cause) {
    case FrameScale::Cause::size:
      return fmt::format("if it is {}, it has {}", tag.tag, frame);
    case FrameScale::Cause::size_and_place:
      return fmt::format("if it is {}, {}, and it has {}", tag.tag, instruction(tag), frame);
    case FrameScale::Cause::size_or_place:
      break;
  }
  return fmt::format("if it is {}, {}, unless it has {}", tag.tag, instruction(tag), frame);
}

// By how much the plate would be turned in its place, radians.
double turn_of(const PlateCheck& check) { return check.offset->turn.norm(); }

// "A photo of 001L together with 002L would tell": the nearest tag that is not in question.
std::string deciding_photo(const Survey& survey, const HungTag& tag,
                           const std::vector<HungTag>& tags) {
  const Vector3d here = find_tag(survey, tag.tag)->world_from_plate.translation;
  const auto in_question = [&](const std::string& name) {
    const auto hung = std::ranges::find(tags, name, &HungTag::tag);
    return name == tag.tag || (hung != tags.end() && (hung->verdict == HangVerdict::off ||
                                                      hung->verdict == HangVerdict::doubtful));
  };
  const PlacedTag* nearest = nullptr;
  const auto distance = [&](const PlacedTag& other) {
    return (other.world_from_plate.translation - here).norm();
  };
  for (const PlacedTag& other : survey.tags) {
    if (in_question(other.name)) continue;
    if (nearest == nullptr || distance(other) < distance(*nearest)) nearest = &other;
  }
  if (nearest == nullptr) return {};
  return fmt::format(". A photo of {} together with {} would tell", tag.tag, nearest->name);
}

// Of tags one of which hangs wrong: what to do about each, were it the one; or what is likelier
// where that is out of question. The rivals of a doubtful tag are doubtful, too.
void name_doubts(const Survey& survey, const AdjustmentProblem& problem, const Consensus& consensus,
                 std::vector<HungTag>& tags) {
  constexpr double kMostTurned = 1;  // radians
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const PlateCheck& check = consensus.plates[i];
    if (check.doubt != HangDoubt::rivals) continue;
    double least_turn = turn_of(check);
    double apart = farthest_corner(problem.plates[i], *check.offset);
    for (const std::size_t rival : check.rivals) {
      const PlateCheck& other = consensus.plates[rival];
      least_turn = std::min(least_turn, turn_of(other));
      apart = std::max(apart, farthest_corner(problem.plates[rival], *other.offset));
    }
    tags[i].rule = "contradiction";
    const std::string what = fmt::format("{} and {} do not fit together by {}", tags[i].tag,
                                         fmt::join(tags[i].rivals, ", "), millimetres(apart));
    if (least_turn > kMostTurned) {
      tags[i].message = fmt::format(
          "{}: whichever hangs wrong would be turned by {:.0f} degrees and more, as no plate hangs "
          "on a "
          "wall. Are the photos of the cameras exchanged, or were they not taken together?",
          what, degrees(least_turn));
      continue;
    }
    std::string cures = cure(problem, tags[i], check);
    bool by_size = check.scale.has_value();
    for (const std::size_t rival : check.rivals) {
      cures += "; " + cure(problem, tags[rival], consensus.plates[rival]);
      by_size = by_size || consensus.plates[rival].scale;
    }
    tags[i].message = fmt::format(
        "{}: one of them hangs wrong, and no other tag in view tells which. Measure them{}: {}{}",
        what, by_size ? ", and their frames" : "", cures, deciding_photo(survey, tags[i], tags));
  }
}

// "a second copy of 001R in the place of 002R"; empty when no tag's place is free for the plate.
std::string suspicion(const Survey& survey, const AdjustmentProblem& problem,
                      const Consensus& consensus, const LeftOutStation& station,
                      const LeftOutStation::Suspect& suspect) {
  if (!suspect.world_from_plate) return {};
  const PlacedTag* place = place_of(survey, *suspect.world_from_plate);
  const std::string& name = problem.plates[suspect.plate].name;
  const PlateCheck& check = consensus.plates[suspect.plate];
  if (place != nullptr && place->name == name && check.verdict == HangVerdict::doubtful) {
    return fmt::format("a second copy of {}: here one hangs in its place, elsewhere one does not",
                       name);
  }
  if (place == nullptr || std::ranges::any_of(station.suspects, [&](const auto& seen) {
        return problem.plates[seen.plate].name == place->name;
      })) {
    return {};
  }
  return fmt::format("{}{} in the place of {}", check.stations > 0 ? "a second copy of " : "", name,
                     place->name);
}

UnplacedTags unplaced_tags(const Survey& survey, const AdjustmentProblem& problem,
                           const Consensus& consensus, const LeftOutStation& station) {
  std::vector<std::string> names;
  std::vector<std::string> causes;
  for (const LeftOutStation::Suspect& suspect : station.suspects) {
    names.push_back(problem.plates[suspect.plate].name);
    std::string cause = suspicion(survey, problem, consensus, station, suspect);
    if (!cause.empty()) causes.push_back(std::move(cause));
  }
  if (station.fits_apart) causes.push_back("photos that were not taken together");
  constexpr std::size_t kSeldom = 3;  // stations: no more are mixed up by chance
  if (causes.empty() || consensus.left_out.size() > kSeldom) {
    causes.push_back(
        "several plates that hang wrong, another rig, or a window before a camera that the rig was "
        "not calibrated with");
  }
  UnplacedTags unplaced{station.name, {}};
  for (const std::string& name : names) {
    HungTag tag;
    tag.tag = name;
    tag.verdict = HangVerdict::doubtful;
    std::ranges::remove_copy(names, std::back_inserter(tag.rivals), name);
    tag.rule = "no-common-place";
    tag.message = fmt::format(
        "{}: no place of the cameras explains {} together; this would: {}. Left out of where tags "
        "hang",
        station.name, fmt::join(names, " and "), fmt::join(causes, "; or "));
    unplaced.tags.push_back(std::move(tag));
  }
  return unplaced;
}

// The unseen plate in whose place a plate hangs, by the plates of its station that hang as
// surveyed; null where most of them know of none.
const SightedPlate* place_by_neighbours(const AdjustmentProblem& problem, const Station& station,
                                        Sighting unknown, const std::vector<bool>& fits) {
  constexpr double kNear = 0.3;  // frame diagonals
  AdjustmentProblem asked{problem.rig, problem.plates, {}};
  asked.plates.emplace_back();
  unknown.plate = problem.plates.size();
  for (const SightedPlate& place : problem.unseen) {
    asked.plates.back() = place;
    int agreed = 0;
    for (const Sighting& seen : station.sightings) {
      if (!fits[seen.plate]) continue;
      agreed += mismatch(asked, seen, unknown) < kNear ? 1 : -1;
    }
    if (agreed > 0) return &place;
  }
  return nullptr;
}

std::vector<UnknownTag> find_unknown_tags(const Survey& survey, const AdjustmentProblem& problem,
                                          std::span<const SightedTag> sighted,
                                          const std::vector<HungTag>& tags) {
  std::vector<bool> fits;
  for (const HungTag& tag : tags) {
    fits.push_back(tag.verdict == HangVerdict::fits || tag.verdict == HangVerdict::unchecked);
  }
  std::vector<UnknownTag> unknown_tags;
  for (const SightedTag& tag : sighted) {
    if (find_tag(survey, tag.tag) != nullptr) continue;
    const auto station = std::ranges::find(problem.stations, tag.station, &Station::name);
    if (station == problem.stations.end()) continue;
    const SightedPlate* place = place_by_neighbours(
        problem, *station, sighting_of(tag.seen, *problem.rig, tag.camera, 0), fits);
    if (place != nullptr) unknown_tags.push_back({tag.station, tag.tag, place->name});
  }
  return unknown_tags;
}

std::vector<UntiedPair> untied_pairs(const Survey& survey, const AdjustmentProblem& problem,
                                     const std::vector<HungTag>& tags) {
  std::vector<bool> fits;
  for (const HungTag& tag : tags) fits.push_back(tag.verdict == HangVerdict::fits);
  const std::vector<std::size_t> group = tied_groups(problem.stations, fits);
  std::vector<UntiedPair> untied;
  for (const Side side : {Side::left, Side::right}) {
    std::vector<std::pair<double, std::size_t>> wall;  // by chainage
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const PlacedTag* tag = find_tag(survey, tags[i].tag);
      if (tag->side == side && fits[i]) wall.emplace_back(tag->chainage, i);
    }
    std::ranges::sort(wall);
    for (std::size_t i = 1; i < wall.size(); ++i) {
      const std::size_t before = wall[i - 1].second, after = wall[i].second;
      if (group[before] != group[after]) untied.push_back({tags[before].tag, tags[after].tag});
    }
  }
  return untied;
}

// Tags of which every picture shows corners that no flat plate of the template has: nothing
// compares where these hang. Where most are so, rig or template are those of others, and none is
// named.
void name_not_flat(const AdjustmentProblem& problem, HungTags& hung) {
  std::vector<HungTag>& tags = hung.tags;
  enum Shape { unseen, flat, not_flat };
  std::vector<Shape> shapes(tags.size(), unseen);
  for (const Station& station : problem.stations) {
    for (Sighting sighting : station.sightings) {
      Shape& shape = shapes[sighting.plate];
      if (tags[sighting.plate].verdict != HangVerdict::unchecked || shape == flat) continue;
      shape = make_consistent(problem, sighting) ? flat : not_flat;
    }
  }
  const auto count = static_cast<std::size_t>(std::ranges::count(shapes, not_flat));
  if (count > 2 && 2 * count > tags.size()) hung.nothing_fits = true;
  if (hung.nothing_fits) return;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (shapes[i] != not_flat) continue;
    tags[i].verdict = HangVerdict::doubtful;
    tags[i].rule = "not-flat";
    tags[i].message = fmt::format(
        "{} is no flat plate of its template: no place of the camera explains its four corners. It "
        "is twisted or bent, something lies along an edge of its frame, or rig or template are "
        "those of others. Left out of where tags hang",
        tags[i].tag);
  }
}

// What to do about a second copy, in each of the stations that show it.
void add_copy(const AdjustmentProblem& problem, const FoundCopy& copy, HungTags& hung) {
  HungTag tag;
  tag.tag = problem.plates[copy.plate].name;
  const bool is_certain = copy.doubt == HangDoubt::none;
  tag.verdict = is_certain ? HangVerdict::off : HangVerdict::doubtful;
  tag.rule = "second-copy";
  tag.message = fmt::format(
      "a second copy of {0} hangs in the place of {1}: take it down and hang {1} there{2}", tag.tag,
      copy.place, uncertainty(copy.doubt));
  for (const std::string& station : copy.stations) {
    auto known = std::ranges::find(hung.unplaced, station, &UnplacedTags::station);
    if (known == hung.unplaced.end()) known = hung.unplaced.insert(known, {station, {}});
    known->tags.push_back(tag);
  }
}

}  // namespace

std::string to_string(HangVerdict verdict) {
  constexpr std::array<const char*, 4> kNames{"unchecked", "fits", "off", "doubtful"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::optional<std::string> untied_in_words(std::span<const UntiedPair> untied) {
  constexpr std::size_t kMostNamed = 3;
  if (untied.empty()) return std::nullopt;
  std::vector<std::string> pairs;
  for (const UntiedPair& pair : untied.first(std::min(untied.size(), kMostNamed))) {
    pairs.push_back(fmt::format("{} and {}", pair.before, pair.after));
  }
  const std::string more = untied.size() > kMostNamed
                               ? fmt::format(" ({} pairs of neighbours in all)", untied.size())
                               : "";
  return fmt::format(
      "no photo ties {}{}: all tags beyond may hang too far along by a slip of the tape, and none "
      "would tell. A photo that shows both of a pair would",
      fmt::join(pairs, ", nor "), more);
}

AdjustmentProblem problem_for(const Survey& survey, const Rig& rig,
                              std::span<const SightedTag> sighted) {
  std::set<std::string_view> seen;
  for (const SightedTag& tag : sighted) seen.insert(tag.tag);
  AdjustmentProblem problem;
  problem.rig = &rig;
  for (const PlacedTag& tag : survey.tags) {
    (seen.contains(tag.name) ? problem.plates : problem.unseen).push_back(plate_for(survey, tag));
  }
  std::map<std::string, std::size_t> plates;
  for (std::size_t i = 0; i < problem.plates.size(); ++i) plates[problem.plates[i].name] = i;
  std::map<std::string, std::size_t> stations;
  for (const SightedTag& tag : sighted) {
    const auto plate = plates.find(tag.tag);
    if (plate == plates.end()) continue;
    const auto [station, is_new] = stations.emplace(tag.station, problem.stations.size());
    if (is_new) problem.stations.push_back({tag.station, {}});
    problem.stations[station->second].sightings.push_back(
        sighting_of(tag.seen, rig, tag.camera, plate->second));
  }
  return problem;
}

void set_survey_sigma(SightedPlate& plate, double sigma, double angle_sigma) {
  plate.survey_variance.head<3>().setConstant(sigma * sigma);
  plate.survey_variance.tail<3>().setConstant(angle_sigma * angle_sigma);
}

std::optional<RigDoubt> rig_doubt(const Survey& survey, const Rig& rig,
                                  std::span<const SightedTag> sighted) {
  if (!stands_level(rig)) return std::nullopt;
  const auto suspicion = suspect_rig(rows_of(survey, rig, sighted), survey, rig);
  if (!suspicion) return std::nullopt;
  RigDoubt doubt{describe(*suspicion, rig), {}};
  if (std::ranges::all_of(suspicion->suspects, is_of_hanging)) {
    doubt.hung = with_plates_of(suspicion->suspects.front(), survey);
  }
  return doubt;
}

std::string in_words(const MixedStations& mixed, const Rig& rig) {
  return fmt::format(
      "{} and {} are mixed up: each has the other's photo of camera {}, or of all its other "
      "cameras",
      mixed.one, mixed.other, rig.cameras[mixed.camera].name);
}

HungTags check_hung_tags(const Survey& survey, const Rig& rig, std::span<const SightedTag> sighted,
                         double tolerance) {
  auto doubt = rig_doubt(survey, rig, sighted);
  if (!doubt) return hung_as_surveyed(survey, rig, sighted, tolerance);
  HungTags result;
  if (doubt->hung) {
    result = hung_as_surveyed(*doubt->hung, rig, sighted, tolerance);
    result.all_alike = std::move(doubt->text);
  } else {
    result.nothing_fits = true;
    result.rig_doubt = std::move(doubt->text);
  }
  return result;
}

HungTags hung_as_surveyed(const Survey& survey, const Rig& rig, std::span<const SightedTag> sighted,
                          double tolerance) {
  HungTags result;
  AdjustmentProblem problem = problem_for(survey, rig, sighted);
  Rig by_plates;  // outlives the problem
  if (!stands_level(rig)) {
    by_plates = calibrated_by_plates(problem);
    problem.rig = &by_plates;
  }
  take_scatter(survey, problem);
  const Consensus consensus = find_consensus(problem, tolerance);
  result.nothing_fits = consensus.nothing_fits;
  result.assumed = assumed_calibration(rig);
  if (auto sigma = assumed_sigma(survey)) {
    result.assumed.insert(result.assumed.begin(), std::move(*sigma));
  }
  for (std::size_t i = 0; i < problem.plates.size(); ++i) {
    result.tags.push_back(hung_tag(survey, problem, i, consensus.plates[i]));
  }
  name_doubts(survey, problem, consensus, result.tags);
  name_not_flat(problem, result);
  if (!result.nothing_fits) {
    result.unknown_tags = find_unknown_tags(survey, problem, sighted, result.tags);
    for (const LeftOutStation& station : consensus.left_out) {
      result.unplaced.push_back(unplaced_tags(survey, problem, consensus, station));
    }
  }
  for (const FoundCopy& copy : consensus.copies) add_copy(problem, copy, result);
  result.mixed = consensus.mixed;
  if (!result.nothing_fits) result.untied = untied_pairs(survey, problem, result.tags);
  return result;
}

}  // namespace tagsmith::detail
