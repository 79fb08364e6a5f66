// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// tagsmith printer.
Command printer_command();

}  // namespace tagsmith::detail
