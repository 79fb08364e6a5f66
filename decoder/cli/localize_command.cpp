// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/cli/commands.hpp"
#include "decoder/cli/fix_files.hpp"
#include "decoder/cli/follow.hpp"
#include "decoder/cli/observe_run.hpp"
#include "decoder/cli/run_drawing.hpp"
#include "decoder/localize/altered_pictures.hpp"
#include "decoder/localize/fix.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/localize_images.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/other_drive.hpp"
#include "decoder/localize/paper_method.hpp"
#include "decoder/localize/repeated_pictures.hpp"
#include "decoder/localize/residual_picture.hpp"
#include "decoder/localize/smooth.hpp"
#include "decoder/localize/travel.hpp"
#include "decoder/paper/pipeline.hpp"
#include "decoder/paper/published.hpp"
#include "decoder/plates/rig_suspicion.hpp"
#include "decoder/plates/set_aside.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/check_together.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey_of_codes.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kLocalize = "localize";

using LocalizationMethod =
    std::function<Fix(const Observation&, const std::vector<Survey>&, const Rig&)>;

struct LocalizeOptions {
  std::vector<std::filesystem::path> surveys;
  std::filesystem::path rig;
  std::filesystem::path run;
  std::filesystem::path csv;  // these three: empty = none
  std::filesystem::path tum;
  std::filesystem::path drawing;
  std::filesystem::path pictures;  // folder, empty = none
  std::string method = "joint";
  std::string reader = "tagsmith";
  bool smooth = false;
  bool json = false;
  bool explain = false;
  bool unsurveyed = false;
  std::string own_template;     // of tags that no survey knows; empty = there is a survey
  std::optional<double> width;  // then of the tunnel, metres
  bool follow = false;
  bool confirmed = false;
  int jobs = 0;  // 0 = as many as the process may use
};

struct LocalizeInput {
  std::vector<Survey> surveys;
  Rig rig;
  Run run;
};

Result<std::vector<Survey>> surveys_of(const LocalizeOptions& options) {
  if (options.own_template.empty()) return load_surveys(options.surveys);
  auto survey = survey_of_codes(options.own_template, *options.width);
  if (!survey) return fail(survey);
  return std::vector<Survey>{std::move(*survey)};
}

Result<LocalizeInput> load(const LocalizeOptions& options) {
  auto surveys = surveys_of(options);
  if (!surveys) return fail(surveys);
  if (const auto one = check_one_grid(*surveys); !one) return fail(one);
  auto rig = load_rig(options.rig);
  if (!rig) return fail(rig);
  if (options.follow) return LocalizeInput{std::move(*surveys), std::move(*rig), {}};
  auto run = load_run(options.run, *rig);
  if (!run) return fail(run);
  return LocalizeInput{std::move(*surveys), std::move(*rig), std::move(*run)};
}

ReaderChoice reader_for(const LocalizeOptions& options) {
  if (options.reader == "paper") return {read_tags_paper, kOutlineCornerSigmaPx};
  return {read_tags, kFittedCornerSigmaPx, options.unsurveyed};
}

// What was taken for granted, a sentence each.
std::vector<std::string> assumed(const LocalizeInput& input, const LocalizeOptions& options) {
  std::vector<std::string> sentences = assumptions(input.surveys, input.rig);
  if (options.width) sentences.insert(sentences.begin(), assumed_of_codes(*options.width));
  return sentences;
}

// The fixes of all measurements by each method asked for, the one to rely on first.
using Located = std::vector<std::vector<Fix>>;

std::vector<Fix> localize_rows(const std::vector<Observation>& rows, LocalizationMethod method,
                               const LocalizeInput& input, int jobs) {
  std::vector<Fix> fixes;
  run_in_order(
      rows.size(), jobs, [&](std::size_t i) { return method(rows[i], input.surveys, input.rig); },
      [&](std::size_t, Fix& fix) { fixes.push_back(std::move(fix)); });
  return fixes;
}

