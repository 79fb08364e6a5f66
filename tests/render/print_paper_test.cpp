// SPDX-License-Identifier: Apache-2.0
// `tagsmith print` onto paper, for printers, with proof; `tagsmith diff` and what it hands to
// print.
#include <cmath>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/render/print_command.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

json manifest_in(const fs::path& folder) {
  return parsed_json(read_file(folder / "manifest.json").value());
}

// The corridor with standard check digits, so that zbar is asked, and another template.
std::string gs1_survey(const fs::path& folder, const std::string& tag) {
  std::string text = read_file(kCorridor).value();
  text.replace(text.find("sum10"), 5, "gs1");
  text.replace(text.find("tag-400x300"), 11, tag);
  const fs::path path = folder / "survey.yaml";
  REQUIRE(write_file(path, text));
  return path.string();
}

}  // namespace

TEST_CASE("tiles on A4 are put together and read by the proof") {
  const TemporaryFolder folder;
  const ProgramOutput output =
      print(kCorridor, folder.path(), "--paper A4 --tile --tags 000L --proof --format both");
  REQUIRE_MESSAGE(output.exit_code == 0, output.err);
  const json manifest = manifest_in(folder.path());
  REQUIRE(manifest["proof"].size() == 2);  // PDF and SVG
  for (const json& proof : manifest["proof"]) {
    CHECK(proof["digits"] == "019000000404");
    CHECK(proof["problem"] == "");
    CHECK(proof["corner_error_mm"].get<double>() < 0.1);
  }
  CHECK(fs::exists(folder.path() / "000L-A1.svg"));
  CHECK(fs::exists(folder.path() / "000L-assembly.svg"));
  const ProgramOutput info = run_shell("pdfinfo '" + (folder.path() / "000L.pdf").string() + "'");
  CHECK(info.out.find("Pages:           5\n") != std::string::npos);
  CHECK(info.out.find("841.89 x 595.276 pts (A4)") != std::string::npos);
  CHECK(run_tagsmith(std::string("verify ") + kCorridor + " '" + folder.path().string() + "'")
            .exit_code == 0);
}

TEST_CASE("the office template nests on A4 and Letter; zbar reads gs1 codes; hashes are right") {
  const TemporaryFolder folder;
  const std::string survey = gs1_survey(folder.path(), "tag-a4");
  for (const char* paper : {"A4", "Letter"}) {
    CAPTURE(paper);
    const fs::path out = folder.path() / paper;
    const ProgramOutput output =
        print(survey, out, std::string("--tags 000L,001R --format pdf --proof --paper ") + paper);
    REQUIRE_MESSAGE(output.exit_code == 0, output.err);
    const json manifest = manifest_in(out);
    REQUIRE(manifest["proof"].size() == 2);
    CHECK(manifest["proof"][0]["zbar"].get<std::string>().size() == 13);
    CHECK(manifest["dots_per_inch"] == 300);
    CHECK(manifest["rounding"] == "");
    for (const auto& [file, hash] : manifest["sha256"].items()) {
      CHECK(hash == sha256(read_file(out / file).value()));
    }
    CHECK(manifest["sha256"].contains("sheet-001.pdf"));
  }
}

TEST_CASE("a roll carries turned plates, is proved, verified and says what it wastes") {
  const TemporaryFolder folder;
  struct Row {
    const char* tag;
    double length;  // of the roll at most, metres
  };
  for (const auto& [tag, length] : {Row{"tag-400x300", 2.30}, Row{"tag-a4", 0.84}}) {
    CAPTURE(tag);
    const std::string survey = gs1_survey(folder.path(), tag);
    const fs::path out = folder.path() / tag;
    const ProgramOutput output =
        print(survey, out, "--paper roll:1000 --format pdf --proof --bar-adjust -0.1");
    REQUIRE_MESSAGE(output.exit_code == 0, output.err);
    const json manifest = manifest_in(out);
    CHECK(manifest["roll"]["length_m"] == manifest["page_mm"][1].get<double>() / 1000);
    CHECK(manifest["roll"]["length_m"] <= length);
    CHECK(manifest["roll"]["waste_percent"] < 20);
    CHECK(output.err.find(" of roll:1000, 1") != std::string::npos);
    // A bar that is one dot narrower is half a dot farther to the right and below.
    constexpr double kDot = 25.4 / 300;
    for (const json& proof : manifest["proof"]) {
      CHECK(proof["corner_error_mm"].get<double>() < std::sqrt(0.5) * kDot + 0.05);
    }
    const ProgramOutput verified = run_tagsmith("verify " + survey + " " + out.string());
    CHECK_MESSAGE(verified.exit_code == 0, verified.out);
  }
}

