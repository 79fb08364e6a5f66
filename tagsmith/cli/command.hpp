// SPDX-License-Identifier: Apache-2.0
// A command of the program: its options and their help, as data. The parser (parse_command.hpp),
// the help and the man page (command_help.hpp) and the completion at the prompt (completion.hpp)
// all use the same data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// Exit codes of the program.
inline constexpr int kExitOk = 0;        // nothing is wrong
inline constexpr int kExitFindings = 1;  // the work was done and found faults
inline constexpr int kExitFailure = 2;   // wrong use or unreadable input; nothing was written

// What a value names: determines what the prompt offers to complete it.
enum class ValueKind {
  text,
  survey,
  rig,
  tag_template,
  table,
  picture,
  json_lines,
  tag,
  file,
  folder
};

// The variable that receives a value. A bool is a flag; a vector takes any number of values.
using ValueTarget =
    std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::filesystem::path*,
                 std::optional<double>*, std::vector<std::string>*,
                 std::vector<std::filesystem::path>*, std::function<void(double)>,
                 std::function<void(const std::string&)>>;

// An option of a command, or a positional argument where `names` has no dash.
struct CommandOption {
  std::string names;  // "-o,--output"; of a positional argument, its placeholder
  ValueTarget target;
  std::string help{};
  std::string placeholder{};  // of the value, in the help: FILE
  ValueKind kind = ValueKind::text;
  bool required = false;
  bool by_commas = false;              // several values in one word
  bool shows_default = false;          // the target's value now
  std::vector<std::string> choices{};  // the only values; empty = any
  std::optional<double> least{};       // of a number
  std::optional<double> greatest{};    // of a number
  bool odd = false;                    // of a number
  std::vector<std::string> needs{};    // names of other options
  std::vector<std::string> excludes{};

  bool is_positional() const { return !names.starts_with('-'); }
  bool is_flag() const { return std::holds_alternative<bool*>(target); }
  bool is_repeatable() const {
    return std::holds_alternative<std::vector<std::string>*>(target) ||
           std::holds_alternative<std::vector<std::filesystem::path>*>(target);
  }
  std::vector<std::string> all_names() const;  // {"-o", "--output"}
};

// A subcommand, and the function that runs it: `run` returns the exit code, or the error that
// prevented the work, which the program reports.
struct Command {
  std::string name;
  std::string summary;
  std::vector<CommandOption> options;
  std::string notes;  // below the options; indented lines stay as they are, others are wrapped
  std::function<Result<int>()> run;
};

// Prints `tagsmith COMMAND: message` to standard error, further lines of the message indented;
// returns kExitFailure.
int report_failure(const std::string& command, const Error& error);

// Prints `tagsmith COMMAND: sentence` for each of the assumptions (assumptions.hpp) to standard
// error.
void print_assumptions(const std::string& command, const std::vector<std::string>& assumed);

}  // namespace tagsmith::detail