// The paper's method has no run: it takes every row as it was seen.
Located localize_all(const LocalizeInput& input, const LocalizeOptions& options,
                     std::vector<Observation> rows, RunCheck& checked) {
  const std::vector<std::string> repeated = notes_on_repeated(rows);
  std::optional<std::vector<Fix>> by_paper;
  if (options.method != "joint") {
    by_paper = localize_rows(rows, localize_by_paper, input, options.jobs);
  }
  Located located;
  if (options.method != "paper") {
    checked = set_aside_misplaced(rows, input.surveys, input.rig);
    located.push_back(localize_rows(rows, localize_jointly, input, options.jobs));
  }
  if (by_paper) located.push_back(std::move(*by_paper));
  for (std::vector<Fix>& fixes : located) {
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      if (fixes[i].position_in_grid && !repeated[i].empty()) fixes[i].notes.push_back(repeated[i]);
    }
  }
  return located;
}

// Says of how many rows photos could not be read; whether there are any.
bool report_lacking_pictures(const std::vector<Observation>& rows) {
  const auto lacking = std::ranges::count_if(rows, &Observation::lacks_picture);
  if (lacking == 0) return false;
  to_stderr("tagsmith {}: photos of {} could not be read, see their notes\n", kLocalize,
            counted(static_cast<std::size_t>(lacking), "row"));
  return true;
}

// What is wrong with tags that the run shows to hang elsewhere, and with rows, once each.
void report_set_aside(const RunCheck& checked) {
  for (const std::string& words : checked.mixed) to_stderr("tagsmith {}: {}\n", kLocalize, words);
  for (const SetAside& tag : checked.aside) {
    to_stderr("tagsmith {}: set aside in {}: {}\n", kLocalize, counted(tag.rows.size(), "row"),
              tag.message);
  }
}

bool shows_no_tag(const Observation& row) { return row.tags.empty(); }

// How single measurements are located while the vehicle drives.
FollowInput live_input(const LocalizeInput& input, const LocalizeOptions& options) {
  const ReaderChoice reader = reader_for(options);
  const bool joint = options.method == "joint";
  const bool sparing = joint && options.reader == "tagsmith" && !options.unsurveyed;
  FollowInput live{input.surveys, input.rig, {}, joint, options.confirmed, options.explain};
  const auto memory = std::make_shared<PictureMemory>();
  live.localize = [&input, reader, joint, sparing, memory](
                      const Measurement& measurement, const std::vector<Survey>& surveys,
                      const std::optional<PosePrior>& prior, Observation& seen) {
    if (sparing) return localize_measurement(measurement, surveys, input.rig, prior, *memory, seen);
    // Of these methods the measurements are not compared.
    Observation row = observe(measurement, surveys, input.rig, reader, prior);
    memory->leave_out_known(row);
    seen.lacks_picture = row.lacks_picture;
    return joint ? localize_jointly(row, surveys, input.rig)
                 : localize_by_paper(row, surveys, input.rig);
  };
  return live;
}

// --- JSON ---

void print_json(const Located& located, const LocalizeInput& input, const LocalizeOptions& options,
                const RunFindings& findings) {
  const std::vector<Measurement>& measurements = input.run.measurements;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    for (const std::vector<Fix>& fixes : located) {
      to_stdout("{}\n", fix_json_line(fixes[i], measurements[i], options.explain));
    }
  }
  std::vector<FixSummary> summaries;
  for (const std::vector<Fix>& fixes : located) {
    summaries.push_back(summarize(fixes, measurements));
  }
  to_stdout("{}\n", summary_json_line(summaries, assumed(input, options), findings, input.rig));
}

// --- table ---

std::string tags_text(const Fix& fix) { return fmt::format("{}", fmt::join(fix.tags, " ")); }

// In millimetres: many are smaller than the last digit of a position in metres.
std::string sigma_text(const Fix& fix, int axis) {
  if (!fix.covariance_in_grid) return "-";
  return fmt::format("{:.1f}", 1000 * std::sqrt((*fix.covariance_in_grid)(axis, axis)));
}

