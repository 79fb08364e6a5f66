// SPDX-License-Identifier: Apache-2.0
// Positions where the world is not as rig, survey and photos say: is a wrong one ever stated as
// sure? Usage: bench_wrong_world [N] [SEED] [--list]
//
// Each draw stands the vehicle in a shipped survey whose rig is calibrated with care or has the
// standard deviations of an unstated calibration, makes one mistake (three in ten: two), small to
// gross, in what really is, and locates with what is believed. Counted are positions that are more
// than five standard deviations off, and of these the ones whose list of what nothing checks
// names none of the mistakes made. `--list` prints these.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/plates/plate_trials.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tests/bench/fix_trial.hpp"

using namespace tagsmith::detail;
using bench::Site;
using Eigen::Vector3d;
using test::Draws;

namespace {

// A plate that hangs there, and the tag that its code names.
struct HungPlate {
  PlacedTag tag;
  Pose world_from_plate;
  double size = 1;  // of the template's
};

// What really is.
struct World {
  Rig rig;
  TagTemplate tag_template;
  std::vector<HungPlate> plates;
  VehiclePose vehicle;
  std::vector<VehiclePose> vehicle_of_photo;  // a camera's each: where it stood when it took it
  std::vector<double> ranges;                 // a sensor's each, as measured
  double way = 0;      // metres driven while rolling shutters pass over an image
  double outward = 0;  // pixels by which all edges of frames move outward
};

double between(Draws& draws, double least, double most) {
  const double size = std::exp(draws.uniform(std::log(least), std::log(most)));
  return draws.chance(0.5) ? size : -size;
}

Vector3d direction(Draws& draws) { return draws.normals(1).normalized(); }

std::size_t any_camera(const World& world, Draws& draws) {
  return draws.index(world.rig.cameras.size());
}

HungPlate& any_plate(World& world, Draws& draws) {
  return world.plates[draws.index(world.plates.size())];
}

// A plate near the vehicle, so that the mistake is likely to be seen.
std::size_t near_plate(const World& world, Draws& draws) {
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < world.plates.size(); ++i) {
    const Vector3d away = world.plates[i].world_from_plate.translation - world.vehicle.position;
    if (away.norm() < 4) near.push_back(i);
  }
  return near.empty() ? draws.index(world.plates.size()) : near[draws.index(near.size())];
}

void turn_camera(RigCamera& camera, Draws& draws) {
  const Eigen::AngleAxisd turn(radians(between(draws, 0.1, 90)), direction(draws));
  camera.vehicle_from_camera.rotation *= turn.toRotationMatrix();
}

void set_focal(RigCamera& camera, double factor) {
  camera.camera.fx *= factor;
  camera.camera.fy *= factor;
}

VehiclePose drawn_elsewhere(const Site& site, Draws& draws) {
  return bench::random_pose(site, draws);
}

void turn_alphas(World& world, Draws& draws) {
  const double angle = radians(between(draws, 0.1, 45));
  for (RigCamera& camera : world.rig.cameras) {
    const double sign = camera.side == Side::left ? 1 : -1;
    camera.vehicle_from_camera.rotation =
        Eigen::AngleAxisd(sign * angle, Vector3d::UnitZ()).toRotationMatrix() *
        camera.vehicle_from_camera.rotation;
  }
}

void bend_lens(World& world, Draws& draws) {
  const double k1 = between(draws, 0.003, 0.3);
  for (RigCamera& camera : world.rig.cameras) camera.camera.distortion[0] = k1;
}

void move_survey(World& world, Draws& draws) {
  const Eigen::AngleAxisd turn(radians(between(draws, 0.05, 5)), Vector3d::UnitZ());
  const Vector3d shift = between(draws, 0.02, 5) * direction(draws);
  for (HungPlate& plate : world.plates) {
    plate.world_from_plate.rotation = turn * plate.world_from_plate.rotation;
    plate.world_from_plate.translation =
        turn.toRotationMatrix() * plate.world_from_plate.translation + shift;
  }
}

// A wall farther out than the survey says, with its plates.
void move_wall(World& world, Draws& draws) {
  const Side side = draws.chance(0.5) ? Side::left : Side::right;
  const double out = between(draws, 0.005, 0.5);
  for (HungPlate& plate : world.plates) {
    if (plate.tag.side != side) continue;
    plate.world_from_plate.translation += out * plate.world_from_plate.rotation.col(2);
  }
}

