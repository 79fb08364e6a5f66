// SPDX-License-Identifier: Apache-2.0
// The physical geometry of a plate: what templates/*.yaml says, in metres.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

inline constexpr double kMillimetre = 1e-3;

// What is printed for people between the feature frame and the plate's edge.
struct LabelStyle {
  bool shown = true;
  double text_height = 0.008;        // of a capital letter, metres
  std::vector<std::string> lines{};  // with fields (label_fields.hpp); empty = the usual lines
  std::string left = "left";         // words for the side of the drive
  std::string right = "right";
};

// A picture below the feature frame, printed in the colour of the frame.
struct LogoStyle {
  std::filesystem::path file{};  // SVG; empty = none
  double width = 0;              // of the room that it is fitted into, metres
  double height = 0;
};

// A QR symbol below the feature frame.
struct QrStyle {
  double size = 0;                   // of its side with the quiet zone, metres; 0 = none
  std::string content = "{digits}";  // with fields (label_fields.hpp)
};

// A hole for a screw or an anchor; its centre from the plate's centre, to the right and up.
struct DrillHole {
  double right = 0;
  double up = 0;
  double diameter = 0;
};

// How the plate is cut out of its sheet.
struct CutStyle {
  bool contour = false;      // the outline and the holes as a path for a cutting plotter
  double corner_radius = 0;  // of the plate's corners
};

// Lengths in metres as seen facing the plate.
struct TagTemplate {
  std::string name;
  double plate_length = 0;        // L
  double plate_height = 0;        // H
  double frame_inner_length = 0;  // L_CI
  double frame_inner_height = 0;  // H_CI
  double frame_stroke = 0;        // thickness of the feature frame
  double frame_offset_right = 0;  // of the frame's centre from the plate's centre
  double frame_offset_up = 0;
  double quiet_zone_modules = 9;  // between the frame's inner edge and the symbol, left and right
  double margin_modules = 9;      // between the frame's inner edge and the bars, above and below
  LabelStyle label{};
  int dots_per_inch = 0;  // of the printer whose whole dots a module fills; 0 = any printer
  double patch_size = 0;  // side of the white and of the black reference patch; 0 = none
  std::vector<DrillHole> holes{};
  CutStyle cut{};
  LogoStyle logo{};
  QrStyle qr{};
  bool white_on_black = false;   // frame, bars and label are white, the plate is black
  std::string material{};        // what the plate is made of, for who makes it
  std::filesystem::path file{};  // it was read from; empty = from none
};

// Width of one module: inner length / (95 + 2 quiet zones).
double module_width(const TagTemplate& tag);

// Height of the bars: inner height - 2 margins.
double bar_height(const TagTemplate& tag);

}  // namespace tagsmith::detail
