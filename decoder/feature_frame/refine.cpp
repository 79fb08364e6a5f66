// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

// Where frames are fitted, and their proportions.
struct Sight {
  const GrayView& image;
  const FrameShape& shape;
  bool was_sharpened = false;
};

// The frame fitted through one lens, and how its sides differ from that lens.
struct FrameFit {
  RefinedFrame frame;
  std::array<SeenSagitta, 4> bows;
};

// Whether the stroke is only half as thick as guessed: that of a plate seen so obliquely that its
// symbol is narrower than it is high. Then a place that should be deep in the stroke is white.
bool is_half_as_thick(const GrayView& image, const SideLine& side) {
  std::vector<double> contrasts;
  const auto light = [&](double along, double strokes) {
    return sample_bilinear(image, point_on(side, along) + strokes * side.stroke * side.outward);
  };
  for (const double along : {-0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8}) {
    const double white = light(along, -0.4), black = light(along, 0.25);
    contrasts.push_back(light(along, 0.75) - (white + black) / 2);
  }
  return quantile(contrasts, 0.5) > 0;
}

// Side i of a settled frame where it is to be looked for, with the stroke and the bow that it
// should have.
SideLine side_to_fit(const GrayView& image, const Quad& settled, std::size_t i,
                     const FrameShape& shape, const LensDistortion& lens,
                     const SideSagittas& bows) {
  SideLine line = side_of(settled, i, shape);
  const bool may_be_half = !lens.is_calibrated() && line.stroke >= kEdgeFit.thin_stroke;
  if (may_be_half && is_half_as_thick(image, line)) line.stroke /= 2;
  line.taper = taper_of(settled, line, i);
  line.bow = bows[i];
  if (lens.bends()) set_stroke_through(lens, settled, i, shape, line);
  return line;
}

// The blur of a frame from those of its sides: the mean of the middle two, of their logarithms.
double common_blur(const std::vector<FittedSide>& sides) {
  std::vector<double> blurs;
  for (const FittedSide& side : sides) blurs.push_back(side.blur_px());
  std::ranges::sort(blurs);
  return std::sqrt(blurs[1] * blurs[2]);
}

// Pixels: strokes that are thinner are fitted by both of their edges.
double thin_stroke(bool was_sharpened) {
  return was_sharpened ? kSharpening.thin_stroke : kEdgeFit.thin_stroke;
}

// `beyond`: by how much the sides' middles bow beyond what the lens gives.
FrameResult<FrameFit> fit_frame(const Sight& sight, const Quad& settled, const LensDistortion& lens,
                                const std::array<double, 4>& beyond) {
  const double thin = thin_stroke(sight.was_sharpened);
  const SideSagittas bows = sagittas_of(lens, settled);
  std::vector<FittedSide> sides;
  for (std::size_t i = 0; i < 4; ++i) {
    SideLine line = side_to_fit(sight.image, settled, i, sight.shape, lens, bows);
    line.bow.c[0] += beyond[i];
    auto side = FittedSide::fit(sight.image, line, thin);
    if (!side) return fail(FrameFault::side_too_short);
    if (!side->stays_near()) return fail(FrameFault::no_fit);
    sides.push_back(*std::move(side));
  }
  const double blur = common_blur(sides);
  FrameFit result;
  std::array<SideLine, 4> lines{};
  for (std::size_t i = 0; i < 4; ++i) {
    FittedSide& side = sides[i];
    result.bows[i] = side.bow();
    const double correlation = sight.was_sharpened ? side.noise_correlation() : 1;
    if (std::abs(std::log(side.blur_px() / blur)) > kEdgeFit.log_sigma) side.try_blur(blur);
    lines[i] = side.line();
    result.frame.sides[i] = side.side();
    result.frame.sides[i].covariance *= correlation;
  }
  const std::optional<Quad> corners = corners_of(lines);
  if (!corners) return fail(FrameFault::not_closed);
  result.frame.corners = *corners;
  result.frame.lens = lens;
  return result;
}

// Fits the frame through a known lens, and once more with the bows that its sides have where they
// were found: a side's bow grows with its distance from the lens's centre.
FrameResult<RefinedFrame> fit_with_known_lens(const Sight& sight, const Quad& settled,
                                              const LensDistortion& lens) {
  FrameResult<FrameFit> fit = fit_frame(sight, settled, lens, {});
  if (!fit) return tl::unexpected(fit.error());
  if (!lens.bends()) return fit->frame;
  const FrameResult<FrameFit> again = fit_frame(sight, fit->frame.corners, lens, {});
  return again ? again->frame : fit->frame;
}

// What the sides of a frame show about an unknown lens: one lens for all of them, and by how much
// each bows beyond that, because real lenses do not follow one model exactly.
struct ToldLens {
  RadialLens radial;
  std::array<double, 4> beyond{};
};

