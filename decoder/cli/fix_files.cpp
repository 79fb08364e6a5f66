// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/fix_files.hpp"

#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"

namespace tagsmith::detail {
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