TEST_CASE("any template prints on whole dots and is read; too coarse a printer is refused") {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  for (const char* dpi : {"150", "300"}) {
    CAPTURE(dpi);
    const ProgramOutput output = print(
        kCorridor, out, std::string("--tags 000L,003R --format pdf,png --proof --dpi ") + dpi);
    REQUIRE_MESSAGE(output.exit_code == 0, output.err);
    const std::string rounding = manifest_in(out)["rounding"];
    CHECK(rounding.starts_with("module 3.0354 mm = "));
    CHECK(rounding.find(std::string(dpi) + " dpi") != std::string::npos);
    CHECK(rounding.ends_with(" 9 modules"));
    CHECK(output.err.find(rounding) != std::string::npos);
  }
  const ProgramOutput coarse = print(gs1_survey(folder.path(), "tag-a4"), folder.path() / "coarse",
                                     "--tags 000L --format pdf --dpi 50");
  CHECK(coarse.exit_code == 2);
  for (const char* part : {"--dpi 50: ", "1.948 mm", "3.83"}) {
    CHECK_MESSAGE(coarse.err.find(part) != std::string::npos, coarse.err);
  }
}

TEST_CASE("adjusted bars prove where the frame will be, in one piece and in tiles") {
  const TemporaryFolder folder;
  for (const char* options :
       {"--bar-adjust -0.2", "--bar-adjust -0.1 --paper A4 --tile", "--bar-adjust 0.1 --dpi 300"}) {
    CAPTURE(options);
    const fs::path out = folder.path() / "out";
    const ProgramOutput output =
        print(kCorridor, out, std::string("--tags 000L --format pdf --proof ") + options);
    REQUIRE_MESSAGE(output.exit_code == 0, output.err);
    const json proof = manifest_in(out)["proof"][0];
    CHECK(std::abs(proof["length_error_mm"].get<double>()) < 0.1);
    const std::string text =
        run_shell("pdftotext -layout '" + (out / "000L.pdf").string() + "' -").out;
    const bool on_dots = std::string(options).find("--dpi") != std::string::npos;
    const char* inside = on_dots ? "inside 342.985 \u00d7 167.979 mm" : "inside 343 \u00d7 168 mm";
    CHECK_MESSAGE(text.find(inside) != std::string::npos, text);
    fs::remove_all(out);
  }
}

TEST_CASE("a proof that fails writes nothing and tells why") {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string survey = gs1_survey(folder.path(), "tag-a4");
  std::string hairline = read_file("templates/tag-a4.yaml").value();
  hairline.replace(hairline.find("stroke: 0.008"), 13, "stroke: 0.00005");
  REQUIRE(write_file(folder.path() / "tag-a4.yaml", hairline));
  const ProgramOutput output = print(survey, out, "--tags 000L --format pdf --proof");
  CHECK(output.exit_code == 1);
  CHECK(output.err.find("000L.pdf: ") != std::string::npos);
  CHECK_FALSE(fs::exists(out));
}

TEST_CASE("papers that cannot carry a plate, and options that make no sense, are refused") {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& options) {
    const ProgramOutput output = print(kCorridor, folder.path() / "out", options);
    CHECK(output.exit_code == 2);
    CHECK_FALSE(fs::exists(folder.path() / "out"));
    return output.err;
  };
  const std::string too_small = error("--paper A3");
  for (const char* part : {"400 x 300 mm", "A2, A1, A0", "332 mm", "--tile: 2 "}) {
    CHECK_MESSAGE(too_small.find(part) != std::string::npos, too_small);
  }
  CHECK(error("--tile").find("--paper A4") != std::string::npos);
  CHECK(error("--paper B17").find("A4, A3") != std::string::npos);
  const std::string no_pdf = error("--format png --single");
  CHECK(no_pdf.find("--single ") != std::string::npos);
  CHECK(no_pdf.find("--format ") != std::string::npos);
  CHECK(error("--bar-adjust -2").find(" 1.21 mm ") != std::string::npos);
  error("--dpi 3");
  error("--tags 000L --only x");
}

