// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/cli/commands.hpp"
#include "decoder/localize/fix.hpp"
#include "decoder/localize/joint_method.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/paper_method.hpp"
#include "decoder/paper/published.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_json.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/cli/print_job.hpp"
#include "tagsmith/cli/print_run.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

// Xu et al. (2017), Table 4: errors in the plane and in z at the ten points, metres. They come from
// other pictures than ours, of a real corridor, so they serve for comparison and are not expected.
constexpr std::array<FixError, 10> kPaperErrors{{{0.083, 0.089},
                                                 {0.179, 0.039},
                                                 {0.270, 0.057},
                                                 {0.231, 0.128},
                                                 {0.209, 0.187},
                                                 {0.095, 0.042},
                                                 {0.021, 0.007},
                                                 {0.060, 0.108},
                                                 {0.146, 0.030},
                                                 {0.124, 0.144}}};
constexpr FixError kPaperMean{kPublishedStraight.mean_plane, kPublishedStraight.mean_height};

constexpr const char* kAboutMethods =
    "  joint: one fit to all corners of all tags and d; one tag is enough. paper: the closed form "
    "of\n"
    "  the paper from D1, D2 and d, which magnifies an error of d by 1/tan(theta) = 5.6 along the\n"
    "  drive and with d a centimetre off often has no real solution; with true d: what the photos\n"
    "  alone allow it. published: Table 4 of Xu et al. 2017, from pictures of a real corridor.\n";

constexpr const char* kPrintLines = "prints.jsonl";
constexpr const char* kPhotoLines = "photos.jsonl";
constexpr const char* kPositions = "positions.txt";

struct Demo : SurveyedRun {
  fs::path folder;  // of the output
  int jobs = 0;
};

// The path relative to the working directory, when it lies inside it.
fs::path as_seen_from_here(const fs::path& path) {
  std::error_code error;
  const fs::path nearer = fs::proximate(path, error);
  return error || nearer.string().starts_with("..") ? path : nearer;
}

Result<Demo> load_demo(const fs::path& output, int jobs) {
  const fs::path corridor = as_seen_from_here(data_directory() / "surveys" / "corridor");
  return load_surveyed_run(corridor / "survey.yaml", corridor / "rig.yaml", corridor / "run.csv")
      .map([&](SurveyedRun shipped) {
        return Demo{std::move(shipped), output, jobs};
      });
}

// PDF and SVG of every tag and their manifest. The PDFs' paths.
Result<std::vector<fs::path>> print_tags(const Demo& demo) {
  const fs::path folder = demo.folder / "print";
  std::vector<const PlacedTag*> tags;
  std::vector<fs::path> pdfs;
  for (const PlacedTag& tag : demo.survey.tags) {
    tags.push_back(&tag);
    pdfs.push_back(folder / (tag.name + ".pdf"));
  }
  PrintStyle style;
  style.revision = survey_revision(demo.survey);
  style.jobs = demo.jobs;
  const Result<PrintJob> job = plan_print(demo.survey, tags, style);
  if (!job) return fail(job);
  CommandFiles files;
  files.reads(demo.survey);
  const Result<PrintRecord> record = run_print(*job, folder, std::move(files));
  if (!record) return fail(record);
  return pdfs;
}

struct Verified {
  std::vector<VerifiedFile> files;
  VerifyMerge merged;
  std::vector<std::string> unreadable;  // why, a file each
};

Verified verify_files(const Demo& demo, const std::vector<fs::path>& files) {
  Verified verified;
  const auto verify = [&](std::size_t i) { return verify_file({demo.survey}, files[i]); };
  const auto take = [&](std::size_t, Result<VerifiedFile>& report) {
    if (report) {
      merge("", *report, verified.merged);
      verified.files.push_back(std::move(*report));
    } else {
      verified.unreadable.push_back(report.error().message);
    }
  };
  run_below_bar("files", files.size(), demo.jobs, verify, take);
  finish(verified.merged);
  return verified;
}

// One line on the files, and every finding. True when there are no findings.
bool show(const Demo& demo, const std::string& step, const Verified& verified) {
  const auto count = [&](TagStatus status) {
    return verified.merged.by_status[static_cast<std::size_t>(status)];
  };
  to_stdout("{:<10} {} files read; tags: {} ok, {} unknown, {} misprinted, {} unreadable\n", step,
            verified.files.size(), count(TagStatus::ok), count(TagStatus::unknown),
            count(TagStatus::misprinted), count(TagStatus::unreadable));
  for (const std::string& problem : verified.unreadable) to_stdout("{:<10} {}\n", "", problem);
  for (const VerifiedFile& file : verified.files) {
    for (const std::string& finding : findings_of(file)) {
      to_stdout("{:<10} {}: {}\n", "", file.file.filename().string(), finding);
    }
  }
  const std::vector<std::string> missing = missing_tags(demo.survey, verified.merged);
  if (!missing.empty()) {
    to_stdout("{:<10} not ok in any: {}\n", "", fmt::join(missing, " "));
  }
  return verified.merged.files_with_findings == 0 && verified.unreadable.empty();
}

