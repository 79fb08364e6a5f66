// SPDX-License-Identifier: Apache-2.0
// `tagsmith plan`: what the cameras will see along the drive, and how well the vehicle will know
// its place.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command plan_command();

}  // namespace tagsmith::detail