TEST_CASE("the installer's list declares its columns in the order asked for") {
  const TemporaryFolder folder;
  REQUIRE(
      print(kCorridor, folder.path(), "--tags 000R --format pdf --point-order PNEZD").exit_code ==
      0);
  const std::string csv = read_file(folder.path() / "setting-out.csv").value();
  CHECK(csv ==
        "tag,y,x,z,description,side,chainage,offset,height,tolerance,digits,survey\r\n"
        "000R,0.3430,0.0000,0.4000,corner P,right,0.3430,0.9500,0.4000,0.0050,000000340401,"
        "corridor\r\n");
  const ProgramOutput text =
      run_shell("pdftotext -layout '" + (folder.path() / "setting-out.pdf").string() + "' -");
  CHECK(text.out.find("negative = left of the drive") != std::string::npos);
  CHECK(text.out.find("Right wall, seen facing it") != std::string::npos);
}

TEST_CASE("the installer is told how a plate turns out of its wall") {
  const TemporaryFolder folder;
  REQUIRE(print("surveys/drift/survey.yaml", folder.path(), "--tags 001L,002L,900R --format pdf")
              .exit_code == 0);
  const ProgramOutput text =
      run_shell("pdftotext -layout -l 1 '" + (folder.path() / "setting-out.pdf").string() + "' -");
  CHECK(text.out.find("the plate of 002L leans 3 degrees forward") != std::string::npos);
  CHECK(text.out.find("the plate of 900R faces 240 degrees, from +y") != std::string::npos);
  CHECK(text.out.find("the plate of 001L") == std::string::npos);
}

TEST_CASE("diff tells what to do, and print --only prints what it asks for") {
  const TemporaryFolder folder;
  std::string text = read_file(kCorridor).value();
  text.replace(text.find("pairs: 8"), 8, "pairs: 7");
  text +=
      "placed:\n  - { tag: 002L, side: left, p: [1.9, 1.65, 0.4] }\n"
      "  - { tag: 003L, side: left, p: [1.9, 2.45, 0.4], digits: \"019002400400\" }\n";
  const fs::path survey = folder.path() / "new.yaml";
  REQUIRE(write_file(survey, text));
  const std::string surveys = std::string(kCorridor) + " '" + survey.string() + "'";
  const ProgramOutput words = run_tagsmith("diff " + surveys);
  CHECK(words.exit_code == 1);
  CHECK(words.out.find("reprint 002L  digits 019001600401 become 019001650406") == 0);
  CHECK(words.out.find("move    003L  by 50 mm") != std::string::npos);
  CHECK(words.out.find("remove  007R") != std::string::npos);
  for (const char* form : {"", "--json "}) {
    const ProgramOutput diff = run_tagsmith("diff " + std::string(form) + surveys);
    const fs::path list = folder.path() / "changes.txt";
    REQUIRE(write_file(list, "\xEF\xBB\xBF" + diff.out));  // as editors write it
    const fs::path out = folder.path() / "out";
    const ProgramOutput printed =
        print(survey.string(), out, "--format pdf --only '" + list.string() + "'");
    REQUIRE_MESSAGE(printed.exit_code == 0, printed.err);
    CHECK(manifest_in(out)["tags"].size() == 1);
    CHECK(fs::exists(out / "002L.pdf"));
    // Who hangs the new plate also moves the other.
    const std::string to_hang = read_file(out / "setting-out.csv").value();
    CHECK(std::ranges::count(to_hang, '\n') == 3);
    CHECK(to_hang.find("\n003L,1.9000,2.4500,") != std::string::npos);
    fs::remove_all(out);
    // The list asks for the new survey's plates.
    const ProgramOutput old = print(kCorridor, out, "--only '" + list.string() + "'");
    CHECK(old.exit_code == 2);
    CHECK_MESSAGE(old.err.find("changes.txt: the list is for revision") != std::string::npos,
                  old.err);
    CHECK(!fs::exists(out));
  }
  CHECK(run_tagsmith(std::string("diff ") + kCorridor + " " + kCorridor).exit_code == 0);
  REQUIRE(write_file(folder.path() / "bad.txt", "please print all\n"));
  const ProgramOutput bad = print(survey.string(), folder.path() / "out",
                                  "--only '" + (folder.path() / "bad.txt").string() + "'");
  CHECK(bad.exit_code == 2);
  CHECK(bad.err.find("bad.txt:1: `please print all`") != std::string::npos);
}

