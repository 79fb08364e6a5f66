// SPDX-License-Identifier: Apache-2.0
// The list of commands.
#pragma once

#include <vector>

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

// Adds every command of the program. Each option takes one value each time it is given, so that
// what follows is a file again: `read --survey mine.yaml a.jpg b.jpg`.
std::vector<Command> add_commands(CLI::App& app);

}  // namespace tagsmith
