// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/plan_optimise.hpp"
#include "tagsmith/cli/plan_page.hpp"
#include "tagsmith/cli/plan_report.hpp"
#include "tagsmith/paper_plan/expected_by_paper.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/plan_summary.hpp"
#include "tagsmith/render/plan_drawing.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

constexpr const char* kName = "plan";

struct PlanCommandOptions {
  std::string survey;
  std::string rig;
  std::string folder;
  std::string paper = "a3";
  PlanOptions plan;
  bool optimise = false;
  OptimiseOptions optimisation;
  bool json = false;
};

// What is planned: the files as given, or the better layout of them.
struct Subject {
  Survey survey;
  Rig rig;
  std::optional<OptimisedDrive> better;
};

// The files that are known before the plan is: a drawing of several sheets has more.
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
  if (!survey) return fail(survey.error().message);
  Result<Rig> rig = load_rig(options.rig);
  if (!rig) return fail(rig.error().message);
  const auto usable = files_of(options, *survey, *rig).check();
  if (!usable) return fail(usable.error().message);
  Subject subject{std::move(*survey), std::move(*rig), std::nullopt};
  if (!options.optimise) return subject;
  auto better = optimise_drive(subject.survey, subject.rig, options.optimisation, options.plan);
  if (!better) return fail(better.error().message);
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

// What --optimise claims, by the plan of the files that it writes.
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
    for (const LayoutFile& file : subject.better->files) {
      files.push_back({folder / file.name, file.bytes});
    }
  }
  const auto sheets = draw_plan(drive.survey, drive.rig, drive.plan, paper_of(options.paper));
  if (!sheets) return fail(sheets.error().message);
  for (const char* name : {"plan.pdf", "plan.svg"}) {
    const auto rendered = render_sheets(*sheets, folder / name);
    if (!rendered) return fail(rendered.error().message);
    files.insert(files.end(), rendered->begin(), rendered->end());
  }
  CommandFiles named;
  named.reads(drive.survey);
  named.reads(drive.rig);
  for (const SheetFile& file : files) named.writes(file.path, "--output");
  if (auto usable = named.check(); !usable) return usable;
  return publish_files(files);
}

Result<int> plan(const PlanCommandOptions& options) {
  const Result<Subject> subject = load(options);
  if (!subject) return fail(subject.error().message);
  PlanOptions with_paper = options.plan;
  with_paper.paper = [&](const auto& pose, const auto& sights, const auto& accuracy) {
    return expect_by_paper(subject->survey, subject->rig, pose, sights, accuracy);
  };
  const Result<DrivePlan> drive_plan = plan_drive(subject->survey, subject->rig, with_paper);
  if (!drive_plan) return fail(drive_plan.error().message);
  if (auto kept = check_claim(*drive_plan, *subject, options); !kept) {
    return fail(kept.error().message);
  }
  print_assumptions(kName, assumptions(std::span(&subject->survey, 1), subject->rig));
  const PlanSummary summary = summarize(*drive_plan);
  const PlannedDrive drive{subject->survey, subject->rig, *drive_plan, summary};
  if (auto written = write_files(drive, *subject, options); !written) {
    return fail(written.error().message);
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
  Command command{
      .name = kName,
      .summary =
          "What the cameras will see along the drive, and how well the vehicle will know "
          "its place",
      .options =
          {survey_argument(&options->survey, "Survey file (YAML)"),
           required(rig_option(&options->rig,
                               "Rig file (YAML); vehicle.envelope says how far it strays")),
           folder_option("-o,--output", &options->folder,
                         "Folder for plan.pdf, plan.svg, plan.html, plan.json and, with "
                         "--optimise, the chosen survey; made if missing"),
           needing({"--output"},
                   choice_option("--paper", &options->paper, drawing_papers(),
                                 "Paper of plan.pdf and plan.svg, landscape (default: a3)")),
           json_flag(options->json, "One JSON object instead of the report"),
           flag("--optimise", &options->optimise,
                "Look for the cheapest layout that keeps the promise below; -o writes its survey")},
      .notes =
          "Exit code: 0 every pose has a position, 1 some have none, 2 a file cannot be read.\n\n"
          "Example:\n"
          "  tagsmith plan surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --to 5\n"
          "  tagsmith plan surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --to 5 \\\n"
          "    --optimise --plane-sigma 5 --tags-lost 1 -o out/better",
      .run = [options] { return plan(*options); },
  };
  std::ranges::move(optimise_options(options->optimisation), std::back_inserter(command.options));
  std::ranges::move(drive_options(options->plan), std::back_inserter(command.options));
  return command;
}

}  // namespace tagsmith::detail
