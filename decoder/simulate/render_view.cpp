// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/render_view.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "decoder/simulate/coverage.hpp"
#include "decoder/simulate/noise.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Size {
  int width = 0;
  int height = 0;
};

// Pixels of a tile's side when `length` pixels are cut into equal tiles, small enough that a tile's
// cells stay in the processor's second-level cache.
int tile_side(int length) {
  constexpr int kAbout = 40;
  const int count = (length + kAbout - 1) / kAbout;
  return (length + count - 1) / count;
}

struct Bounds {
  Vector2d low = Vector2d::Constant(1e300);
  Vector2d high = Vector2d::Constant(-1e300);
};

Bounds bounds_of(const std::vector<Vector2d>& outline) {
  Bounds bounds;
  for (const Vector2d& point : outline) {
    bounds.low = bounds.low.cwiseMin(point);
    bounds.high = bounds.high.cwiseMax(point);
  }
  return bounds;
}

bool overlap(const Bounds& a, const Bounds& b) {
  return (a.low.array() < b.high.array()).all() && (b.low.array() < a.high.array()).all();
}

// An outline whose area counts with a weight: the frame's inner rectangle takes ink away.
struct Shape {
  double weight = 1;
  std::vector<Vector2d> outline;
  Bounds bounds;
};

// A plate's outlines in the image, by layer.
struct DrawnPlate {
  const ScenePlate* plate = nullptr;
  std::vector<Shape> surface;
  std::vector<Shape> ink;
  std::vector<Shape> cover;
  Bounds bounds;
};

// All that stays the same from tile to tile.
struct Job {
  const Camera& camera;
  const ViewOptions& options;
  const Backdrop* backdrop;
  std::vector<DrawnPlate> plates;  // far to near
  BlurKernel kernel;
  std::vector<float> pixel_kernel;  // the kernel's weights summed over each pixel's cells
  std::vector<Vector2d> shifts;     // of the image during the exposure, pixels
  Size tile;                        // pixels
  Size patch;                       // a tile with the kernel's margin
};

// A tile's square, margin included: pixel (x, y) is its upper left one.
struct Patch {
  int x = 0;
  int y = 0;
};

Rectangle grown(const Rectangle& area, double by) {
  return {area.x - by, area.y - by, area.width + 2 * by, area.height + 2 * by};
}

void add_shape(std::vector<Shape>& layer, const Camera& camera, const ViewingFrustum& frustum,
               const ScenePlate& plate, const Rectangle& area, double weight) {
  Shape shape{weight, outline_in_image(camera, frustum, plate.camera_from_plate, area), {}};
  if (shape.outline.empty()) return;
  shape.bounds = bounds_of(shape.outline);
  layer.push_back(std::move(shape));
}

DrawnPlate draw(const Camera& camera, const ViewingFrustum& frustum, const ScenePlate& plate) {
  DrawnPlate drawn;
  drawn.plate = &plate;
  if (!faces_camera(plate)) return drawn;
  const TagDrawing& drawing = plate.drawing;
  const double spread = 0.5 * plate.finish.bar_growth * drawing.module;
  add_shape(drawn.surface, camera, frustum, plate, drawing.plate, 1);
  if (!drawn.surface.empty()) {
    add_shape(drawn.ink, camera, frustum, plate, grown(drawing.frame_outer, spread), 1);
    add_shape(drawn.ink, camera, frustum, plate, grown(drawing.frame_inner, -spread), -1);
    for (const Rectangle& bar : drawing.bars) {
      add_shape(drawn.ink, camera, frustum, plate, grown(bar, spread), 1);
    }
    if (drawing.patches) {
      add_shape(drawn.ink, camera, frustum, plate, grown(drawing.patches->black, spread), 1);
    }
  }
  if (plate.finish.cover) {
    add_shape(drawn.cover, camera, frustum, plate, plate.finish.cover->area, 1);
  }
  for (const std::vector<Shape>* layer : {&drawn.surface, &drawn.cover}) {
    for (const Shape& shape : *layer) {
      drawn.bounds.low = drawn.bounds.low.cwiseMin(shape.bounds.low);
      drawn.bounds.high = drawn.bounds.high.cwiseMax(shape.bounds.high);
    }
  }
  return drawn;
}

