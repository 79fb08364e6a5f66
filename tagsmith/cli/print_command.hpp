// SPDX-License-Identifier: Apache-2.0
// `tagsmith print`: print-ready files of a survey's tags.
#pragma once

#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/print_proof.hpp"

namespace tagsmith::detail {

// `prove` is what --proof runs.
Command print_command(const ProvePages& prove);

}  // namespace tagsmith::detail
