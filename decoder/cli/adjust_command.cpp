// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <iostream>
#include <memory>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "decoder/cli/commands.hpp"
#include "decoder/cli/file_list.hpp"
#include "decoder/cli/magnified.hpp"
#include "decoder/cli/report_files.hpp"
#include "decoder/cli/verify_hanging.hpp"
#include "decoder/verify/as_built.hpp"
#include "decoder/verify/hanging_check.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_json.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/unified_diff.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/tunnel_plan.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/edit_placed.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// ---- The input of the command: the survey, the rig, control tags, and every sighting of a tag.

namespace {

constexpr const char* kAdjust = "adjust";

struct AdjustOptions {
  std::string survey;
  std::vector<std::string> files;
  HangingOptions hanging;
  std::vector<std::string> control;
  std::string output;   // the survey that is written
  std::string diff;     // the same as changes to the survey
  std::string drawing;  // PDF, SVG or PNG
  std::string date;
  bool json = false;
  int jobs = 0;
};

struct AdjustInput {
  Survey survey;
  HangingSetup setup;
  std::vector<std::filesystem::path> lines;  // output of verify
  std::vector<std::filesystem::path> photos;
  std::vector<std::string> control;  // names of tags of the survey
};

namespace fs = std::filesystem;

bool holds_lines(const std::string& file) {
  const std::string extension = fs::path(file).extension().string();
  return extension == ".jsonl" || extension == ".json" || extension == ".ndjson";
}

Result<std::vector<std::string>> control_tags(const AdjustOptions& options, const Survey& survey) {
  for (const std::string& name : options.control) {
    if (find_tag(survey, name) != nullptr) continue;
    return fail(
        fmt::format("--control {}: {} has no tag of this name", name, survey.file.string()));
  }
  if (!options.control.empty()) return options.control;
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) {
    if (tag.control) names.push_back(tag.name);
  }
  if (!names.empty()) return names;
  return fail(survey.file.string() +
              ": has no control tag: write `control: true` at the tags in `placed` that were "
              "surveyed best, or name them with --control");
}

// All photos, read and compared with the survey.
Result<std::vector<VerifiedFile>> verify_photos(const AdjustInput& input, int jobs) {
  VerifyRequest request{input.survey};
  request.rig = &input.setup.rig;
  request.cameras = &input.setup.cameras;
  const std::string revision = survey_revision(input.survey);
  std::vector<VerifiedFile> files(input.photos.size());
  std::string failure;
  const auto verify = [&](std::size_t i) { return verify_file(request, input.photos[i]); };
  const auto take = [&](std::size_t i, Result<VerifiedFile>& verified) {
    if (verified) {
      files[i] = std::move(*verified);
      files[i].revision = revision;
    } else if (failure.empty()) {
      failure = verified.error().message;
    }
  };
  run_below_bar("photos", files.size(), jobs, verify, take);
  if (!failure.empty()) return fail(failure);
  return files;
}

// How many files named in the lines are photos, and how many of these belong to another survey.
struct PhotoCounts {
  std::size_t photos = 0;
  std::size_t others = 0;
  bool any_broken_line = false;
};

Result<PhotoCounts> read_lines(const AdjustInput& input,
                               const std::function<void(const VerifiedFile&)>& take) {
  const std::string revision = survey_revision(input.survey);
  PhotoCounts photo_counts;
  for (const fs::path& path : input.lines) {
    const Result<VerifyLineCounts> counts = read_verify_lines(path, [&](const VerifiedFile& file) {
      if (!file.is_photo()) return;
      ++photo_counts.photos;
      if (file.revision != revision) ++photo_counts.others;
      take(file);
    });
    if (!counts) return fail(counts);
    if (counts->files == 0) {
      return fail(path.string() + ": has no line of `verify --json`");
    }
    report_broken_lines(path.string(), *counts);
    photo_counts.any_broken_line |= counts->broken > 0;
  }
  if (photo_counts.photos > 0 && photo_counts.others == photo_counts.photos) {
    return fail(fmt::format(
        "{}: all {} photos were verified against another state of the survey {}: verify them again",
        input.lines.front().string(), photo_counts.photos, input.survey.file.string()));
  }
  return photo_counts;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%d}", fmt::localtime(now));
}

