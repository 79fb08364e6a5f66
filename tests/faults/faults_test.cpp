// SPDX-License-Identifier: Apache-2.0
// What stays on the disk when the program is killed, when it is told to end, and when the disk or
// the reader of its output goes away. `./dev faults N` tries N moments of each command.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

constexpr int kKilled = 137;  // 128 + SIGKILL

// Moments of each command at which it is killed.
int moments() {
  const char* said = std::getenv("TAGSMITH_FAULTS");
  return said != nullptr ? std::max(1, std::atoi(said)) : 4;
}

const std::string kSite = "surveys/corridor/";
const std::string kSurvey = kSite + "survey.yaml";
const std::string kRig = " --rig " + kSite + "rig.yaml";

// Moments of a run, in no order.
class Moments {
 public:
  explicit Moments(unsigned seed) : random_(seed) {}
  double below(double seconds) {
    return std::uniform_real_distribution<double>(0, seconds)(random_);
  }

 private:
  std::mt19937 random_;
};

struct LongCommand {
  std::string name;
  std::string arguments;  // % stands for the folder it writes into
};

std::string in_folder(std::string arguments, const fs::path& folder) {
  for (std::size_t at = 0; (at = arguments.find('%')) != std::string::npos;) {
    arguments.replace(at, 1, folder.string());
  }
  return arguments;
}

// Every file below the folder, hidden ones too, by its path in it.
std::map<std::string, std::string> files_below(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) {
      files[fs::relative(entry.path(), folder).string()] = contents(entry.path());
    }
  }
  return files;
}

// Files that are there must be whole ones, of an undisturbed run. What is hidden is not yet there.
void check_whole(const std::map<std::string, std::string>& found,
                 const std::map<std::string, std::string>& undisturbed) {
  for (const auto& [name, bytes] : found) {
    CAPTURE(name);
    if (name.starts_with(".") || name.find("/.") != std::string::npos) continue;
    const auto whole = undisturbed.find(name);
    REQUIRE(whole != undisturbed.end());
    CHECK(bytes == whole->second);
  }
}

double seconds_of(const std::string& arguments) {
  const auto start = std::chrono::steady_clock::now();
  REQUIRE(run_tagsmith(arguments).exit_code <= 1);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// In the foreground `timeout` signals the program alone and waits until it has ended; else SIGKILL
// would end `timeout` first, and a program that is still ending would hold its lock.
ProgramOutput run_until(double seconds, const std::string& signal, const std::string& arguments) {
  return run_shell("timeout --foreground --preserve-status -s " + signal + " " +
                   std::to_string(seconds) + " \"$TAGSMITH_PROGRAM\" " + arguments +
                   " > /dev/null 2> /dev/null");
}

// The first two places of the corridor's drive.
void write_short_run(const fs::path& file) {
  std::ifstream all(kSite + "run.csv");
  std::ofstream few(file);
  std::string row;
  for (int i = 0; i < 3 && std::getline(all, row); ++i) few << row << "\n";
}

std::vector<LongCommand> long_commands(const fs::path& lines, const fs::path& run) {
  return {
      {"print", "print " + kSurvey + " -o %/out"},
      {"simulate", "simulate " + kSurvey + kRig + " --run '" + run.string() + "' -o %/out --force"},
      {"plan", "plan " + kSurvey + kRig + " --to 4 --step 0.2 -o %/out"},
      {"draw", "draw " + kSurvey + " -o %/drawing.pdf"},
      {"report", "report " + kSurvey + " '" + lines.string() +
                     "' --html %/report.html --pdf %/report.pdf --csv %/report.csv"},
  };
}

}  // namespace

