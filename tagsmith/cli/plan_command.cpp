// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/cli/plan_report.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/paper_plan/expected_by_paper.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/optimise.hpp"
#include "tagsmith/placement/plan_summary.hpp"
#include "tagsmith/render/plan_drawing.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/edit_yaml.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"

namespace tagsmith::detail {

// ---- A better layout: the search for it, and writing it to files.

namespace {

struct OptimiseOptions {
  Requirement requirement;
  CostOrder order = CostOrder::tags;
  std::vector<std::string> vary{"height", "plate", "stagger", "alpha"};

  bool varies(const char* what) const { return std::ranges::count(vary, what) > 0; }
};

namespace fs = std::filesystem;

// The chosen layout as files, read back from them: the next plan uses what was written.
struct OptimisedDrive {
  Optimisation optimisation;
  // By name: the survey, the rig, and the files that these name: calibrations, and template and
  // logo where they are not the tool's own.
  std::vector<SheetFile> files;
  std::vector<std::string>
      outside;  // of the files named, those in no folder of the file naming them
  Survey survey;
  Rig rig;
};

// Templates to choose from, by file.
using Templates = std::map<fs::path, TagTemplate>;

void add_templates(const fs::path& folder, Templates& templates) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".yaml" || !entry.is_regular_file(error)) continue;
    if (const auto tag = load_template(entry.path())) templates.emplace(entry.path(), *tag);
  }
}

// The tool's own and those beside the survey; of two of one name the survey's.
Templates available_templates(const Survey& survey) {
  Templates all;
  const fs::path beside = survey.file.has_parent_path() ? survey.file.parent_path() : ".";
  add_templates(beside, all);
  std::set<std::string> names;
  for (const auto& [path, tag] : all) names.insert(path.stem().string());
  Templates own;
  add_templates(data_directory() / "templates", own);
  for (const auto& [path, tag] : own) {
    if (!names.contains(path.stem().string())) all.emplace(path, tag);
  }
  return all;
}

bool is_same_plate(const TagTemplate& a, const TagTemplate& b) {
  return a.name == b.name && a.plate_length == b.plate_length && a.plate_height == b.plate_height &&
         a.frame_inner_length == b.frame_inner_length &&
         a.frame_inner_height == b.frame_inner_height;
}

std::vector<YamlEdit> survey_edits(const Survey& survey, const Layout& layout,
                                   const std::string& template_name) {
  const TagSeries& given = *survey.series;
  const TagSeries& series = layout.series;
  std::vector<YamlEdit> edits;
  const auto change = [&](const std::string& key, const std::string& value,
                          const std::string& instead_of = {}) {
    edits.push_back({{"tags"}, key, value, instead_of});
  };
  if (!is_same_plate(survey.tag_template, layout.tag_template)) change("template", template_name);
  if (series.spacing != given.spacing) change("spacing", format_number(series.spacing, 3));
  if (series.mount_height != given.mount_height)
    change("height", format_number(series.mount_height, 3));
  if (series.pairs != given.pairs) change("pairs", std::to_string(series.pairs), "to");
  if (series.pair_angle != given.pair_angle) {
    const double facing =
        std::atan2(layout.tag_template.frame_inner_length, width_at(survey.tunnel, series.first));
    change("theta", format_number(degrees(series.pair_angle.value_or(facing)), 9));
  }
  return edits;
}

// `alpha` makes a camera level; one that is not level keeps its pitch and roll beside a new yaw.
bool is_level(const RigCamera& camera) {
  const Eigen::Matrix3d& rotation = camera.vehicle_from_camera.rotation;
  constexpr double kRounding = 1e-9;
  return std::abs(rotation(2, 2)) < kRounding && std::abs(rotation(2, 0)) < kRounding;
}