// Equally spaced places along the path, at most a quarter of a pixel apart, about its middle.
std::vector<Vector2d> motion_shifts(const Vector2d& motion_px) {
  const int count = std::clamp(static_cast<int>(std::ceil(4 * motion_px.norm())), 1, 1024);
  std::vector<Vector2d> shifts;
  shifts.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) shifts.push_back(((i + 0.5) / count - 0.5) * motion_px);
  return shifts;
}

// The error of an edge's response falls with (cell / sigma)^2, so wide blurs need few cells.
int cells_for_blur(double sigma_px) {
  if (sigma_px >= 3.0) return 1;
  return sigma_px >= 1.4 ? 2 : 4;
}

std::vector<float> weights_by_pixel(const BlurKernel& kernel) {
  std::vector<float> sums(static_cast<std::size_t>(2 * kernel.radius_px + 1));
  for (std::size_t i = 0; i < kernel.weights.size(); ++i) {
    sums[i / static_cast<std::size_t>(kernel.cells_per_px)] += kernel.weights[i];
  }
  return sums;
}

Job prepare(const Camera& camera, std::span<const ScenePlate> plates, const ViewOptions& options,
            const Backdrop* backdrop) {
  Job job{camera, options, backdrop, {}, {}, {}, {}, {}, {}};
  const SensorModel& sensor = options.sensor;
  job.kernel = blur_kernel(sensor.blur_sigma_px, cells_for_blur(sensor.blur_sigma_px));
  job.pixel_kernel = weights_by_pixel(job.kernel);
  job.shifts = motion_shifts(sensor.motion_px);
  job.tile = {tile_side(camera.width), tile_side(camera.height)};
  const int margin = 2 * job.kernel.radius_px;
  job.patch = {job.tile.width + margin, job.tile.height + margin};
  const double margin_px =
      margin + std::max(job.tile.width, job.tile.height) + 2 + sensor.motion_px.norm();
  const ViewingFrustum frustum = viewing_frustum(camera, margin_px);
  for (const ScenePlate& plate : plates) {
    DrawnPlate drawn = draw(camera, frustum, plate);
    if (!drawn.surface.empty() || !drawn.cover.empty()) job.plates.push_back(std::move(drawn));
  }
  std::ranges::stable_sort(job.plates, std::ranges::greater{}, [](const DrawnPlate& drawn) {
    return frame_middle_in_camera(*drawn.plate).norm();
  });
  return job;
}

// The effect of a plate's surface on light at one pixel.
struct Surface {
  float white = 0;    // light of blank surface
  float ink = 0;      // light of ink minus that of blank surface
  float cover = 0;    // light of the cover
  float visible = 1;  // 0 behind the backdrop
};

double dirt_opacity(const Dirt& dirt, const Vector2d& point) {
  if (dirt.amount <= 0) return 0;
  const Vector2d at = point / dirt.blotch_size;
  const double noise = (2 * value_noise(dirt.seed, at.x(), at.y()) +
                        value_noise(dirt.seed + 1, 2.3 * at.x(), 2.3 * at.y())) /
                       3;
  // The sum of two noises stays away from 0 and 1; the edge of a blotch is soft over 0.1 of it.
  const double level = 0.15 + 0.7 * (1 - std::min(dirt.amount, 1.0));
  return std::clamp((noise - level) / 0.1 + 0.5, 0.0, 1.0);
}

