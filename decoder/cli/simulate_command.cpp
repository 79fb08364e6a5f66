// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <system_error>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "decoder/cli/commands.hpp"
#include "decoder/image/load.hpp"
#include "decoder/simulate/noise.hpp"
#include "decoder/simulate/sensor.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTruth = "truth.json";
constexpr const char* kRun = "run.csv";
constexpr int kUsualQuality = 95;

struct SimulateOptions {
  fs::path survey;
  fs::path rig;
  fs::path run;
  fs::path folder;
  double blur_px = 0.7;
  double noise = 1.5;
  bool linear = false;
  std::uint64_t seed = 0;
  int jobs = 0;  // 0 = as many as the process may use
  std::string format = "png";
  int quality = 0;  // of JPEG files; 0 = kUsualQuality
  std::string chain = "none";
  double rolling_px = 0;
  bool force = false;
  bool json = false;
};

// One measurement of the run, with what was simulated for it.
struct Station {
  const Measurement* measurement = nullptr;
  Pose world_from_vehicle;
  std::map<std::string, double> ranges;
};

// One image to make.
struct Shot {
  const Station* station = nullptr;
  const RigCamera* camera = nullptr;
  std::string file;
};

std::string image_name(const std::string& id, const std::string& camera,
                       const std::string& format) {
  return id + "_" + camera + "." + format;
}

// --- checks ---

Result<void> check_image_sizes(const Rig& rig) {
  constexpr double kMostPixels = 50e6;  // 13 bytes a pixel while an image is made
  for (const RigCamera& camera : rig.cameras) {
    const double pixels = static_cast<double>(camera.camera.width) * camera.camera.height;
    if (pixels <= kMostPixels) continue;
    return fail(rig.file.string() + ": camera " + camera.name + " has " +
                format_number(pixels / 1e6, 0) + " million pixels, expected at most 50 million");
  }
  return {};
}

bool fits_file_name(const std::string& text) {
  constexpr std::size_t kLongest = 100;
  return text.size() <= kLongest && text.find_first_of("/\\,\"") == std::string::npos &&
         !text.starts_with('.');
}

// Each image has its own file name, which cannot leave the folder.
Result<void> check_file_names(const SurveyedRun& input, const std::string& format) {
  std::set<std::string> names;
  for (const Measurement& measurement : input.run.measurements) {
    const std::string place = fmt::format("{}:{}: ", input.run.file.string(), measurement.line);
    for (const RigCamera& camera : input.rig.cameras) {
      if (!fits_file_name(measurement.id) || !fits_file_name(camera.name)) {
        return fail(place + "the id `" + measurement.id + "` with camera `" + camera.name +
                    "` makes no file name, expected at most 100 characters without / \\ , \" and "
                    "no leading point");
      }
      const std::string name = image_name(measurement.id, camera.name, format);
      if (!names.insert(name).second) {
        return fail(fmt::format("{}a second image would be called {}, expected ids that differ",
                                place, name));
      }
    }
  }
  return {};
}

Result<void> check_folder(const SimulateOptions& options) {
  std::error_code error;
  if (options.force || !fs::exists(options.folder, error)) return {};
  if (!fs::is_directory(options.folder, error)) {
    return fail(options.folder.string() + ": is a file, expected a folder or nothing");
  }
  if (fs::is_empty(options.folder, error) || error) return {};
  return fail(options.folder.string() +
              ": the folder is not empty; --force replaces files of the same names in it");
}

