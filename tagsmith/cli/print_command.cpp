// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/print_only.hpp"
#include "tagsmith/cli/print_run.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/read_printer.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

struct PrintOptions {
  std::string survey;
  std::string folder;
  std::vector<std::string> formats{"both"};
  std::vector<std::string> tags;  // names; empty = all
  std::string only;               // file that names tags; empty = none
  std::string paper;
  std::string profile;  // of the printer; empty = none
  std::string press;    // its ICC profile; empty = no PDF/X
  bool no_setting_out = false;
  bool proof = false;
  bool json = false;
  PrintStyle style;  // the choices that the options above leave open

  bool has(const char* format) const { return std::ranges::count(formats, format) > 0; }
};

Error unknown_tag(const Survey& survey, const std::string& option, const std::string& name) {
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) names.push_back(tag.name);
  const std::optional<std::string> meant = nearest_word(name, names);
  return {fmt::format("{}: survey {} has no tag \"{}\"{}", option, survey.name, name,
                      meant ? ", did you mean " + *meant + "?" : "")};
}

// The tags that --only or --tags select, all of the survey; without these options nothing, and all
// are printed.
Result<TagsToPrint> wanted_tags(const Survey& survey, const PrintOptions& options) {
  const bool listed = !options.only.empty();
  Result<TagsToPrint> list =
      listed ? read_tags_to_print(options.only, std::cin) : TagsToPrint{options.tags};
  if (!list) return fail(list);
  if (const std::string revision = survey_revision(survey);
      !list->revision.empty() && list->revision != revision) {
    return fail(fmt::format(
        "{}: the list is for revision {} of the survey, {} is revision {}; print the survey that "
        "the list was made for, or list the changes to this one with `tagsmith diff`",
        options.only, list->revision, survey.file.string(), revision));
  }
  for (const auto* names : {&list->names, &list->moved}) {
    for (const std::string& name : *names) {
      if (find_tag(survey, name) != nullptr) continue;
      return tl::unexpected(unknown_tag(survey, listed ? options.only : "--tags", name));
    }
  }
  return list;
}

// In the survey's order, each once.
std::vector<const PlacedTag*> chosen_tags(const Survey& survey, const PrintOptions& options,
                                          const TagsToPrint& list) {
  const bool all = options.only.empty() && options.tags.empty();
  const std::set<std::string> wanted(list.names.begin(), list.names.end());
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) {
    if (all || wanted.contains(tag.name)) tags.push_back(&tag);
  }
  return tags;
}

Result<PrintStyle> style_of(const PrintOptions& options, const Survey& survey,
                            const ProvePages& prove) {
  PrintStyle style = options.style;
  style.formats.clear();
  const bool both = options.has("both");
  if (both || options.has("pdf")) style.formats.push_back(SheetFormat::pdf);
  if (both || options.has("svg")) style.formats.push_back(SheetFormat::svg);
  if (options.has("png")) style.formats.push_back(SheetFormat::png);
  style.revision = survey_revision(survey);
  style.setting_out = !options.no_setting_out;
  if (options.proof) style.prove = prove;
  style.order = style.order || !style.zip.empty();
  const bool has_pdf = std::ranges::count(style.formats, SheetFormat::pdf) > 0;
  const auto right = none_of(
      {{!style.zip.empty() && style.zip.extension() != ".zip",
        "--zip " + style.zip.string() + ": expected a name that ends in .zip"},
       {style.outline_text && !has_pdf, "--outline-text is for PDF files, but --format has no pdf"},
       {!options.press.empty() && !has_pdf, "--pdf-x is for PDF files, but --format has no pdf"},
       {style.single && !has_pdf, "--single makes one PDF, but --format has no pdf"},
       {style.tiled && options.paper.empty(), "--tile needs the paper of the tiles: --paper A4"}});
  if (!right) return fail(right);
  if (!options.profile.empty()) {
    Result<PrinterProfile> profile = read_printer_profile(options.profile);
    if (!profile) return fail(profile);
    style.bar_adjustment = bar_adjustment_for(*profile, survey.tag_template.white_on_black);
    style.printer = std::move(*profile);
  }
  if (!options.press.empty()) {
    Result<OutputIntent> intent = load_output_intent(options.press);
    if (!intent) return fail(intent);
    style.intent = std::move(*intent);
  }
  if (options.paper.empty()) return style;
  const Result<PrintPaper> paper = parse_print_paper(options.paper);
  if (!paper) return fail(paper);
  style.paper = *paper;
  return style;
}

