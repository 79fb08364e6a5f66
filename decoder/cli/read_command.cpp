// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <iostream>
#include <map>
#include <memory>

#include <fmt/core.h>

#include "decoder/cli/commands.hpp"
#include "decoder/cli/file_list.hpp"
#include "decoder/cli/read_json.hpp"
#include "decoder/image/load.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/reader/explain.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReadNotes = R"(Example:
  tagsmith read surveys/corridor/photos --survey surveys/corridor/survey.yaml

--json prints one object an image: image, width, height, tags (digits, check_digit, position,
corners P F lower-right Q in pixels or null, module_px, confidence, method), with --survey parts
(tags of which a part is in sight), rejected (reason, corners), time_ms. Exit: 0 a tag was read, 1 no image has a readable tag, 2 an image could not be read.)";

struct ReadCommandOptions {
  std::vector<std::string> images;
  bool white_on_black = false;
  std::vector<std::string> surveys;
  std::string check;
  std::string reader = "tagsmith";
  std::string frameless = "fallback";
  std::string explain;  // folder; empty = none
  bool json = false;
  int jobs = 0;
};

std::size_t tag_count(const ReadResult& result) {
  return result.tags.size() + result.frameless.read.size();
}

struct Tally {
  std::size_t tags = 0;
  bool unreadable_file = false;
};

Result<ReadOptions> read_options(const ReadCommandOptions& options,
                                 const std::vector<Survey>& surveys) {
  ReadOptions read = read_options_for(surveys);
  if (!options.check.empty()) read.check = parse_check_digit(options.check);
  read.white_on_black = read.white_on_black || options.white_on_black;
  read.tell_passed_over = !options.explain.empty();
  if (options.frameless != "never") {
    read.frameless = options.frameless == "always" ? Frameless::always : Frameless::fallback;
  }
  if (!surveys.empty() && read.code_book.empty()) {
    return fail("the surveys given with --survey have no tags, expected at least one");
  }
  return read;
}

// The drawing of each picture, named after it, with its number too where two pictures have one
// name. None without a folder.
std::vector<fs::path> explanation_paths(const fs::path& folder,
                                        const std::vector<fs::path>& files) {
  if (folder.empty()) return {};
  std::map<fs::path, int> count;
  for (const fs::path& file : files) ++count[file.stem()];
  std::vector<fs::path> paths;
  for (const fs::path& file : files) {
    const std::string number = count[file.stem()] > 1 ? fmt::format("_{}", paths.size() + 1) : "";
    paths.push_back(folder / (file.stem().string() + number + ".explained.png"));
  }
  return paths;
}

Result<void> write_explanation(const GrayView& image, const ReadResult& result,
                               const fs::path& path) {
  const Result<std::string> png = draw_explanation(image, explain(result));
  if (!png) return fail(png);
  return write_file(path, *png);
}

// Reads one picture and, if it has a path for a drawing, draws the reasons for the result.
Result<ImageReadings> read_image(const fs::path& path, const std::string& reader,
                                 const ReadOptions& options,
                                 const std::optional<fs::path>& explanation) {
  const Result<DecodedImage> loaded = load_image(path);
  if (!loaded) return fail(loaded);
  const GrayImage& image = loaded->image;
  const auto start = std::chrono::steady_clock::now();
  ReadResult result =
      reader == "paper" ? read_tags_paper(image.view(), options) : read_tags(image.view(), options);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  if (explanation) {
    const auto written = write_explanation(image.view(), result, *explanation);
    if (!written) return fail(path.string() + ": " + written.error().message);
  }
  return ImageReadings{path,         image.width,    image.height, std::move(result),
                       time.count(), loaded->warning};
}

// The tag's digits, position and check digit, and its name where a survey has it.
template <class AnyReading>
std::string code_in_words(const AnyReading& tag, const std::vector<Survey>& surveys) {
  const GridPoint position = coded_position(tag.digits, surveys);
  return fmt::format("  {}  x {} y {} z {}  {}", to_string(tag.digits), format_number(position[0]),
                     format_number(position[1]), format_number(position[2]), check_digit_name(tag));
}

std::string name_in_words(const Digits& digits, const std::vector<Survey>& surveys) {
  std::string name;
  for (const Survey& survey : surveys) {
    const PlacedTag* placed = find_tag(survey, digits);
    if (placed != nullptr) name = fmt::format("  {} of {}", placed->name, survey.name);
  }
  return name;
}

std::string candidates_in_words(const PartReading& part, const std::vector<Survey>& surveys) {
  std::string text;
  for (const PartCandidate& candidate : part.candidates) {
    if (!text.empty()) text += " or";
    text += name_in_words(candidate.digits, surveys);
  }
  return text;
}

