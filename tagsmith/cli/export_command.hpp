// SPDX-License-Identifier: Apache-2.0
// `tagsmith export`: a survey's tags for other programs.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command export_command();

}  // namespace tagsmith::detail
