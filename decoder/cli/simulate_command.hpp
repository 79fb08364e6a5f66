// SPDX-License-Identifier: Apache-2.0
// `tagsmith simulate`: what the cameras would see.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command simulate_command();

}  // namespace tagsmith::detail
