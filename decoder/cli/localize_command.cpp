// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/localize_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "decoder/cli/fix_files.hpp"
#include "decoder/cli/run_drawing.hpp"
#include "decoder/localize/fix.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/paper_method.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/paper/published.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith {
namespace {

constexpr const char* kName = "localize";

struct LocalizeOptions {
  std::vector<std::filesystem::path> surveys;
  std::filesystem::path rig;
  std::filesystem::path run;
  std::filesystem::path csv;  // these three: empty = none
  std::filesystem::path tum;
  std::filesystem::path drawing;
  std::string method = "joint";
  std::string reader = "tagsmith";
  bool json = false;
  int jobs = 0;  // 0 = as many as the process may use
};

struct LocalizeInput {
  std::vector<Survey> surveys;
  Rig rig;
  Run run;
};

Result<LocalizeInput> load(const LocalizeOptions& options) {
  auto surveys = load_surveys(options.surveys);
  if (!surveys) return fail(surveys.error().message);
  auto rig = load_rig(options.rig);
  if (!rig) return fail(rig.error().message);
  auto run = load_run(options.run, *rig);
  if (!run) return fail(run.error().message);
  return LocalizeInput{std::move(*surveys), std::move(*rig), std::move(*run)};
}

ReaderChoice reader_named(const std::string& name) {
  if (name == "paper") return {read_tags_paper, kOutlineCornerSigmaPx};
  return {read_tags, kFittedCornerSigmaPx};
}

std::vector<Fix> localize_all(const LocalizeInput& input, const ReaderChoice& reader,
                              const std::string& method, int jobs) {
  const std::vector<Measurement>& measurements = input.run.measurements;
  std::vector<Fix> fixes(measurements.size());
  ProgressBar progress("measurements", measurements.size());
  run_in_order(measurements.size(), jobs, [&](std::size_t i) -> Delivery {
    const Observation seen = observe(measurements[i], input.surveys, input.rig, reader);
    fixes[i] = method == "paper" ? localize_by_paper(seen, input.surveys, input.rig)
                                 : localize_jointly(seen, input.surveys, input.rig);
    return [&progress] { progress.advance([] {}); };
  });
  return fixes;
}

// --- JSON ---

using Json = nlohmann::ordered_json;

Json json_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json json_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json position_json(const Fix& fix) {
  if (!fix.position_in_grid) return {};
  const Eigen::Vector3d& position = *fix.position_in_grid;
  return {position.x(), position.y(), position.z()};
}

Json covariance_json(const Fix& fix) {
  if (!fix.covariance_in_grid) return {};
  Json numbers = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      numbers.push_back((*fix.covariance_in_grid)(row, column));
    }
  }
  return numbers;
}

std::optional<double> heading_deg(const Fix& fix) {
  if (!fix.attitude) return std::nullopt;
  return degrees(fix.attitude->heading);
}

Json fix_json(const Fix& fix, const Measurement& measurement) {
  Json line{{"id", fix.id},
            {"status", status_of(fix)},
            {"method", fix.method},
            {"survey", json_or_null(fix.survey)},
            {"position", position_json(fix)},
            {"heading_deg", json_or_null(heading_deg(fix))},
            {"covariance", covariance_json(fix)},
            {"tags", fix.tags},
            {"reason", json_or_null(fix.reason)},
            {"notes", fix.notes}};
  if (const auto error = error_of(fix, measurement)) {
    line["error_plane"] = error->plane;
    line["error_z"] = error->height;
  }
  return line;
}

Json summary_json(const FixSummary& summary) {
  Json values{{"count", summary.count}, {"located", summary.located}};
  if (summary.mean_error && summary.error95 && summary.max_error) {
    values["mean_error_plane"] = summary.mean_error->plane;
    values["mean_error_z"] = summary.mean_error->height;
    values["error95_plane"] = summary.error95->plane;
    values["error95_z"] = summary.error95->height;
    values["max_error_plane"] = summary.max_error->plane;
    values["max_error_z"] = summary.max_error->height;
  }
  return {{"summary", std::move(values)}};
}

