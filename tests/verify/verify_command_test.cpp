// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/support/exif_jpeg.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kSurvey = "surveys/corridor/survey.yaml";
const std::string kPhotos = "surveys/corridor/photos";

// Prints tags of the corridor into the folder.
void print_into(const fs::path& folder, const std::string& options) {
  const ProgramOutput output =
      run_tagsmith("print " + kSurvey + " -o '" + folder.string() + "' --format pdf " + options);
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
}

// Calls `change` for every sample of a tag's plate, with its place from the frame's middle: 1 is
// the frame's inner edge to the right, and below.
template <class Change>
void for_plate(const json& corners, GrayImage& image, const Change& change) {
  const auto mean = [&](std::size_t axis, std::array<double, 4> weights) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += weights[i] * corners[i][axis].get<double>() / 4;
    return sum;
  };
  constexpr std::array<double, 4> kMiddle{1, 1, 1, 1};
  constexpr std::array<double, 4> kRight{-1, 1, 1, -1};
  constexpr std::array<double, 4> kDown{-1, -1, 1, 1};
  const double ux = mean(0, kRight);
  const double uy = mean(1, kRight);
  const double vx = mean(0, kDown);
  const double vy = mean(1, kDown);
  const double area = ux * vy - uy * vx;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double dx = x - mean(0, kMiddle);
      const double dy = y - mean(1, kMiddle);
      const double right = (dx * vy - dy * vx) / area;
      const double down = (ux * dy - uy * dx) / area;
      if (std::abs(right) > 1.16 || std::abs(down) > 1.35) continue;
      change(image.samples[static_cast<std::size_t>(y * image.width + x)], std::abs(right),
             std::abs(down));
    }
  }
}

GrayImage columns_of(const GrayView& image, int first, int end) {
  return copy_of(part_of(image, {first, 0, end, image.height}));
}

}  // namespace

TEST_CASE("the corridor's photos show tags of its survey and nothing else") {
  const ProgramOutput output = run_tagsmith("verify --json " + kSurvey + " " + kPhotos);
  CHECK_MESSAGE(output.exit_code == 0, output.out);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 21);
  CHECK(lines[0]["file"] == kPhotos + "/corridor_01_left.jpg");
  CHECK(lines[0]["tags"][0]["tag"] == "000L");
  CHECK(lines[0]["tags"][0]["status"] == "ok");
  CHECK(lines[0]["findings"].empty());
  const json summary = lines[20]["summary"];
  CHECK(summary["files"] == 20);
  CHECK(summary["ok"] >= 20);
  CHECK(summary["unknown"] == 0);
  CHECK(summary["misprinted"] == 0);
}

TEST_CASE("a tag of reversed colours, without its frame, or cut off is named in a photo") {
  const TemporaryFolder folder;
  const GrayImage photo = load_gray_image(kPhotos + "/corridor_01_left.jpg").value();
  const auto verified = [&](const GrayImage& image) {
    const fs::path file = folder.path() / "photo.png";
    REQUIRE(save_gray_image(file, image.view()).has_value());
    return json_lines(run_tagsmith("verify --json " + kSurvey + " '" + file.string() + "'").out)[0];
  };
  const json corners = verified(photo)["tags"][0]["corners"];

  GrayImage inverted = photo;
  for_plate(corners, inverted, [](std::uint8_t& sample, double, double) { sample = 255 - sample; });
  const json white_on_black = verified(inverted);
  CAPTURE(white_on_black.dump());
  REQUIRE(white_on_black["tags"].size() == 1);
  CHECK(white_on_black["rules"] == json::array({"inverted"}));
  CHECK(white_on_black["findings"][0] ==
        "misprinted: 000L is white on black, expected black on white");
  CHECK(white_on_black["tags"][0]["tag"] == "000L");

  GrayImage bare = photo;
  for_plate(corners, bare, [](std::uint8_t& sample, double right, double down) {
    if (right > 0.92 || down > 0.85) sample = 190;
  });
  const json without_frame = verified(bare);
  CAPTURE(without_frame.dump());
  CHECK(without_frame["rules"] == json::array({"no-frame"}));
  CHECK(without_frame["findings"][0] ==
        "unreadable: the bars of 000L can be read, but no whole feature frame is to be seen around "
        "them");

  GrayImage dark = photo;
  for (std::uint8_t& sample : dark.samples) sample = static_cast<std::uint8_t>(sample / 20);
  const json too_dark = verified(dark);
  CAPTURE(too_dark.dump());
  CHECK(too_dark["rules"] == json::array({"too-dark"}));
  CHECK(too_dark["findings"][0].get<std::string>().find(
            "the bars of 000L can be read, but no whole feature frame is to be seen around them: "
            "its white is ") != std::string::npos);

  const double left = std::min(corners[0][0].get<double>(), corners[3][0].get<double>());
  const double right = std::max(corners[1][0].get<double>(), corners[2][0].get<double>());
  const int first = static_cast<int>(left) + 14;
  const json side_cut_off = verified(columns_of(photo.view(), first, photo.width));
  CHECK(side_cut_off["findings"].empty());
  CHECK(side_cut_off["tags"][0]["status"] == "ok");

  const json at_edge =
      verified(columns_of(photo.view(), first, first + static_cast<int>(right - left) - 28));
  CAPTURE(at_edge.dump());
  REQUIRE(at_edge["tags"].size() == 1);
  CHECK(at_edge["tags"][0]["status"] == "cut_off");
  CHECK(at_edge["tags"][0]["tag"] == "000L");
  CHECK(at_edge["rules"] == json::array({"no-tag"}));
  CHECK(at_edge["findings"][0] == "no tag was found; not wholly in view: 000L");
}

TEST_CASE("missing tags are named, and a fault only with --complete") {
  const std::string arguments = kSurvey + " " + kPhotos + "/corridor_01_*.jpg";
  const ProgramOutput output = run_tagsmith("verify --json " + arguments);
  CHECK(output.exit_code == 0);
  const json missing = json_lines(output.out).back()["summary"]["missing"];
  CHECK(missing == json::array({"001L", "001R", "002L", "002R", "003L", "003R", "004L", "004R",
                                "005L", "005R", "006L", "006R", "007L", "007R"}));
  CHECK(run_tagsmith("verify --complete " + arguments).exit_code == 1);
}

TEST_CASE("photos of another tunnel hold unknown tags") {
  const ProgramOutput output =
      run_tagsmith("verify --json surveys/curved/survey.yaml " + kPhotos + "/corridor_01_left.jpg");
  CHECK(output.exit_code == 1);
  const json line = json_lines(output.out).at(0);
  CHECK(line["tags"][0]["tag"].is_null());
  CHECK(line["tags"][0]["digits"] == "019000000404");
  CHECK(line["findings"].size() == 1);
}

