// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/calibrate_camera.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/QR>
#include <fmt/format.h>

#include "decoder/calibrate/start_calibration.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/cli/parallel.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr int kResiduals = 8;               // of a tag
constexpr double kMedianChiSquare = 7.344;  // of eight degrees of freedom
constexpr double kHuber = 3 * 2.8;          // eight residuals have the length 2.8

// --- misfits ---

// Of all tags of a sighting, used or not.
std::vector<double> chi_squares_of(const CalibrationProblem& problem, const CalibrationState& state,
                                   std::size_t sighting) {
  std::vector<double> chi_squares;
  for (const TagObservation& tag : problem.sightings[sighting].tags) {
    chi_squares.push_back(tag_chi_square(problem, state, sighting, tag));
  }
  return chi_squares;
}

// By how much residuals are larger than stated, by the median tag; at least 1.
double robust_factor(const CalibrationProblem& problem, const CalibrationState& state) {
  std::vector<double> chi_squares;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (!problem.sightings[i].used) continue;
    std::ranges::copy(chi_squares_of(problem, state, i), std::back_inserter(chi_squares));
  }
  if (chi_squares.empty()) return 1;
  return std::sqrt(std::max(1.0, quantile(chi_squares, 0.5) / kMedianChiSquare));
}

// Beyond this a tag of so many is worse than one set of photos in a hundred would show by chance:
// the normal quantile of one in a hundred times their number.
double outlier_limit(std::size_t tags) {
  const double p = 0.01 / static_cast<double>(std::max<std::size_t>(tags, 1));
  // Abramowitz and Stegun 26.2.23, to 4.5e-4.
  const double t = std::sqrt(-2 * std::log(p));
  const double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                           (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  return chi_square_limit(kResiduals, z);
}

std::size_t count_tags(const CalibrationProblem& problem) {
  std::size_t count = 0;
  for (const BoardSighting& sighting : problem.sightings) count += sighting.tags.size();
  return count;
}

std::size_t count_used(const BoardSighting& sighting) {
  return static_cast<std::size_t>(
      std::ranges::count_if(sighting.tags, [](const TagObservation& tag) { return tag.used; }));
}

// Marks the tags that do not fit, of photos that do. True when any mark changed.
bool mark_tags(CalibrationProblem& problem, const CalibrationState& state, double factor) {
  const double limit = outlier_limit(count_tags(problem)) * factor * factor;
  bool changed = false;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    for (TagObservation& tag : problem.sightings[i].tags) {
      const bool fits =
          !problem.sightings[i].used || tag_chi_square(problem, state, i, tag) <= limit;
      changed = changed || fits != tag.used;
      tag.used = fits;
    }
  }
  return changed;
}

// Marks the sightings whose median tag is off three times as far as that of the median sighting, in
// standard deviations: no noise of a photo is so large, but a moved board or another focus is.
bool mark_sightings(CalibrationProblem& problem, const CalibrationState& state) {
  constexpr double kWorse = 3;
  std::vector<double> medians;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    std::vector<double> chi_squares = chi_squares_of(problem, state, i);
    medians.push_back(quantile(chi_squares, 0.5));
  }
  std::vector<double> sorted = medians;
  const double usual = std::max(quantile(sorted, 0.5), kMedianChiSquare);
  bool changed = false;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const bool fits = medians[i] <= kWorse * kWorse * usual;
    changed = changed || fits != problem.sightings[i].used;
    problem.sightings[i].used = fits;
  }
  return changed;
}

// --- the fits ---

// A rich form fitted robustly from a rough start; its problem has the misfits marked.
struct RobustFit {
  CalibrationProblem problem;
  CalibrationState state;
  std::size_t parameters = 0;  // of the lens form
};

// Chi-square of all tags, with residuals so much larger than stated, a misfit counted as the least
// misfit, plus ln(residuals) a parameter (as TriedForm::bic). By AIC one tag near the border that
// is off was enough for a form with a pole beside it, which leaves the rays beyond unknown.
double robust_bic(const RobustFit& fit, double factor) {
  const std::size_t tags = count_tags(fit.problem);
  const double most = outlier_limit(tags);
  double bic =
      static_cast<double>(fit.parameters) * std::log(static_cast<double>(kResiduals * tags));
  for (std::size_t i = 0; i < fit.problem.sightings.size(); ++i) {
    for (const double chi_square : chi_squares_of(fit.problem, fit.state, i)) {
      bic += std::min(chi_square / (factor * factor), most);
    }
  }
  return bic;
}

