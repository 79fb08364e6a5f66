// SPDX-License-Identifier: Apache-2.0
// The work of one run of `print`: which pages, in which files.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/print_proof.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/nested_pages.hpp"
#include "tagsmith/render/page.hpp"
#include "tagsmith/render/pdf_x.hpp"
#include "tagsmith/render/print_paper.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/tiled_pages.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

struct PrintStyle {
  std::vector<SheetFormat> formats{SheetFormat::pdf, SheetFormat::svg};
  bool single = false;        // all pages in one PDF, tags.pdf
  int dots_per_inch = 0;      // edges stand on whole dots of this printer; 0 = of the template's
  double bar_adjustment = 0;  // metres added to the width of every bar; negative = less
  std::optional<PrinterProfile> printer{};  // its scale is corrected in PDF files
  std::optional<OutputIntent> intent{};     // of PDF/X-4; none = no PDF/X
  bool outline_text = false;                // in PDF files
  double bleed = 0.003;                     // metres
  std::optional<PrintPaper> paper{};        // none = the page is the plate with its margin
  bool tiled = false;                       // plates in pieces on several sheets of the paper
  double overlap = 0.010;                   // of neighbouring tiles, metres
  std::string revision{};       // of the survey, for labels and files; empty = none is shown
  bool setting_out = true;      // with the installer's list, table and drawing
  bool order = false;           // with the sign maker's order sheet and cut files
  std::filesystem::path zip{};  // all of it in one file as well; empty = none
  Paper setting_out_paper = Paper::a3;
  std::set<std::string> moved{};  // tags that belong in that list although they are not printed
  double tolerance = 0;           // of a plate's place in that list, metres; 0 = usual_tolerance
  bool northing_first = false;    // y before x in that list (PNEZD instead of PENZD)
  ProvePages prove{};             // none = no proof
  int jobs = 0;                   // cores to use; 0 = all
};

// PNG files have the printer's resolution, or this one where none is stated; so do proofs, and P
// lies on its dots.
inline constexpr int kUsualDotsPerInch = 300;

inline constexpr const char* kSinglePdf = "tags.pdf";

// Pages that belong together: those of one plate, or one page of several plates. Its files are
// named after it.
struct PrintUnit {
  std::string name;
  std::vector<const PlacedTag*> tags;
};

struct PrintJob {
  const Survey* survey = nullptr;
  PrintStyle style;
  TagTemplate printed;   // the survey's template as it is drawn on the printer's dots
  LogoDrawing logo;      // at the origin; without outlines where the template has none
  std::string rounding;  // the changes by that, for people; empty = none
  std::optional<NestPlan> nest;
  std::optional<RollUse> roll;  // of all pages on a roll
  std::optional<TilePlan> tiles;
  std::vector<PrintUnit> units;

  // Across and down its pages. Printers take sheets with the shorter side ahead, and rolls across
  // their width: pages that lie on these leave them turned. A page that is a plate with its margin
  // is printed as it is.
  PrinterScale printer_scale() const {
    const PrinterScale scale = style.printer ? style.printer->scale : PrinterScale{};
    const bool lies = (tiles && tiles->lies) || (nest && nest->lies);
    return lies ? turned(scale) : scale;
  }
  const OutputIntent* intent() const { return style.intent ? &*style.intent : nullptr; }
  int dots_per_inch() const { return printed.dots_per_inch; }
  int png_dots_per_inch() const {
    return dots_per_inch() > 0 ? dots_per_inch() : kUsualDotsPerInch;
  }
};

// Fails without tags, to print or to move, and on a paper that cannot hold a plate; the message
// then names papers that can. The job keeps pointers into the survey.
Result<PrintJob> plan_print(const Survey& survey, const std::vector<const PlacedTag*>& tags,
                            const PrintStyle& style);

// The unit's pages as they are printed, and as they look when the ink has grown by the bars'
// adjustment: the same except for the edges of bars and frame.
std::vector<Page> pages_of(const PrintJob& job, const PrintUnit& unit);
std::vector<Page> nominal_pages(const PrintJob& job, const PrintUnit& unit);

// The last of the first tags that are printed; of the survey's first tag where none is.
Page typical_page(const PrintJob& job);

// One page of a unit in a file.
struct PageInFile {
  SheetFormat format = SheetFormat::pdf;
  std::string file;
  int number = 0;         // of the page in a PDF, from 1; 0 in a picture
  std::size_t index = 0;  // among the unit's pages
};

// Where the pages of job.units[unit] stand, format by format.
std::vector<PageInFile> pages_in_files(const PrintJob& job, std::size_t unit);

// The drawing of a tag as this job prints it, in the plate frame, before the bars' adjustment.
TagDrawing printed_drawing(const PrintJob& job, const PlacedTag& tag);

// Makes the files of all pages. `done` is called after each unit, one at a time.
Result<void> write_print(
    const PrintJob& job, const StagedFiles& files, const std::function<void()>& done = [] {});

}  // namespace tagsmith::detail