TEST_CASE("print files are read back and hold what their manifest says") {
  const TemporaryFolder folder;
  print_into(folder.path(), "--tags 000L,000R,003L");
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + " '" + folder.path().string() + "'");
  CHECK_MESSAGE(output.exit_code == 0, output.out << output.err);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 5);  // three tags, the setting-out, the summary
  CHECK(lines[2]["tags"][0]["tag"] == "003L");
  CHECK(lines[2]["tags"][0]["page"] == 1);
  CHECK(lines[2]["tags"][0]["grade"] == 4.0);
  CHECK(lines[2]["tags"][0]["grade_absolute"] == false);
  CHECK(lines[2]["tags"][0]["grade_parameters"]["decodability"]["value"] > 0.9);
  CHECK(lines[4]["summary"]["missing"].size() == 13);
}

TEST_CASE("print files that were mixed up are misprinted") {
  const TemporaryFolder folder;
  print_into(folder.path(), "--tags 000L,000R");
  fs::copy_file(folder.path() / "000R.pdf", folder.path() / "000L.pdf",
                fs::copy_options::overwrite_existing);
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + " '" + folder.path().string() + "/000L.pdf'");
  CHECK(output.exit_code == 1);
  const json line = json_lines(output.out).at(0);
  CHECK(line["tags"][0]["status"] == "misprinted");
  CHECK(line["findings"].size() == 3);  // wrong tag, missing tag, other bytes
}

TEST_CASE("SVG, PNG and PDF of a print are read; documents and tiles are not") {
  const TemporaryFolder folder;
  const std::string path = "'" + folder.path().string() + "'";
  REQUIRE(run_tagsmith("print " + kSurvey + " -o " + path +
                       " --tags 000L --format pdf,svg,png --dpi 150")
              .exit_code == 0);
  const ProgramOutput output = run_tagsmith("verify --json " + kSurvey + " " + path);
  CHECK_MESSAGE(output.exit_code == 0, output.out << output.err);  // edges on dots are read as ever
  CHECK(json_lines(output.out).size() == 5);
  const TemporaryFolder plain;
  const std::string other = "'" + plain.path().string() + "'";
  REQUIRE(run_tagsmith("print " + kSurvey + " -o " + other + " --tags 000L --format both,png")
              .exit_code == 0);
  const std::vector<json> lines =
      json_lines(run_tagsmith("verify --json " + kSurvey + " " + other).out);
  REQUIRE(lines.size() == 5);
  for (const std::size_t i : {0U, 1U, 2U}) CHECK(lines[i]["tags"][0]["status"] == "ok");
  CHECK(lines[3]["tags"].empty());  // setting-out.pdf
  CHECK(lines[4]["summary"]["files_with_findings"] == 0);
}

TEST_CASE("files are stale when the survey has moved a tag, changed its digits or its plate") {
  const TemporaryFolder folder;
  print_into(folder.path() / "print", "--tags 000L,001L");
  std::string text = *read_file(kSurvey);
  const auto verify = [&] {
    const fs::path survey = folder.path() / "survey.yaml";
    REQUIRE(write_file(survey, text).has_value());
    const ProgramOutput output = run_tagsmith("verify --json '" + survey.string() + "' '" +
                                              (folder.path() / "print").string() + "'");
    return json_lines(output.out).back()["summary"]["stale"].size();
  };
  CHECK(verify() == 0);
  text +=
      "placed:\n  - { tag: 001L, side: left, p: [1.9, 0.807, 0.4], digits: \"019000800402\" }\n";
  CHECK(verify() == 2);  // the tag and the setting-out list
  text.replace(text.find("resolution: 0.01"), 16, "resolution: 0.02");
  CHECK(verify() == 3);
}

TEST_CASE("prints of a template that draws plates otherwise are stale, and nothing else is said") {
  const TemporaryFolder folder;
  const std::string tag = *read_file("templates/tag-400x300.yaml");
  const fs::path survey = folder.path() / "survey.yaml";
  REQUIRE(write_file(survey, *read_file(kSurvey)).has_value());
  REQUIRE(write_file(folder.path() / "tag-400x300.yaml", tag).has_value());
  const auto verify = [&](const std::string& before, const std::string& after) {
    std::string changed = tag;
    if (!before.empty()) changed.replace(changed.find(before), before.size(), after);
    REQUIRE(write_file(folder.path() / "tag-400x300.yaml", changed).has_value());
    return json_lines(run_tagsmith(fmt::format("verify --json '{}' '{}'", survey.string(),
                                               (folder.path() / "print" / "003L.pdf").string()))
                          .out)
        .front();
  };
  for (const char* dots : {"", " --dpi 300"}) {
    REQUIRE(run_tagsmith(fmt::format("print '{}' -o '{}' --format pdf --tags 003L{}",
                                     survey.string(), (folder.path() / "print").string(), dots))
                .exit_code == 0);
    CHECK(!verify("", "").contains("rules"));
    for (const auto& [before, after] :
         {std::pair{"stroke: 0.012", "stroke: 0.014"}, std::pair{"quiet_zone: 9", "quiet_zone: 12"},
          std::pair{"margin: 9", "margin: 11"},
          std::pair{"symbol:", "holes: { diameter_mm: 5, inset_mm: 9 }\nsymbol:"}}) {
      const json line = verify(before, after);
      CHECK_MESSAGE(line["rules"] == json({"stale"}), line.dump());
    }
    verify("", "");
  }
}

TEST_CASE("a logo with a light middle is no tag that could not be read") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.path() / "logo.svg",
                     "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 200 100\"><circle "
                     "cx=\"150\" cy=\"70\" r=\"25\"/><rect x=\"140\" y=\"60\" width=\"20\" "
                     "height=\"20\" fill=\"white\"/></svg>"));
  REQUIRE(write_file(
      folder.path() / "t.yaml",
      "tag: t\nplate: [0.3, 0.22]\n"
      "feature_frame: { inner: [0.2201, 0.11], stroke: 0.008, offset: [0.01, 0.038] }\n"
      "symbol: { quiet_zone: 9, margin: 9 }\nlogo: { file: logo.svg, size_mm: [50, 25] }\n"
      "qr: { size_mm: 30, content: \"{digits}\" }\npatches: { size_mm: 20 }\n"));
  std::string text = *read_file(kSurvey);
  text.replace(text.find("tag-400x300"), 11, "t");
  const fs::path survey = folder.path() / "survey.yaml";
  REQUIRE(write_file(survey, text));
  const std::string print = (folder.path() / "print").string();
  REQUIRE(run_tagsmith(
              fmt::format("print '{}' -o '{}' --format both --tags 000L", survey.string(), print))
              .exit_code == 0);
  const ProgramOutput output =
      run_tagsmith(fmt::format("verify '{}' '{}'", survey.string(), print));
  CHECK_MESSAGE(output.exit_code == 0, output.out);
}

