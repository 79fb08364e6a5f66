// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/assess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

// A deviation of so many standard deviations is no coincidence, among some hundred tests.
constexpr double kSure = 4;

// Tilts below this change the picture's perspective so little that focal length and distance are
// separated three times worse than at 40 degrees.
constexpr double kLeastTilt = radians(20);

struct Case {
  const CameraCalibration& calibration;
  std::span<const BoardView> views;
  std::span<const Board> boards;
  const RayGrid& grid;
  double focal_sigma = 0;

  double refused_ray_px() const { return kRefusedRay * calibration.camera.width; }
};

using Findings = std::vector<CalibrationFinding>;

std::size_t photos_used(const CameraCalibration& calibration) {
  std::set<std::size_t> views;
  for (const CalibratedSighting& sighting : calibration.sightings) {
    if (sighting.used) views.insert(sighting.view);
  }
  return views.size();
}

// --- precision, and what is missing ---

void find_focal(const Case& c, Findings& findings) {
  if (c.focal_sigma <= kWeakFocal) return;
  const bool refused = c.focal_sigma > kRefusedFocal;
  const double limit = refused ? kRefusedFocal : kWeakFocal;
  findings.push_back(
      {CalibrationIssue::focal_unknown,
       refused ? CalibrationTrust::refused : CalibrationTrust::weak, c.focal_sigma, limit,
       fmt::format("the focal length is known to {:.2g} %, expected {:.2g} % or better",
                   100 * c.focal_sigma, 100 * limit),
       "take more photos, with the board tilted by 30 to 45 degrees to each side and both ways"});
}

void find_rays(const Case& c, Findings& findings) {
  const double worst = c.grid.worst_sigma_px();
  if (worst <= kWeakRay) return;
  const bool refused = worst > c.refused_ray_px();
  const double limit = refused ? c.refused_ray_px() : kWeakRay;
  const auto cell = std::ranges::max_element(c.grid.cells, {}, &RayGrid::Cell::worst_sigma_px);
  const auto place = static_cast<std::size_t>(cell - c.grid.cells.begin());
  const std::string measured =
      std::isfinite(worst) ? fmt::format("known to {:.2g} px", worst) : "not known at all";
  findings.push_back({CalibrationIssue::rays_unknown,
                      refused ? CalibrationTrust::refused : CalibrationTrust::weak, worst, limit,
                      fmt::format("the rays at the {} of the picture are {}, expected {:.2g} "
                                  "px or better",
                                  cell_name(place), measured, limit),
                      "take more photos with the board there"});
}

// "upper left, left and lower left"
std::string listed(const std::vector<std::size_t>& cells) {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text += i + 1 == cells.size() ? " and " : ", ";
    text += cell_name(cells[i]);
  }
  return text;
}

// Cells without corners whose rays are more uncertain than they should be.
void find_uncovered(const Case& c, Findings& findings) {
  std::vector<std::size_t> cells;
  double worst = 0;
  for (std::size_t i = 0; i < c.grid.cells.size(); ++i) {
    const RayGrid::Cell& cell = c.grid.cells[i];
    if (!cell.has_ray || cell.corners > 0 || cell.worst_sigma_px <= kWeakRay) continue;
    cells.push_back(i);
    worst = std::max(worst, cell.worst_sigma_px);
  }
  if (cells.empty()) return;
  const auto trust =
      worst > c.refused_ray_px() ? CalibrationTrust::refused : CalibrationTrust::weak;
  findings.push_back({CalibrationIssue::not_covered, trust, worst, kWeakRay,
                      fmt::format("no tag was seen at the {} of the picture", listed(cells)),
                      "take three photos with the board there"});
  findings.back().cells = std::move(cells);
}

// A few photos by a lens that moves fit one camera, which is wrong. Of 24 sets each whose photos
// had focal lengths within 0.2 % of the mean, 7, 4, 3 and 1 with 3, 4, 5 and 6 photos were off by
// more than four standard deviations and showed nothing else.
void find_too_few(const Case& c, Findings& findings) {
  constexpr std::size_t kEnough = 10;
  constexpr std::size_t kLeast = 6;
  const std::size_t used = photos_used(c.calibration);
  if (used >= kEnough) return;
  findings.push_back({CalibrationIssue::too_few_photos,
                      used < kLeast ? CalibrationTrust::refused : CalibrationTrust::weak,
                      static_cast<double>(used), kEnough,
                      fmt::format("{} photos were used, expected {} or more: fewer may fit a lens "
                                  "that moves",
                                  used, kEnough),
                      "take 15 photos: the board near and far, in the middle and at each "
                      "corner of the picture, tilted to all sides"});
}

// The tilt that all but two photos stay below.
double usual_most_tilt(const CameraCalibration& calibration) {
  std::vector<double> tilts;
  for (const CalibratedSighting& sighting : calibration.sightings) {
    if (sighting.used) tilts.push_back(sighting.tilt);
  }
  std::ranges::sort(tilts, std::ranges::greater{});
  return tilts.empty() ? 0 : tilts[std::min<std::size_t>(2, tilts.size() - 1)];
}

