// SPDX-License-Identifier: Apache-2.0
// `tagsmith verify`: print files and photos against the survey.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command verify_command();

}  // namespace tagsmith::detail
