// SPDX-License-Identifier: Apache-2.0
// The localizer on anything that cameras may claim to have seen: true corners moved a little or
// anywhere, tags of other places, parts, ranges that are none. What it states as a position is one.
#include <cmath>
#include <cstdlib>

#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/paper_method.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

namespace {

struct Site {
  std::vector<Survey> surveys{load_survey("surveys/corridor/survey.yaml").value()};
  Rig rig = load_rig("surveys/corridor/rig.yaml").value();
};

SeenCorners any_corners(fuzz::Numbers& numbers) {
  SeenCorners seen;
  seen.sigma_px = numbers.real(0.01, 2);
  const PixelPoint middle{numbers.real(-500, 2500), numbers.real(-500, 2000)};
  const double size = numbers.real(0, 800);
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = i == 1 || i == 2 ? 1 : -1, y = i > 1 ? 1 : -1;
    seen.corners[i] = middle + PixelPoint{size * (x + numbers.real(-0.5, 0.5)),
                                          size * (0.5 * y + numbers.real(-0.5, 0.5))};
  }
  seen.covariance = seen.sigma_px * seen.sigma_px * CornerCovariance::Identity();
  return seen;
}

Observation any_observation(fuzz::Numbers& numbers, const Site& site) {
  Observation seen;
  seen.id = "fuzz";
  const auto& tags = site.surveys.front().tags;
  const int count = numbers.integer(5);
  for (int i = 0; i < count; ++i) {
    const auto& camera = site.rig.cameras[static_cast<std::size_t>(
        numbers.integer(static_cast<int>(site.rig.cameras.size()) - 1))];
    const PlacedTag& tag =
        tags[static_cast<std::size_t>(numbers.integer(static_cast<int>(tags.size()) - 1))];
    const int kind = numbers.integer(7);
    if (kind == 0) {
      seen.parts.push_back({camera.name, {{0, &tag}}, any_corners(numbers), 0.6});
      continue;
    }
    seen.tags.push_back({camera.name, 0, tag, {}, {}, false, false});
    if (kind == 1) {
      seen.tags.back().distance = numbers.real(-1, 50);
    } else {
      seen.tags.back().seen_corners = any_corners(numbers);
    }
  }
  for (const auto& range : site.rig.ranges) {
    if (numbers.integer(1) == 1) seen.ranges[range.name] = numbers.real(0, 10);
  }
  return seen;
}

void require_sound(const Fix& fix) {
  if (!fix.position_in_grid) return;
  if (!fix.position_in_grid->allFinite() || !fix.covariance_in_grid->allFinite()) std::abort();
  if (fix.covariance_in_grid->diagonal().minCoeff() <= 0) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Site site;
  fuzz::Numbers numbers(fuzz::as_text(data, size));
  const Observation seen = any_observation(numbers, site);
  require_sound(localize_jointly(seen, site.surveys, site.rig));
  require_sound(localize_by_paper(seen, site.surveys, site.rig));
  return 0;
}
