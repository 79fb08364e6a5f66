// SPDX-License-Identifier: Apache-2.0
// The public interface from memory: what a survey and a rig made by a program are worth, and that
// values nobody can use are refused with words.
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <tagsmith/files.hpp>
#include <tagsmith/grade.hpp>
#include <tagsmith/localize.hpp>
#include <tagsmith/plan.hpp>

namespace tagsmith::detail::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const std::string kCorridor = "surveys/corridor/";

// The shipped corridor as a program would make it.
SurveyDescription corridor() {
  const tagsmith::Survey shipped = tagsmith::load_survey(kCorridor + "survey.yaml");
  SurveyDescription description;
  description.name = "made";
  description.x_axis_left = true;
  description.start = {0.95, 0, 0};
  description.centerline = {{10, 0, 0}};
  description.width = 1.9;
  description.height = 3;
  description.code.check_digit = tagsmith::CheckDigit::sum10;
  description.sigma = 0.002;
  description.angle_sigma = 0;
  for (const SurveyTag& tag : shipped.tags()) {
    description.tags.push_back({tag.name, tag.corner_p, {}, {}});
  }
  return description;
}

// The error that is thrown; ends the test when there is none.
tagsmith::Error error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const tagsmith::Error& error) {
    return error;
  }
  FAIL("nothing was thrown");
  return {ErrorCode::failed, ""};
}

void check_refused(const char* name, const std::function<void()>& work, const std::string& words) {
  CAPTURE(name);
  const tagsmith::Error error = error_of(work);
  CHECK(error.code() == ErrorCode::invalid_argument);
  CHECK_MESSAGE(std::string(error.what()).find(words) != std::string::npos, error.what());
}

tagsmith::Measurement first_point(const std::vector<Image>& photos) {
  tagsmith::Measurement measurement;
  measurement.images = {{"left", photos[0].view()}, {"right", photos[1].view()}};
  measurement.ranges = {{"d", 0.906}};
  return measurement;
}

std::vector<Image> first_photos() {
  return {tagsmith::load_image(kCorridor + "photos/corridor_01_left.jpg"),
          tagsmith::load_image(kCorridor + "photos/corridor_01_right.jpg")};
}

}  // namespace

TEST_CASE("a survey made in memory is the survey of the file") {
  const tagsmith::Survey made{corridor()};
  const tagsmith::Survey shipped = tagsmith::load_survey(kCorridor + "survey.yaml");
  REQUIRE(made.tags().size() == shipped.tags().size());
  for (const SurveyTag& tag : shipped.tags()) {
    CAPTURE(tag.name);
    const auto same = made.find(tag.name);
    REQUIRE(same.has_value());
    CHECK(same->digits == tag.digits);
    CHECK(same->side == tag.side);
    CHECK(same->coded_position == tag.coded_position);
    CHECK(same->chainage == doctest::Approx(tag.chainage));
    CHECK(made.find(tag.digits)->name == tag.name);
  }
}

TEST_CASE("a survey and a rig made in memory locate as those of the files do") {
  const tagsmith::Rig shipped = tagsmith::load_rig(kCorridor + "rig.yaml");
  const tagsmith::Rig made{shipped.description()};
  const std::vector<Image> photos = first_photos();
  const tagsmith::Fix expected =
      Localizer({tagsmith::load_survey(kCorridor + "survey.yaml")}, shipped)
          .locate(first_point(photos));
  const tagsmith::Fix fix =
      Localizer({tagsmith::Survey(corridor())}, made).locate(first_point(photos));
  REQUIRE_MESSAGE(fix.position.has_value(), fix.reason);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK((*fix.position)[i] == doctest::Approx((*expected.position)[i]).epsilon(1e-9));
  }
  CHECK(fix.tags == expected.tags);
}

