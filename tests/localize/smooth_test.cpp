// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <Eigen/Cholesky>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;

namespace {

// A hall in which no place is in the rock.
std::vector<Survey> hall() {
  Survey survey;
  survey.name = "hall";
  survey.tag_template = test::corridor_template();
  survey.tunnel.left = -500.0;
  survey.tunnel.right = 500.0;
  survey.tunnel.height = 1000;
  survey.tunnel.centerline = Centerline({0, -500, -500}, 0, {{1000, 0, 0}});
  return {survey};
}

Rig level_rig() {
  Rig rig;
  rig.roll_sigma = rig.pitch_sigma = radians(2);
  return rig;
}

// A run and what the localizer would make of it.
struct Drive {
  Run run;
  std::vector<Fix> fixes;
};

void add_row(Drive& drive, double time, const Vector3d& truth) {
  Measurement measurement;
  measurement.id = std::to_string(drive.run.measurements.size());
  measurement.line = static_cast<int>(drive.run.measurements.size()) + 2;
  measurement.time = time;
  measurement.truth_in_grid = truth;
  Fix fix;
  fix.id = measurement.id;
  fix.method = "joint";
  fix.reason = "no tag was seen";
  drive.run.measurements.push_back(measurement);
  drive.fixes.push_back(fix);
}

// Gives the last row a fix at the place (x, y, z, heading).
void locate_last(Drive& drive, const Eigen::Vector4d& place, const Eigen::Matrix4d& covariance) {
  Fix& fix = drive.fixes.back();
  fix.reason.clear();
  fix.survey = "hall";
  fix.tags = {"000L"};
  fix.position_in_grid = place.head<3>();
  fix.covariance_in_grid = covariance.topLeftCorner<3, 3>();
  fix.attitude = Attitude{place[3], 0.01, 0};
  PoseCovariance pose = 1e-4 * PoseCovariance::Identity();
  pose.topLeftCorner<4, 4>() = covariance;
  fix.pose_covariance_in_grid = pose;
}

Eigen::Vector4d gaussian(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random), normal(random)};
}

// Some millimetres, in directions of its own.
Eigen::Matrix4d any_covariance(std::mt19937& random) {
  Eigen::Matrix4d root;
  for (int i = 0; i < 4; ++i) root.col(i) = 0.003 * gaussian(random);
  return root * root.transpose() + 1e-6 * Eigen::Matrix4d::Identity();
}

struct Chances {
  double gap = 0;      // of a row without a fix
  double blunder = 0;  // of a fix that is half a metre off
};

// A drive by the motion model itself: its accelerations drawn anew every 20 ms.
Drive random_drive(int rows, double step, const Chances& chances, std::mt19937& random) {
  const MotionModel motion;
  const Eigen::Vector4d acceleration(motion.acceleration, motion.acceleration, motion.climb,
                                     motion.turn);
  std::uniform_real_distribution<double> unit(0, 1);
  Drive drive;
  Eigen::Vector4d place = Eigen::Vector4d::Zero();
  Eigen::Vector4d rate(0.1, 1.0, 0, 0.05);
  for (int row = 0; row < rows; ++row) {
    add_row(drive, row * step, place.head<3>());
    drive.run.measurements.back().truth_heading = place[3];
    if (unit(random) >= chances.gap) {
      const Eigen::Matrix4d covariance = any_covariance(random);
      Eigen::Vector4d seen = place + covariance.llt().matrixL() * gaussian(random);
      if (unit(random) < chances.blunder) seen.head<2>() += Eigen::Vector2d(0.3, -0.4);
      locate_last(drive, seen, covariance);
    }
    constexpr double kSlice = 0.02;
    for (double t = 0; t < step - kSlice / 2; t += kSlice) {
      const Eigen::Vector4d kick = std::sqrt(kSlice) * acceleration.cwiseProduct(gaussian(random));
      place += kSlice * (rate + kick / 2);
      rate += kick;
    }
  }
  return drive;
}

