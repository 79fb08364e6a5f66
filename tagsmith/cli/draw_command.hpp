// SPDX-License-Identifier: Apache-2.0
// `tagsmith draw`: what a survey means, as a technical drawing.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command draw_command(CLI::App& parent);

}  // namespace tagsmith