void find_frontal(const Case& c, Findings& findings) {
  const double tilt = usual_most_tilt(c.calibration);
  if (c.focal_sigma <= kWeakFocal || tilt >= kLeastTilt) return;
  findings.push_back(
      {CalibrationIssue::all_frontal, CalibrationTrust::good, tilt, kLeastTilt,
       fmt::format("the board was tilted by {:.0f} degrees at most: a longer focal length "
                   "looks like a nearer board",
                   degrees(tilt)),
       "tilt the board by 30 to 45 degrees, to each side and both ways"});
}

// --- contradictions ---

double root_mean_square(const CalibratedSighting& sighting) {
  const double degrees = 8 * static_cast<double>(sighting.tags_used) - 6;
  return degrees > 0 ? std::sqrt(sighting.chi_square / degrees) : 0;
}

double usual_misfit(const CameraCalibration& calibration) {
  std::vector<double> all;
  for (const CalibratedSighting& sighting : calibration.sightings) {
    if (sighting.used) all.push_back(root_mean_square(sighting));
  }
  return all.empty() ? 1 : std::max(1.0, quantile(all, 0.5));
}

// Where many photos have other focal lengths, there is no single camera.
CalibrationTrust trust_in_zoomed(const CameraCalibration& calibration) {
  constexpr double kMost = 1.0 / 3;
  const auto zoomed =
      static_cast<double>(std::ranges::count_if(calibration.sightings, has_other_focal));
  const auto all = static_cast<double>(calibration.sightings.size());
  return zoomed > kMost * all ? CalibrationTrust::refused : CalibrationTrust::weak;
}

void find_zoomed(const Case& c, const CalibratedSighting& sighting, Findings& findings) {
  findings.push_back(
      {CalibrationIssue::photo_zoomed,
       sighting.used ? trust_in_zoomed(c.calibration) : CalibrationTrust::good,
       sighting.own_camera.focal_change, kWeakFocal,
       fmt::format("{}: by itself it has a focal length {:+.2f} % off ({:.2f} % standard "
                   "deviation){}",
                   c.views[sighting.view].file, 100 * sighting.own_camera.focal_change,
                   100 * sighting.own_camera.focal_sigma, sighting.used ? "" : "; it was left out"),
       "switch autofocus, zoom and image stabilisation off, and take the photos again",
       sighting.view});
}

// Photos that do not fit, and those that would fit with another focal length.
void find_bad_photos(const Case& c, Findings& findings) {
  constexpr double kWorse = 1.5;  // than the median photo, in standard deviations
  const double usual = usual_misfit(c.calibration);
  for (const CalibratedSighting& sighting : c.calibration.sightings) {
    if (has_other_focal(sighting)) {
      find_zoomed(c, sighting, findings);
      continue;
    }
    const double misfit = root_mean_square(sighting);
    const int degrees = 8 * static_cast<int>(sighting.tags_used) - 6;
    const bool by_chance =
        degrees <= 0 || sighting.chi_square < usual * usual * chi_square_limit(degrees, kSure);
    if (sighting.used && (by_chance || misfit < kWorse * usual)) continue;
    findings.push_back(
        {CalibrationIssue::photo_contradicts, CalibrationTrust::good, misfit, kWorse * usual,
         sighting.used
             ? fmt::format(
                   "{}: its corners are {:.1f} times as far off as those of the other photos",
                   c.views[sighting.view].file, misfit / usual)
             : fmt::format("{}: its corners contradict those of the other photos; it was left out",
                           c.views[sighting.view].file),
         "take it again, with camera and board at rest and in focus", sighting.view});
  }
}

// Photos of two cameras of one model, or of a lens that moves slightly: each photo fits a separate
// camera better than chance allows.
void find_differing(const Case& c, Findings& findings) {
  const CameraScatter scatter = camera_scatter(c.calibration.sightings);
  if (scatter.chi_square <= scatter.limit()) return;
  const double of_chance = std::sqrt(scatter.limit() / scatter.degrees);
  findings.push_back(
      {CalibrationIssue::photos_differ, CalibrationTrust::weak, c.calibration.photo_factor,
       of_chance,
       fmt::format(
           "focal length and principal point differ from photo to photo {:.1f} times as much "
           "as chance lets them",
           c.calibration.photo_factor),
       "calibrate each camera by itself, switch autofocus, zoom and image stabilisation off, see "
       "that "
       "the board does not bend, and take the photos again"});
}

// Where many photos are left out, the wrong ones may be among the rest.
void find_left_out(const Case& c, Findings& findings) {
  constexpr double kMany = 0.05;
  constexpr double kMost = 1.0 / 3;  // of the tags: with more, the rest is no reliable majority
  const auto& residuals = c.calibration.residuals;
  const auto out = static_cast<double>(
      std::ranges::count_if(residuals, [](const TagResidual& tag) { return !tag.used; }));
  const double share = out / static_cast<double>(residuals.size());
  if (share <= kMany) return;
  findings.push_back(
      {CalibrationIssue::tags_left_out,
       share > kMost ? CalibrationTrust::refused : CalibrationTrust::weak, share, kMany,
       fmt::format("{:.0f} % of the tags were left out because they contradict the others",
                   100 * share),
       "see that the board is flat and rigid, that nothing moves, and that the camera keeps its "
       "focus"});
}

