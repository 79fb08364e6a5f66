// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/logo.hpp"

#include <algorithm>
#include <array>
#include <cairo.h>
#include <cmath>
#include <cstdint>
#include <dlfcn.h>
#include <memory>
#include <unordered_map>
#include <vector>

#include <librsvg/rsvg.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/late_library.hpp"
#include "tagsmith/render/sheet_on_cairo.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kLongerSide = 2000;  // pixels that the outlines are traced in
constexpr int kMargin = 1;            // white pixels around them, so that all outlines close

// Its functions by their own names: linked, the library would take 2 of the 14 ms of every start of
// the program (docs/decisions/0017-third-party-libraries.md).
struct Librsvg {
  decltype(&::rsvg_handle_new_from_data) open = nullptr;
  decltype(&::rsvg_handle_get_intrinsic_dimensions) dimensions = nullptr;
  decltype(&::rsvg_handle_render_document) render = nullptr;
  decltype(&::g_object_unref) close = nullptr;
};

Result<Librsvg> load_librsvg() {
  void* library = dlopen("librsvg-2.so.2", RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr)
    return fail("a logo needs librsvg (package librsvg2-2), which is missing");
  Librsvg rsvg;
  const bool whole =
      find_function(library, "rsvg_handle_new_from_data", rsvg.open) &&
      find_function(library, "rsvg_handle_get_intrinsic_dimensions", rsvg.dimensions) &&
      find_function(library, "rsvg_handle_render_document", rsvg.render) &&
      find_function(library, "g_object_unref", rsvg.close);
  if (!whole) return fail("a logo needs librsvg 2.46 or newer");
  return rsvg;
}

const Result<Librsvg>& librsvg() {
  static const Result<Librsvg> loaded = load_librsvg();
  return loaded;
}

using SvgPicture = std::unique_ptr<RsvgHandle, void (*)(RsvgHandle*)>;

// How dark the pixels are, 0 to 255.
struct Darkness {
  int width = 0;
  int height = 0;
  std::vector<float> samples{};

  float at(int x, int y) const {
    return samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)];
  }
};

Result<Darkness> darkness_of(RsvgHandle* handle, int width, int height) {
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  const CairoContext context(cairo_create(surface.get()));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  const RsvgRectangle viewport{kMargin, kMargin, width - 2.0 * kMargin, height - 2.0 * kMargin};
  if (librsvg()->render(handle, context.get(), &viewport, nullptr) == 0 ||
      cairo_status(context.get()) != CAIRO_STATUS_SUCCESS) {
    return fail("cannot be drawn");
  }
  cairo_surface_flush(surface.get());
  Darkness dark{width, height};
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  for (int y = 0; y < height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(
        data + static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface.get()));
    for (int x = 0; x < width; ++x) {
      const auto part = [&](int shift) { return static_cast<float>((row[x] >> shift) & 0xff); };
      dark.samples.push_back(255 - (0.2126F * part(16) + 0.7152F * part(8) + 0.0722F * part(0)));
    }
  }
  return dark;
}

// The border of the dark pixels by marching squares. A border crosses the sides of the squares
// between four pixels' centres; a crossing is named by its side.
class Tracer {
 public:
  explicit Tracer(const Darkness& dark) : dark_(dark) {}

  std::vector<std::vector<PlatePoint>> outlines() {
    for (int y = 0; y + 1 < dark_.height; ++y) {
      for (int x = 0; x + 1 < dark_.width; ++x) add_square(x, y);
    }
    std::vector<std::vector<PlatePoint>> outlines;
    while (!next_.empty()) outlines.push_back(follow(next_.begin()->first));
    return outlines;
  }

 private:
  static constexpr float kLevel = 127.5F;

  // Of the square right of and below the pixel: upper, right, lower, left. Twice the pixel's
  // number, and 1 more where the side runs downwards.
  std::int64_t side(int x, int y, int which) const {
    const std::int64_t pixel =
        std::int64_t{which == 2 ? y + 1 : y} * dark_.width + (which == 1 ? x + 1 : x);
    return 2 * pixel + (which % 2);
  }

  // From side to side with the dark on one hand, for each choice of dark corners: upper left 1,
  // upper right 2, lower right 4, lower left 8.
  void add_square(int x, int y) {
    constexpr int kNone = -1;
    constexpr std::array<std::array<int, 4>, 16> kSides{{{kNone, 0, kNone, 0},
                                                         {3, 0, kNone, 0},
                                                         {0, 1, kNone, 0},
                                                         {3, 1, kNone, 0},
                                                         {1, 2, kNone, 0},
                                                         {3, 0, 1, 2},
                                                         {0, 2, kNone, 0},
                                                         {3, 2, kNone, 0},
                                                         {2, 3, kNone, 0},
                                                         {2, 0, kNone, 0},
                                                         {0, 1, 2, 3},
                                                         {2, 1, kNone, 0},
                                                         {1, 3, kNone, 0},
                                                         {1, 0, kNone, 0},
                                                         {0, 3, kNone, 0},
                                                         {kNone, 0, kNone, 0}}};
    const auto bit = [&](int right, int down, unsigned value) {
      return dark_.at(x + right, y + down) > kLevel ? value : 0U;
    };
    const unsigned corners = bit(0, 0, 1) | bit(1, 0, 2) | bit(1, 1, 4) | bit(0, 1, 8);
    const std::array<int, 4>& sides = kSides[corners];
    for (std::size_t i = 0; i < 4 && sides[i] != kNone; i += 2) {
      next_[side(x, y, sides[i])] = side(x, y, sides[i + 1]);
    }
  }

