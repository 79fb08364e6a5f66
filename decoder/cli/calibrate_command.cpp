// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "decoder/calibrate/ray_sigma.hpp"
#include "decoder/cli/calibrate_mounting.hpp"
#include "decoder/cli/calibrate_result.hpp"
#include "decoder/cli/commands.hpp"
#include "decoder/cli/file_list.hpp"
#include "decoder/image/load.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/board_file.hpp"
#include "tagsmith/survey/edit_rig.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/write_calibration.hpp"

namespace tagsmith::detail {

// ---- JSON lines of a calibration from photos of boards (docs/formats.md).

namespace {

// The measurement is not known to more digits; null where it is not finite.
Json measured(double value) { return std::isfinite(value) ? Json(with_digits(value, 6)) : Json(); }

double sigma_of(const CameraCalibration& calibration, Eigen::Index i) {
  return std::sqrt(std::max(0.0, calibration.covariance(i, i)));
}

// --- photos ---

Json sighting_json(const BoardCalibration& result, const CalibratedSighting& sighting) {
  Json json{{"board", result.boards[sighting.board].name},
            {"used", sighting.used},
            {"tags_used", sighting.tags_used},
            {"tilt_deg", measured(degrees(sighting.tilt))},
            {"distance", measured(sighting.camera_from_board.translation.norm())},
            {"chi_square", measured(sighting.chi_square)},
            {"edge_px", measured(sighting.edge_px)}};
  if (sighting.own_camera.focal_sigma > 0) {
    json["focal_change"] = measured(sighting.own_camera.focal_change);
    json["focal_sigma"] = measured(sighting.own_camera.focal_sigma);
  }
  return json;
}

Json photo_json(const BoardCalibration& result, std::size_t place, const PhotoUse& use) {
  const BoardView& view = result.views[place];
  Json json{{"file", view.file},      {"width", view.width},        {"height", view.height},
            {"tags", use.tags},       {"tags_used", use.tags_used}, {"used", use.is_used()},
            {"boards", Json::array()}};
  if (!view.objection.empty()) json["objection"] = view.objection;
  for (const CalibratedSighting& sighting : result.calibration.sightings) {
    if (sighting.view == place) json["boards"].push_back(sighting_json(result, sighting));
  }
  return json;
}

// --- summary ---

Json camera_json(const Camera& camera) {
  const std::size_t count = coefficient_names(camera.lens).size();
  return {{"width", camera.width},
          {"height", camera.height},
          {"lens", camera.lens == LensModel::fisheye ? "fisheye" : "perspective"},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"distortion", std::vector(camera.distortion.begin(),
                                     camera.distortion.begin() + static_cast<long>(count))}};
}

Json sigma_json(const CameraCalibration& calibration) {
  Json distortion = Json::array();
  const auto count = static_cast<Eigen::Index>(coefficient_names(calibration.camera.lens).size());
  for (Eigen::Index i = 0; i < count; ++i) {
    distortion.push_back(measured(sigma_of(calibration, 4 + i)));
  }
  return {{"fx", measured(sigma_of(calibration, 0))},
          {"fy", measured(sigma_of(calibration, 1))},
          {"cx", measured(sigma_of(calibration, 2))},
          {"cy", measured(sigma_of(calibration, 3))},
          {"distortion", distortion}};
}

// Lower half, row by row, of fx, fy, cx, cy and the lens's coefficients.
Json covariance_json(const CameraCalibration& calibration) {
  const auto count =
      static_cast<Eigen::Index>(4 + coefficient_names(calibration.camera.lens).size());
  Json numbers = Json::array();
  for (Eigen::Index row = 0; row < count; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      numbers.push_back(calibration.covariance(row, column));
    }
  }
  return numbers;
}

Json forms_json(const CameraCalibration& calibration) {
  return json_list(calibration.tried, [](const TriedForm& tried) -> Json {
    return {{"form", to_string(tried.form)},
            {"parameters", tried.form.parameters()},
            {"chi_square", measured(tried.chi_square)},
            {"bic", measured(tried.bic)},
            {"weight", measured(tried.weight)}};
  });
}

Json cells_json(const RayGrid& grid) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const RayGrid::Cell& cell = grid.cells[i];
    cells.push_back({{"place", cell_name(i)},
                     {"corners", cell.corners},
                     {"ray_sigma_px", cell.has_ray ? measured(cell.worst_sigma_px) : Json()}});
  }
  return cells;
}

