// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/tag_list.hpp"
#include "tagsmith/render/survey_exchange.hpp"
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
  static const std::vector<std::pair<std::string, std::string>> formats{{".wpilib.json", "wpilib"},
                                                                        {".csv", "csv"},
                                                                        {".json", "json"},
                                                                        {".dxf", "dxf"},
                                                                        {".geojson", "geojson"},
                                                                        {".gpkg", "gpkg"},
                                                                        {".landxml", "landxml"},
                                                                        {".xml", "landxml"},
                                                                        {".gsi", "gsi"}};
  for (const auto& [ending, format] : formats) {
    if (options.output.ends_with(ending)) return format;
  }
  return fail("--output " + options.output +
              ": expected a name that ends in .csv, .json, .geojson, .gpkg, .landxml, .xml, .gsi, "
              ".wpilib.json or .dxf, or --format");
}

Result<std::string> render(const Survey& survey, const std::string& format) {
  if (format == "json") return tags_json(survey);
  if (format == "wpilib") return field_layout_json(survey);
  if (format == "geojson") return tags_geojson(survey);
  if (format == "gpkg") return tags_geopackage(survey);
  if (format == "landxml") return render_landxml(survey);
  if (format == "gsi") return render_gsi(survey);
  return format == "dxf" ? render_dxf(survey) : tags_csv(survey);
}

Result<int> run_export(const ExportOptions& options) {
  const Result<std::string> format = format_of(options);
  if (!format) return fail(format);
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey);
  const Result<std::string> bytes = render(*survey, *format);
  if (!bytes) return fail(bytes);
  if (options.output == "-") {
    bytes_to_stdout(*bytes);
    return kExitOk;
  }
  CommandFiles files;
  files.reads(*survey);
  files.writes(options.output, "--output");
  if (auto usable = files.check(); !usable) return fail(usable);
  if (auto written = publish_files({{options.output, *bytes}}); !written) {
    return fail(written);
  }
  to_stderr("{} tags in {}\n", survey->tags.size(), options.output);
  if (*format == "geojson" && survey->grid.epsg == 0) {
    to_stderr(
        "the survey does not name its grid (grid: {{ crs: EPSG:25832 }}): many programs will "
        "take the coordinates for degrees\n");
  }
  return kExitOk;
}

}  // namespace

Command export_command() {
  const auto options = std::make_shared<ExportOptions>();
  return {
      .name = "export",
      .summary = "A survey's tags for CAD, GIS, instruments and other programs",
      .options = {survey_argument(&options->survey, "Survey file (YAML)"),
                  required(file_option("-o,--output", &options->output,
                                       "FILE.csv, .json, .geojson, .gpkg, .landxml (or .xml), "
                                       ".gsi, .wpilib.json or .dxf; - for standard output")),
                  choice_option(
                      "--format", &options->format,
                      {"csv", "json", "geojson", "gpkg", "landxml", "gsi", "wpilib", "dxf"},
                      "What is written (default: by the file's name; csv for -)")},
      .notes =
          "The CSV goes back by `tagsmith new NAME --from FILE --order own`. All are in the grid; "
          "only the WPILib field layout is in the right-handed frame that WPILib wants. GeoJSON, "
          "GeoPackage and LandXML name the grid by the survey's key grid.crs.\n\n"
          "Example:\n"
          "  tagsmith export surveys/corridor/survey.yaml -o out/corridor.csv\n"
          "  tagsmith export surveys/corridor/survey.yaml -o out/corridor.dxf",
      .run = [options] { return run_export(*options); },
  };
}

}  // namespace tagsmith::detail
