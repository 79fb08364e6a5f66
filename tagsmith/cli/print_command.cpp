// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_command.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/print_manifest.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/svg.hpp"
#include "tagsmith/render/tag_text.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith {
namespace {

constexpr const char* kSingleFile = "tags.pdf";

struct PrintOptions {
  std::string survey;
  std::string folder;
  std::string format = "both";
  std::vector<std::string> tags;  // names; empty = all
  bool single = false;
  bool json = false;
  int jobs = 0;  // 0 = all cores

  bool pdf() const { return format != "svg"; }
  bool svg() const { return format != "pdf"; }
};

Error unknown_tag(const Survey& survey, const std::string& name) {
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) names.push_back(tag.name);
  const std::optional<std::string> meant = nearest_word(name, names);
  return {fmt::format("--tags: survey {} has no tag \"{}\"{}", survey.name, name,
                      meant ? ", did you mean " + *meant + "?" : "")};
}

// In the survey's order, each once.
Result<std::vector<const PlacedTag*>> select_tags(const Survey& survey,
                                                  const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (find_tag(survey, name) == nullptr) return tl::unexpected(unknown_tag(survey, name));
  }
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) {
    if (names.empty() || std::ranges::count(names, tag.name) > 0) tags.push_back(&tag);
  }
  if (tags.empty()) return fail(survey.file.string() + ": has no tags to print");
  return tags;
}

// Tag names become file names.
Result<void> check_file_names(const std::vector<const PlacedTag*>& tags) {
  for (const PlacedTag* tag : tags) {
    const bool usable = !tag->name.empty() && tag->name.front() != '.' &&
                        tag->name.find('/') == std::string::npos && tag->name.size() < 200 &&
                        printable_text(tag->name) == tag->name;
    if (!usable) return fail("tag \"" + tag->name + "\": its name cannot be a file's name");
  }
  return {};
}

std::vector<PrintedTag> plan_files(const std::vector<const PlacedTag*>& tags,
                                   const PrintOptions& options) {
  std::vector<PrintedTag> printed;
  for (const PlacedTag* tag : tags) {
    PrintedTag item{tag, {}};
    if (options.pdf()) item.files.push_back(options.single ? kSingleFile : tag->name + ".pdf");
    if (options.svg()) item.files.push_back(tag->name + ".svg");
    printed.push_back(std::move(item));
  }
  return printed;
}

Result<void> write_tag(const Page& page, const std::string& name, const PrintOptions& options,
                       const StagedFiles& files) {
  if (options.pdf() && !options.single) {
    const Result<std::string> pdf = render_pdf(std::span(&page, 1));
    if (!pdf) return fail(pdf.error().message);
    if (auto added = files.add(name + ".pdf", *pdf); !added) return added;
  }
  return options.svg() ? files.add(name + ".svg", render_svg(page)) : Result<void>{};
}

Result<void> write_tags(const std::vector<Page>& pages, const std::vector<PrintedTag>& printed,
                        const PrintOptions& options, const StagedFiles& files) {
  std::vector<Result<void>> written(pages.size());
  tbb::task_arena arena(options.jobs > 0 ? options.jobs : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, pages.size(), [&](std::size_t i) {
      written[i] = write_tag(pages[i], printed[i].tag->name, options, files);
    });
  });
  const auto failed = std::ranges::find_if(written, [](const auto& result) { return !result; });
  return failed == written.end() ? Result<void>{} : *failed;
}

Result<void> write_single_pdf(const std::vector<Page>& pages, const Survey& survey,
                              const StagedFiles& files) {
  const PageNotes notes{survey.name, fmt::format("{} position tags, template {}", pages.size(),
                                                 survey.tag_template.name)};
  const Result<std::string> pdf = render_pdf(pages, notes);
  return pdf ? files.add(kSingleFile, *pdf) : fail(pdf.error().message);
}

Result<void> write_manifests(const Survey& survey, const Page& page,
                             const std::vector<PrintedTag>& printed, const StagedFiles& files) {
  if (auto added = files.add("manifest.json", print_manifest_json(survey, page, printed)); !added) {
    return added;
  }
  return files.add("manifest.csv", print_manifest_csv(survey, page, printed));
}