// The plate's area that a line of the label covers.
Rectangle area_of(const TextItem& line) {
  const double length = std::min(text_width(line.text, line.height), line.max_width);
  const double above = kTextAscent * line.height;
  const double below = kTextDescent * line.height;
  if (line.upwards) return {line.x - above, line.y - length, above + below, length};
  return {line.x, line.y - above, length, above + below};
}

// Whether a hole of the plate goes through the text or the arrow of its label.
bool is_drilled_label(const TagDrawing& drawing) {
  return std::ranges::any_of(drawing.holes, [&](const HoleOutline& hole) {
    return std::ranges::any_of(
               drawing.label, [&](const TextItem& line) { return touches(hole, area_of(line)); }) ||
           std::ranges::any_of(drawing.arrows,
                               [&](const UpArrow& arrow) { return touches(hole, arrow.box); });
  });
}

// The text that a label should have and does not; empty when nothing is missing.
std::string missing_on_label(const PrintJob& job, const PlacedTag& tag) {
  const TagDrawing drawing = printed_drawing(job, tag);
  const std::vector<TextItem>& label = drawing.label;
  for (const TextItem& line : label) {
    if (!is_cut({.text = line.text, .height = line.height, .max_width = line.max_width})) continue;
    return fmt::format(
        "the label of {} has no room for all of `{}`, which ends early: a shorter name of the "
        "survey, more label.lines of fewer words, or a wider strip beside or below the feature "
        "frame",
        tag.name, line.text);
  }
  for (const TextItem& line : label) {
    if (has_glyphs(line.text)) continue;
    return fmt::format(
        "no font on this machine has every character of `{}` on the label of {}: install one, for "
        "example fonts-noto-cjk",
        line.text, tag.name);
  }
  if (!is_drilled_label(drawing)) return {};
  return fmt::format("a hole of the plate goes through the label of {}: move the holes in {}",
                     tag.name, job.printed.name);
}

// Of the first label in which something is missing.
std::string missing_on_labels(const PrintJob& job) {
  constexpr std::size_t kMostTags = 200;  // further ones are as long
  std::size_t seen = 0;
  for (const PrintUnit& unit : job.units) {
    for (const PlacedTag* tag : unit.tags) {
      if (++seen > kMostTags) return {};
      if (std::string missing = missing_on_label(job, *tag); !missing.empty()) return missing;
    }
  }
  return {};
}

// What files or readers must take into account, through no fault of the survey; on standard error.
void warn(const PrintJob& job) {
  const auto say = [](const std::string& text) {
    to_stderr("tagsmith print: warning: {}\n", text);
  };
  const TagTemplate& tag = job.printed;
  if (!job.units.empty() && tag.label.shown &&
      printed_drawing(job, *job.units.front().tags.front()).label.empty()) {
    say("template " + tag.name +
        ": no room for a label below the feature frame, the plates carry none");
  }
  if (!has_glyphs(job.survey->name)) {
    say("no font on this machine has every character of the survey's name " + job.survey->name +
        ": install one, for example fonts-noto-cjk");
  }
  if (const std::string missing = missing_on_labels(job); !missing.empty()) say(missing);
  if (!job.rounding.empty()) {
    to_stderr("tagsmith print: {}\n", job.rounding);
  }
}

void warn_of_earlier(const PrintRecord& record, const std::string& folder) {
  for (const std::string& warning : record.warnings) {
    to_stderr("tagsmith print: warning: {}: {}\n", folder, warning);
  }
}

void report(const PrintRecord& record, const PrintOptions& options) {
  const std::string folder = (std::filesystem::path(options.folder) / "").string();
  std::vector<std::string> others;
  std::set<std::string> shown;
  for (const PrintedTag& item : record.tags) {
    if (options.json) to_stdout("{}\n", printed_tag_json(item, folder));
    for (const std::string& file : item.files) {
      if (file == kSinglePdf && shown.insert(file).second) others.push_back(folder + file);
      if (options.json || !shown.insert(file).second) continue;
      to_stdout("{}\n", folder + file);
    }
  }
  for (const std::string& file : record.documents) others.push_back(folder + file);
  others.insert(others.end(), {folder + "manifest.json", folder + "manifest.csv"});
  if (!options.style.zip.empty()) others.push_back(options.style.zip.string());
  if (!options.json) {
    for (const std::string& file : others) to_stdout("{}\n", file);
    return;
  }
  const Json summary{{"summary", {{"count", record.tags.size()}, {"files", others}}}};
  to_stdout("{}\n", json_text(summary));
}