std::string row_text(const Fix& fix, const Measurement& measurement) {
  if (!fix.position_in_grid) return "no position: " + fix.reason;
  // What rounds to zero is written without its sign.
  const Eigen::Vector3d position = fix.position_in_grid->unaryExpr(
      [](double value) { return std::abs(value) < 5e-4 ? 0.0 : value; });
  std::string row =
      fmt::format("{:9.3f} {:9.3f} {:9.3f}  {:>6} {:>6} {:>6}", position.x(), position.y(),
                  position.z(), sigma_text(fix, 0), sigma_text(fix, 1), sigma_text(fix, 2));
  if (const auto error = error_of(fix, measurement)) {
    row += fmt::format("  {:16.1f} {:7.1f}", 1000 * error->plane, 1000 * error->height);
  }
  return row;
}

// Where each position's uncertainty comes from, standard deviations in millimetres.
void print_budgets(const std::vector<Fix>& fixes) {
  for (const Fix& fix : fixes) {
    if (!fix.budget) continue;
    const Eigen::Matrix<double, 6, 1> sigmas = fix.pose_covariance_in_grid->diagonal().cwiseSqrt();
    to_stdout(
        "{}: heading {:.3f} deg, pitch {:.3f} deg, roll {:.3f} deg; sigma {:.3f}, {:.3f}, {:.3f}\n",
        fix.id, degrees(fix.attitude->heading), degrees(fix.attitude->pitch),
        degrees(fix.attitude->roll), degrees(sigmas[3]), degrees(sigmas[4]), degrees(sigmas[5]));
    to_stdout("  {:<12} {:>8} {:>8} {:>8}\n", "sigma in mm", "x", "y", "z");
    for (const auto& [source, covariance] : parts_of(*fix.budget)) {
      const Eigen::Vector3d mm = 1000 * covariance.diagonal().cwiseMax(0).cwiseSqrt();
      to_stdout("  {:<12} {:8.3f} {:8.3f} {:8.3f}\n", source, mm.x(), mm.y(), mm.z());
    }
    to_stdout("  residuals: chi-square {:.1f}, expected {}\n", fix.chi_square,
              fix.degrees_of_freedom);
  }
}

// Each note once, with the ids it is for; without what print_doubts says of all rows.
void print_notes(const std::vector<Fix>& fixes) {
  std::map<std::string, std::vector<std::string>> ids_of_note;
  for (const Fix& fix : fixes) {
    for (const std::string& note : fix.notes) {
      if (fix.doubt.empty() || note != note_of_doubt(fix.doubt))
        ids_of_note[note].push_back(fix.id);
    }
  }
  for (const auto& [note, ids] : ids_of_note)
    to_stdout("note {}: {}\n", fmt::join(ids, ", "), note);
}

void print_summary(const FixSummary& summary, const PublishedErrors& published) {
  to_stdout("{}, {} located", counted(summary.count, "measurement"), summary.located);
  if (summary.mean_error && summary.error95 && summary.max_error) {
    to_stdout(
        "; mean error {:.4f} m in the plane, {:.4f} m in z; 95 % {:.4f} m, {:.4f} m; greatest "
        "{:.4f} m, {:.4f} m\n",
        summary.mean_error->plane, summary.mean_error->height, summary.error95->plane,
        summary.error95->height, summary.max_error->plane, summary.max_error->height);
    to_stdout("for comparison, Xu et al. 2017, {}: mean error {:.3f} m in the plane, {:.3f} m in z",
              published.experiment, published.mean_plane, published.mean_height);
  }
  to_stdout("\n");
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
  to_stdout("{:<{}}  {:<{}}  {:>9} {:>9} {:>9}  {:>20}{}\n", "id", id_width, "tags", tags_width,
            "x", "y", "z", "sigma of x, y, z, mm",
            summary.mean_error ? "  error, mm: plane       z" : "");
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    to_stdout("{:<{}}  {:<{}}  {}\n", fixes[i].id, id_width, tags_text(fixes[i]), tags_width,
              row_text(fixes[i], measurements[i]));
  }
  print_notes(fixes);
  print_summary(summary, published);
}