// Fails, before any photo is read, on input that cannot be used and output that cannot be written.
Result<AdjustInput> load_adjust_input(const AdjustOptions& options) {
  if (!options.date.empty() && !parse_day(options.date)) {
    return fail("--date " + options.date + ": expected a day as 2026-03-31");
  }
  if (options.date > today()) {
    to_stderr("tagsmith {}: --date {} lies in the future, today is {}\n", kAdjust, options.date,
              today());
  }
  if (!options.drawing.empty() && !sheet_format_of(options.drawing)) {
    return fail("--drawing " + options.drawing +
                ": expected a name that ends with .pdf, .svg or .png");
  }
  Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey);
  CommandFiles files;
  Result<std::optional<LoadedHanging>> hanging = load_hanging(options.hanging, files);
  if (!hanging) return fail(hanging);
  Result<std::vector<std::string>> control = control_tags(options, *survey);
  if (!control) return fail(control);
  AdjustInput input{std::move(*survey), std::move((*hanging)->setup), {}, {}, std::move(*control)};
  std::vector<std::string> photos;
  for (const std::string& file : options.files) {
    if (holds_lines(file)) {
      input.lines.emplace_back(file);
    } else {
      photos.push_back(file);
    }
  }
  if (options.files.empty()) photos = (*hanging)->photos;
  if (photos.empty() && input.lines.empty()) {
    return fail("FILE is required: output of `verify --json`, photos, or --run");
  }
  const Result<FileList> list = list_files(photos, image_extensions(), std::cin);
  if (!list) return fail(list);
  input.photos = list->files;
  files.reads(input.survey);
  for (const fs::path& file : input.lines) files.reads(file, "the lines");
  for (const fs::path& file : input.photos) files.reads(file, "a photo");
  files.writes(options.output, "--output");
  files.writes(options.diff, "--diff");
  files.writes(options.drawing, "--drawing");
  if (const auto usable = files.check(); !usable) return fail(usable);
  return input;
}

// Every sighting of a tag of the survey, from the photos and from the lines.
struct Sightings {
  std::vector<SightedTag> tags;
  bool all_lines_read = true;
};

// What was left out is reported on standard error.
Result<Sightings> sightings_of(const AdjustInput& input, int jobs) {
  const Result<std::vector<VerifiedFile>> photos = verify_photos(input, jobs);
  if (!photos) return fail(photos);
  std::vector<SightedTag> all;
  std::vector<std::string> notes;
  PhotoCounts photo_counts;
  const EachFile files = [&](const auto& take) -> Result<void> {
    for (const VerifiedFile& file : *photos) take(file);
    const Result<PhotoCounts> read = read_lines(input, take);
    if (!read) return fail(read);
    photo_counts = *read;
    return {};
  };
  const auto taken = for_each_sighted(input.survey, input.setup, files,
                                      [&](const auto& tags, const std::string& note) {
                                        all.insert(all.end(), tags.begin(), tags.end());
                                        if (!note.empty()) notes.push_back(note);
                                      });
  if (!taken) return fail(taken);
  if (photo_counts.others > 0) {
    to_stderr(
        "tagsmith {}: {} photos were verified against another state of the survey and left out\n",
        kAdjust, photo_counts.others);
  }
  constexpr std::size_t kMostNotes = 20;
  for (std::size_t i = 0; i < std::min(notes.size(), kMostNotes); ++i) {
    to_stderr("tagsmith {}: {}\n", kAdjust, notes[i]);
  }
  return Sightings{std::move(all), !photo_counts.any_broken_line};
}

// ---- How far the tags hang from their surveyed places, as a technical drawing.

using Eigen::Matrix2d;
using Eigen::Vector2d;

