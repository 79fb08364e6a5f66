// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/frame_bow.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/line_levels.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kSidePlaces = 33;  // along a side

// A side from a to b, and the direction out of the frame.
struct FrameEdge {
  PixelPoint a;
  PixelPoint b;
  PixelPoint out;
};

FrameEdge edge_of(const FrameCorners& corners, std::size_t i) {
  const PixelPoint& a = corners[i];
  const PixelPoint& b = corners[(i + 1) % 4];
  const PixelPoint along = (1 / distance(a, b)) * (b - a);
  const PixelPoint middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  PixelPoint out{along.y, -along.x};
  if (dot(out, a - middle) < 0) out = -1.0 * out;
  return {a, b, out};
}

// Where white turns to black on the way outwards through `at`, pixels from there; nothing without a
// clear edge. White is within `inside`, the stroke within `stroke`. `samples` is a buffer that is
// reused.
std::optional<double> edge_at(const GrayView& image, PixelPoint at, PixelPoint out, double inside,
                              double stroke, std::vector<double>& samples) {
  constexpr double kStep = 0.25;
  constexpr double kLeastContrast = 25;  // grey levels
  const int first = static_cast<int>(std::floor(-inside / kStep));
  const int last = static_cast<int>(std::ceil(stroke / kStep));
  const PlacesOnLine places{at, out, first, kStep};
  const auto is_within = [&](PixelPoint point) {
    return point.x >= 0 && point.y >= 0 && point.x <= image.width - 1 &&
           point.y <= image.height - 1;
  };
  if (!is_within(places.at(0)) || !is_within(places.at(last - first))) return std::nullopt;
  const int count = last - first + 1;
  samples.resize(static_cast<std::size_t>(count));
  sample_line(image, places, samples);
  const auto [black, white] = std::ranges::minmax(samples);
  if (white - black < kLeastContrast) return std::nullopt;
  const double level = (white + black) / 2;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i - 1] < level || samples[i] >= level) continue;
    const double part = (samples[i - 1] - level) / (samples[i - 1] - samples[i]);
    return (first + static_cast<double>(i - 1) + part) * kStep;
  }
  return std::nullopt;
}

// The bow of the parabola through the points (place 0 to 1, distance), of which the worst are left
// out until the rest fit.
std::optional<double> fitted_bow(std::vector<Eigen::Vector2d> points) {
  constexpr double kMostScatter = 0.35;  // pixels, root mean square
  constexpr std::size_t kLeast = kSidePlaces * 2 / 3;
  while (points.size() >= kLeast) {
    const auto count = static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd terms(count, 3);
    Eigen::VectorXd values(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double t = points[static_cast<std::size_t>(i)].x();
      terms.row(i) << 1, t, 4 * t * (1 - t);
      values[i] = points[static_cast<std::size_t>(i)].y();
    }
    const Eigen::Vector3d fit = least_squares(terms, values);
    const Eigen::VectorXd residual = (values - terms * fit).cwiseAbs();
    Eigen::Index worst = 0;
    residual.maxCoeff(&worst);
    if (std::sqrt(residual.squaredNorm() / static_cast<double>(count)) < kMostScatter) {
      return fit[2];
    }
    points.erase(points.begin() + worst);
  }
  return std::nullopt;
}

std::optional<double> bow_of_side(const GrayView& image, const FrameEdge& side, double inside,
                                  double stroke) {
  std::vector<Eigen::Vector2d> points;
  std::vector<double> samples;
  for (int i = 0; i < kSidePlaces; ++i) {
    const double t = 0.04 + 0.92 * i / (kSidePlaces - 1);  // clear of the corners
    const PixelPoint at = side.a + t * (side.b - side.a);
    if (const auto edge = edge_at(image, at, side.out, inside, stroke, samples)) {
      points.emplace_back(t, *edge);
    }
  }
  return fitted_bow(std::move(points));
}

double largest_share(const FrameBow& bow, const FrameCorners& corners) {
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    largest = std::max(largest, std::abs(bow[i]) / distance(corners[i], corners[(i + 1) % 4]));
  }
  return largest;
}