Result<void> save_lines(const fs::path& file, const Demo& demo, const Verified& verified) {
  std::string lines;
  for (const VerifiedFile& one : verified.files) lines += to_json_line(one) + "\n";
  lines += verify_summary_line(demo.survey, verified.merged, std::nullopt, {}) + "\n";
  return write_file(file, lines);
}

// The ten points, each located three times from one reading of its photos: jointly, by the paper's
// method, and by that with the measured d replaced by the true one.
using LocatedPoints = std::array<std::vector<Fix>, 3>;

// The observation with every range to the left wall replaced by the true one. The plates' surface
// is W_T/2 left of the center line.
Observation with_true_ranges(Observation observation, const Measurement& measurement,
                             const Demo& demo) {
  if (!measurement.truth_in_grid) return observation;
  const Eigen::Vector3d truth = world_from_grid(demo.survey.grid, *measurement.truth_in_grid);
  const Tunnel& tunnel = demo.survey.tunnel;
  for (const RigRange& range : demo.rig.ranges) {
    if (!observation.ranges.contains(range.name)) continue;
    observation.ranges[range.name] =
        observe_wall(tunnel.centerline, wall_of(tunnel, range.wall), truth).distance;
  }
  return observation;
}

LocatedPoints localize(const Demo& demo) {
  const std::vector<Measurement>& measurements = demo.run.measurements;
  const std::vector<Survey> surveys{demo.survey};
  const ReaderChoice reader{read_tags, kFittedCornerSigmaPx};
  LocatedPoints located;
  const auto locate = [&](std::size_t i) {
    const Observation seen = observe(measurements[i], surveys, demo.rig, reader);
    const Observation with_true = with_true_ranges(seen, measurements[i], demo);
    return std::array{localize_jointly(seen, surveys, demo.rig),
                      localize_by_paper(seen, surveys, demo.rig),
                      localize_by_paper(with_true, surveys, demo.rig)};
  };
  const auto take = [&](std::size_t, const std::array<Fix, 3>& fixes) {
    for (std::size_t method = 0; method < 3; ++method) located[method].push_back(fixes[method]);
  };
  run_below_bar("points", measurements.size(), demo.jobs, locate, take);
  return located;
}

std::string errors_in_words(const std::optional<FixError>& error, int decimals = 4) {
  return error ? fmt::format("{:6.{}f} {:6.{}f}", error->plane, decimals, error->height, decimals)
               : fmt::format("{:>6} {:>6}", "-", "-");
}

// The position, or why there is none, without the numbers.
std::string position_in_words(const Fix& fix) {
  if (!fix.position_in_grid) return fix.reason.substr(0, fix.reason.find(':'));
  const Eigen::Vector3d& position = *fix.position_in_grid;
  return fmt::format("{:7.3f} {:7.3f} {:7.3f}", position.x(), position.y(), position.z());
}

// Errors in the plane and in z, of each method and of the paper, beside the joint method's
// positions.
std::string table_of(const Demo& demo, const LocatedPoints& located) {
  constexpr const char* kRow = "  {:<5}  {:<9}  {:<23}  {:>13}  {:>13}  {:>13}  {:>13}\n";
  const std::vector<Measurement>& measurements = demo.run.measurements;
  const std::string plane_z = fmt::format("{:>6} {:>6}", "plane", "z");
  std::string text =
      fmt::format(kRow, "", "", "errors in metres", "joint", "paper", "with true d", "published");
  text += fmt::format(kRow, "point", "tags", "      x       y       z", plane_z, plane_z, plane_z,
                      plane_z);
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const auto error_by = [&](std::size_t method) {
      return errors_in_words(error_of(located[method][i], measurements[i]));
    };
    const Fix& fix = located[0][i];
    text += fmt::format(kRow, fix.id, fmt::format("{}", fmt::join(fix.tags, " ")),
                        position_in_words(fix), error_by(0), error_by(1), error_by(2),
                        i < kPaperErrors.size() ? errors_in_words(kPaperErrors[i], 3) : "");
  }
  std::vector<std::string> means;
  std::vector<std::string> counts;
  for (const std::vector<Fix>& fixes : located) {
    const FixSummary summary = summarize(fixes, measurements);
    means.push_back(errors_in_words(summary.mean_error));
    counts.push_back(fmt::format("{} of {}", summary.located, summary.count));
  }
  text += fmt::format(kRow, "mean", "", "", means[0], means[1], means[2],
                      errors_in_words(kPaperMean, 3));
  return text + fmt::format(kRow, "", "", "located", counts[0], counts[1], counts[2],
                            fmt::format("{0} of {0}", kPaperErrors.size()));
}

