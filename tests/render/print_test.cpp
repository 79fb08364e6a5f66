// SPDX-License-Identifier: Apache-2.0
// `tagsmith print` from the outside, on the shipped surveys.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tests/render/print_command.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

std::string all_bytes(const fs::path& folder) {
  std::string bytes;
  for (const std::string& name : names_in(folder)) bytes += name + read_file(folder / name).value();
  return bytes;
}

}  // namespace

TEST_CASE("the corridor prints 16 tags, each a PDF and an SVG, and two manifests") {
  const TemporaryFolder folder;
  const ProgramOutput output = print(kCorridor, folder.path());
  CAPTURE(output.err);
  REQUIRE(output.exit_code == 0);
  CHECK(output.err == "");
  const std::vector<std::string> names = names_in(folder.path());
  CHECK(names.size() == 36);
  for (const char* name :
       {"000L.pdf", "000L.svg", "007R.pdf", "007R.svg", "manifest.csv", "manifest.json"}) {
    CHECK(std::ranges::count(names, name) == 1);
  }
  std::vector<std::string> listed = split(trim(output.out), '\n');
  CHECK(listed.size() == 36);
  for (const std::string& path : listed) CHECK(fs::is_regular_file(path));
}

TEST_CASE("the manifest says what was printed") {
  const TemporaryFolder folder;
  REQUIRE(print(kCorridor, folder.path()).exit_code == 0);
  const json manifest = parsed_json(read_file(folder.path() / "manifest.json").value());
  CHECK(manifest["survey"] == "corridor");
  CHECK(manifest["template"] == "tag-400x300");
  CHECK(manifest["check_digit"] == "sum10");
  CHECK(manifest["page_mm"] == json({450.0, 350.0}));
  CHECK(manifest["plate_mm"] == json({400.0, 300.0}));
  CHECK(manifest["feature_frame_inner_mm"] == json({343.0, 168.0}));
  CHECK(manifest["module_mm"].get<double>() == Approx(3.0353982).epsilon(1e-7));
  REQUIRE(manifest["tags"].size() == 16);
  const json& tag = manifest["tags"][1];  // 0.343 m ahead, coded 0.34 m
  CHECK(tag["tag"] == "000R");
  CHECK(tag["side"] == "right");
  CHECK(tag["digits"] == "000000340401");
  CHECK(tag["position"] == json({0.0, 0.343, 0.4}));
  CHECK(tag["coded_position"] == json({0.0, 0.34, 0.4}));
  CHECK(tag["rounding"] == json({0.0, -0.003, 0.0}));
  CHECK(tag["chainage"] == 0.343);
  CHECK(tag["files"] == json({"000R.pdf", "000R.svg"}));
}

TEST_CASE("the CSV has the same tags, a row each") {
  const TemporaryFolder folder;
  REQUIRE(print(kCorridor, folder.path()).exit_code == 0);
  const std::string csv = read_file(folder.path() / "manifest.csv").value();
  const std::vector<std::string> rows = split(trim(csv), '\n');
  REQUIRE(rows.size() == 17);
  const std::vector<std::string> keys = split(trim(rows[0]), ',');
  const std::vector<std::string> values = split(trim(rows[2]), ',');
  REQUIRE(keys.size() == values.size());
  const auto value = [&](const std::string& key) {
    return values[static_cast<std::size_t>(std::ranges::find(keys, key) - keys.begin())];
  };
  CHECK(value("tag") == "000R");
  CHECK(value("digits") == "000000340401");
  CHECK(value("y") == "0.343");
  CHECK(value("rounding_y") == "-0.003");
  CHECK(value("files") == "000R.pdf;000R.svg");
  CHECK(value("module_mm") == "3.035398");
}

