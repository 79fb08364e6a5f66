// SPDX-License-Identifier: Apache-2.0
// Keeps the walls of docs/architecture.md, and proves on made-up files that the check can fail.
#include "tests/house/house.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

namespace tagsmith::detail::house {
namespace {

using test::contents;

const std::string kSpdx = "// SPDX-License-Identifier: Apache-2.0\n";

// Every C++ source of the project, relative to its root.
std::vector<std::string> project_sources() {
  std::vector<std::string> files{"main.cpp"};
  for (const char* folder : {"tagsmith", "decoder", "tests", "docs"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".cpp" || extension == ".hpp") files.push_back(entry.path().string());
    }
  }
  std::ranges::sort(files);
  return files;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

struct Case {
  const char* name;
  const char* file;
  std::string text;
  const char* expected;  // part of the one violation; empty = none
};

void check_cases(const std::vector<Case>& cases) {
  for (const Case& one : cases) {
    CAPTURE(one.name);
    const std::vector<std::string> violations = check_source(one.file, kSpdx + one.text);
    if (one.expected[0] == '\0') {
      CHECK_MESSAGE(violations.empty(), joined(violations));
    } else {
      REQUIRE(violations.size() == 1);
      CHECK_MESSAGE(violations[0].find(one.expected) != std::string::npos, violations[0]);
    }
  }
}

}  // namespace

TEST_CASE("every source keeps the layers, the third-party walls and the house rules") {
  const std::vector<std::string> files = project_sources();
  REQUIRE(files.size() > 40);  // an empty list would pass unseen
  std::vector<std::string> violations;
  for (const std::string& file : files) {
    std::ranges::copy(check_source(file, contents(file)), std::back_inserter(violations));
  }
  CHECK_MESSAGE(violations.empty(), joined(violations));
}

TEST_CASE("no files include each other in a ring") {
  CHECK(include_rings({{"decoder/scan/a.hpp", "#include \"decoder/scan/b.hpp\"\n"},
                       {"decoder/scan/b.hpp", "#pragma once\n"},
                       {"decoder/scan/b.cpp", "#include \"decoder/scan/b.hpp\"\n"}})
            .empty());
  CHECK(include_rings({{"decoder/scan/a.hpp", "#include \"decoder/scan/b.hpp\"\n"},
                       {"decoder/scan/b.hpp", "#pragma once\n"},
                       {"decoder/scan/b.cpp", "#include \"decoder/scan/a.hpp\"\n"},
                       {"decoder/scan/c.hpp", "#include \"decoder/scan/a.hpp\"\n"}}) ==
        std::vector<std::string>{"decoder/scan/a", "decoder/scan/b"});
  std::map<std::string, std::string> sources;
  for (const std::string& file : project_sources()) {
    if (!layer_of(file).empty()) sources[file] = contents(file);
  }
  REQUIRE(sources.size() > 40);
  const std::vector<std::string> rings = include_rings(sources);
  CHECK_MESSAGE(rings.empty(), joined(rings));
}

TEST_CASE("every source file is built by its folder's CMakeLists.txt") {
  std::map<fs::path, std::vector<std::string>> by_folder;
  for (const std::string& file : project_sources()) {
    const fs::path path(file);
    if (path.extension() == ".cpp") by_folder[path.parent_path()].push_back(path.filename());
  }
  by_folder.erase("tests/support");  // listed in tests/CMakeLists.txt
  by_folder.erase("docs/examples");  // built by tests/examples
  for (const auto& entry : by_folder) {
    const fs::path& folder = entry.first;
    const std::string list = contents(folder / "CMakeLists.txt");
    const std::vector<std::string> unlisted = unlisted_sources(list, entry.second);
    CHECK_MESSAGE(unlisted.empty(), folder.string() << "/CMakeLists.txt does not list:\n"
                                                    << joined(unlisted));
  }
}

// What a stage of the reader does is tested with inputs made for it, not by whole pictures alone.
TEST_CASE("every header of the reader's stages is included by a test of these") {
  const std::string stages[] = {"scan", "feature_frame", "reader"};
  std::string tests;
  for (const std::string& stage : stages) {
    for (const fs::directory_entry& entry : fs::directory_iterator("tests/" + stage)) {
      if (entry.path().extension() == ".cpp") tests += contents(entry.path());
    }
  }
  std::size_t headers = 0;
  for (const std::string& stage : stages) {
    for (const fs::directory_entry& entry : fs::directory_iterator("decoder/" + stage)) {
      const bool is_data = entry.path().filename() == "tuning.hpp";  // counted below
      if (entry.path().extension() != ".hpp" || is_data) continue;
      ++headers;
      const std::string header = entry.path().string();
      CHECK_MESSAGE(tests.find("#include \"" + header + "\"") != std::string::npos,
                    "no test of its module includes " << header);
    }
  }
  CHECK(headers > 40);
}

// Two types of one name in one namespace break the program without a word from the linker.
TEST_CASE("no two headers define a type of one name") {
  std::map<std::string, std::string> defined_in;
  for (const std::string& file : project_sources()) {
    if (layer_of(file).empty() || !file.ends_with(".hpp")) continue;
    for (std::string type : types_defined(contents(file))) {
      if (is_public(file)) type = "tagsmith::" + type;  // all others are in tagsmith::detail
      const auto entry = defined_in.emplace(type, file);
      const std::string& first = entry.first->second;
      CHECK_MESSAGE(entry.second, type << " is defined in " << first << " and " << file);
    }
  }
  CHECK(defined_in.size() > 30);
}

// Sources of a module may be compiled as one, in which such a constant hides the header's.
TEST_CASE("no source defines a constant that has the name of a header's") {
  CHECK(constants_defined("constexpr double kLeast = 2;\n"
                          "inline constexpr std::array<int, 2> kSides{1, 2};\n"
                          "const char* const kNames[] = {};\n"
                          "  constexpr double kInFunction = 1;\n") ==
        std::vector<std::string>{"kLeast", "kSides", "kNames"});
  std::map<std::string, std::string> of_headers;
  for (const std::string& file : project_sources()) {
    if (layer_of(file).empty() || !file.ends_with(".hpp")) continue;
    for (const std::string& name : constants_defined(contents(file))) of_headers[name] = file;
  }
  CHECK(of_headers.size() > 30);
  for (const std::string& file : project_sources()) {
    if (layer_of(file).empty() || !file.ends_with(".cpp")) continue;
    for (const std::string& name : constants_defined(contents(file))) {
      CHECK_MESSAGE(!of_headers.contains(name),
                    file << " defines " << name << " of " << of_headers[name]);
    }
  }
}

TEST_CASE("values of tuning and named constants are counted") {
  CHECK(count_tuned_values("struct FitTuning {\n"
                           "  double least = 2;  // of a = b\n"
                           "  float dark = 0.6F, bright = 0.4F;\n"
                           "  std::array<double, 2> sigmas{1, 2};\n"
                           "};\n"
                           "struct Fit {\n"
                           "  double cost = 0;\n"
                           "};\n") == 4);
  CHECK(count_named_constants("constexpr double kLeast = 2;\n"
                              "  static constexpr std::array<int, 2> kSides{1, 2};\n"
                              "const double least = kLeast;\n"
                              "inline constexpr FitTuning kFit;\n") == 2);
}

// A new threshold takes the place of an old one, or is worth raising these.
TEST_CASE("the reader has no more thresholds than it needs, all of them in structs of tuning") {
  constexpr std::size_t kMostTuned = 150;
  constexpr std::size_t kMostNamed = 160;  // sizes of formats and arrays, bounds of arithmetic
  std::size_t tuned = 0, named = 0;
  for (const std::string& file : project_sources()) {
    const std::string layer = layer_of(file);
    if (layer != "decoder/feature_frame" && layer != "decoder/scan" && layer != "decoder/reader") {
      continue;
    }
    const std::string text = contents(file);
    tuned += count_tuned_values(text);
    named += count_named_constants(text);
  }
  MESSAGE(tuned << " values of tuning, " << named << " other constants");
  CHECK(tuned > 0);
  const std::string remedy =
      " in decoder/feature_frame, scan and reader: let it take the place of another, or raise the "
      "limit in this test with a reason";
  CHECK_MESSAGE(tuned <= kMostTuned, tuned << " values of tuning, limit " << kMostTuned << remedy);
  CHECK_MESSAGE(named <= kMostNamed, named << " other constants, limit " << kMostNamed << remedy);
}

TEST_CASE("the top of the project holds exactly the folders of the house") {
  std::set<std::string> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(".")) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && name[0] != '.' && name != "build" && name != "out") {
      found.insert(name);
    }
  }
  const std::set<std::string> allowed(top_folders().begin(), top_folders().end());
  CHECK(found == allowed);
}