TEST_CASE("surveys that cannot be are refused with the reason") {
  using Change = std::function<void(SurveyDescription&)>;
  const std::vector<std::tuple<const char*, Change, const char*>> cases{
      {"no name", [](auto& s) { s.name.clear(); }, "no name"},
      {"no center line", [](auto& s) { s.centerline.clear(); }, "center line is empty"},
      {"a length that is none", [](auto& s) { s.centerline[0].length = kNan; }, "no number"},
      {"a width below zero", [](auto& s) { s.width = -1; }, "width is -1"},
      {"digit counts",
       [](auto& s) {
         s.code.digit_counts = {4, 4, 4};
       },
       "sum to 11"},
      {"a tag's name", [](auto& s) { s.tags[0].name = "first"; }, "`first`"},
      {"a name twice", [](auto& s) { s.tags[1].name = s.tags[0].name; }, "named 000L"},
      {"a place that is none", [](auto& s) { s.tags[0].corner_p[1] = kNan; }, "000L"},
      {"eleven digits", [](auto& s) { s.tags[0].digits = "12345678901"; }, "twelve digits"},
      {"a tag in the rock", [](auto& s) { s.tags[0].corner_p[0] += 3; }, "000L"},
      {"a frame larger than the plate", [](auto& s) { s.plate.plate_length = 0.3; },
       "needs a plate"},
      {"a frame that leaves its plate upwards", [](auto& s) { s.plate.frame_offset_up = 0.1; },
       "needs a plate"},
      {"a plate that one stroke leaves",
       [](auto& s) { s.plate.plate_height = s.plate.frame_inner_height + s.plate.frame_stroke; },
       "needs a plate"},
      {"a width beyond a kilometre", [](auto& s) { s.width = 1000.5; }, "width is 1000.5"},
      {"margins without bars", [](auto& s) { s.plate.margin_modules = 40; }, "no room"},
  };
  for (const auto& [name, change, words] : cases) {
    SurveyDescription description = corridor();
    change(description);
    check_refused(
        name, [&] { const tagsmith::Survey survey(description); }, words);
  }
}

TEST_CASE("rigs that cannot be are refused with the reason") {
  using Change = std::function<void(RigDescription&)>;
  const std::vector<std::tuple<const char*, Change, const char*>> cases{
      {"no camera", [](auto& r) { r.cameras.clear(); }, "no camera"},
      {"a camera without a name", [](auto& r) { r.cameras[0].name.clear(); }, "no name"},
      {"one name for two", [](auto& r) { r.ranges[0].name = "left"; }, "named left"},
      {"no pixels", [](auto& r) { r.cameras[0].model.width = 0; }, "width is 0"},
      {"no focal length", [](auto& r) { r.cameras[0].model.fx = kNan; }, "focal length"},
      {"a mirror",
       [](auto& r) {
         r.cameras[0].vehicle_from_camera.rotation[0] = {0, 0, -1};
       },
       "no rotation"},
      {"a range upside down", [](auto& r) { r.ranges[0].max = r.ranges[0].min - 1; }, "greatest"},
      {"no height", [](auto& r) { r.vehicle_height = kNan; }, "height"},
      {"a vehicle that stands across the drive", [](auto& r) { r.envelope = Envelope{.yaw = 2}; },
       "yaw is 2"},
  };
  const RigDescription shipped = tagsmith::load_rig(kCorridor + "rig.yaml").description();
  for (const auto& [name, change, words] : cases) {
    RigDescription description = shipped;
    change(description);
    check_refused(
        name, [&] { const tagsmith::Rig rig(description); }, words);
  }
}

TEST_CASE("a rig's rolling shutters are given and read beside its description") {
  using tagsmith::Readout;
  using tagsmith::Rig;
  const RigDescription description = tagsmith::load_rig(kCorridor + "rig.yaml").description();
  CHECK(Rig(description).readouts().empty());
  const Rig rolling(description, {{"right", 0.03}});
  REQUIRE(rolling.readouts().size() == 1);
  CHECK(rolling.readouts()[0].camera == "right");
  CHECK(rolling.readouts()[0].seconds == 0.03);
  check_refused(
      "no such camera",
      [&] {
        const Rig rig(description, {{"roof", 0.03}});
      },
      "camera roof");
  check_refused(
      "milliseconds",
      [&] {
        const Rig rig(description, {{"left", 30}});
      },
      "camera left is 30");
}

