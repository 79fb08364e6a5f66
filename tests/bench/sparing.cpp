// SPDX-License-Identifier: Apache-2.0
// Does sparing the closer look ever change a position? The shipped runs with things painted before
// their photos, so that frames do not stand out, and tags of the survey moved against the pictures:
// `locate` against reading all that can be read. Usage: bench_sparing [N] [SEED]
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/localize_images.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/run.hpp"
#include "tests/bench/bench_site.hpp"
#include "tests/support/draws.hpp"

using namespace tagsmith::detail;
using test::Draws;

namespace {

// A shipped site with its photos.
struct PhotoSite {
  std::vector<Survey> surveys;
  Rig rig;
  std::vector<std::vector<GrayImage>> images;  // of each measurement, in the order of the cameras
  std::vector<Eigen::Vector3d> truths;
};

Result<PhotoSite> load_photos(const std::string& name) {
  Result<bench::Site> drive = bench::load_shipped_site(name);
  if (!drive) return fail(drive.error().message);
  const auto run = load_run("surveys/" + name + "/run.csv", drive->rig);
  if (!run) return fail(run.error().message);
  PhotoSite site{{std::move(drive->survey)}, std::move(drive->rig), {}, {}};
  for (const Measurement& measurement : run->measurements) {
    std::vector<GrayImage>& images = site.images.emplace_back();
    for (const RigCamera& camera : site.rig.cameras) {
      auto image = load_gray_image(measurement.cameras.at(camera.name).image);
      if (!image) return fail(image.error().message);
      images.push_back(std::move(*image));
    }
    site.truths.push_back(measurement.truth_in_grid.value());
  }
  return site;
}

// A grey board, or a grating, before a part of the picture.
void paint_board(GrayImage& image, Draws& draws) {
  const auto up_to = [&](int end) {
    return static_cast<int>(draws.index(static_cast<std::size_t>(end)));
  };
  const int left = up_to(image.width), top = up_to(image.height);
  const int right = std::min(image.width, left + 10 + up_to(250));
  const int bottom = std::min(image.height, top + 10 + up_to(250));
  const int bar = draws.chance(0.5) ? 4 + up_to(10) : 0;  // pixels; 0 = plain
  const int dark = 10 + up_to(150), light = dark + 20 + up_to(80);
  for (int row = top; row < bottom; ++row) {
    for (int column = left; column < right; ++column) {
      const bool is_light = bar > 0 && (column - left) / bar % 2 == 1;
      image.samples[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(column)] =
          static_cast<std::uint8_t>(is_light ? light : dark);
    }
  }
}

// Moves up to two tags by the same way, 5 cm to 1 m in their wall.
int move_tags(Survey& survey, Draws& draws) {
  const int count = draws.chance(0.5) ? 0 : draws.chance(0.7) ? 1 : 2;
  const double away = std::exp(draws.uniform(std::log(0.05), std::log(1.0)));
  const Eigen::Vector3d shift(0, away, 0);
  for (int i = 0; i < count; ++i) {
    survey.tags[draws.index(survey.tags.size())].world_from_plate.translation += shift;
  }
  return count;
}

struct Tally {
  int draws = 0;
  int located = 0;       // by the full look
  int same = 0;          // both without a position, or with the same to a nanometre
  int fewer = 0;         // both with one, sparing by fewer tags
  int only_sparing = 0;  // a position where the full look has none
  int only_full = 0;
  int wrong = 0;        // by two tags and more, off by more than 5 sigma: sparing
  int wrong_full = 0;   // likewise the full look
  double farthest = 0;  // between positions that differ, standard deviations of the full look's
};

double most_sigmas(const Eigen::Vector3d& difference, const Fix& fix) {
  const Eigen::Vector3d sigmas = fix.covariance_in_grid->diagonal().cwiseSqrt();
  return difference.cwiseAbs().cwiseQuotient(sigmas).maxCoeff();
}

bool is_wrong(const Fix& fix, const Eigen::Vector3d& truth) {
  return fix.position_in_grid && fix.confirmations > 0 &&
         most_sigmas(*fix.position_in_grid - truth, fix) > 5;
}

void count(Tally& tally, const Fix& sparing, const Fix& full, const Eigen::Vector3d& truth) {
  ++tally.draws;
  tally.wrong += is_wrong(sparing, truth) ? 1 : 0;
  tally.wrong_full += is_wrong(full, truth) ? 1 : 0;
  if (full.position_in_grid) ++tally.located;
  if (!sparing.position_in_grid || !full.position_in_grid) {
    if (sparing.position_in_grid) ++tally.only_sparing;
    if (full.position_in_grid) ++tally.only_full;
    if (!sparing.position_in_grid && !full.position_in_grid) ++tally.same;
    return;
  }
  const Eigen::Vector3d difference = *sparing.position_in_grid - *full.position_in_grid;
  if (difference.norm() < 1e-9) {
    ++tally.same;
    return;
  }
  if (sparing.tags.size() < full.tags.size()) ++tally.fewer;
  tally.farthest = std::max(tally.farthest, most_sigmas(difference, full));
}

void draw(const PhotoSite& site, Draws& draws, Tally& tally) {
  const std::size_t row = draws.index(site.images.size());
  std::vector<GrayImage> painted = site.images[row];
  std::vector<Survey> surveys = site.surveys;
  move_tags(surveys.front(), draws);
  std::vector<CameraImage> images;
  Observation seen;
  for (std::size_t c = 0; c < painted.size(); ++c) {
    for (std::size_t boards = draws.index(8); boards > 0; --boards) paint_board(painted[c], draws);
    const RigCamera& camera = site.rig.cameras[c];
    images.push_back({&camera, painted[c].view(), camera.name});
    observe_image(seen, camera, painted[c].view(), camera.name, surveys,
                  {read_tags, kFittedCornerSigmaPx});
  }
  Observation spared;
  count(tally, localize_images(spared, images, surveys, site.rig),
        localize_jointly(seen, surveys, site.rig), site.truths[row]);
}

}  // namespace

int main(int argc, char** argv) {
  const int wanted = argc > 1 ? std::atoi(argv[1]) : 2000;
  Draws draws(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  fmt::print(
      "| photos | draws | located | same position | fewer tags | position only sparing | only "
      "looking at all | farthest apart, sigma | confirmed and off by 5 sigma: sparing | looking at "
      "all |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const char* name : {"corridor", "curved"}) {
    const Result<PhotoSite> site = load_photos(name);
    if (!site) {
      fmt::print(stderr, "{}\n", site.error().message);
      return 2;
    }
    Tally tally;
    for (int i = 0; i < wanted; ++i) draw(*site, draws, tally);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.2f} | {} | {} |\n", name, tally.draws,
               tally.located, tally.same, tally.fewer, tally.only_sparing, tally.only_full,
               tally.farthest, tally.wrong, tally.wrong_full);
  }
  return 0;
}
