// SPDX-License-Identifier: Apache-2.0
// Print files and scans as users spoil them: the words they get.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/image/grow_ink.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kSurvey = "surveys/corridor/survey.yaml";

void print_into(const fs::path& folder, const std::string& options) {
  const ProgramOutput output =
      run_tagsmith("print " + options + " -o '" + folder.string() + "' --no-setting-out");
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
}

// The line of one file.
json verified(const fs::path& file, const std::string& options = "") {
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + " '" + file.string() + "' " + options);
  return parsed_json(output.out.substr(0, output.out.find('\n')));
}

std::string rule_of(const json& line) {
  return line.contains("rules") ? line["rules"][0].get<std::string>() : std::string();
}

// What is wrong, in words.
std::string words_of(const json& line) {
  return line["findings"].empty() ? "" : line["findings"][0].get<std::string>();
}

GrayImage cropped(const GrayView& image, int x, int width) {
  return copy_of(part_of(image, {x, 0, x + width, image.height}));
}

// Every sixteenth column left out: 93.75 % of its width.
GrayImage narrowed(const GrayView& image) {
  GrayImage narrow{image.width - image.width / 16, image.height, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (x % 16 != 15) narrow.samples.push_back(image.at(x, y));
    }
  }
  return narrow;
}

GrayImage darkened(GrayImage image, int divisor) {
  for (std::uint8_t& sample : image.samples) sample = static_cast<std::uint8_t>(sample / divisor);
  return image;
}

// A band across the bars, over the lower half of them.
GrayImage half_covered(GrayImage image) {
  for (int y = 1060; y < 1500; ++y) {
    for (int x = 400; x < 2300; ++x) {
      image.samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(x)] = 255;
    }
  }
  return image;
}

}  // namespace