FrameResult<FrameFit> fit_frame(const Sight& sight, const Quad& settled, PixelPoint centre,
                                const ToldLens& told) {
  const LensDistortion lens = LensDistortion::radial(centre, told.radial.lambda);
  return fit_frame(sight, settled, lens, told.beyond);
}

// By how much a side bows beyond what its lens gives, pixels; zero where that may be noise.
double clear_bow(const SeenSagitta& seen) {
  const double bow = std::abs(seen.beyond);
  return bow > kBeyondNoise * std::sqrt(seen.variance) ? bow : 0;
}

double greatest_clear_bow(const std::array<SeenSagitta, 4>& sides) {
  double greatest = 0;
  for (const SeenSagitta& side : sides) greatest = std::max(greatest, clear_bow(side));
  return greatest;
}

// A line fitted to a bow lies off its ends by two thirds of it.
Eigen::Matrix2d off_by_bow(double variance) {
  return Eigen::Matrix2d::Constant(4.0 / 9 * variance);
}

// What an undetected lens adds to the covariances of sides that were fitted straight.
void add_unseen_lens_doubt(FrameFit& fit, PixelPoint centre) {
  const UnseenLens unseen = unseen_lens(fit.frame.corners, fit.bows, centre);
  fit.frame.lens_doubt = unseen.lambda;
  const double shape = fit.frame.unexplained_bow;
  for (std::size_t i = 0; i < 4; ++i) {
    fit.frame.sides[i].covariance +=
        off_by_bow(unseen.bows[i] * unseen.bows[i]) + Eigen::Matrix2d::Identity() * shape * shape;
  }
}

// What an unknown lens adds to the sides' covariances. Real lenses bow sides in ways that are not
// quite those of the model: by as much as the side that it explains worst.
void add_lens_doubt(FrameFit& fit) {
  const SideSagittas bows = sagittas_of(fit.frame.lens, fit.frame.corners);
  for (std::size_t i = 0; i < 4; ++i) {
    const double shape =
        std::max(kLens.shape * std::abs(bows[i].middle()), fit.frame.unexplained_bow);
    fit.frame.sides[i].covariance +=
        off_by_bow(fit.bows[i].variance) + Eigen::Matrix2d::Identity() * shape * shape;
  }
}

// A frame whose sides are used to estimate the lens.
// Why: docs/decisions/0006-lens-tone-and-shadows.md.
class LensSearch {
 public:
  LensSearch(const Sight& sight, const Quad& settled, PixelPoint centre, double lambda)
      : sight_(sight), centre_(centre), told_{{lambda, 0}, {}} {
    fit_ = fit_frame(sight, settled, centre, told_);
    if (fit_ || lambda == 0) return;
    told_ = {};
    fit_ = fit_frame(sight, settled, centre, told_);
  }

  // Fits the frame and the lens that its sides give in turn, until neither changes.
  FrameResult<RefinedFrame> found() {
    if (!fit_) return tl::unexpected(fit_.error());
    if (!settle_lens()) {
      fit_->frame.unexplained_bow = greatest_clear_bow(fit_->bows);
      add_unseen_lens_doubt(*fit_, centre_);
      return fit_->frame;
    }
    let_bow();
    // The bow of each side gives the lens where one lens for all sides did not converge.
    const double before = told_.radial.lambda;
    const auto radial = lens_of_bows();
    if (radial && std::abs(radial->lambda - before) > radial->sigma && fit_again({*radial, {}}))
      let_bow();
    fit_->frame.unexplained_bow = greatest_clear_bow(bows_beyond_lens());
    add_lens_doubt(*fit_);
    // Only this frame's sides confirm the model, so all of lambda is in doubt.
    fit_->frame.lens_doubt = std::abs(told_.radial.lambda);
    return fit_->frame;
  }

 private:
  bool fit_again(const ToldLens& next) {
    FrameResult<FrameFit> again = fit_frame(sight_, fit_->frame.corners, centre_, next);
    if (!again) return false;
    fit_ = std::move(again);
    told_ = next;
    return true;
  }

  // One lens for all sides; false where they give none.
  bool settle_lens() {
    for (int round = 0; round < kEdgeFit.rounds; ++round) {
      const double now = told_.radial.lambda;
      auto radial = lens_of_bows();
      if (!radial && now == 0) radial = lens_when_bowed();
      if (!radial) return now != 0 && !fit_again({});
      if (std::abs(radial->lambda - now) < radial->sigma || !fit_again({*radial, {}})) break;
    }
    return true;
  }

  // Lets each side bow as much as it shows, whatever the lens.
  void let_bow() {
    for (int round = 0; round < kEdgeFit.rounds; ++round) {
      ToldLens next = told_;
      for (std::size_t i = 0; i < 4; ++i) next.beyond[i] += fit_->bows[i].beyond;
      if (!fit_again(next)) break;
    }
  }