TEST_CASE("a command that is killed at any moment leaves whole files, and a second run mends all") {
  const TemporaryFolder work;
  const fs::path lines = work.path() / "photos.jsonl";
  run_shell("\"$TAGSMITH_PROGRAM\" verify --json " + kSurvey + " " + kSite + "photos > '" +
            lines.string() + "'");
  const fs::path run = work.path() / "run.csv";
  write_short_run(run);
  Moments random(7);
  for (const LongCommand& command : long_commands(lines, run)) {
    CAPTURE(command.name);
    const TemporaryFolder once;
    const double seconds = seconds_of(in_folder(command.arguments, once.path()));
    const auto undisturbed = files_below(once.path());
    REQUIRE_FALSE(undisturbed.empty());
    int killed = 0;
    for (int i = 0; i < moments(); ++i) {
      const TemporaryFolder folder;
      const std::string arguments = in_folder(command.arguments, folder.path());
      const double moment = 0.01 + random.below(seconds);
      CAPTURE(moment);
      killed += run_until(moment, "KILL", arguments).exit_code == kKilled;
      check_whole(files_below(folder.path()), undisturbed);
      CHECK(run_tagsmith(arguments).exit_code <= 1);
      const auto mended = files_below(folder.path());
      CHECK(mended.size() == undisturbed.size());  // no stray file
      check_whole(mended, undisturbed);
    }
    CHECK(killed > 0);
  }
}

TEST_CASE("verify that is killed goes on where it was, and its lines become those of one run") {
  const TemporaryFolder folder;
  const std::string lines = (folder.path() / "photos.jsonl").string();
  const std::string verify = "\"$TAGSMITH_PROGRAM\" verify --json --jobs 1 " + kSurvey;
  const auto start = std::chrono::steady_clock::now();
  run_shell(verify + " " + kSite + "photos > '" + lines + ".once'");
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Moments random(8);
  for (int i = 0; i < moments(); ++i) {
    const double moment = 0.01 + random.below(seconds);
    run_shell("timeout --foreground -s KILL " + std::to_string(moment) + " " + verify + " " +
              kSite + "photos > '" + lines + "' 2> /dev/null");
    run_shell(verify + " --resume '" + lines + "' " + kSite + "photos > '" + lines +
              ".rest' 2> /dev/null");
    const auto summary = [&](const std::string& files) {
      return run_tagsmith("report --json " + kSurvey + " " + files).out;
    };
    CHECK(summary("'" + lines + "' '" + lines + ".rest'") == summary("'" + lines + ".once'"));
  }
}

TEST_CASE("SIGTERM leaves the folder as it was") {
  Moments random(9);
  const TemporaryFolder once;
  const std::string print = "print " + kSurvey + " -o %/out";
  const double seconds = seconds_of(in_folder(print, once.path()));
  const auto undisturbed = files_below(once.path());
  for (int i = 0; i < moments(); ++i) {
    const TemporaryFolder folder;
    run_until(random.below(seconds), "TERM", in_folder(print, folder.path()));
    const auto left = files_below(folder.path());
    CHECK((left.empty() || left == undisturbed));
  }
}

TEST_CASE("a full disk, a folder that cannot be written and a closed pipe are told") {
  const TemporaryFolder folder;
  const std::string quiet = " 2> /dev/null";
  const std::string program = "\"$TAGSMITH_PROGRAM\" ";
  CHECK(run_shell(program + "export " + kSurvey + " > /dev/full" + quiet).exit_code == 2);
  CHECK(run_shell(program + "read " + kSite + "photos --json > /dev/full" + quiet).exit_code == 2);
  CHECK(run_shell(program + "verify " + kSurvey + " " + kSite + "photos --json > /dev/full" + quiet)
            .exit_code == 2);
  CHECK(run_tagsmith("print " + kSurvey + " -o /proc/print").exit_code == 2);
  CHECK(run_tagsmith("draw " + kSurvey + " -o /dev/null/draw").exit_code == 2);
  const ProgramOutput closed =
      run_shell("(" + program + "read " + kSite + "photos --json; echo $? >&2) | head -c 1");
  CHECK(closed.err.find("Aborted") == std::string::npos);
  const int exit_code = std::atoi(closed.err.c_str());
  CHECK((exit_code <= 2 || exit_code == 141));  // 128 + SIGPIPE
}
