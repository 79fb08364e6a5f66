// SPDX-License-Identifier: Apache-2.0
// What the words behind the program's name request.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// What --version prints.
struct ProgramVersion {
  std::string number;  // 1.0.0
  std::string commit;  // that it was built from; empty = not known
};

// Runs the command that the arguments name, or prints the help, the version, a man page
// (`help --man [COMMAND]`) or a completion script (`completion SHELL`). Returns the exit code.
int run_program(const std::vector<Command>& commands, const ProgramVersion& version,
                const std::vector<std::string>& arguments);

}  // namespace tagsmith::detail
