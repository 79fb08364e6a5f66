// SPDX-License-Identifier: Apache-2.0
// What is installed serves others: programs that link the libraries by CMake and by pkg-config, and
// the program itself from any folder.
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;

// The project as installed into a folder of its own, once for all tests. Its corridor names a
// template that is nowhere else, so that nothing can be found in the source tree instead.
const fs::path& prefix() {
  static const TemporaryFolder folder;
  static const ProgramOutput installed = [] {
    const std::string install = std::string(CMAKE_PROGRAM) +
                                " --install " BUILD_FOLDER " --prefix " + folder.path().string() +
                                " --component ";
    const std::string own_template =
        "cd " + folder.path().string() +
        "/share/tagsmith && cp templates/tag-400x300.yaml templates/tag-here.yaml && "
        "sed -i 's/tag-400x300/tag-here/' surveys/corridor/survey.yaml";
    return run_shell(install + "runtime && " + install + "development && " + own_template);
  }();
  REQUIRE_MESSAGE(installed.exit_code == 0, installed.out << installed.err);
  return folder.path();
}

// Runs a command with nothing of the build in its environment but the prefix.
ProgramOutput run_installed(const std::string& command) {
  return run_shell("cd / && unset TAGSMITH_DATA LD_LIBRARY_PATH; P=" + prefix().string() + "; " +
                   command);
}

std::string text_of(const ProgramOutput& output) {
  return "exit " + std::to_string(output.exit_code) + "\n" + output.out + output.err;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The libraries that a file of the prefix needs, and its search path.
std::string dynamic_section(const std::string& file) {
  const ProgramOutput output = run_installed("readelf -d $P/" + file);
  REQUIRE(output.exit_code == 0);
  return output.out;
}

// What both programs of tests/library/consumer must say.
void check_programs(const std::string& folder) {
  const ProgramOutput in_memory = run_installed(folder + "/in_memory");
  CHECK_MESSAGE(in_memory.exit_code == 0, text_of(in_memory));
  const ProgramOutput output = run_installed(
      folder + "/from_files $P/share/tagsmith/surveys/corridor " + folder + "/tag.pdf");
  CHECK_MESSAGE(output.exit_code == 0, text_of(output));
  CHECK_MESSAGE(has(output.out, "findings 0\n"), output.out);
  CHECK_MESSAGE(has(output.out, "tag 019000000404 000L of corridor\n"), output.out);
  CHECK_MESSAGE(std::regex_search(output.out, std::regex("fix (1|0\\.999\\d*|1\\.000\\d*) "
                                                         "-0\\.(5|499|500)\\d* "
                                                         "0\\.(24|239|240)\\d* 000L 000R 001R \n")),
                output.out);
  CHECK_MESSAGE(has(output.out, "\nok 000L\nok 000L\n"), output.out);
  CHECK_MESSAGE(has(output.out, "printed 019000000404\n"), text_of(output));
  CHECK_MESSAGE(has(output.out, "file_missing: "), output.out);
  CHECK_MESSAGE(has(output.out, "invalid_file: "), output.out);
}

void check_by_cmake(const std::string& compiler) {
  const TemporaryFolder build;
  const std::string folder = build.path().string();
  const std::string source = fs::absolute("tests/library/consumer").string();
  const ProgramOutput built =
      run_installed(std::string(CMAKE_PROGRAM) + " -S " + source + " -B " + folder +
                    " -G Ninja -DCMAKE_CXX_COMPILER=" + compiler + " -DCMAKE_PREFIX_PATH=$P && " +
                    CMAKE_PROGRAM + " --build " + folder + " --parallel 2");
  REQUIRE_MESSAGE(built.exit_code == 0, text_of(built));
  check_programs(folder);
}

}  // namespace

TEST_CASE("a project that finds the package builds with g++ and does what it should") {
  check_by_cmake("g++");
}

TEST_CASE("so it does with clang++") {
  if (!has_program("clang++")) return;
  check_by_cmake("clang++");
}

TEST_CASE("a program that is compiled with the flags of pkg-config does what it should") {
  const TemporaryFolder build;
  const std::string folder = build.path().string();
  const std::string source = fs::absolute("tests/library/consumer").string();
  const auto compile = [&](const std::string& name, const std::string& package) {
    return "g++ -std=c++17 " + source + "/" + name + ".cpp -o " + folder + "/" + name +
           " $(pkg-config --cflags --libs " + package + ") -Wl,-rpath,$P/lib";
  };
  const ProgramOutput built = run_installed("export PKG_CONFIG_PATH=$P/lib/pkgconfig && " +
                                            compile("in_memory", "tagsmith-core") + " && " +
                                            compile("from_files", "tagsmith-files"));
  REQUIRE_MESSAGE(built.exit_code == 0, text_of(built));
  check_programs(folder);
}

TEST_CASE("the program in docs/library.md compiles and locates") {
  const TemporaryFolder build;
  const std::string folder = build.path().string();
  const std::string page = fs::absolute("docs/library.md").string();
  const ProgramOutput output =
      run_installed("sed -n '/^```cpp$/,/^```$/p' " + page + " | grep -v '^```' > " + folder +
                    "/program.cpp && export PKG_CONFIG_PATH=$P/lib/pkgconfig && g++ -std=c++17 " +
                    folder + "/program.cpp -o " + folder +
                    "/program $(pkg-config --cflags --libs tagsmith-files) "
                    "-Wl,-rpath,$P/lib && cd $P/share/tagsmith && " +
                    folder + "/program");
  CHECK_MESSAGE(output.exit_code == 0, text_of(output));
  CHECK_MESSAGE(has(output.out, "000L at pixel "), text_of(output));
  CHECK_MESSAGE(!has(output.out, "no position"), text_of(output));
}

