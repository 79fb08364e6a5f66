// SPDX-License-Identifier: Apache-2.0
// `tagsmith calibrate` as its users run it, on rendered photos of a board.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "decoder/image/load.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_calibration.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tests/calibrate_command/board_photo_files.hpp"
#include "tests/schemas/schema_judge.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using nlohmann::json;

namespace {

// Twelve varied photos and the board's file, made once.
const fs::path& good_set() {
  static const TemporaryFolder folder;
  static const bool made = [] {
    fs::create_directory(folder.path() / "photos");
    const Board board = plate_board();
    write_varied_photos(folder.path() / "photos", photo_camera(), board, 12);
    write_board(folder.path() / "board.yaml", board);
    return true;
  }();
  REQUIRE(made);
  return folder.path();
}

std::string good_board() { return " --board " + (good_set() / "board.yaml").string() + " "; }

std::string good_photos() { return (good_set() / "photos").string() + " "; }

// A few of them, for what does not ask for a good calibration.
std::string some_photos() {
  std::string names;
  for (const char* name : {"photo00.png", "photo04.png", "photo08.png", "photo11.png"}) {
    names += (good_set() / "photos" / name).string() + " ";
  }
  return names;
}

ProgramOutput run_calibrate(const std::string& arguments) {
  return run_tagsmith("calibrate " + arguments);
}

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

void check_by_schema(const std::string& text) {
  SchemaJudge judge(schema_json("output/calibrate"));
  for (json line : json_lines(text)) {
    CHECK_MESSAGE(judge.accepts(line), line.dump() << "\n" << judge.objections(line));
    line["colour"] = 1;
    CHECK_FALSE(judge.accepts(line));
  }
}

const char* const kRig =
    "rig: loader\n"
    "cameras:\n"
    "  # bought in May\n"
    "  left: { image_size: [960, 720], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, "
    "side: "
    "left }  # front\n"
    "  right: { image_size: [1280, 960], fx: 900, fy: 900, cx: 640, cy: 480, yaw: -90 }\n"
    "vehicle: { height: 0.24 }\n";

// What a run with everything left in this folder, run once.
struct GoodRun {
  TemporaryFolder folder;
  ProgramOutput output;
  json summary;

  GoodRun() {
    REQUIRE(write_file(file("rig.yaml"), kRig));
    output = run_calibrate(good_board() + good_photos() + "--json -o " +
                           file("cameras/left.yaml").string() + " --html " +
                           file("page.html").string() + " --drawing " + file("sheet.svg").string() +
                           " --rig " + file("rig.yaml").string() + " --camera left");
    REQUIRE_MESSAGE(output.exit_code == 0, output.out << output.err);
    summary = json_lines(output.out).back()["summary"];
  }

  fs::path file(const char* name) const { return folder.path() / name; }
};

const GoodRun& good_run() {
  static const GoodRun run;
  return run;
}

// The corridor's rig calibrated by a run of these rows.
ProgramOutput mounting_by(const fs::path& folder, const std::string& rows) {
  const fs::path run = folder / "run.csv";
  REQUIRE(write_file(run, rows));
  return run_tagsmith(
      "calibrate --survey surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --run '" +
      run.string() + "'");
}

}  // namespace

TEST_CASE("good photos make a camera within its sigmas") {
  const GoodRun& run = good_run();
  const json& summary = run.summary;
  check_by_schema(run.output.out);
  CHECK(json_lines(run.output.out).size() == 13);
  CHECK(summary["verdict"] == "good");
  const Camera truth = photo_camera();
  const auto within = [](double value, double expected, double sigma) {
    CAPTURE(value);
    CAPTURE(expected);
    CHECK(std::abs(value - expected) < 4 * sigma);
  };
  within(summary["camera"]["fx"], truth.fx, summary["sigma"]["fx"]);
  within(summary["camera"]["cx"], truth.cx, summary["sigma"]["cx"]);
  within(summary["camera"]["cy"], truth.cy, summary["sigma"]["cy"]);
  within(summary["camera"]["distortion"][0], truth.distortion[0],
         summary["sigma"]["distortion"][0]);
  CHECK(summary["sigma"]["fx"] < 0.3);

  const auto reading = read_calibration({run.file("cameras/left.yaml"), "", std::nullopt});
  REQUIRE(reading.has_value());
  REQUIRE(reading->value.has_value());
  CHECK(reading->value->fx == summary["camera"]["fx"]);
  CHECK(reading->value->width == truth.width);
  CHECK(reading->value->distortion[1] == summary["camera"]["distortion"][1]);
}