TEST_CASE("docs/architecture.md lists the layers in the order that is kept here") {
  const std::string text = contents("docs/architecture.md");
  std::size_t place = 0;
  for (const std::string_view layer : layers()) {
    const std::size_t next = text.find("\n" + std::string(layer), place);
    CHECK_MESSAGE(next != std::string::npos,
                  "after the layer before it in kLayers of tests/house/house.cpp, "
                  "docs/architecture.md has no line that begins with "
                      << layer);
    if (next != std::string::npos) place = next;
  }
}

TEST_CASE("every decision record has its three parts, in this order") {
  int records = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator("docs/decisions")) {
    const std::string text = contents(entry.path());
    CAPTURE(entry.path().string());
    std::size_t place = 0;
    for (const std::string part : {"Situation", "Decision", "Consequences"}) {
      place = text.find("\n\n**" + part + ".**", place);
      REQUIRE_MESSAGE(place != std::string::npos,
                      "no paragraph begins with **" << part << ".** where it should");
    }
    ++records;
  }
  CHECK(records > 10);
}

TEST_CASE("every decision record that is cited exists, and each is cited in code") {
  const fs::path folder = "docs/decisions";
  std::set<std::string> cited_in_code;
  std::vector<std::string> code = project_sources();
  std::erase_if(code, [](const std::string& file) { return file.starts_with("tests/"); });
  code.emplace_back("CMakeLists.txt");
  for (const std::string& file : code) {
    for (const std::string& record : cited_decisions(contents(file))) {
      CHECK_MESSAGE(fs::exists(folder / record), file << " cites " << record);
      cited_in_code.insert(record);
    }
  }
  for (const fs::directory_entry& entry : fs::directory_iterator("docs")) {
    if (entry.path().extension() != ".md") continue;
    for (const std::string& record : cited_decisions(contents(entry.path()))) {
      CHECK_MESSAGE(fs::exists(folder / record), entry.path().string() << " cites " << record);
    }
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string record = entry.path().filename().string();
    CHECK_MESSAGE(cited_in_code.contains(record), "no code cites " << record);
  }
}