Json boards_json(const BoardCalibration& result) {
  Json boards = Json::array();
  for (std::size_t i = 0; i < result.boards.size(); ++i) {
    const CalibratedBoard& board = result.calibration.boards[i];
    Eigen::Index worst = 0;
    board.shape.bow.cwiseAbs().maxCoeff(&worst);
    boards.push_back({{"name", result.boards[i].name},
                      {"serial", result.boards[i].serial},
                      {"stretch", measured(board.shape.stretch)},
                      {"stretch_sigma", measured(board.sigma.stretch)},
                      {"bow", measured(board.shape.bow[worst])},
                      {"bow_sigma", measured(board.sigma.bow[worst])},
                      {"ink_growth", measured(board.shape.growth)},
                      {"ink_growth_sigma", measured(board.sigma.growth)}});
  }
  return boards;
}

Json findings_json(const BoardCalibration& result) {
  return json_list(result.assessment.findings, [&](const CalibrationFinding& finding) {
    Json json{{"rule", to_string(finding.issue)},
              {"severity", severity_of(finding)},
              {"measured", measured(finding.measured)},
              {"limit", measured(finding.limit)}};
    if (finding.view) json["file"] = result.views[*finding.view].file;
    if (finding.board) json["board"] = result.boards[*finding.board].name;
    if (!finding.cells.empty()) json["cells"] = Json::array();
    for (const std::size_t cell : finding.cells) json["cells"].push_back(cell_name(cell));
    json["message"] = finding.message;
    json["remedy"] = finding.remedy;
    return json;
  });
}

// A line a photo, each with its line end.
std::string calibration_photo_lines(const BoardCalibration& result) {
  const std::vector<PhotoUse> uses = photo_uses(result);
  std::string lines;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    lines += json_text(photo_json(result, i, uses[i])) + "\n";
  }
  return lines;
}

// Without its line end; `written` are the files that were.
std::string calibration_summary_line(const BoardCalibration& result,
                                     const std::vector<std::string>& written) {
  const CameraCalibration& calibration = result.calibration;
  const IntrinsicsSigma sigma = rig_sigma(calibration);
  Json json{{"verdict", to_string(result.assessment.trust)},
            {"photos", result.views.size()},
            {"photos_used", std::ranges::count_if(photo_uses(result), &PhotoUse::is_used)},
            {"form", to_string(calibration.form)},
            {"camera", camera_json(calibration.camera)},
            {"sigma", sigma_json(calibration)},
            {"covariance", covariance_json(calibration)},
            {"rig_sigma", {{"focal", measured(sigma.focal)}, {"center", measured(sigma.center)}}},
            {"ray_sigma_px", measured(result.assessment.grid.worst_sigma_px())},
            {"cells", cells_json(result.assessment.grid)},
            {"rms_px", measured(residual_rms_px(calibration))},
            {"edge_px", measured(calibration.edge_px)},
            {"chi_square", measured(calibration.chi_square)},
            {"degrees_of_freedom", calibration.degrees_of_freedom},
            {"sigma_factor", measured(calibration.sigma_factor)},
            {"forms", forms_json(calibration)},
            {"boards", boards_json(result)},
            {"findings", findings_json(result)},
            {"files", written}};
  return json_text({{"summary", json}});
}

// ---- From photos of boards: a camera's intrinsics.

struct BoardCalibrationOptions {
  std::vector<std::string> photos;
  std::vector<std::string> boards;
  std::string output;             // empty = none
  std::string format = "opencv";  // of the output
  std::string html;
  std::string drawing;
  std::string rig;     // the rig that the camera is entered in; empty = none
  std::string camera;  // empty = "camera"
  bool json = false;
  int jobs = 0;
};

namespace fs = std::filesystem;

std::string camera_name(const BoardCalibrationOptions& options) {
  return options.camera.empty() ? "camera" : options.camera;
}

CalibrationFormat format_of(const BoardCalibrationOptions& options) {
  if (options.format == "ros") return CalibrationFormat::ros;
  return options.format == "kalibr" ? CalibrationFormat::kalibr : CalibrationFormat::opencv;
}

// --- before the work ---

// Names of cameras as rigs allow them; other programs' files hold them without quotes.
Result<void> check_name(const std::string& name) {
  const auto is_part = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  const bool begins = std::isalpha(static_cast<unsigned char>(name.front())) != 0;
  if (begins && std::ranges::all_of(name, is_part)) return {};
  return fail("--camera " + name + ": expected a letter and then letters, digits, - or _");
}

