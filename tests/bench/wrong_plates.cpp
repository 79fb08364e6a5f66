// SPDX-License-Identifier: Apache-2.0
// Is an innocent plate accused when something else is wrong? Usage: bench_wrong_plates [N] [SEED]
// [KIND]
//
// N worlds of each kind of mistake: plates moved, exchanged, printed at another size, hung as
// second copies, by themselves and two at once; another calibration or template than stated; photos
// of two rows exchanged. Each is seen from ten places of the shipped corridor, by the shipped rig
// and by one of wide cameras in turn, as corners with their noise, and checked against the survey,
// whose places and angles are off by its standard deviations. Then the same by sixteen photos of a
// phone, whose focal length, centre and distortion are known by its equivalent focal length alone
// and change a little from photo to photo.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "decoder/localize/observation.hpp"
#include "decoder/plates/hung_tags.hpp"
#include "decoder/verify/lens_cameras.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/support/wide_corridor.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

double normal(Random& random, double sigma) {
  return sigma * std::normal_distribution<double>()(random);
}

Vector3d normals(Random& random, double sigma) {
  const double x = normal(random, sigma);
  const double y = normal(random, sigma);
  return {x, y, normal(random, sigma)};
}

Eigen::Matrix3d turned(const Vector3d& turn) {
  return Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
}

// A plate as it hangs: `tag` is what it says, by its place in the survey.
struct Plate {
  std::size_t tag = 0;
  Pose world_from_plate;
  double size = 1;
};

struct World {
  Survey survey;  // as told to the check
  Rig rig;        // likewise
  Rig true_rig;
  std::vector<Plate> plates;
  std::vector<VehiclePose> rows;
  std::vector<Camera> phones;       // by row: the lens as it was then; empty = the rig's cameras
  std::set<std::size_t> wrong;      // tags of which something is wrong
  std::set<std::size_t> exchanged;  // of these, in another's place, and that in theirs
  std::map<std::size_t, std::size_t> copies;  // a second copy hangs in the place of another
  std::pair<std::size_t, std::size_t>
      mixed;  // rows whose photos of the second camera are exchanged
};

World right_world(int number, Random& random) {
  test::WideCorridor corridor;
  World world;
  world.survey = corridor.survey;
  world.rig = number % 2 == 0 ? corridor.rig : load_rig("surveys/corridor/rig.yaml").value();
  world.true_rig = world.rig;
  for (std::size_t i = 0; i < world.survey.tags.size(); ++i) {
    Pose& pose = world.survey.tags[i].world_from_plate;
    world.plates.push_back({i, pose, 1});
    pose.translation += normals(random, world.survey.sigma);
    pose.rotation *= turned(normals(random, radians(0.1)));
  }
  for (int row = 0; row < 10; ++row) {
    VehiclePose vehicle;
    vehicle.position = world_from_grid(
        world.survey.grid,
        {0.95 + normal(random, 0.1), -0.8 + 0.65 * row + uniform(random, -0.2, 0.2), 0.24});
    vehicle.heading = world_heading_from_grid(world.survey.grid, normal(random, radians(3)));
    vehicle.pitch = normal(random, radians(1));
    vehicle.roll = normal(random, radians(1));
    world.rows.push_back(vehicle);
  }
  return world;
}

// A person who holds a phone any way and aims at a place between plates of a wall.
VehiclePose person(const World& world, Random& random) {
  const double x = uniform(random, 0, 1) < 0.5 ? 0 : 1.9;
  const Vector3d target =
      world_from_grid(world.survey.grid, {x, uniform(random, 0.4, 6), uniform(random, 0.2, 0.9)});
  const Vector3d eye =
      world_from_grid(world.survey.grid, {x > 0 ? 0.4 : 1.5, uniform(random, -0.5, 7), 1.4});
  Pose held;
  held.translation = eye;
  held.rotation.col(0) = (target - eye).normalized();
  held.rotation.col(1) = Vector3d::UnitZ().cross(held.rotation.col(0)).normalized();
  held.rotation.col(2) = held.rotation.col(0).cross(held.rotation.col(1));
  const double roll = normal(random, radians(5)) + (uniform(random, 0, 1) < 0.3 ? radians(90) : 0);
  held.rotation *= turned({roll, 0, 0});
  return vehicle_pose_of(held);
}