struct Nees {
  double sum = 0;
  int count = 0;
  int beyond = 0;  // five standard deviations
  double mean() const { return sum / (3 * count); }
};

void add_to(Nees& nees, const Fix& fix, const Measurement& measurement) {
  const Vector3d error = *fix.position_in_grid - *measurement.truth_in_grid;
  const double distance2 = error.dot(fix.covariance_in_grid->ldlt().solve(error));
  nees.sum += distance2;
  ++nees.count;
  if (distance2 > 37.1) ++nees.beyond;  // chi-square of three, as rare as five sigma
}

}  // namespace

TEST_CASE("the covariance of smoothed and of predicted positions is right, blunders are left out") {
  constexpr unsigned kSeed = 5;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  Nees measured;
  Nees predicted;
  double before = 0;
  double after = 0;
  int blunders_kept = 0;
  for (int drive_number = 0; drive_number < 60; ++drive_number) {
    const Drive drive = random_drive(80, 0.1, {0.2, 0.02}, random);
    const auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
    REQUIRE(smoothed.has_value());
    for (std::size_t i = 0; i < smoothed->size(); ++i) {
      const Fix& fix = (*smoothed)[i];
      const Measurement& measurement = drive.run.measurements[i];
      if (!fix.position_in_grid) continue;
      add_to(fix.predicted ? predicted : measured, fix, measurement);
      if (fix.predicted || !drive.fixes[i].position_in_grid) continue;
      const double off = (*drive.fixes[i].position_in_grid - *measurement.truth_in_grid).norm();
      if (off > 0.4) ++blunders_kept;
      before += off * off;
      after += (*fix.position_in_grid - *measurement.truth_in_grid).squaredNorm();
    }
  }
  MESSAGE("NEES of " << measured.count << " measured: " << measured.mean() << ", of "
                     << predicted.count << " predicted: " << predicted.mean()
                     << "; root mean square error " << std::sqrt(after / before) << " of before");
  CHECK(measured.count > 3000);
  CHECK(predicted.count > 800);
  CHECK(measured.mean() > 0.8);
  CHECK(measured.mean() < 1.25);
  CHECK(predicted.mean() > 0.8);
  CHECK(predicted.mean() < 1.25);
  CHECK(measured.beyond + predicted.beyond == 0);
  CHECK(blunders_kept == 0);
  CHECK(after < 0.7 * before);
}

TEST_CASE("errors that neighbouring fixes share are not averaged away") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Nees nees;
  for (int drive_number = 0; drive_number < 400; ++drive_number) {
    Drive drive = random_drive(20, 0.1, {}, random);
    // As from one tag that hangs 2 mm off: the same shift in every fix.
    const Vector3d shift = 0.002 * Vector3d(normal(random), normal(random), normal(random));
    for (Fix& fix : drive.fixes) {
      *fix.position_in_grid += shift;
      const Eigen::Matrix3d survey = 4e-6 * Eigen::Matrix3d::Identity();
      *fix.covariance_in_grid += survey;
      fix.pose_covariance_in_grid->topLeftCorner<3, 3>() += survey;
      fix.budget = ErrorBudget{};
      fix.budget->survey = survey;
    }
    const auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
    REQUIRE(smoothed.has_value());
    for (std::size_t i = 0; i < smoothed->size(); ++i) {
      add_to(nees, (*smoothed)[i], drive.run.measurements[i]);
    }
  }
  MESSAGE("NEES with a shared error: " << nees.mean());
  CHECK(nees.mean() < 1.25);
  CHECK(nees.mean() > 0.5);  // on the safe side: what several tags average away is not counted
}

