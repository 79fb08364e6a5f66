// SPDX-License-Identifier: Apache-2.0
// Scenes for POV-Ray: a plate on a rough wall in the light of lamps, with what a tunnel puts on it,
// in front of it and between it and its lamps. POV-Ray traces the rays; of this project the scene
// has the places of the bars alone.
#pragma once

#include <array>
#include <string>

#include "decoder/feature_frame/frame.hpp"
#include "tests/bench/lots.hpp"

namespace tagsmith::detail::raytraced {

// Of every picture: no distortion, the principal point in its middle.
inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
inline constexpr double kFocalLength = 800;

enum class Kind {
  plain,
  lamp,      // a beam whose edge falls on the plate
  gloss,     // a shining plate that a lamp and the tunnel are reflected in
  shadow,    // of pipes between a lamp and the plate
  mesh,      // the shadow of a mesh
  cable,     // one or two before the plate, with their shadows
  dirt,      // a patchy layer
  splashes,  // of mud
  fog,
  motion,   // while exposed
  defocus,  // a disc
  dark,     // few photons
  wet,      // a film of water with ripples, and dirt
};
inline constexpr int kKinds = 13;
inline constexpr std::array<const char*, kKinds> kNames{
    "plain",    "lamp", "gloss",  "shadow",  "mesh", "cable", "dirt",
    "splashes", "fog",  "motion", "defocus", "dark", "wet"};

struct Scene {
  int width = 0, height = 0;  // of the picture, pixels
  std::string source;         // for POV-Ray
  std::string unhidden;       // the same where only the frame shines, for what of it is in sight
  std::string code;           // of the plate
  FrameCorners corners{};     // of its frame, pixels
  double module_px = 0;       // amid the frame
  double incidence = 0;       // radians
};

// A plate tag-400x300 with a random code with the check digit of GS1, at 0.7 to 3.6 pixels a module
// and 0 to 60 degrees; in a picture of `size` times as many pixels along each side, as many times
// that.
Scene draw_scene(Kind kind, int size, mass::Random& random);

}  // namespace tagsmith::detail::raytraced