// The world as a phone sees it.
World phone_world(int number, Random& random) {
  constexpr int kPhotos = 16;
  World world = right_world(number, random);
  RigCamera camera = camera_by_lens(4000, 3000, 26);
  camera.name = "phone";
  world.rig.cameras = {camera};
  world.rig.roll_sigma = world.rig.pitch_sigma = std::numbers::pi;
  Camera& lens = camera.camera;
  lens.fx = lens.fy = lens.fx * (1 + normal(random, 0.04));
  lens.cx += normal(random, 30);
  lens.cy += normal(random, 30);
  lens.distortion = {normal(random, 0.02), normal(random, 0.01), normal(random, 3e-4),
                     normal(random, 3e-4)};
  world.true_rig = world.rig;
  world.true_rig.cameras = {camera};
  world.rows.clear();
  for (int photo = 0; photo < kPhotos; ++photo) {
    world.rows.push_back(person(world, random));
    Camera& now = world.phones.emplace_back(lens);
    now.fx = now.fy = now.fx * (1 + normal(random, 0.005));
    now.cx += normal(random, 10);
    now.cy += normal(random, 10);
  }
  return world;
}

// --- mistakes ---

std::size_t any_tag(const World& world, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, world.survey.tags.size() - 1)(random);
}

// A tag of which nothing is wrong yet.
std::size_t other_tag(const World& world, Random& random) {
  std::size_t tag = any_tag(world, random);
  while (world.wrong.contains(tag)) tag = any_tag(world, random);
  return tag;
}

void move_by(World& world, double metres, Random& random) {
  const std::size_t tag = other_tag(world, random);
  Pose& pose = world.plates[tag].world_from_plate;
  pose.translation += metres * normals(random, 1).normalized();
  pose.rotation *= turned(normals(random, radians(2)));
  world.wrong.insert(tag);
}

void move(World& world, Random& random) {
  move_by(world, std::exp(uniform(random, std::log(0.03), std::log(0.5))), random);
}

void move_little(World& world, Random& random) { move_by(world, 0.02, random); }

void print_at(World& world, double size, Random& random) {
  const std::size_t tag = other_tag(world, random);
  world.plates[tag].size = size;
  world.wrong.insert(tag);
}

void print_small(World& world, Random& random) { print_at(world, 0.95, random); }

void print_anyhow(World& world, Random& random) {
  print_at(world, uniform(random, 0.9, 0.98), random);
}

void exchange(World& world, Random& random) {
  const std::size_t one = other_tag(world, random);
  world.wrong.insert(one);
  const std::size_t other = other_tag(world, random);
  world.wrong.insert(other);
  std::swap(world.plates[one].world_from_plate, world.plates[other].world_from_plate);
  world.exchanged.insert({one, other});
}

// A plate hangs where it should, and a copy of it in the place of another, which is missing.
void copy(World& world, Random& random) {
  const std::size_t one = other_tag(world, random);
  world.wrong.insert(one);
  const std::size_t other = other_tag(world, random);
  world.wrong.insert(other);
  world.plates[other].tag = one;
  world.copies[one] = other;
}

void exchange_and_copy(World& world, Random& random) {
  exchange(world, random);
  copy(world, random);
}

// One camera looks elsewhere than stated.
template <int kDegrees>
void turn_camera(World& world, Random& random) {
  RigCamera& camera = world.true_rig.cameras[0];
  camera.vehicle_from_camera.rotation *=
      turned(radians(kDegrees) * normals(random, 1).normalized());
}

template <int kPercent>
void change_focus(World& world, Random& random) {
  const double by = 1 + (uniform(random, 0, 1) < 0.5 ? 0.01 : -0.01) * kPercent;
  for (RigCamera& camera : world.true_rig.cameras) {
    camera.camera.fx *= by;
    camera.camera.fy *= by;
  }
}

void change_template(World& world, Random& random) {
  const double by = uniform(random, 0, 1) < 0.5 ? 1.05 : 0.95;
  for (Plate& plate : world.plates) plate.size *= by;
}

void mix_rows(World& world, Random& random) {
  const auto row = [&] {
    return std::uniform_int_distribution<std::size_t>(0, world.rows.size() - 1)(random);
  };
  world.mixed.first = row();
  do world.mixed.second = row();
  while (world.mixed.second == world.mixed.first);
}

using Mistake = void (*)(World&, Random&);

void two_mistakes(World& world, Random& random) {
  constexpr std::array<Mistake, 5> kAny{move, print_anyhow, exchange, copy, mix_rows};
  for (int i = 0; i < 2; ++i) {
    kAny[std::uniform_int_distribution<std::size_t>(0, kAny.size() - 1)(random)](world, random);
  }
}

// --- pictures ---

