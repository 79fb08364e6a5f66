// SPDX-License-Identifier: Apache-2.0
#include "tests/readme/documents.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The value of the word `NAME=value`; empty when there is none.
std::string value_of(const Block& block, const std::string& name) {
  for (const std::string& word : block.words) {
    if (word.starts_with(name + "=")) return word.substr(name.size() + 1);
  }
  return {};
}

std::string place(const Block& block) { return "line " + std::to_string(block.line) + ": "; }

void write_block(const Block& block, const fs::path& file) {
  fs::create_directories(file.parent_path());
  std::ofstream stream(file);
  for (const std::string& line : block.lines) stream << line << '\n';
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

// A folder as the reader has it: the surveys, and the program on the PATH.
void furnish(const fs::path& folder) {
  const char* program = std::getenv("TAGSMITH_PROGRAM");
  if (program == nullptr) {
    throw std::runtime_error("TAGSMITH_PROGRAM must name the executable under test");
  }
  fs::create_directory(folder / "bin");
  fs::create_symlink(fs::absolute(program), folder / "bin" / "tagsmith");
  fs::create_directory_symlink(fs::absolute("surveys"), folder / "surveys");
}

// What the block's commands print; failures are added to the run.
std::string run_block(const Block& block, const fs::path& folder, DocumentRun& run) {
  const std::string expected_text = value_of(block, "exit");
  const int expected = expected_text.empty() ? 0 : std::stoi(expected_text);
  std::string printed;
  for (const std::string& command : tagsmith_commands(block)) {
    const ProgramOutput output = run_shell("cd '" + folder.string() + "' && PATH='" +
                                           (folder / "bin").string() + "':\"$PATH\"; " + command);
    ++run.commands;
    printed += output.out + output.err;
    if (output.exit_code == expected) continue;
    run.failures.push_back(place(block) + command + "\nends with " +
                           std::to_string(output.exit_code) + ", expected " +
                           std::to_string(expected) + "\n" + output.err);
  }
  return printed;
}

void compare(const Block& block, const std::string& printed, DocumentRun& run) {
  const std::vector<std::string> found = lines_of(printed);
  auto from = found.begin();
  for (const std::string& line : block.lines) {
    if (line == "...") continue;
    const auto place_found = std::find(from, found.end(), line);
    if (place_found == found.end()) {
      run.failures.push_back(place(block) + "the program no longer prints, here:\n" + line +
                             "\nfound:\n" + printed);
      return;
    }
    from = place_found + 1;
  }
}

}  // namespace

std::vector<Block> blocks_of(const std::string& markdown) {
  const std::string fence = "```";
  std::vector<Block> blocks;
  bool is_open = false;
  int number = 0;
  for (const std::string& line : lines_of(markdown)) {
    ++number;
    if (!line.starts_with(fence)) {
      if (is_open) blocks.back().lines.push_back(line);
      continue;
    }
    is_open = !is_open;
    if (!is_open) continue;
    Block block;
    block.line = number;
    std::istringstream words(line.substr(fence.size()));
    words >> block.language;
    for (std::string word; words >> word;) block.words.push_back(word);
    blocks.push_back(block);
  }
  return blocks;
}

std::vector<std::string> tagsmith_commands(const Block& block) {
  std::vector<std::string> commands;
  std::string command;
  for (const std::string& line : block.lines) {
    command += line;
    if (command.ends_with('\\')) {
      command.pop_back();
      continue;
    }
    if (command.starts_with("tagsmith ")) commands.push_back(command);
    command.clear();
  }
  return commands;
}

DocumentRun run_document(const std::string& markdown) {
  const TemporaryFolder folder;
  furnish(folder.path());
  DocumentRun run;
  std::string printed;
  for (const Block& block : blocks_of(markdown)) {
    const std::string file = value_of(block, "file");
    if (!file.empty()) write_block(block, folder.path() / file);
    if (block.language == "sh") printed = run_block(block, folder.path(), run);
    if (block.language == "text") compare(block, printed, run);
  }
  return run;
}

}  // namespace tagsmith::detail::test
