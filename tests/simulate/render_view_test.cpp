// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/render_view.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/program.hpp"
#include "tests/support/turned_plate.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TagDrawing drawing() { return draw_tag(test::corridor_template(), *parse_digits("012345678905")); }

Camera camera_of(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = 1600;
  camera.fy = 1600;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

ScenePlate plate_at(const Camera& camera, const Vector2d& pixel, double distance, double yaw_deg,
                    double pitch_deg, double roll_deg) {
  const TagDrawing tag = drawing();
  return {tag,
          camera_from_turned_plate(camera, tag, pixel, distance, radians(yaw_deg),
                                   radians(pitch_deg), radians(roll_deg)),
          {}};
}

ViewOptions plain_options() {
  ViewOptions options;
  options.sensor.tone = SensorTone::linear;
  options.background_light = 0;
  return options;
}

// A scan along a row of pixels.
struct Profile {
  double first = 0;
  double last = 0;
  double sum = 0;  // of the samples, ends included
  int count = 0;
  std::vector<double> samples;
};

Profile scan(const LightImage& image, int y, int from, int to) {
  Profile profile;
  for (int x = from; x <= to; ++x) {
    profile.samples.push_back(static_cast<double>(image.row(y)[x]));
    profile.sum += profile.samples.back();
    ++profile.count;
  }
  profile.first = profile.samples.front();
  profile.last = profile.samples.back();
  return profile;
}

// The place where a sharp edge would give the same sum of light.
double edge_position(const LightImage& image, int y, int from, int to) {
  const Profile profile = scan(image, y, from, to);
  const double share =
      (profile.sum - profile.count * profile.last) / (profile.first - profile.last);
  return from - 0.5 + share;
}

// Where the straight side from a to b crosses a row of pixels.
double crossing(const Camera& camera, const Vector3d& a, const Vector3d& b, double row) {
  double low = 0;
  double high = 1;
  const auto at = [&](double part) { return *project(camera, a + part * (b - a)); };
  const bool rising = at(1).y() > at(0).y();
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((at(middle).y() < row) == rising ? low : high) = middle;
  }
  return at(low).x();
}

struct EdgeErrors {
  double mean = 0;
  double largest = 0;
  int count = 0;
};

// Errors of the plate's left edge against the dark background on every row well within it.
EdgeErrors left_edge_errors(const Camera& camera, const ScenePlate& plate,
                            const ViewOptions& options) {
  const std::vector<ScenePlate> plates{plate};
  const LightImage image = render_light(camera, plates, options);
  const Rectangle& area = plate.drawing.plate;
  const Vector3d top = plate.camera_from_plate * Vector3d(area.x, area.y, 0);
  const Vector3d bottom = plate.camera_from_plate * Vector3d(area.x, area.y + area.height, 0);
  const double y_top = project(camera, top)->y();
  const double y_bottom = project(camera, bottom)->y();
  EdgeErrors errors;
  for (int y = static_cast<int>(y_top) + 12; y < static_cast<int>(y_bottom) - 12; ++y) {
    const double expected = crossing(camera, top, bottom, y);
    const int x = static_cast<int>(std::lround(expected));
    const double error = edge_position(image, y, x - 7, x + 7) - expected;
    errors.mean += error;
    errors.largest = std::max(errors.largest, std::abs(error));
    ++errors.count;
  }
  REQUIRE(errors.count > 50);
  errors.mean /= errors.count;
  return errors;
}

TEST_CASE("Edges lie where geometry puts them, to a hundredth of a pixel") {
  const Camera camera = camera_of(500, 400);
  for (const double blur : {0.0, 0.3, 0.7, 1.0, 1.5}) {
    for (const double shift : {0.0, 0.37, 0.81}) {
      for (const double roll : {0.0, 3.0, 11.0}) {
        ViewOptions options = plain_options();
        options.sensor.blur_sigma_px = blur;
        const ScenePlate plate = plate_at(camera, {250 + shift, 200.3}, 1.9, 25, -8, roll);
        const EdgeErrors errors = left_edge_errors(camera, plate, options);
        CAPTURE(blur);
        CAPTURE(shift);
        CAPTURE(roll);
        CAPTURE(errors.mean);
        CHECK(std::abs(errors.mean) < 0.003);
        CHECK(errors.largest < 0.01);
      }
    }
  }
}

TEST_CASE("Edges follow lens distortion") {
  Camera camera = camera_of(640, 480);
  camera.fx = camera.fy = 500;
  camera.distortion = {-0.28, 0.09, 0.001, -0.0015, -0.01};
  const ScenePlate plate = plate_at(camera, {260.2, 190.6}, 0.55, 20, 5, 4);
  const EdgeErrors errors = left_edge_errors(camera, plate, plain_options());
  CHECK(std::abs(errors.mean) < 0.003);
  CHECK(errors.largest < 0.01);
}

