// SPDX-License-Identifier: Apache-2.0
// File names and files made to deceive whoever looks at the terminal.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tagsmith/base/text.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

// ESC, CR, a C1 control, an override, a byte that is no UTF-8, and a line that looks like a result.
const std::string kName = "a\x1b[2K\r\u009b\u202e\xff\nok: all is well";

std::string in_quotes(const fs::path& path) { return "'" + path.string() + "'"; }

// Nothing but lines of plain text, and none that the name wrote.
void check_harmless(const ProgramOutput& output) {
  for (const std::string& stream : {output.out, output.err}) {
    std::string lines = stream;
    std::erase(lines, '\n');
    CHECK_MESSAGE(is_plain_text(lines), terminal_lines(stream));
    CHECK_MESSAGE(("\n" + stream).find("\nok: all") == std::string::npos, stream);
  }
}

}  // namespace

TEST_CASE("no command sends control characters of a file's name to the terminal") {
  const TemporaryFolder folder;
  const fs::path missing = folder.path() / (kName + ".yaml");
  const fs::path picture = folder.path() / (kName + ".png");
  const fs::path survey = folder.path() / (kName + "-survey.yaml");
  std::ofstream(picture) << "no picture";
  fs::copy_file("surveys/corridor/survey.yaml", survey);
  const std::string corridor = "surveys/corridor/survey.yaml";
  const std::string rig = " --rig surveys/corridor/rig.yaml";
  for (const std::string& command :
       {"validate " + in_quotes(missing),
        "validate " + in_quotes(survey),
        "draw " + in_quotes(missing) + " -o x.pdf",
        "draw " + corridor + " -o " + in_quotes(folder.path() / (kName + ".pdf")),
        "export " + in_quotes(survey) + " -o " + in_quotes(folder.path() / (kName + ".csv")),
        "export " + corridor + " -o " + in_quotes(missing),
        "plan " + in_quotes(missing) + rig,
        "plan " + corridor + " --rig " + in_quotes(missing),
        "print " + in_quotes(missing) + " -o " + in_quotes(folder.path()),
        "diff " + in_quotes(missing) + " " + in_quotes(survey),
        "diff " + corridor + " " + in_quotes(missing),
        "read " + in_quotes(picture),
        "read " + in_quotes(missing),
        "read --json " + in_quotes(picture),
        "verify " + corridor + " " + in_quotes(picture),
        "verify --json " + corridor + " " + in_quotes(picture),
        "verify " + in_quotes(missing) + " " + in_quotes(picture),
        "report " + corridor + " " + in_quotes(missing),
        "localize " + corridor + rig + " --run " + in_quotes(missing),
        "simulate " + corridor + rig + " --run " + in_quotes(missing) + " -o " +
            in_quotes(folder.path()),
        "new " + in_quotes(folder.path() / kName),
        "plan " + in_quotes(survey) + rig + " --step 1",
        "validate --explain " + in_quotes(kName),
        "read --check " + in_quotes(kName) + " x.png",
        in_quotes(kName),
        "read --" + in_quotes(kName)}) {
    CAPTURE(terminal_text(command));
    check_harmless(run_tagsmith(command));
  }
}

TEST_CASE("text of a survey and of a run is refused when it is not plain") {
  const TemporaryFolder folder;
  const fs::path survey = folder.path() / "survey.yaml";
  std::ofstream(survey) << "survey: \"drift\u202e\u009b\"\n";
  const ProgramOutput output = run_tagsmith("validate --json " + in_quotes(survey));
  CHECK(output.exit_code == 1);
  CHECK(output.out.find("\"bad-text\"") != std::string::npos);
  check_harmless(output);

  const fs::path run = folder.path() / "run.csv";
  std::ofstream(run) << "id,left,d\n\u202e1,,0.9\n";
  const ProgramOutput located =
      run_tagsmith("localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --run " +
                   in_quotes(run));
  CHECK(located.exit_code == 2);
  CHECK(located.err.find(":2: error") != std::string::npos);
  check_harmless(located);
}

TEST_CASE("an id that a spreadsheet would compute is written as text, and read again") {
  const TemporaryFolder folder;
  const fs::path run = folder.path() / "run.csv";
  std::ofstream(run) << "id,left,right,d\n\"=HYPERLINK(\"\"http://x\"\")\",,,0.9\n";
  const fs::path fixes = folder.path() / "fixes.csv";
  const ProgramOutput located =
      run_tagsmith("localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --run " +
                   in_quotes(run) + " --csv " + in_quotes(fixes));
  CHECK(located.exit_code == 1);
  std::string text;
  std::ifstream stream(fixes);
  std::getline(stream, text);
  std::getline(stream, text);
  CHECK_MESSAGE(text.starts_with("\"'=HYPERLINK(\"\"http://x\"\")\","), text << located.err);
}

TEST_CASE("a picture that cannot be decoded is told of in the program's own words") {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> grey(64 * 48, 128);
  for (const char* extension : {".webp", ".tiff", ".png", ".bmp", ".jpg"}) {
    CAPTURE(extension);
    const fs::path picture = folder.path() / (std::string("broken") + extension);
    std::string bytes = *encode_gray_image(picture, {grey.data(), 64, 48, 64});
    std::fill(bytes.begin() + 24, bytes.end() - 4, '\x55');
    std::ofstream(picture) << bytes;
    const ProgramOutput output = run_tagsmith("read " + in_quotes(picture));
    for (const char* foreign : {"OpenCV", "imdecode", "libpng", "TIFF: ", "grfmt", "WARN"}) {
      CHECK_MESSAGE(output.err.find(foreign) == std::string::npos, output.err);
    }
    CHECK_MESSAGE(std::ranges::count(output.err, '\n') <= 1, output.err);
  }
}