// Ids and file names come from files and may not be UTF-8.
void print_line(const Json& line) {
  fmt::print("{}\n", line.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void print_json(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements) {
  for (std::size_t i = 0; i < fixes.size(); ++i) print_line(fix_json(fixes[i], measurements[i]));
  print_line(summary_json(summarize(fixes, measurements)));
}

// --- table ---

std::string tags_text(const Fix& fix) { return fmt::format("{}", fmt::join(fix.tags, " ")); }

std::string sigma_text(const Fix& fix, int axis) {
  if (!fix.covariance_in_grid) return "-";
  return fmt::format("{:.3f}", std::sqrt((*fix.covariance_in_grid)(axis, axis)));
}

std::string row_text(const Fix& fix, const Measurement& measurement) {
  if (!fix.position_in_grid) return "no position: " + fix.reason;
  const Eigen::Vector3d& position = *fix.position_in_grid;
  std::string row =
      fmt::format("{:9.3f} {:9.3f} {:9.3f}  {:>6} {:>6} {:>6}", position.x(), position.y(),
                  position.z(), sigma_text(fix, 0), sigma_text(fix, 1), sigma_text(fix, 2));
  if (const auto error = error_of(fix, measurement)) {
    row += fmt::format("  {:11.3f} {:7.3f}", error->plane, error->height);
  }
  return row;
}

// Each note once, with the ids it is for.
void print_notes(const std::vector<Fix>& fixes) {
  std::map<std::string, std::vector<std::string>> ids_of_note;
  for (const Fix& fix : fixes) {
    for (const std::string& note : fix.notes) ids_of_note[note].push_back(fix.id);
  }
  for (const auto& [note, ids] : ids_of_note)
    fmt::print("note {}: {}\n", fmt::join(ids, ", "), note);
}

void print_summary(const FixSummary& summary, const PublishedErrors& published) {
  fmt::print("{} measurements, {} located", summary.count, summary.located);
  if (summary.mean_error && summary.error95 && summary.max_error) {
    fmt::print(
        "; mean error {:.4f} m in the plane, {:.4f} m in z; 95 % {:.4f} m, {:.4f} m; greatest "
        "{:.4f} m, {:.4f} m\n",
        summary.mean_error->plane, summary.mean_error->height, summary.error95->plane,
        summary.error95->height, summary.max_error->plane, summary.max_error->height);
    fmt::print("Xu et al. 2017, {}: mean error {:.3f} m in the plane, {:.3f} m in z",
               published.experiment, published.mean_plane, published.mean_height);
  }
  fmt::print("\n");
}

void print_table(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements,
                 const PublishedErrors& published) {
  std::size_t id_width = 2;
  std::size_t tags_width = 4;
  for (const Fix& fix : fixes) {
    id_width = std::max(id_width, fix.id.size());
    tags_width = std::max(tags_width, tags_text(fix).size());
  }
  const FixSummary summary = summarize(fixes, measurements);
  fmt::print("{:<{}}  {:<{}}  {:>9} {:>9} {:>9}  {:>20}{}\n", "id", id_width, "tags", tags_width,
             "x", "y", "z", "sigma of x, y, z", summary.mean_error ? "  error plane       z" : "");
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    fmt::print("{:<{}}  {:<{}}  {}\n", fixes[i].id, id_width, tags_text(fixes[i]), tags_width,
               row_text(fixes[i], measurements[i]));
  }
  print_notes(fixes);
  print_summary(summary, published);
}

// --- files ---

// Writes each file whole or not at all; none when one cannot be made.
Result<void> write_files(const LocalizeOptions& options, const LocalizeInput& input,
                         const std::vector<Fix>& fixes) {
  std::vector<SheetFile> files;
  if (!options.csv.empty()) {
    files.push_back({options.csv, fixes_csv(fixes, input.run.measurements)});
  }
  if (!options.tum.empty()) {
    auto text = fixes_tum(fixes, input.run, input.surveys);
    if (!text) return tl::unexpected(text.error());
    files.push_back({options.tum, std::move(*text)});
  }
  if (!options.drawing.empty()) {
    const auto sheets = draw_run(input.surveys.front(), input.rig, input.run, fixes);
    if (!sheets) return tl::unexpected(sheets.error());
    auto pages = render_sheets(*sheets, options.drawing);
    if (!pages) return tl::unexpected(pages.error());
    files.insert(files.end(), pages->begin(), pages->end());
  }
  for (const SheetFile& file : files) {
    if (auto written = write_file(file.path, file.bytes); !written) return written;
  }
  return {};
}

// What can be known to be wrong before the work.
Result<void> check_options(const LocalizeOptions& options) {
  if (!options.drawing.empty() && !sheet_format_of(options.drawing)) {
    return fail("--drawing " + options.drawing.string() +
                ": expected a name that ends in .pdf, .svg or .png");
  }
  if (!options.drawing.empty() && options.surveys.size() > 1) {
    return fail("--drawing shows one tunnel, expected one survey");
  }
  if (!options.drawing.empty() && !has_glyphs("0")) {
    return fail("--drawing: no font on this machine: install fonts-dejavu-core");
  }
  return {};
}

int run_localize(const LocalizeOptions& options) {
  if (const auto usable = check_options(options); !usable) {
    return report_failure(kName, usable.error());
  }
  const Result<LocalizeInput> input = load(options);
  if (!input) return report_failure(kName, input.error());
  const std::vector<Measurement>& measurements = input->run.measurements;
  const std::vector<Fix> fixes =
      localize_all(*input, reader_named(options.reader), options.method, options.jobs);
  if (const auto written = write_files(options, *input, fixes); !written) {
    return report_failure(kName, written.error());
  }
  const PublishedErrors& published = published_errors_for(input->surveys.front().tunnel.centerline);
  options.json ? print_json(fixes, measurements) : print_table(fixes, measurements, published);
  const auto is_located = [](const Fix& fix) { return fix.position_in_grid.has_value(); };
  return std::ranges::all_of(fixes, is_located) ? kExitOk : kExitFindings;
}

}  // namespace