// With tags that count linearly beyond three standard deviations, in steps: the median tag gives
// the standard deviation each time.
RobustFit robust_fit(const CalibrationProblem& problem, const CalibrationState& start,
                     const LensForm& lens) {
  constexpr int kRounds = 6;
  RobustFit fit{problem, start, lens.coefficients};
  AdjustmentOptions options{{lens, false}};
  options.huber = kHuber;
  for (int round = 0; round < kRounds; ++round) {
    options.scale = robust_factor(fit.problem, fit.state);
    fit.state = adjust_calibration(fit.problem, fit.state, options).state;
    const double factor = robust_factor(fit.problem, fit.state);
    const bool sightings = round > 0 && mark_sightings(fit.problem, fit.state);
    const bool tags = round > 0 && mark_tags(fit.problem, fit.state, factor);
    if (round > 0 && !sightings && !tags && factor > 0.9 * options.scale) break;
  }
  return fit;
}

// The farthest corner that fits, from the principal point.
double seen_radius(const CalibrationProblem& problem, const Camera& camera) {
  double farthest = 0;
  for (const BoardSighting& sighting : problem.sightings) {
    if (!sighting.used) continue;
    for (const TagObservation& tag : sighting.tags) {
      if (!tag.used) continue;
      for (Index i = 0; i < 4; ++i) {
        const Vector2d corner = tag.pixels.segment<2>(2 * i) - Vector2d(camera.cx, camera.cy);
        farthest = std::max(farthest, corner.norm());
      }
    }
  }
  return farthest;
}

// The eight-parameter form whose curve is the fisheye's up to the angle `outermost`: its six radial
// coefficients by linear least squares from r (1 + k1 s + k2 s^2 + k3 s^3) =
// d (1 + k4 s + k5 s^2 + k6 s^3), where r is the tangent of an angle, s its square and d the
// distorted radius.
Camera as_perspective(const Camera& fisheye, double outermost) {
  constexpr int kPoints = 40;
  Eigen::Matrix<double, kPoints, 6> rows;
  Eigen::Matrix<double, kPoints, 1> right;
  for (int i = 0; i < kPoints; ++i) {
    const double r = std::tan(outermost * (i + 1) / kPoints);
    const double s = r * r;
    const double d = (project(fisheye, {r, 0, 1})->x() - fisheye.cx) / fisheye.fx;
    rows.row(i) << r * s, r * s * s, r * s * s * s, -d * s, -d * s * s, -d * s * s * s;
    right[i] = d - r;
  }
  const Eigen::Matrix<double, 6, 1> k = rows.completeOrthogonalDecomposition().solve(right);
  Camera camera = fisheye;
  camera.lens = LensModel::perspective;
  camera.distortion = {k[0], k[1], 0, 0, k[2], k[3], k[4], k[5]};
  return camera;
}

// The eight-parameter form from where the fisheye ended; nothing beyond 80 degrees from the axis,
// where a plane z = 1 cannot be followed.
std::optional<RobustFit> perspective_like(const CalibrationProblem& problem,
                                          const RobustFit& fisheye) {
  constexpr double kWidest = 1.4;  // radians
  const Camera& camera = fisheye.state.camera;
  const double farthest = seen_radius(fisheye.problem, camera);
  const auto ray = ray_through(camera, {camera.cx + farthest, camera.cy});
  if (!ray) return std::nullopt;
  const double outermost = std::atan2(ray->x(), ray->z());
  if (outermost > kWidest) return std::nullopt;
  CalibrationState start = fisheye.state;
  start.camera = as_perspective(camera, outermost);
  return robust_fit(problem, start, lens_forms(LensModel::perspective).back());
}

// The best fit, and that of the other lens model.
struct BestFits {
  RobustFit better;
  RobustFit other;
  bool comparable = false;
};