TEST_CASE("a component that there is not is told, and so is another major version") {
  const TemporaryFolder project;
  const auto configured = [&](const std::string& request) {
    const std::string folder = project.path().string();
    return run_installed(
        "printf 'cmake_minimum_required(VERSION 3.25)\\nproject(p CXX)\\n"
        "find_package(tagsmith " +
        request + ")\\n' > " + folder + "/CMakeLists.txt && " + CMAKE_PROGRAM + " -G Ninja -S " +
        folder + " -B " + folder + "/b -DCMAKE_PREFIX_PATH=$P");
  };
  CHECK(configured("1 REQUIRED CONFIG").exit_code == 0);
  CHECK(configured("1 REQUIRED CONFIG COMPONENTS core").exit_code == 0);
  CHECK(has(configured("1 REQUIRED CONFIG COMPONENTS gui").err, "gui"));
  CHECK(has(configured("2 REQUIRED CONFIG").err, "version: 1."));
}

TEST_CASE("the core library needs no pictures' decoders, no YAML, no Cairo and no command line") {
  const std::string core = dynamic_section("lib/libtagsmith_core.so");
  for (const char* library : {"opencv", "yaml", "cairo", "pango", "CLI", "jpeg", "png", "crypto"}) {
    CHECK_MESSAGE(!has(core, std::string("[lib") + library), core);
  }
  CHECK_MESSAGE(has(core, "[libtagsmith_core.so.1]"), core);
  CHECK(has(dynamic_section("lib/libtagsmith_files.so"), "[libtagsmith_core.so.1]"));
}

TEST_CASE("what is installed finds its parts relative to itself") {
  CHECK(has(dynamic_section("bin/tagsmith"),
            "(RUNPATH)            Library runpath: "
            "[$ORIGIN/../lib/tagsmith]"));
  for (const char* library : {"lib/libtagsmith_core.so", "lib/libtagsmith_files.so"}) {
    CHECK(has(dynamic_section(library), "Library runpath: [$ORIGIN:$ORIGIN/tagsmith]"));
  }
}

// The list is the binary interface of the major version: a line may be added, none may go.
TEST_CASE("the libraries export what tests/library/exports.txt lists and nothing else") {
  const ProgramOutput output = run_installed(
      "for L in core files; do nm -DC --defined-only $P/lib/libtagsmith_$L.so | "
      "sed -E \"s/^[0-9a-f]+ [A-Za-z] /$L /\"; done | LC_ALL=C sort -u");
  REQUIRE(output.exit_code == 0);
  CHECK_FALSE(has(output.out, "detail"));
  CHECK(output.out == contents("tests/library/exports.txt"));
}

TEST_CASE("the public headers include the standard library and each other alone") {
  const ProgramOutput output = run_installed(
      "grep -h '#include' $P/include/tagsmith/*.hpp | grep -v '#include <[a-z_]*>$' | sort -u");
  std::istringstream lines(output.out);
  for (std::string line; std::getline(lines, line);) {
    CHECK_MESSAGE(std::regex_match(line, std::regex("#include <tagsmith/[a-z]+\\.hpp>")), line);
  }
  CHECK_FALSE(has(run_installed("cat $P/lib/cmake/tagsmith/*.cmake").out, "-W"));
}

TEST_CASE("each public header stands by itself") {
  for (const fs::directory_entry& header : fs::directory_iterator(prefix() / "include/tagsmith")) {
    const ProgramOutput output = run_installed(
        "g++ -std=c++17 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I$P/include "
        "-include " +
        header.path().string() + " -x c++ /dev/null");
    CHECK_MESSAGE(output.exit_code == 0, text_of(output));
  }
}

TEST_CASE("the installed program works from any folder") {
  const ProgramOutput version = run_installed("$P/bin/tagsmith --version");
  CHECK(version.exit_code == 0);
  const ProgramOutput read = run_installed(
      "$P/bin/tagsmith read --survey $P/share/tagsmith/surveys/corridor/survey.yaml "
      "$P/share/tagsmith/surveys/corridor/photos/corridor_01_left.jpg");
  CHECK_MESSAGE(has(read.out, "000L of corridor"), text_of(read));
  // A PNG needs the module of codecs.
  const ProgramOutput drawn = run_installed(
      "$P/bin/tagsmith read --explain $P/work/why "
      "$P/share/tagsmith/surveys/corridor/photos/corridor_01_left.jpg");
  CHECK_MESSAGE(drawn.exit_code == 0, text_of(drawn));
  CHECK(fs::exists(prefix() / "work/why/corridor_01_left.explained.png"));
}

TEST_CASE("the installed demo runs from any folder") {
  const ProgramOutput demo = run_installed("$P/bin/tagsmith demo -o $P/demo");
  CHECK_MESSAGE(demo.exit_code == 0, text_of(demo));
  CHECK(fs::exists(prefix() / "demo/print/000L.pdf"));
}

TEST_CASE("man pages and completions are installed") {
  for (const char* file :
       {"share/man/man1/tagsmith.1", "share/man/man1/tagsmith-read.1",
        "share/man/man1/tagsmith-localize.1", "share/bash-completion/completions/tagsmith",
        "share/zsh/site-functions/_tagsmith", "share/fish/vendor_completions.d/tagsmith.fish",
        "share/tagsmith/templates/tag-400x300.yaml", "share/tagsmith/schemas/survey.schema.json",
        "share/doc/tagsmith/LICENSE"}) {
    CHECK_MESSAGE(fs::file_size(prefix() / file) > 100, file);
  }
}

}  // namespace tagsmith::detail::test