TEST_CASE("in a gap the sigma grows, and beyond the limit there is no position") {
  Drive drive;
  const Eigen::Matrix4d covariance = 1e-6 * Eigen::Matrix4d::Identity();
  for (int row = 0; row < 100; ++row) {
    const double time = 0.1 * row;
    add_row(drive, time, {0, time, 0});
    if (row < 20 || row >= 80) locate_last(drive, {0, time, 0, 0}, covariance);
  }
  const auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE(smoothed.has_value());
  double last = 0;
  int predicted = 0;
  for (std::size_t row = 20; row < 50; ++row) {
    const Fix& fix = (*smoothed)[row];
    if (!fix.position_in_grid) continue;
    CHECK(fix.predicted);
    CHECK(fix.tags.empty());
    CHECK(status_of(fix) == "ok");
    CHECK(!fix.notes.empty());
    CHECK((*fix.covariance_in_grid)(1, 1) > last);
    last = (*fix.covariance_in_grid)(1, 1);
    ++predicted;
  }
  CHECK(predicted >= 3);
  const Fix& middle = (*smoothed)[50];
  CHECK_FALSE(middle.position_in_grid.has_value());
  CHECK(middle.reason.find("no tag was seen; the motion predicts it to") == 0);
  MotionModel patient;
  patient.largest_sigma = 100;
  patient.longest_gap = 2;
  const auto far = smooth_fixes(drive.fixes, drive.run, hall(), level_rig(), patient);
  CHECK((*far)[38].position_in_grid.has_value());
  CHECK_FALSE((*far)[45].position_in_grid.has_value());
  CHECK((*far)[45].reason.find("from the nearest measured position") != std::string::npos);
}

TEST_CASE("rows before the first fix and after the last are predicted too") {
  Drive drive;
  for (int row = 0; row < 10; ++row) {
    add_row(drive, 0.1 * row, {0, 0.1 * row, 0});
    if (row >= 1 && row < 9) {
      locate_last(drive, {0, 0.1 * row, 0, 0}, 1e-6 * Eigen::Matrix4d::Identity());
    }
  }
  const auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE(smoothed.has_value());
  for (const std::size_t row : {0U, 9U}) {
    REQUIRE((*smoothed)[row].position_in_grid.has_value());
    CHECK((*smoothed)[row].predicted);
    const PoseCovariance& pose = (*smoothed)[row].pose_covariance_in_grid.value();
    CHECK(pose(4, 4) == doctest::Approx(std::pow(radians(2), 2)));
    CHECK(pose(5, 5) == doctest::Approx(std::pow(radians(2), 2)));
    CHECK(std::abs((*smoothed)[row].position_in_grid->y() - 0.1 * static_cast<double>(row)) < 0.01);
  }
}

TEST_CASE("on a ramp a vehicle of a predicted row stands on the floor") {
  constexpr double kGrade = 0.15;
  std::vector<Survey> ramp = hall();
  ramp[0].tunnel.centerline = Centerline({0, -500, -500}, 0, {{1000, 0, kGrade}});
  for (const double heading : {0.0, std::numbers::pi}) {  // uphill, downhill
    Drive drive;
    for (int row = 0; row < 10; ++row) {
      const double ahead = 0.1 * row * std::cos(heading);
      const Eigen::Vector4d place(0, ahead, -499.7 + kGrade * (500 + ahead), heading);
      add_row(drive, 0.1 * row, place.head<3>());
      if (row != 5) locate_last(drive, place, 1e-6 * Eigen::Matrix4d::Identity());
    }
    const auto smoothed = smooth_fixes(drive.fixes, drive.run, ramp, level_rig());
    REQUIRE(smoothed.has_value());
    REQUIRE_MESSAGE((*smoothed)[5].predicted, (*smoothed)[5].reason);
    const Attitude& attitude = (*smoothed)[5].attitude.value();
    CHECK(attitude.pitch == doctest::Approx(-std::cos(heading) * std::atan(kGrade)).epsilon(1e-3));
    CHECK(std::abs(attitude.roll) < 0.01);
  }
}