void shift_wall(World& world, Draws& draws) {
  const Side side = draws.chance(0.5) ? Side::left : Side::right;
  const Vector3d shift = between(draws, 0.005, 0.5) * direction(draws);
  for (HungPlate& plate : world.plates) {
    if (plate.tag.side == side) plate.world_from_plate.translation += shift;
  }
}

// Plates along the drive as another spacing hangs them, from the plate nearest to the vehicle on:
// that the whole row is shifted as well is the mistake of a survey moved as a whole.
void stretch_spacing(World& world, Draws& draws) {
  const double factor = between(draws, 0.005, 0.5);
  const double from = world.plates[near_plate(world, draws)].tag.chainage;
  for (HungPlate& plate : world.plates) {
    const double along = factor * (plate.tag.chainage - from);
    plate.world_from_plate.translation +=
        along * plate.world_from_plate.rotation.col(0) * (plate.tag.side == Side::left ? 1 : -1);
  }
}

void turn_plates(World& world, RigParameter how, double angle) {
  for (HungPlate& plate : world.plates) {
    plate.world_from_plate = turned_plate(plate.world_from_plate, plate.tag.side, how, angle);
  }
}

// Plates that follow a slope of the floor instead of hanging level.
void follow_slope(World& world, Draws& draws) {
  turn_plates(world, RigParameter::plate_slope, between(draws, 0.002, 0.15));
}

double lean(Draws& draws) { return radians(between(draws, 0.2, 20)); }

// One of the walls alone.
void lean_wall(World& world, Draws& draws) {
  const bool on_left = draws.chance(0.5);
  turn_plates(world, on_left ? RigParameter::left_plate_tilt : RigParameter::right_plate_tilt,
              lean(draws));
}

// Plates of one wall from a printer that scales.
void resize_wall(World& world, Draws& draws) {
  const Side side = draws.chance(0.5) ? Side::left : Side::right;
  const double size = 1 + between(draws, 0.003, 0.2);
  for (HungPlate& plate : world.plates) {
    if (plate.tag.side == side) plate.size = size;
  }
}

// A load, or a flat tyre.
void lean_vehicle(World& world, Draws& draws) {
  world.vehicle.pitch += radians(between(draws, 0.3, 15));
  world.vehicle.roll += radians(between(draws, 0.3, 15));
  std::ranges::fill(world.vehicle_of_photo, world.vehicle);
}

// A camera that takes its photo later or earlier than the others, along the drive.
void delay_photo(World& world, Draws& draws) {
  VehiclePose& vehicle = world.vehicle_of_photo[any_camera(world, draws)];
  const Vector3d ahead(std::sin(vehicle.heading), std::cos(vehicle.heading), 0);
  vehicle.position += between(draws, 0.003, 0.5) * ahead;
}

// Where the photo of another moment was taken: a random row of the same drive.
void photo_elsewhere(const Site& site, World& world, Draws& draws, bool all) {
  const VehiclePose other = drawn_elsewhere(site, draws);
  if (!all) {
    world.vehicle_of_photo[any_camera(world, draws)] = other;
  } else {
    std::ranges::fill(world.vehicle_of_photo, other);
  }
}

struct Mistake {
  const char* name;
  // Any of these, listed as unchecked, names it; none = all that is seen moves alike, and no
  // single measurement can reveal it.
  std::vector<Unchecked::Kind> kinds;
  std::function<void(const Site&, World&, Draws&)> make;
};