Command localize_command(CLI::App& parent) {
  const auto options = std::make_shared<LocalizeOptions>();
  CLI::App* app = parent.add_subcommand(
      kName, "The vehicle's position at each measurement of a run, from what its cameras saw");
  app->add_option("surveys", options->surveys, "Survey files of the tunnel (survey.yaml)")
      ->required()
      ->type_name("SURVEY");
  app->add_option("--rig", options->rig, "The vehicle's cameras and range sensors (rig.yaml)")
      ->required()
      ->type_name("RIG");
  app->add_option("--run", options->run, "The measurements: images or distances, and ranges")
      ->required()
      ->type_name("RUN.csv");
  app->add_option("--method", options->method,
                  "paper: closed form from a tag on each wall and the range to the left wall")
      ->check(CLI::IsMember({"joint", "paper"}))
      ->capture_default_str();
  app->add_option("--reader", options->reader,
                  "What reads the images: this program's reader, or the paper's published pipeline")
      ->check(CLI::IsMember({"tagsmith", "paper"}))
      ->capture_default_str();
  app->add_flag("--json", options->json, "One JSON object a line, the summary last");
  app->add_option("-o,--output,--csv", options->csv, "Write the positions to this table too")
      ->type_name("FIXES.csv");
  app->add_option("--tum", options->tum,
                  "Write the trajectory (TUM format); needs the run's column time")
      ->type_name("FILE");
  app->add_option("--drawing", options->drawing,
                  "Draw the run in the tunnel's plan, with ellipses and errors: .pdf, .svg or .png")
      ->type_name("FILE");
  app->add_option("--jobs", options->jobs, "Images read at the same time (0 = all processors)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app->footer(
      "Positions are in the survey's grid, metres. Exit code 0: every measurement located; 1: some "
      "have no\nposition, each with its reason; 2: a survey, rig or run could not be used.\n\n"
      "Example:\n  tagsmith localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml "
      "--run surveys/corridor/run.csv");
  return {app, [options] { return run_localize(*options); }};
}

}  // namespace tagsmith
