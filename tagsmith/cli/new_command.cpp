// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/new_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/source_excerpt.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/survey/draft_survey.hpp"
#include "tagsmith/survey/fit_tunnel.hpp"
#include "tagsmith/survey/point_list.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

struct NewOptions {
  std::string name;
  std::string points;
  PointListOptions list;
  std::string template_name = "tag-400x300";
  std::string x_axis = "right";
  std::string check_digit = "gs1";
  std::string walls = "parallel";
  double tolerance_mm = 30;
  std::optional<double> mount_height;
  std::optional<double> tunnel_height;
  bool json = false;
};

// NAME may be a path; the survey has its last part's name.
std::string survey_name(const NewOptions& options) {
  const fs::path path = fs::path(options.name) / "";
  return path.parent_path().filename().string();
}

Result<void> check_name(const NewOptions& options) {
  const std::string name = survey_name(options);
  const bool usable = !name.empty() && is_plain_text(name) &&
                      name.find_first_of("\\,:\"'#{}[]&*!|>%@`") == std::string::npos &&
                      name.front() != '.' && name.front() != '-' && name.front() != '?' &&
                      name.find_first_not_of("0123456789.+-eE") != std::string::npos &&
                      name != "true" && name != "false" && name != "null" && name.size() <= 100;
  if (!usable) {
    return fail("NAME " + options.name +
                ": expected a folder to make, whose name has letters and no , : \" or the like");
  }
  for (const char* file : {"survey.yaml", "rig.yaml"}) {
    const fs::path path = fs::path(options.name) / file;
    std::error_code ignored;
    if (fs::exists(path, ignored)) return fail(path.string() + ": is there already");
  }
  return {};
}

Result<void> write_files(const NewOptions& options, const std::string& survey,
                         const std::optional<std::string>& rig) {
  Result<StagedFiles> files = StagedFiles::begin(options.name);
  if (!files) return fail(files.error().message);
  if (auto added = files->add("survey.yaml", survey); !added) return added;
  if (rig) {
    if (auto added = files->add("rig.yaml", *rig); !added) return added;
  }
  return files->publish();
}

Result<void> write_to_edit(const NewOptions& options) {
  const std::string name = survey_name(options);
  if (auto written = write_files(options, survey_to_edit(name), rig_to_edit(name)); !written) {
    return written;
  }
  const fs::path folder = options.name;
  to_stdout("{}\n{}\n", (folder / "survey.yaml").string(), (folder / "rig.yaml").string());
  to_stderr("edit them, then: tagsmith validate {} --rig {}\n", (folder / "survey.yaml").string(),
            (folder / "rig.yaml").string());
  return {};
}

Result<TagTemplate> named_template(const std::string& name, const fs::path& folder) {
  const auto path = find_template(name, folder);
  if (!path) return fail("no template `" + name + "`; own templates: " + own_templates());
  const Result<TemplateReading> reading = read_template(*path);
  if (!reading) return tl::unexpected(reading.error());
  if (!reading->tag) return fail(to_string(reading->diagnostics, true));
  return *reading->tag;
}

Result<SurveyDraft> make_draft(const NewOptions& options) {
  Result<PointListReading> reading = read_point_list(options.points, options.list);
  if (!reading) return tl::unexpected(reading.error());
  if (!reading->list) return fail(to_string(reading->diagnostics, true));
  PointList& list = *reading->list;
  SurveyDraft draft;
  draft.name = survey_name(options);
  draft.source = fs::path(options.points).filename().string();
  draft.template_name = list.survey ? list.survey->tag_template : options.template_name;
  draft.grid = list.survey ? list.survey->grid : Grid{options.x_axis == "left"};
  const auto tag = named_template(draft.template_name, options.name);
  if (!tag) return tl::unexpected(tag.error());
  TunnelFitOptions fit_options;
  fit_options.tolerance = options.tolerance_mm / 1000;
  fit_options.mount_height = options.mount_height;
  fit_options.roof_height = options.tunnel_height;
  fit_options.measured_walls = options.walls == "measured";
  draft.tag = *tag;
  Result<TunnelFit> fit = fit_tunnel(list.points, draft.grid, *tag, fit_options);
  if (!fit) return fail(options.points + ": " + fit.error().message);
  draft.fit = std::move(*fit);
  draft.points = std::move(list.points);
  number_tags(draft.points, draft.fit);
  const Result<PositionCode> code =
      list.survey ? list.survey->code
                  : code_for(draft.points, *parse_check_digit(options.check_digit));
  if (!code) return fail(options.points + ": " + code.error().message);
  draft.code = *code;
  return draft;
}

