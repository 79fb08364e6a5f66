// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/completion.hpp"

#include <algorithm>
#include <filesystem>

#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBash = R"(_tagsmith() {
  mapfile -t COMPREPLY < <("${COMP_WORDS[0]}" __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  [[ ${COMPREPLY[0]-} != */ ]] || compopt -o nospace
}
complete -F _tagsmith tagsmith
)";

constexpr const char* kZsh = R"(#compdef tagsmith
_tagsmith() {
  local -a answers folders others
  answers=("${(@f)$("${words[1]}" __complete "${(@)words[2,CURRENT]}" 2> /dev/null)}")
  folders=(${(M)answers:#*/})
  others=(${answers:#*/})
  compadd -Q -S '' -- $folders
  compadd -Q -- $others
}
compdef _tagsmith tagsmith
)";

constexpr const char* kFish = R"(function __tagsmith_complete
  set -l words (commandline -opc) (commandline -ct)
  $words[1] __complete $words[2..-1] 2> /dev/null
end
complete -c tagsmith -f -a '(__tagsmith_complete)'
)";

std::vector<std::string> extensions_of(ValueKind kind) {
  switch (kind) {
    case ValueKind::survey:
    case ValueKind::rig:
    case ValueKind::tag_template:
      return {".yaml", ".yml"};
    case ValueKind::table:
      return {".csv"};
    case ValueKind::json_lines:
      return {".jsonl", ".json"};
    case ValueKind::picture:
      return {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".heic", ".webp", ".bmp", ".pgm", ".ppm"};
    default:
      return {};
  }
}

// Files of the kind and folders whose names begin with `typed`.
std::vector<std::string> files_for(ValueKind kind, const std::string& typed) {
  const std::vector<std::string> extensions = extensions_of(kind);
  const std::string folder = typed.substr(0, typed.rfind('/') + 1);
  std::error_code ignored;
  std::vector<std::string> found;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    const std::string name = folder + entry.path().filename().string();
    if (!name.starts_with(typed) ||
        (entry.path().filename().string()[0] == '.' && typed == folder)) {
      continue;
    }
    if (entry.is_directory(ignored)) {
      found.push_back(name + "/");
    } else if (kind != ValueKind::folder &&
               (extensions.empty() ||
                std::ranges::count(extensions, entry.path().extension().string()) > 0)) {
      found.push_back(name);
    }
  }
  return found;
}

std::vector<std::string> tag_names(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (!word.ends_with(".yaml") && !word.ends_with(".yml")) continue;
    const Result<Survey> survey = load_survey(word);
    if (!survey) continue;
    std::vector<std::string> names;
    for (const PlacedTag& tag : survey->tags) names.push_back(tag.name);
    return names;
  }
  return {};
}

std::vector<std::string> that_start_with(const std::string& typed, std::vector<std::string> all) {
  std::erase_if(all, [&](const std::string& one) { return !one.starts_with(typed); });
  return all;
}

// The values of an option. Of several separated by commas only the last is incomplete.
std::vector<std::string> values_for(const CommandOption& option, const std::string& typed,
                                    const std::vector<std::string>& words) {
  const std::size_t before = option.by_commas ? typed.rfind(',') + 1 : 0;
  const std::string open = typed.substr(before);
  std::vector<std::string> values;
  if (!option.choices.empty()) {
    values = that_start_with(open, option.choices);
  } else if (option.kind == ValueKind::tag) {
    values = that_start_with(open, tag_names(words));
  } else if (option.kind != ValueKind::text) {
    values = files_for(option.kind, open);
  }
  for (std::string& value : values) value.insert(0, typed, 0, before);
  return values;
}

const CommandOption* option_named(const Command& command, const std::string& name) {
  for (const CommandOption& option : command.options) {
    const std::vector<std::string> names = option.all_names();
    if (!option.is_positional() && std::ranges::find(names, name) != names.end()) return &option;
  }
  return nullptr;
}

// The positional argument that comes after `given` others.
const CommandOption* positional(const Command& command, std::size_t given) {
  for (const CommandOption& option : command.options) {
    if (!option.is_positional()) continue;
    if (given == 0 || option.is_repeatable()) return &option;
    --given;
  }
  return nullptr;
}

std::vector<std::string> argument_completions(const Command& command,
                                              const std::vector<std::string>& words) {
  const std::string& typed = words.back();
  std::size_t positionals = 0;
  for (std::size_t i = 1; i + 1 < words.size(); ++i) {
    const CommandOption* option = option_named(command, words[i]);
    const bool takes_next = option != nullptr && !option->is_flag();
    if (takes_next && i + 2 == words.size()) return values_for(*option, typed, words);
    if (takes_next) ++i;
    if (option == nullptr && !words[i].starts_with('-')) ++positionals;
  }
  if (typed.starts_with('-')) {
    std::vector<std::string> names{"--help"};
    for (const CommandOption& option : command.options) {
      if (!option.is_positional()) names.push_back(option.all_names().back());
    }
    return that_start_with(typed, std::move(names));
  }
  const CommandOption* argument = positional(command, positionals);
  return argument == nullptr ? std::vector<std::string>() : values_for(*argument, typed, words);
}

}  // namespace

std::vector<std::string> completions(std::span<const Command> commands,
                                     const std::vector<std::string>& words) {
  if (words.empty()) return {};
  std::vector<std::string> found;
  if (words.size() == 1 || (words.front() == "help" && words.size() == 2)) {
    for (const Command& command : commands) found.push_back(command.name);
    if (words.size() == 1) found.insert(found.end(), {"help", "--help", "--version"});
    found = that_start_with(words.back(), std::move(found));
  } else if (const auto command = std::ranges::find(commands, words.front(), &Command::name);
             command != commands.end()) {
    found = argument_completions(*command, words);
  }
  std::ranges::sort(found);
  return found;
}

Result<std::string> completion_script(const std::string& shell) {
  if (shell == "bash") return kBash;
  if (shell == "zsh") return kZsh;
  if (shell == "fish") return kFish;
  return fail("found `" + shell + "`, expected bash, zsh or fish");
}

}  // namespace tagsmith::detail
