// SPDX-License-Identifier: Apache-2.0
// The user guide's ways of verifying an archive in pieces, run as printed: on two processes, killed
// and resumed, and merged into the report of a single run.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/readme/documents.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;

// The guide's block of this language.
std::string guide_block(const std::string& language) {
  const auto blocks = blocks_of(read_file("docs/user-guide.md").value());
  const auto block = std::ranges::find(blocks, language, &Block::language);
  REQUIRE_MESSAGE(block != blocks.end(), "docs/user-guide.md has no block of " << language);
  std::string text;
  for (const std::string& line : block->lines) text += line + "\n";
  return text;
}

// A folder with survey.yaml and all-photos.txt: photos of its tunnel, one of another, a broken one.
class Archive {
 public:
  Archive() {
    fs::copy_file("surveys/corridor/survey.yaml", folder_.path() / "survey.yaml");
    fs::create_directory(folder_.path() / "bin");
    fs::create_symlink(fs::absolute(std::getenv("TAGSMITH_PROGRAM")),
                       folder_.path() / "bin" / "tagsmith");
    std::ofstream list(folder_.path() / "all-photos.txt");
    for (const char* photo :
         {"corridor/photos/corridor_01_left.jpg", "corridor/photos/corridor_01_right.jpg",
          "corridor/photos/corridor_02_left.jpg", "curved/photos/curved_02_left.jpg",
          "corridor/photos/corridor_03_left.jpg", "corridor/photos/corridor_03_right.jpg"}) {
      list << fs::absolute(fs::path("surveys") / photo).string() << '\n';
    }
    REQUIRE(write_file(folder_.path() / "broken.jpg", "\xFF\xD8\xFF\xE0").has_value());
    list << (folder_.path() / "broken.jpg").string() << '\n';
  }

  ProgramOutput run(const std::string& script) const {
    return run_shell("cd '" + folder_.path().string() + "' && PATH=\"$PWD/bin:$PATH\"\n" + script);
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }

  // What the report of these lines says, in every form.
  std::string report_of(const std::string& lines) const {
    const ProgramOutput output =
        run("tagsmith report survey.yaml " + lines + " --json --html page.html --csv table.csv");
    CHECK_MESSAGE(output.exit_code == 1, output.err);
    CHECK(output.err == "");
    return output.out + read_file(path("table.csv")).value() + read_file(path("page.html")).value();
  }

 private:
  TemporaryFolder folder_;
};

// Whether both are the same, without pages of either in the message.
bool same(const std::string& a, const std::string& b) {
  const auto [at, unused] = std::ranges::mismatch(a, b);
  const auto place = at - a.begin();
  const std::size_t from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, place - 100));
  if (a != b) MESSAGE(a.substr(from, 200) << "\n--- or ---\n" << b.substr(from, 200));
  return a == b;
}

std::string whole_run(const Archive& archive) {
  archive.run("tagsmith verify --json --crops crops survey.yaml - < all-photos.txt > whole.jsonl");
  return archive.report_of("whole.jsonl");
}

}  // namespace

TEST_CASE("an array job on two processes gives the report of one run, killed and resumed or not") {
  const Archive archive;
  const std::string expected = whole_run(archive);
  CHECK(expected.find("\"files\":7,\"faults\":2") != std::string::npos);
  REQUIRE(write_file(archive.path("job.sh"), guide_block("slurm")).has_value());
  const std::string job =
      "for i in 0 1; do SLURM_ARRAY_TASK_ID=$i SLURM_ARRAY_TASK_COUNT=2 sh job.sh & done; wait";
  archive.run(job);
  CHECK(same(archive.report_of("done-*.jsonl"), expected));

  // As if the first had been killed in the middle of its second line.
  const std::string lines = read_file(archive.path("done-0.jsonl")).value();
  const std::size_t second = lines.find('\n') + 1;
  REQUIRE(write_file(archive.path("done-0.jsonl"), lines.substr(0, second + 60)).has_value());
  const ProgramOutput again = archive.run(job);
  CHECK(again.err.find("skipped, verified before: 1\n") != std::string::npos);
  // A broken file is tried again.
  std::string resumed = archive.report_of("done-*.jsonl");
  const std::string repeated = "\"repeated\":1";
  REQUIRE(resumed.find(repeated) != std::string::npos);
  resumed.replace(resumed.find(repeated), repeated.size(), "\"repeated\":0");
  CHECK(same(resumed, expected));
  CHECK(read_file(archive.path("done-0.jsonl")).value().starts_with(lines.substr(0, second)));
}

TEST_CASE("GNU parallel on two processes gives the report of one run") {
  REQUIRE_MESSAGE(has_program("parallel"), "GNU parallel is not installed: run ./dev setup");
  const Archive archive;
  const std::string expected = whole_run(archive);
  const ProgramOutput output = archive.run("export HOME=\"$PWD\"\n" + guide_block("parallel"));
  CHECK_MESSAGE(same(archive.report_of("all.jsonl"), expected), output.err);
}

}  // namespace tagsmith::detail::test