Result<std::vector<Board>> load_boards(const BoardCalibrationOptions& options) {
  std::vector<Board> boards;
  for (const std::string& file : options.boards) {
    Result<Board> board = load_board(file);
    if (!board) return fail(board);
    boards.push_back(std::move(*board));
  }
  if (auto checked = check_boards(boards); !checked) return fail(checked);
  return boards;
}

Result<void> check_files(const BoardCalibrationOptions& options,
                         const std::vector<fs::path>& photos) {
  CommandFiles files;
  for (const std::string& board : options.boards) files.reads(board, "the board");
  for (const fs::path& photo : photos) files.reads(photo, "the photo");
  files.writes(options.output, "--output");
  files.writes(options.html, "--html");
  files.writes(options.drawing, "--drawing");
  files.writes(options.rig, "--rig");
  return files.check();
}

// The path of the camera's file in the rig: relative to the rig's folder.
CalibratedIntrinsics intrinsics_of(const BoardCalibrationOptions& options,
                                   const IntrinsicsSigma& sigma) {
  const fs::path folder = fs::path(options.rig).parent_path();
  std::error_code error;
  const fs::path file = fs::proximate(options.output, folder.empty() ? "." : folder, error);
  return {error || options.rig.empty() ? options.output : file.generic_string(), sigma.focal,
          sigma.center};
}

// A rig without the camera is reported before the photos are read.
Result<void> check_rig(const BoardCalibrationOptions& options) {
  if (options.rig.empty()) return {};
  const Result<std::string> text = read_file(options.rig);
  if (!text) return fail(text);
  const auto edited = rig_with_calibration(*text, options.camera, intrinsics_of(options, {1, 1}));
  return edited ? Result<void>{} : fail(options.rig + ": " + edited.error().message);
}

Result<void> check_options(const BoardCalibrationOptions& options) {
  if (options.photos.empty() || options.boards.empty()) {
    return fail(
        "PHOTO and --board are required: photos of a board and its file; or, for where "
        "cameras look, --survey, --rig and --run");
  }
  if (!options.rig.empty() && (options.output.empty() || options.camera.empty())) {
    return fail("--rig takes the camera's file over: --output and --camera are required with it");
  }
  if (auto named = check_name(camera_name(options)); !named) return named;
  if (!options.drawing.empty() && !sheet_format_of(options.drawing)) {
    return fail("--drawing " + options.drawing +
                ": expected a name that ends in .pdf, .svg or .png");
  }
  return check_rig(options);
}

// --- photos ---

// Loads photos and keeps the errors; several threads call it at once.
class Loader {
 public:
  explicit Loader(std::vector<fs::path> files) : files_(std::move(files)) {}

  Result<GrayImage> operator()(std::size_t i) {
    Result<DecodedImage> image = load_image(files_[i]);
    const std::lock_guard lock(mutex_);
    if (!image) {
      broken_[i] = image.error().message;
      return fail(image);
    }
    sizes_.insert({image->image.width, image->image.height});
    if (!image->warning.empty()) damaged_[i] = damaged_in_words(image->warning);
    return std::move(image->image);
  }

  // What is wrong with the photos themselves, whatever they show; empty = nothing.
  std::vector<std::string> broken() const {
    std::vector<std::string> all;
    for (const auto& [i, words] : broken_) all.push_back(words);
    return all;
  }
  bool has_several_sizes() const { return sizes_.size() > 1; }

  void report_damaged() const {
    for (const auto& [i, words] : damaged_) {
      to_stderr("tagsmith calibrate: {}: {}\n", files_[i].string(), words);
    }
  }

 private:
  std::vector<fs::path> files_;
  std::mutex mutex_;
  std::map<std::size_t, std::string> broken_;
  std::map<std::size_t, std::string> damaged_;
  std::set<std::pair<int, int>> sizes_;
};

struct CalibrationOutcome {
  std::optional<BoardCalibration> result;
  std::string reason{};  // without a result: why photos that can be read give no camera
};

