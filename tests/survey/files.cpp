// SPDX-License-Identifier: Apache-2.0
#include "tests/survey/files.hpp"

#include <algorithm>
#include <stdexcept>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail::test {

std::string right_survey() {
  return R"(survey: trial
grid: { x_axis: right }
tunnel:
  width: 4.0
  height: 3.0
  centerline:
    start: [10.0, 20.0, 0.0]
    heading: 0
    elements:
      - { line: 12.0 }
      - { arc: 20.0, turn: left, angle: 30, grade: 1 }
tags:
  template: tag-400x300
  height: 1.4
  spacing: 0.6
  first: 1.0
  pairs: 4
  sigma: 0.003
code: { check_digit: gs1, resolution: 0.01, digits: [4, 4, 3], origin: [0, 0, -1] }
placed:
  - { tag: 001R, side: right, p: [12.0, 22.4, 1.4] }
  - { tag: 004L, side: left, p: [8.0, 25.0, 1.4], digits: "000000000017" }
)";
}

std::string right_rig() {
  return R"(rig: trial
cameras:
  left:
    image_size: [1280, 960]
    focal_length_mm: 6.0
    sensor_mm: [4.8, 3.6]
    alpha: 35
    side: left
  front: { image_size: [1280, 960], fx: 1600, fy: 1601, cx: 640, cy: 480, distortion: [0.1, 0, 0, 0, 0], yaw: 5, pitch: -2, position: [0.5, 0, 0.1], exposure: 0.01, blur_px: 0.5, focus: 3, aperture_mm: 2 }
ranges:
  d: { wall: left, min: 0.25, max: 5.0, sigma: 0.01 }
vehicle: { height: 0.24, roll_sigma: 2, pitch_sigma: 2, envelope: { lateral: 0.4, yaw: 8, speed: 1.5, pitch: 2 } }
)";
}

std::string right_template() {
  return R"(tag: trial
plate: [0.400, 0.300]
feature_frame: { inner: [0.343, 0.168], stroke: 0.012, offset: [0, 0.02] }
symbol: { quiet_zone: 9, margin: 9 }
label: { shown: true, text_height_mm: 8 }
)";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the right file has no \"" + from + "\"");
  return text.replace(at, from.size(), to);
}

std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text) {
  if (const auto written = write_file(path, text); !written) {
    throw std::runtime_error(written.error().message);
  }
  return path;
}

Survey survey_of(const std::string& text) {
  const Diagnosed<Survey> reading = read_survey_text("survey.yaml", text);
  if (!reading.value) throw std::runtime_error(to_string(reading.diagnostics));
  return *reading.value;
}

int count_findings(const std::vector<Diagnostic>& diagnostics, const std::string& code, int line) {
  return static_cast<int>(std::ranges::count_if(diagnostics, [&](const Diagnostic& finding) {
    return finding.code == code && (line < 0 || finding.line == line);
  }));
}

}  // namespace tagsmith::detail::test
