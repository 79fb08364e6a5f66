// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/export_command.hpp"

#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/tag_list.hpp"
#include "tagsmith/render/dxf.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

struct ExportOptions {
  std::string survey;
  std::string output;
  std::string format;  // empty = by the name of the output
};

Result<std::string> format_of(const ExportOptions& options) {
  if (!options.format.empty()) return options.format;
  if (options.output == "-") return std::string("csv");
  for (const char* format : {"wpilib.json", "csv", "json", "dxf"}) {
    if (!options.output.ends_with(std::string(".") + format)) continue;
    return std::string(format).substr(0, std::string(format).find('.'));
  }
  return fail("--output " + options.output +
              ": expected a name that ends in .csv, .json, .wpilib.json or .dxf, or --format");
}

std::string render(const Survey& survey, const std::string& format) {
  if (format == "json") return tags_json(survey);
  if (format == "wpilib") return field_layout_json(survey);
  return format == "dxf" ? render_dxf(survey) : tags_csv(survey);
}

Result<void> run_export(const ExportOptions& options) {
  const Result<std::string> format = format_of(options);
  if (!format) return fail(format.error().message);
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey.error().message);
  if (options.output == "-") {
    bytes_to_stdout(render(*survey, *format));
    return {};
  }
  CommandFiles files;
  files.reads(*survey);
  files.writes(options.output, "--output");
  if (auto usable = files.check(); !usable) return usable;
  if (auto written = publish_files({{options.output, render(*survey, *format)}}); !written) {
    return written;
  }
  to_stderr("{} tags in {}\n", survey->tags.size(), options.output);
  return {};
}

}  // namespace

Command export_command() {
  const auto options = std::make_shared<ExportOptions>();
  return {
      .name = "export",
      .summary = "A survey's tags as CSV, JSON, DXF or WPILib field layout",
      .options = {survey_argument(&options->survey, "Survey file (YAML)"),
                  required(file_option(
                      "-o,--output", &options->output,
                      "FILE.csv, FILE.json, FILE.wpilib.json or FILE.dxf; - for standard "
                      "output")),
                  {.names = "--format",
                   .target = &options->format,
                   .help = "What is written (default: by the file's name; csv for -)",
                   .choices = {"csv", "json", "wpilib", "dxf"}}},
      .notes =
          "The CSV goes back by `tagsmith new NAME --from FILE --order own`. CSV, JSON and DXF are "
          "in the grid, the WPILib field layout in the right-handed frame that WPILib wants.\n\n"
          "Example:\n"
          "  tagsmith export surveys/corridor/survey.yaml -o out/corridor.csv\n"
          "  tagsmith export surveys/corridor/survey.yaml -o out/corridor.dxf",
      .run =
          [options] {
            const Result<void> done = run_export(*options);
            return done ? kExitOk : report_failure("export", done.error());
          },
  };
}

}  // namespace tagsmith::detail
