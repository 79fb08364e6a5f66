// SPDX-License-Identifier: Apache-2.0
// How long the steps take on the shipped corridor: `./dev bench [NAME]`. Runs from the project
// root.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "decoder/image/gray.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/kept_memory.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kSurvey = "surveys/corridor/survey.yaml";
constexpr const char* kPhoto = "surveys/corridor/photos/corridor_01_left.jpg";

void load_corridor_survey(benchmark::State& state) {
  for ([[maybe_unused]] const auto _ : state) {
    const Result<Survey> survey = load_survey(kSurvey);
    if (!survey) return state.SkipWithError(survey.error().message.c_str());
    benchmark::DoNotOptimize(survey->tags.data());
  }
}
BENCHMARK(load_corridor_survey)->Unit(benchmark::kMillisecond);

void draw_one_tag(benchmark::State& state) {
  const Result<Survey> survey = load_survey(kSurvey);
  if (!survey) return state.SkipWithError(survey.error().message.c_str());
  for ([[maybe_unused]] const auto _ : state) {
    benchmark::DoNotOptimize(draw_tag(survey->tag_template, survey->tags.front().digits));
  }
}
BENCHMARK(draw_one_tag);

void load_photo(benchmark::State& state) {
  for ([[maybe_unused]] const auto _ : state) {
    const Result<GrayImage> image = load_gray_image(kPhoto);
    if (!image) return state.SkipWithError(image.error().message.c_str());
    benchmark::DoNotOptimize(image->samples.data());
  }
}
BENCHMARK(load_photo)->Unit(benchmark::kMillisecond);

// Reads one corridor photo with `read`, and shows how many tags it found.
template <class Read>
void read_photo(benchmark::State& state, const Read& read) {
  const Result<GrayImage> image = load_gray_image(kPhoto);
  if (!image) return state.SkipWithError(image.error().message.c_str());
  std::size_t tags = 0;
  for ([[maybe_unused]] const auto _ : state) tags = read(image->view()).tags.size();
  state.counters["tags"] = static_cast<double>(tags);
}

void read_photo_without_survey(benchmark::State& state) {
  read_photo(state, [](const GrayView& image) { return read_tags(image); });
}
BENCHMARK(read_photo_without_survey)->Unit(benchmark::kMillisecond);

void read_photo_with_survey(benchmark::State& state) {
  const Result<Survey> survey = load_survey(kSurvey);
  if (!survey) return state.SkipWithError(survey.error().message.c_str());
  ReadOptions options;
  for (const PlacedTag& tag : survey->tags) options.code_book.push_back(tag.digits);
  read_photo(state, [&](const GrayView& image) { return read_tags(image, options); });
}
BENCHMARK(read_photo_with_survey)->Unit(benchmark::kMillisecond);

// Times `read` beside the paper's own segmentation (Otsu, opening, outlines) of the same photo,
// turn by turn: `of_paper` is the ratio of their least times, which other work on the machine
// disturbs least.
template <class Read>
void compare_with_paper(benchmark::State& state, const Read& read) {
  using Clock = std::chrono::steady_clock;
  keep_freed_memory();
  const Result<GrayImage> image = load_gray_image(kPhoto);
  if (!image) return state.SkipWithError(image.error().message.c_str());
  double least_read = std::numeric_limits<double>::infinity();
  double least_paper = least_read;
  std::size_t tags = 0;
  for ([[maybe_unused]] const auto _ : state) {
    const auto begin = Clock::now();
    benchmark::DoNotOptimize(segment_paper(image->view()).outlines.data());
    const auto middle = Clock::now();
    tags = read(image->view()).tags.size();
    const std::chrono::duration<double> reading = Clock::now() - middle;
    state.SetIterationTime(reading.count());
    least_paper = std::min(least_paper, std::chrono::duration<double>(middle - begin).count());
    least_read = std::min(least_read, reading.count());
  }
  state.counters["tags"] = static_cast<double>(tags);
  state.counters["least_ms"] = 1e3 * least_read;
  state.counters["paper_ms"] = 1e3 * least_paper;
  state.counters["of_paper"] = least_read / least_paper;
}

