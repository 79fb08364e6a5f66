// SPDX-License-Identifier: Apache-2.0
// 2,000 tags into one PDF, as `print --format pdf --single` does it, beside `zint` writing as many
// SVGs: `./dev bench print`. Runs from the project root.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "tagsmith/cli/print_job.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

Survey straight_drive(int tags) {
  const fs::path path = fs::temp_directory_path() / "tagsmith-bench-survey.yaml";
  std::ofstream(path) << "survey: bench\ntunnel:\n  width: 3.0\n  height: 2.8\n  centerline:\n"
                         "    start: [0, 0, 0]\n    heading: 0\n    elements: [ { line: "
                      << tags << " } ]\ntags: { template: tag-400x300, height: 1.2, spacing: 0.6, "
                      << "first: 1.0, pairs: " << tags / 2
                      << " }\ncode: { check_digit: gs1, resolution: [0.1, 0.01, 0.1], digits: "
                         "[2, 7, 2], origin: [-5, 0, 0] }\n";
  Survey survey = load_survey(path).value();
  fs::remove(path);
  return survey;
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void print_into_one_pdf(benchmark::State& state) {
  const Survey survey = straight_drive(static_cast<int>(state.range(0)));
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) tags.push_back(&tag);
  PrintStyle style;
  style.formats = {SheetFormat::pdf};
  style.single = true;
  style.revision = survey_revision(survey);
  const fs::path folder = fs::temp_directory_path() / "tagsmith-bench";
  double bytes = 0;
  for ([[maybe_unused]] const auto _ : state) {
    const PrintJob job = plan_print(survey, tags, style).value();
    const StagedFiles files = StagedFiles::begin(folder).value();
    if (!write_print(job, files)) return state.SkipWithError("not written");
    bytes = static_cast<double>(fs::file_size(files.staged(kSinglePdf)));
  }
  state.counters["bytes_a_tag"] = bytes / static_cast<double>(tags.size());
  state.counters["peak_MB"] = peak_megabytes();
}
BENCHMARK(print_into_one_pdf)
    ->Arg(500)
    ->Arg(1000)
    ->Arg(2000)
    ->Arg(4000)
    ->Arg(8000)
    ->Unit(benchmark::kMillisecond);

void zint_svgs(benchmark::State& state) {
  const fs::path folder = fs::temp_directory_path() / "tagsmith-bench-zint";
  fs::create_directories(folder);
  std::ofstream codes(folder / "codes.txt");
  for (int i = 0; i < state.range(0); ++i) codes << 10'000'000'000 + i << '\n';
  codes.close();
  const std::string command =
      "cd '" + folder.string() + "' && zint --batch --barcode=UPCA --filetype=SVG -i codes.txt";
  for ([[maybe_unused]] const auto _ : state) {
    if (std::system(command.c_str()) != 0) return state.SkipWithError("zint is not installed");
  }
  fs::remove_all(folder);
}
BENCHMARK(zint_svgs)->Arg(2000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tagsmith::detail
