// SPDX-License-Identifier: Apache-2.0
// The front door: runs the command that was asked for.
#include <algorithm>
#include <exception>
#include <new>

#include "decoder/cli/commands.hpp"
#include "tagsmith/cli/commit.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/program.hpp"

using namespace tagsmith::detail;

int main(int argc, char** argv) {
  mute_libraries();
  try {
    return run_program(all_commands(), {TAGSMITH_VERSION, TAGSMITH_COMMIT},
                       {argv + std::min(argc, 1), argv + argc});
  } catch (const std::bad_alloc&) {
    to_stderr("tagsmith: the memory does not suffice; give fewer or smaller files at a time\n");
    return kExitFailure;
  } catch (const std::exception& error) {  // what no library foresees
    to_stderr("tagsmith: {}\n", error.what());
    return kExitFailure;
  }
}
