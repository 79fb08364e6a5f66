// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/calibrate_result.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "decoder/calibrate/distortion_curve.hpp"

namespace tagsmith::detail {
namespace {

std::vector<std::size_t> photos_where(const BoardCalibration& result,
                                      bool (*is_one)(const PhotoUse&)) {
  const std::vector<PhotoUse> uses = photo_uses(result);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (is_one(uses[i])) places.push_back(i);
  }
  return places;
}

std::string size_words(const BoardCalibration& result) {
  const Camera& camera = result.calibration.camera;
  const std::vector<PhotoUse> uses = photo_uses(result);
  std::size_t tags = 0, used = 0;
  for (const PhotoUse& use : uses) {
    tags += use.tags;
    used += use.tags_used;
  }
  return fmt::format("{} of {} photos of {} x {} pixels used, {} of {} tags",
                     std::ranges::count_if(uses, &PhotoUse::is_used), uses.size(), camera.width,
                     camera.height, used, tags);
}

std::string form_words(const CameraCalibration& calibration) {
  std::string chosen = "lens form: " + to_string(calibration.form);
  const std::optional<std::size_t> next = runner_up(calibration);
  if (!next) return chosen;
  const auto found =
      std::ranges::find(calibration.tried, to_string(calibration.form),
                        [](const TriedForm& tried) { return to_string(tried.form); });
  const double worse = calibration.tried[*next].bic - found->bic;
  return fmt::format("{}; runner-up {}, whose BIC is {:.3g} higher ({} forms tried)", chosen,
                     to_string(calibration.tried[*next].form), worse, calibration.tried.size());
}

std::string ray_words(const BoardCalibration& result) {
  const CameraCalibration& calibration = result.calibration;
  const auto middle = ray_sigma_px(calibration, {calibration.camera.cx, calibration.camera.cy});
  const double worst = result.assessment.grid.worst_sigma_px();
  std::string words = "rays: ";
  if (middle) words += fmt::format("known to {:.2g} px at the principal point, ", *middle);
  if (!std::isfinite(worst)) return words + "not known at all in parts of the picture";
  return words + fmt::format("to {:.2g} px at the worst place of the picture", worst);
}

}  // namespace

std::vector<PhotoUse> photo_uses(const BoardCalibration& result) {
  std::vector<PhotoUse> uses(result.views.size());
  for (std::size_t i = 0; i < uses.size(); ++i) uses[i].tags = result.views[i].tags.size();
  for (const TagResidual& tag : result.calibration.residuals) {
    if (tag.used) ++uses[tag.view].tags_used;
  }
  return uses;
}

std::vector<std::size_t> photos_left_out(const BoardCalibration& result) {
  return photos_where(result, [](const PhotoUse& use) { return use.tags > 0 && !use.is_used(); });
}

std::vector<std::size_t> photos_without_tags(const BoardCalibration& result) {
  std::vector<std::size_t> places =
      photos_where(result, [](const PhotoUse& use) { return use.tags == 0; });
  std::erase_if(places, [&](std::size_t i) { return !result.views[i].objection.empty(); });
  return places;
}

std::vector<std::string_view> coefficient_names(LensModel lens) {
  if (lens == LensModel::fisheye) return {"k1", "k2", "k3", "k4"};
  return {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
}

std::string CameraNumber::in_words(double of) const {
  return unit.empty() ? fmt::format("{:.6f}", of) : fmt::format("{:.3f} px", of);
}

std::vector<CameraNumber> camera_numbers(const CameraCalibration& calibration) {
  const CameraVector values = parameters_of(calibration.camera);
  std::vector<CameraNumber> numbers;
  const auto add = [&](std::string name, Eigen::Index i, std::string_view unit) {
    const double sigma = std::sqrt(std::max(0.0, calibration.covariance(i, i)));
    numbers.push_back({std::move(name), values[i], sigma, unit});
  };
  const bool square = calibration.form.square_pixels;
  add(square ? "f" : "fx", 0, "px");
  if (!square) add("fy", 1, "px");
  add("cx", 2, "px");
  add("cy", 3, "px");
  const std::vector<std::string_view> names = coefficient_names(calibration.camera.lens);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if ((calibration.form.lens.free >> i & 1U) == 0) continue;
    add(std::string(names[i]), static_cast<Eigen::Index>(4 + i), "");
  }
  return numbers;
}

double residual_rms_px(const CameraCalibration& calibration) {
  double sum = 0;
  std::size_t corners = 0;
  for (const TagResidual& tag : calibration.residuals) {
    if (!tag.used) continue;
    sum += tag.residual.squaredNorm();
    corners += 4;
  }
  return corners > 0 ? std::sqrt(sum / static_cast<double>(corners)) : 0;
}

std::string_view severity_of(const CalibrationFinding& finding) {
  return finding.trust == CalibrationTrust::good ? "advice" : to_string(finding.trust);
}

std::vector<std::string> calibration_facts(const BoardCalibration& result) {
  const CameraCalibration& calibration = result.calibration;
  return {
      size_words(result), form_words(calibration),
      fmt::format("residuals: {:.3f} px in root mean square, {:.2f} times what the reader states",
                  residual_rms_px(calibration),
                  std::sqrt(calibration.chi_square / std::max(1, calibration.degrees_of_freedom))),
      fmt::format("edges: {:+.3f} px outward by sharpening, tone curve and ink, and taken out",
                  calibration.edge_px),
      ray_words(result)};
}

std::string verdict_words(CalibrationTrust trust) {
  switch (trust) {
    case CalibrationTrust::good:
      return "good";
    case CalibrationTrust::weak:
      return "weak: of use within the sigmas stated, and worse than a calibration should be";
    case CalibrationTrust::refused:
      break;
  }
  return "refused: not to be used";
}

}  // namespace tagsmith::detail
