// SPDX-License-Identifier: Apache-2.0
// `tagsmith validate`: every problem of surveys, rigs and templates in one go.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command validate_command(CLI::App& parent);

}  // namespace tagsmith