void report_problems(const PrintRecord& record) {
  std::size_t problems = 0;
  for (const TagProof& proof : *record.proofs) {
    if (proof.problem.empty()) continue;
    ++problems;
    to_stderr("tagsmith print: proof: {} in {}: {}\n", proof.tag, proof.file, proof.problem);
  }
  to_stderr("tagsmith print: the proof found {}; nothing was written\n",
            counted(problems, "fault"));
}

void report_proof(const PrintRecord& record) {
  double farthest = 0;
  int asked_zbar = 0;
  for (const TagProof& proof : *record.proofs) {
    farthest = std::max(farthest, proof.corner_error);
    asked_zbar += proof.zbar.empty() ? 0 : 1;
  }
  to_stderr(
      "tagsmith print: proof: {} of tags read as the survey has them{}, corners within {} mm\n",
      counted(record.proofs->size(), "picture"),
      asked_zbar > 0 ? fmt::format(", {} of them by zbar too", asked_zbar) : "",
      format_number(farthest * 1000, 3));
}

void report_roll(const PrintJob& job) {
  to_stderr("tagsmith print: {} m of {}, {} % waste\n", format_number(job.roll->length, 2),
            job.style.paper->name, format_number(job.roll->waste() * 100, 0));
}

Result<int> print(const PrintOptions& options, const ProvePages& prove) {
  if (!has_glyphs("0")) return fail("no font on this machine: install fonts-dejavu-core");
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey);
  Result<PrintStyle> style = style_of(options, *survey, prove);
  if (!style) return fail(style);
  const Result<TagsToPrint> list = wanted_tags(*survey, options);
  if (!list) return fail(list);
  const std::vector<const PlacedTag*> tags = chosen_tags(*survey, options, *list);
  style->moved = {list->moved.begin(), list->moved.end()};
  if (tags.empty() && !options.only.empty()) {
    const bool moves = !list->moved.empty() && style->setting_out;
    to_stderr("tagsmith print: {} names no tag to print{}\n", options.only,
              moves ? ", only tags to move: setting-out lists alone are made" : "");
    if (!moves) return kExitOk;
    style->single = style->order = false;
    style->prove = {};
  }
  const Result<PrintJob> job = plan_print(*survey, tags, *style);
  if (!job) return fail(job);
  CommandFiles files;
  files.reads(*survey);
  files.reads(options.only == "-" ? "/dev/stdin" : options.only, "the list --only");
  files.reads(options.profile, "--profile");
  files.reads(options.press, "--pdf-x");
  const Result<PrintRecord> record = run_print(*job, options.folder, std::move(files));
  if (!record) return fail(record);
  warn(*job);
  if (has_problems(*record)) {
    report_problems(*record);
    return kExitFindings;
  }
  if (record->proofs) report_proof(*record);
  if (job->roll && !tags.empty()) report_roll(*job);
  warn_of_earlier(*record, options.folder);
  report(*record, options);
  return kExitOk;
}

// An option in millimetres whose value is kept in metres.
CommandOption length_option(const std::string& name, double& metres, const std::string& text,
                            double least, double greatest) {
  return number_option(
      name, [&metres](double millimetres) { metres = millimetres / 1000; }, "MM", least, greatest,
      text);
}

std::vector<CommandOption> choice_options(PrintOptions& options) {
  return {
      by_commas(choice_option("--format", &options.formats, {"pdf", "svg", "png", "both"},
                              "Separated by commas; both = pdf,svg (default: both)")),
      by_commas(value_option("--tags", &options.tags, "NAME,...",
                             "Only these tags, by name, separated by commas", ValueKind::tag)),
      excluding({"--tags"}, file_option("--only", &options.only,
                                        "Only the tags that this file names, one a line; the "
                                        "output of `tagsmith diff` will do; - for standard input")),
      flag("--single", &options.style.single, "All pages in one PDF, tags.pdf")};
}

