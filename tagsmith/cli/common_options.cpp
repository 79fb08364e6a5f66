// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/common_options.hpp"

#include <algorithm>

namespace tagsmith::detail {

CommandOption flag(const std::string& names, const ValueTarget& target, const std::string& help) {
  return {.names = names, .target = target, .help = help};
}

CommandOption value_option(const std::string& names, const ValueTarget& target,
                           const std::string& placeholder, const std::string& help,
                           ValueKind kind) {
  return {.names = names, .target = target, .help = help, .placeholder = placeholder, .kind = kind};
}

CommandOption number_option(const std::string& names, const ValueTarget& target,
                            const std::string& placeholder, double least, double greatest,
                            const std::string& help) {
  CommandOption option = value_option(names, target, placeholder, help);
  option.least = least;
  option.greatest = greatest;
  return option;
}

CommandOption choice_option(const std::string& names, const ValueTarget& target,
                            const std::vector<std::string>& choices, const std::string& help) {
  return {.names = names, .target = target, .help = help, .choices = choices};
}

CommandOption argument(const std::string& name, const ValueTarget& target, ValueKind kind,
                       const std::string& help) {
  return {.names = name, .target = target, .help = help, .kind = kind};
}

CommandOption required(CommandOption option) {
  option.required = true;
  return option;
}

CommandOption with_default(CommandOption option) {
  option.shows_default = true;
  return option;
}

CommandOption by_commas(CommandOption option) {
  option.by_commas = true;
  return option;
}

CommandOption odd(CommandOption option) {
  option.odd = true;
  return option;
}

CommandOption needing(const std::vector<std::string>& others, CommandOption option) {
  option.needs = others;
  return option;
}

CommandOption excluding(const std::vector<std::string>& others, CommandOption option) {
  option.excludes = others;
  return option;
}

CommandOption jobs_option(int& jobs, const std::string& what) {
  return number_option("--jobs", &jobs, "N", 0, 1024,
                       what + " (default 0: as many as there are cores)");
}

CommandOption json_flag(bool& json, const std::string& help) { return flag("--json", &json, help); }

CommandOption survey_argument(const ValueTarget& target, const std::string& help) {
  return required(argument("SURVEY", target, ValueKind::survey, help));
}

CommandOption rig_option(const ValueTarget& target, const std::string& help) {
  return value_option("--rig", target, "RIG", help, ValueKind::rig);
}

CommandOption folder_option(const std::string& names, const ValueTarget& target,
                            const std::string& help) {
  return value_option(names, target, "DIR", help, ValueKind::folder);
}

CommandOption file_option(const std::string& names, const ValueTarget& target,
                          const std::string& help) {
  return value_option(names, target, "FILE", help, ValueKind::file);
}

CommandOption drawing_paper_option(const std::string& names, Paper& paper,
                                   const std::string& help) {
  const auto choose = [&paper](const std::string& name) {
    paper = name == "a3" ? Paper::a3 : name == "a4" ? Paper::a4 : Paper::letter;
  };
  return choice_option(names, choose, {"a3", "a4", "letter"}, help);
}

Result<void> none_of(const std::vector<WrongUse>& uses) {
  const auto wrong = std::ranges::find(uses, true, &WrongUse::is_so);
  return wrong == uses.end() ? Result<void>{} : fail(wrong->message);
}

std::vector<CommandOption> joined(std::initializer_list<std::vector<CommandOption>> groups) {
  std::vector<CommandOption> all;
  for (const auto& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace tagsmith::detail