Result<Station> station_of(const SurveyedRun& input, const Measurement& measurement,
                           std::uint64_t seed) {
  const std::string place = fmt::format("{}:{}: ", input.run.file.string(), measurement.line);
  if (!measurement.truth_in_grid) {
    return fail(place + "no true position, expected truth_x, truth_y and truth_z in each row");
  }
  Station station{
      &measurement,
      vehicle_in_tunnel(input.survey, *measurement.truth_in_grid, measurement.truth_heading),
      {}};
  const Eigen::Vector3d& position = station.world_from_vehicle.translation;
  if (const auto inside = check_in_tunnel(input.survey.tunnel, position); !inside) {
    return fail(place + "the true position is " + inside.error().message);
  }
  for (const RigCamera& camera : input.rig.cameras) {
    const Pose world_from_camera = station.world_from_vehicle * camera.vehicle_from_camera;
    const auto inside = check_in_tunnel(input.survey.tunnel, world_from_camera.translation);
    if (!inside) return fail(place + "camera " + camera.name + " is " + inside.error().message);
  }
  for (const RigRange& range : input.rig.ranges) {
    const auto value = measured_range(input.survey, range, position, random_bits(seed, 0));
    if (value) station.ranges.emplace(range.name, *value);
    ++seed;
  }
  return station;
}

Result<std::vector<Station>> stations_of(const SurveyedRun& input, std::uint64_t seed) {
  std::vector<Station> stations;
  for (const Measurement& measurement : input.run.measurements) {
    const auto row = static_cast<std::uint64_t>(measurement.line);
    auto station = station_of(input, measurement, random_bits(seed, row));
    if (!station) return fail(station);
    stations.push_back(std::move(*station));
  }
  return stations;
}

// --- truth.json ---

Json corner_json(const std::optional<Eigen::Vector2d>& corner) {
  return corner ? number_list(*corner) : Json();
}

Json plate_json(const Survey& survey, const PlacedTag& tag, const PlateTruth& truth) {
  const auto corner_in_grid = [&](double x, double y) {
    return number_list(
        grid_from_world(survey.grid, tag.world_from_plate * Eigen::Vector3d(x, y, 0)));
  };
  const double right = survey.tag_template.frame_inner_length;
  const double bottom = survey.tag_template.frame_inner_height;
  return {{"tag", tag.name},
          {"code", to_string(tag.digits)},
          {"corners_px",
           {{"P", corner_json(truth.corners[0])},
            {"F", corner_json(truth.corners[1])},
            {"R", corner_json(truth.corners[2])},
            {"Q", corner_json(truth.corners[3])}}},
          {"corners_grid",
           {{"P", corner_in_grid(0, 0)},
            {"F", corner_in_grid(right, 0)},
            {"R", corner_in_grid(right, bottom)},
            {"Q", corner_in_grid(0, bottom)}}},
          {"px_per_module", truth.module_px},
          {"incidence_deg", degrees(truth.incidence)},
          {"fraction_visible", truth.visible_fraction}};
}

// As OpenCV counts them: four of a fisheye, else five, or eight when the denominator is not 1.
Json distortion_json(const Camera& camera) {
  const std::array<double, 8>& k = camera.distortion;
  const bool rational = k[5] != 0 || k[6] != 0 || k[7] != 0;
  const std::size_t count = camera.lens == LensModel::fisheye ? 4 : rational ? 8 : 5;
  return number_list(std::span(k).first(count));
}

