// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/raytraced_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/corridor_template.hpp"

namespace tagsmith::detail::raytraced {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using mass::chance;
using mass::integer;
using mass::Random;
using mass::uniform;

constexpr double kMillimetres = 1000;  // POV-Ray's unit here
constexpr double kInk = 0.006;         // how far ink stands before the plate, millimetres

// An object of POV-Ray's language.
template <class... Parts>
std::string block(std::string_view name, const Parts&... parts) {
  std::string text = fmt::format("{}{{", name);
  ((text += ' ', text += parts), ...);
  return text + "}\n";
}

std::string triple(double x, double y, double z) {
  return fmt::format("<{:.5f},{:.5f},{:.5f}>", x, y, z);
}

// In the camera's frame: x right, y down, z forward. POV-Ray's y goes up.
std::string place(const Vector3d& at) { return triple(at.x(), -at.y(), at.z()); }

std::string grey(double value) { return fmt::format("rgb {:.4f}", value); }

std::string matt(double value) {
  return block("texture", block("pigment", grey(value)), block("finish", "diffuse 0.8 ambient 0"));
}

// A plate before the camera, in its own frame (x right, y down, z into the wall, millimetres from
// P).
struct Hung {
  TagDrawing drawing;
  Matrix3d turn;
  Vector3d shift;