std::vector<Mistake> mistakes() {
  using enum Unchecked::Kind;
  return {
      {"angle of one camera",
       {mounting},
       [](const Site&, World& w, Draws& d) { turn_camera(w.rig.cameras[any_camera(w, d)], d); }},
      {"alpha of all cameras",
       {mounting},
       [](const Site&, World& w, Draws& d) { turn_alphas(w, d); }},
      {"place of one camera",
       {mounting},
       [](const Site&, World& w, Draws& d) {
         w.rig.cameras[any_camera(w, d)].vehicle_from_camera.translation +=
             between(d, 0.01, 1) * direction(d);
       }},
      {"place of all cameras",
       {},
       [](const Site&, World& w, Draws& d) {
         const Vector3d shift = between(d, 0.01, 1) * direction(d);
         for (RigCamera& c : w.rig.cameras) c.vehicle_from_camera.translation += shift;
       }},
      {"focal length of one camera",
       {lens},
       [](const Site&, World& w, Draws& d) {
         set_focal(w.rig.cameras[any_camera(w, d)], 1 + between(d, 0.003, 0.5));
       }},
      {"focal length of all cameras",
       {lens, all_lenses},
       [](const Site&, World& w, Draws& d) {
         const double factor = 1 + between(d, 0.003, 0.5);
         for (RigCamera& c : w.rig.cameras) set_focal(c, factor);
       }},
      {"pixels of all cameras not square",
       {lens, all_lenses},
       [](const Site&, World& w, Draws& d) {
         const double factor = 1 + between(d, 0.002, kSquarePixels);
         for (RigCamera& c : w.rig.cameras) c.camera.fx *= factor;
       }},
      {"image centre of one camera",
       {lens},
       [](const Site&, World& w, Draws& d) {
         RigCamera& c = w.rig.cameras[any_camera(w, d)];
         c.camera.cx += between(d, 1, 200);
         c.camera.cy += between(d, 1, 200);
       }},
      {"distortion of all cameras",
       {lens, all_lenses},
       [](const Site&, World& w, Draws& d) { bend_lens(w, d); }},
      {"height of the vehicle",
       {vehicle_height},
       [](const Site&, World& w, Draws& d) {
         w.vehicle.position.z() = std::max(0.05, w.vehicle.position.z() + between(d, 0.03, 1));
         std::ranges::fill(w.vehicle_of_photo, w.vehicle);
       }},
      {"size of all plates",
       {plate_size},
       [](const Site&, World& w, Draws& d) {
         const double factor = 1 + between(d, 0.003, 0.6);
         w.tag_template.frame_inner_length *= factor;
         w.tag_template.frame_inner_height *= factor;
       }},
      {"shape of all plates",
       {plate_size},
       [](const Site&, World& w, Draws& d) {
         w.tag_template.frame_inner_height *= 1 + between(d, 0.003, 0.6);
       }},
      {"place of one plate",
       {plate_place},
       [](const Site&, World& w, Draws& d) {
         w.plates[near_plate(w, d)].world_from_plate.translation +=
             between(d, 0.01, 3) * direction(d);
       }},
      {"two plates exchanged",
       {plate_place},
       [](const Site&, World& w, Draws& d) {
         HungPlate& one = w.plates[near_plate(w, d)];
         HungPlate& other = any_plate(w, d);
         std::swap(one.world_from_plate, other.world_from_plate);
       }},
      {"second copy of a plate at another's place",
       {plate_place},
       [](const Site&, World& w, Draws& d) {
         any_plate(w, d).tag = w.plates[near_plate(w, d)].tag;
       }},
      {"plates of a wall farther out",
       {plate_place, wall_places},
       [](const Site&, World& w, Draws& d) { move_wall(w, d); }},
      {"plates of a wall shifted alike",
       {plate_place, wall_shift},
       [](const Site&, World& w, Draws& d) { shift_wall(w, d); }},
      {"spacing of all plates",
       {plate_place, wall_places},
       [](const Site&, World& w, Draws& d) { stretch_spacing(w, d); }},
      {"plates along a slope",
       {wall_turn},
       [](const Site&, World& w, Draws& d) { follow_slope(w, d); }},
      {"plates on leaning walls",
       {wall_turn},
       [](const Site&, World& w, Draws& d) { turn_plates(w, RigParameter::plate_tilt, lean(d)); }},
      {"plates on one leaning wall",
       {plate_place, wall_turn},
       [](const Site&, World& w, Draws& d) { lean_wall(w, d); }},
      {"lean of the vehicle",
       {vehicle_height},
       [](const Site&, World& w, Draws& d) { lean_vehicle(w, d); }},
      {"rolling shutters, not stated",
       {rolling_shutter},
       [](const Site&, World& w, Draws& d) { w.way = between(d, 0.002, 0.1); }},
      {"image centre of all cameras",
       {lens, all_lenses},
       [](const Site&, World& w, Draws& d) {
         const double right = between(d, 1, 200), down = between(d, 1, 200);
         for (RigCamera& c : w.rig.cameras) {
           c.camera.cx += right;
           c.camera.cy += down;
         }
       }},
      {"size of one plate",
       {plate_place},
       [](const Site&, World& w, Draws& d) {
         w.plates[near_plate(w, d)].size = 1 + between(d, 0.003, 0.2);
       }},
      {"size of the plates of one wall",
       {plate_place, plate_size},
       [](const Site&, World& w, Draws& d) { resize_wall(w, d); }},
      {"edges of all frames outward",
       {plate_size},
       [](const Site&, World& w, Draws& d) { w.outward = between(d, 0.1, 3); }},
      {"one photo earlier or later",
       {mounting},
       [](const Site&, World& w, Draws& d) { delay_photo(w, d); }},
      {"one photo of another row",
       {mounting},
       [](const Site& s, World& w, Draws& d) { photo_elsewhere(s, w, d, false); }},
      {"all photos of another row",
       {},
       [](const Site& s, World& w, Draws& d) { photo_elsewhere(s, w, d, true); }},
      {"range stuck",
       {range},
       [](const Site& s, World& w, Draws& d) {
         for (std::size_t i = 0; i < w.ranges.size(); ++i) {
           w.ranges[i] = bench::true_range(s, w.rig.ranges[i], drawn_elsewhere(s, d).position);
         }
       }},
      {"survey shifted and turned as a whole",
       {},
       [](const Site&, World& w, Draws& d) { move_survey(w, d); }},
  };
}

