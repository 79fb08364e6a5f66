// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/source_excerpt.hpp"
#include "tagsmith/draft/check_points.hpp"
#include "tagsmith/draft/draft_survey.hpp"
#include "tagsmith/draft/far_points.hpp"
#include "tagsmith/draft/fit_tunnel.hpp"
#include "tagsmith/draft/length_units.hpp"
#include "tagsmith/draft/move_to_p.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/draft/walls_beside.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/tag/measured_point.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

struct NewOptions {
  std::string name;
  std::string points;
  PointListOptions list;
  // Empty: the value from the list, or else from the help.
  std::string template_name;
  std::string x_axis;
  std::string check_digit;
  std::string walls = "parallel";
  std::string point = "P";  // of each plate, that was measured
  double tolerance_mm = 30;
  std::optional<double> mount_height;
  std::optional<double> tunnel_height;
  std::optional<double> width;
  // The layout to propose, where no plate hangs.
  std::optional<double> height;
  std::optional<double> spacing;
  std::optional<double> first;
  std::optional<double> to;
  bool split = false;
  bool json = false;
};

// NAME may be a path; the survey has its last part's name.
std::string survey_name(const NewOptions& options) {
  const fs::path path = fs::path(options.name) / "";
  return path.parent_path().filename().string();
}

Result<void> check_name(const NewOptions& options) {
  const std::string name = survey_name(options);
  constexpr std::size_t kLongest = 100;
  if (name.size() > kLongest) {
    return fail(
        fmt::format("NAME {}: has {} bytes, expected at most {}", name, name.size(), kLongest));
  }
  const Diagnosed<Survey> named = read_survey_text("survey.yaml", survey_to_edit(name));
  const bool usable = is_plain_name(name) &&
                      name.find_first_of("'#{}[]&*!|>%@`") == std::string::npos && named.value &&
                      named.value->name == name;
  if (!usable) {
    return fail("NAME " + options.name +
                ": expected a folder to make, whose name has letters and no , : \" or the like");
  }
  return {};
}

Result<void> write_files(const std::vector<SheetFile>& files) {
  for (const SheetFile& file : files) {
    std::error_code ignored;
    if (fs::exists(file.path, ignored)) return fail(file.path.string() + ": is there already");
  }
  return publish_files(files);
}

Result<void> write_to_edit(const NewOptions& options) {
  const std::string name = survey_name(options);
  const std::string survey = (fs::path(options.name) / "survey.yaml").string();
  const std::string rig = (fs::path(options.name) / "rig.yaml").string();
  auto written = write_files({{survey, survey_to_edit(name)}, {rig, rig_to_edit(name)}});
  if (!written) return written;
  to_stdout("{}\n{}\n", survey, rig);
  to_stderr("edit them, then: tagsmith validate {} --rig {}\n", shell_word(survey),
            shell_word(rig));
  return {};
}

Result<TagTemplate> named_template(const std::string& name, const fs::path& folder) {
  const bool is_file = name.find('/') != std::string::npos || name.ends_with(".yaml");
  // The folder does not exist yet: a path out of it leads nowhere on disk.
  const auto path = is_file ? find_template((folder / name).lexically_normal().string(), {})
                            : find_template(name, folder);
  if (!path) return fail("no template `" + name + "`; own templates: " + own_templates());
  return load_template(*path);
}

TunnelFitOptions fit_options(const NewOptions& options) {
  TunnelFitOptions fit;
  fit.tolerance = options.tolerance_mm / 1000;
  fit.mount_height = options.mount_height;
  fit.roof_height = options.tunnel_height;
  fit.measured_walls = options.walls == "measured";
  return fit;
}

// A layout is proposed exactly where no plate hangs.
Result<void> check_layout(const NewOptions& options, const PointList& list) {
  const bool has_tags = std::ranges::any_of(list.points, is_tag);
  const bool wished = options.height.has_value();  // the other options of a layout require it
  if (has_tags && wished) {
    return fail(options.points +
                ": the list has tags that hang: leave --height, --spacing, --first and --to out");
  }
  if (has_tags || wished) return {};
  return fail(options.points +
              ": the list has no tags (TL, TR or names as 000L): for a layout that is to hang, "
              "give --height M of P above the floor and the gap --spacing M, and if you like "
              "--first M and --to M");
}

std::string template_of(const NewOptions& options, const PointList& list) {
  if (!options.template_name.empty()) return options.template_name;
  return list.survey ? list.survey->tag_template : "tag-400x300";
}