TEST_CASE("files of an earlier print are stale, listed or not, and with other tables told") {
  const TemporaryFolder folder;
  const fs::path print = folder.path() / "print";
  const std::string exchanged =
      "placed:\n"
      "  - { tag: 000L, side: left, p: [1.9, 0.8, 0.4], digits: \"019000800402\" }\n"
      "  - { tag: 001L, side: left, p: [1.9, 0.0, 0.4], digits: \"019000000404\" }\n";
  const fs::path survey = folder.path() / "survey.yaml";
  REQUIRE(write_file(survey, *read_file(kSurvey) + exchanged));
  print_into(print, "--tags 000L,001L");
  fs::create_directories(folder.path() / "copies");
  fs::copy_file(print / "000L.pdf", folder.path() / "copies" / "first.pdf");
  REQUIRE(run_tagsmith("print '" + survey.string() + "' -o '" + print.string() +
                       "' --format pdf --tags 000R")
              .exit_code == 0);
  fs::copy_file(print / "000R.pdf", print / "000R (1).pdf");
  const auto rules_of_files = [&](const fs::path& files) {
    std::map<std::string, json> rules;
    for (const json& line :
         json_lines(run_tagsmith("verify --json '" + survey.string() + "' '" + files.string() + "'")
                        .out)) {
      if (line.contains("file")) {
        rules[fs::path(line["file"].get<std::string>()).filename()] = line.value("rules", json());
      }
    }
    return rules;
  };
  std::map<std::string, json> rules = rules_of_files(print);
  CHECK(rules["000L.pdf"] == json{"stale"});
  CHECK(rules["001L.pdf"] == json{"stale"});
  CHECK(rules["000R.pdf"].is_null());
  CHECK(rules["000R (1).pdf"] == json{"unlisted-file"});
  CHECK(rules["setting-out.pdf"].is_null());
  // Without a manifest the file says itself of which tag it is.
  CHECK(rules_of_files(folder.path() / "copies")["first.pdf"] == json{"stale"});
  REQUIRE(write_file(print / "setting-out.csv", "tag\n"));
  CHECK(rules_of_files(print)["setting-out.pdf"] == json{"changed-file"});
  // Another zero of the chainage changes labels and list, and no code.
  std::string text = *read_file(survey);
  text.replace(text.find("first: 0.0"), 10, "first: 0.5");
  text.replace(text.find("start: [0.95, 0.0, 0.0]"), 23, "start: [0.95, -0.5, 0.0]");
  REQUIRE(write_file(survey, text));
  rules = rules_of_files(print);
  CHECK(rules["000R.pdf"] == json{"stale"});
  CHECK(rules["setting-out.pdf"].size() == 2);
}

TEST_CASE("a scan that was verified as a photo is verified again") {
  const TemporaryFolder folder;
  print_into(folder.path(), "--tags 000L --format png --dpi 150");
  const std::string scan = "'" + (folder.path() / "scan.png").string() + "'";
  fs::rename(folder.path() / "000L.png", folder.path() / "scan.png");
  const std::string lines = "'" + (folder.path() / "lines.jsonl").string() + "'";
  const std::string command = "verify --json --resume " + lines + " " + kSurvey + " " + scan;
  CHECK(run_shell("\"$TAGSMITH_PROGRAM\" " + command + " >> " + lines).exit_code == 0);
  CHECK(json_lines(run_tagsmith(command).out).size() == 1);
  const std::vector<json> again = json_lines(run_tagsmith(command + " --dpi 155").out);
  REQUIRE(again.size() == 2);
  CHECK(again[0]["rules"] == json{"wrong-scale"});
}

TEST_CASE("surveys whose codes cannot be told apart are not verified together") {
  const ProgramOutput output =
      run_tagsmith("verify " + kSurvey + " " + kPhotos + " --also " + kSurvey);
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("[duplicate-survey]") != std::string::npos);
}

TEST_CASE("a page that was fitted to A4 is misprinted") {
  const TemporaryFolder folder;
  print_into(folder.path(), "--tags 000L");
  const std::string original = "'" + (folder.path() / "000L.pdf").string() + "'";
  const std::string fitted = "'" + (folder.path() / "fitted.pdf").string() + "'";
  REQUIRE(run_shell("pdftocairo -pdf -paper A4 " + original + " " + fitted).exit_code == 0);
  const ProgramOutput output = run_tagsmith("verify --json " + kSurvey + " " + fitted);
  CHECK(output.exit_code == 1);
  const json tag = json_lines(output.out).at(0)["tags"][0];
  CHECK(tag["status"] == "misprinted");
  CHECK(tag["rule"] == "wrong-scale");
  CHECK(tag["message"].get<std::string>().find("343 x 168 mm") != std::string::npos);
}

TEST_CASE("a tag that is in a PDF twice is a duplicate") {
  const TemporaryFolder folder;
  print_into(folder.path(), "--tags 000L");
  const std::string page = "'" + (folder.path() / "000L.pdf").string() + "'";
  const std::string twice = "'" + (folder.path() / "twice.pdf").string() + "'";
  REQUIRE(run_shell("pdfunite " + page + " " + page + " " + twice).exit_code == 0);
  const ProgramOutput output = run_tagsmith("verify --json " + kSurvey + " " + twice);
  CHECK(output.exit_code == 1);
  const json line = json_lines(output.out).at(0);
  CHECK(line["rules"] == json::array({"duplicate", "unlisted-file"}));
  REQUIRE(line["tags"].size() == 2);
  CHECK(line["tags"][0]["status"] == "ok");
  CHECK(line["tags"][0]["page"] == 1);
  CHECK(line["tags"][1]["rule"] == "duplicate");
  CHECK(line["tags"][1]["tag"] == "000L");
  CHECK(line["tags"][1]["page"] == 2);
}

TEST_CASE("a print from an older survey is found through its manifest") {
  const TemporaryFolder folder;
  print_into(folder.path(), "--tags 003L");
  const fs::path manifest = folder.path() / "manifest.json";
  json changed = parsed_json(*read_file(manifest));
  changed["tags"][0]["digits"] = "019000000404";
  REQUIRE(write_file(manifest, changed.dump()).has_value());
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + " '" + folder.path().string() + "'");
  CHECK(output.exit_code == 1);
  const json line = json_lines(output.out).at(0);
  CHECK(line["stale"] == true);
  CHECK(std::ranges::count(line["rules"], "stale") == 1);
  CHECK(line["tags"][0]["digits"] != "019000000404");
  CHECK(line["findings"].dump().find("019000000404") != std::string::npos);
  REQUIRE(write_file(manifest, R"({"survey": "corridor", "tags": 3})").has_value());
  const ProgramOutput broken =
      run_tagsmith("verify " + kSurvey + " '" + folder.path().string() + "'");
  CHECK(broken.exit_code == 2);
  CHECK(broken.err.find("manifest.json: tags ") != std::string::npos);
}

