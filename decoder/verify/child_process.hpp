// SPDX-License-Identifier: Apache-2.0
// Runs another program without a shell.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct ProcessLimits {
  std::chrono::milliseconds time{60'000};  // wall time, then it is killed
  std::size_t output_bytes = 256U << 20U;  // of its standard output, then it is killed
};

struct ProcessOutput {
  int exit_code = 0;  // 128 + signal when one ended it
  std::string out;
  std::string err;  // its first 64 KiB
};

// Runs argv[0], looked for on the PATH, with standard input empty. Fails when it cannot be started
// ("NAME: not found" in the message) or exceeds a limit; its exit code is the caller's to judge.
Result<ProcessOutput> run_process(const std::vector<std::string>& argv,
                                  const ProcessLimits& limits = {});

}  // namespace tagsmith::detail
