// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/unchecked.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// How large a gross mistake may be.
constexpr double kShift = 1.0;  // metres, of a plate, a camera, a wall
constexpr double kTurn = 1.0;   // radians, of a camera
constexpr double kLean = 0.1;   // radians, of a plate against its wall
constexpr double kWay = 0.1;  // metres, while a rolling shutter passes over an image: 3 m/s, 33 ms
constexpr double kShare = 0.3;   // of a length: focal length, size of plates, spacing
constexpr double kCenter = 100;  // pixels, of a principal point
constexpr double kBent = 0.3;    // k1 of a lens
constexpr Index kLensMistakes = 5;
// Standard deviations of the position that matter: five, minus one for the effect of noise.
constexpr double kFarOff = 4;
constexpr double kNoticed = 3.1;  // a normal value: chi-square that right rows exceed in 0.1 %

// Displacements of the fit's whitened rows by one kind of mistake, a column a parameter, each
// scaled to a gross mistake.
struct MistakeEffect {
  Unchecked::Kind kind{};
  std::string what;
  MatrixXd rows;
};

// The derivatives of every sighting of the fit, in the order of its rows, not yet whitened.
struct SeenRows {
  std::size_t plate = 0;
  std::size_t camera = 0;
  Index begin = 0;
  SightingRows rows;
};

std::vector<SeenRows> seen_rows(const JointProblem& problem, const JointFit& fit) {
  const CalibrationLayout layout = calibration_layout_of_moment(*problem.rig);
  const VehicleFrame frame = vehicle_frame(fit.state.vehicle);
  std::vector<SeenRows> seen;
  for (const WhitenedRows::Plate& group : fit.rows.plates) {
    Index row = group.begin;
    for (const std::size_t index : group.sightings) {
      const Sighting& sighting = problem.sightings[index];
      const auto rows = sighting_rows(*problem.rig, layout, fit.state.calibration, frame,
                                      problem.plates[group.plate], sighting.camera);
      if (rows) seen.push_back({group.plate, sighting.camera, row, *rows});
      row += kSightingRows;
    }
  }
  return seen;
}

class Effects {
 public:
  Effects(const JointProblem& problem, const JointFit& fit)
      : problem_(problem), fit_(fit), seen_(seen_rows(problem, fit)) {}

  // `derivative(seen)`: of the sighting's rows by the mistake's parameters; rows of sightings
  // that it is not about are zero.
  template <typename Derivative>
  void add(Unchecked::Kind kind, std::string what, Index parameters, Derivative derivative) {
    MatrixXd rows = MatrixXd::Zero(fit_.rows.residual.size(), parameters);
    for (const SeenRows& seen : seen_) {
      rows.middleRows<kSightingRows>(seen.begin) = derivative(seen);
    }
    for (const WhitenedRows::Plate& group : fit_.rows.plates) {
      const auto size = kSightingRows * static_cast<Index>(group.sightings.size());
      group.root.triangularView<Eigen::Lower>().solveInPlace(rows.middleRows(group.begin, size));
    }
    effects_.push_back({kind, std::move(what), std::move(rows)});
  }

  void add_row(Unchecked::Kind kind, std::string what, Index row, double size) {
    MatrixXd rows = MatrixXd::Zero(fit_.rows.residual.size(), 1);
    rows(row, 0) = size;
    effects_.push_back({kind, std::move(what), std::move(rows)});
  }

  void add_plates();
  void add_walls();
  void add_wall_turns();
  void add_cameras();
  void add_shutters();
  void add_ranges_and_height();

  const std::vector<MistakeEffect>& all() const { return effects_; }

 private:
  std::ptrdiff_t plates_on(Side side) const {
    return std::ranges::count_if(fit_.rows.plates, [&](const WhitenedRows::Plate& group) {
      return problem_.plates[group.plate].side == side;
    });
  }

  const JointProblem& problem_;
  const JointFit& fit_;
  std::vector<SeenRows> seen_;
  std::vector<MistakeEffect> effects_;
};

using Rows = MatrixXd;

// The corner that two rows of a sighting belong to, in the plate's frame.
Vector3d corner_of(const SightedPlate& plate, Index row) {
  const Index corner = row / 2;
  return {corner == 1 || corner == 2 ? plate.length : 0, corner >= 2 ? plate.height : 0, 0};
}