TEST_CASE("The blur measured on an edge is the blur asked for") {
  const Camera camera = camera_of(300, 300);
  for (const double sigma : {0.5, 0.7, 1.0, 1.6, 3.2}) {
    ViewOptions options = plain_options();
    options.sensor.blur_sigma_px = sigma;
    double variance = 0;
    constexpr int kPhases = 10;
    for (int phase = 0; phase < kPhases; ++phase) {
      const std::vector<ScenePlate> plates{
          plate_at(camera, {550 + 0.1 * phase, 150}, 0.8, 0, 0, 0)};
      const LightImage image = render_light(camera, plates, options);
      const Vector3d corner(plates[0].drawing.plate.x, 0.08, 0);
      const double edge = project(camera, plates[0].camera_from_plate * corner)->x();
      const int from = static_cast<int>(edge) - 16;
      const Profile profile = scan(image, 150, from, from + 32);
      double moment = 0;
      for (std::size_t i = 1; i < profile.samples.size(); ++i) {
        const double slope =
            (profile.samples[i] - profile.samples[i - 1]) / (profile.last - profile.first);
        const double at = from + static_cast<double>(i) - 0.5 - edge;
        moment += slope * at * at;
      }
      // Differences of neighbours see the edge through one more pixel.
      variance += (moment - 2.0 / 12) / kPhases;
    }
    CAPTURE(sigma);
    CHECK(std::sqrt(variance) == doctest::Approx(sigma).epsilon(0.03));
  }
}

// An edge through a Gaussian and a pixel's aperture: the integral of erf over the pixel.
double blurred_step(double from_edge, double sigma) {
  const auto integral = [&](double x) {
    const double z = x / sigma;
    return x * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
           sigma * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  };
  return integral(from_edge + 0.5) - integral(from_edge - 0.5);
}

TEST_CASE("An edge's light is that of the exact convolution at every sub-pixel place") {
  const Camera camera = camera_of(300, 300);
  ViewOptions options = plain_options();
  for (const double sigma : {0.6, 0.7, 1.0, 1.5}) {
    options.sensor.blur_sigma_px = sigma;
    double largest = 0;
    for (int phase = 0; phase < 20; ++phase) {
      const std::vector<ScenePlate> plates{
          plate_at(camera, {230 + 0.05 * phase, 150}, 1.6, 0, 0, 0)};
      const LightImage image = render_light(camera, plates, options);
      const Vector3d corner(plates[0].drawing.plate.x, 0.08, 0);
      const double edge = project(camera, plates[0].camera_from_plate * corner)->x();
      for (int x = static_cast<int>(edge) - 6; x <= static_cast<int>(edge) + 7; ++x) {
        const double expected = 0.82 * blurred_step(x - edge, sigma);
        const double found = static_cast<double>(image.row(150)[x]);
        largest = std::max(largest, std::abs(found - expected) / 0.82);
      }
    }
    CAPTURE(sigma);
    CHECK(largest < 0.004);
  }
}

TEST_CASE("Ink spread widens the bars by as many modules as it says") {
  const Camera camera = camera_of(1000, 500);
  ViewOptions options = plain_options();
  options.sensor.blur_sigma_px = 0.5;
  const auto ink_px = [&](double growth) {
    ScenePlate plate = plate_at(camera, {500, 250}, 0.6, 0, 0, 0);
    plate.finish.bar_growth = growth;
    const std::vector<ScenePlate> plates{plate};
    const LightImage image = render_light(camera, plates, options);
    // Across the symbol, from the middle of one quiet zone to the other.
    const Vector3d left(4.5 * plate.drawing.module, 0.08, 0);
    const Vector3d right(108.5 * plate.drawing.module, 0.08, 0);
    const auto from = static_cast<int>(project(camera, plate.camera_from_plate * left)->x());
    const auto to = static_cast<int>(project(camera, plate.camera_from_plate * right)->x());
    const Profile profile = scan(image, 250, from, to);
    const double white = plate.finish.white_reflectance;
    const double black = plate.finish.ink_reflectance;
    return (profile.count * white - profile.sum) / (white - black);
  };
  const double module_px = 1600 * drawing().module / 0.6;
  const double clean = ink_px(0);
  CHECK((ink_px(0.3) - clean) / (30 * module_px) == doctest::Approx(0.3).epsilon(0.02));
  CHECK((ink_px(-0.2) - clean) / (30 * module_px) == doctest::Approx(-0.2).epsilon(0.02));
}

