// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/apply_fixes.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/source_excerpt.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/unseen_tags.hpp"
#include "tagsmith/render/logo.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/check_together.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/rules.hpp"

namespace tagsmith::detail {
namespace {

struct ValidateOptions {
  std::vector<std::string> surveys;
  std::vector<std::string> rigs;
  std::vector<std::string> templates;
  std::string explain;  // a rule
  bool list_rules = false;
  bool fix = false;
  bool json = false;
};

struct Findings {
  std::vector<Diagnostic> diagnostics;
  std::vector<Error> unreadable;
  std::vector<std::string> assumed;  // what surveys and rigs do not state of their uncertainty

  void add(const std::vector<Diagnostic>& more) {
    diagnostics.insert(diagnostics.end(), more.begin(), more.end());
  }
};

// Adds the findings of a file; false when the file could not be read at all.
template <class T>
bool collect(const Result<Diagnosed<T>>& reading, Findings& findings) {
  if (!reading) {
    findings.unreadable.push_back(reading.error());
    return false;
  }
  findings.add(reading->diagnostics);
  return true;
}

// A logo that exists and cannot be drawn: print would stop at it.
void check_logo(const TagTemplate& tag, Findings& findings) {
  std::error_code absent;
  const LogoStyle& logo = tag.logo;
  if (logo.file.empty() || !std::filesystem::exists(logo.file, absent)) return;
  const Result<LogoDrawing> drawn = load_logo(logo.file, logo.width, logo.height);
  if (drawn) return;
  Diagnostic finding;
  finding.file = tag.file.string();
  finding.code = "no-logo";
  finding.message = drawn.error().message;
  finding.hint = "save the logo as a plain SVG file";
  findings.diagnostics.push_back(std::move(finding));
}

std::string unseen_words(const Survey& survey, const Rig& rig, std::size_t tag) {
  const PlacedTag& placed = survey.tags[tag];
  return fmt::format(
      "tag {} is seen by no camera of {}: P {} m above the floor, cameras about {} m", placed.name,
      rig.file.string(), format_number(height_of_p(survey, placed), 2),
      format_number(rig.vehicle_height, 2));
}

constexpr const char* kUnseenRemedy =
    "another height of the tag, a larger plate, another alpha, yaw or lens; `tagsmith plan` shows "
    "what the cameras see";

// The most likely reason.
std::string unseen_remedy(const Survey& survey, const Rig& rig, const PlacedTag& tag) {
  const bool is_in_room =
      rig.vehicle_height > 0 && rig.vehicle_height < survey.tunnel.height.at(tag.chainage);
  if (is_in_room) return kUnseenRemedy;
  return fmt::format(
      "vehicle.height of {} is {} m: the height of the vehicle's centre above the "
      "floor, in metres",
      rig.file.string(), format_number(rig.vehicle_height, 3));
}

// Tags that the rig cannot see anywhere. The regular ones together: they come from one line.
std::vector<Diagnostic> unseen_findings(const Survey& survey, const Rig& rig) {
  FindingLog log(survey.file.string());
  std::vector<std::size_t> regular;
  const auto add = [&](std::size_t tag, const std::string& message) {
    const PlacedTag& placed = survey.tags[tag];
    log.warning({placed.line, placed.column}, std::string(kUnseenTagRule), message,
                unseen_remedy(survey, rig, placed));
  };
  for (const std::size_t tag : unseen_tags(survey, rig)) {
    if (survey.tags[tag].surveyed) {
      add(tag, unseen_words(survey, rig, tag));
    } else {
      regular.push_back(tag);
    }
  }
  if (regular.empty()) return log.sorted();
  std::string message = unseen_words(survey, rig, regular.front());
  if (regular.size() > 1) {
    message += fmt::format("; {} of {} tags in all, the last is {}", regular.size(),
                           survey.tags.size(), survey.tags[regular.back()].name);
  }
  add(regular.front(), message);
  return log.sorted();
}

// What `plan` refuses.
void check_room(const Survey& survey, const Rig& rig, Findings& findings) {
  const auto fits = check_vehicle(survey, rig, 0, survey.tunnel.centerline.length());
  if (fits) return;
  FindingLog log(rig.file.string());
  log.error({}, std::string(kVehicleRoomRule), fits.error().message,
            "the rig's numbers are metres; `tagsmith plan` refuses it, too");
  findings.add(log.sorted());
}

// Each survey with each rig, without the findings that comments in the survey allow.
void check_sight(const std::vector<Survey>& surveys, const std::vector<Rig>& rigs,
                 Findings& findings) {
  for (const Survey& survey : surveys) {
    for (const Rig& rig : rigs) {
      check_room(survey, rig, findings);
      findings.add(allowed_removed(unseen_findings(survey, rig), survey.file));
    }
  }
}

Findings validate(const ValidateOptions& options) {
  Findings findings;
  std::vector<Survey> surveys;
  std::vector<Rig> rigs;
  for (const std::string& path : options.surveys) {
    Result<Diagnosed<Survey>> reading = read_survey(path);
    if (!collect(reading, findings) || !reading->value) continue;
    check_logo(reading->value->tag_template, findings);
    surveys.push_back(std::move(*reading->value));
  }
  findings.add(check_together(surveys));
  for (const std::string& path : options.rigs) {
    Result<Diagnosed<Rig>> reading = read_rig(path);
    if (collect(reading, findings) && reading->value) rigs.push_back(std::move(*reading->value));
  }
  check_sight(surveys, rigs, findings);
  findings.assumed = assumptions(surveys, Rig{});
  for (const Rig& rig : rigs)
    std::ranges::move(assumed_calibration(rig), std::back_inserter(findings.assumed));
  for (const std::string& path : options.templates) {
    const Result<Diagnosed<TagTemplate>> reading = read_template(path);
    if (collect(reading, findings) && reading->value) check_logo(*reading->value, findings);
  }
  return findings;
}

std::string json_line(const Diagnostic& diagnostic) {
  Json line;
  line["file"] = diagnostic.file;
  line["line"] = diagnostic.line;
  line["column"] = diagnostic.column;
  line["severity"] = to_string(diagnostic.severity);
  line["code"] = diagnostic.code;
  line["message"] = diagnostic.message;
  line["hint"] = diagnostic.hint;
  if (diagnostic.fix) {
    line["fix"] = {{"found", diagnostic.fix->found}, {"replacement", diagnostic.fix->text}};
  }
  return json_text(line);
}

int report(const Findings& findings, const ValidateOptions& options) {
  FindingPrinter printer;
  for (const Diagnostic& diagnostic : findings.diagnostics) {
    to_stdout("{}",
              Lines{options.json ? json_line(diagnostic) + "\n" : printer.text_of(diagnostic)});
  }
  std::fflush(stdout);  // findings before the summary on them
  for (const Error& error : findings.unreadable) report_failure("validate", error);
  print_assumptions("validate", findings.assumed);
  const auto errors = static_cast<std::size_t>(
      std::ranges::count(findings.diagnostics, Severity::error, &Diagnostic::severity));
  const std::size_t files = options.surveys.size() + options.rigs.size() + options.templates.size();
  to_stderr("{}: {}, {}{}\n", counted(files, "file"), counted(errors, "error"),
            counted(findings.diagnostics.size() - errors, "warning"),
            findings.unreadable.empty()
                ? ""
                : fmt::format(", {} unreadable", findings.unreadable.size()));
  if (!findings.unreadable.empty()) return kExitFailure;
  return errors > 0 ? kExitFindings : kExitOk;
}

void show(const std::string& file, const FixedLine& line, bool json) {
  if (json) {
    to_stdout("{}\n", json_text({{"file", file},
                                 {"line", line.line},
                                 {"fixed", line.codes},
                                 {"before", line.before},
                                 {"after", line.after}}));
  } else {
    to_stdout("{}:{}: mended [{}]\n  - {}\n  + {}\n", file, line.line, fmt::join(line.codes, "] ["),
              trim(line.before), trim(line.after));
  }
}

// Writes the mechanical remedies into the files that were given, and validates again: a remedy may
// reveal what the fault hid.
Result<Findings> fix_and_validate(const ValidateOptions& options) {
  constexpr int kMostPasses = 5;
  std::vector<std::string> files = options.surveys;
  files.insert(files.end(), options.rigs.begin(), options.rigs.end());
  files.insert(files.end(), options.templates.begin(), options.templates.end());
  Findings findings = validate(options);
  for (int pass = 0; pass < kMostPasses; ++pass) {
    bool changed = false;
    for (const std::string& file : files) {
      std::vector<Diagnostic> of_file;
      std::ranges::copy_if(findings.diagnostics, std::back_inserter(of_file),
                           [&](const Diagnostic& diagnostic) { return diagnostic.file == file; });
      const auto lines = fix_file(file, of_file);
      if (!lines && !of_file.empty()) return fail(lines);
      if (!lines) continue;
      for (const FixedLine& line : *lines) show(file, line, options.json);
      changed = changed || !lines->empty();
    }
    if (!changed) break;
    findings = validate(options);
  }
  return findings;
}

Result<int> explain(const std::string& code) {
  const Rule* rule = find_rule(code);
  if (rule == nullptr) {
    std::vector<std::string> codes;
    for (const Rule& known : rules()) codes.emplace_back(known.code);
    const auto near = nearest_word(code, codes);
    return fail(fmt::format("--explain: no rule {}{}", code,
                            near ? ", did you mean " + *near + "?" : "; --rules lists them"));
  }
  to_stdout("{}: {}\n{}\n", rule->code, rule->finds, rule->remedy);
  return kExitOk;
}

int list_rules() {
  to_stdout("| rule | finds | why, and what to do |\n|---|---|---|\n");
  for (const Rule& rule : rules()) {
    to_stdout("| `{}` | {} | {} |\n", rule.code, rule.finds, rule.remedy);
  }
  return kExitOk;
}

Result<int> run_validate(const ValidateOptions& options) {
  if (options.list_rules) return list_rules();
  if (!options.explain.empty()) return explain(options.explain);
  if (options.surveys.empty() && options.rigs.empty() && options.templates.empty()) {
    return fail("no files given, expected SURVEY, --rig or --template");
  }
  if (!options.fix) return report(validate(options), options);
  return fix_and_validate(options).map(
      [&](const Findings& findings) { return report(findings, options); });
}

}  // namespace

Command validate_command() {
  const auto options = std::make_shared<ValidateOptions>();
  return {
      .name = "validate",
      .summary = "Every problem of surveys, rigs and templates in one go, and how to mend it",
      .options =
          {argument("SURVEY", &options->surveys, ValueKind::survey,
                    "Survey files (YAML); several are checked against each other too"),
           rig_option(
               &options->rigs,
               "Rig file to check as well, and whether its cameras can see the surveys' tags"),
           value_option("--template", &options->templates, "FILE", "Template file to check as well",
                        ValueKind::tag_template),
           flag("--fix", &options->fix,
                "Write the mechanical remedies into the files (misspelt keys, decimal commas, "
                "quotes), show them, and report what is left"),
           value_option("--explain", &options->explain, "RULE",
                        "What the rule RULE is about, and why"),
           flag("--rules", &options->list_rules, "All rules, as a table"),
           json_flag(options->json, "One JSON object a line for each finding")},
      .notes =
          "A comment `# tagsmith: allow RULE: REASON` on or above a line silences a warning. "
          "Exit code: 0 no errors, 1 errors found, 2 a file cannot be read.\n\n"
          "Example:\n"
          "  tagsmith validate surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml\n"
          "  tagsmith validate --fix mine/survey.yaml\n"
          "  tagsmith validate --explain spacing-outlier",
      .run = [options] { return run_validate(*options); },
  };
}

}  // namespace tagsmith::detail