TEST_CASE("a predicted position relies on its neighbour, not on what was measured in its own row") {
  Drive drive;
  for (int row = 0; row < 10; ++row) {
    add_row(drive, 0.1 * row, {0, 0.1 * row, 0});
    const double aside = row == 5 ? 3 : 0;  // contradicts the motion
    locate_last(drive, {aside, 0.1 * row, 0, 0}, 1e-6 * Eigen::Matrix4d::Identity());
    Fix& fix = drive.fixes.back();
    fix.tags = {row % 2 == 0 ? "000L" : "001L"};
    fix.notes = {kOneTagOnly};
    fix.unconfirmed = "its photo may be of another moment";
    fix.unchecked = {{}};
    fix.chi_square = 7;
    fix.degrees_of_freedom = 5;
  }
  const Fix predicted = smooth_fixes(drive.fixes, drive.run, hall(), level_rig()).value()[5];
  REQUIRE(predicted.predicted);
  CHECK(predicted.confirmations == 0);
  CHECK(predicted.unchecked.empty());
  CHECK(predicted.degrees_of_freedom == 0);
  CHECK(std::ranges::count(predicted.notes, std::string(kOneTagOnly)) == 0);
  for (Fix& fix : drive.fixes) fix.unconfirmed.clear();
  CHECK(smooth_fixes(drive.fixes, drive.run, hall(), level_rig()).value()[5].confirmations == 1);
}

TEST_CASE("a lone wrong fix at the start loses against those that follow") {
  Drive drive;
  const Eigen::Matrix4d covariance = 1e-6 * Eigen::Matrix4d::Identity();
  for (int row = 0; row < 12; ++row) {
    add_row(drive, 0.1 * row, {0, 0.1 * row, 0});
    locate_last(drive, {row == 0 ? 3.0 : 0.0, 0.1 * row, 0, 0}, covariance);
  }
  const auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE(smoothed.has_value());
  CHECK_FALSE(smoothed->front().position_in_grid.has_value());
  CHECK(smoothed->front().reason.find("contradicts the motion") == 0);
  for (std::size_t row = 1; row < 12; ++row) {
    REQUIRE((*smoothed)[row].position_in_grid.has_value());
    CHECK(std::abs((*smoothed)[row].position_in_grid->x()) < 0.01);
  }
}

TEST_CASE("headings are smoothed across the half turn") {
  Drive drive;
  for (int row = 0; row < 20; ++row) {
    const double heading = std::remainder(radians(175 + row), 2 * radians(180));
    add_row(drive, 0.1 * row, {0, 0, 0});
    locate_last(drive, {0, 0, 0, heading}, 1e-6 * Eigen::Matrix4d::Identity());
  }
  const auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE(smoothed.has_value());
  for (int row = 0; row < 20; ++row) {
    const Fix& fix = (*smoothed)[static_cast<std::size_t>(row)];
    REQUIRE(fix.attitude.has_value());
    CHECK_FALSE(fix.predicted);
    CHECK(std::abs(std::remainder(fix.attitude->heading - radians(175 + row), 2 * radians(180))) <
          radians(0.2));
  }
}

TEST_CASE("smoothing needs times that increase, and headings") {
  Drive drive;
  for (int row = 0; row < 3; ++row) {
    add_row(drive, row, {0, 0, 0});
    locate_last(drive, {0, 0, 0, 0}, 1e-6 * Eigen::Matrix4d::Identity());
  }
  drive.run.file = "run.csv";
  drive.run.measurements[1].time.reset();
  auto smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE_FALSE(smoothed.has_value());
  CHECK(smoothed.error().message.starts_with("run.csv:3: "));
  drive.run.measurements[1].time = 0;
  smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE_FALSE(smoothed.has_value());
  CHECK(smoothed.error().message.starts_with("run.csv:3: time 0 "));
  drive.run.measurements[1].time = 1;
  drive.fixes[2].attitude.reset();
  smoothed = smooth_fixes(drive.fixes, drive.run, hall(), level_rig());
  REQUIRE_FALSE(smoothed.has_value());
  CHECK(smoothed.error().message.starts_with("measurement 2 "));
}