TEST_CASE("Motion widens an edge and leaves its middle") {
  const Camera camera = camera_of(300, 300);
  ViewOptions options = plain_options();
  options.sensor.motion_px = {6, 0};
  const std::vector<ScenePlate> plates{plate_at(camera, {230.3, 150}, 1.6, 0, 0, 0)};
  const LightImage image = render_light(camera, plates, options);
  const Vector3d corner(plates[0].drawing.plate.x, 0.08, 0);
  const double edge = project(camera, plates[0].camera_from_plate * corner)->x();
  const int x = static_cast<int>(edge);
  CHECK(edge_position(image, 150, x - 10, x + 10) == doctest::Approx(edge).epsilon(1e-4));
  // The light rises evenly over six pixels.
  const auto rise = static_cast<double>(image.row(150)[x + 1] - image.row(150)[x - 1]);
  CHECK(rise == doctest::Approx(2.0 / 6 * 0.82).epsilon(0.03));
}

TEST_CASE("The same seed gives the same image, another seed other noise") {
  const Camera camera = camera_of(200, 120);
  const std::vector<ScenePlate> plates{plate_at(camera, {100, 60}, 4, 20, 0, 5)};
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  options.seed = 5;
  const GrayImage first = render_view(camera, plates, options).image;
  CHECK(render_view(camera, plates, options).image.samples == first.samples);
  options.seed = 6;
  CHECK(render_view(camera, plates, options).image.samples != first.samples);
}

TEST_CASE("An image does not depend on how it is cut into tiles") {
  // The same rays through a larger sensor: its tiles fall elsewhere.
  Camera small = camera_of(150, 90);
  Camera large = camera_of(190, 133);
  large.cx = small.cx;
  large.cy = small.cy;
  const std::vector<ScenePlate> plates{plate_at(small, {75, 45}, 4, 20, 0, 5)};
  const LightImage a = render_light(small, plates, plain_options());
  const LightImage b = render_light(large, plates, plain_options());
  double largest = 0;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      largest = std::max(largest, std::abs(static_cast<double>(a.row(y)[x] - b.row(y)[x])));
    }
  }
  CHECK(largest < 1e-5);
}

TEST_CASE("Finishes show") {
  const Camera camera = camera_of(500, 400);
  const ScenePlate clean = plate_at(camera, {250, 200}, 1.6, 0, 0, 0);
  const auto render = [&](const ScenePlate& plate) {
    const std::vector<ScenePlate> plates{plate};
    return render_view(camera, plates, plain_options());
  };
  const View plain = render(clean);
  CHECK(plain.plates[0].visible_fraction == doctest::Approx(1));
  const auto level_at = [&](const View& view, double x, double y) {
    const Vector2d pixel = *project(camera, clean.camera_from_plate * Vector3d(x, y, 0));
    return static_cast<double>(view.image.view().at(static_cast<int>(std::lround(pixel.x())),
                                                    static_cast<int>(std::lround(pixel.y()))));
  };
  CHECK(level_at(plain, 0.02, 0.08) == doctest::Approx(255 * 0.82).epsilon(0.01));

  ScenePlate covered = clean;
  covered.finish.cover = Cover{{-0.012, -0.012, 0.1, 0.192}, 0.3};
  const View cover = render(covered);
  CHECK(level_at(cover, 0.02, 0.08) == doctest::Approx(255 * 0.3).epsilon(0.02));
  CHECK(cover.plates[0].visible_fraction == doctest::Approx(1 - 0.1 / 0.367).epsilon(0.03));

  ScenePlate shaded = clean;
  shaded.finish.white_reflectance = 0.5;
  shaded.finish.shading = {-1.0, 0};
  const View shade = render(shaded);
  CHECK(level_at(shade, 0.01, 0.01) > 255 * 0.5 * 1.3);
  CHECK(level_at(shade, 0.333, 0.01) < 255 * 0.5 * 0.7);

  ScenePlate bright = clean;
  bright.finish.white_reflectance = 0.4;
  bright.finish.glare = Glare{{0.02, 0.08}, 0.01, 0.4};
  const View glare = render(bright);
  CHECK(level_at(glare, 0.02, 0.08) == doctest::Approx(255 * 0.8).epsilon(0.03));
  CHECK(level_at(glare, 0.333, 0.01) == doctest::Approx(255 * 0.4).epsilon(0.02));

  double before = 0;
  for (const double amount : {0.2, 0.5, 0.8}) {
    ScenePlate dirty = clean;
    dirty.finish.dirt = {amount, 0.02, 0.82, 9};  // white dirt hides ink
    const View view = render(dirty);
    double sum = 0;
    for (std::size_t i = 0; i < view.image.samples.size(); ++i) {
      sum += view.image.samples[i] - plain.image.samples[i];
    }
    CAPTURE(amount);
    CHECK(sum > before);
    before = sum;
  }
}

