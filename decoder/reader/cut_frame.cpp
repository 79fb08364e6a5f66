// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/cut_frame.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

// Which of the picture's borders, left, right, upper, lower, a corner of an outline lies on; -1 for
// none.
int border_at(const GrayView& image, PixelPoint corner) {
  const std::array<double, 4> away{corner.x, image.width - 1 - corner.x, corner.y,
                                   image.height - 1 - corner.y};
  for (int i = 0; i < 4; ++i) {
    if (away[static_cast<std::size_t>(i)] < kPart.border_px) return i;
  }
  return -1;
}

}  // namespace

Quad beginning_at(const Quad& quad, std::size_t corner) {
  return {quad[corner % 4], quad[(corner + 1) % 4], quad[(corner + 2) % 4], quad[(corner + 3) % 4]};
}

std::optional<Quad> cut_by_border(const PyramidLevel& level, const Quad& quad) {
  std::array<int, 4> borders{};
  for (std::size_t i = 0; i < 4; ++i) borders[i] = border_at(level.image, quad[i]);
  for (std::size_t i = 0; i < 4; ++i) {
    const bool is_cut = borders[(i + 1) % 4] >= 0 && borders[(i + 1) % 4] == borders[(i + 2) % 4];
    if (!is_cut || borders[i] >= 0 || borders[(i + 3) % 4] >= 0) continue;
    return beginning_at(quad, i);
  }
  return std::nullopt;
}

std::optional<PictureBeside> picture_beside(const GrayView& image, const Quad& outline) {
  const PixelPoint ahead = 0.5 * (outline[1] + outline[2]) - 0.5 * (outline[0] + outline[3]);
  const bool by_columns = std::abs(ahead.x) > std::abs(ahead.y);
  const auto place = [&](PixelPoint at) { return by_columns ? at.x : at.y; };
  const bool keeps_first = place(ahead) > 0;
  const int size = by_columns ? image.width : image.height;
  // The first row or column that the object's blurred edge touches anywhere.
  const auto [least, greatest] = std::minmax({place(outline[1]), place(outline[2])});
  const int limit = keeps_first ? static_cast<int>(std::floor(least - kPart.border_px))
                                : static_cast<int>(std::ceil(greatest + kPart.border_px));
  if (limit < 1 || limit > size - 2) return std::nullopt;
  PictureBeside beside{image, {}, outline};
  for (const auto& [from, to] : {std::pair{0, 1}, std::pair{3, 2}}) {
    const PixelPoint a = outline[static_cast<std::size_t>(from)];
    const PixelPoint b = outline[static_cast<std::size_t>(to)];
    const double share = (limit - place(a)) / (place(b) - place(a));
    if (!(share > 0 && share <= 1)) return std::nullopt;
    beside.quad[static_cast<std::size_t>(to)] = a + share * (b - a);
  }
  const int first = keeps_first ? 0 : limit;
  const int count = keeps_first ? limit + 1 : size - limit;
  (by_columns ? beside.view.width : beside.view.height) = count;
  beside.view.data += by_columns ? first : first * image.stride;
  (by_columns ? beside.first.x : beside.first.y) = first;
  for (PixelPoint& corner : beside.quad) corner = corner - beside.first;
  return beside;
}

std::optional<Quad> completed_by_shape(const Quad& cut, const FrameShape& shape,
                                       const Camera& camera) {
  std::array<Vector3d, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray = ray_through(camera, {cut[i].x, cut[i].y});
    if (!ray) return std::nullopt;
    rays[i] = *ray;
  }
  const Vector3d &p = rays[0], &q = rays[3];
  const Vector3d upper = p.cross(rays[1]), lower = q.cross(rays[2]);
  // Both long sides run where their planes through the camera's centre meet, and the short one at
  // right angles to that.
  Vector3d along = upper.cross(lower).normalized();
  if ((along - along.z() * p).dot(rays[1] - p) < 0) along = -along;
  const Vector3d down = p.cross(q).cross(along).normalized();
  // depth_q * q - depth_p * p = height * down
  Eigen::Matrix<double, 3, 2> sides;
  sides << -p, q;
  Eigen::Vector2d depths =
      (sides.transpose() * sides).inverse() * sides.transpose() * (shape.height * down);
  if (depths[0] < 0 && depths[1] < 0) depths = -depths;
  if (!(depths.minCoeff() > 0)) return std::nullopt;
  const auto f = project(camera, depths[0] * p + shape.length * along);
  const auto r = project(camera, depths[1] * q + shape.length * along);
  if (!f || !r) return std::nullopt;
  const Quad whole{cut[0], {f->x(), f->y()}, {r->x(), r->y()}, cut[3]};
  return is_convex(whole) ? std::optional(whole) : std::nullopt;
}

bool is_in_picture(const GrayView& image, PixelPoint at) {
  return at.x >= -0.5 && at.y >= -0.5 && at.x <= image.width - 0.5 && at.y <= image.height - 0.5;
}

std::optional<RefinedFrame> fit_cut_frame(const GrayView& image, const Quad& corners,
                                          const FrameShape& shape, const LensDistortion& lens,
                                          bool was_sharpened) {
  const auto frame =
      refine_shown_sides(image, corners, {true, false, true, true}, 0, lens, shape, was_sharpened);
  if (!frame || !frame->shown[0] || !frame->shown[2] || !frame->shown[3]) return std::nullopt;
  return *frame;
}

}  // namespace tagsmith::detail
