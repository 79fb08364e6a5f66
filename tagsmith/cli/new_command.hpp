// SPDX-License-Identifier: Apache-2.0
// `tagsmith new`: survey and rig files to begin with, from nothing or from surveyed points.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command new_command();

}  // namespace tagsmith::detail
