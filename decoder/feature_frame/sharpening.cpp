// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/sharpening.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/edge_samples.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/image/transform.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/geometry/damped_steps.hpp"

namespace tagsmith::detail {
namespace {

// Common to all sides: log blur, amount and log sigma of the mask; of each side: place, log stroke
// and the light of the white inside, the stroke and the white outside.
enum : int { kCommonLogBlur, kCommonAmount, kCommonLogSigma };
enum : int { kSidePlace, kSideLogStroke, kSideWhite, kSideBlack, kSideOutside };
constexpr int kCommon = 3, kOfSide = 5;
constexpr int kSharpenedParameters = kCommon + 4 * kOfSide;
using SharpenedParameters = Eigen::Matrix<double, kSharpenedParameters, 1>;
using ParameterMatrix = Eigen::Matrix<double, kSharpenedParameters, kSharpenedParameters>;
using Common = Eigen::Matrix<double, kCommon, 1>;
using OfSide = Eigen::Matrix<double, kOfSide, 1>;

// Adds `weight` (a + b) of so many levels.
TAGSMITH_WIDE void add_pairs(const float* a, const float* b, float weight, int count, float* to) {
  TAGSMITH_INDEPENDENT_TURNS
  for (int i = 0; i < count; ++i) to[i] += weight * (a[i] + b[i]);
}

// The grey levels across one side, as the camera stores them, and their derivatives by the
// parameters: the common ones first.
class SharpenedProfile {
 public:
  static constexpr int kCurves = 1 + kCommon + kOfSide;  // the levels and the derivatives
  using Values = Eigen::Array<float, kCurves, 1>;

  SharpenedProfile(const ToneCurve& tone, const Common& common, const OfSide& side, float first,
                   float last) {
    const auto sigma = static_cast<float>(std::exp(common[kCommonLogSigma]));
    const auto reach = static_cast<Eigen::Index>(std::ceil(kReach * sigma / kStep));
    begin_ = first - static_cast<float>(reach + 1) * kStep;
    const auto count = static_cast<Eigen::Index>((last - first) / kStep) + 2 * reach + 4;
    curves_.setZero(count, kCurves);
    set_plain(tone, common, side);
    sharpen(static_cast<float>(common[kCommonAmount]), sigma, reach);
  }

  Values at(float across) const {
    const float position = (across - begin_) / kStep;
    const auto index = static_cast<Eigen::Index>(position);
    const float share = position - static_cast<float>(index);
    return curves_.row(index) + share * (curves_.row(index + 1) - curves_.row(index));
  }

 private:
  static constexpr float kStep = 0.25F;  // pixels
  static constexpr float kReach = 2.5F;  // standard deviations of the mask

  using Curve = Eigen::ArrayXf;

  // The levels without a mask.
  void set_plain(const ToneCurve& tone, const Common& common, const OfSide& side) {
    const NormalTable& normal = NormalTable::get();
    const auto per_blur = static_cast<float>(std::exp(-common[kCommonLogBlur]));
    const auto stroke = static_cast<float>(std::exp(side[kSideLogStroke]));
    const auto white = static_cast<float>(side[kSideWhite]),
               black = static_cast<float>(side[kSideBlack]);
    const auto outside = static_cast<float>(side[kSideOutside]);
    for (Eigen::Index i = 0; i < curves_.rows(); ++i) {
      const float across =
          begin_ + static_cast<float>(i) * kStep - static_cast<float>(side[kSidePlace]);
      const float z_inner = across * per_blur, z_outer = (across - stroke) * per_blur;
      const NormalValue inner = normal(z_inner), outer = normal(z_outer);
      const ToneCurve::Point point = tone.point_of(white + (black - white) * inner.integral +
                                                   (outside - black) * outer.integral);
      const float by_inner = point.slope * (black - white) * inner.density;
      const float by_outer = point.slope * (outside - black) * outer.density;
      curves_(i, 0) = point.sample;
      curves_(i, 1 + kCommonLogBlur) = -z_inner * by_inner - z_outer * by_outer;
      curves_(i, 1 + kCommon + kSidePlace) = -per_blur * (by_inner + by_outer);
      curves_(i, 1 + kCommon + kSideLogStroke) = -per_blur * stroke * by_outer;
      curves_(i, 1 + kCommon + kSideWhite) = point.slope * (1 - inner.integral);
      curves_(i, 1 + kCommon + kSideBlack) = point.slope * (inner.integral - outer.integral);
      curves_(i, 1 + kCommon + kSideOutside) = point.slope * outer.integral;
    }
  }