// By the plate's length and height, each relative.
Rows by_size(const SightedPlate& plate, const SightingRows& seen) {
  Rows rows(kSightingRows, 2);
  for (Index row = 0; row < kSightingRows; ++row) {
    const Vector3d corner = corner_of(plate, row);
    const Eigen::Matrix3d& axes = plate.world_from_plate.rotation;
    rows(row, 0) = seen.by_plate.row(row).head<3>().dot(axes.col(0) * corner.x());
    rows(row, 1) = seen.by_plate.row(row).head<3>().dot(axes.col(1) * corner.y());
  }
  return rows;
}

// By the focal length (relative), the principal point, k1, and the focal length across alone, of
// which readers of rigs warn where it differs by more.
Rows by_lens(const SightingRows& seen) {
  const Eigen::Vector4d gross(kShare, kCenter, kCenter, kBent);
  Rows rows(kSightingRows, kLensMistakes);
  rows.leftCols<4>() = seen.by_calibration.middleCols<4>(6) * gross.asDiagonal();
  for (Index row = 0; row < kSightingRows; ++row) {
    rows(row, 4) = row % 2 == 0 ? kSquarePixels * seen.by_calibration(row, 6) : 0;
  }
  return rows;
}

Rows by_mounting(const SightingRows& seen) {
  Eigen::Matrix<double, 6, 1> gross;
  gross << kShift, kShift, kShift, kTurn, kTurn, kTurn;
  return seen.by_calibration.leftCols<6>() * gross.asDiagonal();
}

void Effects::add_plates() {
  Eigen::Matrix<double, 6, 1> gross;
  gross << kShift, kShift, kShift, kLean, kLean, kLean;
  for (const WhitenedRows::Plate& group : fit_.rows.plates) {
    add(Unchecked::Kind::plate_place, problem_.plates[group.plate].name, 6,
        [&](const SeenRows& seen) -> Rows {
          if (seen.plate != group.plate) return Rows::Zero(kSightingRows, 6);
          return seen.rows.by_plate * gross.asDiagonal();
        });
  }
  add(Unchecked::Kind::plate_size, "", 2, [&](const SeenRows& seen) -> Rows {
    return kShare * by_size(problem_.plates[seen.plate], seen.rows);
  });
}

// All plates out of their walls, and along the drive by their distance from the vehicle; those of
// one wall shifted alike.
void Effects::add_walls() {
  add(Unchecked::Kind::wall_places, "", 2, [&](const SeenRows& seen) -> Rows {
    const SightedPlate& plate = problem_.plates[seen.plate];
    const Eigen::Matrix3d& axes = plate.world_from_plate.rotation;
    const Vector3d away = plate.world_from_plate.translation - fit_.state.vehicle.position;
    const Vector3d along = kShare * away.dot(axes.col(0)) * axes.col(0);
    Rows rows(kSightingRows, 2);
    rows << seen.rows.by_plate.leftCols<3>() * (kShift * axes.col(2)),
        seen.rows.by_plate.leftCols<3>() * along;
    return rows;
  });
  for (const Side side : {Side::left, Side::right}) {
    if (plates_on(side) < 2) continue;  // add_plates has it
    add(Unchecked::Kind::wall_shift, to_string(side), 3, [&](const SeenRows& seen) -> Rows {
      if (problem_.plates[seen.plate].side != side) return Rows::Zero(kSightingRows, 3);
      return kShift * seen.rows.by_plate.leftCols<3>();
    });
  }
}

// The plates of both walls, or of one, that are turned alike: they lean, stand out from the wall at
// one end, or follow a slope.
void Effects::add_wall_turns() {
  const auto add_turn = [&](std::string name, auto hangs_there) {
    add(Unchecked::Kind::wall_turn, std::move(name), 3, [&](const SeenRows& seen) -> Rows {
      const SightedPlate& plate = problem_.plates[seen.plate];
      if (!hangs_there(plate)) return Rows::Zero(kSightingRows, 3);
      const double mirrored = plate.side == Side::left ? kLean : -kLean;
      const Vector3d gross(kLean, mirrored, mirrored);
      return seen.rows.by_plate.rightCols<3>() * gross.asDiagonal();
    });
  };
  add_turn("", [](const SightedPlate&) { return true; });
  for (const Side side : {Side::left, Side::right}) {
    if (plates_on(side) < 2) continue;  // add_plates has it
    add_turn(to_string(side), [side](const SightedPlate& plate) { return plate.side == side; });
  }
}

