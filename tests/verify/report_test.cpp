// SPDX-License-Identifier: Apache-2.0
// Reports as their readers have them: the page in a browser, the document, the table.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/exif_jpeg.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kSurvey = "surveys/corridor/survey.yaml";

// One tag in order, one print that is too small, a photo of another tunnel, a broken file.
struct Verified {
  TemporaryFolder folder;
  std::string lines;

  fs::path path(const char* name) const { return folder.path() / name; }
  std::string quoted(const char* name) const { return "'" + path(name).string() + "'"; }

  Verified() {
    REQUIRE(write_file(path("broken.jpg"), "\xFF\xD8\xFF\xE0").has_value());
    const ProgramOutput output = run_tagsmith(
        "verify --json " + kSurvey +
        " surveys/corridor/photos/corridor_01_left.jpg surveys/corridor/photos/corridor_02_left.jpg"
        " surveys/curved/photos/curved_02_left.jpg " +
        quoted("broken.jpg") + " --crops " + quoted("crops"));
    REQUIRE(output.exit_code == 2);
    lines = output.out;
    REQUIRE(write_file(path("lines.jsonl"), lines).has_value());
  }
};

json last_line(const std::string& lines) {
  std::istringstream stream(lines);
  std::string last;
  for (std::string line; std::getline(stream, line);) last = line;
  return parsed_json(last);
}

}  // namespace

TEST_CASE("a report's page opens on a phone, filters by typing, and answers clicks and keys") {
  const Verified verified;
  const ProgramOutput output =
      run_tagsmith("report " + kSurvey + " " + verified.quoted("lines.jsonl") + " --html " +
                   verified.quoted("report.html"));
  REQUIRE(output.exit_code == 1);
  const PageVisit visit = visit_page(verified.path("report.html"), 390, 844, R"js(
const rows = kind => [...doc.querySelectorAll('[data-row=' + kind + ']')].filter(r => !r.hidden);
const type = text => {
  const field = doc.getElementById('filter');
  field.focus();
  field.value = text;
  field.dispatchEvent(new page.InputEvent('input', {bubbles: true}));
};
const key = (target, name) =>
  target.dispatchEvent(new page.KeyboardEvent('keydown', {key: name, bubbles: true}));
const seen = {};
seen.overflow = doc.documentElement.scrollWidth - doc.documentElement.clientWidth;
seen.faults = rows('fault').length;
seen.tags = rows('tag').length;
seen.crops = [...doc.querySelectorAll('.crop img')].map(i => i.complete && i.naturalWidth > 50);
seen.marks = doc.querySelectorAll('.map .tag.ok circle').length;
type('002l'); seen.typed = [rows('fault').length, rows('tag').map(r => r.textContent.slice(0, 4))];
type('not-in-survey curved_02'); seen.words = [rows('fault').length, rows('tag').length];
key(doc.body, 'Escape'); seen.cleared = rows('tag').length;
const button = doc.querySelector('[data-status=ok]');
button.click();
seen.pressed = [button.getAttribute('aria-pressed'), rows('tag').length, rows('fault').length];
button.click(); seen.released = rows('tag').length;
doc.querySelector('.map [data-tag="003R"]').dispatchEvent(
  new page.MouseEvent('click', {bubbles: true}));
seen.clicked = [doc.getElementById('filter').value, rows('tag').length];
key(doc.querySelector('.map [data-tag="001L"]'), 'Enter');
seen.entered = doc.getElementById('filter').value;
key(doc.body, 'Escape');
key(doc.body, '/'); seen.focused = doc.activeElement.id;
const crop = doc.querySelector('.crop');
crop.click(); seen.enlarged = crop.getAttribute('aria-expanded');
seen.status = doc.getElementById('shown').textContent;
return seen;
)js");
  CAPTURE(visit.result);
  const json seen = parsed_json(visit.result);
  CHECK(seen["overflow"] <= 0);
  CHECK(seen["faults"] == 2);
  CHECK(seen["tags"] == 16);
  CHECK(seen["crops"] == json::array({true}));
  CHECK(seen["marks"] == 2);
  CHECK(seen["typed"] == json::array({0, json::array({"002L"})}));
  CHECK(seen["words"] == json::array({1, 0}));
  CHECK(seen["cleared"] == 16);
  CHECK(seen["pressed"] == json::array({"true", 2, 0}));
  CHECK(seen["released"] == 16);
  CHECK(seen["clicked"] == json::array({"003R", 1}));
  CHECK(seen["entered"] == "001L");
  CHECK(seen["focused"] == "filter");
  CHECK(seen["enlarged"] == "true");
  CHECK(seen["status"] == "2 faults and 16 tags shown");
  CHECK_MESSAGE(visit.console.empty(), visit.console.front());
}

