// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "decoder/cli/adjust_drawing.hpp"
#include "decoder/cli/adjust_input.hpp"
#include "decoder/cli/commands.hpp"
#include "decoder/verify/as_built.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/unified_diff.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/edit_placed.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr const char* kAdjustNotes = R"(Example:
  tagsmith verify --json mine/survey.yaml --rig mine/rig.yaml --run run.csv > run.jsonl
  tagsmith adjust mine/survey.yaml --rig mine/rig.yaml --run run.csv run.jsonl -o as-built.yaml

All photos are adjusted at once. The control tags hold them: those with `control: true` in `placed`,
or those of --control, within the survey's sigma. FILE: output of `verify --json` (.jsonl), which
takes the place of the photos; or photos, or folders of them. Without FILE the photos of the run.
Exit: 0 every tag seen has its place, 1 one is not determined, or nothing was written because a
control tag does not hang where the survey has it, the photos contradict each other or the rig, 2 a
file could not be read.)";

// --- what is printed ---

// World axes become the grid's.
Matrix3d in_grid(const Grid& grid, const Matrix3d& covariance) {
  Matrix3d axes;
  for (Eigen::Index i = 0; i < 3; ++i) {
    axes.col(i) =
        grid_from_world(grid, Vector3d::Unit(i)) - grid_from_world(grid, Vector3d::Zero());
  }
  return axes * covariance * axes.transpose();
}

// To the micrometre; what rounds to zero has no sign.
Vector3d p_in_grid(const Survey& survey, const AsBuiltTag& tag) {
  const Vector3d p = grid_from_world(survey.grid, tag.world_from_plate.translation);
  return p.unaryExpr([](double value) { return std::round(1e6 * value) / 1e6 + 0.0; });
}

Vector3d sigma_in_grid(const Survey& survey, const AsBuiltTag& tag) {
  const Matrix3d covariance = tag.covariance.topLeftCorner<3, 3>();
  return in_grid(survey.grid, covariance).diagonal().cwiseMax(0).cwiseSqrt();
}

// Of a coordinate of P, whichever.
double mean_sigma(const AsBuiltTag& tag) {
  return std::sqrt(std::max(0.0, tag.covariance.topLeftCorner<3, 3>().trace()) / 3);
}

std::size_t count_of(const AsBuiltSurvey& found, AsBuiltStatus status) {
  return static_cast<std::size_t>(std::ranges::count(found.tags, status, &AsBuiltTag::status));
}

std::vector<std::string> not_seen(const Survey& survey, const AsBuiltSurvey& found) {
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) {
    if (std::ranges::find(found.tags, tag.name, &AsBuiltTag::tag) == found.tags.end()) {
      names.push_back(tag.name);
    }
  }
  return names;
}

void print_words(const Survey& survey, const AsBuiltSurvey& found) {
  to_stdout("     tag          x          y          z  sigma, mm  moved, mm  seen\n");
  for (const AsBuiltTag& tag : found.tags) {
    if (!tag.has_place()) continue;
    const Vector3d p = p_in_grid(survey, tag);
    const auto shown = [](double value) { return std::round(1e4 * value) / 1e4 + 0.0; };
    to_stdout("{:>8} {:10.4f} {:10.4f} {:10.4f} {:10.1f} {:10.1f} {:5}{}\n", tag.tag, shown(p.x()),
              shown(p.y()), shown(p.z()), 1e3 * mean_sigma(tag), 1e3 * tag.shift.norm(),
              tag.stations, tag.status == AsBuiltStatus::control ? "  control" : "");
  }
  for (const AsBuiltTag& tag : found.tags) {
    if (!tag.reason.empty()) to_stdout("{} {}: {}\n", tag.tag, to_string(tag.status), tag.reason);
  }
  for (const LeftOutSighting& out : found.left_out) {
    to_stdout("left out: {} at {} contradicts the rest\n", out.tag, out.station);
  }
  const std::vector<std::string> unseen = not_seen(survey, found);
  if (!unseen.empty()) to_stdout("not seen: {}\n", fmt::join(unseen, " "));
  to_stdout(
      "{} tags adjusted to {} control tags, {} not determined; {} pictures of tags from {} places; "
      "residuals {:.2f} times what was stated\n",
      count_of(found, AsBuiltStatus::adjusted), count_of(found, AsBuiltStatus::control),
      count_of(found, AsBuiltStatus::undetermined), found.sightings, found.stations,
      found.sigma_factor);
}