TEST_CASE("page and drawing say the verdict and show every photo") {
  const GoodRun& run = good_run();
  const std::string page = read_file(run.file("page.html")).value();
  CHECK(has(page, "<p class=\"verdict good\">good</p>"));
  CHECK(has(page, "photo11.png"));
  CHECK_FALSE(has(page, "http://"));
  const std::string sheet = read_file(run.file("sheet.svg")).value();
  CHECK(has(sheet, "Verdict: good"));
  CHECK(has(sheet, "Distortion"));
}

TEST_CASE("the words say numbers, sigmas, the form and the lines for the rig") {
  const TemporaryFolder folder;
  const ProgramOutput output = run_calibrate(good_board() + good_photos() + "--format ros -o " +
                                             (folder.path() / "left.yaml").string());
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  for (const char* words :
       {"12 of 12 photos of 960 x 720 pixels used", "lens form: perspective", "runner-up", "  cx ",
        "sigma", "calibration: ", "sigma: { focal: ", "verdict: good"}) {
    CHECK_MESSAGE(has(output.out, words), words << "\n" << output.out);
  }
  CHECK(has(read_file(folder.path() / "left.yaml").value(), "distortion_model: plumb_bob"));
}

TEST_CASE("three frontal photos make no camera") {
  const TemporaryFolder folder;
  const Camera camera = photo_camera();
  for (int i = 0; i < 3; ++i) {
    const BoardStance stance{{400.0 + 60 * i, 360.0}, 0.7, 0.01 * i, 0.02, 0};
    write_photo(folder.path() / ("front" + std::to_string(i) + ".png"), camera, plate_board(),
                stance, static_cast<std::uint64_t>(i));
  }
  // A copy is no photo of its own.
  fs::copy_file(folder.path() / "front0.png", folder.path() / "copy.png");
  const fs::path file = folder.path() / "out" / "camera.yaml";
  const ProgramOutput output =
      run_calibrate(good_board() + folder.path().string() + " --json -o " + file.string());
  CHECK(output.exit_code == 1);
  const auto lines = json_lines(output.out);
  CHECK(lines.size() == 5);
  CHECK(std::ranges::count_if(lines, [](const json& line) { return line.contains("objection"); }) ==
        1);
  CHECK_FALSE(fs::exists(file));
  CHECK(has(output.err, "was not written: the calibration is refused"));
  check_by_schema(output.out);
  const json summary = json_lines(output.out).back()["summary"];
  CHECK(summary["verdict"] == "refused");
  bool frontal = false;
  for (const json& finding : summary["findings"]) frontal |= finding["rule"] == "all_frontal";
  CHECK(frontal);
}

TEST_CASE("photos without the board are named; without any there is no camera") {
  const TemporaryFolder folder;
  const fs::path empty = folder.path() / "empty.png";
  write_photo(empty, photo_camera(), plate_board(0, 77), {{480, 360}, 0.7, 0.3, 0.1, 0}, 1);
  const ProgramOutput with = run_calibrate(good_board() + some_photos() + empty.string());
  CHECK(with.exit_code != 2);
  CHECK(has(with.out, "no tag of a board: " + empty.string()));

  const ProgramOutput without = run_calibrate(good_board() + empty.string() + " --json");
  CHECK(without.exit_code == 1);
  check_by_schema(without.out);
  const json summary = json_lines(without.out).back()["summary"];
  CHECK(summary["verdict"] == "refused");
  CHECK(has(summary["reason"], "0 of the boards' tags read in 1 photos"));
  CHECK(has(without.err, "0 of the boards' tags"));
}

TEST_CASE("a photo of another size, a broken one and a wrong board are refused by name") {
  const TemporaryFolder folder;
  const fs::path other = folder.path() / "other.png";
  Camera camera = photo_camera();
  camera.width = 800;
  write_photo(other, camera, plate_board(), {{400, 360}, 0.7, 0.3, 0.1, 0}, 1);
  const ProgramOutput sizes = run_calibrate(good_board() + some_photos() + other.string());
  CHECK(sizes.exit_code == 2);
  CHECK(has(sizes.err, other.string() + ": is 800 x 720 pixels, expected 960 x 720"));

  const fs::path broken = folder.path() / "broken.png";
  REQUIRE(write_file(broken, "no picture"));
  const std::string gone = (folder.path() / "gone.png").string();
  const ProgramOutput unreadable =
      run_calibrate(good_board() + some_photos() + broken.string() + " " + gone);
  CHECK(unreadable.exit_code == 2);
  CHECK(has(unreadable.err, broken.string()));
  CHECK(has(unreadable.err, gone));

  const fs::path board = folder.path() / "board.yaml";
  REQUIRE(write_file(board, "board: b\nsheet: [1\n"));
  CHECK(run_calibrate("--board " + board.string() + " " + some_photos()).exit_code == 2);
}