std::vector<YamlEdit> rig_edits(const Rig& rig, double alpha) {
  std::vector<YamlEdit> edits;
  for (const RigCamera& camera : rig.cameras) {
    if (is_level(camera)) {
      edits.push_back({{"cameras", camera.name}, "alpha", format_number(degrees(alpha), 3), "yaw"});
    } else {
      const double yaw = (camera.side == Side::left ? 90 : -90) * (1 - degrees(alpha) / 90);
      edits.push_back({{"cameras", camera.name}, "yaw", format_number(yaw, 3), {}});
    }
  }
  return edits;
}

Result<std::string> edited_file(const fs::path& file, const std::vector<YamlEdit>& edits) {
  const Result<std::string> text = read_file(file);
  if (!text) return fail(text);
  auto edited = edit_yaml(*text, edits);
  if (!edited) return fail(file.string() + ": " + edited.error().message);
  return std::move(*edited);
}

// Adds a file that a file in `folder` names, so that its copy names it, too.
Result<void> add_named(const fs::path& file, const fs::path& folder, OptimisedDrive& drive) {
  const fs::path name = file.lexically_proximate(folder).lexically_normal();
  if (name.is_absolute() || std::ranges::count(drive.files, name, &SheetFile::path) > 0) return {};
  if (*name.begin() == "..") {
    drive.outside.push_back(file.string());
    return {};
  }
  Result<std::string> bytes = read_file(file);
  if (!bytes) return fail(bytes);
  drive.files.push_back({name, std::move(*bytes)});
  return {};
}

bool is_own_template(const fs::path& file) {
  std::error_code error;
  return fs::equivalent(file.parent_path(), data_directory() / "templates", error);
}

Result<void> add_template(const TagTemplate& tag, const fs::path& folder, OptimisedDrive& drive) {
  if (is_own_template(tag.file)) return {};
  if (auto added = add_named(tag.file, folder, drive); !added) return added;
  return tag.logo.file.empty() ? Result<void>{} : add_named(tag.logo.file, folder, drive);
}

// Adds the chosen survey, read back from its text.
Result<void> write_survey(const Survey& survey, const Layout& layout, const Templates& templates,
                          OptimisedDrive& drive) {
  const fs::path folder = survey.file.parent_path();
  std::string template_name = layout.tag_template.name;
  if (is_same_plate(survey.tag_template, layout.tag_template)) {
    if (auto added = add_template(survey.tag_template, folder, drive); !added) return added;
  } else {
    const auto used = std::ranges::find_if(templates, [&](const auto& entry) {
      return is_same_plate(entry.second, layout.tag_template);
    });
    if (used != templates.end()) {
      template_name = used->first.stem().string();
      if (auto added = add_template(used->second, folder, drive); !added) return added;
    }
  }
  auto text = edited_file(survey.file, survey_edits(survey, layout, template_name));
  if (!text) return fail(text);
  Diagnosed<Survey> reading = read_survey_text(survey.file, *text);
  if (!reading.value) {
    return fail("the chosen layout makes no valid survey:\n" +
                to_string(reading.diagnostics, true));
  }
  drive.survey = std::move(*reading.value);
  drive.files.push_back({survey.file.filename().string(), std::move(*text)});
  return {};
}

Result<void> write_rig(const Rig& rig, const Layout& layout, OptimisedDrive& drive) {
  for (const RigCamera& camera : rig.cameras) {
    if (camera.calibration.empty()) continue;
    if (auto added = add_named(camera.calibration, rig.file.parent_path(), drive); !added) {
      return added;
    }
  }
  auto text =
      edited_file(rig.file, layout.alpha ? rig_edits(rig, *layout.alpha) : std::vector<YamlEdit>{});
  if (!text) return fail(text);
  Diagnosed<Rig> reading = read_rig_text(rig.file, *text);
  if (!reading.value) {
    return fail("the chosen alpha makes no valid rig:\n" + to_string(reading.diagnostics, true));
  }
  drive.rig = std::move(*reading.value);
  drive.files.push_back({rig.file.filename().string(), std::move(*text)});
  return {};
}

std::string stagger_text(const Layout& layout) {
  if (!layout.series.pair_angle) return "facing";
  return format_number(degrees(*layout.series.pair_angle), 1) + " deg";
}

