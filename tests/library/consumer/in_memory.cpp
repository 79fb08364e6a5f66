// SPDX-License-Identifier: Apache-2.0
// Nothing but memory: a tag is drawn, read and graded, and a vehicle located by a survey and a rig
// that are made here. Prints a line for each and ends with 1 when something is not as expected.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include <tagsmith/drawing.hpp>
#include <tagsmith/error.hpp>
#include <tagsmith/grade.hpp>
#include <tagsmith/localize.hpp>
#include <tagsmith/plan.hpp>
#include <tagsmith/read.hpp>
#include <tagsmith/version.hpp>

namespace {

constexpr double kPixelsPerMetre = 2000;
constexpr int kMargin = 100;

bool all_good = true;

void expect(bool good, const std::string& what) {
  std::cout << (good ? "good: " : "WRONG: ") << what << '\n';
  all_good = all_good && good;
}

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples{};

  tagsmith::ImageView view() const { return {samples.data(), width, height, 0}; }
};

int pixel_of(double metres) {
  return kMargin + static_cast<int>(std::lround(metres * kPixelsPerMetre));
}

// Paints a rectangle of the plate frame, whose origin the plate's corner moves into the picture.
void paint(Picture& picture, const tagsmith::Rectangle& plate, const tagsmith::Rectangle& area,
           std::uint8_t shade) {
  for (int y = pixel_of(area.y - plate.y); y < pixel_of(area.y + area.height - plate.y); ++y) {
    for (int x = pixel_of(area.x - plate.x); x < pixel_of(area.x + area.width - plate.x); ++x) {
      picture.samples[static_cast<std::size_t>(y * picture.width + x)] = shade;
    }
  }
}

Picture picture_of(const tagsmith::TagDrawing& tag) {
  Picture picture{pixel_of(tag.plate.width) + kMargin, pixel_of(tag.plate.height) + kMargin};
  picture.samples.assign(static_cast<std::size_t>(picture.width * picture.height), 90);
  paint(picture, tag.plate, tag.plate, 230);
  paint(picture, tag.plate, tag.frame_outer, 20);
  paint(picture, tag.plate, tag.frame_inner, 230);
  for (const tagsmith::Rectangle& bar : tag.bars) paint(picture, tag.plate, bar, 20);
  return picture;
}

void read_and_grade() {
  const std::string digits = "036000291452";
  const Picture picture = picture_of(tagsmith::draw_tag({}, digits));
  const tagsmith::ReadResult result = tagsmith::read(picture.view());
  expect(result.tags.size() == 1 && result.tags[0].digits == digits, "reads what it drew");
  if (result.tags.empty()) return;
  expect(result.tags[0].gs1_holds && result.tags[0].corner_covariance.has_value(),
         "with its check digit and the covariance of its corners");
  const tagsmith::Grade grade = tagsmith::grade(picture.view(), result.tags[0].corners);
  expect(grade.grade > 3.5, "and grades it well");
}

tagsmith::Survey small_survey() {
  tagsmith::SurveyDescription description;
  description.name = "small";
  description.centerline = {{10, 0, 0}};
  description.width = 2;
  description.height = 3;
  description.tags = {{"000L", {-1, 1, 0.5}}, {"001L", {-1, 2, 0.5}}, {"000R", {1, 1.343, 0.5}}};
  // Nothing below the origin can be coded.
  description.code.origin = {-10, 0, 0};
  return tagsmith::Survey(description);
}

tagsmith::Rig small_rig() {
  tagsmith::RigDescription description;
  description.name = "small";
  tagsmith::RigCamera camera;
  camera.name = "left";
  camera.model = {1280, 960, 900, 900, 639.5, 479.5, {}, tagsmith::LensModel::perspective};
  camera.vehicle_from_camera = tagsmith::mounting({0, 0, 0}, std::acos(-1.0) / 2);
  camera.sigma = tagsmith::CalibrationSigma{};
  description.cameras = {camera};
  description.vehicle_height = 0.4;
  return tagsmith::Rig(description);
}