TEST_CASE("a board whose file is of another print does not pass for good") {
  const TemporaryFolder folder;
  std::string text = read_file(good_set() / "board.yaml").value();
  // Said to be a third of a percent wider than it is, and as high.
  const std::size_t at = text.find("a_b_mm: 584, a_c_mm: 384, sigma_mm");
  REQUIRE(at != std::string::npos);
  const std::size_t line = text.rfind("# measured", at);
  text.replace(line, std::string("# measured").size(), "measured");
  text.replace(text.find("a_b_mm: 584, a_c_mm: 384, sigma_mm"), 11, "a_b_mm: 586");
  const fs::path board = folder.path() / "board.yaml";
  REQUIRE(write_file(board, text));
  const ProgramOutput output =
      run_calibrate("--board " + board.string() + " " + good_photos() + " --json");
  REQUIRE_MESSAGE(output.exit_code == 1, output.err);
  const json summary = json_lines(output.out).back()["summary"];
  CHECK(summary["verdict"] != "good");
  bool named = false;
  for (const json& finding : summary["findings"]) named |= finding["rule"] == "board_stretched";
  CHECK_MESSAGE(named, summary["findings"].dump());
}

TEST_CASE("two boards of one serial are refused before photos are read") {
  const TemporaryFolder folder;
  const fs::path twin = write_board(folder.path() / "twin.yaml", plate_board());
  const ProgramOutput output =
      run_calibrate(good_board() + "--board " + twin.string() + " /nowhere.png");
  CHECK(output.exit_code == 2);
  CHECK(has(output.err, "a serial of its own"));
}

TEST_CASE("--rig takes the camera over, keeps comments and loads") {
  const GoodRun& run = good_run();
  const json& summary = run.summary;
  const Result<Rig> loaded = load_rig(run.file("rig.yaml"));
  REQUIRE_MESSAGE(loaded.has_value(), loaded.error().message);
  const RigCamera* left = find_camera(*loaded, "left");
  REQUIRE(left != nullptr);
  CHECK(left->camera.fx == summary["camera"]["fx"]);
  CHECK(left->calibration_sigma.focal ==
        doctest::Approx(summary["rig_sigma"]["focal"].get<double>()).epsilon(0.06));
  CHECK(left->calibration_sigma.center ==
        doctest::Approx(summary["rig_sigma"]["center"].get<double>()).epsilon(0.06));
  const std::string text = read_file(run.file("rig.yaml")).value();
  CHECK(has(text, "calibration: cameras/left.yaml"));
  CHECK(has(text, "  # bought in May\n"));
  CHECK(has(text, "alpha: 35, side: left }  # front\n"));
  CHECK(has(text, "cx: 640, cy: 480, yaw: -90 }\n"));
}

TEST_CASE("--rig takes a camera over while another one of the rig lacks its calibration yet") {
  const TemporaryFolder folder;
  const fs::path rig = folder.path() / "rig.yaml";
  REQUIRE(write_file(rig,
                     "rig: crawler\n"
                     "cameras:\n"
                     "  left:  { calibration: left.yaml, alpha: 35, side: left }\n"
                     "  right: { calibration: right.yaml, alpha: 35, side: right }\n"
                     "vehicle: { height: 0.24 }\n"));
  const fs::path file = folder.path() / "left.yaml";
  const ProgramOutput output = run_calibrate(good_board() + good_photos() + "-o " + file.string() +
                                             " --rig " + rig.string() + " --camera left");
  CHECK_MESSAGE(output.exit_code == 0, output.err);
  CHECK(has(output.err, "what it still lacks"));
  CHECK(has(output.err, "right.yaml: no such file"));
  CHECK(fs::exists(file));
  const std::string text = read_file(rig).value();
  CHECK_MESSAGE(has(text, "sigma: { focal"), text);
  CHECK(has(text, "  right: { calibration: right.yaml, alpha: 35, side: right }\n"));
}