BestFits best_fits(const CalibrationProblem& problem) {
  constexpr double kComparable = 1.5;  // of residuals: the best form is never so far off
  const auto perspective = lens_forms(LensModel::perspective);
  const auto fit_from_grid = [&](LensModel lens, const LensForm& form) {
    return robust_fit(problem, start_calibration(problem, lens), form);
  };
  // Fisheye, perspective; then the eight-parameter form, which may bend where no corner is, from
  // where they ended. It counts where no other form explains as much: tags near the border of a
  // wide picture may contradict all other forms.
  std::vector<RobustFit> fits{fit_from_grid(LensModel::fisheye, lens_forms(LensModel::fisheye)[2]),
                              fit_from_grid(LensModel::perspective, perspective[4])};
  fits.push_back(robust_fit(problem, fits[1].state, perspective.back()));
  if (auto like = perspective_like(problem, fits[0])) fits.push_back(std::move(*like));
  double factor = std::numeric_limits<double>::infinity();
  for (const RobustFit& fit : fits)
    factor = std::min(factor, robust_factor(fit.problem, fit.state));
  std::vector<double> costs;
  for (const RobustFit& fit : fits) costs.push_back(robust_bic(fit, factor));
  const auto best = static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin());
  const std::size_t other = best == 0 ? 1 : 0;
  return {fits[best], fits[other], costs[other] < kComparable * kComparable * costs[best]};
}

struct FormFit {
  TriedForm tried;
  CalibrationState state;
  int degrees_of_freedom = 0;
};

// Residuals minus parameters. A parameter with a prior counts as a residual, too.
int degrees_of_freedom(const CalibrationProblem& problem, const CameraForm& form) {
  constexpr int kPose = 6;
  int degrees = form.square_pixels ? -1 : -2;
  for (const BoardSighting& sighting : problem.sightings) {
    if (!sighting.used) continue;
    degrees += kResiduals * static_cast<int>(count_used(sighting)) - kPose;
  }
  return degrees;
}

FormFit fit_form(const CalibrationProblem& problem, const CalibrationState& start,
                 const CameraForm& form) {
  const CalibrationFit fit = adjust_calibration(problem, start, {form});
  FormFit result;
  result.tried.form = form;
  result.tried.camera = fit.state.camera;
  result.tried.chi_square = fit.cost;
  result.state = fit.state;
  result.degrees_of_freedom = degrees_of_freedom(problem, form);
  return result;
}

// A start for a form with square pixels that has more or fewer coefficients: those that it does not
// have are zero.
CalibrationState restricted(CalibrationState state, const LensForm& lens) {
  state.camera.fx = state.camera.fy = (state.camera.fx + state.camera.fy) / 2;
  for (std::size_t i = 0; i < state.camera.distortion.size(); ++i) {
    if ((lens.free >> i & 1U) == 0) state.camera.distortion[i] = 0;
  }
  return state;
}

// Every form of the lens with one focal length, and with two where it is not far from the best. All
// start from the rich fit, the richest from the one before it, too.
std::vector<FormFit> fit_forms(const CalibrationProblem& problem, const CalibrationState& rich) {
  const auto lenses = lens_forms(rich.camera.lens);
  std::vector<FormFit> fits;
  for (const LensForm& lens : lenses) {
    fits.push_back(fit_form(problem, restricted(rich, lens), {lens, true}));
  }
  const FormFit richest = fit_form(problem, fits[fits.size() - 2].state, fits.back().tried.form);
  if (richest.tried.chi_square < fits.back().tried.chi_square) fits.back() = richest;
  constexpr double kHopeless =
      10;  // times the least chi-square: square pixels are never so far off
  const std::size_t square = fits.size();
  double least = std::numeric_limits<double>::infinity();
  for (const FormFit& fit : fits) least = std::min(least, fit.tried.chi_square);
  for (std::size_t i = 0; i < square; ++i) {
    if (fits[i].tried.chi_square > kHopeless * least) continue;
    fits.push_back(fit_form(problem, fits[i].state, {lenses[i], false}));
  }
  return fits;
}

double factor_of(const FormFit& fit) {
  return std::sqrt(std::max(1.0, fit.tried.chi_square / std::max(fit.degrees_of_freedom, 1)));
}

// Fills bic and weight; the place of the least.
std::size_t weigh(std::vector<FormFit>& fits) {
  const double least_factor = factor_of(*std::ranges::min_element(fits, {}, factor_of));
  for (FormFit& fit : fits) {
    const double residuals = fit.degrees_of_freedom + 1.0;
    fit.tried.bic = fit.tried.chi_square / (least_factor * least_factor) +
                    static_cast<double>(fit.tried.form.parameters()) * std::log(residuals);
  }
  const auto best =
      std::ranges::min_element(fits, {}, [](const FormFit& fit) { return fit.tried.bic; });
  const auto akaike = [&](const FormFit& fit) {
    return fit.tried.chi_square / (least_factor * least_factor) +
           2 * static_cast<double>(fit.tried.form.parameters());
  };
  const double least = akaike(*std::ranges::min_element(fits, {}, akaike));
  double sum = 0;
  for (FormFit& fit : fits) {
    fit.tried.weight = std::exp((least - akaike(fit)) / 2);
    sum += fit.tried.weight;
  }
  for (FormFit& fit : fits) fit.tried.weight /= sum;
  return static_cast<std::size_t>(best - fits.begin());
}