TEST_CASE("an include that breaks a wall between layers is found") {
  check_cases({
      {"a lower layer", "tagsmith/tag/a.cpp", "#include \"tagsmith/survey/survey.hpp\"\n",
       "tagsmith/tag/a.cpp:2: includes tagsmith/survey/survey.hpp: tagsmith/survey stands below; "
       "allowed: tagsmith/base tagsmith/geometry tagsmith/symbology tagsmith/tag"},
      {"a higher layer", "tagsmith/survey/a.cpp", "#include \"tagsmith/tag/template.hpp\"\n", ""},
      {"the same layer", "decoder/scan/a.cpp", "#include \"decoder/scan/profile.hpp\"\n", ""},
      {"tagsmith uses the decoder", "tagsmith/cli/a.cpp", "#include \"decoder/image/gray.hpp\"\n",
       "decoder/image stands below"},
      {"a test header in a library", "tagsmith/tag/a.cpp", "#include \"tests/support/x.hpp\"\n",
       "not a folder of the house"},
      {"a relative include", "tests/tag/a.cpp", "#include \"helper.hpp\"\n",
       "include paths start at the project's root"},
      {"a folder whose name begins alike", "tagsmith/tag/a.cpp", "#include \"tagsmith/tagged/x\"\n",
       "not a folder of the house"},
  });
}

