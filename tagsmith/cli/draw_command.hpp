// SPDX-License-Identifier: Apache-2.0
// `tagsmith draw`: what a survey means, as a technical drawing.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command draw_command();

}  // namespace tagsmith::detail
