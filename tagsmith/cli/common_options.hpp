// SPDX-License-Identifier: Apache-2.0
// Options that several commands have.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/render/drawing_title.hpp"

namespace tagsmith::detail {

// An option without a value, and one whose value the help calls by its placeholder.
CommandOption flag(const std::string& names, const ValueTarget& target, const std::string& help);
CommandOption value_option(const std::string& names, const ValueTarget& target,
                           const std::string& placeholder, const std::string& help,
                           ValueKind kind = ValueKind::text);

// An option whose value is a number between two, or one of some words.
CommandOption number_option(const std::string& names, const ValueTarget& target,
                            const std::string& placeholder, double least, double greatest,
                            const std::string& help);
CommandOption choice_option(const std::string& names, const ValueTarget& target,
                            const std::vector<std::string>& choices, const std::string& help);

// A positional argument.
CommandOption argument(const std::string& name, const ValueTarget& target, ValueKind kind,
                       const std::string& help);

// The option, which must be given; which is shown with the value that its target has now; whose
// values may be separated by commas; whose number is odd; which needs or excludes others.
CommandOption required(CommandOption option);
CommandOption with_default(CommandOption option);
CommandOption by_commas(CommandOption option);
CommandOption odd(CommandOption option);
CommandOption needing(const std::vector<std::string>& others, CommandOption option);
CommandOption excluding(const std::vector<std::string>& others, CommandOption option);

// --jobs of a command that works on several items at once; `what` names them. 0 means as many as
// there are cores.
CommandOption jobs_option(int& jobs, const std::string& what);

// --json.
CommandOption json_flag(bool& json, const std::string& help);

// The positional argument SURVEY, which must be given.
CommandOption survey_argument(const ValueTarget& target, const std::string& help);

// --rig RIG.
CommandOption rig_option(const ValueTarget& target, const std::string& help);

// An option whose value is a folder, or a file.
CommandOption folder_option(const std::string& names, const ValueTarget& target,
                            const std::string& help);
CommandOption file_option(const std::string& names, const ValueTarget& target,
                          const std::string& help);

// An option whose value is the paper of a drawing.
CommandOption drawing_paper_option(const std::string& names, Paper& paper, const std::string& help);

// Uses of options that exclude each other, or lack one: fails with the message of the first that is
// so.
struct WrongUse {
  bool is_so;
  std::string message;
};
Result<void> none_of(const std::vector<WrongUse>& uses);

// The options of all groups, one group after the other.
std::vector<CommandOption> joined(std::initializer_list<std::vector<CommandOption>> groups);

}  // namespace tagsmith::detail
