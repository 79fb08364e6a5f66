// SPDX-License-Identifier: Apache-2.0
// Options as data: parsing, help, man pages and completion of the program's commands, and of one
// made for the tests.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/cli/commands.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_help.hpp"
#include "tagsmith/cli/completion.hpp"
#include "tagsmith/cli/parse_command.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

using Words = std::vector<std::string>;

struct Values {
  std::string survey;
  Words photos;
  int count = 3;
  double length = 0;
  Words formats;
  Words also;
  bool json = false;
  std::string only;
};

Command made_command(Values& values) {
  return {.name = "made",
          .summary = "A command for tests",
          .options = {{.names = "SURVEY", .target = &values.survey, .required = true},
                      {.names = "PHOTO", .target = &values.photos},
                      {.names = "-n,--count",
                       .target = &values.count,
                       .shows_default = true,
                       .least = 1,
                       .greatest = 9,
                       .odd = true},
                      {.names = "--length",
                       .target = [&values](double mm) { values.length = mm / 1000; },
                       .least = -1,
                       .greatest = 1},
                      {.names = "--format",
                       .target = &values.formats,
                       .by_commas = true,
                       .choices = {"pdf", "svg"}},
                      {.names = "--also", .target = &values.also},
                      {.names = "--json", .target = &values.json, .needs = {"--count"}},
                      {.names = "--only", .target = &values.only, .excludes = {"--also"}}},
          .notes = "",
          .run = [] { return 0; }};
}

Values parsed(const Words& arguments) {
  Values values;
  const Command command = made_command(values);
  const Result<Asked> asked = parse_command(command, arguments);
  REQUIRE_MESSAGE(asked.has_value(), asked.error().message);
  return values;
}

std::string problem(const Words& arguments) {
  Values values;
  const Command command = made_command(values);
  const Result<Asked> asked = parse_command(command, arguments);
  REQUIRE_FALSE(asked.has_value());
  return asked.error().message;
}

}  // namespace

TEST_CASE("arguments reach the targets of their options") {
  const Values values = parsed({"s.yaml", "--also", "a", "p.jpg", "-n", "5", "--length", "-0.5",
                                "q.jpg", "--format", "pdf,svg", "--also", "b", "--json"});
  CHECK(values.survey == "s.yaml");
  CHECK(values.photos == Words{"p.jpg", "q.jpg"});  // what follows an option's value is no other
  CHECK(values.also == Words{"a", "b"});
  CHECK(values.count == 5);
  CHECK(values.length == -0.0005);
  CHECK(values.formats == Words{"pdf", "svg"});
  CHECK(values.json);
}

TEST_CASE("behind two dashes every word is an argument") {
  const Values values = parsed({"--also", "a", "--", "-s.yaml", "--json", "-n"});
  CHECK(values.survey == "-s.yaml");
  CHECK(values.photos == Words{"--json", "-n"});
  CHECK(values.also == Words{"a"});
  CHECK_FALSE(values.json);
  CHECK(problem({"--"}).find("SURVEY") != std::string::npos);
}

TEST_CASE("a file whose name begins with a dash is told from an option") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.path() / "-survey.yaml", "x"));
  const ProgramOutput output = run_shell("cd '" + folder.path().string() +
                                         "' && \"$TAGSMITH_PROGRAM\" validate -survey.yaml");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("the file of that name is `./-survey.yaml`") != std::string::npos);
}

TEST_CASE("wrong arguments are named with what was expected") {
  CHECK(problem({}).find("SURVEY") != std::string::npos);
  CHECK(problem({"s", "--count", "4"}) == "--count: found `4`, expected an odd number from 1 to 9");
  CHECK(problem({"s", "--count", "nan"}).find("`nan`") != std::string::npos);
  CHECK(problem({"s", "--count", "1e99"}).find("`1e99`") != std::string::npos);
  CHECK(problem({"s", "--format", "pdf,png"}) == "--format: found `png`, expected pdf or svg");
  CHECK(problem({"s", "--cuont", "5"}) == "no option `--cuont`, did you mean `--count`?");
  CHECK(problem({"--cuont=5"}) == "no option `--cuont=5`, did you mean `--count`?");
  CHECK(problem({"s", "--json"}).find("--count") != std::string::npos);
  CHECK(problem({"s", "--only", "x", "--also", "y"}).find("--also") != std::string::npos);
  CHECK(problem({"s", "--count", "3", "--count", "5"}) ==
        "--count: given twice, it takes one value");
  CHECK_FALSE(problem({"s", "--also"}).empty());
  // A variable of a script that is not set.
  CHECK(problem({"s", "--only", ""}) == "--only: is empty, expected a value");
  CHECK(problem({"s", "--count", ""}) == "--count: is empty, expected a value");
}

