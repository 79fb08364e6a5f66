// SPDX-License-Identifier: Apache-2.0
// How long the steps take on the shipped corridor: `./dev bench [NAME]`. Runs from the project
// root.
#include <benchmark/benchmark.h>

#include "decoder/image/load.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {
namespace {

constexpr const char* kSurvey = "surveys/corridor/survey.yaml";
constexpr const char* kPhoto = "surveys/corridor/photos/corridor_01_left.jpg";

void load_corridor_survey(benchmark::State& state) {
  for (auto _ : state) {
    const Result<Survey> survey = load_survey(kSurvey);
    if (!survey) return state.SkipWithError(survey.error().message.c_str());
    benchmark::DoNotOptimize(survey->tags.data());
  }
}
BENCHMARK(load_corridor_survey)->Unit(benchmark::kMillisecond);

void draw_one_tag(benchmark::State& state) {
  const Result<Survey> survey = load_survey(kSurvey);
  if (!survey) return state.SkipWithError(survey.error().message.c_str());
  for (auto _ : state) {
    benchmark::DoNotOptimize(draw_tag(survey->tag_template, survey->tags.front().digits));
  }
}
BENCHMARK(draw_one_tag);

void load_photo(benchmark::State& state) {
  for (auto _ : state) {
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
  for (auto _ : state) tags = read(image->view()).tags.size();
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

void read_photo_by_paper_pipeline(benchmark::State& state) {
  read_photo(state, [](const GrayView& image) { return read_tags_paper(image); });
}
BENCHMARK(read_photo_by_paper_pipeline)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tagsmith

BENCHMARK_MAIN();
