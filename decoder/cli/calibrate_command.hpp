// SPDX-License-Identifier: Apache-2.0
// `tagsmith calibrate`: cameras that one can trust.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command calibrate_command();

}  // namespace tagsmith::detail
