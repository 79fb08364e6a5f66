// SPDX-License-Identifier: Apache-2.0
// The loop of a printer's profile: sheet, print, scan, profile, compensated print, scan again.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/calibrate/measure_printer.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_printer.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr double kPrinterDpi = 600;
constexpr double kMillimetresPerInch = 25.4;

struct Printer {
  int growth_dots = 3;  // of every bar, in all
  double scale_right = 1.003;
  double scale_down = 0.998;
};

struct Scanner {
  double dpi = 400;
  double turn_deg = 0.4;
  double blur_dots = 1.6;  // of the printer, standard deviation
  double noise = 3;        // grey levels
};

// What leaves the printer: ink or none at every dot, grey by a screen of 8 x 8 dots.
cv::Mat printed(const fs::path& pdf, const Printer& printer) {
  const std::string root = (pdf.parent_path() / pdf.stem()).string() + "-page";
  const ProgramOutput drawn = run_shell(
      fmt::format("pdftoppm -gray -r {} -singlefile '{}' '{}'", kPrinterDpi, pdf.string(), root));
  REQUIRE(drawn.exit_code == 0);
  const GrayImage page = load_gray_image(root + ".pgm").value();
  cv::Mat ink(page.height, page.width, CV_8U);
  for (int y = 0; y < page.height; ++y) {
    for (int x = 0; x < page.width; ++x) {
      const double u = (x % 8) - 3.5;
      const double v = (y % 8) - 3.5;
      const double threshold = 255 * (u * u + v * v + 0.5) / 25.5;
      ink.at<std::uint8_t>(y, x) = 255 - page.view().at(x, y) > threshold ? 255 : 0;
    }
  }
  const int size = printer.growth_dots + 1;
  cv::dilate(ink, ink, cv::getStructuringElement(cv::MORPH_RECT, {size, size}));
  return ink;
}

// Scanned in grey, as sRGB.
GrayImage scanned(const cv::Mat& ink, const Printer& printer, const Scanner& scanner) {
  cv::Mat light;
  ink.convertTo(light, CV_32F, -0.80 / 255, 0.85);
  cv::GaussianBlur(light, light, {}, scanner.blur_dots);
  const double step = scanner.dpi / kPrinterDpi;
  const double turn = scanner.turn_deg * CV_PI / 180;
  const double c = std::cos(turn) * step;
  const double s = std::sin(turn) * step;
  const double margin = 60;
  const cv::Matx23d scan_from_page(c * printer.scale_right, -s * printer.scale_down, margin + 30,
                                   s * printer.scale_right, c * printer.scale_down, margin);
  const cv::Size size(static_cast<int>(ink.cols * step + 3 * margin),
                      static_cast<int>(ink.rows * step + 3 * margin));
  cv::warpAffine(light, light, scan_from_page, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0.85);
  cv::Mat noise(light.size(), CV_32F);
  cv::theRNG().state = 7;
  cv::randn(noise, 0, scanner.noise);
  GrayImage scan{size.width, size.height, {}};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double level =
          ToneCurve::srgb().sample_of(light.at<float>(y, x)) + noise.at<float>(y, x);
      scan.samples.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L)));
    }
  }
  return scan;
}

// `turned`: the page is wider than the printer takes.
GrayImage print_and_scan(const fs::path& pdf, const Printer& printer, const Scanner& scanner = {},
                         bool turned = false) {
  cv::Mat ink = printed(pdf, printer);
  if (turned) cv::rotate(ink, ink, cv::ROTATE_90_CLOCKWISE);
  return scanned(ink, printer, scanner);
}

double mm_per_dot() { return kMillimetresPerInch / kPrinterDpi; }

// Of the feature frame inside, millimetres, as the printer and a scanner make it.
double length_in_scan(const fs::path& pdf, const fs::path& survey, const Printer& printer,
                      bool turned = false) {
  Scanner scanner;
  scanner.dpi = 150;
  const Survey loaded = load_survey(survey).value();
  ReadOptions options = read_options_for({&loaded, 1});
  options.code_book.clear();
  const ReadResult read = read_tags(print_and_scan(pdf, printer, scanner, turned).view(), options);
  REQUIRE(read.tags.size() == 1);
  const auto& [p, f, r, q] = read.tags.front().corners;
  return (distance(p, f) + distance(q, r)) / 2 / 150 * kMillimetresPerInch;
}

}  // namespace

