// SPDX-License-Identifier: Apache-2.0
// What commands print and write does not depend on where and how they run: language, time zone,
// number of threads, rights of new files, order of files on the command line.
#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;

const std::string kSurvey = "surveys/corridor/survey.yaml";
const std::string kRig = " --rig surveys/corridor/rig.yaml";
const std::string kPhotos = " surveys/corridor/photos/corridor_0";

struct Surroundings {
  std::string name;
  std::string shell;    // what is said before the command
  std::string program;  // words of the shell
  std::string jobs;
};

// A language whose numbers have commas, made here because few machines have one.
std::string german(const TemporaryFolder& folder) {
  const std::string path = folder.path().string();
  run_shell("localedef -i de_DE -f UTF-8 '" + path + "/de_DE.UTF-8'");  // warns of what it lacks
  const std::string shell = "export LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 LOCPATH='" + path + "'; ";
  const ProgramOutput one_and_a_half = run_shell(shell + "exec env printf %.1f 1,5");
  REQUIRE_MESSAGE(one_and_a_half.out == "1,5", "German is missing: install locales");
  return shell;
}

std::string without_times(const std::string& text) {
  return std::regex_replace(text, std::regex(",\"time_ms\":[0-9.e+-]+"), "");
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

// Everything the command prints, and every file that it writes into OUT, one after the other.
std::string all_output(const std::string& arguments, const Surroundings& where) {
  const TemporaryFolder folder;
  const std::string out = folder.path().string();
  const ProgramOutput output =
      run_shell(where.shell + where.program + " " + replaced(arguments, "OUT", out) + where.jobs);
  std::string all = std::to_string(output.exit_code) + "\n" + output.err +
                    replaced(without_times(output.out), out, "OUT");
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) all += file.filename().string() + "\n" + contents(file);
  return all;
}

// Where two texts begin to differ, with what stands there.
std::string difference(const std::string& a, const std::string& b) {
  const auto [in_a, in_b] = std::ranges::mismatch(a, b);
  const auto at = static_cast<std::size_t>(in_a - a.begin());
  const std::size_t from = at - std::min<std::size_t>(at, 60);
  return "at byte " + std::to_string(at) + ": " + a.substr(from, 120) +
         "\n instead of: " + b.substr(from, 120);
}

void check_same(const std::string& found, const std::string& expected) {
  const bool same = found == expected;
  CHECK_MESSAGE(same, difference(found, expected));
}

std::string verified(int first, int last) {
  return "verify --json " + kSurvey + kPhotos + std::to_string(first) + "_*.jpg" + kPhotos +
         std::to_string(last) + "_*.jpg";
}

}  // namespace

TEST_CASE("language, time zone, threads and rights of new files change no byte") {
  const TemporaryFolder languages;
  const std::string in_german = german(languages);
  const std::string tagsmith = "\"$TAGSMITH_PROGRAM\"";
  const Surroundings usual{"the usual", "umask 022; export LC_ALL=C TZ=UTC; ", tagsmith,
                           " --jobs 1"};
  const Surroundings others[] = {
      {"Kathmandu", "umask 077; export LC_ALL=C.UTF-8 TZ=Asia/Kathmandu; ", tagsmith, " --jobs 4"},
      {"Germany", in_german + "export TZ=Europe/Berlin; ", tagsmith, " --jobs 4"},
      {"commas in numbers", in_german, TAGSMITH_OF_USER, " --jobs 1"},
  };
  const std::string commands[] = {
      "read --json" + kPhotos + "1_*.jpg surveys/curved/photos/curved_01_*.jpg",
      verified(1, 2) + " --html OUT/page.html --pdf OUT/page.pdf --csv OUT/tags.csv",
      "localize --json " + kSurvey + kRig + " --run surveys/corridor/run.csv --drawing OUT/run.svg",
      "print --json -o OUT --tags 000L,003R --order " + kSurvey,
      "plan --json --to 4.5 -o OUT " + kSurvey + kRig,
  };
  for (const std::string& command : commands) {
    CAPTURE(command);
    const std::string expected = all_output(command, usual);
    REQUIRE_MESSAGE(expected.size() > 1000, expected);
    for (const Surroundings& where : others) {
      CAPTURE(where.name);
      check_same(all_output(command, where), expected);
    }
  }
}

// Lines of three jobs that share photos: of all stations of the corridor, two of which have each
// other's left photo, and of photos that the run does not have.
class ThreeJobs {
 public:
  ThreeJobs() {
    run_shell("cp -r surveys/corridor surveys/curved '" + path("") + "'");
    run_shell("cd '" + path("corridor") + "'; sed -e s/02_left/@/ -e s/05_left/02_left/ " +
              "-e s/@/05_left/ run.csv > mixed.csv");
    verify(1, "0[1-4]_*");
    verify(2, "0[4-7]_*");
    verify(3, "[01][0789]_*");
  }

  ProgramOutput report(const std::string& jobs) const {
    const ProgramOutput output = run_shell(
        "cd '" + path("") + "'; \"$TAGSMITH_PROGRAM\" report --json corridor/survey.yaml " + jobs +
        " --rig corridor/rig.yaml --run corridor/mixed.csv --html page.html --pdf page.pdf "
        "--csv tags.csv");
    return {output.exit_code,
            output.out + contents(path("page.html")) + contents(path("page.pdf")) +
                contents(path("tags.csv")),
            output.err};
  }

 private:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  void verify(int job, const std::string& corridor) const {
    const std::string number = std::to_string(job);
    run_shell("cd '" + path("") + "'; \"$TAGSMITH_PROGRAM\" verify --json corridor/survey.yaml " +
              "corridor/photos/corridor_" + corridor + " curved/photos/curved_0" + number +
              "_left.jpg > " + number);
  }

  TemporaryFolder folder_;
};

TEST_CASE("the order of a report's files changes no byte") {
  const ThreeJobs jobs;
  const ProgramOutput expected = jobs.report("1 2 3");
  CHECK(expected.err.find("are mixed up") != std::string::npos);
  CHECK(expected.err.find("camera of the rig took it is not known") != std::string::npos);
  for (const char* order : {"3 2 1", "2 3 1"}) {
    const ProgramOutput output = jobs.report(order);
    CHECK(output.err == expected.err);
    check_same(output.out, expected.out);
  }
}

}  // namespace tagsmith::detail::test