// The rest of the bow when the image is undistorted by the one radial term (about its centre) that
// leaves least: the evidence for a bent plate when the lens is not known.
FrameBow without_radial(const FrameBow& bow, const FrameCorners& corners, int width, int height) {
  const PixelPoint centre{(width - 1) / 2.0, (height - 1) / 2.0};
  const auto shifted = [&](PixelPoint point) {
    const PixelPoint from = point - centre;
    return dot(from, from) * from;
  };
  Eigen::Vector4d by_radial;
  for (std::size_t i = 0; i < 4; ++i) {
    const FrameEdge side = edge_of(corners, i);
    const PixelPoint moved =
        shifted(0.5 * (side.a + side.b)) - 0.5 * (shifted(side.a) + shifted(side.b));
    by_radial[static_cast<Eigen::Index>(i)] = dot(side.out, moved);
  }
  const Eigen::Map<const Eigen::Vector4d> measured(bow.data());
  const double k = by_radial.dot(measured) / std::max(1e-9, by_radial.squaredNorm());
  const Eigen::Vector4d left = measured - k * by_radial;
  return {left[0], left[1], left[2], left[3]};
}

}  // namespace

std::optional<FrameBow> measure_bow(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners) {
  constexpr double kLeastStroke = 3;  // pixels
  FrameBow bow{};
  for (std::size_t i = 0; i < 4; ++i) {
    const FrameEdge side = edge_of(corners, i);
    // Perpendicular to this side a metre has as many pixels as along the two that meet it.
    const double across = distance(corners[(i + 1) % 4], corners[(i + 2) % 4]);
    const double height = i % 2 == 0 ? tag.frame_inner_height : tag.frame_inner_length;
    const double stroke = tag.frame_stroke * across / height;
    const double clear = i % 2 == 0 ? tag.margin_modules : tag.quiet_zone_modules;
    const double inside = 0.8 * clear * module_width(tag) * across / height;
    if (stroke < kLeastStroke) return std::nullopt;
    const auto measured = bow_of_side(image, side, inside, 0.8 * stroke);
    if (!measured) return std::nullopt;
    bow[i] = *measured;
  }
  return bow;
}

FrameBow bow_of_lens(const Camera& camera, const FrameCorners& corners) {
  FrameBow bow{};
  for (std::size_t i = 0; i < 4; ++i) {
    const FrameEdge side = edge_of(corners, i);
    const auto from = ray_through(camera, {side.a.x, side.a.y});
    const auto to = ray_through(camera, {side.b.x, side.b.y});
    const auto middle = from && to ? project(camera, 0.5 * (*from + *to)) : std::nullopt;
    if (!middle) continue;
    bow[i] = dot(side.out, PixelPoint{middle->x(), middle->y()} - 0.5 * (side.a + side.b));
  }
  return bow;
}

double share_of_bend(const FrameBow& bow, const FrameCorners& corners) {
  double share = 0;
  for (const std::size_t i : {0U, 1U}) {
    if (bow[i] * bow[i + 2] >= 0) continue;  // outwards both or inwards both: not one bend
    const double one = std::abs(bow[i]) / distance(corners[i], corners[i + 1]);
    const double other = std::abs(bow[i + 2]) / distance(corners[i + 2], corners[(i + 3) % 4]);
    share = std::max(share, std::min(one, other));
  }
  return share;
}

std::optional<Finding> find_bent(const PictureEvidence& evidence, const TagEvidence& seen) {
  constexpr double kMostBend = 0.01;
  constexpr double kMostBendOfUnknownLens = 0.02;
  if (!evidence.is_photo) return std::nullopt;
  const Camera* camera = evidence.camera;
  const FrameCorners& corners = seen.tag.corners;
  std::optional<FrameBow> bow = measure_bow(evidence.image, evidence.survey.tag_template, corners);
  if (!bow) return std::nullopt;
  if (camera != nullptr) {
    const FrameBow of_lens = bow_of_lens(*camera, corners);
    for (std::size_t i = 0; i < 4; ++i) (*bow)[i] -= of_lens[i];
  }
  double share = share_of_bend(*bow, corners);
  if (camera == nullptr) {
    const FrameBow left =
        without_radial(*bow, corners, evidence.image.width, evidence.image.height);
    share = std::min(share, largest_share(left, corners));
  }
  const double limit = camera != nullptr ? kMostBend : kMostBendOfUnknownLens;
  if (share <= limit) return std::nullopt;
  return Finding{TagStatus::misprinted, "bent",
                 fmt::format("{} is bent: two opposite sides of its frame bow by {:.1f} % of their "
                             "length, limit {:.0f} %",
                             seen.tag.tag, 100 * share, 100 * limit)};
}

}  // namespace tagsmith::detail
