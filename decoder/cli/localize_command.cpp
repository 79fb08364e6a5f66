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
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/paper_method.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/geometry/angle.hpp"
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
  std::filesystem::path output;  // empty = none
  std::string method = "paper";
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

std::vector<Fix> localize_all(const LocalizeInput& input, const ReaderChoice& reader, int jobs) {
  const std::vector<Measurement>& measurements = input.run.measurements;
  std::vector<Fix> fixes(measurements.size());
  ProgressBar progress("measurements", measurements.size());
  run_in_order(measurements.size(), jobs, [&](std::size_t i) -> Delivery {
    const Observation seen = observe(measurements[i], input.surveys, input.rig, reader);
    fixes[i] = localize_by_paper(seen, input.surveys, input.rig);
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
  if (!fix.heading) return std::nullopt;
  return degrees(*fix.heading);
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
  if (summary.mean_error && summary.max_error) {
    values["mean_error_plane"] = summary.mean_error->plane;
    values["mean_error_z"] = summary.mean_error->height;
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

void print_summary(const FixSummary& summary) {
  fmt::print("{} measurements, {} located", summary.count, summary.located);
  if (summary.mean_error && summary.max_error) {
    fmt::print("; mean error {:.3f} m in the plane, {:.3f} m in z; greatest {:.3f} m, {:.3f} m",
               summary.mean_error->plane, summary.mean_error->height, summary.max_error->plane,
               summary.max_error->height);
  }
  fmt::print("\n");
}

void print_table(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements) {
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
  print_summary(summary);
}

// --- CSV ---

// RFC 4180, 2.5 to 2.7.
std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_number(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string();
}

std::string csv_row(const Fix& fix, const Measurement& measurement) {
  std::vector<std::string> fields{csv_field(fix.id), status_of(fix), fix.method,
                                  csv_field(fix.survey)};
  for (const int axis : {0, 1, 2}) {
    fields.push_back(fix.position_in_grid ? csv_number((*fix.position_in_grid)[axis]) : "");
  }
  fields.push_back(csv_number(heading_deg(fix)));
  for (const int row : {0, 1, 2}) {
    for (int column = row; column < 3; ++column) {
      fields.push_back(fix.covariance_in_grid ? csv_number((*fix.covariance_in_grid)(row, column))
                                              : "");
    }
  }
  const std::optional<FixError> error = error_of(fix, measurement);
  fields.push_back(csv_field(tags_text(fix)));
  fields.push_back(error ? csv_number(error->plane) : "");
  fields.push_back(error ? csv_number(error->height) : "");
  fields.push_back(csv_field(fix.reason));
  fields.push_back(csv_field(fmt::format("{}", fmt::join(fix.notes, "; "))));
  return fmt::format("{}\n", fmt::join(fields, ","));
}

std::string csv_text(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements) {
  std::string text =
      "id,status,method,survey,x,y,z,heading_deg,covariance_xx,covariance_xy,covariance_xz,"
      "covariance_yy,covariance_yz,covariance_zz,tags,error_plane,error_z,reason,notes\n";
  for (std::size_t i = 0; i < fixes.size(); ++i) text += csv_row(fixes[i], measurements[i]);
  return text;
}

int run_localize(const LocalizeOptions& options) {
  const Result<LocalizeInput> input = load(options);
  if (!input) return report_failure(kName, input.error());
  const std::vector<Measurement>& measurements = input->run.measurements;
  const std::vector<Fix> fixes = localize_all(*input, reader_named(options.reader), options.jobs);
  if (!options.output.empty()) {
    const Result<void> written = write_file(options.output, csv_text(fixes, measurements));
    if (!written) return report_failure(kName, written.error());
  }
  options.json ? print_json(fixes, measurements) : print_table(fixes, measurements);
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
      ->check(CLI::IsMember({"paper"}))
      ->capture_default_str();
  app->add_option("--reader", options->reader,
                  "What reads the images: this program's reader, or the paper's published pipeline")
      ->check(CLI::IsMember({"tagsmith", "paper"}))
      ->capture_default_str();
  app->add_flag("--json", options->json, "One JSON object a line, the summary last");
  app->add_option("-o,--output", options->output, "Write the positions to this file too")
      ->type_name("FIXES.csv");
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
