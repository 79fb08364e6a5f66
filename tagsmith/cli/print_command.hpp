// SPDX-License-Identifier: Apache-2.0
// `tagsmith print`: print-ready files of a survey's tags.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command print_command(CLI::App& parent);

}  // namespace tagsmith
