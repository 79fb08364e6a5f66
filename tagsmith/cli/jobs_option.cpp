// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/jobs_option.hpp"

namespace tagsmith::detail {

CommandOption jobs_option(int& jobs, const std::string& what) {
  return {.names = "--jobs",
          .target = &jobs,
          .help = what + " (default 0: as many as there are cores)",
          .placeholder = "N",
          .least = 0,
          .greatest = 1024};
}

}  // namespace tagsmith::detail