double shading_at(const ScenePlate& plate, const Vector2d& point) {
  const Rectangle& area = plate.drawing.plate;
  const Vector2d part((point.x() - area.x) / area.width - 0.5,
                      (point.y() - area.y) / area.height - 0.5);
  return std::max(0.0, 1.0 + plate.finish.shading.dot(part));
}

double glare_at(const Glare& glare, const Vector2d& point) {
  const double distance = (point - glare.centre).norm() / glare.radius;
  return glare.strength * std::exp(-0.5 * distance * distance);
}

Surface surface_at(const Job& job, const ScenePlate& plate, const Vector2d& pixel) {
  const PlateFinish& finish = plate.finish;
  const std::optional<Vector3d> ray = ray_through(job.camera, pixel);
  const std::optional<double> depth = ray ? depth_on_plate(plate, *ray) : std::nullopt;
  const Vector3d place = depth ? Vector3d(*depth * *ray) : frame_middle_in_camera(plate);
  const Vector2d point = point_on_plate(plate, place);
  const double distance = place.norm();
  const double cosine = plate.camera_from_plate.rotation.col(2).dot(place) / distance;
  const double light =
      irradiance(job.options.lighting, distance, cosine) * shading_at(plate, point);
  const double clean = 1.0 - dirt_opacity(finish.dirt, point);
  const double glare = finish.glare ? light * glare_at(*finish.glare, point) : 0.0;
  double ground = finish.white_reflectance, ink = finish.ink_reflectance;
  if (plate.drawing.white_on_black) std::swap(ground, ink);
  const double soiled = clean * ground + (1 - clean) * finish.dirt.reflectance;
  Surface surface;
  surface.white = static_cast<float>(light * soiled + glare);
  surface.ink = static_cast<float>(light * clean * (ink - ground));
  surface.cover = static_cast<float>(finish.cover ? light * finish.cover->reflectance : 0.0);
  if (job.backdrop != nullptr) {
    const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, job.camera.width - 1);
    const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, job.camera.height - 1);
    const bool hidden = static_cast<double>(job.backdrop->depth.row(y)[x]) < place.z();
    surface.visible = hidden ? 0.0F : 1.0F;
  }
  return surface;
}

bool is_uniform(const Job& job, const ScenePlate& plate) {
  const PlateFinish& finish = plate.finish;
  return job.backdrop == nullptr && job.options.lighting.lamp == 0 && finish.dirt.amount <= 0 &&
         !finish.glare && finish.shading.isZero(0);
}

void add_layer(CoverageGrid& grid, const Job& job, const Patch& patch,
               const std::vector<Shape>& layer) {
  const double cells = job.kernel.cells_per_px;
  const Vector2d corner(patch.x - 0.5, patch.y - 0.5);
  const double share = 1.0 / static_cast<double>(job.shifts.size());
  std::vector<Vector2d> in_cells;
  for (const Shape& shape : layer) {
    for (const Vector2d& shift : job.shifts) {
      const Vector2d origin = corner - shift;
      const Bounds area{origin, origin + Vector2d(job.patch.width, job.patch.height)};
      if (!overlap(area, shape.bounds)) continue;
      in_cells.clear();
      for (const Vector2d& point : shape.outline) in_cells.push_back(cells * (point - origin));
      grid.add(in_cells, shape.weight * share);
    }
  }
  grid.integrate();
}

// Buffers that one tile after the other uses.
struct Workspace {
  explicit Workspace(const Job& job)
      : background(job.patch.width, job.patch.height),
        light(job.patch.width * job.kernel.cells_per_px,
              job.patch.height * job.kernel.cells_per_px),
        rows(light.width, job.tile.height),
        surface(light.width, light.height),
        ink(light.width, light.height),
        cover(light.width, light.height) {}

  LightImage background;  // by pixels
  LightImage light;       // by cells
  LightImage rows;        // filtered downwards: cells wide, pixels high
  CoverageGrid surface;
  CoverageGrid ink;
  CoverageGrid cover;
};