bool in_view(const SightingRows& rows, const Camera& camera) {
  const auto& pixels = rows.predicted;
  const double size = (pixels.head<2>() - pixels.segment<2>(4)).norm();
  const Eigen::Vector2d right = pixels.segment<2>(2) - pixels.head<2>();
  const Eigen::Vector2d down = pixels.segment<2>(6) - pixels.head<2>();
  if (size < 60 || right.x() * down.y() <= right.y() * down.x()) return false;
  for (Eigen::Index i = 0; i < kSightingRows; i += 2) {
    if (pixels[i] < 0 || pixels[i] > camera.width || pixels[i + 1] < 0 ||
        pixels[i + 1] > camera.height) {
      return false;
    }
  }
  return true;
}

std::string row_of(const World& world, std::size_t row, std::size_t camera) {
  const auto [a, b] = world.mixed;
  if (camera > 0 && a != b && (row == a || row == b)) row = a + b - row;
  return fmt::format("row {}", row);
}

struct Sighting {
  SightedTag tag;
  std::size_t plate = 0;  // of World::plates
};

void photograph(const World& world, std::size_t row, std::size_t camera, Random& random,
                std::vector<Sighting>& sighted) {
  constexpr double kNoise = 0.15;  // pixels
  Rig rig = world.true_rig;
  if (!world.phones.empty()) rig.cameras[camera].camera = world.phones[row];
  std::vector<Sighting> seen;
  for (const Plate& hung : world.plates) {
    SightedPlate plate = sighted_plate(world.survey.tags[hung.tag], world.survey);
    plate.world_from_plate = hung.world_from_plate;
    plate.world_from_plate.translation += plate.world_from_plate.rotation * (1 - hung.size) / 2 *
                                          Vector3d(plate.length, plate.height, 0);
    plate.length *= hung.size;
    plate.height *= hung.size;
    const auto rows = sighting_rows(rig, calibration_layout(rig), {},
                                    vehicle_frame(world.rows[row]), plate, camera);
    if (!rows || !in_view(*rows, rig.cameras[camera].camera)) continue;
    SightedTag tag{row_of(world, row, camera), camera, world.survey.tags[hung.tag].name, {}};
    for (std::size_t c = 0; c < 4; ++c) {
      const auto at = static_cast<Eigen::Index>(2 * c);
      tag.seen.corners[c] = {rows->predicted[at] + normal(random, kNoise),
                             rows->predicted[at + 1] + normal(random, kNoise)};
    }
    tag.seen.covariance = kNoise * kNoise * CornerCovariance::Identity();
    seen.push_back({tag, static_cast<std::size_t>(&hung - world.plates.data())});
  }
  // Of two copies in one picture verify tells by itself.
  const auto code = [](const Sighting& s) { return s.tag.tag; };
  std::ranges::copy_if(seen, std::back_inserter(sighted), [&](const Sighting& sighting) {
    return std::ranges::count(seen, sighting.tag.tag, code) == 1;
  });
}

// --- what was said ---

struct Tally {
  int worlds = 0;
  int silent = 0;  // something wrong, and nothing said of it
  int nothing_fits = 0;
  int wrong = 0;  // tags with something wrong, checked
  int named = 0;  // of these
  int doubted = 0;
  int missed = 0;
  int misstated = 0;  // named, and what is said of them is not so
  int decidable = 0;  // wrong tags of which the pictures tell (decidable_tags)
  int decided = 0;    // of these: named
  int innocent = 0;   // other tags, checked
  int accused = 0;    // of these
  int innocent_doubted = 0;
  // Of the offsets of innocent tags: the greatest stated standard deviation, millimetres, and
  // squared errors in units of the stated ones, by coordinate.
  std::vector<double> sigmas;
  double squares = 0;
};

// Where the tag is, less where the survey has it, as HungTag tells it.
Vector3d true_offset(const World& world, std::size_t tag) {
  const Pose& surveyed = world.survey.tags[tag].world_from_plate;
  const auto plate = std::ranges::find(world.plates, tag, &Plate::tag);
  const Vector3d shift =
      surveyed.rotation.transpose() * (plate->world_from_plate.translation - surveyed.translation);
  return {shift.x(), -shift.y(), -shift.z()};
}

void count_offset(const World& world, std::size_t tag, const Measured3& offset, Tally& tally) {
  if (offset.sigma.minCoeff() <= 0) return;
  tally.sigmas.push_back(1e3 * offset.sigma.maxCoeff());
  const Vector3d error = (offset.value - true_offset(world, tag)).cwiseQuotient(offset.sigma);
  tally.squares += error.squaredNorm() / 3;
}

