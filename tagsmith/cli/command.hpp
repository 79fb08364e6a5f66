// SPDX-License-Identifier: Apache-2.0
// What every command of the program shares.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace CLI {
class App;
}

namespace tagsmith {

// Exit codes of the program.
inline constexpr int kExitOk = 0;        // all well
inline constexpr int kExitFindings = 1;  // the work was done and found faults
inline constexpr int kExitFailure = 2;   // wrong use or unreadable input; nothing was written

// A subcommand, and what runs when it was chosen. `run` returns the exit code.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

// Why `arguments`, those of the program, name none of the commands; empty when the first one does
// or is an option.
std::string unknown_command(const std::vector<Command>& commands,
                            const std::vector<std::string>& arguments);

// Prints `tagsmith COMMAND: message` to standard error, further lines of the message indented;
// returns kExitFailure.
int report_failure(const std::string& command, const Error& error);

// Prints `tagsmith COMMAND: sentence` for each of the assumptions (assumptions.hpp) to standard
// error.
void print_assumptions(const std::string& command, const std::vector<std::string>& assumed);

}  // namespace tagsmith
