// SPDX-License-Identifier: Apache-2.0
// `tagsmith diff`: what becomes of the plates when a survey changes.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command diff_command();

}  // namespace tagsmith::detail