std::string point_name(const SurveyedPoint& point) {
  return point.tag ? tag_name(point.tag->pair, point.tag->side) : point.name;
}

void print_json(const SurveyDraft& draft) {
  using Json = nlohmann::ordered_json;
  const auto length = [](const std::optional<double>& value) {
    return value ? Json(std::round(*value * 1e6) / 1e6) : Json(nullptr);
  };
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    const PointResidual& residual = draft.fit.residuals[i];
    to_stdout("{}\n", json_text({{"line", draft.points[i].line},
                                 {"point", draft.points[i].name},
                                 {"name", point_name(draft.points[i])},
                                 {"kind", to_string(draft.points[i].kind)},
                                 {"chainage", length(residual.chainage)},
                                 {"across", length(residual.across)},
                                 {"up", length(residual.up)}}));
  }
  const Tunnel& tunnel = draft.fit.tunnel;
  to_stdout("{}\n", json_text({{"summary",
                                {{"points", draft.points.size()},
                                 {"width", length(width_at(tunnel, 0))},
                                 {"least_width", length(least_width(tunnel))},
                                 {"greatest_width", length(greatest_width(tunnel))},
                                 {"height", length(tunnel.height.at(0))},
                                 {"length", length(tunnel.centerline.length())},
                                 {"elements", tunnel.centerline.elements().size()},
                                 {"rms_across", length(draft.fit.rms_across)},
                                 {"rms_up", length(draft.fit.rms_up)}}}}));
}

void print_table(const SurveyDraft& draft) {
  const auto mm = [](const std::optional<double>& value) {
    return value ? fmt::format("{:+.1f}", *value * 1000 + 0.0) : std::string("-");
  };
  to_stdout("{:>6}  {:<12}  {:<11}  {:>10}  {:>9}  {:>9}\n", "line", "point", "kind", "chainage",
            "across mm", "up mm");
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    const PointResidual& residual = draft.fit.residuals[i];
    to_stdout("{:>6}  {:<12}  {:<11}  {:>10.3f}  {:>9}  {:>9}\n", draft.points[i].line,
              point_name(draft.points[i]), to_string(draft.points[i].kind), residual.chainage + 0.0,
              mm(residual.across), mm(residual.up));
  }
  const Tunnel& tunnel = draft.fit.tunnel;
  const std::size_t elements = tunnel.centerline.elements().size();
  const auto range = [](double least, double greatest) {
    return greatest - least < 5e-4 ? fmt::format("{:.3f}", least)
                                   : fmt::format("{:.3f} to {:.3f}", least, greatest);
  };
  to_stdout("{} points: tunnel {} m wide, {} m high, {:.3f} m long, of {} element{}; ",
            draft.points.size(), range(least_width(tunnel), greatest_width(tunnel)),
            range(tunnel.height.least(), tunnel.height.greatest()), tunnel.centerline.length(),
            elements, elements == 1 ? "" : "s");
  to_stdout("rms {:.1f} mm across, {:.1f} mm up\n", draft.fit.rms_across * 1000,
            draft.fit.rms_up * 1000);
}

// What validate says of the file that was written: findings, then how many. Exit code.
Result<int> report_draft(const NewOptions& options) {
  const std::string file = (fs::path(options.name) / "survey.yaml").string();
  const Result<SurveyReading> reading = read_survey(file);
  if (!reading) return tl::unexpected(reading.error());
  FindingPrinter printer;
  for (const Diagnostic& finding : reading->diagnostics) {
    to_stderr("{}", Lines{printer.text_of(finding)});
  }
  const auto errors =
      std::ranges::count(reading->diagnostics, Severity::error, &Diagnostic::severity);
  const auto warnings = static_cast<std::ptrdiff_t>(reading->diagnostics.size()) - errors;
  to_stderr("{} written: {} error{}, {} warning{}; look at it: tagsmith draw {} -o {}.pdf\n", file,
            errors, errors == 1 ? "" : "s", warnings, warnings == 1 ? "" : "s", file,
            survey_name(options));
  return errors > 0 ? kExitFindings : kExitOk;
}