TEST_CASE("formats, chosen tags and one PDF of all") {
  struct Case {
    const char* options;
    std::vector<std::string> names;
  };
  const Case cases[] = {
      {"--format pdf --tags 003R,000L", {"000L.pdf", "003R.pdf"}},
      {"--format svg --tags 003R", {"003R.svg"}},
      {"--tags 003R --tags 003R", {"003R.pdf", "003R.svg"}},
      {"--single --format pdf", {"tags.pdf"}},
      {"--single --tags 001L", {"001L.svg", "tags.pdf"}},
  };
  for (const Case& example : cases) {
    CAPTURE(example.options);
    const TemporaryFolder folder;
    REQUIRE(print(kCorridor, folder.path(), example.options).exit_code == 0);
    std::vector<std::string> expected = example.names;
    expected.insert(expected.end(),
                    {"manifest.csv", "manifest.json", "setting-out.csv", "setting-out.pdf"});
    std::ranges::sort(expected);
    CHECK(names_in(folder.path()) == expected);
  }
}

TEST_CASE("one PDF of all has a page a tag") {
  const TemporaryFolder folder;
  REQUIRE(print(kCorridor, folder.path(), "--single").exit_code == 0);
  REQUIRE_MESSAGE(has_program("pdfinfo"), "pdfinfo is missing: install poppler-utils");
  const ProgramOutput info = run_shell("pdfinfo '" + (folder.path() / "tags.pdf").string() + "'");
  CHECK(info.out.find("Pages:           16\n") != std::string::npos);
}

TEST_CASE("the same survey gives the same bytes, whatever the jobs, time zone and language") {
  const TemporaryFolder first;
  const TemporaryFolder second;
  REQUIRE(print("surveys/curved/survey.yaml", first.path(), "--jobs 1").exit_code == 0);
  ::setenv("TZ", "Asia/Kathmandu", 1);
  ::setenv("LC_ALL", "C.UTF-8", 1);
  ::setenv("LANG", "ja_JP.UTF-8", 1);
  REQUIRE(print("surveys/curved/survey.yaml", second.path(), "--jobs 4").exit_code == 0);
  CHECK(names_in(first.path()).size() == 28);
  CHECK((all_bytes(first.path()) == all_bytes(second.path())));
}

TEST_CASE("--json prints an object a tag and a summary") {
  const TemporaryFolder folder;
  const ProgramOutput output = print(kCorridor, folder.path(), "--json --tags 000L,000R");
  const std::vector<std::string> lines = split(trim(output.out), '\n');
  REQUIRE(lines.size() == 3);
  CHECK(parsed_json(lines[0])["tag"] == "000L");
  CHECK(fs::exists(parsed_json(lines[0])["files"][0].get<std::string>()));
  CHECK(parsed_json(lines[2])["summary"]["count"] == 2);
  // Those of a tag are in its own line.
  const auto others = parsed_json(lines[2])["summary"]["files"];
  CHECK(others.size() >= 2);
  for (const auto& file : others) {
    const std::string name = fs::path(file.get<std::string>()).filename();
    CHECK(name != "000L.pdf");
    CHECK(name != "000L.svg");
  }
}

TEST_CASE("wrong use says what is wrong and writes nothing") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "out";
  REQUIRE(write_file(temporary.path() / "file", ""));
  struct Case {
    std::string arguments;
    const char* message;
  };
  const std::string to_folder = " -o '" + folder.string() + "' ";
  const std::string survey = kCorridor;
  const Case cases[] = {
      {survey + to_folder + "--tags 00L", "has no tag \"00L\", did you mean 000L?"},
      {survey + to_folder + "--tags xyzxyz", "has no tag \"xyzxyz\""},
      {survey + to_folder + "--format gif", "--format"},
      {survey + to_folder + "--format svg --single", "--single"},
      {survey + to_folder + "--jobs -1", "--jobs"},
      {survey + to_folder + "--format svg --outline-text", "--outline-text is for PDF files"},
      {survey + to_folder + "--no-setting-out --tolerance 4",
       "--no-setting-out excludes --tolerance"},
      {survey + to_folder + "--setting-out-paper a4 --no-setting-out",
       "--no-setting-out excludes --setting-out-paper"},
      {survey + to_folder + "--no-setting-out --point-order PNEZD",
       "--no-setting-out excludes --point-order"},
      {survey + to_folder + "--pdf-x none.icc", "none.icc"},
      {survey + to_folder + "--pdf-x surveys/corridor/survey.yaml", "is no ICC profile"},
      {"missing.yaml" + to_folder, "missing.yaml: no such file"},
      {survey + " -o /proc/none", "/proc/none"},
      {survey + " -o '" + (temporary.path() / "file").string() + "'",
       "file: is a file, expected a folder"},
      {survey, "--output"},
  };
  for (const Case& example : cases) {
    CAPTURE(example.arguments);
    const ProgramOutput output = run_tagsmith("print " + example.arguments);
    CAPTURE(output.err);
    CHECK(output.exit_code == 2);
    CHECK(output.out == "");
    CHECK(output.err.find(example.message) != std::string::npos);
    CHECK_FALSE(fs::exists(folder));
  }
}