std::string row(const LayoutReport& report, const Optimisation& optimisation) {
  const Layout& layout = report.layout;
  return fmt::format(
      "{} {:<20}{:>5}{:>9.2f}{:>9}{:>8}  {:<14}{:>10}{:>8}{:>13}{:>13}\n",
      report.name == optimisation.chosen.name ? ">" : " ", report.name, report.tags,
      report.plate_area, format_number(layout.series.spacing, 3),
      format_number(layout.series.mount_height, 2), layout.tag_template.name, stagger_text(layout),
      layout.alpha ? format_number(degrees(*layout.alpha), 1) : "given",
      std::isfinite(report.worst_plane) ? fmt::format("{:.1f} mm", 1000 * report.worst_plane)
                                        : "none",
      report.meets ? "met" : fmt::format("{:.1f} %", 100 * report.met_share));
}

// A line for each; a freedom without effect is reported as such.
std::string table(const Optimisation& optimisation) {
  std::string text = fmt::format("  {:<20}{:>5}{:>9}{:>9}{:>8}  {:<14}{:>10}{:>8}{:>13}{:>13}\n",
                                 "what varies", "tags", "area, m2", "spacing", "height", "plate",
                                 "theta", "alpha", "worst plane", "requirement");
  text += row(optimisation.given, optimisation);
  const std::vector<LayoutReport>& rows = optimisation.alternatives;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto same = std::ranges::find_if(
        rows, [&](const LayoutReport& other) { return is_same(other.layout, rows[i].layout); });
    const bool is_new = static_cast<std::size_t>(same - rows.begin()) == i;
    text += is_new ? row(rows[i], optimisation)
                   : fmt::format("  {:<20} no better than {}\n", rows[i].name, same->name);
  }
  return text;
}

Json json_of(const LayoutReport& report) {
  const Layout& layout = report.layout;
  const auto in_degrees = [](const std::optional<double>& angle) {
    return angle ? Json(degrees(*angle)) : Json();
  };
  return {{"name", report.name},
          {"tags", report.tags},
          {"plate_area", report.plate_area},
          {"template", layout.tag_template.name},
          {"spacing", layout.series.spacing},
          {"height", layout.series.mount_height},
          {"pairs", layout.series.pairs},
          {"theta_deg", in_degrees(layout.series.pair_angle)},
          {"alpha_deg", in_degrees(layout.alpha)},
          {"meets", report.meets},
          {"met_share", report.met_share},
          {"covered_share", report.covered_share},
          {"plane_any_pose", finite_or_null(report.worst_plane)}};
}

Result<OptimisedDrive> optimise_drive(const Survey& survey, const Rig& rig,
                                      const OptimiseOptions& options, const PlanOptions& plan) {
  const Templates templates = available_templates(survey);
  std::vector<TagTemplate> plates;
  for (const auto& [path, tag] : templates) plates.push_back(tag);
  const Freedom freedom{options.varies("height"), options.varies("plate"),
                        options.varies("stagger"), options.varies("alpha")};
  std::optional<ProgressBar> bar;
  const auto show = [&bar](std::size_t, std::size_t total) {
    if (!bar) bar.emplace("layouts", total);
    bar->advance([] {});
  };
  auto found =
      optimise(survey, rig, plates, options.requirement, options.order, freedom, plan, show);
  bar.reset();
  if (!found) return fail(found);
  OptimisedDrive drive;
  drive.optimisation = std::move(*found);
  const Layout& layout = drive.optimisation.chosen.layout;
  if (auto written = write_survey(survey, layout, templates, drive); !written) {
    return fail(written);
  }
  if (auto written = write_rig(rig, layout, drive); !written) return fail(written);
  return drive;
}

