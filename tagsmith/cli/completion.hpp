// SPDX-License-Identifier: Apache-2.0
// Completion at the prompt: the shells ask the program itself what may follow.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// What may stand in place of the last of these words, which follow the program's name: commands,
// options, choices, files of the kind that is asked for, and the names of the tags of the survey
// that stands before. Folders end with a slash.
std::vector<std::string> completions(std::span<const Command> commands,
                                     const std::vector<std::string>& words);

// The script that teaches a shell (bash, zsh or fish) to ask.
Result<std::string> completion_script(const std::string& shell);

}  // namespace tagsmith::detail
