// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/fix_files.hpp"

#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"

namespace tagsmith::detail {

// ---- JSON lines.

namespace {

Json json_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

// Row by row.
Json covariance_json(const Fix& fix) {
  if (!fix.covariance_in_grid) return {};
  return number_list(Eigen::Matrix3d(fix.covariance_in_grid->transpose()));
}

void add_attitude(Json& line, const Fix& fix) {
  line["heading_deg"] = fix.attitude ? Json(degrees(fix.attitude->heading)) : Json();
  if (!fix.attitude || !fix.pose_covariance_in_grid) return;
  line["pitch_deg"] = degrees(fix.attitude->pitch);
  line["roll_deg"] = degrees(fix.attitude->roll);
  const Eigen::Matrix<double, 6, 1> sigmas = fix.pose_covariance_in_grid->diagonal().cwiseSqrt();
  line["heading_sigma_deg"] = degrees(sigmas[3]);
  line["pitch_sigma_deg"] = degrees(sigmas[4]);
  line["roll_sigma_deg"] = degrees(sigmas[5]);
}

Json dropped_json(const Fix& fix) {
  return json_list(fix.dropped, [](const Dropped& dropped) -> Json {
    return {{"name", dropped.name},
            {"camera", json_or_null(dropped.camera)},
            {"reason", dropped.reason}};
  });
}

Json unchecked_json(const Fix& fix) {
  return json_list(fix.unchecked, [](const Unchecked& unchecked) -> Json {
    return {{"kind", to_string(unchecked.kind)},
            {"name", json_or_null(unchecked.name)},
            {"metres", unchecked.metres > 0 ? Json(unchecked.metres) : Json()}};
  });
}

// Standard deviations, metres.
Json budget_json(const ErrorBudget& budget) {
  Json parts;
  for (const auto& [source, covariance] : parts_of(budget)) {
    parts[source] = number_list(Eigen::Vector3d(covariance.diagonal().cwiseMax(0).cwiseSqrt()));
  }
  return parts;
}

Json residuals_json(const Fix& fix) {
  Json all = Json::array();
  for (const FittedCorners& corners : fix.corners) {
    Json residuals = Json::array();
    for (std::size_t i = 0; i < 4; ++i) {
      const PixelPoint residual = corners.seen[i] - corners.fitted[i];
      residuals.push_back({residual.x, residual.y});
    }
    all.push_back({{"camera", corners.camera},
                   {"tag", corners.tag},
                   {"used", corners.used},
                   {"pixels", std::move(residuals)}});
  }
  return all;
}

Json summary_values(const FixSummary& summary) {
  Json values{
      {"count", summary.count}, {"located", summary.located}, {"confirmed", summary.confirmed}};
  if (summary.mean_error && summary.error95 && summary.max_error) {
    values["mean_error_plane"] = summary.mean_error->plane;
    values["mean_error_z"] = summary.mean_error->height;
    values["error95_plane"] = summary.error95->plane;
    values["error95_z"] = summary.error95->height;
    values["max_error_plane"] = summary.max_error->plane;
    values["max_error_z"] = summary.max_error->height;
  }
  return values;
}

// By which its values are multiplied for JSON: angles are in degrees there, a camera's focal length
// in pixels.
double unit_of(const RigSuspect& suspect, const Rig& rig) {
  switch (suspect.parameter) {
    case RigParameter::focal:
      return suspect.camera.empty() ? 1 : find_camera(rig, suspect.camera)->camera.fx;
    case RigParameter::distortion:
    case RigParameter::position:
    case RigParameter::plate_point:
    case RigParameter::plate_size:
      return 1;
    default:
      return degrees(1.0);
  }
}

Json suspicion_json(const RigSuspicion& suspicion, const Rig& rig) {
  Json suspects = Json::array();
  for (const RigSuspect& suspect : suspicion.suspects) {
    const double unit = unit_of(suspect, rig);
    suspects.push_back({{"camera", json_or_null(suspect.camera)},
                        {"parameter", to_string(suspect.parameter)},
                        {"stated", unit * suspect.stated},
                        {"expected", unit * suspect.expected},
                        {"sigma", unit * suspect.sigma},
                        {"rows_explained", suspect.rows_explained}});
    if (suspect.parameter == RigParameter::position ||
        suspect.parameter == RigParameter::plate_point) {
      suspects.back()["shift"] = number_list(suspect.shift);
    }
  }
  return {{"text", describe(suspicion, rig)},
          {"rows", suspicion.rows},
          {"rows_as_stated", suspicion.rows_as_stated},
          {"suspects", std::move(suspects)}};
}

}  // namespace

std::vector<std::pair<std::string, Eigen::Matrix3d>> parts_of(const ErrorBudget& budget) {
  return {{"pixels", budget.pixels},  {"edges", budget.edges},
          {"survey", budget.survey},  {"coding", budget.coding},
          {"ranges", budget.ranges},  {"calibration", budget.calibration},
          {"vehicle", budget.vehicle}};
}

std::string fix_json_line(const Fix& fix, const Measurement& measurement, bool explain) {
  Json line{{"id", fix.id},
            {"status", status_of(fix)},
            {"method", fix.method},
            {"survey", json_or_null(fix.survey)},
            {"position", fix.position_in_grid ? number_list(*fix.position_in_grid) : Json()}};
  add_attitude(line, fix);
  line["covariance"] = covariance_json(fix);
  line["tags"] = fix.tags;
  line["ranges"] = fix.ranges;
  line["dropped"] = dropped_json(fix);
  line["confirmations"] = fix.position_in_grid ? Json(fix.confirmations) : Json();
  line["reason"] = json_or_null(fix.reason);
  line["notes"] = fix.notes;
  if (fix.predicted) line["predicted"] = true;
  if (fix.degrees_of_freedom > 0) {
    line["chi_square"] = fix.chi_square;
    line["degrees_of_freedom"] = fix.degrees_of_freedom;
    line["variance_factor"] = fix.variance_factor;
    line["unchecked"] = unchecked_json(fix);
  }
  if (explain && fix.budget) line["budget"] = budget_json(*fix.budget);
  if (explain && fix.budget) line["residuals"] = residuals_json(fix);
  if (const auto error = error_of(fix, measurement)) {
    line["error_plane"] = error->plane;
    line["error_z"] = error->height;
  }
  return json_text(line);
}

std::string summary_json_line(std::span<const FixSummary> summaries,
                              const std::vector<std::string>& assumed, const RunFindings& findings,
                              const Rig& rig) {
  Json values = summary_values(summaries.front());
  values["assumed"] = assumed;
  if (const auto& suspicion = findings.checked.suspicion) {
    values["rig_suspicion"] = suspicion_json(*suspicion, rig);
  }
  if (const auto& text = findings.checked.contradicted; !text.empty()) {
    values["contradicted"] = text;
  }
  if (findings.rolling) {
    values["rolling_shutter"] = {{"text", to_string(*findings.rolling)},
                                 {"rows", findings.rolling->rows},
                                 {"located", findings.rolling->located}};
  }
  if (findings.travel.turned) {
    values["turned_headings"] = {{"text", to_string(*findings.travel.turned)},
                                 {"degrees", degrees(findings.travel.turned->angle)},
                                 {"steps", findings.travel.turned->steps}};
  }
  if (findings.course) {
    values["course_offset"] = {{"text", to_string(*findings.course)},
                               {"degrees", degrees(findings.course->angle)},
                               {"sigma_deg", degrees(findings.course->sigma)},
                               {"steps", findings.course->steps}};
  }
  if (findings.travel.height) {
    values["wrong_height"] = {{"text", to_string(*findings.travel.height)},
                              {"height", findings.travel.height->height},
                              {"stated", findings.travel.height->stated}};
  }
  if (findings.travel.range) {
    values["wrong_range"] = {{"text", to_string(*findings.travel.range)},
                             {"range", findings.travel.range->name},
                             {"metres", findings.travel.range->metres},
                             {"sigmas", findings.travel.range->sigmas},
                             {"tags_may_be_wrong", findings.travel.range->tags_may_be_wrong}};
  }
  if (!findings.altered.empty()) values["altered_photos"] = findings.altered;
  if (!findings.another_drive.empty()) values["another_drive"] = findings.another_drive;
  if (!findings.checked.mixed.empty()) values["mixed_rows"] = findings.checked.mixed;
  for (const SetAside& tag : findings.checked.aside) {
    values["set_aside"].push_back({{"tag", tag.tag},
                                   {"rule", tag.rule},
                                   {"message", tag.message},
                                   {"rows", tag.rows.size()}});
  }
  if (summaries.size() > 1) values["paper"] = summary_values(summaries[1]);
  return json_text({{"summary", std::move(values)}});
}

// ---- Files.

namespace {

std::string csv_number(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string();
}

std::string csv_degrees(const std::optional<double>& radian) {
  return radian ? csv_number(degrees(*radian)) : std::string();
}

std::optional<double> sigma_of(const Fix& fix, int parameter) {
  if (!fix.pose_covariance_in_grid) return std::nullopt;
  return std::sqrt((*fix.pose_covariance_in_grid)(parameter, parameter));
}

// Pitch, roll and the standard deviations of the attitude, degrees.
void add_attitude(std::vector<std::string>& fields, const Fix& fix) {
  const std::optional<Attitude>& attitude = fix.attitude;
  fields.push_back(csv_degrees(attitude ? std::optional(attitude->pitch) : std::nullopt));
  fields.push_back(csv_degrees(attitude ? std::optional(attitude->roll) : std::nullopt));
  for (const int parameter :
       {vehicle_parameter::kHeading, vehicle_parameter::kPitch, vehicle_parameter::kRoll}) {
    fields.push_back(csv_degrees(sigma_of(fix, parameter)));
  }
}

std::string csv_row(const Fix& fix, const Measurement& measurement) {
  std::vector<std::string> fields{csv_field(fix.id), status_of(fix), fix.method,
                                  csv_field(fix.survey)};
  for (const int axis : {0, 1, 2}) {
    fields.push_back(fix.position_in_grid ? csv_number((*fix.position_in_grid)[axis]) : "");
  }
  fields.push_back(csv_degrees(fix.attitude ? std::optional(fix.attitude->heading) : std::nullopt));
  for (const int row : {0, 1, 2}) {
    for (int column = row; column < 3; ++column) {
      fields.push_back(fix.covariance_in_grid ? csv_number((*fix.covariance_in_grid)(row, column))
                                              : "");
    }
  }
  const std::optional<FixError> error = error_of(fix, measurement);
  fields.push_back(csv_field(fmt::format("{}", fmt::join(fix.tags, " "))));
  fields.push_back(error ? csv_number(error->plane) : "");
  fields.push_back(error ? csv_number(error->height) : "");
  fields.push_back(csv_field(fix.reason));
  fields.push_back(csv_field(fmt::format("{}", fmt::join(fix.notes, "; "))));
  fields.push_back(csv_number(measurement.time));
  add_attitude(fields, fix);
  fields.push_back(fix.position_in_grid ? std::to_string(fix.confirmations) : "");
  return fmt::format("{}\n", fmt::join(fields, ","));
}

std::string tum_row(const Fix& fix, double time, const Grid& grid) {
  const Pose pose = world_from_vehicle(fix, grid);
  const Eigen::Quaterniond q(pose.rotation);
  const Eigen::Vector3d& t = pose.translation;
  return fmt::format("{:.6f} {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n", time, t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace

std::string fixes_csv(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements) {
  std::string text =
      "id,status,method,survey,x,y,z,heading_deg,covariance_xx,covariance_xy,covariance_xz,"
      "covariance_yy,covariance_yz,covariance_zz,tags,error_plane,error_z,reason,notes,time,"
      "pitch_deg,roll_deg,sigma_heading_deg,sigma_pitch_deg,sigma_roll_deg,confirmations\n";
  for (std::size_t i = 0; i < fixes.size(); ++i) text += csv_row(fixes[i], measurements[i]);
  return text;
}

Result<std::string> fixes_tum(const std::vector<Fix>& fixes, const Run& run,
                              const std::vector<Survey>& surveys) {
  std::string text;
  bool mirrored = false;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const Measurement& measurement = run.measurements[i];
    if (!fixes[i].position_in_grid || !fixes[i].attitude) continue;
    if (!measurement.time) {
      return fail(
          fmt::format("{}:{}: no time, which a TUM trajectory needs: add a column `time` "
                      "in seconds",
                      run.file.string(), measurement.line));
    }
    const Grid& grid = survey_of(fixes[i], surveys).grid;
    mirrored = mirrored || grid.x_axis_left;
    text += tum_row(fixes[i], *measurement.time, grid);
  }
  if (text.empty()) {
    return fail(run.file.string() +
                ": no measurement has a position with a heading, so there is no trajectory to "
                "write (the paper's method gives no heading)");
  }
  return std::string("# time x y z qx qy qz qw; seconds, metres") +
         (mirrored ? "; x is minus the grid's x, which grows to the left" : "") + "\n" + text;
}

}  // namespace tagsmith::detail