// What was tried of each freedom, and what is never tried.
std::string limits_text(const OptimiseOptions& options, bool alpha_can_vary) {
  std::string text = "\ntried       spacing from 0.05 to 20 m in steps of 0.05 m\n";
  const auto add = [&](const char* line) { text += std::string(12, ' ') + line + "\n"; };
  if (options.varies("plate")) add("every template of the tool and of the survey's folder");
  if (options.varies("height")) add("height of P in steps of 0.2 m, up to 4 m");
  if (options.varies("stagger")) add("plates facing, and half a pitch apart");
  if (options.varies("alpha") && alpha_can_vary) add("alpha from 15 to 75 deg in steps of 5 deg");
  text += "not varied  the first tag's chainage, tags on one wall alone, a spacing that changes\n";
  add("the rig's cameras, lenses, places and exposure");
  if (options.varies("alpha") && !alpha_can_vary)
    add("alpha: not every camera of the rig has a side");
  return text +
         "One freedom after the other, twice over: the best found, which need not be the best\n"
         "there is.\n";
}

// The alternatives, a line each, the chosen one marked.
std::string optimisation_report(const Optimisation& optimisation, const OptimiseOptions& options) {
  std::string text = fmt::format(
      "required: plane at most {} mm at every pose{}\n"
      "          along {:.1f} % of the drive{}\n\n",
      format_number(1000 * options.requirement.plane_sigma, 3),
      options.requirement.tags_lost == 0
          ? ""
          : "; with any one tag lost a tag at every\n"
            "          pose still, and that plane on the center line",
      100 * optimisation.demanded_share,
      optimisation.demanded_share < 1
          ? " (elsewhere not even the given plates side by side serve every pose)"
          : "");
  return text + table(optimisation) + limits_text(options, optimisation.alpha_can_vary);
}

// One JSON object (docs/formats.md).
std::string optimisation_json(const Optimisation& optimisation) {
  return json_text({{"demanded_share", optimisation.demanded_share},
                    {"given", json_of(optimisation.given)},
                    {"chosen", json_of(optimisation.chosen)},
                    {"alternatives", json_list(optimisation.alternatives, json_of)}});
}

// ---- The command.

constexpr const char* kName = "plan";

struct PlanCommandOptions {
  std::string survey;
  std::string rig;
  std::string folder;
  Paper paper = Paper::a3;
  PlanOptions plan;
  bool optimise = false;
  OptimiseOptions optimisation;
  bool json = false;
};

// The plan's input: the files as given, or the better layout of them.
struct Subject {
  Survey survey;
  Rig rig;
  std::optional<OptimisedDrive> better;
};

// The files whose names are known before the plan: a drawing of several sheets has more.
CommandFiles files_of(const PlanCommandOptions& options, const Survey& survey, const Rig& rig) {
  CommandFiles files;
  files.reads(survey);
  files.reads(rig);
  if (options.folder.empty()) return files;
  std::vector<fs::path> names{"plan.json", "plan.html", "plan.pdf", "plan.svg"};
  if (options.optimise) {
    names.insert(names.end(), {survey.file.filename(), rig.file.filename()});
  }
  for (const fs::path& name : names) files.writes(options.folder / name, "--output");
  return files;
}

Result<Subject> load(const PlanCommandOptions& options) {
  Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey);
  Result<Rig> rig = load_rig(options.rig);
  if (!rig) return fail(rig);
  const auto usable = files_of(options, *survey, *rig).check();
  if (!usable) return fail(usable);
  Subject subject{std::move(*survey), std::move(*rig), std::nullopt};
  if (!options.optimise) return subject;
  auto better = optimise_drive(subject.survey, subject.rig, options.optimisation, options.plan);
  if (!better) return fail(better);
  subject.survey = better->survey;
  subject.rig = better->rig;
  subject.better = std::move(*better);
  return subject;
}

std::string as_json(const PlannedDrive& drive, const Subject& subject) {
  std::string object = plan_json(drive);
  if (!subject.better) return object + "\n";
  object.pop_back();
  return object + ",\"optimisation\":" + optimisation_json(subject.better->optimisation) + "}\n";
}

