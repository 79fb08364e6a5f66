// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// `tagsmith adjust`.
Command adjust_command();

}  // namespace tagsmith::detail
