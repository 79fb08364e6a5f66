// SPDX-License-Identifier: Apache-2.0
// `tagsmith verify`: print files and photos against the survey.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command verify_command(CLI::App& parent);

}  // namespace tagsmith