TEST_CASE("a logo that is no picture, and a QR symbol of too much text, print nothing") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "out";
  const fs::path survey = temporary.path() / "survey.yaml";
  REQUIRE(write_file(survey, *read_file(kCorridor)));
  REQUIRE(write_file(temporary.path() / "logo.svg", "no picture"));
  const auto refused = [&](const std::string& line) {
    REQUIRE(write_file(temporary.path() / "tag-400x300.yaml",
                       *read_file("templates/tag-400x300.yaml") + line));
    const ProgramOutput output = print(survey.string(), folder);
    CHECK(output.exit_code == 2);
    CHECK_FALSE(fs::exists(folder));
    return output.err;
  };
  CHECK(refused("logo: { file: logo.svg, size_mm: [40, 20] }\n").find("logo.svg: is no SVG file") !=
        std::string::npos);
  const std::string error =
      refused("qr: { size_mm: 12, content: \"https://mine.example/{survey}/{name}/{digits}\" }\n");
  CHECK(error.find("tag 000L: the QR symbol") != std::string::npos);
}

TEST_CASE("a machine without fonts is told so") {
  const TemporaryFolder temporary;
  const std::string fonts = (temporary.path() / "fonts.conf").string();
  REQUIRE(write_file(fonts, "<?xml version=\"1.0\"?><fontconfig></fontconfig>"));
  ::setenv("FONTCONFIG_FILE", fonts.c_str(), 1);
  const ProgramOutput output = print(kCorridor, temporary.path() / "out");
  ::unsetenv("FONTCONFIG_FILE");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("install fonts-dejavu-core") != std::string::npos);
  CHECK_FALSE(fs::exists(temporary.path() / "out"));
}

TEST_CASE("names in any script and paths that need quoting stay whole in the manifests") {
  const TemporaryFolder temporary;
  std::string survey = read_file(kCorridor).value();
  const std::size_t at = survey.find("survey: corridor");
  REQUIRE(at != std::string::npos);
  const std::string name = "\u7164\u77ff <1> & \u00c4";
  survey.replace(at, 16, "survey: '" + name + "'");
  const std::string path = (temporary.path() / "a, \"b\".yaml").string();
  REQUIRE(write_file(path, survey));
  const fs::path folder = temporary.path() / "out";
  const ProgramOutput output = print(path, folder, "--tags 000L");
  CAPTURE(output.err);
  REQUIRE(output.exit_code == 0);
  const json manifest = parsed_json(read_file(folder / "manifest.json").value());
  CHECK(manifest["survey"] == name);
  CHECK(manifest["survey_file"] == path);
  const std::string csv = read_file(folder / "manifest.csv").value();
  CHECK(csv.find(name + ",\"" + temporary.path().string() + "/a, \"\"b\"\".yaml\",000L,") !=
        std::string::npos);
}

TEST_CASE("a survey's name that leaves the label no room for its revision is told") {
  const TemporaryFolder temporary;
  const std::string path = (temporary.path() / "survey.yaml").string();
  const auto printed = [&](std::size_t length) {
    std::string survey = read_file(kCorridor).value();
    survey.replace(survey.find("survey: corridor"), 16, "survey: " + std::string(length, 'M'));
    REQUIRE(write_file(path, survey));
    const ProgramOutput output =
        print(path, temporary.path() / std::to_string(length), "--tags 000L --no-setting-out");
    CHECK(output.exit_code == 0);
    return output.err;
  };
  CHECK(printed(20) == "");
  CHECK(printed(150).find("the label of 000L has no room for all of `MMM") != std::string::npos);
}
