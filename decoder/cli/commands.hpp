// SPDX-License-Identifier: Apache-2.0
// The list of commands.
#pragma once

#include <vector>

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// Every command of the program, in the order of their list.
std::vector<Command> all_commands();

}  // namespace tagsmith::detail
