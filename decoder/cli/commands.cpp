// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/commands.hpp"

#include "decoder/cli/adjust_command.hpp"
#include "decoder/cli/calibrate_command.hpp"
#include "decoder/cli/demo_command.hpp"
#include "decoder/cli/localize_command.hpp"
#include "decoder/cli/printer_command.hpp"
#include "decoder/cli/read_command.hpp"
#include "decoder/cli/report_command.hpp"
#include "decoder/cli/simulate_command.hpp"
#include "decoder/cli/verify_command.hpp"
#include "decoder/verify/proof.hpp"
#include "tagsmith/cli/board_command.hpp"
#include "tagsmith/cli/diff_command.hpp"
#include "tagsmith/cli/draw_command.hpp"
#include "tagsmith/cli/export_command.hpp"
#include "tagsmith/cli/new_command.hpp"
#include "tagsmith/cli/plan_command.hpp"
#include "tagsmith/cli/print_command.hpp"
#include "tagsmith/cli/validate_command.hpp"

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