void print_tables(const Located& located, const LocalizeInput& input, bool explain) {
  const PublishedErrors& published = published_errors_for(input.surveys.front().tunnel.centerline);
  for (const std::vector<Fix>& fixes : located) {
    if (located.size() > 1 && !fixes.empty()) to_stdout("method {}:\n", fixes.front().method);
    print_table(fixes, input.run.measurements, published);
    if (explain) print_budgets(fixes);
  }
}

// --- files ---

// NUMBER-ID.svg in the folder of residuals.
std::filesystem::path picture_name(std::size_t number, const std::string& id) {
  std::string name = fmt::format("{:03}-{}.svg", number, id.substr(0, 60));
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.' && c != '-'; }, '_');
  return name;
}

// `drawing`: its sheets, when they are counted; before, its file alone stands for them.
Result<void> check_files(const LocalizeOptions& options, const LocalizeInput& input,
                         const std::vector<SheetFile>& drawing) {
  CommandFiles files;
  for (const Survey& survey : input.surveys) files.reads(survey);
  files.reads(input.rig);
  files.reads(input.run);
  files.writes(options.csv, "--csv");
  files.writes(options.tum, "--tum");
  if (drawing.empty()) files.writes(options.drawing, "--drawing");
  for (const SheetFile& sheet : drawing) files.writes(sheet.path, "--drawing");
  const std::vector<Measurement>& measurements = input.run.measurements;
  for (std::size_t i = 0; i < measurements.size() && !options.pictures.empty(); ++i) {
    files.writes(options.pictures / picture_name(i + 1, measurements[i].id), "--residuals");
  }
  return files.check();
}

// Writes all files or none.
Result<void> write_files(const LocalizeOptions& options, const LocalizeInput& input,
                         const std::vector<Fix>& fixes) {
  std::vector<SheetFile> files;
  if (!options.drawing.empty()) {
    const auto sheets = draw_run(input.surveys.front(), input.rig, input.run, fixes);
    if (!sheets) return fail(sheets);
    auto pages = render_sheets(*sheets, options.drawing);
    if (!pages) return fail(pages);
    files = std::move(*pages);
    if (auto usable = check_files(options, input, files); !usable) return usable;
  }
  if (!options.csv.empty()) {
    files.push_back({options.csv, fixes_csv(fixes, input.run.measurements)});
  }
  if (!options.tum.empty()) {
    auto text = fixes_tum(fixes, input.run, input.surveys);
    if (!text) return fail(text);
    files.push_back({options.tum, std::move(*text)});
  }
  for (std::size_t i = 0; i < fixes.size() && !options.pictures.empty(); ++i) {
    if (fixes[i].corners.empty()) continue;
    files.push_back({options.pictures / picture_name(i + 1, fixes[i].id),
                     residual_picture(fixes[i], input.rig)});
  }
  return publish_files(files);
}

// Why no position of the run should be used; empty = nothing says so.
std::string doubt_of(const RunFindings& findings, const Rig& rig) {
  const std::string doubt = doubt_in_words(findings.checked, rig);
  return doubt.empty() ? findings.travel.why() : doubt;
}

void print_doubts(const RunFindings& findings, const Rig& rig) {
  constexpr const char* kDoubt = "do not rely on these positions";
  if (const std::string doubt = doubt_in_words(findings.checked, rig); !doubt.empty()) {
    to_stdout("{}\n", doubt);
  }
  if (findings.rolling) to_stdout("note: {}\n", to_string(*findings.rolling));
  if (findings.course) to_stdout("note: {}\n", to_string(*findings.course));
  if (findings.travel.turned) to_stdout("{}: {}\n", kDoubt, to_string(*findings.travel.turned));
  if (findings.travel.height) to_stdout("{}: {}\n", kDoubt, to_string(*findings.travel.height));
  if (findings.travel.range) {
    to_stdout("{}: {}\n", findings.travel.range->tags_may_be_wrong ? kDoubt : "note",
              to_string(*findings.travel.range));
  }
}

