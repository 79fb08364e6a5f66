// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// --jobs of a command that works on several things at once; `what` says on which. 0 means as many
// as there are cores.
CommandOption jobs_option(int& jobs, const std::string& what);

}  // namespace tagsmith::detail
