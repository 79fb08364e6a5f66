// SPDX-License-Identifier: Apache-2.0
// --jobs, the same in every command.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tagsmith {

// Adds --jobs N, 0 to 1024. `what` begins its description: "Files read at once".
void add_jobs_option(CLI::App& app, int& jobs, const std::string& what);

}  // namespace tagsmith