World true_world(const Site& site, Draws& draws) {
  World world{test::disturbed(site.rig, draws), site.survey.tag_template, {}, {}, {}, {}};
  world.vehicle = bench::random_pose(site, draws);
  world.vehicle_of_photo.assign(site.rig.cameras.size(), world.vehicle);
  for (const PlacedTag& tag : site.survey.tags) {
    Pose hung = tag.world_from_plate;
    hung.translation += draws.normals(site.survey.sigma);
    hung.rotation *= test::small_turn(draws, site.survey.angle_sigma);
    world.plates.push_back({tag, hung});
  }
  for (const RigRange& range : site.rig.ranges) {
    world.ranges.push_back(bench::true_range(site, range, world.vehicle.position));
  }
  return world;
}

void move_outward(FrameCorners& corners, double pixels) {
  Eigen::Matrix<double, 8, 1> stacked;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const PixelPoint& corner = corners[static_cast<std::size_t>(i)];
    stacked.segment<2>(2 * i) << corner.x, corner.y;
  }
  stacked += pixels * by_outward_edges(stacked);
  for (Eigen::Index i = 0; i < 4; ++i) {
    corners[static_cast<std::size_t>(i)] = {stacked[2 * i], stacked[2 * i + 1]};
  }
}

Observation observed(const Site& site, const World& world, Draws& draws) {
  Observation observation;
  for (std::size_t c = 0; c < world.rig.cameras.size(); ++c) {
    const RigCamera& camera = world.rig.cameras[c];
    for (const HungPlate& plate : world.plates) {
      TagTemplate tag = world.tag_template;
      tag.frame_inner_length *= plate.size;
      tag.frame_inner_height *= plate.size;
      auto corners = bench::corners_in_image(camera, world.vehicle_of_photo[c],
                                             plate.world_from_plate, tag, world.way);
      if (!corners) continue;
      move_outward(*corners, world.outward);
      observation.tags.push_back({camera.name, 0, plate.tag, bench::noisy(*corners, draws), {}});
    }
  }
  for (std::size_t i = 0; i < world.ranges.size(); ++i) {
    const RigRange& range = site.rig.ranges[i];
    const double measured = world.ranges[i] + draws.normal(range.sigma);
    if (!draws.chance(0.2)) observation.ranges[range.name] = measured;
  }
  return observation;
}

struct Tally {
  int draws = 0;
  int located = 0;
  int wrong = 0;      // located and beyond five sigma
  int named = 0;      // of these, what the position lists as unchecked names a mistake
  int never = 0;      // or a mistake is of those that no single measurement can reveal
  int untold = 0;     // or neither
  double most = 0;    // error in metres of the untold
  int with_list = 0;  // located with two tags or more, and something is unchecked
  int of_two = 0;     // located with two tags or more
};

bool none_reveals(const std::vector<const Mistake*>& made) {
  return std::ranges::any_of(made, [](const Mistake* mistake) { return mistake->kinds.empty(); });
}

bool names(const Fix& fix, const std::vector<const Mistake*>& made) {
  return std::ranges::any_of(fix.unchecked, [&](const Unchecked& unchecked) {
    return std::ranges::any_of(made, [&](const Mistake* mistake) {
      return std::ranges::find(mistake->kinds, unchecked.kind) != mistake->kinds.end();
    });
  });
}

