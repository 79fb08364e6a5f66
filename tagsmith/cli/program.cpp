// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/program.hpp"

#include <algorithm>
#include <cstdio>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_help.hpp"
#include "tagsmith/cli/completion.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/parse_command.hpp"

namespace tagsmith::detail {
namespace {

using Words = std::vector<std::string>;

int complain(const std::string& problem, const std::string& remedy) {
  to_stderr("tagsmith: {}\n{}\n", problem, remedy);
  return kExitFailure;
}

int unknown_command(const std::vector<Command>& commands, const std::string& word) {
  std::vector<std::string> names{"help", "completion"};
  for (const Command& command : commands) names.push_back(command.name);
  const auto near = nearest_word(word, names);
  return complain("no command `" + word + "`" + (near ? ", did you mean `" + *near + "`?" : ""),
                  "Run `tagsmith help` for the list.");
}

int show(const std::string& text) {
  bytes_to_stdout(text);
  return kExitOk;
}

int show_version(const ProgramVersion& version) {
  const std::string commit = version.commit.empty() ? "" : " (commit " + version.commit + ")";
  return show("tagsmith " + version.number + commit +
              "\nLicence: Apache-2.0, https://www.apache.org/licenses/LICENSE-2.0\n"
              "Method: Xu et al. 2017, PLoS ONE 12(1) e0171012\n");
}

// `help [--man] [COMMAND]`.
int help(const std::vector<Command>& commands, const ProgramVersion& version, Words words) {
  const bool as_man_page = std::erase(words, "--man") > 0;
  if (words.empty()) {
    return show(as_man_page ? program_man_page(commands, version.number)
                            : program_help(commands, terminal_columns()));
  }
  const auto command = std::ranges::find(commands, words.front(), &Command::name);
  if (command == commands.end()) return unknown_command(commands, words.front());
  return show(as_man_page ? command_man_page(*command, version.number)
                          : command_help(*command, terminal_columns()));
}

int completion(const Words& words) {
  const Result<std::string> script = completion_script(words.empty() ? "" : words.front());
  return script ? show(*script) : report_failure("completion", script.error());
}

int run_command(const Command& command, const Words& arguments) {
  const Result<Asked> asked = parse_command(command, arguments);
  if (!asked) {
    report_failure(command.name, asked.error());
    to_stderr("Run `tagsmith help {}` for its options.\n", command.name);
    return kExitFailure;
  }
  if (*asked == Asked::help) return show(command_help(command, terminal_columns()));
  const Result<int> code = command.run();
  return code ? *code : report_failure(command.name, code.error());
}

int answer(const std::vector<Command>& commands, const ProgramVersion& version,
           const Words& arguments) {
  if (arguments.empty()) {
    return complain("a command is missing", "Run `tagsmith help` for the list.");
  }
  const std::string& first = arguments.front();
  const Words rest(arguments.begin() + 1, arguments.end());
  if (first == "--version") return show_version(version);
  if (first == "-h" || first == "--help" || first == "help") return help(commands, version, rest);
  if (first == "completion") return completion(rest);
  if (first == "__complete") {
    for (const std::string& one : completions(commands, rest)) to_stdout("{}\n", one);
    return kExitOk;
  }
  const auto command = std::ranges::find(commands, first, &Command::name);
  if (command == commands.end()) return unknown_command(commands, first);
  return run_command(*command, rest);
}

}  // namespace

int run_program(const std::vector<Command>& commands, const ProgramVersion& version,
                const std::vector<std::string>& arguments) {
  const int exit_code = answer(commands, version, arguments);
  // Results that did not reach standard output are a failure.
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  return report_failure(arguments.empty() ? "help" : arguments.front(),
                        {"standard output cannot be written"});
}

}  // namespace tagsmith::detail
