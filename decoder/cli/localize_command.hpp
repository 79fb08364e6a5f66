// SPDX-License-Identifier: Apache-2.0
// `tagsmith localize`: the vehicle's position at each measurement of a run.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command localize_command(CLI::App& parent);

}  // namespace tagsmith