// True when some copy of the plate hangs where the tag is said to, or is of another size and so
// said.
bool is_so(const World& world, std::size_t tag, const HungTag& said) {
  if (said.rule == "second-copy") {
    const auto copy = world.copies.find(tag);
    return copy != world.copies.end() &&
           said.message.find(world.survey.tags[copy->second].name) != std::string::npos;
  }
  if (said.offset.sigma.isZero()) return world.exchanged.contains(tag);
  const Pose& surveyed = world.survey.tags[tag].world_from_plate;
  for (const Plate& plate : world.plates) {
    if (plate.tag != tag) continue;
    if (plate.size != 1) return said.rule == "wrong-scale";
    const Vector3d shift =
        surveyed.rotation.transpose() * (plate.world_from_plate.translation - surveyed.translation);
    const Vector3d error = said.offset.value - Vector3d(shift.x(), -shift.y(), -shift.z());
    const Vector3d most = 5 * said.offset.sigma + Vector3d::Constant(0.01);
    if ((error.cwiseAbs() - most).maxCoeff() < 0) return true;
  }
  return false;
}

// Wrong tags of which the pictures tell: a row shows the plate that is wrong (of a second copy the
// copy, not the original) together with two others of which nothing is wrong. These agree on where
// the cameras were, so it is told which of three does not fit. One of the two has to be in the same
// photo, or a second row has to show the same: else photos that were not taken together explain it.
std::set<std::string> decidable_tags(const World& world, const std::vector<Sighting>& sighted) {
  std::map<std::string, std::set<std::size_t>> rows;
  std::map<std::pair<std::string, std::size_t>, std::set<std::size_t>> photos;
  for (const auto& [seen, plate] : sighted) {
    rows[seen.station].insert(plate);
    photos[{seen.station, seen.camera}].insert(plate);
  }
  const auto right_ones = [&](const std::set<std::size_t>& plates) {
    return std::ranges::count_if(
        plates, [&](std::size_t plate) { return !world.wrong.contains(world.plates[plate].tag); });
  };
  std::map<std::size_t, std::set<std::string>> told;  // the rows that tell of the plate
  std::set<std::size_t> certain;
  for (const auto& [photo, plates] : photos) {
    if (right_ones(rows[photo.first]) < 2) continue;
    for (const std::size_t plate : plates) {
      told[plate].insert(photo.first);
      if (right_ones(plates) > 0 || told[plate].size() > 1) certain.insert(plate);
    }
  }
  std::set<std::string> decidable;
  for (const std::size_t plate : certain) {
    const std::size_t tag = world.plates[plate].tag;
    const auto copy = world.copies.find(tag);
    const bool is_wrong = copy == world.copies.end() || copy->second == plate;
    if (is_wrong) decidable.insert(world.survey.tags[tag].name);
  }
  return decidable;
}

// What is wrong of it goes to standard error, with the world.
void count(const World& world, const std::set<std::string>& decidable, const HungTags& found,
           const std::string& what, Tally& tally) {
  ++tally.worlds;
  bool told = found.nothing_fits || !found.unplaced.empty() || !found.mixed.empty();
  std::set<std::string> in_unplaced;
  std::map<std::string, HungTag> copies;
  for (const UnplacedTags& photos : found.unplaced) {
    for (const HungTag& tag : photos.tags) {
      in_unplaced.insert(tag.tag);
      if (tag.verdict == HangVerdict::off) copies[tag.tag] = tag;
    }
  }
  if (world.wrong.empty()) {
    for (const UnplacedTags& photos : found.unplaced) {
      fmt::print(stderr, "{}: left out: {}\n", what, photos.tags.front().message);
    }
  }
  tally.nothing_fits += found.nothing_fits ? 1 : 0;
  for (const HungTag& judged : found.tags) {
    const auto copy = copies.find(judged.tag);
    const HungTag& tag = copy == copies.end() ? judged : copy->second;
    const auto index =
        static_cast<std::size_t>(find_tag(world.survey, tag.tag) - world.survey.tags.data());
    const bool off = tag.verdict == HangVerdict::off;
    const bool doubted = tag.verdict == HangVerdict::doubtful ||
                         (!off && (in_unplaced.contains(tag.tag) || found.nothing_fits));
    told = told || off || doubted;
    if (world.wrong.empty() && tag.verdict == HangVerdict::doubtful) {
      fmt::print(stderr, "{}: doubtful: {}\n", what, tag.message);
    }
    if (tag.verdict == HangVerdict::unchecked && !doubted) continue;
    if (world.wrong.contains(index)) {
      ++tally.wrong;
      tally.named += off ? 1 : 0;
      tally.doubted += doubted ? 1 : 0;
      tally.missed += off || doubted ? 0 : 1;
      tally.decidable += decidable.contains(tag.tag) ? 1 : 0;
      tally.decided += off && decidable.contains(tag.tag) ? 1 : 0;
      if (off && !is_so(world, index, tag)) {
        ++tally.misstated;
        fmt::print(stderr, "{}: misstated: {}\n", what, tag.message);
      }
    } else {
      ++tally.innocent;
      if (tag.verdict == HangVerdict::fits) count_offset(world, index, tag.offset, tally);
      if (off) {
        ++tally.accused;
        fmt::print(stderr, "{}: accused: {}\n", what, tag.message);
      }
      tally.innocent_doubted += doubted ? 1 : 0;
    }
  }
  tally.silent += told ? 0 : 1;
  fmt::print(stderr, "{}: told {} nothing fits {}\n", what, told, found.nothing_fits);
}