void find_large_residuals(const Case& c, Findings& findings) {
  constexpr double kMuch = 3;
  const double factor = c.calibration.sigma_factor;
  if (factor <= kMuch) return;
  findings.push_back(
      {CalibrationIssue::residuals_larger, CalibrationTrust::weak, factor, kMuch,
       fmt::format("the corners are {:.1f} times as far off as the pictures explain", factor),
       "see that the board is flat and rigid and the file is the one it was printed from; a "
       "lens that no model fits needs more photos"});
}

// --- boards ---

void find_bow(const Case& c, std::size_t index, Findings& findings) {
  constexpr double kNoticed = 0.001;  // of the longer side: 0.3 mm of A4
  constexpr double kMuch = 0.005;     // above it, a sheet is not bent by a plain curve alone
  const CalibratedBoard& board = c.calibration.boards[index];
  Eigen::Index place = 0;
  const double bow = board.shape.bow.cwiseAbs().maxCoeff(&place);
  const double side = std::max(c.boards[index].width, c.boards[index].height);
  if (bow <= kSure * board.sigma.bow[place] || bow <= kNoticed * side) return;
  findings.push_back(
      {CalibrationIssue::board_bowed,
       bow > kMuch * side ? CalibrationTrust::weak : CalibrationTrust::good, bow, kNoticed * side,
       fmt::format("the board {} is bent by {:.1f} mm", c.boards[index].name, 1000 * bow),
       "glue it on glass or an aluminium composite plate and check it with a straight edge"});
  findings.back().board = index;
}

// The stretch from the photos alone: the prior's share is removed.
void find_stretch(const Case& c, std::size_t index, Findings& findings) {
  const CalibratedBoard& board = c.calibration.boards[index];
  const double prior = std::sqrt(2.0) * c.boards[index].scale_sigma;
  const double variance = board.sigma.stretch * board.sigma.stretch;
  const double information = 1 / variance - 1 / (prior * prior);
  if (!(prior > 0) || !(information > 0)) return;
  const double seen = board.shape.stretch / variance / information;
  if (std::abs(seen) <= kSure * std::sqrt(1 / information + prior * prior)) return;
  findings.push_back(
      {CalibrationIssue::board_stretched, CalibrationTrust::weak, seen, prior,
       fmt::format("the board {} is {:+.2f} % wider for its height than its file says",
                   c.boards[index].name, 100 * seen),
       "measure both check distances again and write them into the board's file"});
  findings.back().board = index;
}

}  // namespace

std::string_view to_string(CalibrationIssue issue) {
  constexpr std::array kNames{"focal_unknown", "rays_unknown",    "too_few_photos",
                              "not_covered",   "all_frontal",     "photo_contradicts",
                              "photo_zoomed",  "photos_differ",   "tags_left_out",
                              "board_bowed",   "board_stretched", "residuals_larger"};
  static_assert(kNames.size() == static_cast<std::size_t>(CalibrationIssue::residuals_larger) + 1);
  return kNames[static_cast<std::size_t>(issue)];
}

std::string_view to_string(CalibrationTrust trust) {
  constexpr std::array kNames{"good", "weak", "refused"};
  static_assert(kNames.size() == static_cast<std::size_t>(CalibrationTrust::refused) + 1);
  return kNames[static_cast<std::size_t>(trust)];
}

std::string_view cell_name(std::size_t cell) {
  constexpr std::array<std::string_view, std::tuple_size_v<decltype(RayGrid::cells)>> kNames{
      "upper left", "top, left of the middle",    "top, right of the middle",    "upper right",
      "left edge",  "middle, to the left",        "middle, to the right",        "right edge",
      "lower left", "bottom, left of the middle", "bottom, right of the middle", "lower right"};
  return kNames[cell];
}

CalibrationAssessment assess_calibration(const CameraCalibration& calibration,
                                         std::span<const BoardView> views,
                                         std::span<const Board> boards) {
  CalibrationAssessment result;
  result.grid = ray_grid(calibration);
  result.focal_sigma = focal_sigma(calibration);
  const Case c{calibration, views, boards, result.grid, result.focal_sigma};
  Findings& findings = result.findings;
  // Contradictions first: they make rays uncertain, too, where more photos would not help.
  find_bad_photos(c, findings);
  find_differing(c, findings);
  find_left_out(c, findings);
  find_large_residuals(c, findings);
  find_focal(c, findings);
  find_rays(c, findings);
  find_uncovered(c, findings);
  find_too_few(c, findings);
  find_frontal(c, findings);
  for (std::size_t b = 0; b < boards.size(); ++b) {
    find_bow(c, b, findings);
    find_stretch(c, b, findings);
  }
  std::ranges::stable_sort(findings, std::ranges::greater{}, &CalibrationFinding::trust);
  if (!findings.empty()) result.trust = findings.front().trust;
  return result;
}

}  // namespace tagsmith::detail