TEST_CASE("unreadable files are told, the others checked, and the exit code is 2") {
  const TemporaryFolder folder;
  const fs::path broken = folder.path() / "broken.pdf";
  REQUIRE(write_file(broken, "%PDF-1.4\nnothing").has_value());
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + " no-such.jpg '" + broken.string() + "' " +
                   kPhotos + "/corridor_01_left.jpg");
  CHECK(output.exit_code == 2);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 4);
  CHECK(lines[0]["file"] == "no-such.jpg");
  CHECK(lines[1]["file"] == broken.string());
  for (const std::size_t i : {0U, 1U}) CHECK(lines[i]["rules"] == json::array({"broken-file"}));
  CHECK(lines[0]["findings"] != lines[1]["findings"]);
  CHECK(lines[2]["tags"][0]["status"] == "ok");
  CHECK(output.err.find("no-such.jpg: ") != std::string::npos);
  CHECK(output.err.find("broken.pdf: ") != std::string::npos);
}

TEST_CASE("mirrored and upside-down pages are told apart, with crops") {
  const TemporaryFolder folder;
  const std::string path = "'" + folder.path().string() + "'";
  REQUIRE(
      run_tagsmith("print " + kSurvey + " -o " + path + " --tags 000L --format svg").exit_code ==
      0);
  const std::string svg = *read_file(folder.path() / "000L.svg");
  const std::size_t begin = svg.find('>', svg.find("<svg")) + 1;
  const std::size_t end = svg.rfind("</svg>");
  const auto verify_turned = [&](const std::string& name, const std::string& transform) {
    const fs::path file = folder.path() / "turned" / name;
    REQUIRE(write_file(file, svg.substr(0, begin) + "<g transform=\"" + transform + "\">" +
                                 svg.substr(begin, end - begin) + "</g></svg>")
                .has_value());
    const ProgramOutput output =
        run_tagsmith("verify --json " + kSurvey + " '" + file.string() + "' --crops " + path);
    CHECK(output.exit_code == 1);
    return json_lines(output.out).at(0)["tags"][0];
  };
  const json mirrored = verify_turned("mirrored.svg", "translate(450 0) scale(-1 1)");
  CHECK(mirrored["rule"] == "mirrored");
  CHECK(mirrored["remedy"] != "");
  CHECK(fs::file_size(mirrored["crop"].get<std::string>()) > 1000);
  CHECK(verify_turned("down.svg", "translate(450 350) scale(-1 -1)")["rule"] == "upside-down");
}

TEST_CASE("tiles are put together and verified, as pages of a PDF or as files") {
  const TemporaryFolder folder;
  const std::string path = "'" + folder.path().string() + "'";
  REQUIRE(run_tagsmith("print " + kSurvey + " -o " + path +
                       " --tags 000L,001R --paper A4 --tile --format pdf,svg,png")
              .exit_code == 0);
  const auto tags_in = [&](const std::string& name) {
    const ProgramOutput output =
        run_tagsmith("verify --json " + kSurvey + " '" + (folder.path() / name).string() + "'");
    return json_lines(output.out).at(0);
  };
  for (const char* name : {"000L.pdf", "000L-A1.svg", "000L-A1.png"}) {
    CAPTURE(std::string(name));
    const json line = tags_in(name);
    REQUIRE(line["tags"].size() == 1);
    CHECK(line["tags"][0]["tag"] == "000L");
  }
  CHECK(tags_in("000L-B2.svg")["tags"].empty());
  CHECK(tags_in("000L-assembly.png")["findings"].empty());

  fs::remove(folder.path() / "000L-B2.svg");
  CHECK(tags_in("000L-A1.svg")["findings"][0] == "its tile 000L-B2.svg is not here");
  const std::string in = "cd " + path + " && ";
  // Two sheets exchanged; another paper; sheets lost.
  REQUIRE(run_shell(in + "pdfseparate 001R.pdf p%d.pdf && pdfunite p1.pdf p3.pdf p2.pdf p4.pdf "
                         "p5.pdf 001R.pdf")
              .exit_code == 0);
  CHECK(tags_in("001R.pdf")["rules"] ==
        json::array({"changed-file", "covered", "missing-in-file"}));
  REQUIRE(run_shell(in + "pdfunite p1.pdf p2.pdf 001R.pdf").exit_code == 0);
  CHECK(tags_in("001R.pdf")["findings"][0] ==
        "has 2 pages, expected 5: an assembly sheet and 4 tiles for each tag");
  REQUIRE(run_shell(in + "pdftocairo -pdf -paper A3 000L.pdf 001R.pdf").exit_code == 0);
  CHECK(tags_in("001R.pdf")["findings"][0] ==
        "page 1: is 420 x 297 mm, expected 297 x 210 mm (manifest.json)");
}

TEST_CASE("output that would overwrite what is resumed is refused") {
  const TemporaryFolder folder;
  const std::string lines = "'" + (folder.path() / "lines.jsonl").string() + "'";
  const std::string command = "\"$TAGSMITH_PROGRAM\" verify --json --resume " + lines + " " +
                              kSurvey + " " + kPhotos + "/corridor_01_left.jpg ";
  const ProgramOutput over = run_shell(command + "> " + lines);
  CHECK(over.exit_code == 2);
  CHECK(over.err.find("`>>`") != std::string::npos);
  CHECK(run_shell(command + ">> " + lines).exit_code == 0);
  CHECK(run_shell(command + ">> " + lines).exit_code == 0);
  const std::vector<json> all = json_lines(*read_file(folder.path() / "lines.jsonl"));
  REQUIRE(all.size() == 3);  // the photo once, two summaries
  CHECK(all[1] == all[2]);   // the second counts what it skipped
}

TEST_CASE("lines that could not be written are no success") {
  const std::string command =
      "\"$TAGSMITH_PROGRAM\" verify --json " + kSurvey + " " + kPhotos + "/corridor_01_left.jpg > ";
  const ProgramOutput output = run_shell(command + "/dev/full");
  CHECK(output.exit_code == 2);
  CHECK(!output.err.empty());
  CHECK(run_shell(command + "/dev/null").exit_code == 0);
}