TEST_CASE("a page that breaks, or asks for something from elsewhere, is found out") {
  const TemporaryFolder folder;
  const auto visit = [&](const std::string& page) {
    REQUIRE(write_file(folder.path() / "p.html", page).has_value());
    return visit_page(folder.path() / "p.html", 390, 844, "return doc.title;");
  };
  CHECK(visit("<!doctype html><title>fine</title>").result == "\"fine\"");
  CHECK(visit("<!doctype html><title>fine</title>").console.empty());
  CHECK(!visit("<script>missing.thing()</script>").console.empty());
  CHECK(!visit("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\">"
               "<img src=\"http://example.org/a.png\">")
             .console.empty());
  CHECK_THROWS(visit_page(folder.path() / "p.html", 390, 844, "return missing.thing;"));
}

TEST_CASE("a file that is no output of verify is refused, a line cut short is not") {
  const TemporaryFolder folder;
  const std::string page = (folder.path() / "page.html").string();
  std::ofstream(page) << "<!doctype html>\n<p>a report</p>\n";
  const ProgramOutput refused = run_tagsmith("report " + kSurvey + " " + page);
  CHECK(refused.exit_code == 2);
  CHECK(refused.out.empty());
  CHECK_MESSAGE(refused.err.find("none of its 2 lines is of `verify --json`") != std::string::npos,
                refused.err);
  const ProgramOutput absent = run_tagsmith("report " + kSurvey + " " + page + "l");
  CHECK(absent.exit_code == 2);
  CHECK_MESSAGE(absent.err.find("page.htmll: no such file, did you mean") != std::string::npos,
                absent.err);
  const std::string cut = (folder.path() / "cut.jsonl").string();
  std::ofstream(cut) << R"({"file":"a.jpg","ta)";
  const ProgramOutput nothing = run_tagsmith("report " + kSurvey + " " + cut);
  CHECK(nothing.exit_code == 2);
  CHECK(nothing.err.find("has no whole line of `verify --json`") != std::string::npos);
  std::ofstream(cut) << R"({"file":"a.jpg","tags":[],"findings":[]})"
                     << "\n"
                     << R"({"file":"b.jpg","ta)";
  CHECK(run_tagsmith("report " + kSurvey + " " + cut).exit_code == 1);
}

TEST_CASE("lines of an earlier survey are judged by their codes against the present one") {
  const TemporaryFolder folder;
  const std::string lines = (folder.path() / "lines.jsonl").string();
  const std::string tag =
      R"({"digits":"019000000404","corners":[[9,9],[99,9],[99,59],[9,59]],"tag":"000L","status":")";
  for (const auto& [status, rule] : {std::pair("unknown", "not-in-survey"),
                                     {"doubtful", "contradiction"},
                                     {"misplaced", "misplaced"}}) {
    CAPTURE(std::string(status));
    std::ofstream(lines)
        << R"({"file":"a.jpg","survey":"corridor","revision":"000000000000","tags":[)" << tag
        << status << R"(","rule":")" << rule
        << R"(","message":"raise it by 40 mm"}],"findings":[]})"
        << "\n";
    const ProgramOutput report = run_tagsmith("report " + kSurvey + " " + lines);
    CHECK(report.out.find("raise it by 40 mm") == std::string::npos);
    CHECK_MESSAGE(report.out.find("0 faults") != std::string::npos, report.out);
  }
}

TEST_CASE("chainages of a long drive's map stand clear of its tags") {
  const Verified verified;
  REQUIRE(write_file(verified.path("long.yaml"), R"(survey: long
tunnel:
  width: 4.5
  height: 4
  centerline: { start: [0, 0, 0], heading: 15, elements: [ { line: 100 }, { arc: 80, turn: left, angle: 60 }, { line: 100 } ] }
tags: { template: tag-400x300, height: 1.5, spacing: 2.0, first: 1.0, to: 280 }
code: { check_digit: gs1, resolution: 0.1, digits: [4, 5, 2], origin: [-200, -10, -1] }
)")
              .has_value());
  REQUIRE(run_tagsmith("report " + verified.quoted("long.yaml") + " " +
                       verified.quoted("lines.jsonl") + " --html " + verified.quoted("long.html"))
              .exit_code == 1);
  const PageVisit visit = visit_page(verified.path("long.html"), 1400, 900, R"(
    const boxes = of => [...doc.querySelectorAll(of)].map(each => each.getBoundingClientRect());
    const words = boxes('.map svg > text');
    const tags = boxes('.tag circle');
    const over = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    return [words.length > 20, tags.length > 200,
            words.filter(word => tags.some(tag => over(word, tag))).length];)");
  CHECK(visit.result == "[true,true,0]");
}