TEST_CASE("a list that only moves tags makes the setting-out list anew, and prints nothing") {
  const TemporaryFolder folder;
  const fs::path moved = folder.path() / "moved.yaml";
  REQUIRE(write_file(moved, read_file(kCorridor).value() +
                                "placed:\n  - { tag: 005L, side: left, p: [1.9, 4.003, 0.4], "
                                "digits: \"019004000408\" }\n"));
  const fs::path out = folder.path() / "out";
  const fs::path list = folder.path() / "changes.txt";
  REQUIRE(print(kCorridor, out, "--format pdf --tags 004L,005L").exit_code == 0);
  REQUIRE(
      write_file(list, run_tagsmith(fmt::format("diff {} '{}'", kCorridor, moved.string())).out));
  const ProgramOutput output =
      print(moved.string(), out, "--format pdf --only '" + list.string() + "'");
  CHECK(output.exit_code == 0);
  CHECK(output.err.find("setting-out lists alone are made") != std::string::npos);
  const std::string csv = read_file(out / "setting-out.csv").value();
  CHECK(csv.find("\n005L,1.9000,4.0030,") != std::string::npos);
  CHECK(csv.find("\n004L,") != std::string::npos);
  CHECK(manifest_in(out)["tags"].size() == 2);
  // On whatever paper the plates were printed.
  fs::remove_all(out);
  REQUIRE(print(kCorridor, out, "--format pdf --paper roll:1000 --tags 004L,005L").exit_code == 0);
  const json before = manifest_in(out);
  CHECK(print(moved.string(), out, "--only '" + list.string() + "'").exit_code == 0);
  CHECK(manifest_in(out)["tags"].size() == 2);
  CHECK(manifest_in(out)["page_mm"] == before["page_mm"]);
}

TEST_CASE("the setting-out list has all tags of the folder, those of earlier prints too") {
  const TemporaryFolder folder;
  REQUIRE(print(kCorridor, folder.path(), "--format pdf --tags 000L,001L").exit_code == 0);
  REQUIRE(print(kCorridor, folder.path(), "--format pdf --tags 001L,000R").exit_code == 0);
  CHECK(manifest_in(folder.path())["tags"].size() == 3);
  const std::string list = read_file(folder.path() / "setting-out.csv").value();
  CHECK(std::ranges::count(list, '\n') == 4);
  CHECK(run_tagsmith(fmt::format("verify {} '{}'", kCorridor, folder.path().string())).exit_code ==
        0);
}

TEST_CASE("a print into a folder warns of the plates of earlier prints that are no longer right") {
  const TemporaryFolder folder;
  const fs::path moved = folder.path() / "moved.yaml";
  REQUIRE(write_file(moved, read_file(kCorridor).value() +
                                "placed:\n  - { tag: 001L, side: left, p: [1.9, 0.9, 0.4] }\n"));
  const fs::path out = folder.path() / "out";
  // Plates 000L and 000R fill the first sheet, 001L and 001R the second.
  REQUIRE(print(kCorridor, out, "--format pdf --paper A1 --tags 000L,000R,001L,001R").exit_code ==
          0);
  const ProgramOutput again = print(moved.string(), out, "--format pdf --paper A1 --tags 001L");
  REQUIRE(again.exit_code == 0);
  CHECK_MESSAGE(again.err.find("has 000L 000R any more") != std::string::npos, again.err);
  CHECK_MESSAGE(again.err.find("sheet-002.pdf: an earlier print of tags that are printed again") !=
                    std::string::npos,
                again.err);
  const ProgramOutput other = print(moved.string(), out, "--format pdf --tags 002L");
  CHECK(other.err.find("sheet-001.pdf sheet-002.pdf: of an earlier print") != std::string::npos);
  // 001L hangs elsewhere now and is not printed again: no list says where its old plate belongs.
  fs::remove_all(out);
  REQUIRE(print(kCorridor, out, "--format pdf --tags 000L,001L").exit_code == 0);
  const ProgramOutput next = print(moved.string(), out, "--format pdf --tags 000R");
  CHECK_MESSAGE(next.err.find("001L.pdf: the survey has other digits") != std::string::npos,
                next.err);
  const std::string list = read_file(out / "setting-out.csv").value();
  CHECK(std::ranges::count(list, '\n') == 3);
  CHECK(list.find("001L") == std::string::npos);
}

TEST_CASE("a damaged manifest of an earlier print is taken for none") {
  const TemporaryFolder folder;
  REQUIRE(print(kCorridor, folder.path(), "--format pdf --tags 000L").exit_code == 0);
  const fs::path file = folder.path() / "manifest.json";
  const std::string manifest = read_file(file).value();
  for (const auto& [from, to] :
       {std::pair{"\"side\": \"left\"", "\"sides\": 1"}, std::pair{"\"digits\"", "\"digit\""},
        std::pair{"[\n        1.9,", "[\n        \"x\","},
        std::pair{"\"000L.pdf\"\n", "\"../000L.pdf\"\n"}}) {
    CAPTURE(to);
    std::string damaged = manifest;
    REQUIRE(damaged.find(from) != std::string::npos);
    damaged.replace(damaged.find(from), std::string_view(from).size(), to);
    REQUIRE(write_file(file, damaged));
    const ProgramOutput output = print(kCorridor, folder.path(), "--format pdf --tags 000R");
    CHECK_MESSAGE(output.exit_code == 0, output.err);
    CHECK(manifest_in(folder.path())["tags"].size() == 1);
  }
}