// Why points have no position, with the numbers.
std::string reasons_of(const std::vector<Fix>& fixes) {
  std::string text;
  for (const Fix& fix : fixes) {
    if (!fix.reason.empty()) {
      text += fmt::format("  {} by {}: {}\n", fix.id, fix.method, fix.reason);
    }
  }
  return text;
}

void show_files(const Demo& demo) {
  const std::string corridor = demo.survey.file.parent_path().string();
  const std::string words = fmt::format(
      "\nFiles in {}:\n"
      "  print/           {} tags as PDF and SVG, true scale, manifest.json, and the\n"
      "                   installer's setting-out.csv and setting-out.pdf\n"
      "  prints.jsonl     what was read from the PDFs\n"
      "  photos.jsonl     what was read in the photos\n"
      "  positions.txt    the table above, and why points have no position\n"
      "Step by step, with your own files in place of these:\n"
      "  tagsmith validate {corridor}/survey.yaml\n"
      "  tagsmith print {corridor}/survey.yaml -o print\n"
      "  tagsmith verify {corridor}/survey.yaml print {corridor}/photos\n"
      "  tagsmith localize {corridor}/survey.yaml --rig {corridor}/rig.yaml --run "
      "{corridor}/run.csv\n",
      terminal_text(demo.folder.string()), demo.survey.tags.size(),
      fmt::arg("corridor", terminal_text(corridor)));
  to_stdout("{}", Lines{words});
}

Result<void> check_files(const Demo& demo) {
  CommandFiles files;
  files.reads(demo.survey);
  files.reads(demo.rig);
  files.reads(demo.run);
  for (const char* name : {kPrintLines, kPhotoLines, kPositions}) {
    files.writes(demo.folder / name, "--output");
  }
  return files.check();
}

Result<bool> run_steps(const Demo& demo) {
  if (auto usable = check_files(demo); !usable) return fail(usable);
  to_stdout("{:<10} {}: {} tags, no findings\n", "validate", demo.survey.file.string(),
            demo.survey.tags.size());
  const Result<std::vector<fs::path>> pdfs = print_tags(demo);
  if (!pdfs) return fail(pdfs);
  to_stdout("{:<10} {} tags as PDF and SVG\n", "print", pdfs->size());
  const Verified prints = verify_files(demo, *pdfs);
  const bool prints_are_well = show(demo, "prints", prints);
  const Verified photos = verify_files(demo, photos_of(demo.run.measurements));
  const bool photos_are_well = show(demo, "photos", photos);
  const LocatedPoints located = localize(demo);
  const std::string table = table_of(demo, located);
  to_stdout("{:<10} ten points by both methods, from the photos and the range d\n{}{}", "localize",
            Lines{table}, Lines{kAboutMethods});
  for (const Result<void>& saved :
       {save_lines(demo.folder / kPrintLines, demo, prints),
        save_lines(demo.folder / kPhotoLines, demo, photos),
        write_file(demo.folder / kPositions,
                   table + reasons_of(located[0]) + reasons_of(located[1]))}) {
    if (!saved) return fail(saved);
  }
  show_files(demo);
  return prints_are_well && photos_are_well;
}

Result<int> run(const fs::path& output, int jobs) {
  return load_demo(output, jobs).and_then(run_steps).map([](bool well) {
    return well ? kExitOk : kExitFindings;
  });
}

}  // namespace

Command demo_command() {
  struct Options {
    std::string output = "tagsmith-demo";
    int jobs = 0;
  };
  auto options = std::make_shared<Options>();
  return {
      .name = "demo",
      .summary =
          "The whole loop on the corridor of Xu et al. (2017): print, verify, read, localize",
      .options = {with_default(folder_option("-o,--output", &options->output,
                                             "Folder for the files; made if missing")),
                  jobs_option(options->jobs, "Files read at once")},
      .notes =
          "Exit: 0 all went well, 1 a print or a photo has a finding, 2 the files could not be "
          "made.\n\n"
          "Example:\n"
          "  tagsmith demo -o demo",
      .run = [options] { return run(options->output, options->jobs); },
  };
}

}  // namespace tagsmith::detail