// x_camera = R x_grid + t.
Json camera_json(const Grid& grid, const Camera& camera, const Pose& world_from_camera) {
  const Pose camera_from_world = inverse(world_from_camera);
  const auto rotation_row = [&](int row) {
    const Eigen::Vector3d in_world = camera_from_world.rotation.row(row).transpose();
    return number_list(grid_from_world(grid, in_world));
  };
  return {{"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"model", camera.lens == LensModel::fisheye ? "fisheye" : "perspective"},
          {"distortion", distortion_json(camera)},
          {"R", json_list(std::array{0, 1, 2}, rotation_row)},
          {"t", number_list(camera_from_world.translation)},
          {"position_grid", number_list(grid_from_world(grid, world_from_camera.translation))}};
}

Json shot_json(const Survey& survey, const Shot& shot, const SurveyView& seen) {
  const Pose& world_from_vehicle = shot.station->world_from_vehicle;
  const Eigen::Vector3d& position = *shot.station->measurement->truth_in_grid;
  const Eigen::Vector3d forward = world_from_vehicle.rotation.col(0);
  Json plates = Json::array();
  for (std::size_t i = 0; i < seen.tags.size(); ++i) {
    plates.push_back(plate_json(survey, survey.tags[seen.tags[i]], seen.view.plates[i]));
  }
  return {{"file", shot.file},
          {"id", shot.station->measurement->id},
          {"camera_name", shot.camera->name},
          {"image_size", {shot.camera->camera.width, shot.camera->camera.height}},
          {"vehicle",
           {{"O_grid", number_list(position)},
            {"heading_grid", number_list(grid_from_world(survey.grid, forward))}}},
          {"camera", camera_json(survey.grid, shot.camera->camera,
                                 world_from_vehicle * shot.camera->vehicle_from_camera)},
          {"plates", plates}};
}

std::string truth_text(const Survey& survey, Json images) {
  const Json truth{
      {"set", "simulated"},
      {"survey", survey.name},
      {"check", to_string(survey.code.check)},
      {"conventions",
       "x_camera = R x_grid + t (x right, y down, z forward); pixel (0, 0) is the centre of the "
       "upper left pixel; corners P, F, R, Q = upper left, upper right, lower right, lower left "
       "inner corner of the feature frame seen facing the plate, null where it has no pixel; "
       "metres, degrees"},
      {"grid_x_axis", survey.grid.x_axis_left ? "left" : "right"},
      {"images", std::move(images)}};
  // Names come from files and may not be UTF-8.
  return json_text(truth, 1) + "\n";
}

// --- run.csv ---

std::string run_text(const SurveyedRun& input, const std::vector<Station>& stations,
                     const std::string& format) {
  std::string text = "id";
  for (const RigCamera& camera : input.rig.cameras) text += "," + csv_field(camera.name);
  for (const RigRange& range : input.rig.ranges) text += "," + csv_field(range.name);
  text += ",truth_x,truth_y,truth_z,truth_heading,time\n";
  for (const Station& station : stations) {
    const Measurement& measurement = *station.measurement;
    const Eigen::Vector3d forward = station.world_from_vehicle.rotation.col(0);
    const double heading =
        grid_heading_from_world(input.survey.grid, std::atan2(forward.x(), forward.y()));
    text += csv_field(measurement.id);
    for (const RigCamera& camera : input.rig.cameras) {
      text += "," + csv_field(image_name(measurement.id, camera.name, format));
    }
    for (const RigRange& range : input.rig.ranges) {
      const auto value = station.ranges.find(range.name);
      text += "," + (value == station.ranges.end() ? "" : format_number(value->second, 4));
    }
    for (const double value : *measurement.truth_in_grid) text += "," + format_number(value);
    text += "," + format_number(degrees(heading), 6) + ",";
    if (measurement.time) text += format_number(*measurement.time);
    text += "\n";
  }
  return text;
}

// --- the work ---

std::vector<Shot> shots_of(const SurveyedRun& input, const std::vector<Station>& stations,
                           const std::string& format) {
  std::vector<Shot> shots;
  for (const Station& station : stations) {
    for (const RigCamera& camera : input.rig.cameras) {
      shots.push_back(
          {&station, &camera, image_name(station.measurement->id, camera.name, format)});
    }
  }
  return shots;
}

std::optional<CameraChain> chain_of(const SimulateOptions& options) {
  if (options.chain == "none") return std::nullopt;
  CameraChain chain = camera_chain(options.chain);
  chain.rolling_px = options.rolling_px;
  return chain;
}

ViewOptions view_options(const SimulateOptions& options, std::uint64_t shot) {
  ViewOptions view;
  view.lighting = tunnel_lighting();
  view.sensor.blur_sigma_px = options.blur_px;
  view.sensor.noise_sigma = options.noise;
  view.sensor.tone = options.linear ? SensorTone::linear : SensorTone::srgb;
  view.seed = random_bits(options.seed + 1, shot);
  if (const auto chain = chain_of(options)) view.sensor = through_chain(view.sensor, *chain);
  return view;
}

// The bytes of a picture's file. Where a chain makes the picture, its compression is the only one.
Result<std::string> encoded(const SimulateOptions& options, const std::string& file,
                            const GrayImage& image) {
  const auto chain = chain_of(options);
  if (!chain) {
    const int quality = options.quality > 0 ? options.quality : kUsualQuality;
    return encode_gray_image(file, image.view(), quality);
  }
  if (options.format == "jpg") return encode_gray_image(file, image.view(), chain->jpeg_quality);
  const Result<GrayImage> stored = compressed(image.view(), chain->jpeg_quality);
  if (!stored) return fail(stored);
  return encode_gray_image(file, stored->view());
}

void print_line(const Json& line) { to_stdout("{}\n", json_text(line)); }

void print_json(const Json& truths, const fs::path& folder) {
  for (const Json& shot : truths) {
    Json tags = json_list(shot["plates"], [](const Json& plate) { return plate["tag"]; });
    print_line({{"file", shot["file"]},
                {"id", shot["id"]},
                {"camera", shot["camera_name"]},
                {"tags", std::move(tags)}});
  }
  print_line({{"summary", {{"images", truths.size()}, {"folder", folder.string()}}}});
}

// Renders every shot into the staged folder; the truth of each, or the first failure.
Result<Json> render_shots(const SimulateOptions& options, const SurveyedRun& input,
                          const std::vector<Shot>& shots, const StagedFiles& files) {
  Json truths = Json::array();
  std::optional<Error> failure;
  const auto render = [&](std::size_t i) -> Result<Json> {
    const Shot& shot = shots[i];
    const SurveyView seen =
        render_survey_view(input.survey, *shot.camera, shot.station->world_from_vehicle,
                           view_options(options, i), options.seed);
    const auto bytes = encoded(options, shot.file, seen.view.image);
    if (!bytes) return fail(bytes);
    if (auto added = files.add(shot.file, *bytes); !added) return fail(added);
    return shot_json(input.survey, shot, seen);
  };
  const auto take = [&](std::size_t, Result<Json>& truth) {
    if (truth) truths.push_back(std::move(*truth));
    if (!truth && !failure) failure = truth.error();
  };
  run_below_bar("images", shots.size(), options.jobs, render, take);
  if (failure) return tl::unexpected(*failure);
  return truths;
}

Result<void> check_files(const SimulateOptions& options, const SurveyedRun& input,
                         const std::vector<Shot>& shots) {
  CommandFiles files;
  files.reads(input.survey);
  files.reads(input.rig);
  files.reads(input.run);
  for (const char* name : {kTruth, kRun}) files.writes(options.folder / name, "--output");
  for (const Shot& shot : shots) files.writes(options.folder / shot.file, "--output");
  return files.check();
}

Result<void> check_chain(const SimulateOptions& options) {
  const bool chain = options.chain != "none";
  const bool quality = options.quality != 0;
  return none_of(
      {{chain && options.linear,
        "--linear and --camera-chain exclude each other: a chain bends its own tone curve"},
       {!chain && options.rolling_px != 0,
        "--rolling-shutter needs --camera-chain mild, strong or night"},
       {chain && quality,
        "--quality and --camera-chain exclude each other: a chain has its own compression"},
       {quality && options.format != "jpg",
        "--quality is for JPEG files: give --format jpg, too"}});
}

Result<Json> simulate(const SimulateOptions& options, const SurveyedRun& input) {
  if (const auto chain = check_chain(options); !chain) return fail(chain);
  if (const auto sizes = check_image_sizes(input.rig); !sizes) return fail(sizes);
  const auto names = check_file_names(input, options.format);
  if (!names) return fail(names);
  const auto stations = stations_of(input, options.seed);
  if (!stations) return fail(stations);
  const auto folder = check_folder(options);
  if (!folder) return fail(folder);
  const std::vector<Shot> shots = shots_of(input, *stations, options.format);
  if (const auto usable = check_files(options, input, shots); !usable) {
    return fail(usable);
  }
  auto files = StagedFiles::begin(options.folder);
  if (!files) return fail(files);
  auto truths = render_shots(options, input, shots, *files);
  if (!truths) return truths;
  for (const auto& [name, text] : {std::pair{kTruth, truth_text(input.survey, *truths)},
                                   std::pair{kRun, run_text(input, *stations, options.format)}}) {
    if (const auto added = files->add(name, text); !added) return fail(added);
  }
  if (const auto published = files->publish(); !published) {
    return fail(published);
  }
  return truths;
}

Result<int> run_simulate(const SimulateOptions& options) {
  const Result<SurveyedRun> input = load_surveyed_run(options.survey, options.rig, options.run);
  if (!input) return fail(input);
  const Result<Json> truths = simulate(options, *input);
  if (!truths) return fail(truths);
  if (options.json) {
    print_json(*truths, options.folder);
  } else {
    to_stdout("{} images, run.csv and truth.json in {}\n", truths->size(), options.folder.string());
  }
  return kExitOk;
}

std::vector<CommandOption> camera_options(SimulateOptions& options) {
  return {with_default(number_option("--blur", &options.blur_px, "PX", 0, 20,
                                     "Standard deviation of the lens's blur, pixels")),
          with_default(number_option("--noise", &options.noise, "LEVELS", 0, 100,
                                     "Standard deviation of the noise at middle grey")),
          flag("--linear", &options.linear, "Grey levels in proportion to light (default: sRGB)"),
          with_default(choice_option("--camera-chain", &options.chain,
                                     {"none", "mild", "strong", "night"},
                                     "What the cameras do to a picture before they store it")),
          with_default(number_option(
              "--rolling-shutter", &options.rolling_px, "PX", -100, 100,
              "Way of the picture to the right while a chain's camera reads its rows")),
          with_default(number_option("--seed", &options.seed, "N", 0, 1e15,
                                     "Of the noise and of the walls' texture")),
          with_default(choice_option("--format", &options.format, {"png", "jpg"}, "Image format")),
          number_option("--quality", &options.quality, "N", 1, 100,
                        "JPEG quality, 1 to 100 (default: 95)")};
}

}  // namespace