// What can be known to be wrong before the work.
Result<void> check_options(const LocalizeOptions& options) {
  const bool files = !options.csv.empty() || !options.tum.empty() || !options.drawing.empty() ||
                     !options.pictures.empty();
  const bool draws = !options.drawing.empty();
  return none_of(
      {{options.surveys.empty() && options.own_template.empty(),
        "expected SURVEY; or, to take tags by what their digits say, --template NAME with --width "
        "M"},
       {!options.surveys.empty() && !options.own_template.empty(),
        "--template is for tags of which there is no survey: leave one of them out"},
       {options.own_template.empty() != !options.width,
        "--template and --width go together: the plates' template, the tunnel's width"},
       {options.follow && !options.run.empty(),
        "--follow reads measurements from standard input, expected no --run"},
       {!options.follow && options.run.empty(), "expected --run RUN.csv, or --follow"},
       {options.follow && (files || options.method == "both"),
        "--follow answers on standard output alone, with one method"},
       {options.smooth && (options.follow || options.method == "paper"),
        "--smooth needs a whole run (--run) and the headings of --method joint"},
       {options.smooth && options.explain,
        "--explain tells what makes a single position uncertain, and --smooth joins all of a run: "
        "leave one of them out"},
       {options.confirmed && options.method != "joint",
        "--confirmed needs --method joint: the paper's closed form has nothing to spare"},
       {options.unsurveyed && options.method == "paper",
        "tags that no survey has need --method joint"},
       {options.unsurveyed && options.surveys.size() > 1,
        "--unsurveyed: expected one survey, whose code and tunnel hold for all tags"},
       {draws && !sheet_format_of(options.drawing),
        "--drawing " + options.drawing.string() +
            ": expected a name that ends in .pdf, .svg or .png"},
       {draws && options.surveys.size() > 1, "--drawing shows one tunnel, expected one survey"},
       {draws && !has_glyphs("0"),
        "--drawing: no font on this machine: install fonts-dejavu-core"}});
}

Result<int> run_localize(LocalizeOptions options) {
  options.unsurveyed = options.unsurveyed || !options.own_template.empty();
  if (const auto usable = check_options(options); !usable) {
    return fail(usable);
  }
  const Result<LocalizeInput> input = load(options);
  if (!input) return fail(input);
  print_assumptions(kLocalize, assumed(*input, options));
  if (options.follow) {
    return follow(live_input(*input, options));
  }
  if (const auto usable = check_files(options, *input, {}); !usable) {
    return fail(usable);
  }
  if (options.smooth) {
    if (const auto usable = check_times(input->run); !usable) {
      return fail(usable);
    }
  }
  std::vector<Observation> rows =
      observe_run(input->run, input->surveys, input->rig, reader_for(options), options.jobs);
  const bool lacks_pictures = report_lacking_pictures(rows);
  RunFindings findings;
  findings.altered = leave_out_altered(rows, input->surveys, input->rig);
  if (!findings.altered.empty()) to_stderr("tagsmith {}: {}\n", kLocalize, findings.altered);
  if (!options.unsurveyed && std::ranges::all_of(rows, shows_no_tag)) {
    findings.another_drive = other_drive_in_words(input->run.measurements, input->surveys);
  }
  Located located = localize_all(*input, options, rows, findings.checked);
  if (options.method != "paper" && !findings.checked.suspicion) {
    findings.rolling = rolling_shutter(located.front(), rows, input->surveys, input->rig);
  }
  findings.travel = travel_doubts(located.front(), input->surveys, input->rig);
  findings.course = course_offset(located.front());
  report_set_aside(findings.checked);
  if (options.smooth) {
    auto smoothed = smooth_fixes(located.front(), input->run, input->surveys, input->rig);
    if (!smoothed) return fail(smoothed);
    located.front() = std::move(*smoothed);
  }
  const std::string doubt = doubt_of(findings, input->rig);
  for (std::vector<Fix>& fixes : located) {
    for (Fix& fix : fixes) {
      if (!doubt.empty()) fix = doubted(std::move(fix), doubt);
      if (options.confirmed) fix = if_confirmed(std::move(fix));
    }
  }
  const std::vector<Fix>& fixes = located.front();
  if (const auto written = write_files(options, *input, fixes); !written) {
    return fail(written);
  }
  if (options.json) {
    print_json(located, *input, options, findings);
  } else {
    print_tables(located, *input, options.explain);
    if (!findings.another_drive.empty()) to_stdout("{}\n", findings.another_drive);
    print_doubts(findings, input->rig);
  }
  const auto is_located = [](const Fix& fix) { return fix.position_in_grid.has_value(); };
  const bool is_sound = !lacks_pictures && findings.altered.empty() && doubt.empty();
  return is_sound && std::ranges::all_of(fixes, is_located) ? kExitOk : kExitFindings;
}

}  // namespace