// Another plate may have the name that the list states.
Result<void> check_template(const PointList& list, const TagTemplate& tag) {
  constexpr double kSame = 1e-6;
  if (!list.survey) return {};
  const ListedSurvey& listed = *list.survey;
  if (tag.name != listed.tag_template) {
    return fail("the list says the template " + listed.tag_template + ", not " + tag.name +
                ": leave --template out, or give a file of that template");
  }
  if (!listed.plate) return {};
  const std::array found = listed_plate(tag);
  const auto same = [&](double a, double b) { return std::abs(a - b) < kSame; };
  if (std::ranges::equal(found, *listed.plate, same)) return {};
  const auto words = [](const std::array<double, 4>& plate) {
    return fmt::format("{} x {} m with a frame of {} x {} m", format_number(plate[0]),
                       format_number(plate[1]), format_number(plate[2]), format_number(plate[3]));
  };
  return fail(
      "the plates of the list are " + words(*listed.plate) + ", the template " + tag.name +
      " that was found has " + words(found) +
      ": give the file of the list's own, --template FILE.yaml, as seen from the new folder");
}

// Options must not contradict the list.
Result<void> check_options(const NewOptions& options, const PointList& list) {
  struct Said {
    const char* option;
    std::string value;
    std::string listed;
  };
  const auto any = [&](const auto& matches) { return std::ranges::any_of(list.points, matches); };
  const bool has_floor = any([](const SurveyedPoint& point) {
    const bool is_floor = point.kind == PointKind::floor || point.kind == PointKind::centerline;
    return point.height || (is_floor && point.has_height);
  });
  const bool has_roof = any([](const SurveyedPoint& point) {
    return point.tunnel_height || point.kind == PointKind::roof;
  });
  if (options.mount_height && has_floor) {
    return fail("--mount-height is for lists that do not say the floor (CL, FL): leave it out");
  }
  if (options.tunnel_height && has_roof) {
    return fail("--tunnel-height is for lists that do not say the roof (RF): leave it out");
  }
  if (options.point != "P" && !any(is_tag)) {
    return fail("--point is for lists with tags, and this one has none: leave it out");
  }
  if (!list.survey) return {};
  for (const Said& said :
       {Said{"--x-axis", options.x_axis, list.survey->grid.x_axis_left ? "left" : "right"},
        Said{"--check-digit", options.check_digit, to_string(list.survey->code.check)}}) {
    if (said.value.empty() || said.value == said.listed) continue;
    return fail(std::string(said.option) + " " + said.value + ": the list says " + said.listed +
                ": leave the option out");
  }
  return {};
}

// Faults of single points are reported before a fit that they would only disturb.
Result<PointList> read_points(const NewOptions& options, std::vector<Diagnostic>& warnings) {
  Result<Diagnosed<PointList>> reading = read_point_list(options.points, options.list);
  if (!reading) return fail(reading);
  if (!reading->value) return fail(to_string(reading->diagnostics, false));
  warnings = reading->diagnostics;
  PointList& list = *reading->value;
  FindingLog log(options.points);
  if (const auto doubt = doubt_of_unit(list.points, list.metres_per_unit);
      doubt && !list.unit_is_known) {
    const std::string unit =
        list.metres_per_unit == 1
            ? ""
            : "\nthe file says a unit of " + format_number(list.metres_per_unit, 9) + " m";
    return fail(options.points + ": " + *doubt + unit);
  }
  check_exchanged(list.points, log);
  if (log.has_errors()) return fail(to_string(log.sorted(), true));
  if (auto layout = check_layout(options, list); !layout) return fail(layout);
  if (auto said = check_options(options, list); !said) {
    return fail(options.points + ": " + said.error().message);
  }
  return std::move(list);
}

// As the option states, else as all digits of the list have it.
CheckDigit check_digit_of(const NewOptions& options, const std::vector<SurveyedPoint>& points) {
  if (const auto asked = parse_check_digit(options.check_digit)) return *asked;
  const auto all_have = [&](CheckDigit check) {
    return std::ranges::all_of(points, [&](const SurveyedPoint& point) {
      const auto digits = parse_digits(point.digits);
      return !digits || has_check_digit(check, *digits);
    });
  };
  return all_have(CheckDigit::sum10) && !all_have(CheckDigit::gs1) ? CheckDigit::sum10
                                                                   : CheckDigit::gs1;
}

