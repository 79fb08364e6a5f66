// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/command.hpp"

#include <cstdio>

#include <fmt/core.h>

namespace tagsmith {

int report_failure(const std::string& command, const Error& error) {
  fmt::print(stderr, "tagsmith {}: {}\n", command, error.message);
  return kExitFailure;
}

}  // namespace tagsmith
