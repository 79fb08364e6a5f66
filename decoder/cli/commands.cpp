// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/commands.hpp"

#include "decoder/verify/proof.hpp"
#include "tagsmith/cli/commands.hpp"

namespace tagsmith::detail {

std::vector<Command> all_commands() {
  return {
      new_command(),      validate_command(), draw_command(),
      plan_command(),     export_command(),   print_command(prove_pages),
      printer_command(),  board_command(),    calibrate_command(),
      diff_command(),     read_command(),     verify_command(),
      report_command(),   adjust_command(),   localize_command(),
      simulate_command(), demo_command(),
  };
}

}  // namespace tagsmith::detail
