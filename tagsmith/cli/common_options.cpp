// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/common_options.hpp"

namespace tagsmith::detail {

CommandOption required(CommandOption option) {
  option.required = true;
  return option;
}

CommandOption jobs_option(int& jobs, const std::string& what) {
  return {.names = "--jobs",
          .target = &jobs,
          .help = what + " (default 0: as many as there are cores)",
          .placeholder = "N",
          .least = 0,
          .greatest = 1024};
}

CommandOption json_flag(bool& json, const std::string& help) {
  return {.names = "--json", .target = &json, .help = help};
}

CommandOption survey_argument(const ValueTarget& target, const std::string& help) {
  return required({.names = "SURVEY", .target = target, .help = help, .kind = ValueKind::survey});
}

CommandOption rig_option(const ValueTarget& target, const std::string& help) {
  return {.names = "--rig",
          .target = target,
          .help = help,
          .placeholder = "RIG",
          .kind = ValueKind::rig};
}

CommandOption folder_option(const std::string& names, const ValueTarget& target,
                            const std::string& help) {
  return {.names = names,
          .target = target,
          .help = help,
          .placeholder = "DIR",
          .kind = ValueKind::folder};
}

CommandOption file_option(const std::string& names, const ValueTarget& target,
                          const std::string& help) {
  return {.names = names,
          .target = target,
          .help = help,
          .placeholder = "FILE",
          .kind = ValueKind::file};
}

std::vector<std::string> drawing_papers() { return {"a3", "a4", "letter"}; }

Paper paper_of(const std::string& name) {
  if (name == "letter") return Paper::letter;
  return name == "a4" ? Paper::a4 : Paper::a3;
}

}  // namespace tagsmith::detail