  // Adds so much of what a Gaussian mask takes from each curve.
  void sharpen(float amount, float sigma, Eigen::Index reach) {
    Curve squares = Curve::LinSpaced(reach + 1, 0, static_cast<float>(reach) * kStep / sigma);
    squares = squares.square();
    Curve weights = (-squares / 2).exp();
    weights[0] /= 2;
    weights /= 2 * weights.sum();
    const Curve smooth = smoothed(0, weights);
    const Curve mask = curves_.col(0) - smooth;
    curves_.col(1 + kCommonAmount) = mask;
    if (amount == 0) return;
    const Curve by_sigma = weights * squares;
    curves_.col(1 + kCommonLogSigma) =
        amount * (2 * by_sigma.sum() * smooth - smoothed(0, by_sigma));
    for (int j = 1; j < kCurves; ++j) {
      if (j == 1 + kCommonAmount || j == 1 + kCommonLogSigma) continue;
      curves_.col(j) += amount * (curves_.col(j) - smoothed(j, weights));
    }
    curves_.col(0) += amount * mask;
    for (Eigen::Index i = 0; i < curves_.rows(); ++i) {
      const float level = curves_(i, 0);
      if (level < 0 || level > 255) curves_.row(i).setZero();
      curves_(i, 0) = std::clamp(level, 0.0F, 255.0F);
    }
  }

  // A curve's sums with weights from the middle on; zero within their reach of its ends.
  Curve smoothed(Eigen::Index curve, const Curve& weights) const {
    const Eigen::Index reach = weights.size() - 1, count = curves_.rows() - 2 * reach;
    Curve smooth = Curve::Zero(curves_.rows());
    for (Eigen::Index k = 0; k <= reach; ++k) {
      add_pairs(&curves_(reach - k, curve), &curves_(reach + k, curve), weights[k],
                static_cast<int>(count), &smooth[reach]);
    }
    return smooth;
  }

