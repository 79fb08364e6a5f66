// SPDX-License-Identifier: Apache-2.0
// `tagsmith demo`: the whole loop on the corridor that comes with the program.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command demo_command();

}  // namespace tagsmith::detail
