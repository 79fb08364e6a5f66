// SPDX-License-Identifier: Apache-2.0
// The commands that survey and print. Their summaries say what each does.
#pragma once

#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/print_proof.hpp"

namespace tagsmith::detail {

Command new_command();
Command validate_command();
Command draw_command();
Command plan_command();
Command export_command();
Command print_command(const ProvePages& prove);  // `prove` is what --proof runs
Command board_command();
Command diff_command();

}  // namespace tagsmith::detail