std::string as_text(const PlannedDrive& drive, const Subject& subject,
                    const PlanCommandOptions& options) {
  std::string report = plan_report(drive);
  if (!subject.better) return report;
  return optimisation_report(subject.better->optimisation, options.optimisation) +
         "\nThe chosen layout, planned again from its files, meets the requirement:\n" + report;
}

// The claims of --optimise, by the plan of the files that it writes.
Result<void> check_claim(const DrivePlan& plan, const Subject& subject,
                         const PlanCommandOptions& options) {
  if (!subject.better) return {};
  const double share =
      served_share(plan, options.optimisation.requirement, subject.better->optimisation.demanded);
  if (share == 1) return {};
  return fail(fmt::format(
      "the chosen layout ({}), planned again from its files, meets the requirement along {:.2f} % "
      "of the drive only; nothing was written",
      subject.better->optimisation.chosen.name, 100 * share));
}

Result<void> write_files(const PlannedDrive& drive, const Subject& subject,
                         const PlanCommandOptions& options) {
  if (options.folder.empty()) return {};
  const fs::path folder = options.folder;
  std::vector<SheetFile> files{{folder / "plan.json", as_json(drive, subject)},
                               {folder / "plan.html", plan_page(drive)}};
  if (subject.better) {
    for (const SheetFile& file : subject.better->files) {
      files.push_back({folder / file.path, file.bytes});
    }
  }
  const auto sheets = draw_plan(drive.survey, drive.rig, drive.plan, options.paper);
  if (!sheets) return fail(sheets);
  for (const char* name : {"plan.pdf", "plan.svg"}) {
    const auto rendered = render_sheets(*sheets, folder / name);
    if (!rendered) return fail(rendered);
    files.insert(files.end(), rendered->begin(), rendered->end());
  }
  CommandFiles named;
  named.reads(drive.survey);
  named.reads(drive.rig);
  for (const SheetFile& file : files) named.writes(file.path, "--output");
  if (auto usable = named.check(); !usable) return usable;
  if (auto written = publish_files(files); !written) return written;
  if (subject.better && !subject.better->outside.empty()) {
    to_stderr("tagsmith plan: warning: {} must be named anew in the files in {}: {}\n",
              subject.better->outside.size() == 1 ? "a file" : "files", options.folder,
              fmt::join(subject.better->outside, ", "));
  }
  return {};
}

// Poses before and beyond the center line are planned as any others.
void warn_of_outside(const PlannedDrive& drive) {
  constexpr double kRounding = 1e-6;
  const double length = drive.survey.tunnel.centerline.length();
  const double from = drive.plan.columns.front().chainage;
  const double to = drive.plan.columns.back().chainage;
  if (from >= -kRounding && to <= length + kRounding) return;
  to_stderr(
      "tagsmith plan: warning: the drive goes from chainage 0 to {} m, the plan from {} to {} m: "
      "poses outside the drive count in all shares\n",
      format_number(length, 3), format_number(from, 3), format_number(to, 3));
}

Result<int> plan(const PlanCommandOptions& options) {
  const Result<Subject> subject = load(options);
  if (!subject) return fail(subject);
  PlanOptions with_paper = options.plan;
  with_paper.paper = [&](const auto& pose, const auto& sights, const auto& accuracy) {
    return expect_by_paper(subject->survey, subject->rig, pose, sights, accuracy);
  };
  const Result<DrivePlan> drive_plan = plan_drive(subject->survey, subject->rig, with_paper);
  if (!drive_plan) return fail(drive_plan);
  if (auto kept = check_claim(*drive_plan, *subject, options); !kept) {
    return fail(kept);
  }
  const PlanSummary summary = summarize(*drive_plan);
  const PlannedDrive drive{subject->survey, subject->rig, *drive_plan, summary};
  print_assumptions(kName, plan_assumptions(drive));
  warn_of_outside(drive);
  if (auto written = write_files(drive, *subject, options); !written) {
    return fail(written);
  }
  to_stdout("{}",
            Lines{options.json ? as_json(drive, *subject) : as_text(drive, *subject, options)});
  return summary.gaps.empty() ? kExitOk : kExitFindings;
}

