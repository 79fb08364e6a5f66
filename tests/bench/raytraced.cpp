// SPDX-License-Identifier: Apache-2.0
// Photos of another maker, for the benches that read folders with a truth.json: POV-Ray traces the
// scenes of raytraced_scene.hpp, each pixel from 4 to 9 places and at edges from up to 81 times as
// many, and a plain sensor of OpenCV's functions stores them. Nothing of the reader's model of
// pictures or of `simulate` is in them. Usage: bench_raytraced FOLDER [PHOTOS [SEED [KIND
// [SIZE]]]], KIND one of kNames or "all" in turn, SIZE (1) times as many pixels along each side;
// needs povray.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "tagsmith/geometry/angle.hpp"
#include "tests/bench/raytraced_scene.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::raytraced;
using mass::Random;
using mass::uniform;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// A part of the picture, pixels; the ends are not in it.
struct Part {
  int left, top, right, bottom;

  cv::Rect times(int by) const {
    return {left * by, top * by, (right - left) * by, (bottom - top) * by};
  }
};

Part whole(const Scene& scene) { return {0, 0, scene.width, scene.height}; }

// The frame and what is about it.
Part around(const Scene& scene) {
  const FrameCorners& corners = scene.corners;
  const auto [left, right] = std::ranges::minmax(corners, {}, &PixelPoint::x);
  const auto [top, bottom] = std::ranges::minmax(corners, {}, &PixelPoint::y);
  const double aside = 0.35 * (right.x - left.x) + 6, above = 0.35 * (bottom.y - top.y) + 6;
  return {std::max(0, static_cast<int>(left.x - aside)),
          std::max(0, static_cast<int>(top.y - above)),
          std::min(scene.width, static_cast<int>(right.x + aside) + 1),
          std::min(scene.height, static_cast<int>(bottom.y + above) + 1)};
}

// What POV-Ray makes of a scene at so many samples a pixel along each axis, linear light; nothing
// where it fails.
std::optional<cv::Mat> traced(const std::string& source, const Scene& scene, int samples,
                              const Part& part, const std::string& options) {
  const test::TemporaryFolder folder;
  const fs::path text = folder.path() / "scene.pov", picture = folder.path() / "scene.png";
  std::ofstream(text) << source;
  const cv::Rect area = part.times(samples);
  const auto result = test::run_shell(fmt::format(
      "povray +I{} +O{} +W{} +H{} +SC{} +SR{} +EC{} +ER{} +WT1 -D -GA Output_File_Type=N "
      "Bits_Per_Color=16 Grayscale_Output=on File_Gamma=1.0 {}",
      text.string(), picture.string(), scene.width * samples, scene.height * samples, area.x + 1,
      area.y + 1, area.x + area.width, area.y + area.height, options));
  cv::Mat light = cv::imread(picture.string(), cv::IMREAD_UNCHANGED);
  if (result.exit_code != 0 || light.empty()) {
    fmt::print(stderr, "{}\n", result.err);
    return std::nullopt;
  }
  if (light.channels() > 1) cv::extractChannel(light, light, 1);
  light.convertTo(light, CV_32F, 1.0 / 65535);
  return light.size() == area.size() ? light : light(area).clone();
}

// The light of the picture, so many samples a pixel: coarse but about the plate.
std::optional<cv::Mat> light_of(const Scene& scene, int samples) {
  const auto coarse = traced(scene.source, scene, 1, whole(scene), "+A0.1 +AM1 +R2");
  const Part part = around(scene);
  const auto fine = traced(scene.source, scene, samples, part, "+A0.05 +AM2 +R3 -J");
  if (!coarse || !fine) return std::nullopt;
  cv::Mat light;
  cv::resize(*coarse, light, {}, samples, samples, cv::INTER_NEAREST);
  fine->copyTo(light(part.times(samples)));
  return light;
}

