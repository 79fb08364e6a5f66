// SPDX-License-Identifier: Apache-2.0
// The front door: the list of commands.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "decoder/cli/demo_command.hpp"
#include "decoder/cli/localize_command.hpp"
#include "decoder/cli/read_command.hpp"
#include "decoder/cli/report_command.hpp"
#include "decoder/cli/simulate_command.hpp"
#include "decoder/cli/verify_command.hpp"
#include "decoder/verify/proof.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/diff_command.hpp"
#include "tagsmith/cli/draw_command.hpp"
#include "tagsmith/cli/export_command.hpp"
#include "tagsmith/cli/new_command.hpp"
#include "tagsmith/cli/plan_command.hpp"
#include "tagsmith/cli/print_command.hpp"
#include "tagsmith/cli/validate_command.hpp"

namespace {

// Runs the command that was chosen. Results that never reached standard output are a failure.
int run(const tagsmith::Command& command) {
  const int exit_code = command.run();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  return tagsmith::report_failure(command.app->get_name(), {"standard output cannot be written"});
}

int run(int argc, char** argv) {
  CLI::App app{
      "tagsmith: position tags for mine tunnels, from the survey to the vehicle's position"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "tagsmith " TAGSMITH_VERSION);
  const std::vector<tagsmith::Command> commands{
      tagsmith::new_command(app),      tagsmith::validate_command(app),
      tagsmith::draw_command(app),     tagsmith::plan_command(app),
      tagsmith::export_command(app),   tagsmith::print_command(app, tagsmith::prove_pages),
      tagsmith::diff_command(app),     tagsmith::read_command(app),
      tagsmith::verify_command(app),   tagsmith::report_command(app),
      tagsmith::localize_command(app), tagsmith::simulate_command(app),
      tagsmith::demo_command(app),
  };
  if (const auto problem =
          tagsmith::unknown_command(commands, {argv + std::min(argc, 1), argv + argc});
      !problem.empty()) {
    std::fprintf(stderr, "tagsmith: %s\nRun with --help for the list.\n", problem.c_str());
    return tagsmith::kExitFailure;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? tagsmith::kExitOk : tagsmith::kExitFailure;
  }
  for (const tagsmith::Command& command : commands) {
    if (command.app->parsed()) return run(command);
  }
  return tagsmith::kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {  // what no library foresees, such as no memory left
    std::fprintf(stderr, "tagsmith: %s\n", error.what());
    return tagsmith::kExitFailure;
  }
}