// Tags get names, or are proposed, and a code.
Result<void> complete_tags(const NewOptions& options, const std::optional<ListedSurvey>& listed,
                           SurveyDraft& draft) {
  if (options.height) {
    Result<TagSeries> series =
        propose_series(draft.fit.tunnel, draft.tag,
                       {*options.height, *options.spacing, options.first, options.to});
    if (!series) return fail(series);
    draft.series = *series;
  }
  number_tags(draft.points, draft.fit);
  draft.code.check = check_digit_of(options, draft.points);
  if (options.split && listed) {
    return fail("the list says the code that is printed on its plates: leave --split out");
  }
  if (options.split) return {};
  Result<PositionCode> code =
      listed ? listed->code : code_for(tag_positions(draft), draft.code.check);
  if (!code) return fail(code);
  draft.code = *code;
  return {};
}

struct Drafted {
  SurveyDraft whole;
  std::vector<DraftPart> parts;  // what is written, one at least
  std::vector<Diagnostic> warnings;
  double metres_per_unit = 1;  // of the list's numbers
};

Result<std::vector<DraftPart>> parts_of(const NewOptions& options, const SurveyDraft& draft) {
  if (options.split) return split_draft(draft);
  std::vector<DraftPart> whole;
  whole.push_back({draft, 0, draft.fit.tunnel.centerline.length()});
  return whole;
}

// Walls beside a center line have the requested distance, whatever was fitted through points on
// them.
void hold_width(Tunnel& tunnel, double width) {
  if (!tunnel.left.is_constant() || !tunnel.right.is_constant()) return;
  const Tunnel wished = plain_tunnel(width, 0, tunnel.centerline);
  tunnel.left = wished.left;
  tunnel.right = wished.right;
}

// The tunnel through the points, beside which walls are added where --width says so.
Result<TunnelFit> fit_points(const NewOptions& options, const TunnelFitOptions& fitted,
                             const SurveyDraft& draft, std::vector<SurveyedPoint>& points) {
  if (options.width) {
    if (auto added = add_walls_beside(points, draft.grid, *options.width); !added) {
      return fail(added);
    }
  }
  return fit_tunnel(points, draft.grid, draft.tag, fitted);
}

// The point of the plates that was measured in place of P; nothing where it was P.
std::optional<MeasuredPoint> measured_point(const NewOptions& options, const TagTemplate& tag) {
  for (const MeasuredPoint& point : points_besides_p(tag)) {
    if (point.option == options.point) return point;
  }
  return std::nullopt;
}

Result<void> fit_draft(const NewOptions& options, const TunnelFitOptions& fitted,
                       std::vector<SurveyedPoint> points, SurveyDraft& draft) {
  FindingLog log(options.points);
  const auto fit_of = [&](std::vector<SurveyedPoint> others) {
    return fit_points(options, fitted, draft, others);
  };
  check_far_points(points, draft.grid, fit_of, log);
  if (log.has_errors()) return fail(to_string(log.sorted(), true));
  Result<TunnelFit> fit = fit_points(options, fitted, draft, points);
  if (!fit) return fail(options.points + ": " + fit.error().message);
  if (const auto point = measured_point(options, draft.tag)) {
    move_to_p(points, *point, draft.grid, fit->tunnel, draft.tag);
    fit = fit_tunnel(points, draft.grid, draft.tag, fitted);
    if (!fit) return fail(options.points + ": " + fit.error().message);
  }
  draft.points = std::move(points);
  draft.fit = std::move(*fit);
  if (options.width) hold_width(draft.fit.tunnel, *options.width);
  return {};
}

