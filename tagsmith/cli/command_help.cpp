// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/command_help.hpp"

#include <cstdlib>
#include <type_traits>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kTextColumn = 28;  // where the explanation of an option begins

// The text in lines of at most `columns`, all but the first indented.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns) {
  const std::string line_end = "\n" + std::string(indent, ' ');
  return fmt::format("{}", fmt::join(wrapped_lines(text, columns - indent), line_end));
}

// Paragraphs are wrapped; indented and empty lines stay as they are.
std::string wrapped_notes(const std::string& notes, std::size_t columns) {
  std::string result;
  std::string paragraph;
  const auto flush = [&] {
    if (!paragraph.empty()) result += wrapped(paragraph, 0, columns) + "\n";
    paragraph.clear();
  };
  for (const std::string& line : split(notes, '\n')) {
    if (!line.empty() && line.front() != ' ') {
      paragraph += (paragraph.empty() ? "" : " ") + line;
      if (line.back() == ':') flush();
    } else {
      flush();
      result += line + "\n";
    }
  }
  flush();
  return result;
}

// The value of an option's target as it is before any argument; empty where it has no text.
std::string value_now(const CommandOption& option) {
  return std::visit(
      [](const auto& target) -> std::string {
        using Target = std::decay_t<decltype(target)>;
        if constexpr (std::is_same_v<Target, std::string*>) {
          return *target;
        } else if constexpr (std::is_same_v<Target, double*>) {
          return format_number(*target);
        } else if constexpr (std::is_same_v<Target, int*> ||
                             std::is_same_v<Target, std::uint64_t*>) {
          return std::to_string(*target);
        } else {
          return {};
        }
      },
      option.target);
}

// The placeholder of the option's value: FILE, or its choices.
std::string value_text(const CommandOption& option) {
  if (option.is_flag()) return {};
  if (option.is_positional()) return option.names + (option.is_repeatable() ? "..." : "");
  if (!option.placeholder.empty()) return option.placeholder;
  if (option.choices.empty()) return "VALUE";
  return fmt::format("{}{}", fmt::join(option.choices, "|"), option.by_commas ? ",..." : "");
}

std::string names_text(const CommandOption& option) {
  if (option.is_positional()) return value_text(option);
  const std::string value = value_text(option);
  return fmt::format("{}{}{}", fmt::join(option.all_names(), ", "), value.empty() ? "" : " ",
                     value);
}

std::string explanation(const CommandOption& option) {
  std::vector<std::string> remarks;
  const std::string usual = option.shows_default ? value_now(option) : std::string();
  if (!usual.empty()) remarks.push_back("default: " + usual);
  if (option.required && !option.is_positional()) remarks.push_back("required");
  if (option.is_repeatable() && !option.is_positional() && !option.by_commas) {
    remarks.push_back("repeatable");
  }
  for (const std::string& other : option.needs) remarks.push_back("with " + other);
  for (const std::string& other : option.excludes) remarks.push_back("not with " + other);
  if (remarks.empty()) return option.help;
  return fmt::format("{} ({})", option.help, fmt::join(remarks, "; "));
}

std::string entry(const std::string& names, const std::string& text, std::size_t columns) {
  std::string line = "  " + names;
  if (line.size() + 2 > kTextColumn) {
    line += "\n" + std::string(kTextColumn, ' ');
  } else {
    line.resize(kTextColumn, ' ');
  }
  return line + wrapped(text, kTextColumn, columns) + "\n";
}

std::string usage(const Command& command) {
  std::string text = "tagsmith " + command.name;
  for (const CommandOption& option : command.options) {
    if (option.required && !option.is_positional()) {
      text += " " + option.all_names().front() + " " + value_text(option);
    }
  }
  text += " [OPTION]...";
  for (const CommandOption& option : command.options) {
    if (!option.is_positional()) continue;
    text += option.required ? " " + value_text(option) : " [" + value_text(option) + "]";
  }
  return text;
}

// Text of a man page: backslashes and dashes kept, and no line that is read as a request.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) {
      result += std::string("\\&") + c;
    } else {
      result += c;
    }
  }
  return result;
}