Json tag_json(const Survey& survey, const AsBuiltTag& tag) {
  Json line{{"tag", tag.tag}, {"status", to_string(tag.status)}, {"stations", tag.stations}};
  if (!tag.reason.empty()) line["reason"] = tag.reason;
  if (!tag.has_place()) return line;
  const PlateAttitude attitude = attitude_of(survey.grid, tag.world_from_plate);
  const Vector3d turned = tag.covariance.diagonal().tail<3>().cwiseMax(0).cwiseSqrt();
  const Matrix3d covariance = in_grid(survey.grid, tag.covariance.topLeftCorner<3, 3>());
  const Vector3d surveyed = find_tag(survey, std::string_view(tag.tag))->p_in_grid;
  line["p"] = number_list(p_in_grid(survey, tag));
  line["sigma"] = number_list(sigma_in_grid(survey, tag));
  line["covariance"] = number_list(covariance.reshaped());
  line["moved"] = number_list(Vector3d(p_in_grid(survey, tag) - surveyed));
  line["facing_deg"] = std::fmod(degrees(attitude.facing.value_or(0)) + 360, 360);
  line["tilt_deg"] = degrees(attitude.tilt);
  line["roll_deg"] = degrees(attitude.roll);
  // About the plate's own axes: right, down, into the wall.
  line["sigma_deg"] = {{"facing", degrees(turned.y())},
                       {"tilt", degrees(turned.x())},
                       {"roll", degrees(turned.z())}};
  return line;
}

// What is infinite is null.
Json group_json(const ControlGroup& group) {
  const bool is_checked = std::isfinite(group.unnoticed);
  return {{"tags", group.tags},
          {"shift", is_checked ? Json(group.shift) : Json()},
          {"unnoticed", is_checked ? Json(group.unnoticed) : Json()}};
}

void print_json(const Survey& survey, const AsBuiltSurvey& found) {
  for (const AsBuiltTag& tag : found.tags) to_stdout("{}\n", json_text(tag_json(survey, tag)));
  const auto left_out = [](const LeftOutSighting& out) -> Json {
    return {{"station", out.station}, {"tag", out.tag}};
  };
  Json summary{{"adjusted", count_of(found, AsBuiltStatus::adjusted)},
               {"control", count_of(found, AsBuiltStatus::control)},
               {"contradicted", count_of(found, AsBuiltStatus::contradicted)},
               {"undetermined", count_of(found, AsBuiltStatus::undetermined)},
               {"not_seen", not_seen(survey, found)},
               {"stations", found.stations},
               {"sightings", found.sightings},
               {"left_out", json_list(found.left_out, left_out)},
               {"chi_square", found.chi_square},
               {"degrees_of_freedom", found.degrees_of_freedom},
               {"sigma_factor", found.sigma_factor},
               {"control_groups", json_list(found.groups, group_json)}};
  to_stdout("{}\n", json_text({{"summary", std::move(summary)}}));
}

// --- the survey that is written ---

std::string today() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%d}", fmt::localtime(now));
}

// The survey's text with the places found.
Result<std::string> as_built_text(const AdjustOptions& options, const std::string& text,
                                  const Survey& survey, const AsBuiltSurvey& found) {
  std::vector<AsBuiltPlace> places;
  for (const AsBuiltTag& tag : found.tags) {
    if (tag.status != AsBuiltStatus::adjusted) continue;
    places.push_back({tag.tag, p_in_grid(survey, tag),
                      attitude_of(survey.grid, tag.world_from_plate), mean_sigma(tag),
                      options.date.empty() ? today() : options.date});
  }
  Result<std::string> changed = survey_with_places(text, survey, places);
  if (!changed) return fail(options.survey + ": " + changed.error().message);
  const std::string& name = options.output.empty() ? options.survey : options.output;
  const Diagnosed<Survey> reading = read_survey_text(name, *changed);
  if (reading.value) return changed;
  return fail(options.survey +
              ": the places cannot be written into it: " + to_string(reading.diagnostics, true));
}