TEST_CASE("a third-party header outside its folder is found") {
  check_cases({
      {"yaml-cpp where it belongs", "tagsmith/survey/a.cpp", "#include <yaml-cpp/yaml.h>\n", ""},
      {"yaml-cpp in a header", "tagsmith/survey/a.hpp",
       "#pragma once\n#include <yaml-cpp/yaml.h>\n",
       "a.hpp:3: includes yaml-cpp/yaml.h: yaml-cpp is allowed only in .cpp files"},
      {"yaml-cpp elsewhere", "tagsmith/cli/a.cpp", "#include <yaml-cpp/yaml.h>\n",
       "yaml-cpp is allowed only in tagsmith/survey"},
      {"Cairo elsewhere", "tagsmith/tag/a.cpp", "#include <cairo.h>\n", "Cairo, Pango is allowed"},
      {"Cairo's folder form", "decoder/simulate/a.cpp", "#include <cairo/cairo.h>\n",
       "Cairo, Pango is allowed"},
      {"Pango elsewhere", "tagsmith/cli/a.cpp", "#include <pango/pangocairo.h>\n",
       "Cairo, Pango is allowed"},
      {"zlib elsewhere", "tagsmith/cli/a.cpp", "#include <zlib.h>\n", "zlib is allowed"},
      {"CLI11 in a library", "decoder/verify/a.cpp", "#include <CLI/CLI.hpp>\n",
       "CLI11 is allowed"},
      {"OpenCV in tagsmith", "tagsmith/render/a.cpp", "#include <opencv2/core.hpp>\n",
       "OpenCV is allowed only in decoder/"},
      {"OpenCV in the scan", "decoder/scan/a.cpp", "#include <opencv2/core.hpp>\n",
       "OpenCV is allowed only in decoder/"},
      {"OpenCV where it belongs", "decoder/image/a.cpp", "#include <opencv2/imgproc.hpp>\n", ""},
      {"OpenCV's umbrella header", "decoder/image/a.cpp", "#include <opencv2/opencv.hpp>\n",
       "not in the house's list"},
      {"OpenCV's windows", "decoder/image/a.cpp", "#include <opencv2/highgui.hpp>\n",
       "not in the house's list"},
      {"a library nobody agreed on", "tagsmith/base/a.cpp", "#include <boost/any.hpp>\n",
       "not in the house's list"},
      {"Eigen in the symbology", "tagsmith/symbology/a.cpp", "#include <Eigen/Core>\n",
       "Eigen is allowed only"},
      {"fmt in the symbology", "tagsmith/symbology/a.cpp", "#include <fmt/core.h>\n",
       "fmt is allowed only"},
      {"system calls in the scan", "decoder/scan/a.cpp", "#include <unistd.h>\n",
       "system headers are allowed only"},
      {"the standard library", "decoder/scan/a.cpp", "#include <vector>\n", ""},
      {"the public interface in its module", "decoder/api/a.cpp", "#include <tagsmith/read.hpp>\n",
       ""},
      {"the public interface below it", "decoder/reader/a.cpp", "#include <tagsmith/read.hpp>\n",
       "the public interface is allowed only in decoder/(api|python)"},
      {"a public header over another", "decoder/api/include/tagsmith/a.hpp",
       "#pragma once\n#include <tagsmith/read.hpp>\n#include <vector>\n", ""},
      {"a public header over a module", "decoder/api/include/tagsmith/a.hpp",
       "#pragma once\n#include \"tagsmith/base/text.hpp\"\n",
       "a public header includes <tagsmith/...> and the standard library"},
      {"Eigen in a public header", "decoder/api/include/tagsmith/a.hpp",
       "#pragma once\n#include <Eigen/Core>\n",
       "a public header includes <tagsmith/...> and the standard library"},
      {"Python over the public interface", "decoder/python/a.cpp",
       "#include <tagsmith/read.hpp>\n#include <pybind11/pybind11.h>\n", ""},
      {"Python over a module", "decoder/python/a.cpp", "#include \"decoder/reader/reader.hpp\"\n",
       "the public interface alone"},
      {"an include with blanks", "tagsmith/tag/a.cpp", "  #  include  <CLI/CLI.hpp>\n",
       "CLI11 is allowed"},
  });
}

