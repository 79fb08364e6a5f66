// SPDX-License-Identifier: Apache-2.0
// `tagsmith read`: decodes the tags in pictures.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith {

Command read_command(CLI::App& parent);

}  // namespace tagsmith