// Which share of the frame is in sight.
std::optional<double> share_in_sight(const Scene& scene) {
  const auto shining = traced(scene.unhidden, scene, 1, whole(scene), "");
  if (!shining) return std::nullopt;
  std::vector<cv::Point> outline;
  for (const PixelPoint& corner : scene.corners) {
    outline.emplace_back(static_cast<int>(std::lround(corner.x)),
                         static_cast<int>(std::lround(corner.y)));
  }
  cv::Mat frame = cv::Mat::zeros(shining->size(), CV_8U);
  cv::fillConvexPoly(frame, outline, 1);
  cv::Mat in_sight = frame.clone();
  in_sight.setTo(0, *shining < 0.3);
  return cv::sum(in_sight)[0] / std::max(1.0, cv::sum(frame)[0]);
}

void blur_by(cv::Mat& light, cv::Mat kernel) {
  kernel /= cv::sum(kernel)[0];
  cv::filter2D(light, light, -1, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
}

// A disc, its border by the share of it in each sample.
cv::Mat disc(double radius) {
  constexpr int kParts = 8;
  const int side = 2 * static_cast<int>(std::ceil(radius + 1)) + 1;
  cv::Mat fine = cv::Mat::zeros(side * kParts, side * kParts, CV_32F);
  for (int y = 0; y < fine.rows; ++y) {
    for (int x = 0; x < fine.cols; ++x) {
      const double across = (x + 0.5) / kParts - side / 2.0, down = (y + 0.5) / kParts - side / 2.0;
      fine.at<float>(y, x) = std::hypot(across, down) < radius ? 1 : 0;
    }
  }
  cv::Mat kernel;
  cv::resize(fine, kernel, {side, side}, 0, 0, cv::INTER_AREA);
  return kernel;
}

cv::Mat path(double length, double angle) {
  constexpr int kPlaces = 401;
  const int side = 2 * static_cast<int>(std::ceil(length)) + 3;
  cv::Mat kernel = cv::Mat::zeros(side, side, CV_32F);
  for (int i = 0; i < kPlaces; ++i) {
    const double along = length * (i / (kPlaces - 1.0) - 0.5);
    const double x = side / 2 + along * std::cos(angle), y = side / 2 + along * std::sin(angle);
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx) {
        kernel.at<float>(top + dy, left + dx) +=
            static_cast<float>(std::abs(1 - dx - (x - left)) * std::abs(1 - dy - (y - top)));
      }
    }
  }
  return kernel;
}

// The value above which a twentieth of the frame's light is.
double bright_in(const cv::Mat& light, const Scene& scene) {
  const Part part = around(scene);
  cv::Mat row = light(part.times(1)).clone().reshape(1, 1), sorted;
  cv::sort(row, sorted, cv::SORT_ASCENDING);
  return static_cast<double>(sorted.at<float>(0, sorted.cols * 19 / 20));
}

// One of three tone curves: sRGB, a power, and sRGB bent to an S.
double sample_of(double light, int tone) {
  const double srgb = light < 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
  if (tone == 1) return std::pow(light, 0.45);
  return tone == 2 ? srgb + 0.5 * srgb * (1 - srgb) * (2 * srgb - 1) : srgb;
}

cv::Mat stored(cv::Mat light, int samples, Kind kind, const Scene& scene, Random& random) {
  cv::GaussianBlur(light, light, {}, uniform(random, 0.25, 0.6) * samples, 0, cv::BORDER_REPLICATE);
  if (kind == Kind::defocus) blur_by(light, disc(uniform(random, 0.8, 3) * samples));
  if (kind == Kind::motion) {
    blur_by(light, path(uniform(random, 1, 5) * samples, uniform(random, 0, 2 * std::numbers::pi)));
  }
  cv::resize(light, light, {scene.width, scene.height}, 0, 0, cv::INTER_AREA);
  light *= uniform(random, 0.45, 1.15) / std::max(1e-6, bright_in(light, scene));
  const bool dark = kind == Kind::dark;
  const double photons = dark ? 250 : 4000;  // of full light
  const double read_noise = uniform(random, 0.3, 1.5) * (dark ? 0.013 : 0.0032);
  const int tone = mass::integer(random, 0, 2);
  cv::Mat picture(light.size(), CV_8U);
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      const double seen = static_cast<double>(light.at<float>(y, x));
      const double sigma = std::sqrt(std::max(0.0, seen) / photons + read_noise * read_noise);
      const double noisy = seen + std::normal_distribution<double>(0, sigma)(random);
      picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(
          std::lround(255 * sample_of(std::clamp(noisy, 0.0, 1.0), tone)));
    }
  }
  return picture;
}