std::string man_head(const std::string& name, const std::string& summary,
                     const std::string& version) {
  return fmt::format(".TH {} 1 \"\" \"tagsmith {}\" \"tagsmith manual\"\n.SH NAME\n{} \\- {}\n",
                     roff(upper_case(name)), version, roff(name), roff(summary));
}

std::string man_notes(const std::string& notes) {
  std::string result;
  bool verbatim = false;
  for (const std::string& line : split(notes, '\n')) {
    const bool indented = line.starts_with(' ');
    if (indented != verbatim) result += indented ? ".PP\n.EX\n" : ".EE\n.PP\n";
    verbatim = indented;
    if (line.empty()) {
      result += ".PP\n";
    } else {
      result += roff(indented ? line.substr(2) : line) + "\n";
    }
  }
  return result + (verbatim ? ".EE\n" : "");
}

}  // namespace

std::vector<std::string> wrapped_lines(const std::string& text, std::size_t columns) {
  std::vector<std::string> lines;
  for (const std::string& word : split_words(text)) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > columns) {
      lines.push_back(word);
    } else {
      lines.back() += " " + word;
    }
  }
  return lines;
}

std::size_t terminal_columns() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  const auto stated = parse_integer(columns == nullptr ? "" : columns);
  return stated && *stated >= 40 ? static_cast<std::size_t>(*stated) : 100;
}

std::string command_help(const Command& command, std::size_t columns) {
  std::string text = wrapped(command.summary, 0, columns) +
                     "\n\nUsage: " + wrapped(usage(command), 7, columns) + "\n\n";
  for (const CommandOption& option : command.options) {
    if (option.is_positional()) text += entry(names_text(option), explanation(option), columns);
  }
  text += "\nOptions:\n";
  for (const CommandOption& option : command.options) {
    if (!option.is_positional()) text += entry(names_text(option), explanation(option), columns);
  }
  text += entry("-h, --help", "This text", columns);
  return text + (command.notes.empty() ? "" : "\n" + wrapped_notes(command.notes, columns));
}

std::string program_help(std::span<const Command> commands, std::size_t columns) {
  std::string text = fmt::format(
      "tagsmith: {}\n\nUsage: tagsmith COMMAND [ARGUMENT]...\n\nCommands:\n", kProgramSummary);
  for (const Command& command : commands) text += entry(command.name, command.summary, columns);
  text += "\nOptions:\n" + entry("-h, --help", "This text", columns) +
          entry("--version", "Version, commit and licence", columns);
  return text + "\n`tagsmith help COMMAND` tells a command's options.\n";
}

std::string command_man_page(const Command& command, const std::string& version) {
  std::string page = man_head("tagsmith-" + command.name, command.summary, version);
  page += ".SH SYNOPSIS\n.B " + roff(usage(command)) + "\n.SH OPTIONS\n";
  for (const CommandOption& option : command.options) {
    page += ".TP\n.B " + roff(names_text(option)) + "\n" + roff(explanation(option)) + "\n";
  }
  page += ".TP\n.B \\-h, \\-\\-help\nThe options in short.\n";
  if (!command.notes.empty()) page += ".SH NOTES\n" + man_notes(command.notes);
  return page + ".SH SEE ALSO\n.BR tagsmith (1)\n";
}

std::string program_man_page(std::span<const Command> commands, const std::string& version) {
  std::string page = man_head("tagsmith", kProgramSummary, version);
  page += ".SH SYNOPSIS\n.B tagsmith\n.I COMMAND\n[ARGUMENT]...\n.SH COMMANDS\n";
  for (const Command& command : commands) {
    page += ".TP\n.BR tagsmith\\-" + roff(command.name) + " (1)\n" + roff(command.summary) + "\n";
  }
  page +=
      ".SH EXIT STATUS\n0 all is well; 1 the work was done and found faults; 2 wrong use or "
      "unreadable input, and nothing was written.\n.SH SEE ALSO\n";
  for (const Command& command : commands) page += ".BR tagsmith\\-" + roff(command.name) + " (1)\n";
  return page;
}

}  // namespace tagsmith::detail
