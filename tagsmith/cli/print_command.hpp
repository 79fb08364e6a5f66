// SPDX-License-Identifier: Apache-2.0
// `tagsmith print`: print-ready files of a survey's tags.
#pragma once

#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/print_proof.hpp"

namespace tagsmith {

// `prove` is what --proof runs.
Command print_command(CLI::App& parent, const ProvePages& prove);

}  // namespace tagsmith