Colour colour_of(const AsBuiltTag& tag) {
  switch (tag.status) {
    case AsBuiltStatus::control:
      return colours::kGreen;
    case AsBuiltStatus::adjusted:
      return colours::kBlue;
    default:
      return colours::kRed;
  }
}

Matrix2d plane_covariance(const AsBuiltTag& tag) { return tag.covariance.topLeftCorner<2, 2>(); }

double magnification(const Survey& survey, const AsBuiltSurvey& found) {
  std::vector<double> sizes;
  for (const AsBuiltTag& tag : found.tags) {
    if (!tag.has_place()) continue;
    const double ellipse = kEllipse95 * std::sqrt(std::max(0.0, plane_covariance(tag).trace()));
    sizes.push_back(std::max(tag.shift.head<2>().norm(), ellipse));
  }
  return magnification_for(survey.tunnel, std::move(sizes));
}

void add_tag(Sketch& sketch, const Survey& survey, const PlanStrip& strip,
             const PlacedTag& surveyed, const AsBuiltTag& tag, double factor) {
  const Vector2d from = surveyed.world_from_plate.translation.head<2>();
  const Vector2d at = strip.view_from_world * from;
  if (!tag.has_place()) {
    sketch.layer("undetermined").add(Dot{at, 0.002, colours::kRed});
    sketch.layer("undetermined").add(Dot{at, 0.0014, colours::kWhite});
    return;
  }
  const Matrix2d turn = strip.view_from_world.linear();
  const Vector2d to = at + factor * (turn * tag.shift.head<2>());
  Ellipse ellipse = ellipse95(to, turn * plane_covariance(tag) * turn.transpose(), factor);
  ellipse.line.colour = colour_of(tag);
  sketch.layer("ellipses").add(std::move(ellipse));
  sketch.layer("moved").add(Arrow{at, to, {colour_of(tag), kNarrow, {}}, 0.0015});
  Words height = words_beyond_name(
      survey, strip, surveyed, fmt::format("{:+.1f}", std::round(1e4 * tag.shift.z()) / 10 + 0.0));
  height.colour = colour_of(tag);
  sketch.layer("heights").add(std::move(height));
}

auto count_of(const AsBuiltSurvey& found, AsBuiltStatus status) {
  return std::ranges::count(found.tags, status, &AsBuiltTag::status);
}

DrawingView summary_view(const AsBuiltSurvey& found) {
  const std::vector<std::string> lines{
      fmt::format("{} tags adjusted (blue), {} control tags (green), {} contradicted (red), {} not "
                  "determined (ring)",
                  count_of(found, AsBuiltStatus::adjusted), count_of(found, AsBuiltStatus::control),
                  count_of(found, AsBuiltStatus::contradicted),
                  count_of(found, AsBuiltStatus::undetermined)),
      fmt::format("{} pictures of tags from {} places, {} left out; residuals {:.2f} times what "
                  "was stated",
                  found.sightings, found.stations, found.left_out.size(), found.sigma_factor),
      "numbers beside the names: how far the tag hangs above (+) or below (-) its surveyed place, "
      "mm"};
  DrawingView view;
  view.title = "As built";
  view.new_row = true;
  add_lines(view.sketch.layer("summary"), lines, 0, colours::kBlack, 0.0025, 0.006);
  return view;
}

// The tunnel's plan with an arrow for each tag from where it was surveyed to where it hangs, its
// 95 % ellipse, and how far it hangs above (+) or below (-), millimetres. Control tags are green:
// their arrows are residuals. Tags without a place have a ring. Arrows and ellipses are magnified
// by one round factor, which the drawing says; the plan itself is to scale.
Result<std::vector<Sheet>> draw_as_built(const Survey& survey, const AsBuiltSurvey& found) {
  const double factor = magnification(survey, found);
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey)) {
    DrawingView view = plan_view(survey, strip);
    if (factor != 1) {
      view.title += fmt::format("; arrows and 95 % ellipses magnified {:g} times", factor);
    }
    for (const AsBuiltTag& tag : found.tags) {
      const PlacedTag& surveyed = *find_tag(survey, tag.tag);
      if (surveyed.chainage < strip.from || surveyed.chainage > strip.to) continue;
      add_tag(view.sketch, survey, strip, surveyed, tag, factor);
    }
    views.push_back(std::move(view));
  }
  views.push_back(summary_view(found));
  return lay_out_sheets({survey.name, "as built", {}}, views,
                        {.coarsest_scale = coarsest_plan_scale(survey)});
}