TEST_CASE("a name that is markup is shown and does nothing") {
  const Verified verified;
  const json line{{"file", "<img src=x onerror=alert(1)>\".jpg"},
                  {"tags", json::array({{{"tag", "\"><script>bad()</script>"},
                                         {"status", "unreadable"},
                                         {"rule", "glare"},
                                         {"message", "</script><b>"}}})},
                  {"findings", json::array({"unreadable: </script><b>"})},
                  {"rules", json::array({"glare"})}};
  REQUIRE(write_file(verified.path("hostile.jsonl"), line.dump() + "\n").has_value());
  REQUIRE(run_tagsmith("report " + kSurvey + " " + verified.quoted("hostile.jsonl") + " --html " +
                       verified.quoted("hostile.html") + " --pdf " + verified.quoted("hostile.pdf"))
              .exit_code == 1);
  const PageVisit visit = visit_page(
      verified.path("hostile.html"), 390, 844,
      "return [doc.querySelectorAll('.card b, .card script, .card img').length, "
      "doc.querySelector('.card').textContent.includes('<img src=x onerror=alert(1)>')];");
  CHECK(visit.result == "[0,true]");
  CHECK(visit.console.empty());
}

TEST_CASE("the document has the summary, the map, the faults with pictures and the tags") {
  const Verified verified;
  REQUIRE(run_tagsmith("report " + kSurvey + " " + verified.quoted("lines.jsonl") + " --pdf " +
                       verified.quoted("report.pdf"))
              .exit_code == 1);
  const ProgramOutput text = run_shell("pdftotext " + verified.quoted("report.pdf") + " -");
  REQUIRE(text.exit_code == 0);
  for (const char* part : {"Verification of corridor", "2 of 16 tags seen", "not-in-survey",
                           "broken-file", "corridor_01_left", "Tags 000L to 007R", "unseen"}) {
    CAPTURE(part);
    const bool is_there = text.out.find(part) != std::string::npos;
    CHECK(is_there == (std::string(part) != "corridor_01_left"));  // nothing is wrong with that one
  }
  // A header of two lines, then a line an image.
  const ProgramOutput images = run_shell("pdfimages -list " + verified.quoted("report.pdf") +
                                         " | tail -n +3 | grep -c jpeg");
  CHECK(images.out == "1\n");
}

TEST_CASE("page and document say where tags hang, and what that relies on") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  const auto outputs = [&](const std::string& name) {
    return " --html " + at + "/" + name + ".html --pdf " + at + "/" + name + ".pdf";
  };
  const std::string rig = " --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  const ProgramOutput verified = run_tagsmith("verify --json " + kSurvey + rig + outputs("verify"));
  REQUIRE(verified.exit_code == 0);
  REQUIRE(write_file(folder.path() / "lines.jsonl", verified.out).has_value());
  REQUIRE(run_tagsmith("report " + kSurvey + " " + at + "/lines.jsonl" + rig + outputs("report"))
              .exit_code == 1);  // two tags are in no photo
  for (const std::string name : {"verify", "report"}) {
    CAPTURE(name);
    const std::string page = *read_file(folder.path() / (name + ".html"));
    const std::string document = run_shell("pdftotext " + at + "/" + name + ".pdf -").out;
    for (const std::string& text : {page, document}) {
      CHECK(text.find("no photo ties 00") != std::string::npos);
      CHECK(text.find("right edge out, ") != std::string::npos);
    }
  }
}

