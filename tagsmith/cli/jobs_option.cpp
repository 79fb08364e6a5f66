// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/jobs_option.hpp"

#include <CLI/CLI.hpp>

namespace tagsmith {

void add_jobs_option(CLI::App& app, int& jobs, const std::string& what) {
  app.add_option("--jobs", jobs, what + " (default 0: as many as there are cores)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
}

}  // namespace tagsmith