// docs/library.md promises that no struct changes its members before the next major version: a
// program that was compiled with version 1.0.0 would read others.
#if defined(__x86_64__) && defined(__GLIBCXX__) && !defined(_GLIBCXX_DEBUG)
TEST_CASE("the structs of the interface have the sizes of version 1") {
  struct Size {
    const char* name;
    std::size_t now, then;
  };
  const Size sizes[]{
      {"PlateTemplate", sizeof(tagsmith::PlateTemplate), 112},
      {"Rectangle", sizeof(tagsmith::Rectangle), 32},
      {"TagDrawing", sizeof(tagsmith::TagDrawing), 128},
      {"Error", sizeof(tagsmith::Error), 24},
      {"Image", sizeof(tagsmith::Image), 64},
      {"FileFinding", sizeof(tagsmith::FileFinding), 144},
      {"VerifiedTag", sizeof(tagsmith::VerifiedTag), 224},
      {"VerifiedFile", sizeof(tagsmith::VerifiedFile), 112},
      {"VerifyOptions", sizeof(tagsmith::VerifyOptions), 48},
      {"Point", sizeof(tagsmith::Point), 16},
      {"ReflectanceReferences", sizeof(tagsmith::ReflectanceReferences), 32},
      {"GradeParameter", sizeof(tagsmith::GradeParameter), 56},
      {"Grade", sizeof(tagsmith::Grade), 72},
      {"ImageView", sizeof(tagsmith::ImageView), 24},
      {"CameraView", sizeof(tagsmith::CameraView), 56},
      {"SeenTag", sizeof(tagsmith::SeenTag), 648},
      {"Measurement", sizeof(tagsmith::Measurement), 144},
      {"Attitude", sizeof(tagsmith::Attitude), 24},
      {"Dropped", sizeof(tagsmith::Dropped), 96},
      {"Unchecked", sizeof(tagsmith::Unchecked), 72},
      {"Fix", sizeof(tagsmith::Fix), 680},
      {"LocalizerOptions", sizeof(tagsmith::LocalizerOptions), 1},
      {"Localizer", sizeof(tagsmith::Localizer), 8},
      {"PlanOptions", sizeof(tagsmith::PlanOptions), 88},
      {"WallShares", sizeof(tagsmith::WallShares), 24},
      {"Stretch", sizeof(tagsmith::Stretch), 16},
      {"SigmaRange", sizeof(tagsmith::SigmaRange), 24},
      {"CriticalTag", sizeof(tagsmith::CriticalTag), 56},
      {"PlanSummary", sizeof(tagsmith::PlanSummary), 280},
      {"ReadOptions", sizeof(tagsmith::ReadOptions), 184},
      {"Tag", sizeof(tagsmith::Tag), 736},
      {"FramelessTag", sizeof(tagsmith::FramelessTag), 208},
      {"Refusal", sizeof(tagsmith::Refusal), 128},
      {"ReadResult", sizeof(tagsmith::ReadResult), 72},
      {"CameraModel", sizeof(tagsmith::CameraModel), 112},
      {"Mounting", sizeof(tagsmith::Mounting), 96},
      {"CalibrationSigma", sizeof(tagsmith::CalibrationSigma), 40},
      {"RigCamera", sizeof(tagsmith::RigCamera), 312},
      {"Readout", sizeof(tagsmith::Readout), 40},
      {"RigRange", sizeof(tagsmith::RigRange), 64},
      {"Envelope", sizeof(tagsmith::Envelope), 40},
      {"RigDescription", sizeof(tagsmith::RigDescription), 160},
      {"Rig", sizeof(tagsmith::Rig), 16},
      {"SurveyTag", sizeof(tagsmith::SurveyTag), 144},
      {"CenterlinePart", sizeof(tagsmith::CenterlinePart), 24},
      {"PositionCode", sizeof(tagsmith::PositionCode), 64},
      {"TagPlace", sizeof(tagsmith::TagPlace), 112},
      {"SurveyDescription", sizeof(tagsmith::SurveyDescription), 344},
      {"Survey", sizeof(tagsmith::Survey), 16},
  };
  for (const auto& [name, now, then] : sizes) CHECK_MESSAGE(now == then, name);
}
#endif