  float begin_ = 0;
  Eigen::Array<float, Eigen::Dynamic, kCurves> curves_;  // at places kStep apart
};

// The samples across one side, averaged along it.
struct SideProfile {
  const ToneCurve* tone = nullptr;  // of the image
  std::vector<EdgeSample> samples;
  float first = 0, last = 0;
  OfSide guess = OfSide::Zero();
};

SideProfile profile_of(const GrayView& image, const RefinedFrame& frame, std::size_t i,
                       const FrameShape& shape) {
  SideLine side = side_of(frame.corners, i, shape);
  side.bow = sagittas_of(frame.lens, frame.corners)[i];
  SideProfile profile;
  const double stroke = frame.sides[i].stroke_px;
  const double outward = stroke + std::min(kSharpening.beyond_px, 0.75 * stroke);
  profile.samples =
      edge_samples_between(image, side, std::min(kSharpening.beyond_px, 1.5 * side.reach), outward);
  const FrameSide& fitted = frame.sides[i];
  const ToneCurve& tone = ToneCurve::of(image);
  profile.tone = &tone;
  const double middle = (fitted.white_begin + fitted.white_end) / 2;
  const double sample_of_middle = tone.sample_of(middle);
  for (EdgeSample& sample : profile.samples) {
    profile.first = std::min(profile.first, sample.across);
    profile.last = std::max(profile.last, sample.across);
    // As if the side were lit evenly, like its middle.
    const double t = static_cast<double>(sample.along + 1) / 2;
    const double white = fitted.white_begin + t * (fitted.white_end - fitted.white_begin);
    sample.value *= static_cast<float>(sample_of_middle / std::max(1.0, tone.sample_of(white)));
  }
  profile.guess[kSideLogStroke] = std::log(stroke);
  profile.guess[kSideWhite] = profile.guess[kSideOutside] = middle;
  profile.guess[kSideBlack] = (fitted.black_begin + fitted.black_end) / 2;
  return profile;
}

struct Problem {
  std::array<SideProfile, 4> sides;
  SharpenedParameters nominal = SharpenedParameters::Zero();
  SharpenedParameters prior_sigma = SharpenedParameters::Zero();
};

Problem problem_of(const GrayView& image, const RefinedFrame& frame, const FrameShape& shape) {
  Problem problem;
  Common nominal;
  double blur = 0;
  for (std::size_t i = 0; i < 4; ++i) blur += frame.shown[i] ? frame.sides[i].blur_px : 0;
  blur /= static_cast<double>(std::ranges::count(frame.shown, true));
  nominal << std::log(std::max(blur, 0.4)), 0, std::log(kSharpening.usual_px);
  problem.nominal.head<kCommon>() = nominal;
  problem.prior_sigma.head<kCommon>() << 1, 1.5, 0.4;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = static_cast<Eigen::Index>(kCommon + i * kOfSide);
    problem.prior_sigma.segment<kOfSide>(at) << 1, 0.3, 0.5, 0.5, 0.5;
    if (!frame.shown[i]) continue;  // a side without samples, held by its priors
    problem.sides[i] = profile_of(image, frame, i, shape);
    problem.nominal.segment<kOfSide>(at) = problem.sides[i].guess;
  }
  return problem;
}

struct Equations {
  ParameterMatrix matrix = ParameterMatrix::Zero();
  SharpenedParameters right = SharpenedParameters::Zero();
  double cost = 0;
};

// Of one side: residuals by their root weights, and their derivatives by common and own parameters.
void add_side(const Problem& problem, const SharpenedParameters& p, std::size_t i,
              Equations& equations) {
  const SideProfile& side = problem.sides[i];
  if (side.samples.empty()) return;
  const auto at = static_cast<Eigen::Index>(kCommon + i * kOfSide);
  const SharpenedProfile profile(*side.tone, p.head<kCommon>(), p.segment<kOfSide>(at), side.first,
                                 side.last);
  using Terms = Eigen::Matrix<float, kCommon + kOfSide, 1>;
  auto sums = (Terms::Zero() * Terms::Zero().transpose()).eval();
  Terms right_sums = Terms::Zero();
  for (const EdgeSample& sample : side.samples) {
    const SharpenedProfile::Values predicted = profile.at(sample.across);
    const double variance =
        kEdgeFit.least_residual * kEdgeFit.least_residual / static_cast<double>(sample.weight) +
        kSharpening.model * kSharpening.model;
    const auto off = static_cast<double>(sample.value - predicted[0]);
    const double ratio2 = off * off / (kSharpening.dirt * kSharpening.dirt);
    const double root = 1 / std::sqrt(variance * (1 + ratio2));
    const Terms terms = static_cast<float>(root) * predicted.tail<kCommon + kOfSide>().matrix();
    sums += terms.lazyProduct(terms.transpose());
    right_sums += static_cast<float>(root * off) * terms;
    equations.cost += kSharpening.dirt * kSharpening.dirt / variance * std::log1p(ratio2);
  }
  const auto squares = sums.cast<double>().eval();
  const auto right = right_sums.cast<double>().eval();
  equations.matrix.topLeftCorner<kCommon, kCommon>() += squares.topLeftCorner<kCommon, kCommon>();
  equations.matrix.block<kCommon, kOfSide>(0, at) += squares.topRightCorner<kCommon, kOfSide>();
  equations.matrix.block<kOfSide, kCommon>(at, 0) += squares.bottomLeftCorner<kOfSide, kCommon>();
  equations.matrix.block<kOfSide, kOfSide>(at, at) += squares.bottomRightCorner<kOfSide, kOfSide>();
  equations.right.head<kCommon>() += right.head<kCommon>();
  equations.right.segment<kOfSide>(at) += right.tail<kOfSide>();
}

Equations equations_at(const Problem& problem, const SharpenedParameters& p) {
  Equations equations;
  for (std::size_t i = 0; i < 4; ++i) add_side(problem, p, i, equations);
  for (int j = 0; j < kSharpenedParameters; ++j) {
    const double weight = 1 / (problem.prior_sigma[j] * problem.prior_sigma[j]);
    const double off = problem.nominal[j] - p[j];
    equations.matrix(j, j) += weight;
    equations.right[j] += weight * off;
    equations.cost += weight * off * off;
  }
  return equations;
}

void constrain(double most_amount, SharpenedParameters& p) {
  p[kCommonLogBlur] = std::clamp(p[kCommonLogBlur], std::log(0.25), std::log(3.0));
  p[kCommonAmount] = std::clamp(p[kCommonAmount], 0.0, most_amount);
  p[kCommonLogSigma] = std::clamp(p[kCommonLogSigma], std::log(0.5), std::log(4.0));
}

struct SharpenedSolution {
  SharpenedParameters parameters;
  double cost = 0;
};

SharpenedSolution minimise(const Problem& problem, SharpenedParameters p, double most_amount) {
  const Equations found = minimise_damped(
      p, {.settled = 1e-3, .damping = 1e-2},
      [&](const SharpenedParameters& at) { return equations_at(problem, at); },
      [&](SharpenedParameters& at) { constrain(most_amount, at); });
  return {p, found.cost};
}

double sample_count(const Problem& problem) {
  double count = 0;
  for (const SideProfile& side : problem.sides) count += static_cast<double>(side.samples.size());
  return count;
}

// Whether the plain fit leaves residuals that a little sharpening would explain.
bool may_be_sharpened(const Problem& problem) {
  const Equations plain = equations_at(problem, problem.nominal);
  const auto solver = plain.matrix.ldlt();
  const SharpenedParameters step = solver.solve(plain.right);
  const double variance = solver.solve(SharpenedParameters::Unit(kCommonAmount))[kCommonAmount];
  const double noise = std::max(1.0, (plain.cost - plain.right.dot(step)) / sample_count(problem));
  const double amount = step[kCommonAmount];
  return amount > 0 && amount * amount > kSharpening.worth * noise * variance;
}

SharpenedSolution sharpened_fit(const Problem& problem) {
  SharpenedParameters start = problem.nominal;
  start[kCommonAmount] = 0.5;
  return minimise(problem, start, 4);
}

SharpenedSolution plain_fit(Problem problem) {
  problem.prior_sigma[kCommonAmount] = 1e-4;
  return minimise(problem, problem.nominal, 0);
}

}  // namespace