Command simulate_command() {
  const auto options = std::make_shared<SimulateOptions>();
  return {
      .name = "simulate",
      .summary = "What the cameras would see along a run, for rehearsals",
      .options =
          joined({{survey_argument(&options->survey, "The tunnel and its tags (survey.yaml)"),
                   required(rig_option(&options->rig,
                                       "The vehicle's cameras and range sensors (rig.yaml)")),
                   required(value_option("--run", &options->run, "RUN.csv",
                                         "True positions: id, truth_x, truth_y, truth_z, ...",
                                         ValueKind::table)),
                   required(folder_option("-o,--output", &options->folder,
                                          "Folder for the images, run.csv and truth.json")),
                   flag("--force", &options->force, "Write into a folder that is not empty"),
                   json_flag(options->json, "One JSON object an image, the summary last"),
                   jobs_option(options->jobs, "Images made at the same time")},
                  camera_options(*options)}),
      .notes =
          "For each row and camera DIR/ID_CAMERA.png; DIR/run.csv with the ranges measured and the "
          "truth, for localize; DIR/truth.json with each plate's corners in pixels. Without "
          "truth_heading the vehicle looks along the tunnel. Label text on the plates is not "
          "drawn. Exit code 0: all files written; 2: wrong use or input, none written.\n\n"
          "Example:\n"
          "  tagsmith simulate surveys/curved/survey.yaml --rig surveys/curved/rig.yaml --run "
          "surveys/curved/run.csv \\\n"
          "    -o rehearsal",
      .run = [options] { return run_simulate(*options); },
  };
}

}  // namespace tagsmith::detail