// The corners of a tag of the left wall in the camera that looks at it from (0, y, z).
tagsmith::SeenTag seen_from(const tagsmith::SurveyTag& tag, double y, double z) {
  const tagsmith::PlateTemplate plate;
  tagsmith::SeenTag seen;
  seen.camera = "left";
  seen.digits = tag.digits;
  const auto pixel = [&](double right, double down) {
    const double along = tag.corner_p[1] + right - y;
    const double up = tag.corner_p[2] - down - z;
    return tagsmith::Point{639.5 + 900 * along, 479.5 - 900 * up};
  };
  seen.corners = {pixel(0, 0), pixel(plate.frame_inner_length, 0),
                  pixel(plate.frame_inner_length, plate.frame_inner_height),
                  pixel(0, plate.frame_inner_height)};
  return seen;
}

void locate() {
  const tagsmith::Survey survey = small_survey();
  expect(survey.tags().size() == 3 && survey.find("000R")->side == tagsmith::Side::right,
         "a survey in memory finds its tags");
  tagsmith::Localizer localizer({survey}, small_rig());
  tagsmith::Measurement measurement;
  measurement.tags = {seen_from(survey.tags()[0], 1.6, 0.4), seen_from(survey.tags()[2], 1.6, 0.4)};
  const tagsmith::Fix fix = localizer.locate(measurement);
  expect(fix.position.has_value(), "locates a vehicle by corners: " + fix.reason);
  if (!fix.position) return;
  const auto& [x, y, z] = *fix.position;
  expect(std::abs(x) < 1e-3 && std::abs(y - 1.6) < 1e-3 && std::abs(z - 0.4) < 1e-3,
         "to a millimetre");
  measurement.time = 1.0;
  expect(localizer.track(measurement).position.has_value(), "while it drives too");
  tagsmith::PlanOptions options;
  options.from = 0.5;
  options.to = 2.5;
  const tagsmith::PlanSummary plan = tagsmith::plan(survey, small_rig(), options);
  expect(plan.covered_share > 0 && plan.unread_tags.size() == 1, "and plans its drive");
  expect(plan.plane_sigma && plan.plane_sigma->median > 0 && plan.height_sigma &&
             plan.height_sigma->median > 0,
         "with its accuracy in the plane and in height");
}

void refuse() {
  try {
    tagsmith::read({});
    expect(false, "refuses a view of nothing");
  } catch (const tagsmith::Error& error) {
    expect(error.code() == tagsmith::ErrorCode::invalid_argument, error.what());
  }
  try {
    tagsmith::Measurement lopsided;
    const tagsmith::Survey survey = small_survey();
    lopsided.tags = {seen_from(survey.tags()[0], 1.6, 0.4)};
    auto& covariance = lopsided.tags[0].covariance.emplace();
    for (std::size_t i = 0; i < 8; ++i) covariance[i][i] = 0.1;
    covariance[0][1] = 0.01;
    tagsmith::Localizer({survey}, small_rig()).locate(lopsided);
    expect(false, "refuses a covariance that is not symmetric");
  } catch (const tagsmith::Error& error) {
    expect(error.code() == tagsmith::ErrorCode::invalid_argument, error.what());
  }
  tagsmith::SurveyDescription twice;
  try {
    twice.name = "twice";
    twice.centerline = {{10, 0, 0}};
    twice.width = 2;
    twice.height = 3;
    twice.tags = {{"000L", {-1, 1, 0.5}}};
    const tagsmith::Survey survey(twice);
    expect(false, "refuses a position that cannot be coded");
  } catch (const std::runtime_error& error) {
    expect(std::string(error.what()).find("cod") != std::string::npos, error.what());
  }
}

}  // namespace

int main() {
  std::cout << "tagsmith " << tagsmith::version() << '\n';
  read_and_grade();
  locate();
  refuse();
  return all_good ? 0 : 1;
}