TEST_CASE("what is wrong with a scan of known resolution is named") {
  const TemporaryFolder folder;
  print_into(folder.path(), kSurvey + " --format png --dpi 150 --tags 000L");
  const GrayImage page = load_gray_image(folder.path() / "000L.png").value();
  REQUIRE(page.width == 2658);
  struct Case {
    std::string name;
    GrayImage scan;
    const char* dpi;
    const char* rule;
    const char* words;
  };
  const GrayImage thick = grow_ink(page.view(), 15);
  const std::vector<Case> cases{
      {"good", page, "150", "", ""},
      {"turned on the glass", turn_upright(page.view(), 3), "150", "", ""},
      {"fit to page", page, "159.6", "wrong-scale", "; 94.0 % of its size"},
      {"stretched", narrowed(page.view()), "150", "wrong-scale",
       "93.7 % of its width and 99.9 % of its height: stretched, or of another template"},
      {"mirrored", turn_upright(page.view(), 2), "150", "mirrored", "000L is mirrored"},
      {"inverted", exchange_black_and_white(page.view()), "150", "inverted",
       "000L is white on black, expected black on white"},
      {"grown", thick, "150", "bars-grown",
       "bars wider than drawn by more than 0.7 modules (2.1 mm): made so much narrower, it is "
       "000L"},
      {"shrunk", grow_ink(page.view(), -16), "150", "bars-grown",
       "bars narrower than drawn by more than 0.7 modules (2.1 mm)"},
      {"cropped inside the frame", cropped(page.view(), 330, 2000), "150", "no-frame",
       "the bars of 000L are there without their whole feature frame"},
      {"dark", darkened(page, 40), "150", "too-dark", "no tag was found: the brightest parts"},
      {"blank", GrayImage{800, 600, std::vector<std::uint8_t>(480'000, 255)}, "150", "no-tag",
       "no tag was found"}};
  for (const Case& c : cases) {
    CAPTURE(c.name);
    const fs::path file = folder.path() / "scan" / "scan.png";
    fs::create_directories(file.parent_path());
    REQUIRE(save_gray_image(file, c.scan.view()).has_value());
    const json line = verified(file, std::string("--dpi ") + c.dpi);
    CAPTURE(line.dump());
    CHECK(rule_of(line) == c.rule);
    CHECK(words_of(line).find(c.words) != std::string::npos);
    if (!line["tags"].empty()) CHECK(line["up"] == "unknown");
  }
}

TEST_CASE("a tag that reads although half of it is covered is told where to clean") {
  const TemporaryFolder folder;
  print_into(folder.path(), kSurvey + " --format png --dpi 150 --tags 000L");
  const GrayImage page = load_gray_image(folder.path() / "000L.png").value();
  const fs::path file = folder.path() / "scan" / "scan.png";
  fs::create_directories(file.parent_path());
  REQUIRE(save_gray_image(file, half_covered(page).view()).has_value());
  const json line = verified(file, "--dpi 150");
  CAPTURE(line.dump());
  CHECK(line["tags"][0]["status"] == "ok");
  CHECK(line["findings"].empty());
  REQUIRE(line["notes"].size() == 1);
  const auto note = line["notes"][0].get<std::string>();
  CHECK(note.starts_with("000L reads, but "));
  CHECK(note.find("at the lower middle") != std::string::npos);
}

TEST_CASE("PDFs that cannot be read say why in words of their own") {
  const TemporaryFolder folder;
  print_into(folder.path(), kSurvey + " --format pdf --tags 000L");
  const std::string pdf = *read_file(folder.path() / "000L.pdf");
  const auto quoted = [&](const char* name) {
    return "'" + (folder.path() / "odd" / name).string() + "' ";
  };
  const auto at = [&](const char* name) { return folder.path() / "odd" / name; };
  REQUIRE(write_file(at("plain.pdf"), pdf).has_value());
  REQUIRE(
      run_shell("qpdf --encrypt user owner 256 -- " + quoted("plain.pdf") + quoted("password.pdf"))
          .exit_code == 0);
  REQUIRE(write_file(at("text.pdf"), "hello").has_value());
  REQUIRE(write_file(at("mail.pdf"), "From: somebody\n\n" + pdf).has_value());
  std::string corrupted = pdf;
  // In the page's own content, after the plate.
  corrupted.replace(corrupted.find("stream") + 900, 40, 40, 'A');
  REQUIRE(write_file(at("corrupted.pdf"), corrupted).has_value());
  const json noted = verified(at("corrupted.pdf"));
  CHECK(noted["findings"].empty());
  CHECK(noted["notes"][0].get<std::string>().starts_with(
      "page 1: the file is damaged, and others may draw it otherwise: Syntax Error"));
  CHECK(!verified(at("plain.pdf")).contains("notes"));
  CHECK(words_of(verified(at("plain.pdf"))).empty());
  CHECK(words_of(verified(at("mail.pdf"))).empty());
  CHECK(words_of(verified(at("password.pdf"))) ==
        "is protected by a password: save it without one");
  CHECK(words_of(verified(at("text.pdf"))).starts_with("is called .pdf and is none"));
}

TEST_CASE("a print from another survey is told as that, not as stale") {
  const TemporaryFolder folder;
  print_into(folder.path(), "surveys/curved/survey.yaml --format pdf --tags 000L");
  const json line = verified(folder.path() / "000L.pdf");
  CHECK(words_of(line) == "it was printed from survey curved, expected corridor (manifest.json)");
  CHECK(!line.contains("stale"));
  CHECK(std::ranges::count(line["rules"], "other-survey") == 1);
  CHECK(line["tags"][0]["rule"] == "not-in-survey");
}

TEST_CASE("a damaged photo is read, with a note that names the file and not on standard error") {
  const TemporaryFolder folder;
  std::string jpeg = *read_file("surveys/corridor/photos/corridor_01_left.jpg");
  jpeg.erase(jpeg.size() - 30'000, 20'000);
  const fs::path file = folder.path() / "IMG_1.jpg";
  REQUIRE(write_file(file, jpeg).has_value());
  const ProgramOutput output = run_tagsmith("verify " + kSurvey + " '" + file.string() + "'");
  CHECK(output.exit_code == 0);
  CHECK(output.err.empty());
  CHECK(output.out.find("IMG_1.jpg: ok  000L") != std::string::npos);
  const json line = verified(file);
  REQUIRE(line["notes"].size() == 1);
  const std::string note = line["notes"][0];
  CHECK(note.find("JPEG data") != std::string::npos);  // what libjpeg says of it
  CHECK(output.out.find(note) != std::string::npos);
  const ProgramOutput read = run_tagsmith("read '" + file.string() + "'");
  CHECK(read.err.find("IMG_1.jpg: " + note.substr(0, 20)) != std::string::npos);
}

}  // namespace tagsmith::detail::test
