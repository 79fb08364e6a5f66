// SPDX-License-Identifier: Apache-2.0
// Calibration: errors beside OpenCV's, how honest the covariances are, and what it costs.
// Usage: bench_calibrate [errors [SETS] | own [SETS] | nees [DRAWS] | time [PHOTOS]]; without, all
// of them. `own` is `errors` without the others.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/calibrate/assess.hpp"
#include "decoder/calibrate/calibrate_camera.hpp"
#include "decoder/calibrate/ray_sigma.hpp"
#include "decoder/image/load.hpp"
#include "tests/bench/calibrate_other.hpp"
#include "tests/support/board_photos.hpp"

namespace tagsmith::detail::bench {
namespace {

using Eigen::Vector2d;
using test::Draws;

struct NamedCamera {
  std::string name;
  Camera camera;
};

// --- errors beside OpenCV's ---

struct CameraError {
  double focal = 0;  // relative
  double center_px = 0;
  double ray_px = 0;  // the worst of the picture
};

double worst_ray(const Camera& truth, const Camera& found) {
  constexpr int kSteps = 24;
  double worst = 0;
  for (int x = 0; x <= kSteps; ++x) {
    for (int y = 0; y <= kSteps; ++y) {
      const Vector2d pixel(x * (truth.width - 1.0) / kSteps, y * (truth.height - 1.0) / kSteps);
      const auto ray = ray_through(truth, pixel);
      if (!ray) continue;
      const auto seen = project(found, *ray);
      worst = std::max(worst, seen ? (*seen - pixel).norm() : truth.width);
    }
  }
  return worst;
}

CameraError error_of(const Camera& truth, const Camera& found) {
  CameraError error;
  error.focal = std::max(std::abs(found.fx / truth.fx - 1), std::abs(found.fy / truth.fy - 1));
  error.center_px = std::hypot(found.cx - truth.cx, found.cy - truth.cy);
  error.ray_px = worst_ray(truth, found);
  return error;
}

bool is_wholly_seen(const Camera& camera, const Board& board, const Pose& pose) {
  for (const double x : {0.0, board.width}) {
    for (const double y : {0.0, board.height}) {
      const auto pixel = project(camera, pose * Eigen::Vector3d(x, y, 0));
      if (!pixel || !in_image(camera, *pixel)) return false;
    }
  }
  return true;
}

// Fifteen poses in which the whole board is in the picture, as a chessboard needs it.
std::vector<Pose> whole_poses(const Camera& camera, const Board& board, std::size_t count,
                              Draws& draws) {
  std::vector<Pose> poses;
  while (poses.size() < count) {
    const Pose pose =
        test::camera_from_board(camera, board, test::varied_stance(camera, poses.size(), draws));
    if (is_wholly_seen(camera, board, pose)) poses.push_back(pose);
  }
  return poses;
}

// Unsharp mask of radius 1 px and strength 1.2, then an S-shaped tone curve: what phones do.
GrayImage sharpened(const GrayImage& image) {
  constexpr double kStrength = 1.2;
  constexpr int kReach = 3;
  double kernel[2 * kReach + 1], sum = 0;
  for (int i = -kReach; i <= kReach; ++i) sum += kernel[i + kReach] = std::exp(-0.5 * i * i);
  const auto smooth = [&](const std::vector<double>& from, int dx, int dy) {
    std::vector<double> to(from.size());
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        double value = 0;
        for (int i = -kReach; i <= kReach; ++i) {
          const int u = std::clamp(x + i * dx, 0, image.width - 1);
          const int v = std::clamp(y + i * dy, 0, image.height - 1);
          value += kernel[i + kReach] / sum *
                   from[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                        static_cast<std::size_t>(u)];
        }
        to[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
           static_cast<std::size_t>(x)] = value;
      }
    }
    return to;
  };
  const std::vector<double> plain(image.samples.begin(), image.samples.end());
  const std::vector<double> blurred = smooth(smooth(plain, 1, 0), 0, 1);
  GrayImage result = image;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double t = std::clamp((plain[i] + kStrength * (plain[i] - blurred[i])) / 255, 0.0, 1.0);
    const double curved = 0.5 * t + 0.5 * t * t * (3 - 2 * t);
    result.samples[i] = static_cast<std::uint8_t>(std::lround(255 * curved));
  }
  return result;
}

