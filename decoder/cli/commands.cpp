// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/commands.hpp"

#include <CLI/CLI.hpp>

#include "decoder/cli/demo_command.hpp"
#include "decoder/cli/localize_command.hpp"
#include "decoder/cli/read_command.hpp"
#include "decoder/cli/report_command.hpp"
#include "decoder/cli/simulate_command.hpp"
#include "decoder/cli/verify_command.hpp"
#include "decoder/verify/proof.hpp"
#include "tagsmith/cli/diff_command.hpp"
#include "tagsmith/cli/draw_command.hpp"
#include "tagsmith/cli/export_command.hpp"
#include "tagsmith/cli/new_command.hpp"
#include "tagsmith/cli/plan_command.hpp"
#include "tagsmith/cli/print_command.hpp"
#include "tagsmith/cli/validate_command.hpp"

namespace tagsmith {

std::vector<Command> add_commands(CLI::App& app) {
  std::vector<Command> commands{
      new_command(app),    validate_command(app), draw_command(app),
      plan_command(app),   export_command(app),   print_command(app, prove_pages),
      diff_command(app),   read_command(app),     verify_command(app),
      report_command(app), localize_command(app), simulate_command(app),
      demo_command(app),
  };
  for (const Command& command : commands) {
    for (CLI::Option* option : command.app->get_options()) {
      if (option->nonpositional()) option->allow_extra_args(false);
    }
  }
  return commands;
}

}  // namespace tagsmith