  Vector3d in_camera(const Vector3d& on_plate) const { return turn * on_plate + shift; }
  Vector3d on_frame(double across, double down, double away) const {
    const Rectangle& inner = drawing.frame_inner;
    return in_camera({across * inner.width, down * inner.height, -away});
  }
  // From the plate's frame to POV-Ray's.
  std::string matrix() const {
    const Matrix3d& r = turn;
    return fmt::format(
        "matrix<{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.5f},{:.5f},{:.5f}"
        ">",
        r(0, 0), -r(1, 0), r(2, 0), r(0, 1), -r(1, 1), r(2, 1), r(0, 2), -r(1, 2), r(2, 2),
        shift.x(), -shift.y(), shift.z());
  }
};

Eigen::Vector2d pixel_of(const Vector3d& at) {
  return {(kWidth - 1) / 2.0 + kFocalLength * at.x() / at.z(),
          (kHeight - 1) / 2.0 + kFocalLength * at.y() / at.z()};
}

Vector3d amid(const Hung& hung) {
  return {hung.drawing.frame_inner.width / 2, hung.drawing.frame_inner.height / 2, 0};
}

double module_px(const Hung& hung) {
  const Vector3d half{hung.drawing.module / 2, 0, 0};
  return (pixel_of(hung.in_camera(amid(hung) + half)) - pixel_of(hung.in_camera(amid(hung) - half)))
      .norm();
}

Hung hang(const Digits& code, double wanted_px, double incidence, Random& random) {
  Hung hung{moved(draw_tag(test::corridor_template(), code), 0, 0, kMillimetres), {}, {}};
  const double roll = chance(random, 0.6) ? radians(uniform(random, -12, 12))
                                          : uniform(random, 0, 2 * std::numbers::pi);
  const double way =
      radians(uniform(random, -30, 30)) + (chance(random, 0.5) ? std::numbers::pi : 0);
  const Eigen::AngleAxisd to_way(way, Vector3d::UnitZ());
  hung.turn = Eigen::AngleAxisd(roll, Vector3d::UnitZ()) * to_way *
              Eigen::AngleAxisd(incidence, Vector3d::UnitY()) * to_way.inverse().toRotationMatrix();
  double distance = kFocalLength * hung.drawing.module / wanted_px;
  for (int i = 0; i < 8; ++i) {
    hung.shift = Vector3d(0.04, -0.03, 1) * distance - hung.turn * amid(hung);
    distance *= module_px(hung) / wanted_px;
  }
  return hung;
}

std::string rectangle(const Rectangle& area, double front, double back) {
  return block("box", triple(area.x, area.y, front), ",",
               triple(area.x + area.width, area.y + area.height, back));
}

// The frame's strokes and the bars, as thin boxes.
std::string ink_of(const TagDrawing& drawing) {
  const Rectangle &outer = drawing.frame_outer, &inner = drawing.frame_inner;
  const double below = inner.y + inner.height, right = inner.x + inner.width;
  std::vector<Rectangle> parts = drawing.bars;
  parts.push_back({outer.x, outer.y, outer.width, inner.y - outer.y});
  parts.push_back({outer.x, below, outer.width, outer.y + outer.height - below});
  parts.push_back({outer.x, inner.y, inner.x - outer.x, inner.height});
  parts.push_back({right, inner.y, outer.x + outer.width - right, inner.height});
  std::string text;
  for (const Rectangle& part : parts) text += rectangle(part, -kInk, 0);
  return text;
}

// A second texture over that of plate and ink.
std::string layer_of(Kind kind, Random& random) {
  if (kind != Kind::dirt && kind != Kind::wet && kind != Kind::splashes) return {};
  const bool spotted = kind == Kind::splashes;
  const double dark = spotted ? uniform(random, 0.05, 0.3) : uniform(random, 0.1, 0.5);
  const double from = spotted ? 0.72 : 0.9 - uniform(random, 0.25, 0.45);
  const double to = spotted ? 0.74 : from + 0.1 + uniform(random, 0.02, 0.3);
  const std::array<const char*, 3> patterns{"bozo", "granite", "wrinkles"};
  const std::string pattern =
      spotted ? fmt::format("spotted scale {:.2f}", uniform(random, 6, 25))
              : fmt::format("{} scale {:.2f} turbulence 0.6",
                            patterns.at(static_cast<std::size_t>(integer(random, 0, 2))),
                            uniform(random, 32, 240));
  const std::string map =
      fmt::format("[{:.3f} rgbt <0,0,0,1>][{:.3f} rgbt <{:.3f},{:.3f},{:.3f},{:.3f}>]", from, to,
                  dark, dark, dark, spotted ? 0 : uniform(random, 0, 0.5));
  return block("texture", block("pigment", pattern, block("color_map", map)),
               block("finish", "diffuse 1 ambient 0"));
}

std::string plate_of(const Hung& hung, Kind kind, Random& random) {
  const bool shines = kind == Kind::gloss || kind == Kind::wet;
  const std::string finish =
      shines ? fmt::format(
                   "diffuse 1 ambient 0 specular {:.3f} roughness {:.5f} "
                   "reflection{{0,{:.3f} fresnel on}} conserve_energy",
                   uniform(random, 0.05, 0.4), std::pow(10, uniform(random, -2.8, -1.6)),
                   uniform(random, 0.3, 0.9))
             : fmt::format("diffuse 1 ambient 0 specular {:.3f} roughness 0.08",
                           uniform(random, 0, 0.05));
  const std::string layer = layer_of(kind, random);
  const auto surface = [&](double value) {
    return block("texture", block("pigment", grey(value)), block("finish", finish)) + layer;
  };
  return block(
      "union",
      block("object", rectangle(hung.drawing.plate, 0, 3), surface(uniform(random, 0.6, 0.9))),
      block("union", ink_of(hung.drawing), surface(uniform(random, 0.02, 0.08)), "no_shadow"),
      shines ? block("interior", "ior 1.45") : std::string(), hung.matrix());
}

std::string wall_of(const Hung& hung, Random& random) {
  const double bright = uniform(random, 0.05, 0.5);
  const std::string rock =
      fmt::format("granite scale {:.0f} color_map{{[0 {}][1 {}]}}", uniform(random, 50, 900),
                  grey(bright * uniform(random, 0.3, 0.9)), grey(bright));
  const std::array<const char*, 3> reliefs{"bumps", "granite", "wrinkles"};
  const std::string relief = fmt::format(
      "{} {:.2f} scale {:.1f}", reliefs.at(static_cast<std::size_t>(integer(random, 0, 2))),
      uniform(random, 0.3, 1.5), uniform(random, 20, 200));
  return block("box", "<-9000,-9000,6>,<9000,9000,40>",
               block("texture", block("pigment", rock), block("normal", relief),
                     block("finish", "diffuse 0.9 ambient 0")),
               hung.matrix());
}

// Pipes along the wall, beside the plate.
std::string pipes_of(const Hung& hung, Random& random) {
  std::string text;
  for (int count = integer(random, 0, 3); count > 0; --count) {
    const double height = hung.drawing.plate.height;
    const double y =
        (chance(random, 0.5) ? 1 : -1) * uniform(random, 0.55, 1.6) * height + amid(hung).y();
    text += block("cylinder", triple(-4000, y, -uniform(random, 0, 30)), ",",
                  triple(4000, y + uniform(random, -200, 200), -uniform(random, 0, 30)),
                  fmt::format(",{:.1f}", uniform(random, 6, 40)), matt(uniform(random, 0.03, 0.7)),
                  hung.matrix());
  }
  return text;
}

std::string cable_of(const Hung& hung, Random& random) {
  const Rectangle& inner = hung.drawing.frame_inner;
  const double x = uniform(random, -0.1, 1.1) * inner.width,
               y = uniform(random, 0, 1) * inner.height;
  const double angle = uniform(random, 0, std::numbers::pi), radius = uniform(random, 1, 9);
  const double before = uniform(random, radius, 60), bow = uniform(random, -30, 30);
  constexpr int kPoints = 9;
  std::string points = fmt::format("cubic_spline {}", kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double along = -1 + 2.0 * i / (kPoints - 1), sag = bow * (1 - along * along);
    points += "," + triple(x + 700 * along * std::cos(angle) - sag * std::sin(angle),
                           y + 700 * along * std::sin(angle) + sag * std::cos(angle), -before);
    points += fmt::format(",{:.2f}", radius);
  }
  return block("sphere_sweep", points, matt(uniform(random, 0.02, 0.8)), hung.matrix());
}

// Drops of mud that stand on the plate.
std::string drops_of(const Hung& hung, Random& random) {
  std::string text;
  const Rectangle& inner = hung.drawing.frame_inner;
  for (int count = integer(random, 2, 9); count > 0; --count) {
    const double across = uniform(random, 0, inner.width), down = uniform(random, 0, inner.height);
    text +=
        block("sphere", fmt::format("<0,0,0>,{:.2f} scale <1,1,0.2>", uniform(random, 1, 9)),
              "translate", triple(across, down, 0), matt(uniform(random, 0.1, 0.4)), hung.matrix());
  }
  return text;
}

std::string water_of(const Hung& hung, Random& random) {
  Rectangle film = hung.drawing.plate;
  film.width *= uniform(random, 0.3, 1);
  return block(
      "object", rectangle(film, -0.8, -0.05),
      block("texture", block("pigment", "rgbt <1,1,1,0.98>"),
            block("normal", fmt::format("bumps {:.3f} scale {:.1f}", uniform(random, 0.01, 0.08),
                                        uniform(random, 15, 80))),
            block("finish", "ambient 0 diffuse 0.02 specular 0.5 roughness 0.005")),
      block("interior", "ior 1.33"), hung.matrix());
}

// A bar that throws a shadow and is not seen.
std::string shade(const Vector3d& middle, const Vector3d& along, double radius) {
  return block("cylinder", place(middle - 3000 * along), ",", place(middle + 3000 * along),
               fmt::format(",{:.2f}", radius), matt(0.1), "no_image");
}

std::string pipe_shades(const Hung& hung, const Vector3d& lamp, Random& random) {
  std::string text;
  for (int count = integer(random, 1, 2); count > 0; --count) {
    const Vector3d hit = hung.on_frame(uniform(random, 0, 1), uniform(random, 0, 1), 0);
    const double angle = uniform(random, 0, std::numbers::pi);
    text +=
        shade(lamp + (hit - lamp) * uniform(random, 0.35, 0.9),
              hung.turn * Vector3d(std::cos(angle), std::sin(angle), 0), uniform(random, 4, 60));
  }
  return text;
}

std::string mesh_shades(const Hung& hung, const Vector3d& lamp, Random& random) {
  const Vector3d hit = hung.on_frame(uniform(random, 0, 1), uniform(random, 0, 1), 0);
  const Vector3d middle = lamp + (hit - lamp) * uniform(random, 0.5, 0.92);
  const double angle = uniform(random, 0, std::numbers::pi);
  const double pitch = uniform(random, 30, 120), radius = uniform(random, 1, 5);
  const Vector3d one = hung.turn * Vector3d(std::cos(angle), std::sin(angle), 0);
  const Vector3d other = hung.turn * Vector3d(-std::sin(angle), std::cos(angle), 0);
  std::string text;
  for (int i = -12; i <= 12; ++i) {
    text += shade(middle + i * pitch * one, other, radius);
    text += shade(middle + i * pitch * other, one, radius);
  }
  return text;
}

// A lamp; its light falls with the square of the distance and is `strength` at the plate's.
std::string lamp_at(const Hung& hung, const Vector3d& at, double strength,
                    const std::string& more = {}) {
  return block("light_source", place(at), grey(strength),
               fmt::format("fade_distance {:.1f} fade_power 2", hung.in_camera(amid(hung)).norm()),
               more);
}

Vector3d near_camera(Random& random) {
  return {uniform(random, -400, 400), uniform(random, -300, 300), 0};
}

std::string beam(const Hung& hung, Random& random) {
  const Vector3d aim = hung.in_camera(
      amid(hung) + Vector3d(uniform(random, -200, 200), uniform(random, -150, 150), 0));
  return lamp_at(
      hung, near_camera(random), uniform(random, 0.6, 3),
      fmt::format("spotlight point_at {} radius {:.1f} falloff {:.1f} tightness {:.0f}", place(aim),
                  uniform(random, 1, 4), uniform(random, 5, 16), uniform(random, 0, 30)));
}

// A lamp that the plate reflects towards the camera, and its globe.
std::string reflected_lamp(const Hung& hung, Random& random) {
  const Vector3d hit = hung.on_frame(uniform(random, -0.2, 1.2), uniform(random, -0.2, 1.2), 0);
  const Vector3d ray = hit.normalized(), normal = hung.turn.col(2);
  const Vector3d lamp = hit + (ray - 2 * ray.dot(normal) * normal) * uniform(random, 500, 2500);
  return lamp_at(hung, lamp, uniform(random, 0.3, 2)) +
         block("sphere", place(lamp), fmt::format(",{:.1f}", uniform(random, 15, 70)),
               block("texture", block("pigment", grey(1)),
                     block("finish",
                           fmt::format("ambient 0 emission {:.1f}", uniform(random, 1, 5)))),
               "no_shadow");
}

std::string lights_of(const Hung& hung, Kind kind, Random& random) {
  const double strength = uniform(random, 0.1, 0.6);
  if (kind == Kind::dark) return lamp_at(hung, near_camera(random), uniform(random, 0.05, 0.2));
  if (kind == Kind::shadow || kind == Kind::mesh) {
    const Vector3d lamp = hung.in_camera(
        {uniform(random, -600, 1000), -uniform(random, -600, 800), -uniform(random, 700, 2500)});
    const double size = uniform(random, 5, 60);
    // The many wires of a mesh take long; its shadow is cast from fewer places of the lamp.
    const int places = kind == Kind::mesh ? 2 : 4;
    const std::string soft =
        fmt::format("area_light <{:.1f},0,0>,<0,{:.1f},0>,{},{} adaptive 0 jitter circular orient",
                    size, size, places, places);
    return lamp_at(hung, lamp, uniform(random, 0.6, 1.6), soft) +
           lamp_at(hung, near_camera(random), uniform(random, 0.02, 0.3)) +
           (kind == Kind::mesh ? mesh_shades(hung, lamp, random) : pipe_shades(hung, lamp, random));
  }
  const Vector3d above = hung.in_camera(
      {uniform(random, -1500, 1500), -uniform(random, 600, 1500), -uniform(random, 900, 2500)});
  std::string text = lamp_at(hung, above, strength);
  text += kind == Kind::lamp ? beam(hung, random)
                             : lamp_at(hung, near_camera(random), uniform(random, 0.1, 0.8));
  if (kind == Kind::gloss || kind == Kind::wet) text += reflected_lamp(hung, random);
  return text;
}

std::string in_front(const Hung& hung, Kind kind, Random& random) {
  std::string text;
  if (kind == Kind::cable) {
    for (int count = integer(random, 1, 2); count > 0; --count) text += cable_of(hung, random);
  }
  if (kind == Kind::splashes) text += drops_of(hung, random);
  return text;
}

std::string fog_of(const Hung& hung, Random& random) {
  return block("fog",
               fmt::format("fog_type 1 distance {:.1f} color {} turbulence {:.2f} turb_depth 0.5",
                           hung.in_camera(amid(hung)).norm() / uniform(random, 0.2, 1.6),
                           grey(uniform(random, 0.1, 0.6)), uniform(random, 0, 0.4)));
}

std::string camera() {
  return "#version 3.7;\nglobal_settings{assumed_gamma 1.0 max_trace_level 6}\nbackground{rgb "
         "0}\n" +
         block("camera",
               fmt::format(
                   "perspective location 0 direction <0,0,{:.8f}> up <0,1,0> right <{:.8f},0,0>",
                   kFocalLength / kHeight, static_cast<double>(kWidth) / kHeight));
}

}  // namespace

