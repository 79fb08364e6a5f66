// SPDX-License-Identifier: Apache-2.0
// How long reading takes, by stage and image, beside other readers in the same run; a large image;
// a folder with all cores against decoding its files alone. Usage: bench_read_times [IMAGE...] [-n
// RUNS]; by default two shipped photos. Times are medians of the runs, least time in parentheses:
// on a machine that others use too the least is the fairer one.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <tbb/parallel_for_each.h>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/scan/decode.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/bench/kept_memory.hpp"
#include "tests/bench/other_readers.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

struct Times {
  double median_ms = 0;
  double least_ms = 0;
};

template <class Work>
Times time_of(int runs, const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    times.push_back(time.count());
  }
  std::ranges::sort(times);
  return {times[times.size() / 2], times.front()};
}

void print_row(const std::string& name, const Times& times, const Times& unit,
               const std::string& remark = "") {
  fmt::print("| {} | {:.3f} ({:.3f}) | {:.2f} | {} |\n", name, times.median_ms, times.least_ms,
             times.least_ms / unit.least_ms, remark);
  std::fflush(stdout);
}

std::string count_of(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// Times of the stages after finding, for the tags that were read.
struct StageTimes {
  Times refine;
  Times profile;
  Times decode;
};

StageTimes stages_of(const GrayView& image, const std::vector<Reading>& tags, int runs) {
  std::vector<RefinedFrame> frames;
  std::vector<SymbolProfile> profiles;
  StageTimes times;
  times.refine = time_of(runs, [&] {
    frames.clear();
    for (const Reading& tag : tags) {
      if (auto frame = refine_frame(image, tag.corners)) frames.push_back(*frame);
    }
  });
  times.profile = time_of(runs, [&] {
    profiles.clear();
    for (const RefinedFrame& frame : frames) {
      profiles.push_back(RobustProfile(image, frame, SymbolLayout{}).of_agreeing_rows());
    }
  });
  times.decode = time_of(runs, [&] {
    for (const SymbolProfile& profile : profiles) {
      ImagingModel start;
      start.blur = std::clamp(profile.blur, 0.1, 3.0);
      static_cast<void>(decode_profile(profile.bins, start, {}));
    }
  });
  return times;
}

void time_image(const fs::path& path, int runs) {
  const Result<GrayImage> loaded = load_gray_image(path);
  if (!loaded) {
    fmt::print(stderr, "{}\n", loaded.error().message);
    return;
  }
  const GrayView image = loaded->view();
  fmt::print("\n| {}, {} x {} | ms: median (least) of {} | / paper's segmentation | |\n",
             path.filename().string(), image.width, image.height, runs);
  fmt::print("|---|---|---|---|\n");
  const Times unit = time_of(runs, [&] { segment_paper(image); });
  print_row("the paper's segmentation", unit, unit, "Otsu, opening, outlines");
  print_row("the paper's pipeline", time_of(runs, [&] { read_tags_paper(image); }), unit);
  std::vector<std::uint8_t> copy(loaded->samples.size());
  print_row("one memcpy of the image",
            time_of(runs, [&] { std::memcpy(copy.data(), image.data, copy.size()); }), unit);
  print_row("loading the file", time_of(runs, [&] { static_cast<void>(load_gray_image(path)); }),
            unit);
  ReadResult result;
  const Times all = time_of(runs, [&] { result = read_tags(image); });
  print_row("**read_tags**", all, unit, count_of(result.tags.size(), "tag"));
  print_row("- half and quarter size", time_of(runs, [&] { half_size(half_size(image).view()); }),
            unit, "of read_tags");
  const StageTimes stages = stages_of(image, result.tags, runs);
  print_row("- refining the frames read", stages.refine, unit);
  print_row("- their scan profiles", stages.profile, unit);
  print_row("- their digits", stages.decode, unit);
  const double rest =
      all.least_ms - stages.refine.least_ms - stages.profile.least_ms - stages.decode.least_ms;
  print_row("- the rest: finding frames", {rest, rest}, unit, "and what was refused");
  FramelessResult frameless;
  print_row("read_frameless",
            time_of(std::min(runs, 9), [&] { frameless = read_frameless(image); }), unit,
            "where no tag was found: " + count_of(frameless.read.size(), "symbol"));
  for (const bench::OtherReader& reader : bench::other_readers()) {
    std::size_t count = 0;
    const Times times = time_of(runs, [&] { count = reader.read(image).size(); });
    print_row(reader.name, times, unit, count_of(count, "symbol"));
  }
}

// The image enlarged to about `pixels`, linearly.
GrayImage enlarged(const GrayView& image, double pixels) {
  const double scale = std::sqrt(pixels / (static_cast<double>(image.width) * image.height));
  GrayImage large{
      static_cast<int>(image.width * scale), static_cast<int>(image.height * scale), {}};
  for (int y = 0; y < large.height; ++y) {
    const double v = std::min(y / scale, image.height - 1.001);
    const int top = static_cast<int>(v);
    for (int x = 0; x < large.width; ++x) {
      const double u = std::min(x / scale, image.width - 1.001);
      const int left = static_cast<int>(u);
      const double a = u - left;
      const double b = v - top;
      const double sample =
          (1 - b) * ((1 - a) * image.at(left, top) + a * image.at(left + 1, top)) +
          b * ((1 - a) * image.at(left, top + 1) + a * image.at(left + 1, top + 1));
      large.samples.push_back(static_cast<std::uint8_t>(sample));
    }
  }
  return large;
}

void time_large(const fs::path& path) {
  constexpr double kPixels = 50e6;
  constexpr int kRuns = 5;
  const Result<GrayImage> image = load_gray_image(path);
  if (!image) return;
  const GrayImage large = enlarged(image->view(), kPixels);
  std::size_t tags = 0;
  const Times times = time_of(kRuns, [&] { tags = read_tags(large.view()).tags.size(); });
  fmt::print("\n{} enlarged to {} x {}: {:.0f} ms, least {:.0f} (aim 150), {}\n",
             path.filename().string(), large.width, large.height, times.median_ms, times.least_ms,
             count_of(tags, "tag"));
}

// Seconds for all files, on all cores.
double seconds_for(const std::vector<fs::path>& files,
                   const std::function<void(const fs::path&)>& work) {
  const auto start = std::chrono::steady_clock::now();
  tbb::parallel_for_each(files, work);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void time_folder(const fs::path& folder) {
  constexpr int kRuns = 5;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") files.push_back(entry.path());
  }
  double decoding = 1e9;
  double reading = 1e9;
  for (int run = 0; run < kRuns; ++run) {
    decoding = std::min(decoding, seconds_for(files, [](const fs::path& file) {
                          static_cast<void>(load_gray_image(file));
                        }));
    reading = std::min(reading, seconds_for(files, [](const fs::path& file) {
                         const Result<GrayImage> image = load_gray_image(file);
                         if (image) read_tags(image->view());
                       }));
  }
  const auto count = static_cast<double>(files.size());
  fmt::print(
      "{}: {} files on all cores, {:.0f} a second read, {:.0f} a second decoded from JPEG alone: "
      "{:.2f} times the time\n",
      folder.string(), files.size(), count / reading, count / decoding, reading / decoding);
}

int run(int argc, char** argv) {
  keep_freed_memory();
  int runs = 51;
  std::vector<fs::path> images;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "-n" && i + 1 < argc) {
      runs = std::max(1, std::atoi(argv[++i]));
    } else {
      images.emplace_back(argv[i]);
    }
  }
  if (images.empty()) {
    images = {"surveys/corridor/photos/corridor_01_left.jpg",
              "surveys/curved/photos/curved_02_left.jpg"};
  }
  if (bench::other_readers().size() < 2) {
    fmt::print(stderr, "zbar or zxing-cpp is not installed (libzbar-dev, libzxing-dev)\n");
  }
  for (const fs::path& image : images) time_image(image, runs);
  time_large(images.front());
  time_folder("surveys/corridor/photos");
  time_folder("surveys/curved/photos");
  return 0;
}

}  // namespace
}  // namespace tagsmith::detail

int main(int argc, char** argv) { return tagsmith::detail::run(argc, argv); }