ViewOptions photo_options(std::uint64_t seed) {
  ViewOptions options;
  options.sensor.blur_sigma_px = 0.7;
  options.sensor.noise_sigma = 2;
  options.sensor.exposure = 0.85;
  options.seed = seed;
  return options;
}

using Render = std::function<ScenePlate(const Pose&)>;

std::vector<GrayImage> photos_of(const Camera& camera, const std::vector<Pose>& poses,
                                 std::uint64_t seed, const Render& plate_at) {
  std::vector<GrayImage> photos(poses.size());
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    const ScenePlate plate = plate_at(poses[i]);
    photos[i] = render_view(camera, std::span(&plate, 1), photo_options(1000 * seed + i)).image;
  });
  return photos;
}

PhotoSource source_of(const std::vector<GrayImage>& photos) {
  PhotoSource source;
  for (std::size_t i = 0; i < photos.size(); ++i) source.files.push_back(fmt::format("{}", i));
  source.load = [&photos](std::size_t i) -> Result<GrayImage> { return photos[i]; };
  return source;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? std::nan("") : values[values.size() / 2];
}

struct Method {
  std::string name;
  Render plate_at;
  std::function<std::optional<Camera>(const std::vector<GrayImage>&)> calibrate;
  std::vector<CameraError> errors{};
};

// Error^2 over variance of all parameters of the form that are free, a parameter.
double nees_of(const Camera& truth, const CameraCalibration& calibration) {
  const auto basis = free_parameters(calibration.form);
  const Eigen::MatrixXd inverse = (basis.transpose() * basis).inverse() * basis.transpose();
  const Eigen::VectorXd off = inverse * (parameters_of(calibration.camera) - parameters_of(truth));
  const Eigen::MatrixXd covariance = inverse * calibration.covariance * inverse.transpose();
  return off.dot(covariance.ldlt().solve(off)) / static_cast<double>(off.size());
}

bool holds_truth(const Camera& truth, const CameraForm& form) {
  if (form.lens.lens != truth.lens) return false;
  for (std::size_t i = 0; i < truth.distortion.size(); ++i) {
    if (truth.distortion[i] != 0 && (form.lens.free >> i & 1U) == 0) return false;
  }
  return !form.square_pixels || truth.fx == truth.fy;
}

// What of ours is told besides the errors.
struct OwnFigures {
  std::vector<double> nees, factor, edge, ray_sigmas;
};

std::vector<Method> methods_of(const Board& board, const Camera& camera, OwnFigures& own) {
  std::vector<Method> methods;
  methods.push_back(
      {"tagsmith", [&board](const Pose& pose) { return test::board_plate(board, pose); },
       [&board, &camera, &own](const std::vector<GrayImage>& photos) -> std::optional<Camera> {
         const auto result = calibrate_photos(source_of(photos), {&board, 1});
         if (!result) return std::nullopt;
         const CameraCalibration& found = result->calibration;
         if (holds_truth(camera, found.form)) own.nees.push_back(nees_of(camera, found));
         own.factor.push_back(found.sigma_factor);
         own.edge.push_back(found.edge_px);
         own.ray_sigmas.push_back(worst_ray(camera, found.camera) /
                                  ray_grid(found).worst_sigma_px());
         return found.camera;
       }});
  for (const OtherTarget& target : other_targets()) {
    methods.push_back({target.name,
                       [&board, &target](const Pose& pose) {
                         ScenePlate plate;
                         plate.drawing = target.draw(board.width, board.height);
                         plate.camera_from_plate = pose;
                         return plate;
                       },
                       [&board, &target](const std::vector<GrayImage>& photos) {
                         return target.calibrate(photos, board.width, board.height);
                       }});
  }
  return methods;
}

