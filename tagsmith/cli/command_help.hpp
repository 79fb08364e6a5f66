// SPDX-License-Identifier: Apache-2.0
// The program's description of its commands: help for the terminal, and man pages.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/cli/command.hpp"

namespace tagsmith::detail {

// What the program is for, in a line.
inline constexpr const char* kProgramSummary =
    "position tags for mine tunnels, from the survey to the vehicle's position";

// The words of the text in lines of at most `columns` bytes; a longer word stays whole.
std::vector<std::string> wrapped_lines(const std::string& text, std::size_t columns);

// Columns of the terminal of standard output; otherwise the value of COLUMNS, otherwise 100.
std::size_t terminal_columns();

// The help of one command, at most this many columns wide where words allow it.
std::string command_help(const Command& command, std::size_t columns);

// The list of the commands.
std::string program_help(std::span<const Command> commands, std::size_t columns);

// The same as manual pages of section 1 (man-pages(7), groff_man(7)).
std::string command_man_page(const Command& command, const std::string& version);
std::string program_man_page(std::span<const Command> commands, const std::string& version);

}  // namespace tagsmith::detail