// The profile of a printer that scales pages so, and prints bars as they are drawn.
fs::path profile_in(const TemporaryFolder& folder, const std::string& scale) {
  fs::path profile = folder.path() / "printer.yaml";
  REQUIRE(write_file(profile, "printer: office\nscale: " + scale +
                                  "\nbar_growth_mm: [0, 0]\ndot_gain_percent: 0\n"));
  return profile;
}

TEST_CASE("a print for another printer leaves the files of the earlier one out of the manifest") {
  const TemporaryFolder folder;
  const fs::path profile = profile_in(folder, "[1.012, 1.005]");
  const fs::path out = folder.path() / "out";
  REQUIRE(print(kCorridor, out, "--format pdf --tags 000L --profile '" + profile.string() + "'")
              .exit_code == 0);
  const ProgramOutput other = print(kCorridor, out, "--format pdf --tags 000R");
  CHECK_MESSAGE(other.err.find("000L.pdf: of an earlier print") != std::string::npos, other.err);
  CHECK(manifest_in(out)["tags"].size() == 1);
}

// Black pixels of a PDF's first page.
double ink_on(const fs::path& pdf) {
  const std::string root = (pdf.parent_path() / "page").string();
  REQUIRE(run_shell(fmt::format("pdftoppm -r 100 -gray -singlefile '{}' '{}'", pdf.string(), root))
              .exit_code == 0);
  const std::string page = read_file(root + ".pgm").value();  // samples after "P5 WIDTH HEIGHT 255"
  double ink = 0;
  for (const char sample : page.substr(page.find("\n255\n") + 5)) {
    ink += 1 - static_cast<unsigned char>(sample) / 255.0;
  }
  return ink;
}

TEST_CASE("a printer that shrinks pages loses nothing at their edges") {
  const TemporaryFolder folder;
  const fs::path profile = profile_in(folder, "[0.98, 0.985]");
  // Plates as they fill a roll's length, a sheet, tiles and a page of their own.
  for (const char* paper : {"--paper roll:610", "--paper A1", "--paper A4 --tile", ""}) {
    CAPTURE(paper);
    const std::string options = fmt::format("--format pdf --tags 000L,000R,001L,001R {}", paper);
    const fs::path plain = folder.path() / "plain";
    const fs::path out = folder.path() / "shrunk";
    REQUIRE(print(kCorridor, plain, options).exit_code == 0);
    REQUIRE(print(kCorridor, out, options + " --profile '" + profile.string() + "'").exit_code ==
            0);
    CHECK(run_tagsmith(fmt::format("verify {} '{}'", kCorridor, out.string())).exit_code == 0);
    if (std::string_view(paper).ends_with("--tile")) continue;  // other tiles
    const std::string file = fs::exists(out / "sheet-001.pdf") ? "sheet-001.pdf" : "000L.pdf";
    CHECK(ink_on(out / file) * 0.98 * 0.985 ==
          doctest::Approx(ink_on(plain / file)).epsilon(0.005));  // texts are not scaled
    for (const fs::path& used : {plain, out}) fs::remove_all(used);
  }
}

TEST_CASE("a sign maker's PDF has trim, bleed and the cut contour as a spot colour") {
  const TemporaryFolder folder;
  const std::string survey = gs1_survey(folder.path(), "tag-a4");
  std::string tag = read_file("templates/tag-a4.yaml").value();
  tag += "cut: { contour: true, corner_radius_mm: 4 }\n";
  REQUIRE(write_file(folder.path() / "tag-a4.yaml", tag));
  const fs::path out = folder.path() / "out";
  REQUIRE(print(survey, out, "--tags 000L").exit_code == 0);
  const std::string plain = run_shell("qpdf --qdf --object-streams=disable '" +
                                      (out / "000L.pdf").string() + "' - | strings")
                                .out;
  for (const char* part : {"/TrimBox", "/BleedBox", "/Separation", "/CutContour CS 1 SCN",
                           "/PrintScaling /None", "survey corridor revision"}) {
    CHECK_MESSAGE(plain.find(part) != std::string::npos, part);
  }
  CHECK(plain.find("1 0 1 RG") == std::string::npos);
  CHECK(read_file(out / "000L.svg").value().find("id=\"CutContour\"") != std::string::npos);
}