void print_errors(const std::vector<Method>& methods) {
  const auto of = [](const Method& method, double CameraError::*field) {
    std::vector<double> values;
    for (const CameraError& error : method.errors) values.push_back(error.*field);
    return median(values);
  };
  const Method& ours = methods.front();
  fmt::print("| target | sets | focal, % | centre, px | worst ray, px | over ours |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  for (const Method& method : methods) {
    const auto ratio = [&](double CameraError::*field) {
      return of(method, field) / of(ours, field);
    };
    fmt::print("| {} | {} | {:.4f} | {:.3f} | {:.3f} | {:.1f}, {:.1f}, {:.1f} |\n", method.name,
               method.errors.size(), 100 * of(method, &CameraError::focal),
               of(method, &CameraError::center_px), of(method, &CameraError::ray_px),
               ratio(&CameraError::focal), ratio(&CameraError::center_px),
               ratio(&CameraError::ray_px));
  }
}

std::vector<GrayImage> all_sharpened(const std::vector<GrayImage>& photos) {
  std::vector<GrayImage> result(photos.size());
  tbb::parallel_for(std::size_t{0}, photos.size(),
                    [&](std::size_t i) { result[i] = sharpened(photos[i]); });
  return result;
}

struct Comparison {
  std::string title;
  OwnFigures own;
  std::vector<Method> methods;
};

void print_comparison(const Comparison& one) {
  fmt::print("\n{}:\n\n", one.title);
  print_errors(one.methods);
  double nees = 0;
  for (const double value : one.own.nees) nees += value / static_cast<double>(one.own.nees.size());
  fmt::print(
      "\nours: NEES {:.2f} a parameter in {} sets, worst ray over the worst sigma {:.2f}, sigma "
      "factor {:.2f}, edges {:+.3f} px (medians)\n",
      nees, one.own.nees.size(), median(one.own.ray_sigmas), median(one.own.factor),
      median(one.own.edge));
}

void compare_errors(std::size_t sets, bool others) {
  const Camera camera{1600, 1200, 1150, 1150, 812.3, 590.7, {-0.25, 0.08}};
  const Board board = test::plate_board();
  Comparison plain{"15 photos, noise 2", {}, {}};
  Comparison sharp{"15 photos, noise 2, sharpened 1.2, S-shaped tone curve", {}, {}};
  for (Comparison* one : {&plain, &sharp}) {
    one->methods = methods_of(board, camera, one->own);
    if (!others) one->methods.resize(1);
  }
  for (std::uint64_t set = 0; set < sets; ++set) {
    Draws draws(set + 1);
    const std::vector<Pose> poses = whole_poses(camera, board, 15, draws);
    for (std::size_t i = 0; i < plain.methods.size(); ++i) {
      const auto photos = photos_of(camera, poses, set + 1, plain.methods[i].plate_at);
      const auto found = plain.methods[i].calibrate(photos);
      if (found) plain.methods[i].errors.push_back(error_of(camera, *found));
      const auto by_sharp = sharp.methods[i].calibrate(all_sharpened(photos));
      if (by_sharp) sharp.methods[i].errors.push_back(error_of(camera, *by_sharp));
    }
  }
  print_comparison(plain);
  print_comparison(sharp);
}

// --- honesty ---

