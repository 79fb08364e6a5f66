// SPDX-License-Identifier: Apache-2.0
// Options that several commands have.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/cli/command.hpp"
#include "tagsmith/render/drawing_title.hpp"

namespace tagsmith::detail {

// The option, which must be given.
CommandOption required(CommandOption option);

// --jobs of a command that works on several things at once; `what` says on which. 0 means as many
// as there are cores.
CommandOption jobs_option(int& jobs, const std::string& what);

// --json.
CommandOption json_flag(bool& json, const std::string& help);

// The positional argument SURVEY, which must be given.
CommandOption survey_argument(const ValueTarget& target, const std::string& help);

// --rig RIG.
CommandOption rig_option(const ValueTarget& target, const std::string& help);

// An option whose value is a folder, or a file.
CommandOption folder_option(const std::string& names, const ValueTarget& target,
                            const std::string& help);
CommandOption file_option(const std::string& names, const ValueTarget& target,
                          const std::string& help);

// Papers of drawings, as options name them, and the paper of such a name.
std::vector<std::string> drawing_papers();
Paper paper_of(const std::string& name);

}  // namespace tagsmith::detail