void fill_background(Workspace& work, const Job& job, const LightImage* background,
                     const Patch& patch) {
  for (int y = 0; y < job.patch.height; ++y) {
    float* target = work.background.row(y);
    if (background == nullptr) {
      std::fill_n(target, job.patch.width, static_cast<float>(job.options.background_light));
      continue;
    }
    const float* source = background->row(std::clamp(patch.y + y, 0, background->height - 1));
    for (int x = 0; x < job.patch.width; ++x) {
      target[x] = source[std::clamp(patch.x + x, 0, background->width - 1)];
    }
  }
}

void spread_background(Workspace& work, int cells) {
  for (int y = 0; y < work.light.height; ++y) {
    const float* source = work.background.row(y / cells);
    float* target = work.light.row(y);
    for (int x = 0; x < work.background.width; ++x) {
      std::fill_n(target, cells, source[x]);
      target += cells;
    }
  }
}

bool has_any(const Workspace& work, int x, int y, int cells, bool covered) {
  float sum = 0;
  for (int row = y; row < y + cells; ++row) {
    const float* surface = work.surface.row(row);
    const float* cover = work.cover.row(row);
    for (int column = x; column < x + cells; ++column) {
      sum += surface[column] + (covered ? cover[column] : 0.0F);
    }
  }
  return sum > 1e-6F;
}

void paint_pixel(Workspace& work, int x, int y, int cells, const Surface& at, bool covered) {
  for (int row = y; row < y + cells; ++row) {
    const float* surface = work.surface.row(row);
    const float* ink = work.ink.row(row);
    const float* cover = work.cover.row(row);
    float* light = work.light.row(row);
    for (int column = x; column < x + cells; ++column) {
      const float share = at.visible * surface[column];
      light[column] += share * (at.white - light[column]) + at.visible * ink[column] * at.ink;
      if (covered) light[column] += at.visible * cover[column] * (at.cover - light[column]);
    }
  }
}

void paint_plate(Workspace& work, const Job& job, const Patch& patch, const DrawnPlate& drawn) {
  const int cells = job.kernel.cells_per_px;
  const bool covered = !drawn.cover.empty();
  work.surface.clear();
  work.ink.clear();
  add_layer(work.surface, job, patch, drawn.surface);
  add_layer(work.ink, job, patch, drawn.ink);
  if (covered) {
    work.cover.clear();
    add_layer(work.cover, job, patch, drawn.cover);
  }
  const bool uniform = is_uniform(job, *drawn.plate);
  const Vector2d middle(job.camera.cx, job.camera.cy);
  Surface at = surface_at(job, *drawn.plate, middle);
  for (int y = 0; y < job.patch.height; ++y) {
    for (int x = 0; x < job.patch.width; ++x) {
      if (!has_any(work, x * cells, y * cells, cells, covered)) continue;
      if (!uniform) at = surface_at(job, *drawn.plate, {patch.x + x, patch.y + y});
      paint_pixel(work, x * cells, y * cells, cells, at, covered);
    }
  }
}

// Filters `source` down to pixels, `weights` reaching over whole pixels of `cells` samples each.
// Downwards first, so that the long way goes along rows.
void filter(const LightImage& source, LightImage& rows, const std::vector<float>& weights,
            int cells, LightImage& target, const Patch& tile, const Size& size) {
  const int height = std::min(size.height, target.height - tile.y);
  const int width = std::min(size.width, target.width - tile.x);
  for (int y = 0; y < height; ++y) {
    float* sums = rows.row(y);
    std::fill_n(sums, source.width, 0.0F);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const float* samples = source.row(y * cells + static_cast<int>(k));
      const float weight = weights[k];
      for (int x = 0; x < source.width; ++x) sums[x] += weight * samples[x];
    }
    float* line = target.row(tile.y + y) + tile.x;
    for (int x = 0; x < width; ++x) {
      const float* samples = sums + std::ptrdiff_t{x} * cells;
      float sum = 0;
      for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * samples[k];
      line[x] = sum;
    }
  }
}