void print_in_words(const ImageReadings& readings, const std::vector<Survey>& surveys) {
  const ReadResult& result = readings.result;
  const std::size_t count = tag_count(result);
  to_stdout("{}: {} {}\n", readings.image.string(), count, count == 1 ? "tag" : "tags");
  for (const Reading& tag : result.tags) {
    to_stdout("{}  P at ({:.1f}, {:.1f})  {:.1f} px/module{}\n", code_in_words(tag, surveys),
              tag.corners[0].x, tag.corners[0].y, tag.module_px,
              name_in_words(tag.digits, surveys));
  }
  for (const FramelessReading& tag : result.frameless.read) {
    to_stdout("{}  no frame: bars at ({:.0f}, {:.0f})  {:.1f} px/module{}\n",
              code_in_words(tag, surveys), tag.bars[0].x, tag.bars[0].y, tag.module_px,
              name_in_words(tag.digits, surveys));
  }
  for (const PartReading& part : result.parts) {
    to_stdout("  {}  in part, {:.0f} % in sight:{}\n", digits_in_sight(part), 100 * part.share,
              candidates_in_words(part, surveys));
  }
  for (const Rejection& rejection : result.rejected) {
    to_stdout("  refused at ({:.0f}, {:.0f}): {}\n", rejection.corners[0].x, rejection.corners[0].y,
              describe(rejection));
  }
  for (const FramelessRejection& rejection : result.frameless.rejected) {
    to_stdout("  refused at ({:.0f}, {:.0f}): no frame: {}\n", rejection.symbol.bars[0].x,
              rejection.symbol.bars[0].y, describe(rejection));
  }
}

Tally read_all(const ReadCommandOptions& options, const std::vector<fs::path>& files,
               const std::vector<fs::path>& explanations, const std::vector<Survey>& surveys,
               const ReadOptions& read) {
  Tally tally;
  const auto read_one = [&](std::size_t i) {
    std::optional<fs::path> explanation;
    if (!explanations.empty()) explanation = explanations[i];
    return read_image(files[i], options.reader, read, explanation);
  };
  const auto print = [&](std::size_t i, const Result<ImageReadings>& readings) {
    if (!readings) {
      report_failure("read", readings.error());
      tally.unreadable_file = true;
      return;
    }
    tally.tags += tag_count(readings->result);
    if (!readings->warning.empty()) {
      to_stderr("tagsmith read: {}: {}\n", files[i].string(), damaged_in_words(readings->warning));
    }
    if (options.json) {
      to_stdout("{}\n", to_json_line(*readings, surveys));
    } else {
      print_in_words(*readings, surveys);
    }
  };
  run_below_bar("images", files.size(), options.jobs, read_one, print);
  return tally;
}

Result<void> check_files(const std::vector<Survey>& surveys, const std::vector<fs::path>& images,
                         const std::vector<fs::path>& explanations) {
  CommandFiles files;
  for (const Survey& survey : surveys) files.reads(survey);
  for (const fs::path& image : images) files.reads(image, "the picture");
  for (const fs::path& path : explanations) files.writes(path, "--explain");
  return files.check();
}

Result<int> run(const ReadCommandOptions& options) {
  const Result<std::vector<Survey>> surveys =
      load_surveys({options.surveys.begin(), options.surveys.end()});
  if (!surveys) return fail(surveys);
  const Result<ReadOptions> read = read_options(options, *surveys);
  if (!read) return fail(read);
  const Result<FileList> list = list_files(options.images, image_extensions(), std::cin);
  if (!list) return fail(list);
  const std::vector<fs::path> explanations = explanation_paths(options.explain, list->files);
  if (auto usable = check_files(*surveys, list->files, explanations); !usable) {
    return fail(usable);
  }
  const Tally tally = read_all(options, list->files, explanations, *surveys, *read);
  if (!list->skipped.empty()) {
    to_stderr("tagsmith read: skipped, no pictures: {}\n", skipped_in_words(list->skipped));
  }
  if (tally.unreadable_file) return kExitFailure;
  return tally.tags > 0 ? kExitOk : kExitFindings;
}

}  // namespace

Command read_command() {
  const auto options = std::make_shared<ReadCommandOptions>();
  return {
      .name = "read",
      .summary = "Decode the tags in pictures; needs no survey",
      .options = {required(argument(
                      "IMAGE", &options->images, ValueKind::picture,
                      "Pictures, folders of pictures, or - for a list of files on standard input")),
                  value_option("--survey", &options->surveys, "SURVEY",
                               "Read only the codes of this survey; reaches smaller tags",
                               ValueKind::survey),
                  choice_option("--check", &options->check, {"sum10", "gs1"},
                                "Check digit that a tag must have (default: either)"),
                  flag("--white-on-black", &options->white_on_black,
                       "The plates are white on black (a survey's template says so itself)"),
                  with_default(choice_option(
                      "--reader", &options->reader, {"tagsmith", "paper"},
                      "tagsmith, or paper: the published pipeline, literally, for comparison")),
                  with_default(choice_option(
                      "--frameless", &options->frameless, {"fallback", "always", "never"},
                      "Read symbols without a feature frame: fallback (where a picture has no tag "
                      "with one), always, or never")),
                  folder_option("--explain", &options->explain,
                                "Folder for a drawing of each picture: frames, corners, scan "
                                "lines, digits with their margins, what was refused and why"),
                  json_flag(options->json, "One JSON object an image"),
                  jobs_option(options->jobs, "Pictures read at once")},
      .notes = kReadNotes,
      .run = [options] { return run(*options); },
  };
}

}  // namespace tagsmith::detail