// ---- The command.

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr const char* kAdjustNotes = R"(Example:
  tagsmith verify --json mine/survey.yaml --rig mine/rig.yaml --run run.csv > run.jsonl
  tagsmith adjust mine/survey.yaml --rig mine/rig.yaml --run run.csv run.jsonl -o as-built.yaml

All photos are adjusted at once. The control tags hold them: those with `control: true` in `placed`,
or those of --control, within the survey's sigma. FILE: output of `verify --json` (.jsonl), which
takes the place of the photos; or photos, or folders of them. Without FILE the photos of the run.
Exit: 0 every tag seen has its place, 1 one is not determined, a line of FILE is broken, or nothing
was written because a control tag does not hang where the survey has it, the photos contradict each
other or the rig, 2 a file could not be read.)";

// --- what is printed ---

// Converts world axes to the grid's.
Matrix3d in_grid(const Grid& grid, const Matrix3d& covariance) {
  Matrix3d axes;
  for (Eigen::Index i = 0; i < 3; ++i) {
    axes.col(i) =
        grid_from_world(grid, Vector3d::Unit(i)) - grid_from_world(grid, Vector3d::Zero());
  }
  return axes * covariance * axes.transpose();
}

// To the micrometre; a value that rounds to zero has no sign.
Vector3d p_in_grid(const Survey& survey, const AsBuiltTag& tag) {
  const Vector3d p = grid_from_world(survey.grid, tag.world_from_plate.translation);
  return p.unaryExpr([](double value) { return std::round(1e6 * value) / 1e6 + 0.0; });
}

