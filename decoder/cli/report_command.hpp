// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

// `tagsmith report`: one summary of any number of `verify --json` runs.
Command report_command(CLI::App& parent);

}  // namespace tagsmith