Result<Drafted> make_draft(const NewOptions& options) {
  Drafted drafted;
  Result<PointList> list = read_points(options, drafted.warnings);
  if (!list) return fail(list);
  SurveyDraft& draft = drafted.whole;
  draft.name = survey_name(options);
  draft.source = fs::path(options.points).filename().string();
  drafted.metres_per_unit = list->metres_per_unit;
  draft.of_export = list->survey.has_value();
  if (list->survey) draft.angle_sigma = list->survey->angle_sigma;
  draft.template_name = template_of(options, *list);
  draft.grid = list->survey ? list->survey->grid : Grid{options.x_axis == "left"};
  if (!draft.grid.x_axis_left) draft.grid.epsg = list->epsg;
  const auto tag = named_template(draft.template_name, options.name);
  if (!tag) return fail(tag);
  if (auto same = check_template(*list, *tag); !same) {
    return fail(options.points + ": " + same.error().message);
  }
  draft.tag = *tag;
  TunnelFitOptions fitted = fit_options(options);
  if (list->alignment) fitted.alignment = line_in_world(*list->alignment, draft.grid);
  if (auto fit = fit_draft(options, fitted, std::move(list->points), draft); !fit) return fail(fit);
  FindingLog log(options.points);
  if (options.list.order != "own") {
    check_heights(draft.points, draft.fit, log);
    check_across(draft.points, draft.fit, log);
    if (!list->alignment && !draft.of_export) check_shape(draft, log);
  }
  if (auto tags = complete_tags(options, list->survey, draft); !tags) {
    return fail(options.points + ": " + tags.error().message);
  }
  Result<std::vector<DraftPart>> parts = parts_of(options, draft);
  if (!parts) return fail(options.points + ": " + parts.error().message);
  drafted.parts = std::move(*parts);
  for (const DraftPart& part : drafted.parts) check_proposed(part.draft, log);
  std::ranges::move(log.sorted(), std::back_inserter(drafted.warnings));
  return drafted;
}

// How far the fitted center line is off the file's, at most, metres; nothing where it has none.
std::optional<double> alignment_off(const SurveyDraft& draft) {
  std::optional<double> off;
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    if (!draft.points[i].of_alignment) continue;
    off = std::max(off.value_or(0), std::abs(draft.fit.residuals[i].across.value_or(0)));
  }
  return off;
}

std::string point_name(const SurveyedPoint& point) {
  return point.tag ? tag_name(point.tag->pair, point.tag->side) : point.name;
}

// survey.yaml, or survey-1.yaml and so on.
fs::path file_of(const NewOptions& options, const Drafted& drafted, std::size_t part) {
  const bool is_whole = drafted.parts.size() == 1;
  return fs::path(options.name) /
         (is_whole ? "survey.yaml" : "survey-" + std::to_string(part + 1) + ".yaml");
}

Json part_json(const NewOptions& options, const Drafted& drafted, std::size_t index) {
  const DraftPart& part = drafted.parts[index];
  return {{"file", file_of(options, drafted, index).string()},
          {"survey", part.draft.name},
          {"from", with_decimals(part.from, 6)},
          {"to", with_decimals(part.to, 6)},
          {"tags", tag_positions(part.draft).size()},
          {"resolution", part.draft.code.resolution[0]}};
}