TEST_CASE("copies of damaged photos are made without a word that names no file") {
  const TemporaryFolder folder;
  std::string jpeg = *read_file(kPhotos + "/corridor_01_left.jpg");
  jpeg.erase(jpeg.size() - 30'000, 20'000);
  REQUIRE(write_file(folder.path() / "worn.jpg", jpeg).has_value());
  const GrayImage photo = load_gray_image(kPhotos + "/corridor_01_left.jpg").value();
  std::string png = encode_gray_image("a.png", photo.view()).value();
  png.insert(33, std::string("\0\0\0\3iCCPabc\0\0\0\0", 15));  // behind the header: no profile
  REQUIRE(write_file(folder.path() / "odd.png", png).has_value());
  const std::string copies = (folder.path() / "copies").string();
  const ProgramOutput output = run_tagsmith("verify " + kSurvey + " '" + folder.path().string() +
                                            "' --annotate '" + copies + "'");
  CHECK(output.exit_code == 0);
  CHECK(output.err.empty());
  CHECK(std::distance(fs::directory_iterator(copies), fs::directory_iterator()) == 2);
}

TEST_CASE("copies of photos are annotated, upright, in the format of the source") {
  const TemporaryFolder folder;
  const std::string photo = kPhotos + "/corridor_01_left.jpg";
  const std::string jpeg = *read_file(photo);
  // The same photo that says it was taken with the camera on its side (EXIF orientation 6).
  REQUIRE(write_file(folder.path() / "side.jpg", with_orientation(jpeg, 6)).has_value());
  const ProgramOutput output = run_tagsmith(
      "verify --json " + kSurvey + " " + photo + " '" + (folder.path() / "side.jpg").string() +
      "' --annotate '" + (folder.path() / "copies").string() + "'");
  CHECK(output.exit_code == 0);
  std::vector<fs::path> copies;
  for (const auto& entry : fs::directory_iterator(folder.path() / "copies")) {
    copies.push_back(entry.path());
  }
  REQUIRE(copies.size() == 2);
  std::sort(copies.begin(), copies.end());
  const auto size_of = [](const fs::path& file) {
    const std::string bytes = *read_file(file);
    const std::size_t frame = bytes.find("\xFF\xC0");
    const auto byte = [&](std::size_t at) {
      return static_cast<int>(static_cast<unsigned char>(bytes.at(frame + at)));
    };
    return std::pair(byte(7) * 256 + byte(8), byte(5) * 256 + byte(6));
  };
  CHECK(copies[0].filename().string().starts_with("corridor_01_left-"));
  CHECK(size_of(copies[0]) == std::pair(1280, 960));
  CHECK(copies[1].filename().string().starts_with("side-"));
  CHECK(size_of(copies[1]) == std::pair(960, 1280));
  CHECK(*read_file(copies[0]) != jpeg);
}

TEST_CASE("photos that name their lens tell where tags hang without a rig") {
  const TemporaryFolder folder;
  for (const int photo : {3, 4, 5, 6}) {
    const std::string name = fmt::format("curved_{:02}_right.jpg", photo);
    const std::string jpeg = *read_file("surveys/curved/photos/" + name);
    REQUIRE(write_file(folder.path() / name, with_lens(jpeg, "Phone 7", 43)).has_value());
  }
  const std::string lines = (folder.path() / "lines.jsonl").string();
  const ProgramOutput output = run_tagsmith("verify --json surveys/curved/survey.yaml '" +
                                            folder.path().string() + "' > '" + lines + "'");
  CHECK(output.err.find("no rig given") != std::string::npos);
  const std::vector<json> files = json_lines(*read_file(lines));
  REQUIRE(files.size() == 5);
  const json camera{{"name", "Maker Phone 7"}, {"focal_35_mm", 43.0}, {"focal_mm", 5.43}};
  CHECK(files[0]["camera"] == camera);
  int checked = 0;
  for (const json& tag : files[4]["summary"]["hanging"]) {
    if (tag["verdict"] == "unchecked") continue;
    CHECK(tag["verdict"] == "fits");
    ++checked;
  }
  CHECK(checked >= 3);
  // What the lines say of it is kept by report.
  const ProgramOutput report =
      run_tagsmith("report --json surveys/curved/survey.yaml '" + lines + "'");
  CHECK(report.err.find("no rig given") == std::string::npos);
  CHECK(json_lines(report.out).at(0)["summary"]["completeness"]["placement_checked"] == checked);
}

TEST_CASE("with a rig, tags that hang elsewhere than surveyed are found and told what to do") {
  const std::string rig = " --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  const ProgramOutput right = run_tagsmith("verify --json " + kSurvey + rig);
  CHECK_MESSAGE(right.exit_code == 0, right.out << right.err);
  const json checked = json_lines(right.out).at(20)["summary"]["hanging"];
  CHECK(checked.size() == 14);
  for (const json& tag : checked) CHECK(tag["verdict"] == "fits");
  const json summary = json_lines(right.out).at(20)["summary"];
  CHECK(summary["placement"] == "checked");
  CHECK(summary["completeness"]["placement_checked"] == 14);
  CHECK(summary["hanging_unplaced"].empty());

  // The survey's place of 001L is 30 mm too high: the plate hangs too low against it.
  const TemporaryFolder folder;
  std::string survey = *read_file(kSurvey);
  survey.insert(survey.find("\ncode:"),
                "\nplaced:\n  - { tag: 001L, side: left, p: [1.9, 0.8, 0.43], "
                "digits: \"01900080040\" }\n");
  const std::string moved = (folder.path() / "survey.yaml").string();
  REQUIRE(write_file(moved, survey).has_value());
  const ProgramOutput output = run_tagsmith("verify --json '" + moved + "'" + rig + " --crops '" +
                                            folder.path().string() + "'");
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 21);
  CHECK(lines[20]["summary"]["misplaced"] == 1);
  CHECK(lines[20]["summary"]["doubtful"] == 0);
  const json tag = lines[2]["tags"][0];
  CHECK(tag["tag"] == "001L");
  CHECK(tag["status"] == "misplaced");
  CHECK(tag["rule"] == "moved");
  CHECK(tag["message"] == "001L hangs 30 mm from its surveyed place: raise it by 30 mm");
  CHECK(std::abs(tag["hanging"]["offset_mm"][1].get<double>() + 30) < 2);
  CHECK(tag["hanging"]["offset_sigma_mm"][1] < 5);
  CHECK(fs::file_size(tag["crop"].get<std::string>()) > 1000);
  CHECK(lines[2]["findings"].size() == 1);
  CHECK(run_tagsmith("verify '" + moved + "'" + rig + " --tolerance 40").exit_code == 0);
}

// What a summary says of the tags that do not fit, by name; and of how many it says something.
std::map<std::string, std::string> judged(const json& summary) {
  std::map<std::string, std::string> words{{"all", std::to_string(summary["hanging"].size())}};
  for (const json& tag : summary["hanging"]) {
    if (tag["verdict"] != "fits") words[tag["tag"]] = tag["message"];
  }
  return words;
}