constexpr double kFarthestChainage = 1e6;  // metres before or behind the center line's start

std::vector<CommandOption> drive_options(PlanOptions& options) {
  return {
      number_option("--from", &options.from, "M", -kFarthestChainage, kFarthestChainage,
                    "Chainage of the plan's start, m (default: 0)"),
      number_option("--to", &options.to, "M", -kFarthestChainage, kFarthestChainage,
                    "Chainage of its end, m (default: the center line's end)"),
      number_option("--step", &options.step, "M", 1e-4, 1000,
                    "Step of the chainage, m (default: 0.05)"),
      odd(number_option("--offsets", &options.lateral_offsets, "N", 1, 101,
                        "Lateral offsets over the envelope, odd (default: 5)")),
      odd(number_option("--headings", &options.headings, "N", 1, 101,
                        "Headings over the envelope, odd (default: 5)")),
      number_option("--speed", &options.speed, "M/S", 0, 100,
                    "Speed in m/s instead of the envelope's"),
      number_option("--corner-sigma", &options.corner_sigma_px, "PX", 1e-4, 100,
                    "Standard deviation of a corner's coordinate, pixels (default: as measured)"),
      jobs_option(options.jobs, "Cores to use at most")};
}

std::vector<CommandOption> optimise_options(OptimiseOptions& options) {
  std::vector<CommandOption> all{
      number_option(
          "--plane-sigma", [&options](double mm) { options.requirement.plane_sigma = mm / 1000; },
          "MM", 1e-3, 1e5, "Greatest sigma in the plane at any pose, mm (default: 20)"),
      number_option("--tags-lost", &options.requirement.tags_lost, "N", 0, 1,
                    "Tags that may be unreadable, 0 or 1 (default: 0)"),
      choice_option(
          "--least",
          [&options](const std::string& what) {
            options.order = what == "plate" ? CostOrder::plate : CostOrder::tags;
          },
          {"tags", "plate"},
          "tags: fewest tags, that is the widest spacing; plate: smallest plate (default: tags)"),
      by_commas(choice_option("--vary", &options.vary,
                              {"height", "plate", "stagger", "alpha", "none"},
                              "What may change besides the spacing (default: all of "
                              "height,plate,stagger,alpha; none: nothing else)"))};
  for (CommandOption& option : all) option.needs = {"--optimise"};
  return all;
}

}  // namespace

Command plan_command() {
  const auto options = std::make_shared<PlanCommandOptions>();
  return {
      .name = kName,
      .summary =
          "What the cameras will see along the drive, and how well the vehicle will know "
          "its place",
      .options = joined(
          {{survey_argument(&options->survey, "Survey file (YAML)"),
            required(rig_option(&options->rig,
                                "Rig file (YAML); vehicle.envelope says how far it strays")),
            folder_option("-o,--output", &options->folder,
                          "Folder for plan.pdf, plan.svg, plan.html, plan.json and, with "
                          "--optimise, the chosen survey; made if missing"),
            needing({"--output"}, drawing_paper_option(
                                      "--paper", options->paper,
                                      "Paper of plan.pdf and plan.svg, landscape (default: a3)")),
            json_flag(options->json, "One JSON object instead of the report"),
            flag(
                "--optimise", &options->optimise,
                "Look for the cheapest layout that keeps the promise below; -o writes its survey")},
           optimise_options(options->optimisation),
           drive_options(options->plan)}),
      .notes =
          "Exit code: 0 every pose has a position, 1 some have none, 2 a file cannot be read.\n\n"
          "Example:\n"
          "  tagsmith plan surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --to 5\n"
          "  tagsmith plan surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --to 5 \\\n"
          "    --optimise --plane-sigma 5 --tags-lost 1 -o out/better",
      .run = [options] { return plan(*options); },
  };
}

}  // namespace tagsmith::detail