struct Kind {
  const char* name;
  Mistake mistake;
  bool by_phone = false;
};

void nothing_wrong(World&, Random&) {}

void measure(const Kind& kind, int worlds, std::uint64_t seed) {
  Tally tally;
  for (int number = 0; number < worlds; ++number) {
    Random random(1'000'003 * seed + static_cast<std::uint64_t>(number));
    World world = kind.by_phone ? phone_world(number, random) : right_world(number, random);
    kind.mistake(world, random);
    std::vector<Sighting> sighted;
    for (std::size_t row = 0; row < world.rows.size(); ++row) {
      for (std::size_t camera = 0; camera < world.rig.cameras.size(); ++camera) {
        photograph(world, row, camera, random, sighted);
      }
    }
    std::vector<SightedTag> tags;
    std::ranges::transform(sighted, std::back_inserter(tags), &Sighting::tag);
    count(world, decidable_tags(world, sighted), check_hung_tags(world.survey, world.rig, tags),
          fmt::format("{}, world {}", kind.name, number), tally);
  }
  fmt::print(
      "| {} | {} | {} | {} | {} of {} | {} of {} | {} | {} | {} | {} of {} | {} | {:.1f} | {:.2f} "
      "|\n",
      kind.name, tally.worlds, tally.silent, tally.nothing_fits, tally.named, tally.wrong,
      tally.decided, tally.decidable, tally.doubted, tally.missed, tally.misstated, tally.accused,
      tally.innocent, tally.innocent_doubted,
      tally.sigmas.empty() ? 0 : quantile(tally.sigmas, 0.5),
      tally.squares / std::max<double>(1, static_cast<double>(tally.sigmas.size())));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int worlds = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  fmt::print(
      "| what is wrong | worlds | nothing said | nothing fits | wrong tags named | of those "
      "of which the pictures tell | doubtful | missed | named, misstated | innocent tags accused | "
      "doubtful | offset's sigma, mm | NEES |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const std::string only = argc > 3 ? argv[3] : "";  // of the kinds whose names have this
  for (const Kind& kind : {Kind{"nothing", nothing_wrong},
                           Kind{"one plate moved, 3 to 50 cm", move},
                           Kind{"one plate moved by 20 mm", move_little},
                           Kind{"one printed at 95 %", print_small},
                           Kind{"two exchanged", exchange},
                           Kind{"a second copy in another's place", copy},
                           Kind{"exchange and second copy", exchange_and_copy},
                           Kind{"one camera turned by 3 degrees", turn_camera<3>},
                           Kind{"one camera turned by 1 degree", turn_camera<1>},
                           Kind{"focal lengths 5 % off", change_focus<5>},
                           Kind{"focal lengths 2 % off", change_focus<2>},
                           Kind{"template 5 % off", change_template},
                           Kind{"photos of two rows exchanged", mix_rows},
                           Kind{"two of these at once", two_mistakes},
                           Kind{"phone: nothing", nothing_wrong, true},
                           Kind{"phone: one plate moved, 3 to 50 cm", move, true},
                           Kind{"phone: one printed at 95 %", print_small, true},
                           Kind{"phone: two exchanged", exchange, true},
                           Kind{"phone: a second copy in another's place", copy, true},
                           Kind{"phone: template 5 % off", change_template, true}}) {
    if (std::string(kind.name).find(only) != std::string::npos) measure(kind, worlds, seed);
  }
  return 0;
}