  // By how much the sides bow beyond what the estimated lens gives.
  std::array<SeenSagitta, 4> bows_beyond_lens() const {
    std::array<SeenSagitta, 4> seen = fit_->bows;
    for (std::size_t i = 0; i < 4; ++i) seen[i].beyond += told_.beyond[i];
    return seen;
  }

  std::optional<RadialLens> lens_of_bows() const {
    return lens_of_sides(fit_->frame.corners, bows_beyond_lens(), centre_, told_.radial.lambda);
  }

  // When strongly bowed sides are fitted as straight, parts of them lie on other edges, and no lens
  // explains the result: the lens is estimated once more after each side was allowed to bow. Leaves
  // the frame unchanged where the sides give no lens then either.
  std::optional<RadialLens> lens_when_bowed() {
    if (greatest_clear_bow(fit_->bows) == 0) return std::nullopt;
    const FrameFit straight = *fit_;
    let_bow();
    const auto radial = lens_of_bows();
    if (!radial) {
      fit_ = straight;
      told_ = {};
    }
    return radial;
  }

  const Sight& sight_;
  PixelPoint centre_;
  ToldLens told_;
  FrameResult<FrameFit> fit_;
};

}  // namespace

RefinedFrame turned_to(RefinedFrame frame, std::size_t first) {
  const auto turn = [&](auto& four) {
    std::rotate(four.begin(), four.begin() + static_cast<std::ptrdiff_t>(first), four.end());
  };
  turn(frame.corners);
  turn(frame.sides);
  turn(frame.shown);
  return frame;
}

FrameResult<RefinedFrame> refine_frame(const GrayView& image, const Quad& settled,
                                       const LensGuess& lens, const FrameShape& shape,
                                       bool was_sharpened) {
  const Sight sight{image, shape, was_sharpened};
  const PixelPoint centre{(image.width - 1) / 2.0, (image.height - 1) / 2.0};
  FrameResult<RefinedFrame> frame = lens.known
                                        ? fit_with_known_lens(sight, settled, *lens.known)
                                        : LensSearch(sight, settled, centre, lens.lambda).found();
  if (frame) frame->was_sharpened = was_sharpened;
  return frame;
}

namespace {

// Levels, blur and stroke of a side that is not visible: the mean of the visible ones.
FrameSide hidden_side(const RefinedFrame& frame, double sigma) {
  FrameSide mean;
  double count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!frame.shown[i]) continue;
    const FrameSide& side = frame.sides[i];
    mean.blur_px += side.blur_px;
    mean.stroke_px += side.stroke_px;
    mean.white_begin += (side.white_begin + side.white_end) / 2;
    mean.black_begin += (side.black_begin + side.black_end) / 2;
    ++count;
  }
  mean.blur_px /= count;
  mean.stroke_px /= count;
  mean.white_begin /= count;
  mean.black_begin /= count;
  mean.white_end = mean.white_begin;
  mean.black_end = mean.black_begin;
  mean.covariance = sigma * sigma * Eigen::Matrix2d::Identity();
  return mean;
}

}  // namespace

FrameResult<RefinedFrame> refine_shown_sides(const GrayView& image, const Quad& settled,
                                             const std::array<bool, 4>& shown, double hidden_sigma,
                                             const LensDistortion& lens, const FrameShape& shape,
                                             bool was_sharpened) {
  std::array<SideLine, 4> lines{};
  RefinedFrame frame;
  frame.lens = lens;
  frame.was_sharpened = was_sharpened;
  const SideSagittas bows = sagittas_of(lens, settled);
  double most_doubt = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    lines[i] = side_to_fit(image, settled, i, shape, lens, bows);
    frame.shown[i] = false;
    if (!shown[i]) continue;
    const auto side = FittedSide::fit(image, lines[i], thin_stroke(was_sharpened));
    if (!side || !side->stays_near()) continue;
    const double doubt = clear_bow(side->bow());
    lines[i] = side->line();
    frame.sides[i] = side->side();
    frame.shown[i] = true;
    if (was_sharpened) frame.sides[i].covariance *= side->noise_correlation();
    frame.sides[i].covariance += off_by_bow(doubt * doubt);
    most_doubt = std::max(most_doubt, doubt);
  }
  if (std::ranges::count(frame.shown, true) < 2) {
    return fail(FrameFault::covered);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (frame.shown[i]) continue;
    frame.sides[i] = hidden_side(frame, hidden_sigma);
    frame.sides[i].covariance += off_by_bow(most_doubt * most_doubt);
  }
  const std::optional<Quad> corners = corners_of(lines);
  if (!corners) return fail(FrameFault::not_closed);
  frame.corners = *corners;
  return frame;
}

}  // namespace tagsmith::detail