// What the files lack through no fault of the survey, said on standard error.
void warn(const Survey& survey, const Page& page) {
  if (survey.tag_template.label.shown && page.tags[0].drawing.label.empty()) {
    fmt::print(stderr,
               "tagsmith print: warning: template {}: no room for a label below the feature frame, "
               "the plates carry none\n",
               survey.tag_template.name);
  }
  if (!has_glyphs(survey.name)) {
    fmt::print(stderr,
               "tagsmith print: warning: no font on this machine has every character of the "
               "survey's name {}: install one, for example fonts-noto-cjk\n",
               survey.name);
  }
}

void report(const std::vector<PrintedTag>& printed, const PrintOptions& options) {
  const std::string folder = (std::filesystem::path(options.folder) / "").string();
  std::vector<std::string> others;
  if (options.pdf() && options.single) others.push_back(folder + kSingleFile);
  others.insert(others.end(), {folder + "manifest.json", folder + "manifest.csv"});
  for (const PrintedTag& item : printed) {
    if (options.json) fmt::print("{}\n", printed_tag_json(item, folder));
    for (const std::string& file : item.files) {
      if (!options.json && file != kSingleFile) fmt::print("{}\n", folder + file);
    }
  }
  if (options.json) {
    const nlohmann::json summary{{"summary", {{"count", printed.size()}, {"files", others}}}};
    fmt::print("{}\n", summary.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    for (const std::string& file : others) fmt::print("{}\n", file);
  }
}

Result<void> print(const PrintOptions& options) {
  if (options.single && !options.pdf()) return fail("--single makes one PDF, but --format is svg");
  if (!has_glyphs("0")) return fail("no font on this machine: install fonts-dejavu-core");
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey.error().message);
  const auto tags = select_tags(*survey, options.tags);
  if (!tags) return fail(tags.error().message);
  if (auto usable = check_file_names(*tags); !usable) return usable;
  const std::vector<PrintedTag> printed = plan_files(*tags, options);
  std::vector<Page> pages;
  for (const PlacedTag* tag : *tags) pages.push_back(tag_page(*survey, *tag));

  Result<StagedFiles> files = StagedFiles::begin(options.folder);
  if (!files) return fail(files.error().message);
  if (auto written = write_tags(pages, printed, options, *files); !written) return written;
  if (options.pdf() && options.single) {
    if (auto written = write_single_pdf(pages, *survey, *files); !written) return written;
  }
  if (auto written = write_manifests(*survey, pages.front(), printed, *files); !written) {
    return written;
  }
  if (auto published = files->publish(); !published) return published;
  warn(*survey, pages.front());
  report(printed, options);
  return {};
}

}  // namespace

Command print_command(CLI::App& parent) {
  CLI::App* app =
      parent.add_subcommand("print", "Print-ready PDF and SVG files of a survey's tags");
  const auto options = std::make_shared<PrintOptions>();
  app->add_option("SURVEY", options->survey, "Survey file (YAML)")->required();
  app->add_option("-o,--output", options->folder,
                  "Folder for the files and their manifest; made if missing")
      ->required();
  app->add_option("--format", options->format, "pdf, svg or both (default: both)")
      ->check(CLI::IsMember({"pdf", "svg", "both"}));
  app->add_option("--tags", options->tags, "Only these tags, by name, separated by commas")
      ->delimiter(',');
  app->add_flag("--single", options->single, "All tags in one PDF, tags.pdf, a page each");
  app->add_option("--jobs", options->jobs, "Cores to use at most (default: all)")
      ->check(CLI::Range(1, 1024));
  app->add_flag("--json", options->json, "One JSON object a printed tag, then a summary");
  app->footer(
      "Every page is the plate at true scale with crop marks, and a 100 mm scale bar in both\n"
      "directions in the margin: print at 100 %, then measure both.\n\n"
      "Example:\n"
      "  tagsmith print surveys/corridor/survey.yaml -o out/print\n"
      "  tagsmith print surveys/corridor/survey.yaml -o out/spares --format pdf --tags 000L,003R");
  return {app, [options] {
            const Result<void> printed = print(*options);
            return printed ? kExitOk : report_failure("print", printed.error());
          }};
}

}  // namespace tagsmith