TEST_CASE("every option of the program is told once, and its numbers have limits") {
  int options = 0;
  for (const Command& command : all_commands()) {
    CAPTURE(command.name);
    CHECK(command.notes.find("\n  tagsmith " + command.name) != std::string::npos);
    std::set<std::string> names;
    for (const CommandOption& option : command.options) {
      CAPTURE(option.names);
      CHECK_FALSE(option.help.empty());
      for (const std::string& name : option.all_names()) CHECK(names.insert(name).second);
      if (std::holds_alternative<int*>(option.target)) CHECK(option.greatest.has_value());
      const bool free_value =
          !option.is_flag() && !option.is_positional() && option.choices.empty();
      if (free_value) CHECK_FALSE(option.placeholder.empty());
      ++options;
    }
    for (const CommandOption& option : command.options) {
      for (const std::string& other : option.needs) CHECK(names.contains(other));
      for (const std::string& other : option.excludes) CHECK(names.contains(other));
    }
  }
  CHECK(options > 100);
}

TEST_CASE("help is as wide as it is asked to be, and says each option") {
  for (const Command& command : all_commands()) {
    const std::string help = command_help(command, 72);
    for (const std::string& line : split(help, '\n')) {
      const bool verbatim = line.starts_with("  tagsmith ") || line.find("    --") == 0;
      if (!verbatim) CHECK_MESSAGE(line.size() <= 72, line);
    }
    for (const CommandOption& option : command.options) {
      CHECK_MESSAGE(help.find(option.all_names().back()) != std::string::npos, option.names);
    }
  }
}

TEST_CASE("help says what an option is when it is not given") {
  Values values;
  const std::string help = command_help(made_command(values), 80);
  CHECK(help.find("(default: 3)") != std::string::npos);
  CHECK(run_tagsmith("help read").out.find("(default: fallback)") != std::string::npos);
  CHECK(run_tagsmith("help simulate").out.find("(default: 0.7)") != std::string::npos);
  CHECK(run_tagsmith("help verify").out.find("(default: 10)") != std::string::npos);
  CHECK(run_tagsmith("help plan").out.find("(with --optimise)") != std::string::npos);
}

TEST_CASE("man pages hold every option, and no line of text is taken for a request") {
  for (const Command& command : all_commands()) {
    const std::string page = command_man_page(command, "1.0");
    CHECK(page.starts_with(".TH TAGSMITH\\-"));
    for (const std::string& line : split(page, '\n')) {
      if (!line.starts_with('.')) continue;
      const std::string request = line.substr(0, line.find(' '));
      const std::set<std::string> known{".TH", ".SH", ".TP", ".B", ".BR", ".PP", ".EX", ".EE"};
      CHECK_MESSAGE(known.contains(request), line);
    }
  }
  CHECK(run_tagsmith("help --man").out.find("tagsmith\\-verify") != std::string::npos);
  CHECK(run_tagsmith("help --man print").out == run_tagsmith("help print --man").out);
}

TEST_CASE("help, version and mistakes at the front door") {
  CHECK(run_tagsmith("help verify").out == run_tagsmith("verify --help").out);
  CHECK(run_tagsmith("--help").out == run_tagsmith("help").out);
  const ProgramOutput version = run_tagsmith("--version");
  CHECK(version.out.find("Apache-2.0") != std::string::npos);
  const ProgramOutput mistyped = run_tagsmith("verfiy");
  CHECK(mistyped.exit_code == 2);
  CHECK(mistyped.err.find("`verify`") != std::string::npos);
  const ProgramOutput option = run_tagsmith("print survey.yaml -o x --dpl 300");
  CHECK(option.exit_code == 2);
  CHECK(option.err.find("tagsmith print: no option `--dpl`, did you mean `--dpi`?") == 0);
  CHECK(run_tagsmith("").exit_code == 2);
}

TEST_CASE("the prompt offers commands, options, choices, files and tags") {
  const std::vector<Command> commands = all_commands();
  const auto offered = [&](const Words& words) { return completions(commands, words); };
  CHECK(offered({"ver"}) == Words{"verify"});
  CHECK(offered({"help", "loc"}) == Words{"localize"});
  CHECK(offered({"read", "--fra"}) == Words{"--frameless"});
  CHECK(offered({"read", "--check", ""}) == Words{"gs1", "sum10"});
  CHECK(offered({"print", "s.yaml", "--format", "pdf,s"}) == Words{"pdf,svg"});
  CHECK(offered({"verify", "surveys/corridor/s"}) == Words{"surveys/corridor/survey.yaml"});
  CHECK(offered({"verify", "surveys/curv"}) == Words{"surveys/curved/"});
  CHECK(offered({"print", "surveys/corridor/survey.yaml", "--tags", "000L,003"}) ==
        Words{"000L,003L", "000L,003R"});
  CHECK(offered({"nothing", ""}).empty());
}

TEST_CASE("bash completes with the script that the program prints") {
  const ProgramOutput output = run_shell(
      "PATH=$(dirname \"$TAGSMITH_PROGRAM\"):$PATH bash -c 'source <(tagsmith completion bash); "
      "COMP_WORDS=(tagsmith read --frameless al); COMP_CWORD=3; _tagsmith; "
      "echo \"${COMPREPLY[@]}\"'");
  CHECK(output.out == "always\n");
  CHECK(run_tagsmith("completion zsh").out.starts_with("#compdef tagsmith"));
  CHECK(run_tagsmith("completion tcsh").exit_code == 2);
}
