// SPDX-License-Identifier: Apache-2.0
// Completion at the prompt: the shells ask the program itself which words may follow.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// The possible completions of the last of these words, which follow the program's name: commands,
// options, choices, files of the requested kind, and the names of the tags of the survey that is
// given before. Folders end with a slash.
std::vector<std::string> completions(std::span<const Command> commands,
                                     const std::vector<std::string>& words);

// The script that makes a shell (bash, zsh or fish) use the completion.
Result<std::string> completion_script(const std::string& shell);

}  // namespace tagsmith::detail