void read_cold_beside_paper(benchmark::State& state) {
  compare_with_paper(state, [](const GrayView& image) { return read_tags(image); });
}
BENCHMARK(read_cold_beside_paper)->Unit(benchmark::kMillisecond)->UseManualTime();

// As it is used: one pass over twenty photos, each seen once, memory touched for the first time
// when this is the only benchmark of the run (`./dev bench twenty`). Sums over the photos.
void read_twenty_beside_paper(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  std::chrono::duration<double> reading{0}, segmenting{0};
  std::size_t tags = 0;
  for ([[maybe_unused]] const auto _ : state) {
    for (int i = 1; i <= 10; ++i) {
      for (const char* side : {"left", "right"}) {
        const Result<GrayImage> image =
            load_gray_image(fmt::format("surveys/corridor/photos/corridor_{:02}_{}.jpg", i, side));
        if (!image) return state.SkipWithError(image.error().message.c_str());
        const auto begin = Clock::now();
        tags += read_tags(image->view()).tags.size();
        const auto middle = Clock::now();
        benchmark::DoNotOptimize(segment_paper(image->view()).outlines.data());
        segmenting += Clock::now() - middle;
        reading += middle - begin;
      }
    }
    state.SetIterationTime(reading.count());
  }
  state.counters["tags"] = static_cast<double>(tags);
  state.counters["paper_ms"] = 1e3 * segmenting.count();
  state.counters["of_paper"] = reading.count() / segmenting.count();
}
BENCHMARK(read_twenty_beside_paper)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(1);

// With the survey's codes, and the tags expected 3 pixels from where they are.
void read_expected_beside_paper(benchmark::State& state) {
  const Result<Survey> survey = load_survey(kSurvey);
  const Result<GrayImage> image = load_gray_image(kPhoto);
  if (!survey || !image) return state.SkipWithError("the shipped corridor cannot be loaded");
  ReadOptions options = read_options_for(std::span(&*survey, 1));
  for (const Reading& tag : read_tags(image->view(), options).tags) {
    ExpectedTag expected{tag.corners, 4};
    for (PixelPoint& corner : expected.corners) corner = corner + PixelPoint{2, -2};
    options.expected.push_back(expected);
  }
  compare_with_paper(state, [&](const GrayView& picture) { return read_tags(picture, options); });
}
BENCHMARK(read_expected_beside_paper)->Unit(benchmark::kMillisecond)->UseManualTime();

// The photo enlarged to the size of a phone's: 50 million pixels.
void read_50_mpx(benchmark::State& state) {
  const Result<GrayImage> image = load_gray_image(kPhoto);
  if (!image) return state.SkipWithError(image.error().message.c_str());
  GrayImage large{8192, 6144, {}};
  large.samples.reserve(static_cast<std::size_t>(large.width) *
                        static_cast<std::size_t>(large.height));
  const double step = static_cast<double>(image->width) / large.width;
  for (int y = 0; y < large.height; ++y) {
    for (int x = 0; x < large.width; ++x) {
      const double sample = sample_bilinear(image->view(), {step * x, step * y});
      large.samples.push_back(static_cast<std::uint8_t>(std::lround(sample)));
    }
  }
  std::size_t tags = 0;
  for ([[maybe_unused]] const auto _ : state) tags = read_tags(large.view()).tags.size();
  state.counters["tags"] = static_cast<double>(tags);
}
BENCHMARK(read_50_mpx)->Unit(benchmark::kMillisecond);

void halve_photo(benchmark::State& state) {
  const Result<GrayImage> image = load_gray_image(kPhoto);
  if (!image) return state.SkipWithError(image.error().message.c_str());
  for ([[maybe_unused]] const auto _ : state)
    benchmark::DoNotOptimize(half_size(image->view()).samples.data());
}
BENCHMARK(halve_photo)->Unit(benchmark::kMillisecond);

void read_photo_by_paper_pipeline(benchmark::State& state) {
  read_photo(state, [](const GrayView& image) { return read_tags_paper(image); });
}
BENCHMARK(read_photo_by_paper_pipeline)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tagsmith::detail

BENCHMARK_MAIN();
