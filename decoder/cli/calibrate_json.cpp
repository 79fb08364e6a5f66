// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/calibrate_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "decoder/calibrate/ray_sigma.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

using Json = nlohmann::ordered_json;

// What measures is not known to more digits; null where it is not finite.
Json measured(double value) {
  constexpr int kDigits = 6;
  if (!std::isfinite(value)) return nullptr;
  if (value == 0) return 0.0;
  const double power = std::pow(10.0, kDigits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * power) / power;
}

double sigma_of(const CameraCalibration& calibration, Eigen::Index i) {
  return std::sqrt(std::max(0.0, calibration.covariance(i, i)));
}

// --- photos ---

Json sighting_json(const BoardCalibration& result, const CalibratedSighting& sighting) {
  Json json{{"board", result.boards[sighting.board].name},
            {"used", sighting.used},
            {"tags_used", sighting.tags_used},
            {"tilt_deg", measured(degrees(sighting.tilt))},
            {"distance", measured(sighting.camera_from_board.translation.norm())},
            {"chi_square", measured(sighting.chi_square)},
            {"edge_px", measured(sighting.edge_px)}};
  if (sighting.focal_sigma > 0) {
    json["focal_change"] = measured(sighting.focal_change);
    json["focal_sigma"] = measured(sighting.focal_sigma);
  }
  return json;
}

Json photo_json(const BoardCalibration& result, std::size_t place, const PhotoUse& use) {
  const BoardView& view = result.views[place];
  Json json{{"file", view.file},      {"width", view.width},        {"height", view.height},
            {"tags", use.tags},       {"tags_used", use.tags_used}, {"used", use.tags_used > 0},
            {"boards", Json::array()}};
  for (const CalibratedSighting& sighting : result.calibration.sightings) {
    if (sighting.view == place) json["boards"].push_back(sighting_json(result, sighting));
  }
  return json;
}

// --- summary ---

Json camera_json(const Camera& camera) {
  const std::size_t count = coefficient_names(camera.lens).size();
  return {{"width", camera.width},
          {"height", camera.height},
          {"lens", camera.lens == LensModel::fisheye ? "fisheye" : "perspective"},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"distortion", std::vector(camera.distortion.begin(),
                                     camera.distortion.begin() + static_cast<long>(count))}};
}

Json sigma_json(const CameraCalibration& calibration) {
  Json distortion = Json::array();
  const auto count = static_cast<Eigen::Index>(coefficient_names(calibration.camera.lens).size());
  for (Eigen::Index i = 0; i < count; ++i) {
    distortion.push_back(measured(sigma_of(calibration, 4 + i)));
  }
  return {{"fx", measured(sigma_of(calibration, 0))},
          {"fy", measured(sigma_of(calibration, 1))},
          {"cx", measured(sigma_of(calibration, 2))},
          {"cy", measured(sigma_of(calibration, 3))},
          {"distortion", distortion}};
}

// Lower half, row by row, of fx, fy, cx, cy and the lens's coefficients.
Json covariance_json(const CameraCalibration& calibration) {
  const auto count =
      static_cast<Eigen::Index>(4 + coefficient_names(calibration.camera.lens).size());
  Json numbers = Json::array();
  for (Eigen::Index row = 0; row < count; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      numbers.push_back(calibration.covariance(row, column));
    }
  }
  return numbers;
}

Json forms_json(const CameraCalibration& calibration) {
  return json_list(calibration.tried, [](const TriedForm& tried) -> Json {
    return {{"form", to_string(tried.form)},
            {"parameters", tried.form.parameters()},
            {"chi_square", measured(tried.chi_square)},
            {"bic", measured(tried.bic)},
            {"weight", measured(tried.weight)}};
  });
}

Json cells_json(const RayGrid& grid) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const RayGrid::Cell& cell = grid.cells[i];
    cells.push_back({{"place", cell_name(i)},
                     {"corners", cell.corners},
                     {"ray_sigma_px", cell.has_ray ? measured(cell.worst_sigma_px) : Json()}});
  }
  return cells;
}

Json boards_json(const BoardCalibration& result) {
  Json boards = Json::array();
  for (std::size_t i = 0; i < result.boards.size(); ++i) {
    const CalibratedBoard& board = result.calibration.boards[i];
    Eigen::Index worst = 0;
    board.shape.bow.cwiseAbs().maxCoeff(&worst);
    boards.push_back({{"name", result.boards[i].name},
                      {"serial", result.boards[i].serial},
                      {"stretch", measured(board.shape.stretch)},
                      {"stretch_sigma", measured(board.sigma.stretch)},
                      {"bow", measured(board.shape.bow[worst])},
                      {"bow_sigma", measured(board.sigma.bow[worst])},
                      {"ink_growth", measured(board.shape.growth)},
                      {"ink_growth_sigma", measured(board.sigma.growth)}});
  }
  return boards;
}

Json finding_json(const BoardCalibration& result, const CalibrationFinding& finding) {
  Json json{{"rule", to_string(finding.issue)},
            {"severity", severity_of(finding)},
            {"measured", measured(finding.measured)},
            {"limit", measured(finding.limit)}};
  if (finding.view) json["file"] = result.views[*finding.view].file;
  if (finding.board) json["board"] = result.boards[*finding.board].name;
  if (!finding.cells.empty()) json["cells"] = Json::array();
  for (const std::size_t cell : finding.cells) json["cells"].push_back(cell_name(cell));
  json["message"] = finding.message;
  json["remedy"] = finding.remedy;
  return json;
}

std::size_t photos_used(const std::vector<PhotoUse>& uses) {
  std::size_t used = 0;
  for (const PhotoUse& use : uses) used += use.tags_used > 0 ? 1 : 0;
  return used;
}

}  // namespace

std::string calibration_photo_lines(const BoardCalibration& result) {
  const std::vector<PhotoUse> uses = photo_uses(result);
  std::string lines;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    lines += json_text(photo_json(result, i, uses[i])) + "\n";
  }
  return lines;
}

std::string calibration_summary_line(const BoardCalibration& result,
                                     const std::vector<std::string>& written) {
  const CameraCalibration& calibration = result.calibration;
  const IntrinsicsSigma sigma = rig_sigma(calibration);
  Json json{{"verdict", to_string(result.assessment.trust)},
            {"photos", result.views.size()},
            {"photos_used", photos_used(photo_uses(result))},
            {"form", to_string(calibration.form)},
            {"camera", camera_json(calibration.camera)},
            {"sigma", sigma_json(calibration)},
            {"covariance", covariance_json(calibration)},
            {"rig_sigma", {{"focal", measured(sigma.focal)}, {"center", measured(sigma.center)}}},
            {"ray_sigma_px", measured(result.assessment.grid.worst_sigma_px())},
            {"cells", cells_json(result.assessment.grid)},
            {"rms_px", measured(residual_rms_px(calibration))},
            {"edge_px", measured(calibration.edge_px)},
            {"chi_square", measured(calibration.chi_square)},
            {"degrees_of_freedom", calibration.degrees_of_freedom},
            {"sigma_factor", measured(calibration.sigma_factor)},
            {"forms", forms_json(calibration)},
            {"boards", boards_json(result)},
            {"findings", Json::array()},
            {"files", written}};
  for (const CalibrationFinding& finding : result.assessment.findings) {
    json["findings"].push_back(finding_json(result, finding));
  }
  return json_text({{"summary", json}});
}

std::string no_calibration_line(std::size_t photos, const std::string& reason) {
  return json_text({{"summary", {{"verdict", "refused"}, {"photos", photos}, {"reason", reason}}}});
}

}  // namespace tagsmith::detail