Scene draw_scene(Kind kind, int size, Random& random) {
  Scene scene;
  scene.width = kWidth * size;
  scene.height = kHeight * size;
  scene.incidence = radians(uniform(random, 0, 60));
  const Digits code = bench::random_code(random);
  scene.code = to_string(code);
  const Hung hung = hang(code, mass::log_uniform(random, 0.7, 3.6), scene.incidence, random);
  scene.module_px = module_px(hung) * size;
  const std::array<Eigen::Vector2d, 4> places{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d at = pixel_of(hung.on_frame(places[i].x(), places[i].y(), 0));
    // Places are counted from the middle of a pixel.
    scene.corners[i] = {(at.x() + 0.5) * size - 0.5, (at.y() + 0.5) * size - 0.5};
  }
  const std::string beside = wall_of(hung, random) + pipes_of(hung, random);
  const std::string front = in_front(hung, kind, random);
  scene.source = camera() + (kind == Kind::fog ? fog_of(hung, random) : std::string()) + beside +
                 plate_of(hung, kind, random) + front + lights_of(hung, kind, random) +
                 (kind == Kind::wet ? water_of(hung, random) : std::string());
  scene.unhidden =
      camera() + beside + front +
      block("object", rectangle(hung.drawing.frame_outer, -kInk, 3), block("pigment", grey(1)),
            block("finish", "emission 1 ambient 0 diffuse 0"), hung.matrix());
  return scene;
}

}  // namespace tagsmith::detail::raytraced