Vector3d sigma_in_grid(const Survey& survey, const AsBuiltTag& tag) {
  const Matrix3d covariance = tag.covariance.topLeftCorner<3, 3>();
  return in_grid(survey.grid, covariance).diagonal().cwiseMax(0).cwiseSqrt();
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
              shown(p.y()), shown(p.z()), 1e3 * tag.survey_sigma, 1e3 * tag.shift.norm(),
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
  const Vector3d surveyed = find_tag(survey, tag.tag)->p_in_grid;
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

// An infinite value is null.
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

// The survey's text with the places that were determined.
Result<std::string> as_built_text(const AdjustOptions& options, const std::string& text,
                                  const Survey& survey, const AsBuiltSurvey& found) {
  std::vector<AsBuiltPlace> places;
  for (const AsBuiltTag& tag : found.tags) {
    if (tag.status != AsBuiltStatus::adjusted) continue;
    places.push_back({tag.tag, p_in_grid(survey, tag),
                      attitude_of(survey.grid, tag.world_from_plate), tag.survey_sigma,
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
  if (!text) return fail(text);
  const Result<std::string> changed = as_built_text(options, *text, survey, found);
  if (!changed) return fail(changed);
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
  if (!sheets) return fail(sheets);
  const auto files = render_sheets(*sheets, options.drawing);
  if (!files) return fail(files);
  return publish_files(*files);
}

// Why the places must not be used; nothing where they may.
std::optional<std::string> reason_not_to_write(const AsBuiltSurvey& found,
                                               const std::vector<std::string>& control) {
  constexpr std::size_t kMostLeftOut = 10;  // one in so many sightings: more are no coincidence
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

// Reports the control tags of which a mistake, alone or shared by several, would not be noticed.
void warn_of_unchecked(const std::vector<ControlGroup>& groups) {
  constexpr double kLarge = 0.02;  // metres: ten times what control tags are usually surveyed to
  for (const ControlGroup& group : groups) {
    if (group.unnoticed < kLarge) continue;
    const bool one = group.tags.size() == 1;
    const std::string names = fmt::format("{}", fmt::join(group.tags, ", "));
    if (std::isinf(group.unnoticed)) {
      to_stderr("tagsmith {}: nothing{} tells whether {} {} as surveyed\n", kAdjust,
                one ? "" : " but each other", names, one ? "hangs" : "hang");
    } else {
      to_stderr(
          "tagsmith {}: {} may hang up to {:.0f} mm from where the survey has {} without any other "
          "control tag telling\n",
          kAdjust, names, 1e3 * group.unnoticed, one ? "it" : "them all");
    }
  }
}

// Reports tags that were surveyed, hang there by the photos, and whose places the photos tell less
// well than the survey does.
void warn_of_less_certain(const Survey& survey, const AsBuiltSurvey& found) {
  constexpr double kFarthest = 3;  // standard deviations
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::string> names;
  for (const AsBuiltTag& tag : found.tags) {
    const PlacedTag& surveyed = *find_tag(survey, tag.tag);
    const bool is_better = surveyed.surveyed && surveyed.sigma < tag.survey_sigma;
    if (tag.status != AsBuiltStatus::adjusted || !is_better) continue;
    const double sigma = std::hypot(surveyed.sigma, tag.survey_sigma);
    if (tag.shift.cwiseAbs().maxCoeff() < kFarthest * sigma) names.push_back(tag.tag);
  }
  if (names.empty()) return;
  const std::size_t count = names.size();
  names.resize(std::min(count, kMostNamed));
  to_stderr(
      "tagsmith {}: {} in `placed` {} as surveyed by the photos, which tell the place less well "
      "than the survey does: {}{}: with `control: true` such tags keep their places\n",
      kAdjust, counted(count, "tag"), count == 1 ? "hangs" : "hang", fmt::join(names, ", "),
      count > kMostNamed ? " ..." : "");
}

Result<int> run(const AdjustOptions& options) {
  const Result<AdjustInput> input = load_adjust_input(options);
  if (!input) return fail(input);
  const Result<Sightings> seen = sightings_of(*input, options.jobs);
  if (!seen) return fail(seen);
  const std::vector<SightedTag>& sighted = seen->tags;
  print_assumptions(kAdjust, assumptions({&input->survey, 1}, input->setup.rig));
  if (const auto doubt = rig_doubt(input->survey, input->setup.rig, sighted)) {
    to_stderr("tagsmith {}: the {} in doubt, and nothing was adjusted: {}\n", kAdjust,
              doubt->hung ? "plates are" : "rig is", doubt->text);
    return kExitFindings;
  }
  Result<AsBuiltSurvey> found =
      adjust_as_built(input->survey, input->setup.rig, sighted, input->control);
  if (!found) return fail(options.survey + ": " + found.error().message);
  judge_control(input->survey, *found);
  options.json ? print_json(input->survey, *found) : print_words(input->survey, *found);
  if (const auto drawn = write_drawing(options, input->survey, *found); !drawn) {
    return fail(drawn);
  }
  auto reason = reason_not_to_write(*found, input->control);
  if (!reason && count_of(*found, AsBuiltStatus::control) == 1) {
    reason = doubt_of_single_control(*input, sighted, *found);
  }
  if (!reason) warn_of_unchecked(found->groups);
  if (reason) {
    const std::string& file = options.output.empty() ? options.diff : options.output;
    const std::string what =
        file.empty() ? "do not rely on these places" : file + " was not written";
    to_stderr("tagsmith {}: {}: {}\n", kAdjust, what, *reason);
    return kExitFindings;
  }
  warn_of_less_certain(input->survey, *found);
  const auto written = write_survey(options, input->survey, *found);
  if (!written) return fail(written);
  const bool is_complete =
      seen->all_lines_read && count_of(*found, AsBuiltStatus::undetermined) == 0;
  return is_complete ? kExitOk : kExitFindings;
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