TEST_CASE("a file is validated as what its first key says that it is") {
  for (const char* file : {"surveys/corridor/survey.yaml", "surveys/corridor/rig.yaml",
                           "templates/tag-400x300.yaml"}) {
    CAPTURE(file);
    CHECK(tagsmith::validate(file).empty());
  }
}

TEST_CASE("arguments that nobody can use are refused with the reason") {
  const tagsmith::Survey survey = tagsmith::load_survey(kCorridor + "survey.yaml");
  const tagsmith::Rig rig = tagsmith::load_rig(kCorridor + "rig.yaml");
  const std::vector<Image> photos = first_photos();
  ImageView narrow = photos[0].view();
  narrow.stride = 5;
  tagsmith::ReadOptions of_camera;
  of_camera.camera = rig.cameras()[0].model;
  of_camera.camera->width = 640;
  tagsmith::PlanOptions even;
  even.headings = 4;
  tagsmith::SeenTag seen{"left", survey.tags()[0].digits, {}, CornerCovariance{}};
  tagsmith::Measurement measurement;
  measurement.tags = {seen};
  const Localizer localizer({survey}, rig);
  check_refused(
      "an overlapping stride", [&] { tagsmith::read(narrow); }, "stride");
  check_refused(
      "another camera's size", [&] { tagsmith::read(photos[0].view(), of_camera); },
      "expected 640");
  check_refused(
      "an even number", [&] { tagsmith::plan(survey, rig, even); }, "headings");
  check_refused(
      "no survey", [&] { const Localizer none({}, rig); }, "no survey");
  check_refused(
      "a survey twice",
      [&] {
        const Localizer twice({survey, survey}, rig);
      },
      "the survey is named corridor");
  check_refused(
      "another survey of equal codes",
      [&] {
        tagsmith::verify(survey, {}, {{tagsmith::Survey(corridor())}, {}, 1});
      },
      "code-collision");
  check_refused(
      "no covariance", [&] { localizer.locate(measurement); }, "positive definite");
  check_refused(
      "no digits", [&] { tagsmith::draw_tag({}, "abc"); }, "twelve digits");
  check_refused(
      "corners that are none",
      [&] {
        tagsmith::grade(photos[0].view(), {Point{kNan, 0}});
      },
      "corner");
  check_refused(
      "another extension", [&] { tagsmith::print_tag(survey, "000L", "a.gif"); }, "a.gif");
}

TEST_CASE("a picture too coarse to be graded says so") {
  const tagsmith::Image photo = tagsmith::load_image(kCorridor + "photos/corridor_10_left.jpg");
  for (const tagsmith::Tag& tag : tagsmith::read(photo.view()).tags) {
    if (tag.module_px >= 4) continue;
    CHECK(error_of([&] { tagsmith::grade(photo.view(), tag.corners); }).code() ==
          ErrorCode::failed);
  }
}

TEST_CASE("threads may locate with one localizer at once") {
  const Localizer localizer({tagsmith::load_survey(kCorridor + "survey.yaml")},
                            tagsmith::load_rig(kCorridor + "rig.yaml"));
  const std::vector<Image> photos = first_photos();
  std::vector<tagsmith::Fix> fixes(4);
  std::vector<std::thread> threads;
  threads.reserve(fixes.size());
  for (tagsmith::Fix& fix : fixes) {
    threads.emplace_back([&] { fix = localizer.locate(first_point(photos)); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const tagsmith::Fix& fix : fixes) CHECK(fix.position == fixes.front().position);
}

}  // namespace tagsmith::detail::test
