// SPDX-License-Identifier: Apache-2.0
// Runs what a Markdown document tells its reader to type.
#pragma once

#include <string>
#include <vector>

namespace tagsmith::detail::test {

// A fenced block: its lines, and what stands behind the opening fence.
struct Block {
  int line = 0;                    // of the opening fence
  std::string language;            // the first word: sh, text, yaml ...
  std::vector<std::string> words;  // the others: "exit=1", "file=mine/survey.yaml"
  std::vector<std::string> lines;
};

std::vector<Block> blocks_of(const std::string& markdown);

// The commands of a block that begin with `tagsmith`, with lines that end in a backslash joined.
std::vector<std::string> tagsmith_commands(const Block& block);

struct DocumentRun {
  int commands = 0;                   // how many were run
  std::vector<std::string> failures;  // where, what was found, what was expected
};

// Goes through the document in a temporary folder that holds `surveys`, a link to the project's:
// - a block with `file=PATH` is written to that file;
// - each tagsmith command of a `sh` block runs, expected to end with 0, or with N by `exit=N`;
// - each line of a `text` block must be a line of what the `sh` block before it printed, in that
//   order; `...` stands for any lines.
DocumentRun run_document(const std::string& markdown);

}  // namespace tagsmith::detail::test