Result<CalibrationOutcome> calibrate(const BoardCalibrationOptions& options,
                                     std::vector<Board> boards,
                                     const std::vector<fs::path>& files) {
  Loader loader(files);
  PhotoSource photos{{}, [&](std::size_t i) { return loader(i); }};
  for (const fs::path& file : files) photos.files.push_back(file.string());
  ProgressBar bar("readings of photos", 2 * files.size());
  const PhotoCalibrationOptions how{options.jobs,
                                    [&](std::size_t, std::size_t) { bar.advance([] {}); }};
  Result<PhotoCalibration> found = calibrate_photos(photos, boards, how);
  loader.report_damaged();
  if (const auto broken = loader.broken(); !broken.empty()) {
    return fail(fmt::format("{}", fmt::join(broken, "\n")));
  }
  if (!found && loader.has_several_sizes()) return fail(found);
  if (!found) return CalibrationOutcome{std::nullopt, found.error().message};
  BoardCalibration result{camera_name(options),
                          std::move(boards),
                          std::move(found->calibration),
                          std::move(found->views),
                          {}};
  result.assessment = assess_calibration(result.calibration, result.views, result.boards);
  return CalibrationOutcome{std::move(result)};
}

// --- files ---

CalibrationNotes notes_of(const BoardCalibration& result) {
  CalibrationNotes notes{result.camera_name, {}, residual_rms_px(result.calibration)};
  notes.comments.emplace_back("By tagsmith " TAGSMITH_VERSION ", from photos of " +
                              std::string(result.boards.size() == 1 ? "the board" : "the boards"));
  for (const Board& board : result.boards) notes.comments.back() += " " + board.name;
  notes.comments.push_back("verdict: " + verdict_words(result.assessment.trust));
  for (const std::string& fact : calibration_facts(result)) notes.comments.push_back(fact);
  for (const CameraNumber& number : camera_numbers(result.calibration)) {
    notes.comments.push_back(fmt::format("sigma of {}: {:.3g}{}{}", number.name, number.sigma,
                                         number.unit.empty() ? "" : " ", number.unit));
  }
  return notes;
}

// Errors that a change caused. Other cameras of a rig may not have their calibrations yet.
std::vector<Diagnostic> added_errors(const std::vector<Diagnostic>& now,
                                     const std::vector<Diagnostic>& before) {
  std::vector<Diagnostic> added;
  std::ranges::copy_if(now, std::back_inserter(added), [&](const Diagnostic& one) {
    return one.severity == Severity::error &&
           std::ranges::find(before, one.message, &Diagnostic::message) == before.end();
  });
  return added;
}

// The rig's new text. It must not have errors that it did not have before, with the camera's file,
// which is not in its place yet: it is checked with the staged file.
Result<std::string> rig_text(const BoardCalibrationOptions& options, const BoardCalibration& result,
                             const std::string& camera_file) {
  Result<std::string> text = read_file(options.rig);
  if (!text) return text;
  const CalibratedIntrinsics intrinsics = intrinsics_of(options, rig_sigma(result.calibration));
  const fs::path target = fs::absolute(options.output);
  const Result<StagedFiles> waiting = StagedFiles::begin(target.parent_path());
  if (!waiting) return fail(waiting);
  if (auto added = waiting->add(target.filename(), camera_file); !added) {
    return fail(added);
  }
  CalibratedIntrinsics staged = intrinsics;
  staged.file = waiting->staged(target.filename()).string();
  const auto trial = rig_with_calibration(*text, options.camera, staged);
  if (!trial) return fail(options.rig + ": " + trial.error().message);
  const Diagnosed<Rig> reading = read_rig_text(options.rig, *trial);
  const std::vector<Diagnostic> added =
      added_errors(reading.diagnostics, read_rig_text(options.rig, *text).diagnostics);
  if (!added.empty()) {
    return fail("the rig cannot take this camera, and nothing was written:\n" +
                to_string(added, true));
  }
  if (!reading.value) {
    to_stderr("tagsmith calibrate: the rig takes this camera; what it still lacks:\n{}",
              to_string(reading.diagnostics, true));
  }
  return rig_with_calibration(*text, options.camera, intrinsics);
}

// The camera's file and the rig that uses it; none for a camera that is refused.
Result<std::vector<SheetFile>> camera_files(const BoardCalibrationOptions& options,
                                            const BoardCalibration& result) {
  std::vector<SheetFile> files;
  if (options.output.empty() || result.assessment.trust == CalibrationTrust::refused) return files;
  Result<std::string> text =
      calibration_text(format_of(options), result.calibration.camera, notes_of(result));
  if (!text) return fail("--format " + options.format + ": " + text.error().message);
  files.push_back({options.output, std::move(*text)});
  if (options.rig.empty()) return files;
  Result<std::string> rig = rig_text(options, result, files.front().bytes);
  if (!rig) return fail(rig);
  files.push_back({options.rig, std::move(*rig)});
  return files;
}