// --- the result ---

CameraCovariance covariance_of(const CalibrationPrecision& precision, const CameraForm& form) {
  const auto basis = free_parameters(form);
  return basis * precision.shared.topLeftCorner(basis.cols(), basis.cols()) * basis.transpose();
}

double tilt_of(const Pose& camera_from_middle) {
  return std::acos(std::clamp(camera_from_middle.rotation(2, 2), -1.0, 1.0));
}

void add_sightings(CameraCalibration& result, const CalibrationProblem& problem,
                   const CalibrationState& state, const CalibrationPrecision& precision) {
  const double raised = result.sigma_factor * result.sigma_factor;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const BoardSighting& sighting = problem.sightings[i];
    const SightingState& fitted = state.sightings[i];
    CalibratedSighting one;
    one.view = sighting.view;
    one.board = sighting.board;
    one.used = sighting.used;
    one.camera_from_board = camera_from_board(problem.planes[sighting.board], fitted);
    one.covariance = raised * precision.sightings[i].topLeftCorner<6, 6>();
    one.edge_px = mean_edge(problem, state, i);
    one.tags_used = count_used(sighting);
    one.tilt = tilt_of(fitted.camera_from_middle);
    one.own_camera = precision.own_cameras[i];
    one.own_camera.focal_sigma *= result.sigma_factor;
    one.own_camera.chi_square /= raised;
    for (const TagObservation& tag : sighting.tags) {
      TagResidual residual{sighting.view, sighting.board, tag.tag, tag.pixels};
      residual.residual =
          residual_of(problem, state, i, tag).value_or(CornerPixels(CornerPixels::Zero()));
      residual.chi_square = tag_chi_square(problem, state, i, tag);
      residual.used = tag.used && sighting.used;
      if (tag.used) one.chi_square += residual.chi_square;
      result.residuals.push_back(residual);
    }
    result.sightings.push_back(one);
  }
}

void add_boards(CameraCalibration& result, const CalibrationState& state,
                const CalibrationPrecision& precision) {
  const Index first = result.form.parameters();
  for (std::size_t b = 0; b < state.shapes.size(); ++b) {
    const Eigen::VectorXd sigma =
        result.sigma_factor *
        precision.shared.diagonal()
            .segment<kShapeParameters>(first + kShapeParameters * static_cast<Index>(b))
            .cwiseSqrt();
    result.boards.push_back({state.shapes[b], {sigma[0], sigma[1], sigma.segment<3>(2), sigma[5]}});
  }
}

double mean_edge(const CameraCalibration& calibration) {
  double sum = 0;
  double tags = 0;
  for (const CalibratedSighting& sighting : calibration.sightings) {
    if (!sighting.used) continue;
    sum += static_cast<double>(sighting.tags_used) * sighting.edge_px;
    tags += static_cast<double>(sighting.tags_used);
  }
  return tags > 0 ? sum / tags : 0;
}

// Photos that contradict the others are placed separately, for the report on them.
void place_unused(const CalibrationProblem& problem, CalibrationState& state,
                  const CameraForm& form) {
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (problem.sightings[i].used) continue;
    CalibrationProblem alone = problem;
    alone.sightings = {problem.sightings[i]};
    alone.sightings.front().used = true;
    CalibrationState one = state;
    one.sightings = {state.sightings[i]};
    AdjustmentOptions options{form, false, false};
    options.huber = kHuber;
    state.sightings[i] = adjust_calibration(alone, one, options).state.sightings.front();
  }
}

// The errors that a photo's corners share are averaged over the photos, not over the corners. At
// least 1.
double photo_factor(const CameraScatter& scatter) {
  return scatter.degrees > 0 ? std::sqrt(std::max(1.0, scatter.chi_square / scatter.degrees)) : 1;
}

// The variance factor of the camera for its next photo.
double raised_by(const CameraScatter& scatter) {
  const double of_mean = std::pow(photo_factor(scatter), 2);
  if (scatter.chi_square <= scatter.limit()) return of_mean;
  return of_mean + static_cast<double>(scatter.photos) * (of_mean - 1);
}