// As bench_photo_sets reads it.
json truth_of(const std::string& file, Kind kind, const Scene& scene, double in_sight) {
  json corners;
  bool inside = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint& at = scene.corners[i];
    corners[std::string(1, "PFRQ"[i])] = {at.x, at.y};
    const double stroke = 5 * scene.module_px;
    inside = inside && at.x > stroke && at.y > stroke && at.x < scene.width - stroke &&
             at.y < scene.height - stroke;
  }
  const json plate{{"kind", "upca"},
                   {"code", scene.code},
                   {"corners_px", corners},
                   {"px_per_module", scene.module_px},
                   {"incidence_deg", degrees(scene.incidence)},
                   {"frame_in_image", inside},
                   {"fraction_visible", in_sight}};
  return {
      {"file", file}, {"level", kNames.at(static_cast<std::size_t>(kind))}, {"plates", {plate}}};
}

// Photo `number` and its truth; nothing where POV-Ray fails.
json take(const fs::path& folder, int number, std::uint64_t seed, int size) {
  const auto kind = static_cast<Kind>(number % kKinds);
  Random random(seed * 1'000'003 + static_cast<std::uint64_t>(number));
  const Scene scene = draw_scene(kind, size, random);
  const std::string file =
      fmt::format("{}_{:04}.jpg", kNames.at(static_cast<std::size_t>(kind)), number);
  const int samples = scene.module_px > 4 ? 1 : scene.module_px > 1.6 ? 2 : 3;
  const auto in_sight = share_in_sight(scene);
  const auto light = in_sight ? light_of(scene, samples) : std::nullopt;
  if (!light) return {};
  const cv::Mat picture = stored(*light, samples, kind, scene, random);
  cv::imwrite((folder / file).string(), picture,
              {cv::IMWRITE_JPEG_QUALITY, mass::integer(random, 85, 98)});
  return truth_of(file, kind, scene, *in_sight);
}

// The folder's truth.json, whole after each photo.
class Album {
 public:
  explicit Album(fs::path folder) : folder_(std::move(folder)) {}

  void add(json image) {
    if (image.is_null()) return;
    const std::scoped_lock lock(mutex_);
    images_.push_back(std::move(image));
    std::ranges::sort(images_, {},
                      [](const json& item) { return item.at("file").get<std::string>(); });
    std::ofstream(folder_ / "truth.json")
        << json{{"set", folder_.filename().string()}, {"check", "gs1"}, {"images", images_}}.dump(
               1);
  }

  std::size_t size() const { return images_.size(); }

 private:
  fs::path folder_;
  std::mutex mutex_;
  std::vector<json> images_;
};

}  // namespace

int main(int argc, char** argv) {
  const std::string kind = argc > 4 && std::string(argv[4]) != "all" ? argv[4] : "";
  const int size = argc > 5 ? std::atoi(argv[5]) : 1;
  const auto only = std::ranges::find(kNames, kind);
  if (argc < 2 || *argv[1] == '-' || size < 1 || (!kind.empty() && only == kNames.end())) {
    fmt::print(stderr, "bench_raytraced FOLDER [PHOTOS [SEED [KIND [SIZE]]]]; KIND: all, {}\n",
               fmt::join(kNames, ", "));
    return 2;
  }
  const fs::path folder = argv[1];
  const int photos = argc > 2 ? std::atoi(argv[2]) : 4 * kKinds;
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  if (!test::has_program("povray")) {
    fmt::print(stderr, "povray is not installed\n");
    return 2;
  }
  // Photos of one kind are those of that kind among kKinds times as many of all.
  const int step = kind.empty() ? 1 : kKinds;
  const int first = kind.empty() ? 0 : static_cast<int>(only - kNames.begin());
  fs::create_directories(folder);
  Album album(folder);
  tbb::parallel_for(0, photos,
                    [&](int i) { album.add(take(folder, first + step * i, seed, size)); });
  fmt::print("{} photos in {}\n", album.size(), folder.string());
  return std::cmp_equal(album.size(), photos) ? 0 : 1;
}
