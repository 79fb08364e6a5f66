// SPDX-License-Identifier: Apache-2.0
// What goes to the sign maker: order sheet, cut files, one ZIP.
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/zip_file.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// The corridor with round plates that have four holes.
std::string holed_survey(const fs::path& folder) {
  std::string text = read_file("surveys/corridor/survey.yaml").value();
  text.replace(text.find("tag-400x300"), 11, "holed");
  REQUIRE(write_file(folder / "survey.yaml", text));
  REQUIRE(write_file(folder / "holed.yaml",
                     "tag: holed\n"
                     "plate: [0.400, 0.300]\n"
                     "feature_frame: { inner: [0.343, 0.168], stroke: 0.012 }\n"
                     "symbol: { quiet_zone: 9, margin: 9 }\n"
                     "holes: { diameter_mm: 6, inset_mm: 10 }\n"
                     "cut: { contour: true, corner_radius_mm: 10 }\n"
                     "material: 3 mm aluminium composite\n"));
  return (folder / "survey.yaml").string();
}

struct Group {
  int code = 0;
  std::string value;
};

std::vector<Group> groups_of(const std::string& dxf) {
  std::vector<Group> groups;
  std::istringstream lines(dxf);
  std::string code;
  std::string value;
  while (std::getline(lines, code) && std::getline(lines, value)) {
    groups.push_back({std::stoi(code), value});
  }
  return groups;
}

}  // namespace

TEST_CASE("a ZIP for the shop holds all files, is read by others and the same every time") {
  const TemporaryFolder folder;
  const std::string survey = holed_survey(folder.path());
  const fs::path out = folder.path() / "out";
  const fs::path zip = folder.path() / "shop.zip";
  const auto print = [&] {
    return run_tagsmith("print " + survey + " -o " + out.string() +
                        " --paper roll:1000 --format pdf --zip " + zip.string());
  };
  const ProgramOutput output = print();
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  for (const char* test : {"python3 -m zipfile -t ", "unzip -tq "}) {
    CHECK(run_shell(test + zip.string()).exit_code == 0);
  }
  const fs::path unpacked = folder.path() / "unpacked";
  REQUIRE(run_shell("unzip -q " + zip.string() + " -d " + unpacked.string()).exit_code == 0);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(out)) {
    ++files;
    CHECK(read_file(entry.path()).value() == read_file(unpacked / entry.path().filename()).value());
  }
  CHECK(files == 7);
  const json manifest = parsed_json(read_file(out / "manifest.json").value());
  CHECK(manifest["sha256"]["sheet-001-cut.dxf"] ==
        sha256(read_file(out / "sheet-001-cut.dxf").value()));
  const std::string first = sha256(read_file(zip).value());
  REQUIRE(print().exit_code == 0);
  CHECK(sha256(read_file(zip).value()) == first);
  CHECK(run_tagsmith("verify " + survey + " " + out.string()).exit_code == 0);
  const std::string order =
      run_shell("pdftotext -layout " + (out / "order.pdf").string() + " -").out;
  for (const char* part : {"16", "400 x 300 mm", "3 mm aluminium composite", "4 a plate", "6 mm",
                           "10 mm", "roll:1000", "CutContour"}) {
    CHECK_MESSAGE(order.find(part) != std::string::npos, order);
  }
}

TEST_CASE("the cut file has each plate's outline and holes where the page has them") {
  const TemporaryFolder folder;
  const std::string survey = holed_survey(folder.path());
  const fs::path out = folder.path() / "out";
  REQUIRE(run_tagsmith("print " + survey + " -o " + out.string() +
                       " --paper roll:1000 --format pdf --order")
              .exit_code == 0);
  const json manifest = parsed_json(read_file(out / "manifest.json").value());
  int outlines = 0;
  int circles = 0;
  int arcs = 0;
  double x = 0;
  double right = 0;
  double top = 0;
  for (const Group& group : groups_of(read_file(out / "sheet-001-cut.dxf").value())) {
    outlines += group.value == "POLYLINE" ? 1 : 0;
    circles += group.value == "CIRCLE" ? 1 : 0;
    arcs += group.code == 42 ? 1 : 0;
    if (group.code == 8) CHECK(group.value == "CutContour");
    if (group.code == 40) CHECK(parse_number(group.value) == 3);
    if (group.code == 10) x = parse_number(group.value).value();
    if (group.code == 10 || group.code == 20) CHECK(parse_number(group.value).value() > 0);
    right = std::max(right, x);
    if (group.code == 20) top = std::max(top, parse_number(group.value).value());
  }
  CHECK(outlines == 16);
  CHECK(circles == 64);
  CHECK(arcs == 64);
  // Borders of 8 mm at the right at least and 15 mm above, and half a gap of 10 mm.
  CHECK(right <= manifest["page_mm"][0].get<double>() - 13 + 0.001);
  CHECK(top == doctest::Approx(manifest["page_mm"][1].get<double>() - 20).epsilon(1e-4));
}

TEST_CASE("a ZIP that cannot be is refused, with the place and nothing written") {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string print = "print surveys/corridor/survey.yaml -o " + out.string();
  const std::string taken = (folder.path() / "taken.zip").string();
  fs::create_directory(taken);
  for (const std::string& zip : {std::string("shop.tar"), taken}) {
    const ProgramOutput output = run_tagsmith(print + " --zip " + zip);
    CHECK(output.exit_code == 2);
    CHECK_MESSAGE(output.err.find(zip) != std::string::npos, output.err);
    CHECK_FALSE(fs::exists(out));
  }
  const fs::path zip = folder.path() / "a.zip";
  const std::vector<ZipEntry> gone{{"gone", folder.path() / "gone"}};
  CHECK_FALSE(write_zip(zip, gone));
  const std::vector<ZipEntry> many(70'000, gone.front());
  CHECK_FALSE(write_zip(zip, many));
  REQUIRE(write_zip(zip, {}));
  CHECK(read_file(zip).value().size() == 22);
}