// Whether `form` shows each ray that `chosen` has in a corner of the picture, and has one there
// itself.
bool reaches_as_far(const Camera& form, const Camera& chosen) {
  for (const double x : {0.0, chosen.width - 1.0}) {
    for (const double y : {0.0, chosen.height - 1.0}) {
      const auto ray = ray_through(chosen, {x, y});
      if (ray && !(project(form, *ray) && ray_through(form, {x, y}))) return false;
    }
  }
  return true;
}

// The place of the chosen form, after forms are left out that turn back inside the picture where
// the chosen one does not: no lens does. They stay where the corners read may need a richer form:
// then the rays beyond these corners are unknown.
std::size_t choose(std::vector<FormFit>& fits) {
  constexpr double kLittle = 1.0 / 3;  // of the weight: by chance a rich form has an eighth
  constexpr double kExcluded = 20;     // of BIC: odds of 20 000 against
  const TriedForm chosen = fits[weigh(fits)].tried;
  const auto turns_back = std::ranges::stable_partition(
      fits, [&](const FormFit& fit) { return reaches_as_far(fit.tried.camera, chosen.camera); });
  double weight = 0;
  for (const FormFit& fit : turns_back) {
    if (fit.tried.bic < chosen.bic + kExcluded) weight += fit.tried.weight;
  }
  if (weight < kLittle) fits.erase(turns_back.begin(), turns_back.end());
  return weigh(fits);
}

Result<CameraCalibration> result_of(const CalibrationProblem& problem, std::vector<FormFit> fits) {
  const std::size_t chosen = choose(fits);
  CameraCalibration result;
  for (FormFit& fit : fits) {
    const auto precision = precision_of(problem, fit.state, fit.tried.form);
    const double factor = factor_of(fit);
    if (!precision) continue;
    fit.tried.covariance = factor * factor * covariance_of(*precision, fit.tried.form);
    result.tried.push_back(fit.tried);
  }
  FormFit& best = fits[chosen];
  place_unused(problem, best.state, best.tried.form);
  const auto precision = precision_of(problem, best.state, best.tried.form);
  if (!precision) return fail("the photos do not determine any camera: take 15 of them, tilted");
  result.camera = best.tried.camera;
  result.form = best.tried.form;
  result.covariance = best.tried.covariance;
  result.chi_square = best.tried.chi_square;
  result.degrees_of_freedom = best.degrees_of_freedom;
  result.sigma_factor = factor_of(best);
  add_sightings(result, problem, best.state, *precision);
  const CameraScatter scatter = camera_scatter(result.sightings);
  result.photo_factor = photo_factor(scatter);
  const double raised = raised_by(scatter);
  result.covariance *= raised;
  for (TriedForm& tried : result.tried) tried.covariance *= raised;
  add_boards(result, best.state, *precision);
  result.edge_px = mean_edge(result);
  return result;
}

// Leaves out the photos of another focal length, where they are few enough for the others to be
// believed. True when there are any.
bool leave_out_zoomed(CalibrationProblem& problem, const CameraCalibration& calibration) {
  constexpr double kMost = 1.0 / 3;
  std::vector<std::size_t> zoomed;
  std::size_t used = 0;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (!problem.sightings[i].used) continue;
    ++used;
    if (has_other_focal(calibration.sightings[i])) zoomed.push_back(i);
  }
  if (static_cast<double>(zoomed.size()) > kMost * static_cast<double>(used)) return false;
  for (const std::size_t i : zoomed) problem.sightings[i].used = false;
  return !zoomed.empty();
}

Result<void> check_views(std::span<const BoardView> views) {
  constexpr std::size_t kLeastTags = 4;  // 32 numbers: a pose and a camera of one photo
  std::size_t tags = 0;
  for (const BoardView& view : views) {
    if (view.width != views[0].width || view.height != views[0].height) {
      return fail(fmt::format(
          "{}: is {} x {} pixels, expected {} x {} as {} is: calibrate each camera by itself, from "
          "photos that are neither cropped nor turned",
          view.file, view.width, view.height, views[0].width, views[0].height, views[0].file));
    }
    tags += view.tags.size();
  }
  if (tags >= kLeastTags) return {};
  return fail(fmt::format(
      "{} of the boards' tags read in {} photos, expected {} at least: see that the photos show "
      "the boards given, sharp and whole",
      tags, views.size(), kLeastTags));
}

}  // namespace

