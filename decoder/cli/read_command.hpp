// SPDX-License-Identifier: Apache-2.0
// `tagsmith read`: decodes the tags in pictures.
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

Command read_command();

}  // namespace tagsmith::detail
