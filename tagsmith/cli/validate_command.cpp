// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/validate_command.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/rig.hpp"

namespace tagsmith {
namespace {

struct ValidateOptions {
  std::vector<std::string> surveys;
  std::vector<std::string> rigs;
  std::vector<std::string> templates;
  bool json = false;
};

struct Findings {
  std::vector<Diagnostic> diagnostics;
  std::vector<Error> unreadable;
};

// Takes over what a reading found; false when the file could not be read at all.
template <class Reading>
bool collect(const Result<Reading>& reading, Findings& findings) {
  if (!reading) {
    findings.unreadable.push_back(reading.error());
    return false;
  }
  findings.diagnostics.insert(findings.diagnostics.end(), reading->diagnostics.begin(),
                              reading->diagnostics.end());
  return true;
}

Findings validate(const ValidateOptions& options) {
  Findings findings;
  std::vector<Survey> surveys;
  for (const std::string& path : options.surveys) {
    Result<SurveyReading> reading = read_survey(path);
    if (collect(reading, findings) && reading->survey) {
      surveys.push_back(std::move(*reading->survey));
    }
  }
  const std::vector<Diagnostic> together = check_together(surveys);
  findings.diagnostics.insert(findings.diagnostics.end(), together.begin(), together.end());
  for (const std::string& path : options.rigs) collect(read_rig(path), findings);
  for (const std::string& path : options.templates) collect(read_template(path), findings);
  return findings;
}

std::string json_line(const Diagnostic& diagnostic) {
  nlohmann::ordered_json line;
  line["file"] = diagnostic.file;
  line["line"] = diagnostic.line;
  line["column"] = diagnostic.column;
  line["severity"] = to_string(diagnostic.severity);
  line["code"] = diagnostic.code;
  line["message"] = diagnostic.message;
  line["hint"] = diagnostic.hint;
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

int report(const Findings& findings, const ValidateOptions& options) {
  for (const Diagnostic& diagnostic : findings.diagnostics) {
    fmt::print("{}\n", options.json ? json_line(diagnostic) : to_string(diagnostic));
  }
  std::fflush(stdout);  // findings before what is said about them
  for (const Error& error : findings.unreadable) report_failure("validate", error);
  const auto errors = static_cast<std::size_t>(
      std::ranges::count(findings.diagnostics, Severity::error, &Diagnostic::severity));
  const std::size_t files = options.surveys.size() + options.rigs.size() + options.templates.size();
  fmt::print(stderr, "{}: {}, {}{}\n", counted(files, "file"), counted(errors, "error"),
             counted(findings.diagnostics.size() - errors, "warning"),
             findings.unreadable.empty()
                 ? ""
                 : fmt::format(", {} unreadable", findings.unreadable.size()));
  if (!findings.unreadable.empty()) return kExitFailure;
  return errors > 0 ? kExitFindings : kExitOk;
}

}  // namespace

Command validate_command(CLI::App& parent) {
  CLI::App* app = parent.add_subcommand(
      "validate", "Every problem of surveys, rigs and templates in one go, and how to mend it");
  const auto options = std::make_shared<ValidateOptions>();
  app->add_option("SURVEY", options->surveys,
                  "Survey files (YAML); several are checked against each other too");
  app->add_option("--rig", options->rigs, "Rig file to check as well; repeatable")
      ->take_all()
      ->expected(1);
  app->add_option("--template", options->templates, "Template file to check as well; repeatable")
      ->take_all()
      ->expected(1);
  app->add_flag("--json", options->json, "One JSON object a line for each finding");
  app->footer(
      "Example:\n"
      "  tagsmith validate surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml\n"
      "Exit code: 0 no errors, 1 errors found, 2 a file cannot be read.");
  return {app, [options] {
            if (options->surveys.empty() && options->rigs.empty() && options->templates.empty()) {
              return report_failure("validate",
                                    {"no files given, expected SURVEY, --rig or --template"});
            }
            return report(validate(*options), *options);
          }};
}

}  // namespace tagsmith
