// SPDX-License-Identifier: Apache-2.0
// `tagsmith localize`: the vehicle's position at each measurement of a run.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command localize_command();

}  // namespace tagsmith::detail