void list(const Fix& fix, const bench::PoseError& error, std::string_view kind) {
  fmt::print("  {}: {:.3f} m off, {:.1f} sigma, tags {}, ranges {}, chi-square {:.1f} on {}\n",
             kind, error.error.head<3>().norm(), error.greatest_sigmas(), fmt::join(fix.tags, " "),
             fmt::join(fix.ranges, " "), fix.chi_square, fix.degrees_of_freedom);
  for (const std::string& note : fix.notes) fmt::print("    {}\n", note);
}

void count(Tally& tally, const Fix& fix, const World& world, const Grid& grid,
           const std::vector<const Mistake*>& made, bool verbose) {
  ++tally.draws;
  if (!fix.position_in_grid) return;
  ++tally.located;
  if (fix.tags.size() > 1) {
    ++tally.of_two;
    tally.with_list += fix.unchecked.empty() ? 0 : 1;
  }
  const bench::PoseError error = bench::error_of(fix, world.vehicle, grid);
  if (error.greatest_sigmas() <= 5) return;
  ++tally.wrong;
  if (names(fix, made)) {
    ++tally.named;
    return;
  }
  if (none_reveals(made)) {
    ++tally.never;
    return;
  }
  ++tally.untold;
  tally.most = std::max(tally.most, error.error.head<3>().norm());
  if (!verbose) return;
  std::string what;
  for (const Mistake* mistake : made) what += fmt::format("[{}] ", mistake->name);
  list(fix, error, what);
}

void print_row(std::string_view name, const Tally& tally) {
  const auto share = [](int part, int of) { return 100.0 * part / std::max(1, of); };
  fmt::print("| {} | {} | {:.1f} % | {:.1f} % | {} | {} | {} | {} | {:.3f} |\n", name, tally.draws,
             share(tally.located, tally.draws), share(tally.with_list, tally.of_two), tally.wrong,
             tally.named, tally.never, tally.untold, tally.most);
}

// The shipped surveys, each with a careful calibration and with an unstated one's deviations, all
// of these with two cameras and with one.
std::vector<Site> drawn_sites() {
  std::vector<Site> sites;
  for (const char* name : {"corridor", "curved"}) {
    Result<Site> site = bench::calibrated_site(name);
    if (!site) {
      fmt::print(stderr, "{}\n", site.error().message);
      std::exit(2);
    }
    sites.push_back(*site);
    site->survey.sigma = kUsualSigma;
    for (PlacedTag& tag : site->survey.tags) tag.sigma = site->survey.sigma;
    site->survey.angle_sigma = kUsualAngleSigma;
    for (RigCamera& camera : site->rig.cameras) {
      camera.calibration_sigma = usual_calibration(IntrinsicsSource::data_sheet, camera.camera);
    }
    sites.push_back(std::move(*site));
  }
  for (std::size_t i = 0, both = sites.size(); i < both; ++i) {
    Site lone = sites[i];
    lone.rig.cameras.erase(lone.rig.cameras.begin() + 1, lone.rig.cameras.end());
    sites.push_back(std::move(lone));
  }
  return sites;
}

}  // namespace

int main(int argc, char** argv) {
  const int wanted = argc > 1 ? std::atoi(argv[1]) : 50'000;
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const bool verbose = argc > 3 && std::string_view(argv[3]) == "--list";
  const std::vector<Site> sites = drawn_sites();
  const std::vector<Mistake> kinds = mistakes();
  Draws draws(seed);
  std::map<std::string, Tally> tallies;
  Tally two;
  Tally right;
  for (int drawn = 0; drawn < wanted;) {
    const Site& site = sites[draws.index(sites.size())];
    World world = true_world(site, draws);
    std::vector<const Mistake*> made;
    const int count_made = draws.chance(0.1) ? 0 : draws.chance(0.3) ? 2 : 1;
    while (static_cast<int>(made.size()) < count_made) {
      made.push_back(&kinds[draws.index(kinds.size())]);
      made.back()->make(site, world, draws);
    }
    const Observation seen = observed(site, world, draws);
    if (seen.tags.empty()) continue;
    ++drawn;
    const Fix fix = localize_jointly(seen, {site.survey}, site.rig);
    Tally& tally = made.empty() ? right : made.size() > 1 ? two : tallies[made.front()->name];
    count(tally, fix, world, site.survey.grid, made, verbose && !made.empty());
  }
  fmt::print(
      "| mistake | draws | located | of two tags: something unchecked | beyond 5 sigma "
      "| named by the position | no measurement can tell | neither | greatest of these, m |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  print_row("none", right);
  for (const auto& [name, tally] : tallies) print_row(name, tally);
  print_row("two at once", two);
  return 0;
}
