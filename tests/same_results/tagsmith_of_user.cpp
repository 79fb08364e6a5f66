// SPDX-License-Identifier: Apache-2.0
// tagsmith in a process that has taken its user's language, as desktop programs do, whose numbers
// may have commas. The program itself never does.
#include <clocale>
#include <exception>
#include <iostream>
#include <locale>

#include "decoder/cli/commands.hpp"
#include "tagsmith/cli/program.hpp"

using namespace tagsmith::detail;

int main(int argc, char** argv) try {
  std::locale::global(std::locale(""));  // the C library's, too
  return run_program(all_commands(), {}, {argv + 1, argv + argc});
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 3;
}