TEST_CASE("a rig that cannot take the camera stays as it is, and nothing is written") {
  const TemporaryFolder folder;
  const fs::path rig = folder.path() / "rig.yaml";
  REQUIRE(write_file(rig, kRig));
  const fs::path file = folder.path() / "camera.yaml";
  const std::string into = "-o " + file.string() + " --rig " + rig.string() + " --camera ";
  // Found out before any photo is read.
  const ProgramOutput front = run_calibrate(good_board() + "/nowhere.png " + into + "front");
  CHECK(front.exit_code == 2);
  CHECK(has(front.err, "no camera `front`"));
  // The photos are of another size than the vehicle's pictures.
  const ProgramOutput right = run_calibrate(good_board() + good_photos() + into + "right");
  CHECK(right.exit_code == 2);
  CHECK(has(right.err, "image_size is 1280 x 960"));
  CHECK(read_file(rig).value() == kRig);
  CHECK_FALSE(fs::exists(file));
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("wrong use is refused with what is right") {
  const TemporaryFolder folder;
  struct Row {
    std::string arguments;
    const char* words;
  };
  const std::string photo = (good_set() / "photos" / "photo00.png").string();
  for (const Row& row :
       {Row{photo, "PHOTO and --board are required"},
        Row{good_board(), "PHOTO and --board are required"},
        Row{good_board() + photo + " --survey s.yaml --rig r.yaml --run r.csv", "excludes"},
        Row{photo + " --survey s.yaml --rig r.yaml --run r.csv", "give one"},
        Row{good_board() + photo + " -o o.yaml --rig r.yaml", "--camera"},
        Row{good_board() + photo + " --drawing a.bmp", ".pdf, .svg or .png"},
        Row{good_board() + photo + " --camera 1st", "--camera 1st"},
        Row{good_board() + photo + " --format xml", "opencv"},
        Row{good_board() + photo + " -o " + photo, "would replace the photo"},
        Row{good_board() + photo + " -o " + (good_set() / "board.yaml").string(),
            "would replace the board"},
        Row{good_board() + photo + " -o x.yaml --html x.yaml", "a name of its own"}}) {
    CAPTURE(row.arguments);
    const ProgramOutput output = run_calibrate(row.arguments);
    CHECK(output.exit_code == 2);
    CHECK_MESSAGE(has(output.err, row.words), output.err);
  }
}

TEST_CASE("a drive tells where cameras look, and the rig is written with it") {
  const TemporaryFolder folder;
  const auto rig = read_file("surveys/corridor/rig.yaml");
  REQUIRE(rig.has_value());
  std::string text = *rig;
  const std::string alpha = "alpha: 35, side: left";
  text.replace(text.find(alpha), alpha.size(), "alpha: 15, side: left");
  const fs::path stated = folder.path() / "stated.yaml";
  const fs::path fitted = folder.path() / "fitted.yaml";
  REQUIRE(write_file(stated, text).has_value());
  const std::string drive = "calibrate --survey surveys/corridor/survey.yaml --rig '" +
                            stated.string() + "' -o '" + fitted.string() + "' --run ";
  const ProgramOutput output = run_tagsmith(drive + "surveys/corridor/run.csv");
  CHECK_MESSAGE(output.exit_code == 0, output.err);
  const auto loaded = load_rig(fitted);
  REQUIRE_MESSAGE(loaded.has_value(), loaded.error().message);
  const MountingAngles left = mounting_angles(loaded->cameras[0].vehicle_from_camera);
  CHECK(std::abs(degrees(left.yaw) - 55) < 0.02);
  CHECK(std::abs(degrees(left.pitch)) < 0.02);
  CHECK(std::abs(degrees(left.roll)) < 0.02);
  CHECK(read_file(fitted)->find("# The crawler of the corridor experiment") == 0);

  fs::remove(fitted);
  const std::string photo = fs::absolute("surveys/corridor/photos/corridor_01_left.jpg").string();
  const fs::path short_run = folder.path() / "short.csv";
  REQUIRE(write_file(short_run, "id,left\n1," + photo + "\n2," + photo + "\n").has_value());
  const ProgramOutput untold = run_tagsmith(drive + "'" + short_run.string() + "'");
  CHECK(untold.exit_code == 1);
  CHECK(untold.err.find("2 of 2 rows") != std::string::npos);
  CHECK_FALSE(fs::exists(fitted));
}

TEST_CASE("what a drive does not tell keeps the rig's own sigma in all cameras") {
  const TemporaryFolder folder;
  std::string text = read_file("surveys/corridor/rig.yaml").value();
  const std::string exact = "sigma: 0 }";
  for (auto at = text.find(exact); at != std::string::npos; at = text.find(exact)) {
    text.replace(at, exact.size(), "sigma: { position: 0.04, angle: 2, focal: 0, center: 0 } }");
  }
  const fs::path stated = folder.path() / "stated.yaml";
  const fs::path fitted = folder.path() / "fitted.yaml";
  REQUIRE(write_file(stated, text));
  const ProgramOutput output = run_tagsmith(
      "calibrate --survey surveys/corridor/survey.yaml --run surveys/corridor/run.csv --rig '" +
      stated.string() + "' -o '" + fitted.string() + "'");
  CHECK_MESSAGE(output.exit_code == 0, output.err);
  CHECK(output.out.find("the rig has it to 0.0400") != std::string::npos);
  CHECK(output.out.find("at 10 places 0.4 m and more apart") != std::string::npos);
  const Result<Rig> rig = load_rig(fitted);
  REQUIRE_MESSAGE(rig, rig.error().message);
  for (const RigCamera& camera : rig->cameras) {
    CHECK(camera.calibration_sigma.position >= 0.04);
    CHECK(camera.calibration_sigma.position < 0.05);
    CHECK(camera.calibration_sigma.angle < radians(0.1));
  }
}

TEST_CASE("photos of one camera that are mirrored top to bottom make no mounting") {
  const TemporaryFolder folder;
  const std::string photos = fs::absolute("surveys/corridor/photos").string();
  std::string rows = "id,left,right\n";
  for (int row = 1; row <= 10; ++row) {
    const GrayImage image =
        load_gray_image(fmt::format("{}/corridor_{:02}_left.jpg", photos, row)).value();
    std::string mirrored = fmt::format("P5 {} {} 255\n", image.width, image.height);
    for (int y = image.height - 1; y >= 0; --y) {
      const std::uint8_t* first = image.view().row(y);
      mirrored.append(first, first + image.width);
    }
    const fs::path left = folder.path() / fmt::format("left{}.pgm", row);
    REQUIRE(write_file(left, mirrored));
    rows += fmt::format("{},{},{}/corridor_{:02}_right.jpg\n", row, left.string(), photos, row);
  }
  const ProgramOutput output = mounting_by(folder.path(), rows);
  CHECK(output.exit_code == 1);
  CHECK_MESSAGE(
      output.err.find("the photos of camera left are mirrored top to bottom") != std::string::npos,
      output.err);
}

TEST_CASE("photos of a drive that cannot be read are named and are a finding") {
  const TemporaryFolder folder;
  const std::string photos = fs::absolute("surveys/corridor/photos").string();
  std::string rows = "id,left,right\n";
  for (int row = 1; row <= 10; ++row) {
    const std::string right =
        row == 4 ? "nope.jpg" : fmt::format("{}/corridor_{:02}_right.jpg", photos, row);
    rows += fmt::format("{},{}/corridor_{:02}_left.jpg,{}\n", row, photos, row, right);
  }
  const ProgramOutput output = mounting_by(folder.path(), rows);
  CHECK(output.exit_code == 1);
  CHECK_MESSAGE(output.err.find("row 4: ") != std::string::npos, output.err);
  CHECK_MESSAGE(output.err.find("nope.jpg: no such file") != std::string::npos, output.err);
}

TEST_CASE("rows with a photo of another row make no mounting") {
  // Plates could give way a little each, and the right camera be where the mean of the rows has it.
  const TemporaryFolder folder;
  const std::string photos = fs::absolute("surveys/corridor/photos").string();
  std::string rows = "id,left,right\n";
  for (int row = 1; row <= 10; ++row) {
    const bool is_late = row == 2 || row == 5 || row == 8;
    rows += fmt::format("{},{}/corridor_{:02}_left.jpg,{}/corridor_{:02}_right.jpg\n", row, photos,
                        row, photos, is_late ? row + 1 : row);
  }
  const fs::path run = folder.path() / "run.csv";
  const fs::path fitted = folder.path() / "fitted.yaml";
  REQUIRE(write_file(run, rows));
  const ProgramOutput output = run_tagsmith(
      "calibrate --survey surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml -o '" +
      fitted.string() + "' --run '" + run.string() + "'");
  CHECK(output.exit_code == 1);
  CHECK(output.err.find("do not fit together") != std::string::npos);
  CHECK_FALSE(fs::exists(fitted));
}
