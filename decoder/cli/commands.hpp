// SPDX-License-Identifier: Apache-2.0
// The commands that read pictures, and the list of all commands.
#pragma once

#include <vector>

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command printer_command();
Command calibrate_command();
Command read_command();
Command verify_command();
Command report_command();
Command adjust_command();
Command localize_command();
Command simulate_command();
Command demo_command();

// Every command of the program, in the order of their list.
std::vector<Command> all_commands();

}  // namespace tagsmith::detail