Result<void> write_survey(const AdjustOptions& options, const Survey& survey,
                          const AsBuiltSurvey& found) {
  if (options.output.empty() && options.diff.empty()) return {};
  const Result<std::string> text = read_file(options.survey);
  if (!text) return fail(text.error().message);
  const Result<std::string> changed = as_built_text(options, *text, survey, found);
  if (!changed) return fail(changed.error().message);
  if (!options.diff.empty()) {
    auto written =
        write_file(options.diff, unified_diff(options.survey, *text, options.survey, *changed));
    if (!written) return written;
  }
  return options.output.empty() ? Result<void>{} : write_file(options.output, *changed);
}

Result<void> write_drawing(const AdjustOptions& options, const Survey& survey,
                           const AsBuiltSurvey& found) {
  if (options.drawing.empty()) return {};
  const auto sheets = draw_as_built(survey, found);
  if (!sheets) return fail(sheets.error().message);
  const auto files = render_sheets(*sheets, options.drawing);
  if (!files) return fail(files.error().message);
  for (const SheetFile& file : *files) {
    if (auto written = write_file(file.path, file.bytes); !written) return written;
  }
  return {};
}

// Why the places must not be relied on; nothing where they may.
std::optional<std::string> reason_not_to_write(const AsBuiltSurvey& found,
                                               const std::vector<std::string>& control) {
  constexpr std::size_t kMostLeftOut = 10;  // one in so many sightings: more are no chance
  if (count_of(found, AsBuiltStatus::contradicted) > 0) {
    return "survey the contradicted control tags again, or leave them out of the control tags";
  }
  if (!found.cut_off.empty()) {
    return fmt::format(
        "only photos that contradict the rest tie {} to a control tag: of the control tags there "
        "one pair or more does not hang as surveyed, or rows are mixed up",
        fmt::join(found.cut_off, " "));
  }
  const bool loses_control = std::ranges::any_of(found.left_out, [&](const auto& sighting) {
    const auto tag = std::ranges::find(found.tags, sighting.tag, &AsBuiltTag::tag);
    return tag != found.tags.end() && tag->status == AsBuiltStatus::undetermined &&
           std::ranges::find(control, sighting.tag) != control.end();
  });
  constexpr double kMostFactor = 5;  // of the corners' stated sigmas, which differ by camera
  if (found.sigma_factor > kMostFactor || loses_control ||
      kMostLeftOut * found.left_out.size() > found.sightings) {
    return "too many photos contradict each other, or a control tag: are rig, run and survey those "
           "of these photos?";
  }
  return std::nullopt;
}

// All other tags move with a single control tag that does not hang as surveyed.
std::optional<std::string> doubt_of_single_control(const AdjustInput& input,
                                                   const std::vector<SightedTag>& sighted,
                                                   const AsBuiltSurvey& found) {
  const auto control = std::ranges::find(found.tags, AsBuiltStatus::control, &AsBuiltTag::status);
  const auto moved = contradicted_by_others(input.survey, input.setup.rig, sighted, control->tag);
  if (!moved) return std::nullopt;
  return fmt::format(
      "{} is the only control tag, and by the others it hangs {:.0f} mm from where the survey has "
      "it: survey it again, or name another with --control",
      control->tag, 1e3 * moved->shift.norm());
}

