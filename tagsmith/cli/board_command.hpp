// SPDX-License-Identifier: Apache-2.0
// `tagsmith board`: a sheet of tags to calibrate cameras by.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command board_command();

}  // namespace tagsmith::detail