void print_json(const NewOptions& options, const Drafted& drafted) {
  const SurveyDraft& draft = drafted.whole;
  const auto length = [](const std::optional<double>& value) {
    return value ? Json(with_decimals(*value, 6)) : Json(nullptr);
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
  Json parts = Json::array();
  for (std::size_t i = 0; i < drafted.parts.size(); ++i) {
    parts.push_back(part_json(options, drafted, i));
  }
  to_stdout("{}\n", json_text({{"summary",
                                {{"points", draft.points.size()},
                                 {"width", length(width_at(tunnel, 0))},
                                 {"least_width", length(least_width(tunnel))},
                                 {"greatest_width", length(greatest_width(tunnel))},
                                 {"height", length(tunnel.height.at(0))},
                                 {"length", length(tunnel.centerline.length())},
                                 {"elements", tunnel.centerline.elements().size()},
                                 {"rms_across", length(draft.fit.rms_across)},
                                 {"rms_up", length(draft.fit.rms_up)},
                                 {"alignment_off", length(alignment_off(draft))},
                                 {"metres_per_unit", drafted.metres_per_unit},
                                 {"surveys", parts}}}}));
}

void print_table(const Drafted& drafted) {
  const SurveyDraft& draft = drafted.whole;
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
  to_stdout("{} points: tunnel {} m wide, {} m high, {:.3f} m long, of {}; ", draft.points.size(),
            range(least_width(tunnel), greatest_width(tunnel)),
            range(tunnel.height.least(), tunnel.height.greatest()), tunnel.centerline.length(),
            counted(elements, "element"));
  to_stdout("rms {:.1f} mm across, {:.1f} mm up\n", draft.fit.rms_across * 1000,
            draft.fit.rms_up * 1000);
  if (drafted.metres_per_unit != 1) {
    to_stdout("the list was read in units of {} m\n", format_number(drafted.metres_per_unit, 9));
  }
  if (const auto off = alignment_off(draft)) {
    to_stdout("the center line is at most {:.1f} mm off the file's alignment\n", *off * 1000);
  }
}

void print_parts(const Drafted& drafted) {
  if (drafted.parts.size() == 1) return;
  for (const DraftPart& part : drafted.parts) {
    to_stdout("{}: chainage {:.3f} to {:.3f} m, {} tags\n", part.draft.name, part.from, part.to,
              tag_positions(part.draft).size());
  }
}

// A code that is too coarse for the survey's accuracy is reported, not only chosen.
void report_resolution(const SurveyDraft& draft) {
  constexpr double kUsual = 0.01;
  const double resolution = draft.code.resolution[0];
  if (resolution <= kUsual) return;
  to_stderr(
      "the tags lie so far apart that eleven digits say their positions to {} m only; --split "
      "makes several surveys with codes of {} m\n",
      format_number(resolution), format_number(kUsual));
}

// The report of validate on the file that was written: findings, then their number. Exit code.
Result<int> report_draft(const NewOptions& options, const std::string& file,
                         FindingPrinter& printer) {
  const Result<Diagnosed<Survey>> reading = read_survey(file);
  if (!reading) return fail(reading);
  for (const Diagnostic& finding : reading->diagnostics) {
    to_stderr("{}", Lines{printer.text_of(finding)});
  }
  const auto errors = static_cast<std::size_t>(
      std::ranges::count(reading->diagnostics, Severity::error, &Diagnostic::severity));
  const std::size_t warnings = reading->diagnostics.size() - errors;
  to_stderr("{} written: {}, {}; look at it: tagsmith draw {} -o {}\n", file,
            counted(errors, "error"), counted(warnings, "warning"), shell_word(file),
            shell_word((reading->value ? reading->value->name : survey_name(options)) + ".pdf"));
  return errors > 0 ? kExitFindings : kExitOk;
}

// A layout that nobody has hung yet is proposed whole or not at all.
Result<void> check_proposal(const NewOptions& options, const SheetFile& file) {
  const Diagnosed<Survey> reading = read_survey_text(file.path, file.bytes);
  std::string faults;
  for (const Diagnostic& finding : reading.diagnostics) {
    if (finding.severity != Severity::error) continue;
    faults += "\n" + finding.message + " [" + finding.code + "]";
  }
  if (faults.empty()) return {};
  return fail(options.points +
              ": the layout of --height, --spacing, --first and --to does not fit:" + faults);
}

Result<int> write_draft(const NewOptions& options) {
  const Result<Drafted> drafted = make_draft(options);
  if (!drafted) return fail(drafted);
  std::vector<SheetFile> files;
  for (std::size_t i = 0; i < drafted->parts.size(); ++i) {
    files.push_back({file_of(options, *drafted, i), draft_survey(drafted->parts[i].draft)});
    if (auto fits = check_proposal(options, files.back()); options.height && !fits) {
      return fail(fits);
    }
  }
  if (auto written = write_files(files); !written) return fail(written);
  FindingPrinter printer;
  for (const Diagnostic& warning : drafted->warnings) {
    to_stderr("{}", Lines{printer.text_of(warning)});
  }
  options.json ? print_json(options, *drafted) : print_table(*drafted);
  if (!options.json) print_parts(*drafted);
  std::fflush(stdout);  // residuals before findings
  if (!drafted->whole.of_export) report_resolution(drafted->parts.front().draft);
  int worst = kExitOk;
  for (const SheetFile& file : files) {
    const Result<int> code = report_draft(options, file.path.string(), printer);
    if (!code) return fail(code);
    worst = std::max(worst, *code);
  }
  return worst;
}

Result<int> run_new(const NewOptions& options) {
  if (auto usable = check_name(options); !usable) return fail(usable);
  if (options.points.empty()) {
    if (auto written = write_to_edit(options); !written) return fail(written);
    return kExitOk;
  }
  return write_draft(options);
}

// Metres.
double unit_named(const std::string& unit) {
  if (unit == "ft") return kFoot;
  if (unit == "us-ft") return kSurveyFoot;
  return unit == "mm" ? 0.001 : 1;
}

// The layout to propose, and how it is written.
std::vector<CommandOption> layout_options(NewOptions& options) {
  return {
      needing(
          {"--spacing"},
          number_option(
              "--height", &options.height, "M", 0, 100,
              "For lists without tags: propose a layout with P so many metres above the floor")),
      needing({"--height"},
              number_option(
                  "--spacing", &options.spacing, "M", 0.001, 100'000,
                  "Of the layout: metres of clear gap between neighbouring plates of one wall")),
      needing({"--height"},
              value_option(
                  "--first", &options.first, "M",
                  "Of the layout: chainage of the first left P (default: where the points begin)")),
      needing(
          {"--height"},
          value_option(
              "--to", &options.to, "M",
              "Of the layout: chainage up to which a left P may lie (default: where they end)")),
      flag("--split", &options.split,
           "Write several surveys where one code cannot say all positions to a centimetre")};
}

// How the points are listed.
std::vector<CommandOption> list_options(NewOptions& options) {
  return {
      value_option("--order", &options.list.order, "ORDER",
                   "Columns of a table: P point, E east (x), N north (y), Z, D description, - "
                   "skipped, as PENZD; or own: a list of `tagsmith export`"),
      flag("--header", &options.list.header, "The list's first line names its columns"),
      by_commas(
          value_option("--ignore", &options.list.ignore, "D,...",
                       "Leave points with these descriptions out, or alignments of these names")),
      choice_option(
          "--units",
          [&options](const std::string& unit) { options.list.metres_per_unit = unit_named(unit); },
          {"m", "ft", "us-ft", "mm"},
          "Of the list: m, ft (0.3048 m), us-ft (1200/3937 m) or mm (default: what the file says, "
          "else m)")};
}

std::vector<std::string> point_choices() {
  std::vector<std::string> choices{"P"};
  for (const MeasuredPoint& point : points_besides_p({})) choices.emplace_back(point.option);
  return choices;
}

// The options that shape a draft from points.
std::vector<CommandOption> draft_options(NewOptions& options) {
  std::vector<CommandOption> draft = joined(
      {list_options(options),
       {value_option("--template", &options.template_name, "NAME", "Plate (default: tag-400x300)"),
        choice_option("--point", &options.point, point_choices(),
                      "Where tags were measured: P (default), the frame's middle, another inner "
                      "corner of it, its outer top left corner, or the plate's top left corner"),
        choice_option("--x-axis", &options.x_axis, {"right", "left"},
                      "right (default) or left of +y seen from above, where the grid's x grows"),
        choice_option("--check-digit", &options.check_digit, {"gs1", "sum10"},
                      "gs1 (default) or sum10"),
        number_option("--tolerance", &options.tolerance_mm, "MM", 0.1, 10'000,
                      "How far a point may be off, millimetres (default: 30)"),
        number_option("--mount-height", &options.mount_height, "M", 0, 100,
                      "Metres of P above the floor, for lists without floor points"),
        number_option(
            "--width", &options.width, "M", 0.1, 1000,
            "Metres between the walls, for lists without wall points: an alignment alone"),
        number_option("--tunnel-height", &options.tunnel_height, "M", 0.1, 1000,
                      "Metres of the roof above the floor, for lists without roof points"),
        choice_option("--walls", &options.walls, {"parallel", "measured"},
                      "parallel (default): one width for all; measured: walls and roof run through "
                      "their points, the center line through CL")},
       layout_options(options),
       {json_flag(options.json, "One JSON object a point, then a summary")}});
  for (CommandOption& option : draft) option.needs.emplace_back("--from");
  return draft;
}

}  // namespace

Command new_command() {
  const auto options = std::make_shared<NewOptions>();
  return {
      .name = "new",
      .summary = "Survey and rig files to edit, or a survey from surveyed points",
      .options = joined(
          {{required(argument("NAME", &options->name, ValueKind::folder,
                              "Folder to make; the survey has its name")),
            value_option(
                "--from", &options->points, "FILE",
                "Draft the survey from these points: a table (CSV), LandXML, Leica GSI, RW5 or DXF",
                ValueKind::table)},
           draft_options(*options)}),
      .notes =
          "Descriptions of points, by their first word: TL TR a tag's P on the left or right wall "
          "(or its name, as 000L), WL WR the wall in the plates' plane, CL the center line on the "
          "floor, FL the floor, RF the roof. Left and right are those of the drive; list the "
          "points of each kind along the drive. Nothing about the columns is guessed, nor the unit "
          "where the walls lie too far apart for metres. The kind of file is told by its content; "
          "in a DXF the layers are the descriptions.\n\n"
          "Example:\n"
          "  tagsmith new drift-7\n"
          "  tagsmith new drift-8 --from points.csv --order PENZD --tunnel-height 2.8",
      .run = [options] { return run_new(*options); },
  };
}

}  // namespace tagsmith::detail