Result<std::vector<SheetFile>> all_files(const BoardCalibrationOptions& options,
                                         const BoardCalibration& result) {
  Result<std::vector<SheetFile>> files = camera_files(options, result);
  if (!files) return files;
  if (!options.html.empty()) files->push_back({options.html, calibration_page(result)});
  if (options.drawing.empty()) return files;
  const Result<std::vector<Sheet>> sheets = draw_calibration(result);
  if (!sheets) return fail(sheets);
  Result<std::vector<SheetFile>> drawn = render_sheets(*sheets, options.drawing);
  if (!drawn) return drawn;
  files->insert(files->end(), drawn->begin(), drawn->end());
  return files;
}

// --- words ---

std::string named_photos(const BoardCalibration& result, const std::vector<std::size_t>& places) {
  std::vector<std::string> names;
  for (const std::size_t place : places) names.push_back(result.views[place].file);
  return fmt::format("{}", fmt::join(names, ", "));
}

void print_numbers(const CameraCalibration& calibration) {
  for (const CameraNumber& number : camera_numbers(calibration)) {
    to_stdout("  {:3} {:>12}  sigma {}\n", number.name, number.in_words(number.value),
              number.in_words(number.sigma));
  }
}

void print_findings(const BoardCalibration& result) {
  for (const CalibrationFinding& finding : result.assessment.findings) {
    to_stdout("{}: {}\n  {}\n", severity_of(finding), finding.message, finding.remedy);
  }
}

void print_rig_lines(const BoardCalibrationOptions& options, const BoardCalibration& result) {
  const bool is_written =
      !options.output.empty() && result.assessment.trust != CalibrationTrust::refused;
  if (!is_written || !options.rig.empty()) return;
  const CalibratedIntrinsics intrinsics = intrinsics_of(options, rig_sigma(result.calibration));
  to_stdout("for the rig's camera:\n  calibration: {}\n  sigma: {{ focal: {}, center: {} }}\n",
            calibration_value(intrinsics), focal_value(intrinsics), center_value(intrinsics));
}

void print_in_words(const BoardCalibrationOptions& options, const BoardCalibration& result) {
  for (const std::string& fact : calibration_facts(result)) to_stdout("{}\n", fact);
  print_numbers(result.calibration);
  if (const auto out = photos_left_out(result); !out.empty()) {
    to_stdout("left out: {}\n", named_photos(result, out));
  }
  for (const BoardView& view : result.views) {
    if (!view.objection.empty()) to_stdout("left out: {}: {}\n", view.file, view.objection);
  }
  if (const auto empty = photos_without_tags(result); !empty.empty()) {
    to_stdout("no tag of a board: {}\n", named_photos(result, empty));
  }
  print_findings(result);
  print_rig_lines(options, result);
  to_stdout("verdict: {}\n", verdict_words(result.assessment.trust));
}

int report_no_camera(const BoardCalibrationOptions& options, std::size_t photos,
                     const std::string& reason) {
  if (options.json) {
    const Json summary{{"verdict", "refused"}, {"photos", photos}, {"reason", reason}};
    to_stdout("{}\n", json_text({{"summary", summary}}));
  } else {
    to_stdout("verdict: refused\n");
  }
  to_stderr("tagsmith calibrate: {}\n", reason);
  return kExitFindings;
}

Result<int> report(const BoardCalibrationOptions& options, const BoardCalibration& result) {
  const Result<std::vector<SheetFile>> files = all_files(options, result);
  if (!files) return fail(files);
  if (auto written = publish_files(*files); !written) return fail(written);
  std::vector<std::string> names;
  for (const SheetFile& file : *files) names.push_back(file.path.string());
  if (options.json) {
    to_stdout("{}", Lines{calibration_photo_lines(result)});
    to_stdout("{}\n", calibration_summary_line(result, names));
  } else {
    print_in_words(options, result);
  }
  if (!names.empty()) to_stderr("written: {}\n", fmt::join(names, ", "));
  const CalibrationTrust trust = result.assessment.trust;
  if (trust == CalibrationTrust::refused && !options.output.empty()) {
    to_stderr("tagsmith calibrate: {} was not written: the calibration is refused\n",
              options.output);
  }
  return trust == CalibrationTrust::good ? kExitOk : kExitFindings;
}