TEST_CASE("where the rig is wrong no plate is accused, and the right value is told") {
  const TemporaryFolder folder;
  std::string rig = read_file("surveys/corridor/rig.yaml").value();
  const std::size_t right = rig.find("right:");
  const std::string focal = "focal_length_mm: 6.0";
  rig.replace(rig.find(focal, right), focal.size(), "focal_length_mm: 5.5");
  const fs::path file = folder.path() / "rig.yaml";
  std::ofstream(file) << rig;
  const std::string options =
      kSurvey + " --rig '" + file.string() + "' --run surveys/corridor/run.csv";
  const ProgramOutput output = run_tagsmith("verify --json " + options);
  CHECK(output.exit_code == 1);
  CHECK(output.err.find("the rig is in doubt") != std::string::npos);
  CHECK(run_tagsmith("verify " + options)
            .out.find("where tags hang: not judged, because the rig is in doubt") !=
        std::string::npos);
  CHECK(output.err.find("right: a focal length of 1") != std::string::npos);
  const json summary = json_lines(output.out).back()["summary"];
  CHECK(summary["files_with_findings"] == 0);
  for (const json& tag : summary["hanging"]) CHECK(tag["verdict"] == "unchecked");
}

TEST_CASE("jobs that know no rig are merged into where tags hang, by all their photos") {
  const TemporaryFolder folder;
  const std::string path = "'" + folder.path().string() + "/";
  std::string survey = *read_file(kSurvey);
  survey.insert(survey.find("\ncode:"),
                "\nplaced:\n  - { tag: 003L, side: left, p: [1.9, 2.4, 0.43], "
                "digits: \"01900240040\" }\n");
  REQUIRE(write_file(folder.path() / "survey.yaml", survey).has_value());
  const std::string moved = path + "survey.yaml' ";
  const std::string rig = " --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  // Left photos in one job, right ones in the other: alone neither sees two tags.
  const std::string files = "$(ls " + kPhotos + "/*_";
  const std::string program = "\"$TAGSMITH_PROGRAM\" ";
  const auto job = [&](const std::string& side, const std::string& options) {
    return run_shell(program + "verify --json " + options + moved + files + side + ".jpg) >> " +
                     path + side + ".jsonl'");
  };
  CHECK(job("left", "").exit_code == 0);
  CHECK(job("right", "").exit_code == 0);
  const std::string both = path + "left.jsonl' " + path + "right.jsonl'";
  const ProgramOutput report = run_tagsmith("report --json " + moved + both + rig);
  CHECK_MESSAGE(report.err.starts_with("tagsmith report: no photo ties 000L and 001L"), report.err);
  CHECK(report.err.find('\n') == report.err.size() - 1);
  const json summary = json_lines(report.out).at(0)["summary"];

  // The same as one run that sees all photos.
  const ProgramOutput whole = run_tagsmith("verify --json " + moved + rig);
  const json expected = json_lines(whole.out).at(20)["summary"];
  CHECK(judged(summary) == judged(expected));
  CHECK(judged(summary).contains("003L"));
  CHECK(summary["faults"] == expected["misplaced"].get<int>() + expected["doubtful"].get<int>());
  const ProgramOutput without_rig = run_tagsmith("report --json " + moved + both);
  const json unchecked = json_lines(without_rig.out).at(0)["summary"];
  CHECK(unchecked["completeness"]["seen"] == 14);
  CHECK(unchecked["faults"] == 0);

  // A run that was killed goes on where it was, and sees all as well.
  const ProgramOutput again =
      run_tagsmith("verify --json --resume " + path + "left.jsonl' " + moved + rig);
  const std::vector<json> lines = json_lines(again.out);
  REQUIRE(lines.size() == 11);
  CHECK(!lines[0]["tags"][0].contains("hanging"));
  CHECK(judged(lines[10]["summary"]) == judged(summary));
  CHECK(lines[10]["summary"]["misplaced"] == expected["misplaced"]);
  CHECK(lines[10]["summary"]["doubtful"] == expected["doubtful"]);

  // What was verified with another lens is verified again.
  std::string other = *read_file("surveys/corridor/rig.yaml");
  other.insert(other.find("cameras:"), "# another lens\n");
  other = std::regex_replace(other, std::regex("focal_length_mm: [0-9.]+"), "focal_length_mm: 6.1");
  REQUIRE(write_file(folder.path() / "rig.yaml", other).has_value());
  const auto verify_left = [&](const std::string& of_rig, const std::string& resume) {
    return run_shell(program + "verify --json " + resume + moved + files + "left.jpg) --run " +
                     "surveys/corridor/run.csv --rig " + of_rig + " >> " + path + "lens.jsonl'");
  };
  verify_left(path + "rig.yaml'", "");
  const auto count = [&] { return json_lines(*read_file(folder.path() / "lens.jsonl")).size(); };
  CHECK(count() == 11);
  const std::string resume = "--resume " + path + "lens.jsonl' ";
  verify_left("surveys/corridor/rig.yaml", resume);
  CHECK(count() == 22);
  verify_left("surveys/corridor/rig.yaml", resume);
  CHECK(count() == 23);
}

TEST_CASE(
    "a file that was verified again stands for what an earlier state of the survey made of it") {
  const TemporaryFolder folder;
  const std::string photo = kPhotos + "/corridor_03_left.jpg";
  const std::string now = run_tagsmith("verify --json " + kSurvey + " " + photo).out;
  std::string before =
      std::regex_replace(now.substr(0, now.find('\n') + 1),
                         std::regex("\"revision\":\"[0-9a-f]+\""), "\"revision\":\"0123456789ab\"");
  before = std::regex_replace(
      before, std::regex("\"status\":\"ok\""),
      "\"status\":\"misplaced\",\"rule\":\"moved\",\"message\":\"hangs elsewhere\"");
  REQUIRE(before != now.substr(0, now.find('\n') + 1));
  const fs::path lines = folder.path() / "photos.jsonl";
  for (const std::string& text : {before + now, now + before}) {
    REQUIRE(write_file(lines, text).has_value());
    const ProgramOutput report =
        run_tagsmith("report --json " + kSurvey + " '" + lines.string() + "'");
    CHECK(report.err == "");
    const json summary = json_lines(report.out).at(0)["summary"];
    CHECK(summary["other_revisions"] == 0);
    CHECK(summary["faults"] == 0);
  }
  // Alone it counts, but not where its tags hung by the places of that state.
  REQUIRE(write_file(lines, before).has_value());
  const json alone = json_lines(
      run_tagsmith("report --json " + kSurvey + " '" + lines.string() + "'").out)[0]["summary"];
  CHECK(alone["other_revisions"] == 1);
  CHECK(alone["faults"] == 0);
}

