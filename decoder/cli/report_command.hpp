// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// `tagsmith report`: one summary of any number of `verify --json` runs.
Command report_command();

}  // namespace tagsmith::detail