TEST_CASE("A nearer plate hides the one behind it") {
  const Camera camera = camera_of(500, 400);
  const std::vector<ScenePlate> plates{plate_at(camera, {250, 200}, 1.6, 0, 0, 0),
                                       plate_at(camera, {250, 200}, 3.2, 0, 0, 0)};
  const View view = render_view(camera, plates, plain_options());
  CHECK(view.plates[0].visible_fraction == doctest::Approx(1));
  CHECK(view.plates[1].visible_fraction == 0);
  const std::vector<ScenePlate> front{plates[0]};
  CHECK(render_view(camera, front, plain_options()).image.samples == view.image.samples);
}

TEST_CASE("A backdrop nearer than the plate hides it, one behind it does not") {
  const Camera camera = camera_of(300, 200);
  const std::vector<ScenePlate> plates{plate_at(camera, {150, 100}, 3, 0, 0, 0)};
  Backdrop backdrop{LightImage(300, 200, 0.2F), LightImage(300, 200, 5.0F)};
  CHECK(render_view(camera, plates, plain_options(), &backdrop).plates[0].visible_fraction == 1);
  for (int y = 0; y < 200; ++y) std::fill_n(backdrop.depth.row(y), 150, 2.0F);
  const View view = render_view(camera, plates, plain_options(), &backdrop);
  CHECK(view.plates[0].visible_fraction == doctest::Approx(0.5).epsilon(0.05));
  CHECK(view.image.view().at(100, 45) == 51);
  CHECK(view.image.view().at(200, 45) == std::lround(255 * 0.82));
}

TEST_CASE("Plates behind, beside and around the camera are no trouble") {
  Camera camera = camera_of(200, 120);
  camera.distortion = {-0.35, 0.1, 0, 0, 0};
  const TagDrawing tag = drawing();
  for (const Vector3d& place :
       {Vector3d(0, 0, -1), Vector3d(5, 0, 0), Vector3d(-0.17, -0.08, 0.001),
        Vector3d(-0.17, 0.1, 0), Vector3d(1000, 0, 1), Vector3d(0, 0, 1e6)}) {
    for (const double yaw : {0.0, 1.2, 1.57079, 3.0}) {
      Pose pose;
      pose.rotation = Eigen::AngleAxisd(yaw, Vector3d::UnitY()).toRotationMatrix();
      pose.translation = place;
      const std::vector<ScenePlate> plates{{tag, pose, {}}};
      const View view = render_view(camera, plates, plain_options());
      CHECK(view.image.samples.size() == 200U * 120U);
      CHECK(view.plates[0].visible_fraction >= 0);
      CHECK(view.plates[0].visible_fraction <= 1);
    }
  }
}

TEST_CASE("A plate cut by the image's edge has its corners beyond it") {
  const Camera camera = camera_of(300, 200);
  const std::vector<ScenePlate> plates{plate_at(camera, {299.5, 100}, 3, 0, 0, 0)};
  const View view = render_view(camera, plates, plain_options());
  CHECK(view.plates[0].visible_fraction == doctest::Approx(0.5).epsilon(0.03));
  REQUIRE(view.plates[0].corners[1]);
  const double depth = plates[0].camera_from_plate.translation.z();
  CHECK(view.plates[0].corners[1]->x() == doctest::Approx(299.5 + 1600 * 0.343 / 2 / depth));
  CHECK(view.plates[0].module_px == doctest::Approx(1600 * drawing().module / depth));
}

TEST_CASE("Seen from behind a plate is not drawn") {
  const Camera camera = camera_of(300, 200);
  const std::vector<ScenePlate> plates{plate_at(camera, {150, 100}, 3, 180, 0, 0)};
  const View view = render_view(camera, plates, plain_options());
  CHECK(view.plates[0].visible_fraction == 0);
  CHECK(std::ranges::all_of(view.image.samples, [](std::uint8_t level) { return level == 0; }));
}

TEST_CASE("An independent reader reads the symbols") {
  REQUIRE_MESSAGE(test::has_program("zbarimg"), "install zbar-tools");
  const test::TemporaryFolder folder;
  const Camera camera = camera_of(900, 600);
  struct Case {
    std::string name;
    double distance;
    double yaw_deg;
    double roll_deg;
  };
  for (const Case& c : {Case{"frontal", 1.2, 0, 0}, Case{"turned", 1.2, 20, 0},
                        Case{"rolled", 1.2, 10, 8}, Case{"far", 2.0, 0, 0}}) {
    CAPTURE(c.name);
    ViewOptions options;
    options.sensor.noise_sigma = 2;
    const std::vector<ScenePlate> plates{
        plate_at(camera, {450, 300}, c.distance, c.yaw_deg, 0, c.roll_deg)};
    const std::filesystem::path path = folder.path() / (c.name + ".png");
    REQUIRE(save_gray_image(path, render_view(camera, plates, options).image.view()));
    const test::ProgramOutput output =
        test::run_shell("zbarimg -q --raw -Supca.enable '" + path.string() + "'");
    CHECK(output.out == "012345678905\n");
  }
}

}  // namespace
}  // namespace tagsmith::detail
