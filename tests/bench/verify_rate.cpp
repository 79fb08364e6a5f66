// SPDX-License-Identifier: Apache-2.0
// What `verify` costs beside decoding the JPEGs alone, by this program's loader and by OpenCV's, on
// the same cores in the same run: `./dev bench verify_rate [N] [SURVEY FOLDER]...`. N photos a
// round, the folder's over and over. And what starting the program costs.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sys/resource.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_json.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

struct Cost {
  double wall = std::numeric_limits<double>::infinity();  // seconds a photo, least of the rounds
  double processor = std::numeric_limits<double>::infinity();
};

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// One round over `count` photos, as the commands run them.
void run_round(Cost& cost, std::size_t count, const std::function<void(std::size_t)>& work) {
  const double wall = seconds_of(CLOCK_MONOTONIC);
  const double processor = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  run_in_order(count, 0, [&](std::size_t i) -> Delivery {
    work(i);
    return [] {};
  });
  const auto photos = static_cast<double>(count);
  cost.wall = std::min(cost.wall, (seconds_of(CLOCK_MONOTONIC) - wall) / photos);
  cost.processor =
      std::min(cost.processor, (seconds_of(CLOCK_PROCESS_CPUTIME_ID) - processor) / photos);
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

int measure(std::size_t count, const std::string& survey_file, const fs::path& folder) {
  constexpr int kRounds = 5;
  const Result<Survey> survey = load_survey(survey_file);
  if (!survey) {
    fmt::print(stderr, "{}\n", survey.error().message);
    return 2;
  }
  std::vector<fs::path> photos;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") photos.push_back(entry.path());
  }
  if (photos.empty()) return 2;
  const auto photo = [&](std::size_t i) -> const fs::path& { return photos[i % photos.size()]; };
  ManifestCache manifests;
  const VerifyRequest request{*survey, {}, false, &manifests};
  Cost decoding;
  Cost colour;
  Cost grey;
  Cost hashing;
  Cost reading;
  Cost verifying;
  for (int round = 0; round < kRounds; ++round) {
    run_round(decoding, count,
              [&](std::size_t i) { static_cast<void>(load_gray_image(photo(i))); });
    run_round(colour, count, [&](std::size_t i) {
      static_cast<void>(cv::imread(photo(i).string(), cv::IMREAD_COLOR));
    });
    run_round(grey, count, [&](std::size_t i) {
      static_cast<void>(cv::imread(photo(i).string(), cv::IMREAD_GRAYSCALE));
    });
    run_round(hashing, count, [&](std::size_t i) {
      const Result<InputFile> file = read_input_file(photo(i));
      if (file) static_cast<void>(decode_gray_image("", file->bytes));
    });
    run_round(reading, count, [&](std::size_t i) {
      const Result<GrayImage> image = load_gray_image(photo(i));
      if (image) read_tags(image->view());
    });
    run_round(verifying, count, [&](std::size_t i) {
      const Result<VerifiedFile> report = verify_file(request, photo(i));
      if (report) static_cast<void>(to_json_line(*report));
    });
  }
  fmt::print("\n{}, {} photos a round, least of {} rounds, peak {:.0f} MB\n\n", folder.string(),
             count, kRounds, peak_megabytes());
  fmt::print("| | photos/s | processor ms/photo | / decoding | / imread grey | / imread |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  const auto print_row = [&](const char* what, const Cost& cost) {
    fmt::print("| {} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", what, 1 / cost.wall,
               1e3 * cost.processor, cost.processor / decoding.processor,
               cost.processor / grey.processor, cost.processor / colour.processor);
  };
  print_row("decoding alone", decoding);
  print_row("cv::imread, grey", grey);
  print_row("cv::imread, colour", colour);
  print_row("decoding and hashing", hashing);
  print_row("decoding and read_tags", reading);
  print_row("verify", verifying);
  return 0;
}

// Processor seconds of a shell command, the least of several runs.
double seconds_of_command(const std::string& command) {
  constexpr int kRuns = 15;
  double least = std::numeric_limits<double>::infinity();
  const auto of_children = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  };
  for (int run = 0; run < kRuns; ++run) {
    const double before = of_children();
    if (std::system(command.c_str()) != 0) return std::numeric_limits<double>::quiet_NaN();
    least = std::min(least, of_children() - before);
  }
  return least;
}

// The program with all codecs loaded from the start is what it would be if it were linked to them.
void print_start() {
  const std::string program = TAGSMITH_PROGRAM;
  const std::string codecs = "LD_PRELOAD=" TAGSMITH_CODECS " ";
  const auto print = [&](const char* what, const std::string& arguments) {
    const std::string command = program + " " + arguments + " > /dev/null";
    fmt::print("| {} | {:.0f} | {:.0f} |\n", what, 1e3 * seconds_of_command(command),
               1e3 * seconds_of_command(codecs + command));
  };
  fmt::print("\n| processor ms | | with all codecs loaded |\n|---|---|---|\n");
  print("tagsmith --version", "--version");
  print("tagsmith read, one photo", "read surveys/corridor/photos/corridor_01_left.jpg");
  print("tagsmith verify, 20 photos",
        "verify surveys/corridor/survey.yaml surveys/corridor/photos --json");
}

}  // namespace
}  // namespace tagsmith::detail

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::size_t count = 200;
  if (arguments.size() % 2 == 1) {
    count = std::max<std::size_t>(1, std::strtoull(arguments.front().c_str(), nullptr, 10));
    arguments.erase(arguments.begin());
  }
  if (arguments.empty()) {
    arguments = {"surveys/corridor/survey.yaml", "surveys/corridor/photos",
                 "surveys/curved/survey.yaml", "surveys/curved/photos"};
  }
  int worst = 0;
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    worst = std::max(worst, tagsmith::detail::measure(count, arguments[i], arguments[i + 1]));
  }
  tagsmith::detail::print_start();
  return worst;
}