TEST_CASE("what of where tags hang was not checked, or fits nothing, is told and a finding") {
  const TemporaryFolder folder;
  const fs::path lines = folder.path() / "photos.jsonl";
  const std::string report = "report " + kSurvey + " '" + lines.string() + "'";
  const std::string rig = " --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  std::string verified = run_tagsmith("verify --json " + kSurvey + " " + kPhotos).out;
  REQUIRE(write_file(lines, verified).has_value());
  const std::string page = (folder.path() / "report.html").string();
  const std::string table = (folder.path() / "report.csv").string();
  const ProgramOutput unchecked =
      run_tagsmith(report + " --json --html '" + page + "' --csv '" + table + "'");
  CHECK(json_lines(unchecked.out).at(0)["summary"]["placement"] == "not_checked");
  CHECK(read_file(page)->find("Placement not checked") != std::string::npos);
  CHECK(read_file(table)->find(",finding,placement") != std::string::npos);

  // A second copy of 001R hangs where 002R should.
  for (std::size_t at = 0; (at = verified.find("\"002R\"", at)) != std::string::npos;) {
    verified.replace(at, 6, "\"001R\"");
  }
  REQUIRE(write_file(lines, verified).has_value());
  const ProgramOutput copied = run_tagsmith(report + rig + " --json --csv '" + table + "'");
  CHECK(copied.exit_code == 1);
  CHECK_MESSAGE(copied.err.starts_with("tagsmith report: no photo ties"), copied.err);
  CHECK(copied.err.find('\n') == copied.err.size() - 1);
  const json summary = json_lines(copied.out).at(0)["summary"];
  CHECK(summary["faults"] > 0);
  for (const json& tag : summary["hanging"]) CHECK(tag["verdict"] != "off");
  CHECK(read_file(table)->find("second copy") != std::string::npos);
}

TEST_CASE("faults that only the merge finds have pictures, or say why not") {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return folder.path() / name; };
  const auto quoted = [&](const char* name) { return " '" + path(name).string() + "'"; };
  std::string survey = *read_file(kSurvey);
  survey.insert(survey.find("\ncode:"),
                "\nplaced:\n  - { tag: 003L, side: left, p: [1.9, 2.4, 0.43], "
                "digits: \"01900240040\" }\n");
  REQUIRE(write_file(path("survey.yaml"), survey).has_value());
  const ProgramOutput lines = run_shell("\"$TAGSMITH_PROGRAM\" verify --json" +
                                        quoted("survey.yaml") + " " + kPhotos + "/*.jpg");
  REQUIRE(lines.exit_code == 0);
  REQUIRE(write_file(path("lines.jsonl"), lines.out).has_value());
  const std::string rig = " --rig '" + fs::absolute("surveys/corridor/rig.yaml").string() +
                          "' --run '" + fs::absolute("surveys/corridor/run.csv").string() + "'";
  const auto page = [&](const std::string& from) {
    const ProgramOutput report = run_shell(
        "cd '" + from + "' && \"$TAGSMITH_PROGRAM\" report" + quoted("survey.yaml") +
        quoted("lines.jsonl") + rig + " --html" + quoted("r.html") + " --pdf" + quoted("r.pdf"));
    REQUIRE_MESSAGE(report.exit_code == 1, report.err);
    return *read_file(path("r.html"));
  };
  const auto count = [](const std::string& text, const std::string& part) {
    int found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  const std::string here = page(fs::current_path().string());
  const int cards = count(here, "<article");
  CHECK(cards > 0);
  CHECK(count(here, "data:image/jpeg") == cards);

  const std::string changed =
      std::regex_replace(lines.out, std::regex("\"sha256\":\"....."), "\"sha256\":\"00000");
  REQUIRE(write_file(path("lines.jsonl"), changed).has_value());
  const std::string other = page(fs::current_path().string());
  CHECK(count(other, "No picture: the photo was changed since it was verified.") == cards);
}

TEST_CASE("what up cannot be known of is said in the page, the table and the lines") {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return folder.path() / name; };
  const auto quoted = [&](const char* name) { return " '" + path(name).string() + "'"; };
  // A camera on its head that notes the contrary, and one that notes nothing.
  const GrayImage photo = load_gray_image(kPhotos + "/corridor_01_left.jpg").value();
  const std::string turned =
      encode_gray_image("a.jpg", turn_upright(photo.view(), 3).view()).value();
  REQUIRE(write_file(path("head.jpg"), with_orientation(turned, 1)).has_value());
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + quoted("head.jpg") + " " + kPhotos +
                   "/corridor_02_left.jpg --csv" + quoted("r.csv") + " --html" + quoted("r.html"));
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 3);
  CHECK(lines[0]["up"] == "doubted");
  CHECK(lines[0]["tags"][0]["status"] == "doubtful");
  CHECK(lines[0]["tags"][0]["rule"] == "upside-down");
  CHECK(lines[1]["up"] == "unknown");
  const json covered = lines[2]["summary"]["completeness"];
  CHECK(covered["upright_unchecked"] == json::array({"001L"}));
  CHECK(covered["by_tag"][2]["upright"] == "unchecked");
  const std::string table = *read_file(path("r.csv"));
  const std::string message = lines[0]["tags"][0]["message"];
  CHECK(message.starts_with("000L "));
  CHECK(table.find("left,,\"" + message) != std::string::npos);
  CHECK(table.find("left,unchecked,") != std::string::npos);
  const std::string page = *read_file(path("r.html"));
  CHECK(page.find("<h3>000L: upside-down?</h3>") != std::string::npos);
  CHECK(page.find("No tag in the photos was checked for hanging upside down") != std::string::npos);
}

TEST_CASE("what --rig cannot use is told") {
  const std::string photo = kPhotos + "/corridor_01_left.jpg";
  const ProgramOutput wide = run_tagsmith("verify surveys/corridor/survey.yaml " + photo +
                                          " --rig surveys/curved/rig.yaml "
                                          "--camera middle");
  CHECK(wide.exit_code == 2);
  CHECK(wide.err.find("left, right") != std::string::npos);
  const TemporaryFolder folder;
  const fs::path copy = folder.path() / "IMG_1.jpg";
  fs::copy_file(photo, copy);
  const ProgramOutput unknown = run_tagsmith("verify --json " + kSurvey + " '" + copy.string() +
                                             "' --rig surveys/corridor/rig.yaml");
  CHECK(unknown.exit_code == 0);
  const json summary = json_lines(unknown.out).at(1)["summary"];
  CHECK(summary["placement"] == "not_checked");
  REQUIRE(summary["hanging_notes"].size() == 1);
  CHECK(summary["hanging_notes"][0].get<std::string>().starts_with(copy.string() + ": "));
  CHECK(unknown.err.find(copy.string() + ": ") != std::string::npos);
  CHECK(run_tagsmith("verify " + kSurvey).exit_code == 2);
  CHECK(run_tagsmith("verify " + kSurvey + " " + photo + " --camera left").exit_code == 2);
}

