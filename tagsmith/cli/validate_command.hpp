// SPDX-License-Identifier: Apache-2.0
// `tagsmith validate`: every problem of surveys, rigs and templates in one go.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command validate_command();

}  // namespace tagsmith::detail