Result<CameraCalibration> calibrate_camera(std::span<const BoardView> views,
                                           std::span<const Board> boards) {
  if (auto checked = check_boards(boards); !checked) return fail(checked);
  if (auto checked = check_views(views); !checked) return fail(checked);
  // For a lens that bends little either model is right: both are compared form by form.
  auto [better, other, compare] = best_fits(calibration_problem(views, boards));
  const auto fit_all = [&, &better = better, &other = other, compare = compare] {
    std::vector<FormFit> fits = fit_forms(better.problem, better.state);
    if (compare) {
      std::ranges::move(fit_forms(better.problem, other.state), std::back_inserter(fits));
    }
    return result_of(better.problem, std::move(fits));
  };
  Result<CameraCalibration> result = fit_all();
  if (result && leave_out_zoomed(better.problem, *result)) result = fit_all();
  return result;
}

CameraScatter camera_scatter(std::span<const CalibratedSighting> sightings) {
  CameraScatter scatter;
  for (const CalibratedSighting& sighting : sightings) {
    if (!sighting.used) continue;
    scatter.chi_square += sighting.own_camera.chi_square;
    scatter.degrees += sighting.own_camera.degrees;
    ++scatter.photos;
  }
  return scatter;
}

double CameraScatter::limit() const {
  constexpr double kNormal = 4;
  return chi_square_limit(std::max(1, degrees), kNormal);
}

bool has_other_focal(const CalibratedSighting& sighting) {
  constexpr double kChance = 4;     // standard deviations: no coincidence among some hundred photos
  constexpr double kLeast = 0.001;  // relative; less is within a calibration's accuracy
  const double change = std::abs(sighting.own_camera.focal_change);
  const double sigma = sighting.own_camera.focal_sigma;
  return sigma > 0 && change > kChance * sigma && change > kLeast;
}

// ---- From photo files' pixels.

namespace {

// The guess with which a photo is read again: the camera, and where it has the photo's boards.
BoardGuess guess_for(const CameraCalibration& calibration, std::size_t view) {
  BoardGuess guess{calibration.camera, {}};
  for (const CalibratedSighting& sighting : calibration.sightings) {
    if (sighting.view == view) {
      guess.boards.push_back({sighting.board, sighting.camera_from_board});
    }
  }
  return guess;
}

using ReadView = std::function<BoardView(const GrayView&, std::size_t)>;

// All photos read; the first one that cannot be loaded is the error.
Result<std::vector<BoardView>> read_all(const PhotoSource& photos, std::size_t already_done,
                                        const PhotoCalibrationOptions& options,
                                        const ReadView& read) {
  const std::size_t count = photos.files.size();
  std::vector<BoardView> views(count);
  std::optional<Error> error;
  run_in_order(count, options.jobs, [&](std::size_t i) -> Delivery {
    const Result<GrayImage> image = photos.load(i);
    if (!image) {
      return [&error, what = image.error()] {
        if (!error) error = what;
      };
    }
    views[i] = read(image->view(), i);
    return [&options, already_done, i, count] {
      if (options.on_read) options.on_read(already_done + i + 1, 2 * count);
    };
  });
  if (error) return tl::unexpected(*error);
  return views;
}

// "; 2 of the photos are left out: a.jpg is mirrored"; empty where none has an objection.
std::string objections_in_words(std::span<const BoardView> views) {
  const auto is_out = [](const BoardView& view) { return !view.objection.empty(); };
  const auto first = std::ranges::find_if(views, is_out);
  if (first == views.end()) return {};
  const auto count = std::ranges::count_if(views, is_out);
  return fmt::format("; {} of the photos {} left out: {} {}", count, count == 1 ? "is" : "are",
                     first->file, first->objection);
}

}  // namespace

Result<PhotoCalibration> calibrate_photos(const PhotoSource& photos, std::span<const Board> boards,
                                          const PhotoCalibrationOptions& options) {
  if (auto checked = check_boards(boards); !checked) return fail(checked);
  auto views = read_all(photos, 0, options, [&](const GrayView& image, std::size_t i) {
    return read_board_view(image, photos.files[i], boards);
  });
  if (!views) return fail(views);
  object_to_views(boards, *views);
  auto first = calibrate_camera(*views, boards);
  if (!first) return fail(first.error().message + objections_in_words(*views));
  auto again =
      read_all(photos, photos.files.size(), options, [&](const GrayView& image, std::size_t i) {
        return read_board_view_again(image, (*views)[i], boards, guess_for(*first, i));
      });
  if (!again) return fail(again);
  auto calibration = calibrate_camera(*again, boards);
  if (!calibration) return fail(calibration);
  return PhotoCalibration{std::move(*calibration), std::move(*again)};
}

}  // namespace tagsmith::detail
