// SPDX-License-Identifier: Apache-2.0
// `tagsmith diff`: what becomes of the plates when a survey changes.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command diff_command(CLI::App& parent);

}  // namespace tagsmith