std::vector<CommandOption> paper_options(PrintOptions& options) {
  return {
      value_option("--paper", &options.paper, "PAPER",
                   "A4, A3, A2, A1, A0, Letter, Tabloid, WIDTHxHEIGHT or roll:WIDTH in mm: as many "
                   "plates a page as it holds (default: the page is one plate with its margin)"),
      flag("--tile", &options.style.tiled,
           "Plates in pieces on several sheets of the paper, with an assembly sheet"),
      needing({"--tile"}, length_option("--overlap", options.style.overlap,
                                        "Of neighbouring tiles, mm (default: 10)", 5, 50)),
      length_option("--bleed", options.style.bleed,
                    "How far crop marks and bleed box stand off the plate, mm (default: 3)", 0,
                    20)};
}

std::vector<CommandOption> printer_options(PrintOptions& options) {
  return {
      number_option(
          "--dpi", &options.style.dots_per_inch, "DPI", 50, 10'000,
          "The printer's dots per inch: every edge stands on a whole dot; also the resolution of "
          "PNG and of the proof (default: the template's dots_per_inch, else 300 for those)"),
      length_option("--bar-adjust", options.style.bar_adjustment,
                    "Added to the width of every bar and of the frame, mm; -0.1 takes away "
                    "what the ink adds, 0.1 on plates white on black (default: 0)",
                    -10, 10),
      excluding({"--bar-adjust"},
                file_option("--profile", &options.profile,
                            "Printer's profile, from `tagsmith printer`: takes the growth of its "
                            "bars away, and in PDF files its scale")),
      file_option("--pdf-x", &options.press,
                  "PDF files of tags as PDF/X-4 for the press and paper of this ICC profile, which "
                  "the print shop gives"),
      flag("--outline-text", &options.style.outline_text,
           "Text in PDF files of tags as outlines in place of letters of a font"),
      flag("--proof", &options.proof,
           "Draw the files as pixels, read them, and write nothing unless digits, sizes and "
           "corners are the survey's")};
}

std::vector<CommandOption> installer_options(PrintOptions& options) {
  return {
      flag("--no-setting-out", &options.no_setting_out,
           "Without the installer's setting-out.csv and setting-out.pdf"),
      flag("--order", &options.style.order,
           "With order.pdf for the sign maker (counts, sizes, material), and the contours of "
           "each page as DXF"),
      file_option("--zip", &options.style.zip, "All of it, the order too, in this ZIP as well"),
      excluding({"--no-setting-out"},
                drawing_paper_option(
                    "--setting-out-paper", options.style.setting_out_paper,
                    "Of setting-out.pdf: its drawing on this paper, its table on Letter or "
                    "else A4 (default: a3)")),
      excluding(
          {"--no-setting-out"},
          length_option("--tolerance", options.style.tolerance,
                        "How far P may hang from its place, mm, for the setting-out list (default: "
                        "twice the survey's sigma, at least 5)",
                        0.1, 1000)),
      excluding(
          {"--no-setting-out"},
          choice_option(
              "--point-order",
              [&options](const std::string& order) {
                options.style.northing_first = order == "PNEZD";
              },
              {"PENZD", "PNEZD"},
              "Columns of setting-out.csv: PENZD (x before y, default) or PNEZD (y before x)"))};
}

}  // namespace

Command print_command(const ProvePages& prove) {
  const auto options = std::make_shared<PrintOptions>();
  return {
      .name = "print",
      .summary = "Print-ready PDF, SVG and PNG files of a survey's tags, and the installer's lists",
      .options = joined(
          {{survey_argument(&options->survey, "Survey file (YAML)"),
            required(folder_option("-o,--output", &options->folder,
                                   "Folder for the files and their manifest; made if missing")),
            json_flag(options->json, "One JSON object a printed tag, then a summary"),
            jobs_option(options->style.jobs, "Cores to use at most")},
           choice_options(*options),
           paper_options(*options),
           printer_options(*options),
           installer_options(*options)}),
      .notes =
          "Every page is at true scale, with a 100 mm scale bar in both directions: print at "
          "100 %, then measure both. Exit: 0 printed, 1 the proof found a fault, 2 wrong use or "
          "unreadable input; nothing is written with 1 and 2.\n\n"
          "Example:\n"
          "  tagsmith print surveys/corridor/survey.yaml -o out/print\n"
          "  tagsmith print surveys/corridor/survey.yaml -o out/office --paper A4 --tile --format "
          "pdf\n"
          "  tagsmith print surveys/corridor/survey.yaml -o out/spares --format pdf --tags "
          "000L,003R",
      .run = [options, prove] { return print(*options, prove); },
  };
}

}  // namespace tagsmith::detail