// Reads, fits, prints and writes; the exit code. Fails on wrong use and on input that cannot be
// read.
Result<int> calibrate_by_boards(const BoardCalibrationOptions& options) {
  if (auto right = check_options(options); !right) return fail(right);
  Result<std::vector<Board>> boards = load_boards(options);
  if (!boards) return fail(boards);
  const Result<FileList> list = list_files(options.photos, image_extensions(), std::cin);
  if (!list) return fail(list);
  if (auto usable = check_files(options, list->files); !usable) return fail(usable);
  const Result<CalibrationOutcome> outcome = calibrate(options, std::move(*boards), list->files);
  if (!outcome) return fail(outcome);
  if (!list->skipped.empty()) {
    to_stderr("tagsmith calibrate: skipped, no pictures: {}\n", skipped_in_words(list->skipped));
  }
  if (!outcome->result) return report_no_camera(options, list->files.size(), outcome->reason);
  return report(options, *outcome->result);
}

// ---- The command.

constexpr const char* kCalibrateNotes =
    R"(From photos of boards: the lens. Needs no guess of it: perspective cameras and fisheyes are tried, and the simplest form that explains the corners is chosen. Every number comes with its standard deviation, and whatever the photos lack is named with what to do about it.

From a drive past surveyed tags (--survey, --rig, --run): where a rig's cameras stand and look.

Example:
  tagsmith board -o board.pdf
  tagsmith calibrate --board board.yaml photos -o left.yaml --html left.html
  tagsmith calibrate --board board.yaml photos -o left.yaml --rig rig.yaml --camera left
  tagsmith calibrate --survey survey.yaml --rig rig.yaml --run run.csv -o rig-mounted.yaml

Exit: 0 the calibration is good, 1 it is weak, or refused and nothing is written for the rig, 2 wrong use or a file that cannot be read.)";

struct CalibrateOptions {
  BoardCalibrationOptions board;  // with the options that both kinds share
  std::string survey;
  std::string run;
};

std::vector<CommandOption> board_options(BoardCalibrationOptions& options) {
  return {
      argument("PHOTO", &options.photos, ValueKind::picture,
               "Photos of boards by one camera, folders of them, or - for a list of files on "
               "standard input"),
      value_option("--board", &options.boards, "BOARD.yaml",
                   "A board's file, as `tagsmith board` wrote it and you completed it; several "
                   "boards must differ in their serials",
                   ValueKind::file),
      with_default(choice_option(
          "--format", &options.format, {"opencv", "ros", "kalibr"},
          "Of the camera's file: opencv (FileStorage), ros (camera_info) or kalibr (camchain)")),
      value_option(
          "--camera", &options.camera, "NAME",
          "The camera's name, in the rig and in files of ros and kalibr (default: camera)"),
      file_option("--html", &options.html,
                  "A page: verdict, coverage, residuals, distortion, photos"),
      file_option("--drawing", &options.drawing,
                  "The same pictures as a sheet: FILE.pdf, FILE.svg or FILE.png")};
}

std::vector<CommandOption> calibrate_options(CalibrateOptions& options) {
  const std::vector<std::string> of_boards{"--board", "--format", "--camera", "--html",
                                           "--drawing"};
  return joined(
      {board_options(options.board),
       {excluding(of_boards,
                  needing({"--rig", "--run"}, value_option("--survey", &options.survey, "SURVEY",
                                                           "The survey whose tags the drive passes",
                                                           ValueKind::survey))),
        needing({"--survey"},
                value_option("--run", &options.run, "RUN.csv",
                             "The drive: pictures and ranges, row by row", ValueKind::table)),
        rig_option(
            &options.board.rig,
            "With photos: takes the camera's file and its sigmas over, comments kept. With a "
            "drive: the cameras as they are known"),
        file_option(
            "-o,--output", &options.board.output,
            "With photos: the camera's file. With a drive: the rig with its cameras' mounting"),
        json_flag(options.board.json, "One JSON object a photo or camera, then the summary"),
        jobs_option(options.board.jobs, "Photos read at once")}});
}

Result<int> run(const CalibrateOptions& options) {
  const BoardCalibrationOptions& board = options.board;
  if (options.survey.empty()) return calibrate_by_boards(board);
  if (!board.photos.empty()) return fail("PHOTO is of boards, and --survey of a drive: give one");
  return calibrate_mounting(
      {options.survey, board.rig, options.run, board.output, board.json, board.jobs});
}

}  // namespace

Command calibrate_command() {
  const auto options = std::make_shared<CalibrateOptions>();
  return {
      .name = "calibrate",
      .summary = "A camera's lens from photos of boards, or a rig's mounting from a drive",
      .options = calibrate_options(*options),
      .notes = kCalibrateNotes,
      .run = [options] { return run(*options); },
  };
}

}  // namespace tagsmith::detail
