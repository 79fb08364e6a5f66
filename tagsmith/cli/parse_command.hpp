// SPDX-License-Identifier: Apache-2.0
// Words of a command line, parsed by CLI11: only this code uses that library.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

enum class Asked { run, help };

// Stores the arguments of the command in the targets of its options. An error names the option,
// what was found and what was expected, and the option that was probably meant.
Result<Asked> parse_command(const Command& command, const std::vector<std::string>& arguments);

}  // namespace tagsmith::detail