Command localize_command() {
  const auto options = std::make_shared<LocalizeOptions>();
  return {
      .name = kLocalize,
      .summary = "The vehicle's position at each measurement of a run, from what its cameras saw",
      .options =
          {argument("SURVEY", &options->surveys, ValueKind::survey,
                    "Survey files of the tunnel (survey.yaml)"),
           required(
               rig_option(&options->rig, "The vehicle's cameras and range sensors (rig.yaml)")),
           value_option("--run", &options->run, "RUN.csv",
                        "The measurements: images or distances, and ranges", ValueKind::table),
           with_default(choice_option(
               "--method", &options->method, {"joint", "paper", "both"},
               "joint: one fit to all tags, ranges and the rig's priors; paper: closed form from a "
               "tag on each wall and the range to the left wall; both: compares")),
           with_default(choice_option(
               "--reader", &options->reader, {"tagsmith", "paper"},
               "What reads the images: this program's reader, or the paper's published pipeline")),
           json_flag(options->json, "One JSON object a line, the summary last"),
           flag("--explain", &options->explain,
                "What survey, pixels, ranges and calibration contribute to each sigma"),
           folder_option("--residuals", &options->pictures,
                         "Draw each measurement's residuals: seen against fitted corners"),
           flag("--unsurveyed", &options->unsurveyed,
                "Use tags that are not in the survey too, at their coded positions"),
           value_option("--template", &options->own_template, "NAME",
                        "Without a survey: the tags' template; they hang where their digits say"),
           number_option(
               "--width", &options->width, "M", 0.1, 100,
               "Without a survey: width of the straight tunnel, m; its right wall is at x = 0"),
           flag("--confirmed", &options->confirmed,
                "No position where a wrong plate would go unnoticed: by one tag alone, unless the "
                "motion (--smooth, --follow) by other tags agrees; none in a run whose rows "
                "together doubt the rig"),
           flag("--follow", &options->follow,
                "Read measurements as JSON lines from standard input and answer each at once"),
           value_option("-o,--output,--csv", &options->csv, "FIXES.csv",
                        "Write the positions to this table too", ValueKind::file),
           flag("--smooth", &options->smooth,
                "Fit a motion of steady velocity to the run, fill its gaps; needs the column time"),
           file_option("--tum", &options->tum,
                       "Write the trajectory (TUM format); needs the run's column time"),
           file_option(
               "--drawing", &options->drawing,
               "Draw the run in the tunnel's plan, with ellipses and errors: .pdf, .svg or .png"),
           jobs_option(options->jobs, "Images read at the same time")},
      .notes =
          "Positions are in the survey's grid, metres. Exit code 0: every measurement located; 1: "
          "some have no position, each with its reason, a photo could not be read, or all rows "
          "doubt the rig; 2: a survey, "
          "rig or run could not be "
          "used.\n\n"
          "Example:\n"
          "  tagsmith localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml "
          "--run surveys/corridor/run.csv",
      .run = [options] { return run_localize(*options); },
  };
}

}  // namespace tagsmith::detail