TEST_CASE("a printer is measured from a scan; what its profile says is gone from the next print") {
  const TemporaryFolder folder;
  const std::string sheet = (folder.path() / "sheet.pdf").string();
  const std::string scan = (folder.path() / "scan.png").string();
  const std::string profile = (folder.path() / "office.yaml").string();
  const Printer printer;
  REQUIRE(run_tagsmith("printer -o " + sheet).exit_code == 0);
  REQUIRE(save_gray_image(scan, print_and_scan(sheet, printer).view()));
  const ProgramOutput output =
      run_tagsmith(fmt::format("printer {} --dpi 400 -o {} --json", scan, profile));
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  const json found = parsed_json(output.out);
  const double growth = printer.growth_dots * mm_per_dot();  // 0.127 mm
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double scale = axis == 0 ? printer.scale_right : printer.scale_down;
    CHECK(found["scale"][axis].get<double>() == doctest::Approx(scale).epsilon(3e-4));
    CHECK(std::abs(found["bar_growth_mm"][axis].get<double>() - growth) < 0.010);
  }
  CHECK(found["dot_gain_percent"] > 10);
  MESSAGE("found: " << found.dump());

  const std::string again = (folder.path() / "again.pdf").string();
  REQUIRE(run_tagsmith(fmt::format("printer -o {} --profile {}", again, profile)).exit_code == 0);
  const PrinterMeasurement left =
      measure_printer("again", print_and_scan(again, printer).view(), 400).value();
  MESSAGE("left: scale " << left.profile.scale.right << ", " << left.profile.scale.down
                         << ", growth mm " << left.profile.growth_right * 1000 << ", "
                         << left.profile.growth_down * 1000);
  // A mark stands on whole dots: 0.04 mm on 117 mm.
  CHECK(std::abs(left.profile.scale.right - 1) < 3e-4);
  CHECK(std::abs(left.profile.scale.down - 1) < 3e-4);
  CHECK(std::abs(left.profile.growth_right) < 0.010e-3);
  CHECK(std::abs(left.profile.growth_down) < 0.010e-3);
}

TEST_CASE("plates printed with a profile have their size, are proved and verified") {
  const TemporaryFolder folder;
  const Printer printer;
  const fs::path profile = folder.path() / "office.yaml";
  REQUIRE(write_file(
      profile, printer_profile_text(
                   {"office", {printer.scale_right, printer.scale_down}, 0.127e-3, 0.127e-3, 0})));
  fs::path out = folder.path() / "out";
  const std::string survey = "surveys/corridor/survey.yaml";
  for (const char* paper :
       {" --paper A4 --tile --format both", " --paper A2 --format svg", " --format pdf"}) {
    CAPTURE(paper);
    out += "-next";
    const ProgramOutput output =
        run_tagsmith(fmt::format("print {} -o {} --tags 000L --proof --profile {}{}", survey,
                                 out.string(), profile.string(), paper));
    REQUIRE_MESSAGE(output.exit_code == 0, output.err);
    const ProgramOutput verified = run_tagsmith("verify " + survey + " " + out.string());
    CHECK_MESSAGE(verified.exit_code == 0, verified.out);
  }
  const double length = length_in_scan(out / "000L.pdf", survey, printer);
  MESSAGE("feature frame inside: " << length << " mm");
  CHECK(length == doctest::Approx(343).epsilon(0.0003));

  // The ink of a white plate's bars is that around a black plate's.
  const fs::path black = folder.path() / "survey.yaml";
  REQUIRE(write_file(black, *read_file(survey)));
  REQUIRE(write_file(folder.path() / "tag-400x300.yaml",
                     *read_file("templates/tag-400x300.yaml") + "white_on_black: true\n"));
  REQUIRE(run_tagsmith(fmt::format("print {} -o {} --tags 000L --format pdf --profile {}",
                                   black.string(), (folder.path() / "black").string(),
                                   profile.string()))
              .exit_code == 0);
  CHECK(length_in_scan(folder.path() / "black" / "000L.pdf", black, printer) ==
        doctest::Approx(343).epsilon(0.0003));
}