void render_tile(Workspace& work, const Job& job, const LightImage* background, const Patch& tile,
                 LightImage& target) {
  const Patch patch{tile.x - job.kernel.radius_px, tile.y - job.kernel.radius_px};
  const double reach = job.options.sensor.motion_px.norm();
  const Bounds area{
      Vector2d(patch.x - 0.5 - reach, patch.y - 0.5 - reach),
      Vector2d(patch.x + job.patch.width + reach, patch.y + job.patch.height + reach)};
  fill_background(work, job, background, patch);
  bool has_plate = false;
  for (const DrawnPlate& drawn : job.plates) {
    if (!overlap(area, drawn.bounds)) continue;
    if (!has_plate) spread_background(work, job.kernel.cells_per_px);
    has_plate = true;
    paint_plate(work, job, patch, drawn);
  }
  if (has_plate) {
    filter(work.light, work.rows, job.kernel.weights, job.kernel.cells_per_px, target, tile,
           job.tile);
  } else {
    filter(work.background, work.rows, job.pixel_kernel, 1, target, tile, job.tile);
  }
}

// The mean of the backdrop over the path, bilinear between pixels.
LightImage moved_background(const LightImage& light, const std::vector<Vector2d>& shifts) {
  LightImage mean(light.width, light.height);
  const float share = 1.0F / static_cast<float>(shifts.size());
  for (const Vector2d& shift : shifts) {
    const int dx = static_cast<int>(std::floor(-shift.x()));
    const int dy = static_cast<int>(std::floor(-shift.y()));
    const auto u = static_cast<float>(-shift.x() - dx);
    const auto v = static_cast<float>(-shift.y() - dy);
    for (int y = 0; y < light.height; ++y) {
      const float* upper = light.row(std::clamp(y + dy, 0, light.height - 1));
      const float* lower = light.row(std::clamp(y + dy + 1, 0, light.height - 1));
      float* target = mean.row(y);
      for (int x = 0; x < light.width; ++x) {
        const int left = std::clamp(x + dx, 0, light.width - 1);
        const int right = std::clamp(x + dx + 1, 0, light.width - 1);
        const float top = upper[left] + u * (upper[right] - upper[left]);
        const float bottom = lower[left] + u * (lower[right] - lower[left]);
        target[x] += share * (top + v * (bottom - top));
      }
    }
  }
  return mean;
}

}  // namespace

LightImage render_light(const Camera& camera, std::span<const ScenePlate> plates,
                        const ViewOptions& options, const Backdrop* backdrop) {
  const Job job = prepare(camera, plates, options, backdrop);
  LightImage moved;
  const LightImage* background = backdrop == nullptr ? nullptr : &backdrop->light;
  if (background != nullptr && job.shifts.size() > 1) {
    moved = moved_background(*background, job.shifts);
    background = &moved;
  }
  LightImage light(camera.width, camera.height);
  Workspace work(job);
  for (int y = 0; y < camera.height; y += job.tile.height) {
    for (int x = 0; x < camera.width; x += job.tile.width) {
      render_tile(work, job, background, {x, y}, light);
    }
  }
  return light;
}

View render_view(const Camera& camera, std::span<const ScenePlate> plates,
                 const ViewOptions& options, const Backdrop* backdrop) {
  const LightImage light = render_light(camera, plates, options, backdrop);
  View view{{}, plate_truths(camera, plates, backdrop)};
  if (!options.sensor.chain) {
    view.image = expose(light, options.sensor, options.seed);
    return view;
  }
  view.image = develop(light, options.sensor, options.seed);
  for (PlateTruth& truth : view.plates) {
    roll_corners(truth, camera.height, options.sensor.chain->rolling_px);
  }
  return view;
}

}  // namespace tagsmith::detail