std::optional<Sharpening> sharpening_of(const GrayView& image, const RefinedFrame& frame,
                                        const FrameShape& shape) {
  const Problem problem = problem_of(image, frame, shape);
  if (!may_be_sharpened(problem)) return std::nullopt;
  const SharpenedSolution sharp = sharpened_fit(problem);
  const double noise = std::max(1.0, sharp.cost / sample_count(problem));
  if (plain_fit(problem).cost - sharp.cost < kSharpening.clear * noise) return std::nullopt;
  const SharpenedParameters& p = sharp.parameters;
  Sharpening sharpening{p[kCommonAmount], std::exp(p[kCommonLogSigma]), 0, 0};
  const ToneCurve& tone = ToneCurve::of(image);
  const auto shown = static_cast<double>(std::ranges::count(frame.shown, true));
  for (std::size_t i = 0; i < 4; ++i) {
    if (!frame.shown[i]) continue;
    const auto at = static_cast<Eigen::Index>(kCommon + i * kOfSide);
    sharpening.black += tone.sample_of(p[at + kSideBlack]) / shown;
    sharpening.white += tone.sample_of(p[at + kSideWhite]) / shown;
  }
  return sharpening;
}

void add_halo_doubt(const Quad& before, RefinedFrame& frame) {
  double moved = 0;
  for (std::size_t i = 0; i < 4; ++i) moved += distance(before[i], frame.corners[i]) / 4;
  const double doubt = kSharpening.doubt * moved;
  for (FrameSide& side : frame.sides) {
    side.covariance += Eigen::Matrix2d::Constant(doubt * doubt / kCorner.alike);
  }
}

UnsharpenedImage::UnsharpenedImage(const GrayView& image) : sharp_(image), image_(copy_of(image)) {}

namespace {

// The part of an image around a quadrilateral that its feature frame and halos cover.
PixelBox around(const GrayView& image, const Quad& quad) {
  return box_around(quad, kSharpening.beyond_px + 0.1 * extent_of(quad), image);
}

// Grey levels; a column of the plane is a row of the picture, whose samples are neighbours.
using Plane = Eigen::ArrayXXf;

Plane plane_of(const GrayView& image) {
  Plane plane(image.width, image.height);
  for (Eigen::Index y = 0; y < plane.cols(); ++y) {
    const std::uint8_t* samples = image.row(static_cast<int>(y));
    for (Eigen::Index x = 0; x < plane.rows(); ++x) plane(x, y) = samples[x];
  }
  return plane;
}

// Half of a Gaussian of sum 1, from its middle on.
std::vector<float> gaussian(double sigma) {
  std::vector<float> weights;
  float sum = 0;
  for (int k = 0; k <= static_cast<int>(std::ceil(4 * sigma)); ++k) {
    weights.push_back(static_cast<float>(std::exp(-k * k / (2 * sigma * sigma))));
    sum += (k == 0 ? 1.0F : 2.0F) * weights.back();
  }
  for (float& weight : weights) weight /= sum;
  return weights;
}

// The constants of one iteration: the share that is kept of the sharp picture, the share that is
// added from the smoothed one, and the levels of ink and paper.
struct Round {
  float kept, fed_back, black, white;
};

// What was clipped was darker than 0 or brighter than 255: it lies nearer to black or white.
TAGSMITH_WIDE void next_levels(const float* sharp, const float* smooth, const Round& round,
                               int count, float* plain) {
  const auto [kept, fed_back, black, white] = round;
  TAGSMITH_INDEPENDENT_TURNS
  for (int i = 0; i < count; ++i) {
    float level = kept * sharp[i] + fed_back * smooth[i];
    const float to_black = sharp[i] < 1.5F ? 0.5F : 0.0F;
    level += to_black * ((level > black ? black : level) - level);
    const float to_white = sharp[i] > 253.5F ? 0.5F : 0.0F;
    plain[i] = level + to_white * ((level < white ? white : level) - level);
  }
}

// The rows of a plane within a Gaussian's reach, smoothed along themselves: each is read once, so
// that the plane may change behind them.
class SmoothedRows {
 public:
  SmoothedRows(const Plane& plane, const std::vector<float>& weights)
      : plane_(plane),
        weights_(weights),
        reach_(static_cast<Eigen::Index>(weights.size()) - 1),
        padded_(plane.rows() + 2 * reach_),
        across_(plane.rows(), 2 * reach_ + 1),
        smooth_(plane.rows()) {}