TEST_CASE("a line or a file against the rules of the house is found") {
  check_cases({
      {"a library that prints", "decoder/scan/a.cpp", "void f() { std::cout << 1; }\n",
       "libraries neither print"},
      {"a library that exits", "decoder/scan/a.cpp", "void f() { std::exit(1); }\n",
       "libraries neither print"},
      {"a command that prints past the console", "decoder/cli/a.cpp",
       "void f() { fmt::print(stderr, \"x\"); }\n", "show text by tagsmith/cli/console.hpp"},
      {"a word about printing", "decoder/scan/a.cpp", "// not std::cout\n", ""},
      {"a command that prints", "decoder/cli/a.cpp", "void f() { to_stdout(\"\"); }\n", ""},
      {"a command that parses by itself", "tagsmith/cli/a.cpp", "CLI::App app;\n",
       "options are data"},
      {"the parser", "tagsmith/cli/parse_command.cpp", "CLI::App app;\n", ""},
      {"unfinished work", "decoder/scan/a.cpp", std::string("// TO") + "DO: later\n",
       "a.cpp:2: unfinished work"},
      {"no include guard", "decoder/scan/a.hpp", "int f();\n", "a header needs #pragma once"},
      {"a folder of its own", "helpers/a.cpp", "int a;\n", "lies in no folder of the house"},
  });
}

TEST_CASE("the decision records that a text cites are found") {
  const std::vector<std::string> expected{"0016-printing.md", "decision 31", "Decision record 7"};
  CHECK(cited_decisions("// Why: docs/decisions/0016-printing.md.\n(decision 31) Decision record 7 "
                        "a decision of 5 m; docs/decisions") == expected);
}

TEST_CASE("the types of a header are found") {
  const char* const header =
      "struct A {\nenum class B { x, y };\nclass C final : public D {\nstruct E;\n  struct F {\n"
      "class TAGSMITH_EXPORT G {\n";
  CHECK(types_defined(header) == std::vector<std::string>{"A", "B", "C", "G"});
}

TEST_CASE("a missing SPDX line is found") {
  CHECK(check_source("main.cpp", "int main() {}\n").size() == 1);
  CHECK(check_source("main.cpp", "").size() == 1);
}

TEST_CASE("a source that no CMakeLists.txt names is found") {
  const std::vector<std::string> sources{"code.cpp", "position_code.cpp", "a.cpp"};
  const std::string list = "tagsmith_module(x SOURCES position_code.cpp a.cpp)\n";
  CHECK(unlisted_sources(list, sources) == std::vector<std::string>{"code.cpp"});
}

// Without programs on the PATH no command goes further than to look for the packages it needs.
TEST_CASE("every command that ./dev help lists is one") {
  const test::ProgramOutput help = test::run_shell("./dev help");
  CHECK(help.exit_code == 0);
  const std::regex entry("\n  ([a-z]+) ");
  int commands = 0;
  for (std::sregex_iterator match(help.out.begin(), help.out.end(), entry), end; match != end;
       ++match, ++commands) {
    const std::string command = (*match)[1];
    CAPTURE(command);
    const test::ProgramOutput output =
        test::run_shell("PATH=/nowhere /bin/bash ./dev " + command + " 2>&1");
    CHECK_MESSAGE(output.out.find("no command") == std::string::npos, output.out);
  }
  CHECK(commands >= 10);
  CHECK(test::run_shell("./dev nothing").exit_code == 2);
}

}  // namespace tagsmith::detail::house
