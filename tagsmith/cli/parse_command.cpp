// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/parse_command.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

template <class Target>
constexpr bool kTakesNumber =
    std::is_same_v<Target, int*> || std::is_same_v<Target, std::uint64_t*> ||
    std::is_same_v<Target, double*> || std::is_same_v<Target, std::optional<double>*> ||
    std::is_same_v<Target, std::function<void(double)>>;

bool is_whole(const CommandOption& option) {
  return std::holds_alternative<int*>(option.target) ||
         std::holds_alternative<std::uint64_t*>(option.target);
}

// The limits of a number that has no limits of its own.
constexpr double kGreatest = std::numeric_limits<int>::max();

std::string expected_number(const CommandOption& option) {
  const char* kind = option.odd         ? "an odd number"
                     : is_whole(option) ? "a whole number"
                                        : "a number";
  return fmt::format("{} from {} to {}", kind, format_number(option.least.value_or(-kGreatest)),
                     format_number(option.greatest.value_or(kGreatest)));
}

// What is wrong with one value; empty when nothing is.
std::string problem_of_value(const CommandOption& option, const std::string& text) {
  if (!option.choices.empty()) {
    if (std::ranges::find(option.choices, text) != option.choices.end()) return {};
    return fmt::format("found `{}`, expected {}", text, fmt::join(option.choices, " or "));
  }
  if (text.empty()) {
    return "is empty, expected " + (option.placeholder.empty() ? "a value" : option.placeholder);
  }
  const bool takes_number =
      std::visit([](const auto& target) { return kTakesNumber<std::decay_t<decltype(target)>>; },
                 option.target);
  if (!takes_number) return {};
  const std::optional<double> value = parse_number(text);
  const bool fits = value && *value >= option.least.value_or(-kGreatest) &&
                    *value <= option.greatest.value_or(kGreatest) &&
                    (!is_whole(option) || *value == std::floor(*value)) &&
                    (!option.odd || std::fmod(*value, 2) == 1);
  return fits ? "" : fmt::format("found `{}`, expected {}", text, expected_number(option));
}

// Stores checked values in the option's target.
struct Assign {
  const std::vector<std::string>& values;

  double number() const { return *parse_number(values.back()); }
  void operator()(bool* target) const { *target = true; }
  void operator()(int* target) const { *target = static_cast<int>(number()); }
  void operator()(std::uint64_t* target) const { *target = static_cast<std::uint64_t>(number()); }
  void operator()(double* target) const { *target = number(); }
  void operator()(std::optional<double>* target) const { *target = number(); }
  void operator()(std::string* target) const { *target = values.back(); }
  void operator()(std::filesystem::path* target) const { *target = values.back(); }
  void operator()(std::vector<std::string>* target) const { *target = values; }
  void operator()(std::vector<std::filesystem::path>* target) const {
    target->assign(values.begin(), values.end());
  }
  void operator()(const std::function<void(double)>& target) const { target(number()); }
  void operator()(const std::function<void(const std::string&)>& target) const {
    target(values.back());
  }
};

std::vector<std::string> separated(const CommandOption& option,
                                   const std::vector<std::string>& words) {
  if (!option.by_commas) return words;
  std::vector<std::string> values;
  for (const std::string& word : words) {
    for (std::string& value : split(word, ',')) values.push_back(std::move(value));
  }
  return values;
}

// Checks and stores the values of one option; CLI::ValidationError when one is wrong.
bool take(const CommandOption& option, const std::vector<std::string>& words) {
  if (words.size() > 1 && !option.is_repeatable()) {
    throw CLI::ValidationError(option.all_names().back(), "given twice, it takes one value");
  }
  const std::vector<std::string> values = separated(option, words);
  for (const std::string& value : values) {
    if (const std::string problem = problem_of_value(option, value); !problem.empty()) {
      throw CLI::ValidationError(option.all_names().back(), problem);
    }
  }
  std::visit(Assign{values}, option.target);
  return true;
}

void add_option(CLI::App& app, const CommandOption& option) {
  CLI::Option* added = nullptr;
  if (option.is_flag()) {
    added = app.add_flag_function(option.names, [&option](std::int64_t given) {
      // CLI11 gives what stands behind "=", less than 1 for "false".
      if (given < 1) throw CLI::ValidationError(option.all_names().back(), "takes no value");
      take(option, {});
    });
  } else {
    added = app.add_option(option.names,
                           [&option](const CLI::results_t& words) { return take(option, words); });
    const bool takes_all = option.is_repeatable() || !option.is_positional();
    added->type_size(1)->expected(1, takes_all ? CLI::detail::expected_max_vector_size : 1);
    added->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    added->allow_extra_args(option.is_positional() && option.is_repeatable());
  }
  added->required(option.required);
}

void add_options(CLI::App& app, const Command& command) {
  for (const CommandOption& option : command.options) add_option(app, option);
  for (const CommandOption& option : command.options) {
    CLI::Option* added = app.get_option(option.all_names().back());
    for (const std::string& other : option.needs) added->needs(app.get_option(other));
    for (const std::string& other : option.excludes) added->excludes(app.get_option(other));
  }
}

// What no option took. CLI11 keeps there, too, the `--` behind which all words are arguments.
std::vector<std::string> unknown_words(const CLI::App& app) {
  std::vector<std::string> words = app.remaining();
  std::erase(words, "--");
  return words;
}

// The option that was probably meant by an unknown word.
std::string problem_of_unknown(const Command& command, const std::string& word) {
  if (!word.starts_with('-')) return fmt::format("found `{}`, which no argument takes", word);
  std::vector<std::string> names{"--help"};
  for (const CommandOption& option : command.options) {
    if (option.is_positional()) continue;
    for (std::string& name : option.all_names()) names.push_back(std::move(name));
  }
  std::error_code ignored;
  if (std::filesystem::exists(word, ignored)) {
    return fmt::format("no option `{0}`; the file of that name is `./{0}`", word);
  }
  const auto near = nearest_word(word.substr(0, word.find('=')), names);
  return fmt::format("no option `{}`{}", word, near ? ", did you mean `" + *near + "`?" : "");
}

}  // namespace

Result<Asked> parse_command(const Command& command, const std::vector<std::string>& arguments) {
  CLI::App app;
  app.allow_extras();
  try {
    add_options(app, command);
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    return Asked::help;
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string_view words = error.what();
    return fail(fmt::format("{} needs a value", words.substr(0, words.find(':'))));
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> unknown = unknown_words(app);
    return fail(unknown.empty() ? error.what() : problem_of_unknown(command, unknown.front()));
  }
  const std::vector<std::string> unknown = unknown_words(app);
  if (!unknown.empty()) return fail(problem_of_unknown(command, unknown.front()));
  return Asked::run;
}

}  // namespace tagsmith::detail