void print_nees(const NamedCamera& truth, std::size_t draws_count) {
  const Board board = test::plate_board();
  std::vector<double> nees(draws_count), sigmas(draws_count);
  std::vector<int> held(draws_count), good(draws_count);
  tbb::parallel_for(std::size_t{0}, draws_count, [&](std::size_t i) {
    Draws draws(i + 1);
    const auto views = test::seen_boards(truth.camera, board, 15, draws);
    const auto found = calibrate_camera(views, {&board, 1});
    if (!found) return;
    held[i] = holds_truth(truth.camera, found->form) ? 1 : 0;
    if (held[i] != 0) nees[i] = nees_of(truth.camera, *found);
    sigmas[i] = worst_ray(truth.camera, found->camera) / ray_grid(*found).worst_sigma_px();
    const auto assessment = assess_calibration(*found, views, {&board, 1});
    good[i] = assessment.trust == CalibrationTrust::good ? 1 : 0;
  });
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < draws_count; ++i) {
    sum += nees[i];
    count += held[i];
  }
  std::ranges::sort(sigmas);
  fmt::print("| {} | {} of {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", truth.name, count, draws_count,
             std::ranges::count(good, 1), sum / count, sigmas[draws_count / 2],
             sigmas[draws_count * 95 / 100]);
  std::fflush(stdout);
}

void measure_nees(std::size_t draws) {
  fmt::print(
      "\nSimulated corners, 15 photos:\n\n| camera | truth among the form chosen | good | "
      "NEES a parameter | worst ray over worst sigma, median | 95 % "
      "|\n|---|---|---|---|---|---|\n");
  const std::vector<NamedCamera> cameras{
      {"no distortion", {1280, 960, 1100, 1100, 645.2, 473.1}},
      {"k1 0.05", {1280, 960, 1400, 1400, 650, 470, {0.05}}},
      {"k1 -0.35", {1280, 960, 800, 800, 633.5, 488, {-0.35, 0.12}}},
      {"tangential, fx and fy", {1920, 1080, 1000, 1004, 980, 520, {-0.28, 0.09, 0.0012, -0.0009}}},
      {"k1 to k6",
       {1280, 960, 1150, 1150, 645, 474, {0.4, 0.05, 0.0003, -0.0002, 0.002, 0.8, 0.15, 0.01}}},
      {"fisheye, 180 degrees",
       {1280, 960, 400, 400, 645, 474, {-0.02, 0.004, -0.001, 0.0001}, LensModel::fisheye}}};
  for (const NamedCamera& camera : cameras) print_nees(camera, draws);
}

// --- time ---

void measure_time(std::size_t count) {
  const Camera camera{4000, 3000, 3000, 3000, 2010, 1490, {-0.1, 0.02}};
  const Board board = test::plate_board();
  Draws draws(1);
  constexpr std::size_t kDifferent = 10;
  const std::vector<Pose> poses = whole_poses(camera, board, kDifferent, draws);
  const auto photos =
      photos_of(camera, poses, 1, [&](const Pose& pose) { return test::board_plate(board, pose); });
  const auto folder = std::filesystem::temp_directory_path() / "tagsmith-bench-calibrate";
  std::filesystem::create_directories(folder);
  PhotoSource source;
  for (std::size_t i = 0; i < count; ++i) {
    const auto file = folder / fmt::format("{}.jpg", i % kDifferent);
    if (i < kDifferent && !save_gray_image(file, photos[i].view())) return;
    source.files.push_back(file.string());
  }
  source.load = [&](std::size_t i) { return load_gray_image(source.files[i]); };
  const auto start = std::chrono::steady_clock::now();
  const auto found = calibrate_photos(source, {&board, 1});
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::filesystem::remove_all(folder);
  fmt::print("\n{} photos of 12 million pixels, {} tags: {:.1f} s{}\n", count,
             found ? found->calibration.residuals.size() : 0, time.count(),
             found ? "" : ": " + found.error().message);
}

}  // namespace
}  // namespace tagsmith::detail::bench

int main(int argc, char** argv) {
  using namespace tagsmith::detail::bench;
  const std::string what = argc > 1 ? argv[1] : "all";
  const auto number = [&](std::size_t usual) {
    return argc > 2 ? static_cast<std::size_t>(std::max(1, std::atoi(argv[2]))) : usual;
  };
  if (what == "errors" || what == "all") compare_errors(number(10), true);
  if (what == "own") compare_errors(number(10), false);
  if (what == "nees" || what == "all") measure_nees(number(200));
  if (what == "time" || what == "all") measure_time(number(100));
  return 0;
}
