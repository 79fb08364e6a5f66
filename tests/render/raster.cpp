// SPDX-License-Identifier: Apache-2.0
#include "tests/render/raster.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "decoder/image/load.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

void need_program(const std::string& name, const std::string& package) {
  if (!has_program(name)) throw std::runtime_error(name + " is missing: install " + package);
}

Raster load(const std::filesystem::path& path, double dpi) {
  Result<GrayImage> image = load_gray_image(path);
  if (!image) throw std::runtime_error(image.error().message);
  return {*std::move(image), dpi / 25.4};
}

void run(const std::string& command) {
  const ProgramOutput output = run_shell(command);
  if (output.exit_code != 0) throw std::runtime_error(command + ": " + output.err);
}

// First index of each run of samples on one side of half darkness, and the end.
std::vector<std::size_t> run_starts(const std::vector<double>& darkness) {
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 1; i < darkness.size(); ++i) {
    if ((darkness[i] > 0.5) != (darkness[i - 1] > 0.5)) starts.push_back(i);
  }
  starts.push_back(darkness.size());
  return starts;
}

int pixel(const Raster& raster, double metres) {
  return static_cast<int>(std::lround(metres * 1000 * raster.pixels_per_mm));
}

}  // namespace

Raster rasterize_pdf(const std::string& bytes, double dpi) {
  need_program("pdftoppm", "poppler-utils");
  const TemporaryFolder folder;
  const std::string base = (folder.path() / "page").string();
  if (!write_file(base + ".pdf", bytes)) throw std::runtime_error("cannot write " + base);
  run("pdftoppm -r " + std::to_string(dpi) + " -gray -singlefile '" + base + ".pdf' '" + base +
      "'");
  return load(base + ".pgm", dpi);
}

Raster rasterize_svg(const std::string& bytes, double dpi) {
  need_program("rsvg-convert", "librsvg2-bin");
  const TemporaryFolder folder;
  const std::string base = (folder.path() / "page").string();
  if (!write_file(base + ".svg", bytes)) throw std::runtime_error("cannot write " + base);
  const std::string resolution = std::to_string(dpi);
  run("rsvg-convert --dpi-x " + resolution + " --dpi-y " + resolution + " -o '" + base + ".png' '" +
      base + ".svg'");
  return load(base + ".png", dpi);
}

Profile profile_of(const Raster& raster, const Rectangle& strip, bool vertical) {
  const int left = pixel(raster, strip.x);
  const int top = pixel(raster, strip.y);
  const int right = pixel(raster, strip.x + strip.width);
  const int bottom = pixel(raster, strip.y + strip.height);
  Profile profile{{}, (vertical ? top : left) / raster.pixels_per_mm, 1 / raster.pixels_per_mm};
  profile.darkness.assign(static_cast<std::size_t>(vertical ? bottom - top : right - left), 0);
  const double count = vertical ? right - left : bottom - top;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const auto along = static_cast<std::size_t>(vertical ? y - top : x - left);
      profile.darkness[along] += (1 - raster.image.view().at(x, y) / 255.0) / count;
    }
  }
  return profile;
}

std::vector<double> edges_mm(const Profile& profile) {
  const std::vector<double>& dark = profile.darkness;
  const std::vector<std::size_t> starts = run_starts(dark);
  std::vector<double> edges;
  for (std::size_t i = 1; i + 1 < starts.size(); ++i) {
    const std::size_t before = (starts[i - 1] + starts[i]) / 2;
    const std::size_t after = (starts[i] + starts[i + 1]) / 2;
    double position = static_cast<double>(before);
    for (std::size_t at = before; at < after; ++at) {
      position += (dark[at] - dark[after]) / (dark[before] - dark[after]);
    }
    edges.push_back(profile.first_mm + position * profile.step_mm);
  }
  return edges;
}

std::vector<double> lines_mm(const Profile& profile) {
  std::vector<double> lines;
  double mass = 0;
  double moment = 0;
  for (std::size_t i = 0; i <= profile.darkness.size(); ++i) {
    const double dark = i < profile.darkness.size() ? profile.darkness[i] : 0;
    if (dark > 0.02) {
      mass += dark;
      moment += dark * (static_cast<double>(i) + 0.5);
    } else if (mass > 0) {
      lines.push_back(profile.first_mm + moment / mass * profile.step_mm);
      mass = moment = 0;
    }
  }
  return lines;
}

double darkest(const Raster& raster, const Rectangle& rectangle) {
  double dark = 0;
  for (int y = pixel(raster, rectangle.y); y < pixel(raster, rectangle.y + rectangle.height); ++y) {
    for (int x = pixel(raster, rectangle.x); x < pixel(raster, rectangle.x + rectangle.width);
         ++x) {
      dark = std::max(dark, 1 - raster.image.view().at(x, y) / 255.0);
    }
  }
  return dark;
}

Rectangle grown(const Rectangle& rectangle, double by) {
  return {rectangle.x - by, rectangle.y - by, rectangle.width + 2 * by, rectangle.height + 2 * by};
}

double darkest_between(const Raster& raster, const Rectangle& inner, const Rectangle& outer) {
  const double inner_right = inner.x + inner.width;
  const double inner_bottom = inner.y + inner.height;
  return std::max({
      darkest(raster, {outer.x, outer.y, outer.width, inner.y - outer.y}),
      darkest(raster, {outer.x, inner_bottom, outer.width, outer.y + outer.height - inner_bottom}),
      darkest(raster, {outer.x, outer.y, inner.x - outer.x, outer.height}),
      darkest(raster, {inner_right, outer.y, outer.x + outer.width - inner_right, outer.height}),
  });
}

}  // namespace tagsmith::detail::test