  // Row y of the plane smoothed both ways; rows are requested one after the other. Beyond its
  // borders the plane is continued with its border values.
  const Eigen::ArrayXf& at(Eigen::Index y) {
    const Eigen::Index last = plane_.cols() - 1;
    while (met_ <= std::min(y + reach_, last)) smooth_along(met_++);
    smooth_ = weights_[0] * across(y);
    for (Eigen::Index k = 1; k <= reach_; ++k) {
      add_pairs(across(std::max<Eigen::Index>(y - k, 0)).data(),
                across(std::min(y + k, last)).data(), weights_[static_cast<std::size_t>(k)],
                static_cast<int>(smooth_.size()), smooth_.data());
    }
    return smooth_;
  }

 private:
  Plane::ColXpr across(Eigen::Index y) { return across_.col(y % across_.cols()); }

  void smooth_along(Eigen::Index y) {
    const Eigen::Index width = plane_.rows();
    padded_ << Eigen::ArrayXf::Constant(reach_, plane_(0, y)), plane_.col(y),
        Eigen::ArrayXf::Constant(reach_, plane_(width - 1, y));
    Plane::ColXpr row = across(y);
    row = weights_[0] * plane_.col(y);
    for (Eigen::Index k = 1; k <= reach_; ++k) {
      add_pairs(&padded_[reach_ - k], &padded_[reach_ + k], weights_[static_cast<std::size_t>(k)],
                static_cast<int>(width), row.data());
    }
  }

  const Plane& plane_;
  const std::vector<float>& weights_;
  Eigen::Index reach_;
  Eigen::Index met_ = 0;
  Eigen::ArrayXf padded_;
  Plane across_;  // row y in column y modulo their number
  Eigen::ArrayXf smooth_;
};

}  // namespace

// With y = x + a (x - G x), the picture x is the limit of x <- (y + a G x) / (1 + a).
void UnsharpenedImage::undo(const Sharpening& sharpening, const Quad& quad) {
  constexpr double kAtRest = 0.01;
  const PixelBox area = around(sharp_, quad);
  if (area.width() <= 0 || area.height() <= 0) return;
  const Plane sharp = plane_of(part_of(sharp_, area));
  const std::vector<float> weights = gaussian(sharpening.sigma_px);
  const double kept = 1 / (1 + sharpening.amount);
  const double fed_back = sharpening.amount * kept;
  const Round by{static_cast<float>(kept), static_cast<float>(fed_back),
                 static_cast<float>(sharpening.black), static_cast<float>(sharpening.white)};
  Plane plain = sharp;
  const int rounds =
      std::max(1, static_cast<int>(std::ceil(std::log(kAtRest) / std::log(fed_back))));
  for (int round = 0; round < rounds; ++round) {
    SmoothedRows rows(plain, weights);
    for (Eigen::Index y = 0; y < plain.cols(); ++y) {
      next_levels(&sharp(0, y), rows.at(y).data(), by, static_cast<int>(plain.rows()),
                  &plain(0, y));
    }
  }
  for (Eigen::Index y = 0; y < plain.cols(); ++y) {
    std::uint8_t* samples =
        image_.samples.data() + (area.top + y) * image_.width + std::ptrdiff_t{area.left};
    for (Eigen::Index x = 0; x < plain.rows(); ++x) {
      samples[x] = static_cast<std::uint8_t>(std::clamp(plain(x, y) + 0.5F, 0.0F, 255.0F));
    }
  }
}

void UnsharpenedImage::restore(const Quad& quad) {
  const PixelBox area = around(sharp_, quad);
  for (int y = area.top; y < area.bottom; ++y) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y) * image_.width + area.left;
    std::copy_n(sharp_.row(y) + area.left, std::max(0, area.width()),
                image_.samples.begin() + first);
  }
}

}  // namespace tagsmith::detail