TEST_CASE("a lying sheet leaves the printer turned, and so does what the profile takes away") {
  const TemporaryFolder folder;
  Printer printer;
  printer.scale_right = 1.004;
  printer.scale_down = 0.997;
  const fs::path profile = folder.path() / "office.yaml";
  REQUIRE(write_file(
      profile, printer_profile_text(
                   {"office", {printer.scale_right, printer.scale_down}, 0.127e-3, 0.127e-3, 0})));
  std::string text = *read_file("surveys/corridor/survey.yaml");
  text.replace(text.find("tag-400x300"), 11, "tag-a4");
  const fs::path survey = folder.path() / "survey.yaml";
  REQUIRE(write_file(survey, text));
  const ProgramOutput output = run_tagsmith(
      fmt::format("print {} -o {} --paper A4 --tags 000L --proof --format pdf --profile {}",
                  survey.string(), (folder.path() / "out").string(), profile.string()));
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  const double wanted = 1000 * load_survey(survey).value().tag_template.frame_inner_length;
  CHECK(length_in_scan(folder.path() / "out" / "sheet-001.pdf", survey, printer, true) ==
        doctest::Approx(wanted).epsilon(0.0005));
}

TEST_CASE("what is no scan of the sheet, and no profile, is refused and nothing written") {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder.path() / name).string(); };
  const auto refused = [&](const std::string& arguments) {
    const ProgramOutput output = run_tagsmith(arguments);
    CHECK_MESSAGE(output.exit_code == 2, arguments);
    CHECK_FALSE(fs::exists(path("x.yaml")));
    CHECK_FALSE(fs::exists(path("x.pdf")));
    return output.err;
  };
  REQUIRE(save_gray_image(path("white.png"),
                          GrayImage{300, 400, std::vector<std::uint8_t>(120'000, 255)}.view()));
  CHECK(refused("printer " + path("white.png") + " --dpi 300 -o " + path("x.yaml"))
            .find("0 of the 4") != std::string::npos);
  refused("printer " + path("white.png") + " -o " + path("x.yaml"));
  refused("printer " + path("white.png") + " --dpi 300 -o " + path("x.txt"));
  refused("printer " + path("none.png") + " --dpi 300 -o " + path("x.yaml"));
  refused("printer -o " + path("x.svg"));
  refused("printer -o " + path("x.pdf") + " --paper 150x200");
  REQUIRE(run_tagsmith("printer -o " + path("sheet.pdf") + " --paper Letter").exit_code == 0);
  Printer fitted;  // printed to fit the page
  for (const double scale : {0.95, 0.972, 0.987}) {
    fitted.scale_right = fitted.scale_down = scale;
    REQUIRE(save_gray_image(path("fit.png"), print_and_scan(path("sheet.pdf"), fitted).view()));
    const std::string error =
        refused("printer " + path("fit.png") + " --dpi 400 -o " + path("x.yaml"));
    CHECK(std::regex_search(error, std::regex("the sheet is 9(4\\.9|5|7\\.|8\\.[67])")));
    CHECK(error.find("print at 100 %, without \"fit to page\"") != std::string::npos);
  }

  struct Row {
    const char* text;
    const char* place;
  };
  for (const Row& row :
       {Row{"", ":1:1"}, Row{"printer: a\nscale: [1.2, 1]\nbar_growth_mm: [0, 0]\n", ":2:"},
        Row{"printer: a\nscale: [0.972, 0.972]\nbar_growth_mm: [0, 0]\n", ":2:"},
        Row{"printer: a\nscale: [0.987, 0.988]\nbar_growth_mm: [0, 0]\n", ":2:"},
        Row{"printer: a\nscale: [1.006, 0.994]\nbar_growth_mm: [0, 0]\n", ":2:"},
        Row{"printer: a\nscale: [1, 1]\nbar_growth_mm: [0.1]\n", ":3:"},
        Row{"printer: a\nscale: [.nan, 1]\nbar_growth_mm: [0, 0]\n", ":2:"},
        Row{"printer: a\nscale: [1, 1]\nbar_growth_mm: [0, 0]\ngain: 3\n", ":4:"},
        Row{"rig: a\n", ":1:"}, Row{"\x01", ":1:"}}) {
    CAPTURE(row.text);
    REQUIRE(write_file(path("bad.yaml"), row.text));
    const std::string error = refused("print surveys/corridor/survey.yaml -o " + path("out") +
                                      " --profile " + path("bad.yaml"));
    CHECK_MESSAGE(error.find(path("bad.yaml") + row.place) != std::string::npos, error);
    CHECK_FALSE(fs::exists(path("out")));
    refused("printer -o " + path("x.pdf") + " --profile " + path("bad.yaml"));
  }
}
