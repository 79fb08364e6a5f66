// SPDX-License-Identifier: Apache-2.0
// A surveyed drift for tests: its points in a table, and the survey that the program drafts of
// them.
#pragma once

#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {

inline std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  REQUIRE(write_file(path, text));
}

// A drift of 30 m, an arc of 25 m radius to the left over 60 degrees and 20 m more, 1.5 % up.
inline const Centerline& drift() {
  static const Centerline line(
      {452310, 5411220, 312}, radians(20),
      {{30, 0, 0.015}, {25 * radians(60), -1 / 25.0, 0.015}, {20, 0, 0.015}});
  return line;
}

// Point lists of the drift, measured with `noise` metres; `order` as --order.
class PointWriter {
 public:
  PointWriter(double noise, unsigned seed) : noise_(noise), random_(seed) {}

  void add(double chainage, double offset, double height, const std::string& code) {
    const CenterlinePoint at = drift().at(chainage);
    Eigen::Vector3d p = at.position + offset * right_of(at.heading);
    p.z() += height;
    std::normal_distribution<double> error(0, noise_);
    for (double& coordinate : p) coordinate += noise_ > 0 ? error(random_) : 0.0;
    points.push_back({p, code});
  }

  std::string text(const std::string& order) const {
    std::string csv;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& [p, code] = points[i];
      const std::map<char, std::string> fields{{'P', fmt::format("{}", i + 1)},
                                               {'E', fmt::format("{:.3f}", p.x())},
                                               {'N', fmt::format("{:.3f}", p.y())},
                                               {'Z', fmt::format("{:.3f}", p.z())},
                                               {'D', code}};
      std::string row;
      for (const char letter : order) row += (row.empty() ? "" : ",") + fields.at(letter);
      csv += row + "\n";
    }
    return csv;
  }

  struct Point {
    Eigen::Vector3d p;
    std::string code;
  };
  std::vector<Point> points;

 private:
  double noise_;
  std::mt19937 random_;
};

inline PointWriter surveyed_drift(double noise, unsigned seed = 1) {
  PointWriter writer(noise, seed);
  for (int i = 0; i < 24; ++i) writer.add(1 + 3 * i, -2.1, 1.3, "WL rib");
  for (int i = 0; i < 24; ++i) writer.add(1.7 + 3 * i, 2.1, 1.3, "wr");
  for (int i = 0; i < 12; ++i) writer.add(2 + 6 * i, 0.3, 0, "FL");
  for (int i = 0; i < 4; ++i) writer.add(5 + 18 * i, 0, 3.1, "RF");
  for (int i = 0; i < 3; ++i) writer.add(4 + 9 * i, -2.1, 1.4, "TL");
  for (int i = 0; i < 3; ++i) writer.add(4.3 + 9 * i, 2.1, 1.4, "TR");
  return writer;
}

inline ProgramOutput draft(const std::filesystem::path& folder, const std::string& csv,
                           const std::string& arguments) {
  write_text(folder / "points.csv", csv);
  return run_tagsmith("new " + quoted(folder / "out") + " --from " + quoted(folder / "points.csv") +
                      " " + arguments);
}

}  // namespace tagsmith::detail::test