TEST_CASE("a tag of another survey that was given is named") {
  const ProgramOutput output = run_tagsmith("verify --json " + kSurvey +
                                            " surveys/curved/photos/curved_02_left.jpg --also "
                                            "surveys/curved/survey.yaml");
  CHECK(output.exit_code == 1);
  const json tag = json_lines(output.out).at(0)["tags"][0];
  CHECK(tag["rule"] == "other-survey");
  CHECK(tag["digits"] == "003105070602");
  const std::string message = tag["message"];
  for (const char* part : {"003105070602", "001L", "curved", "corridor"}) {
    CHECK_MESSAGE(message.find(part) != std::string::npos, message);
  }
}

TEST_CASE("photos that show codes of other surveys alone are told to be of another drive") {
  const std::string curved = "surveys/curved/photos/curved_0";
  const auto summary_of = [](const std::string& photos) {
    const ProgramOutput output = run_tagsmith("verify --json " + kSurvey + " " + photos);
    CHECK(output.exit_code == 1);
    return json_lines(output.out).back().at("summary");
  };
  const json foreign = summary_of(curved + "1_left.jpg " + curved + "2_left.jpg");
  CHECK(foreign.contains("another_drive"));
  CHECK(foreign.at("unknown") == 2);
  CHECK(foreign.at("misprinted") == 0);  // though one code is right by the other check digit alone
  // One strange code may be a misprint, and one tag of the survey shows that it is the right one.
  CHECK_FALSE(summary_of(curved + "1_left.jpg").contains("another_drive"));
  const json mixed = summary_of(curved + "1_left.jpg " + curved + "2_left.jpg " + kPhotos +
                                "/corridor_01_left.jpg");
  CHECK_FALSE(mixed.contains("another_drive"));
}

TEST_CASE("two runs are merged into a report, and a third skips what they did") {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  const auto verify = [&](const std::string& name, const std::string& arguments) {
    const ProgramOutput output = run_tagsmith("verify --json " + kSurvey + " " + arguments);
    REQUIRE(write_file(folder.path() / name, output.out).has_value());
    return output;
  };
  verify("1.jsonl", kPhotos + "/corridor_01_left.jpg " + kPhotos + "/corridor_02_left.jpg");
  verify("2.jsonl", kPhotos + "/corridor_02_left.jpg surveys/curved/photos/curved_02_left.jpg");
  const std::string both = "'" + path + "/1.jsonl' '" + path + "/2.jsonl'";
  const ProgramOutput report = run_tagsmith("report " + kSurvey + " " + both + " --html '" + path +
                                            "/r.html' --csv '" + path + "/r.csv'");
  CHECK(report.exit_code == 1);
  const json summary =
      json_lines(run_tagsmith("report --json " + kSurvey + " " + both).out).at(0)["summary"];
  CHECK(summary["files"] == 3);
  CHECK(summary["faults"] == 1);
  CHECK(summary["repeated"] == 1);
  CHECK(summary["completeness"]["seen"] == 2);
  CHECK(summary["completeness"]["tags"] == 16);
  const std::string html = *read_file(folder.path() / "r.html");
  for (const char* part : {"<!doctype html>", "width=device-width", "<svg", "id=\"filter\"",
                           "@media print", "not-in-survey", "</html>"}) {
    CAPTURE(part);
    CHECK(html.find(part) != std::string::npos);
  }
  for (const char* loads : {"src=\"http", "@import", "url(", "fetch(", "<link"}) {
    CAPTURE(loads);
    CHECK(html.find(loads) == std::string::npos);
  }
  const std::string csv = *read_file(folder.path() / "r.csv");
  CHECK(csv.find("000L,019000000404,") != std::string::npos);
  CHECK(csv.find("unseen") != std::string::npos);

  const ProgramOutput again =
      run_tagsmith("verify --json " + kSurvey + " --resume '" + path + "/1.jsonl' " + kPhotos +
                   "/corridor_01_left.jpg " + kPhotos + "/corridor_03_left.jpg");
  const std::vector<json> added = json_lines(again.out);
  REQUIRE(added.size() == 2);  // the new file and the summary
  CHECK(added[0]["file"] == kPhotos + "/corridor_03_left.jpg");
  CHECK(added[1]["summary"]["files"] == 2);
  CHECK(again.err.ends_with(": 1\n"));

  const std::string cut_short = *read_file(folder.path() / "1.jsonl") + "{\"file\": \"a.jp";
  REQUIRE(write_file(folder.path() / "cut.jsonl", cut_short).has_value());
  const ProgramOutput cut = run_tagsmith("report " + kSurvey + " '" + path + "/cut.jsonl'");
  CHECK(cut.exit_code == 1);
  CHECK(cut.err.starts_with(path + "/cut.jsonl: 1 "));
  CHECK(run_tagsmith("report " + kSurvey + " no-such.jsonl").exit_code == 2);
  const ProgramOutput endless = run_tagsmith("report " + kSurvey + " /dev/zero");
  CHECK(endless.exit_code == 2);
  CHECK(endless.err.find("64 MiB") != std::string::npos);
}

TEST_CASE("tags that are known to worse than the tolerance are named") {
  const std::string command =
      "verify surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --run "
      "surveys/corridor/run.csv";
  const std::string words = "may be off by more than the tolerance of 2 mm";
  CHECK(run_tagsmith(command).err.find("may be off") == std::string::npos);
  CHECK(run_tagsmith(command + " --tolerance 2").err.find(words) != std::string::npos);
  const json summary =
      json_lines(run_tagsmith(command + " --tolerance 2 --json").out).back().at("summary");
  REQUIRE_FALSE(summary.at("hanging_notes").empty());
  CHECK(summary.at("hanging_notes")[0].get<std::string>().find(words) != std::string::npos);
}

TEST_CASE("wrong use gives exit code 2 and nothing on standard output") {
  for (const std::string& arguments :
       {std::string("verify"), "verify " + kSurvey, "verify no-such.yaml " + kPhotos,
        "verify " + kSurvey + " docs", "verify --jobs 0 " + kSurvey + " docs",
        "verify --dpi nan " + kSurvey + " " + kPhotos,
        "verify --tolerance nan --rig surveys/corridor/rig.yaml " + kSurvey + " " + kPhotos}) {
    CAPTURE(arguments);
    const ProgramOutput output = run_tagsmith(arguments);
    CHECK(output.exit_code == 2);
    CHECK(output.out == "");
    CHECK(output.err != "");
  }
  CHECK(run_tagsmith("verify --help").out.find("Example:") != std::string::npos);
}

}  // namespace tagsmith::detail::test