TEST_CASE("a photo in which no tag was read is shown in the report, small and upright") {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return folder.path() / name; };
  const auto quoted = [&](const char* name) { return " '" + path(name).string() + "'"; };
  GrayImage wall{1600, 1200, {}};
  for (int i = 0; i < 1600 * 1200; ++i) {
    wall.samples.push_back(static_cast<std::uint8_t>(i % 1600 / 8));
  }
  const std::string jpeg = encode_gray_image("a.jpg", wall.view()).value();
  REQUIRE(write_file(path("wall.jpg"), with_orientation(jpeg, 6)).has_value());
  const ProgramOutput direct =
      run_tagsmith("verify --json " + kSurvey + quoted("wall.jpg") + " --crops" + quoted("crops") +
                   " --html" + quoted("direct.html"));
  CHECK(direct.exit_code == 1);
  const json line = parsed_json(direct.out.substr(0, direct.out.find('\n')));
  CHECK(line["rules"] == json::array({"no-tag"}));
  const GrayImage shown = load_gray_image(line["picture"].get<std::string>()).value();
  CHECK(std::pair(shown.width, shown.height) == std::pair(300, 400));
  CHECK(shown.view().at(5, 5) < shown.view().at(5, 390));  // the left of what was stored is the top

  const auto page = [&](const std::string& lines) {
    REQUIRE(write_file(path("lines.jsonl"), lines).has_value());
    CHECK(run_tagsmith("report " + kSurvey + quoted("lines.jsonl") + " --html" + quoted("r.html") +
                       " --pdf" + quoted("r.pdf"))
              .exit_code == 1);
    return *read_file(path("r.html"));
  };
  const std::string from_crop = page(direct.out);
  CHECK(from_crop == *read_file(path("direct.html")));
  CHECK(from_crop.find("data:image/jpeg") != std::string::npos);
  CHECK(run_shell("pdfimages -list" + quoted("r.pdf") + " | grep -c jpeg").out == "1\n");
  fs::remove_all(path("crops"));
  CHECK(page(direct.out) == from_crop);  // from the photo itself
  fs::remove(path("wall.jpg"));
  const std::string without = page(direct.out);
  CHECK(without.find("data:image/jpeg") == std::string::npos);
  CHECK(without.find("No picture: the photo is not where the line says.") != std::string::npos);
}

TEST_CASE("verify writes the same report as report does of its lines") {
  const Verified verified;
  const std::string files =
      " surveys/corridor/photos/corridor_01_left.jpg surveys/curved/photos/curved_02_left.jpg";
  const ProgramOutput direct =
      run_tagsmith("verify --json " + kSurvey + files + " --crops " + verified.quoted("crops") +
                   " --html " + verified.quoted("a.html") + " --csv " + verified.quoted("a.csv") +
                   " --pdf " + verified.quoted("a.pdf"));
  CHECK(direct.exit_code == 1);
  REQUIRE(write_file(verified.path("a.jsonl"), direct.out).has_value());
  CHECK(run_tagsmith("report " + kSurvey + " " + verified.quoted("a.jsonl") + " --html " +
                     verified.quoted("b.html") + " --csv " + verified.quoted("b.csv") + " --pdf " +
                     verified.quoted("b.pdf"))
            .exit_code == 1);
  CHECK(*read_file(verified.path("a.html")) == *read_file(verified.path("b.html")));
  CHECK(*read_file(verified.path("a.csv")) == *read_file(verified.path("b.csv")));
  CHECK(fs::exists(verified.path("b.pdf")));
}

TEST_CASE("the summary says what the photos cover, of which wall, how often and how well") {
  const ProgramOutput output =
      run_tagsmith("verify --json " + kSurvey + " surveys/corridor/photos");
  const json summary = last_line(output.out)["summary"];
  CHECK(summary["placement"] == "not_checked");
  const json covered = summary["completeness"];
  CHECK(covered["placement_checked"] == 0);
  CHECK(covered["placement_unchecked"].size() == 14);
  CHECK(covered["by_tag"][0]["placement"] == "unchecked");
  CHECK(covered["tags"] == 16);
  CHECK(covered["seen"] == 14);
  CHECK(covered["share"] == 0.875);
  CHECK(covered["left"] == json{{"tags", 8}, {"seen", 7}});
  REQUIRE(covered["unseen"].size() == 2);
  CHECK(covered["unseen"][0]["side"] == "left");
  CHECK(covered["unseen"][0]["tags"] == json::array({"004L"}));
  CHECK(covered["unseen"][1]["tags"] == json::array({"004R"}));
  REQUIRE(covered["by_tag"].size() == 16);
  const json first = covered["by_tag"][0];
  CHECK(first["tag"] == "000L");
  CHECK(first["status"] == "ok");
  CHECK(first["seen"] == 1);
  CHECK(first["best_grade"] >= first["worst_grade"]);
  CHECK(covered["by_tag"][8]["status"] == "unseen");
  CHECK(covered["by_tag"][8]["best_grade"].is_null());
}

}  // namespace tagsmith::detail::test