// Says of which control tags a mistake, if several one that they share, would go unnoticed.
void warn_of_unchecked(const std::vector<ControlGroup>& groups) {
  constexpr double kLarge = 0.02;  // metres: ten times what control tags are usually surveyed to
  for (const ControlGroup& group : groups) {
    if (group.unnoticed < kLarge) continue;
    const bool one = group.tags.size() == 1;
    const std::string names = fmt::format("{}", fmt::join(group.tags, ", "));
    if (std::isinf(group.unnoticed)) {
      to_stderr("{}: nothing{} tells whether {} {} as surveyed\n", kAdjust,
                one ? "" : " but each other", names, one ? "hangs" : "hang");
    } else {
      to_stderr(
          "{}: {} may hang up to {:.0f} mm from where the survey has {} without any other "
          "control tag telling\n",
          kAdjust, names, 1e3 * group.unnoticed, one ? "it" : "them all");
    }
  }
}

Result<int> run(const AdjustOptions& options) {
  const Result<AdjustInput> input = load_adjust_input(options);
  if (!input) return fail(input.error().message);
  const Result<std::vector<SightedTag>> sighted = sighted_tags(*input, options.jobs);
  if (!sighted) return fail(sighted.error().message);
  print_assumptions(kAdjust, assumptions({&input->survey, 1}, input->setup.rig));
  if (const auto doubt = rig_doubt(input->survey, input->setup.rig, *sighted)) {
    to_stderr("{}: the rig is in doubt, and nothing was adjusted: {}\n", kAdjust, *doubt);
    return kExitFindings;
  }
  Result<AsBuiltSurvey> found =
      adjust_as_built(input->survey, input->setup.rig, *sighted, input->control);
  if (!found) return fail(options.survey + ": " + found.error().message);
  judge_control(input->survey, *found);
  options.json ? print_json(input->survey, *found) : print_words(input->survey, *found);
  if (const auto drawn = write_drawing(options, input->survey, *found); !drawn) {
    return fail(drawn.error().message);
  }
  auto reason = reason_not_to_write(*found, input->control);
  if (!reason && count_of(*found, AsBuiltStatus::control) == 1) {
    reason = doubt_of_single_control(*input, *sighted, *found);
  }
  if (!reason) warn_of_unchecked(found->groups);
  if (reason) {
    const std::string& file = options.output.empty() ? options.diff : options.output;
    const std::string what =
        file.empty() ? "do not rely on these places" : file + " was not written";
    to_stderr("{}: {}: {}\n", kAdjust, what, *reason);
    return kExitFindings;
  }
  const auto written = write_survey(options, input->survey, *found);
  if (!written) return fail(written.error().message);
  return count_of(*found, AsBuiltStatus::undetermined) > 0 ? kExitFindings : kExitOk;
}

}  // namespace

Command adjust_command() {
  auto options = std::make_shared<AdjustOptions>();
  Command command{
      .name = kAdjust,
      .summary = "Find where every tag hangs, by all photos of a drive and some control tags",
      .options = {survey_argument(&options->survey, "The survey"),
                  argument("FILE", &options->files, ValueKind::file,
                           "Output of `verify --json` (.jsonl), photos, folders of photos, or - "
                           "for a list of photos on standard input"),
                  by_commas(value_option(
                      "--control", &options->control, "TAG,...",
                      "Tags that hang as surveyed, instead of those with `control: true`",
                      ValueKind::tag)),
                  file_option("-o,--output", &options->output,
                              "Survey to write, with the places found and all comments"),
                  file_option("--diff", &options->diff,
                              "Changes to the survey to write, as `patch` takes them"),
                  file_option("--drawing", &options->drawing,
                              "Plan to write of how far each tag hangs from its surveyed place: "
                              "FILE.pdf, FILE.svg or FILE.png"),
                  value_option("--date", &options->date, "YYYY-MM-DD",
                               "Day of the photos, written with the places (default: today)"),
                  json_flag(options->json, "One JSON object a tag, then the summary"),
                  jobs_option(options->jobs, "Photos read at once")},
      .notes = kAdjustNotes,
      .run = [options] { return run(*options); },
  };
  for (CommandOption& option : hanging_options(options->hanging)) {
    if (option.names == "--tolerance") continue;
    option.required = option.names == "--rig";
    command.options.push_back(std::move(option));
  }
  return command;
}

}  // namespace tagsmith::detail