void Effects::add_cameras() {
  const auto& cameras = problem_.rig->cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto is_other = [&](const SeenRows& seen) { return seen.camera != i; };
    if (std::ranges::all_of(seen_, is_other)) continue;
    add(Unchecked::Kind::mounting, cameras[i].name, 6, [&](const SeenRows& seen) -> Rows {
      return is_other(seen) ? Rows::Zero(kSightingRows, 6) : by_mounting(seen.rows);
    });
    add(Unchecked::Kind::lens, cameras[i].name, kLensMistakes, [&](const SeenRows& seen) -> Rows {
      return is_other(seen) ? Rows::Zero(kSightingRows, kLensMistakes) : by_lens(seen.rows);
    });
  }
  add(Unchecked::Kind::all_lenses, "", kLensMistakes,
      [&](const SeenRows& seen) -> Rows { return by_lens(seen.rows); });
}

// The vehicle drives on while cameras whose readout the rig does not state read their rows, each as
// slowly as it may be.
void Effects::add_shutters() {
  const auto is_unstated = [](const RigCamera& camera) { return !camera.readout; };
  if (std::ranges::none_of(problem_.rig->cameras, is_unstated)) return;
  add(Unchecked::Kind::rolling_shutter, "", 6, [&](const SeenRows& seen) -> Rows {
    if (!is_unstated(problem_.rig->cameras[seen.camera])) return Rows::Zero(kSightingRows, 6);
    return seen.rows.by_calibration.middleCols<6>(kMotion) * motion_sigmas(kWay).asDiagonal();
  });
}

void Effects::add_ranges_and_height() {
  for (std::size_t i = 0; i < fit_.selection.ranges.size(); ++i) {
    const WallRange& range = problem_.ranges[fit_.selection.ranges[i]];
    add_row(Unchecked::Kind::range, range.name, fit_.rows.ranges_begin + static_cast<Index>(i),
            kShift / range.sigma);
  }
  add_row(Unchecked::Kind::vehicle_height, "", fit_.rows.vehicle_begin,
          kShift / problem_.rig->height_sigma);
}

// How far a mistake moves the position at most where chi-square grows by no more than
// `unnoticed`, in standard deviations of the coordinate it moves most and in metres.
struct Reach {
  double sigmas = 0;
  double metres = 0;
};

Reach reach_of(const JointFit& fit, const MatrixXd& effect, double unnoticed) {
  const MatrixXd by_parameters = fit.rows.jacobian.transpose() * effect;
  const MatrixXd gain = fit.covariance * by_parameters;
  MatrixXd cost = effect.transpose() * effect - by_parameters.transpose() * gain;
  cost /= unnoticed;
  cost.diagonal().array() += 1;  // no parameter beyond a gross mistake
  const MatrixXd moves = gain.topRows<3>();
  const Eigen::Matrix3d spread = moves * solve_symmetric(cost, moves.transpose());
  const Vector3d metres = spread.diagonal().cwiseMax(0).cwiseSqrt();
  const Vector3d sigmas = fit.covariance.diagonal().head<3>().cwiseSqrt();
  return {metres.cwiseQuotient(sigmas).maxCoeff(), metres.maxCoeff()};
}

}  // namespace

std::vector<Unchecked> unchecked_by(const JointProblem& problem, const JointFit& fit,
                                    double variance_factor) {
  Effects effects(problem, fit);
  effects.add_plates();
  effects.add_walls();
  effects.add_wall_turns();
  effects.add_cameras();
  effects.add_shutters();
  effects.add_ranges_and_height();
  // A chi-square as large as the fit's own was not refused either.
  const double unnoticed =
      std::max(chi_square_limit(fit.degrees_of_freedom, kNoticed), fit.chi_square);
  std::vector<Unchecked> unchecked;
  for (const MistakeEffect& effect : effects.all()) {
    const Reach reach = reach_of(fit, effect.rows, unnoticed);
    if (reach.sigmas < kFarOff * std::sqrt(variance_factor)) continue;
    unchecked.push_back({effect.kind, effect.what, reach.metres});
  }
  using enum Unchecked::Kind;
  for (const Unchecked::Kind always : {all_mountings, moment, survey_frame}) {
    unchecked.push_back({always, {}, 0});
  }
  return unchecked;
}

}  // namespace tagsmith::detail
