// SPDX-License-Identifier: Apache-2.0
// bench_adjust [PLATES] [PHOTOS] [SEED]: the as-built survey of a simulated drive. Plates hang 20
// mm from the survey and are turned by 0.3 degrees (standard deviations); a control tag of 2 mm
// hangs on either wall every 20 m; corners have a noise of 0.1 pixels, and one sighting in a
// thousand is of another tag. Errors, what they should be by the stated covariances, time and
// memory.
#include <cstdlib>
#include <ctime>

#include <fmt/core.h>
#include <sys/resource.h>

#include "tagsmith/base/statistics.hpp"
#include "tests/support/as_built_drive.hpp"

namespace tagsmith::detail::test {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void add_misread(AsBuiltDrive& drive, Draws& draws) {
  for (SightedTag& tag : drive.sighted) {
    if (draws.chance(0.001)) tag.tag = drive.survey.tags[draws.index(drive.hung.size())].name;
  }
}

int run(int plates, int photos, std::uint64_t seed) {
  AsBuiltDriveOptions options;
  options.pairs = plates / 2;
  options.stations = photos / 2;
  Draws draws(seed);
  AsBuiltDrive drive = as_built_drive(options, draws);
  add_misread(drive, draws);
  const double before = megabytes();
  const double start = processor_seconds();
  const auto found = adjust_as_built(drive.survey, drive.rig, drive.sighted, drive.control);
  const double taken = processor_seconds() - start;
  if (!found) {
    fmt::print(stderr, "{}\n", found.error().message);
    return 1;
  }
  std::vector<double> unnoticed;
  for (const ControlGroup& group : found->groups) unnoticed.push_back(group.unnoticed);
  AsBuiltErrors errors = errors_of(drive, *found);
  const auto of = [&](double share) { return 1e3 * quantile(errors.distances, share); };
  fmt::print(
      "{} plates, {} control; {} photos of {} tags, {} left out\n"
      "{} places adjusted: median {:.2f} mm, 95 % {:.2f} mm, most {:.2f} mm; NEES {:.2f}; "
      "sigma factor {:.3f}\n"
      "{:.1f} s of one processor, {:.0f} MB ({:.0f} MB of these the input)\n"
      "{} groups of control tags: off by {:.1f} mm unnoticed (median)\n",
      plates, drive.control.size(), photos, drive.sighted.size(), found->left_out.size(),
      errors.distances.size(), of(0.5), of(0.95), of(1), errors.nees, found->sigma_factor, taken,
      megabytes(), before, found->groups.size(), 1e3 * quantile(unnoticed, 0.5));
  return 0;
}

}  // namespace
}  // namespace tagsmith::detail::test

// NOLINTNEXTLINE(bugprone-exception-escape): an exception may end it
int main(int argc, char** argv) {
  const auto number = [&](int place, int otherwise) {
    return argc > place ? std::atoi(argv[place]) : otherwise;
  };
  return tagsmith::detail::test::run(number(1, 2000), number(2, 20000),
                                     static_cast<std::uint64_t>(number(3, 1)));
}