  PlatePoint place(std::int64_t crossing) const {
    const auto pixel = crossing / 2;
    const int x = static_cast<int>(pixel % dark_.width);
    const int y = static_cast<int>(pixel / dark_.width);
    const bool down = crossing % 2 != 0;
    const float here = dark_.at(x, y);
    const float there = down ? dark_.at(x, y + 1) : dark_.at(x + 1, y);
    const double part = (kLevel - here) / (there - here);
    return {x + (down ? 0 : part), y + (down ? part : 0)};
  }

  // Takes the outline that begins there; leaves out points that lie on the line between others.
  std::vector<PlatePoint> follow(std::int64_t from) {
    std::vector<PlatePoint> points;
    for (auto found = next_.find(from); found != next_.end(); found = next_.find(from)) {
      points.push_back(place(from));
      from = found->second;
      next_.erase(found);
    }
    return thinned(points);
  }

  static double distance_from_line(const PlatePoint& p, const PlatePoint& a, const PlatePoint& b) {
    const double x = b.x - a.x, y = b.y - a.y;
    const double length = std::hypot(x, y);
    return length == 0 ? std::hypot(p.x - a.x, p.y - a.y)
                       : std::abs(x * (p.y - a.y) - y * (p.x - a.x)) / length;
  }

  // Each stretch is as long as all that it passes over lie within the tolerance of it.
  static std::vector<PlatePoint> thinned(const std::vector<PlatePoint>& points) {
    constexpr double kTolerance = 0.15;    // pixels
    constexpr std::size_t kLongest = 400;  // points
    std::vector<PlatePoint> kept;
    for (std::size_t from = 0; from < points.size();) {
      kept.push_back(points[from]);
      std::size_t to = from + 1;
      const auto fits = [&](std::size_t end) {
        for (std::size_t i = from + 1; i < end; ++i) {
          if (distance_from_line(points[i], points[from], points[end]) > kTolerance) return false;
        }
        return true;
      };
      while (to + 1 < points.size() && to - from < kLongest && fits(to + 1)) ++to;
      from = to;
    }
    return kept;
  }

  const Darkness& dark_;
  std::unordered_map<std::int64_t, std::int64_t> next_;  // crossing by the one before it
};

// Width over height of the picture; it has a size, or a viewBox.
double aspect_of(RsvgHandle* handle) {
  gboolean has_width = 0, has_height = 0, has_view = 0;
  RsvgLength width{}, height{};
  RsvgRectangle view{};
  librsvg()->dimensions(handle, &has_width, &width, &has_height, &height, &has_view, &view);
  double aspect = has_view != 0 ? view.width / view.height : 0;
  if (has_view == 0 && width.unit == height.unit) aspect = width.length / height.length;
  return aspect > 0 && std::isfinite(aspect) ? std::clamp(aspect, 0.01, 100.0) : 1;
}

Result<LogoDrawing> trace(RsvgHandle* handle, double width, double height) {
  const double aspect = aspect_of(handle);
  const double drawn_width = std::min(width, aspect * height);
  const double drawn_height = drawn_width / aspect;
  const double pixels_per_metre = kLongerSide / std::max(drawn_width, drawn_height);
  const auto pixels = [&](double metres) {
    return static_cast<int>(std::ceil(metres * pixels_per_metre)) + 2 * kMargin;
  };
  const Result<Darkness> dark = darkness_of(handle, pixels(drawn_width), pixels(drawn_height));
  if (!dark) return fail(dark);
  LogoDrawing logo{{0, 0, width, height}, Tracer(*dark).outlines()};
  if (logo.outlines.empty()) return fail("has nothing that is darker than middle grey");
  for (std::vector<PlatePoint>& outline : logo.outlines) {
    for (PlatePoint& p : outline) {  // a pixel's centre is half a pixel from its corner
      p = {(width - drawn_width) / 2 + (p.x + 0.5 - kMargin) / pixels_per_metre,
           (height - drawn_height) / 2 + (p.y + 0.5 - kMargin) / pixels_per_metre};
    }
  }
  return logo;
}

}  // namespace

Result<LogoDrawing> load_logo(const std::filesystem::path& file, double width, double height) {
  constexpr std::size_t kMostBytes = 2'000'000;
  const Result<std::string> bytes = read_file(file);
  if (!bytes) return fail(bytes);
  if (bytes->size() > kMostBytes) return fail(file.string() + ": has more than 2 MB");
  if (!librsvg()) return fail(librsvg().error().message);
  const SvgPicture handle(
      librsvg()->open(reinterpret_cast<const guint8*>(bytes->data()), bytes->size(), nullptr),
      [](RsvgHandle* picture) { librsvg()->close(picture); });
  if (handle == nullptr) return fail(file.string() + ": is no SVG file");
  Result<LogoDrawing> logo = trace(handle.get(), width, height);
  return logo ? std::move(logo) : fail(file.string() + ": " + logo.error().message);
}

LogoDrawing in_room(LogoDrawing logo, const Rectangle& room) {
  for (std::vector<PlatePoint>& outline : logo.outlines) {
    for (PlatePoint& p : outline) p = {p.x + room.x - logo.room.x, p.y + room.y - logo.room.y};
  }
  logo.room = room;
  return logo;
}

}  // namespace tagsmith::detail