Result<int> write_draft(const NewOptions& options) {
  const Result<SurveyDraft> draft = make_draft(options);
  if (!draft) return fail(draft.error().message);
  if (auto written = write_files(options, draft_survey(*draft), std::nullopt); !written) {
    return fail(written.error().message);
  }
  options.json ? print_json(*draft) : print_table(*draft);
  std::fflush(stdout);  // residuals before findings
  return report_draft(options);
}

Result<int> run_new(const NewOptions& options) {
  if (auto usable = check_name(options); !usable) return fail(usable.error().message);
  if (options.points.empty()) {
    if (auto written = write_to_edit(options); !written) return fail(written.error().message);
    return kExitOk;
  }
  if (options.list.order.empty()) {
    return fail("--from needs --order, the order of the file's columns: PENZD, PNEZD or own");
  }
  return write_draft(options);
}

// The options that shape a draft from points.
std::vector<CommandOption> draft_options(NewOptions& options) {
  std::vector<CommandOption> draft{
      {.names = "--order",
       .target = &options.list.order,
       .help = "Columns of the list: P point, E east (x), N north (y), Z, D description, - "
               "skipped, as PENZD; or own: a list of `tagsmith export`",
       .placeholder = "ORDER"},
      {.names = "--header",
       .target = &options.list.header,
       .help = "The list's first line names its columns"},
      {.names = "--ignore",
       .target = &options.list.ignore,
       .help = "Leave points with these descriptions out, separated by commas",
       .placeholder = "D,...",
       .by_commas = true},
      {.names = "--template",
       .target = &options.template_name,
       .help = "Plate (default: tag-400x300)",
       .placeholder = "NAME"},
      {.names = "--x-axis",
       .target = &options.x_axis,
       .help = "right (default) or left of +y seen from above, where the grid's x grows",
       .choices = {"right", "left"}},
      {.names = "--check-digit",
       .target = &options.check_digit,
       .help = "gs1 (default) or sum10",
       .choices = {"gs1", "sum10"}},
      {.names = "--tolerance",
       .target = &options.tolerance_mm,
       .help = "How far a point may be off, millimetres (default: 30)",
       .placeholder = "MM",
       .least = 0.1,
       .greatest = 10'000},
      {.names = "--mount-height",
       .target = &options.mount_height,
       .help = "Metres of P above the floor, for lists without floor points",
       .placeholder = "M",
       .least = 0,
       .greatest = 100},
      {.names = "--tunnel-height",
       .target = &options.tunnel_height,
       .help = "Metres of the roof above the floor, for lists without roof points",
       .placeholder = "M",
       .least = 0.1,
       .greatest = 1000},
      {.names = "--walls",
       .target = &options.walls,
       .help = "parallel (default): one width for all; measured: walls and roof run through "
               "their points, the center line through CL",
       .choices = {"parallel", "measured"}},
      json_flag(options.json, "One JSON object a point, then a summary")};
  for (CommandOption& option : draft) option.needs = {"--from"};
  return draft;
}

}  // namespace

Command new_command() {
  const auto options = std::make_shared<NewOptions>();
  Command command{
      .name = "new",
      .summary = "Survey and rig files to edit, or a survey from surveyed points",
      .options = {{.names = "NAME",
                   .target = &options->name,
                   .help = "Folder to make; the survey has its name",
                   .kind = ValueKind::folder,
                   .required = true},
                  {.names = "--from",
                   .target = &options->points,
                   .help = "Draft the survey from this list of points (CSV)",
                   .placeholder = "FILE.csv",
                   .kind = ValueKind::table}},
      .notes =
          "Descriptions of points, by their first word: TL TR a tag's P on the left or right wall "
          "(or its name, as 000L), WL WR the wall in the plates' plane, CL the center line on the "
          "floor, FL the floor, RF the roof. Left and right are those of the drive; list the "
          "points of each kind along the drive. Nothing about the columns is guessed.\n\n"
          "Example:\n"
          "  tagsmith new drift-7\n"
          "  tagsmith new drift-8 --from points.csv --order PENZD --tunnel-height 2.8",
      .run =
          [options] {
            const Result<int> done = run_new(*options);
            return done ? *done : report_failure("new", done.error());
          },
  };
  std::ranges::move(draft_options(*options), std::back_inserter(command.options));
  return command;
}

}  // namespace tagsmith::detail
