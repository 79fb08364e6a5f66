// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "decoder/calibrate/measure_printer.hpp"
#include "decoder/cli/commands.hpp"
#include "decoder/image/load.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/render/printer_sheet.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/read_printer.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

struct PrinterOptions {
  std::string scan;
  std::string output;
  std::string paper = "A4";
  std::string profile;
  double dots_per_inch = 0;
  bool json = false;
};

Result<int> write_sheet(const PrinterOptions& options) {
  if (!has_glyphs("0")) return fail("no font on this machine: install fonts-dejavu-core");
  if (sheet_format_of(options.output) != SheetFormat::pdf) {
    return fail("--output " + options.output + ": a test sheet is a PDF, expected NAME.pdf");
  }
  const Result<PrintPaper> paper = parse_print_paper(options.paper);
  if (!paper) return fail(paper);
  PrinterProfile profile;
  CommandFiles files;
  if (!options.profile.empty()) {
    const Result<PrinterProfile> read = read_printer_profile(options.profile);
    if (!read) return fail(read);
    profile = *read;
    files.reads(options.profile, "--profile");
  }
  files.writes(options.output, "--output");
  if (auto usable = files.check(); !usable) return fail(usable);
  const Result<Sheet> sheet = printer_sheet(*paper, profile);
  if (!sheet) return fail(sheet);
  const auto drawn = render_sheets({&*sheet, 1}, options.output);
  if (!drawn) return fail(drawn);
  if (auto written = publish_files(*drawn); !written) return fail(written);
  to_stdout("{}\n", options.output);
  return kExitOk;
}

void report(const PrinterMeasurement& found, const PrinterOptions& options) {
  const PrinterProfile& profile = found.profile;
  if (options.json) {
    const Json object{{"printer", profile.name},
                      {"scale", {profile.scale.right, profile.scale.down}},
                      {"bar_growth_mm", {profile.growth_right * 1000, profile.growth_down * 1000}},
                      {"growth_spread_mm", found.growth_spread * 1000},
                      {"dot_gain_percent", profile.dot_gain * 100},
                      {"mark_error_mm", found.mark_error * 1000},
                      {"profile", options.output}};
    to_stdout("{}\n", json_text(object));
    return;
  }
  to_stdout("scale {} % across, {} % down; bars {} mm too wide across, {} mm down; dot gain {} %\n",
            format_number(profile.scale.right * 100, 3), format_number(profile.scale.down * 100, 3),
            mm_text(profile.growth_right), mm_text(profile.growth_down),
            format_number(profile.dot_gain * 100, 1));
  to_stdout("{}\n", options.output);
}

// A name that a profile can carry.
std::string profile_name(std::string text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  for (char& c : text) {
    if (!is_plain(c) && c != '-' && c != '_' && c != '.') c = '_';
  }
  if (text.empty() || !is_plain(text.front())) text.insert(0, "printer");
  return text.substr(0, 100);
}

Result<int> measure(const PrinterOptions& options) {
  if (options.dots_per_inch == 0) {
    return fail("--dpi is missing: the resolution that " + options.scan + " was scanned with");
  }
  if (!options.profile.empty()) {
    return fail("--profile belongs to the sheet, without a scan: a scan makes a profile");
  }
  const fs::path output = options.output;
  if (output.extension() != ".yaml" && output.extension() != ".yml") {
    return fail("--output " + options.output + ": expected a name that ends in .yaml or .yml");
  }
  CommandFiles files;
  files.reads(options.scan, "the scan");
  files.writes(options.output, "--output");
  if (auto usable = files.check(); !usable) return fail(usable);
  const Result<GrayImage> scan = load_gray_image(options.scan);
  if (!scan) return fail(scan);
  Result<PrinterMeasurement> found =
      measure_printer(options.scan, scan->view(), options.dots_per_inch);
  if (!found) return fail(found);
  found->profile.name = profile_name(output.stem().string());
  const std::vector<SheetFile> profile{{output, printer_profile_text(found->profile)}};
  if (auto written = publish_files(profile); !written) return fail(written);
  report(*found, options);
  return kExitOk;
}

}  // namespace

Command printer_command() {
  const auto options = std::make_shared<PrinterOptions>();
  return {
      .name = "printer",
      .summary = "A printer's test sheet, and its profile from a scan of that sheet",
      .options = {argument("SCAN", &options->scan, ValueKind::file,
                           "Scan of the printed sheet; without it the sheet is written"),
                  required(file_option("-o,--output", &options->output,
                                       "The sheet, NAME.pdf; or of a scan the profile, NAME.yaml")),
                  number_option("--dpi", &options->dots_per_inch, "DPI", 50, 10'000,
                                "The scan's resolution, dots per inch"),
                  value_option("--paper", &options->paper, "PAPER",
                               "Of the sheet: A4, Letter or larger (default: A4)"),
                  file_option("--profile", &options->profile,
                              "Of the sheet: takes away what this profile says, as a check"),
                  json_flag(options->json, "Of a scan: one JSON object")},
      .notes =
          "Print the sheet at 100 %, scan it flat and whole, measure: the profile has the "
          "printer's "
          "scale across and down, how much wider it prints bars, and its dot gain. `tagsmith print "
          "--profile` takes scale and width away.\n\n"
          "Example:\n"
          "  tagsmith printer -o out/printer-test.pdf\n"
          "  tagsmith printer scan.png --dpi 600 -o out/office.yaml",
      .run =
          [options] { return options->scan.empty() ? write_sheet(*options) : measure(*options); },
  };
}

}  // namespace tagsmith::detail
