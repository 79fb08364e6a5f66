// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_job.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/render/logo.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/png.hpp"
#include "tagsmith/render/qr_symbol.hpp"
#include "tagsmith/render/svg.hpp"
#include "tagsmith/render/tag_text.hpp"

namespace tagsmith::detail {
namespace {

Error paper_too_small(const TagTemplate& tag, const Rectangle& plate, const PrintStyle& style) {
  std::string text =
      fmt::format("--paper {} cannot carry a plate of {} x {} mm ({}) in one piece; ",
                  style.paper->name, mm_text(plate.width, 1), mm_text(plate.height, 1), tag.name);
  text += papers_for(plate, style.bleed, style.paper->reach) + " can";
  const Result<TilePlan> tiles = plan_tiles(plate, *style.paper, style.overlap, 0);
  if (tiles) text += fmt::format(", or --tile: {} sheets a plate", tiles->tiles());
  return {text};
}

// The printer's dots, when their number is stated.
Result<void> draw_on_dots(PrintJob& job) {
  const int dots_per_inch = job.style.dots_per_inch;
  if (dots_per_inch == 0) return {};
  const TagTemplate& wanted = job.survey->tag_template;
  const double dots = module_width(wanted) / kMetresPerInch * dots_per_inch;
  if (dots < kLeastDots) {
    return fail(
        fmt::format("--dpi {}: a module of {} mm ({}) is {} dots wide, expected at least {}: "
                    "a finer printer or a larger template",
                    dots_per_inch, format_number(module_width(wanted) * 1000, 3), wanted.name,
                    format_number(dots, 2), kLeastDots));
  }
  job.printed = drawn_on_dots(wanted, dots_per_inch);
  job.printed.dots_per_inch = dots_per_inch;
  job.rounding = describe_rounding(wanted, job.printed, dots_per_inch);
  return {};
}

// Readers fail where bars are 0.6 modules wider or narrower than they should be; at 0.4 they do
// not.
Result<void> check_bar_adjustment(const PrintJob& job) {
  constexpr double kMost = 0.4;
  const double most = kMost * std::min(module_width(job.printed), job.printed.frame_stroke);
  if (std::abs(job.style.bar_adjustment) <= most) return {};
  return fail(
      fmt::format("--bar-adjust {}: expected at most {} mm either way, {} of a module or of the "
                  "frame's stroke of {}",
                  format_number(job.style.bar_adjustment * 1000),
                  format_number(std::floor(most * 1e5) / 100), kMost, job.printed.name));
}

// Loads the logo, and checks whether each tag's QR symbol can be printed.
Result<void> plan_plate_parts(PrintJob& job, const std::vector<const PlacedTag*>& tags) {
  const TagDrawing drawing = draw_tag(job.printed, Digits{});
  if (drawing.logo) {
    const LogoStyle& style = job.printed.logo;
    Result<LogoDrawing> logo = load_logo(style.file, style.width, style.height);
    if (!logo) return fail(logo);
    job.logo = std::move(*logo);
  }
  if (!drawing.qr) return {};
  for (const PlacedTag* tag : tags) {
    const auto symbol =
        qr_symbol(qr_content(*job.survey, *tag, job.style.revision), drawing.qr->box);
    if (!symbol) return fail("tag " + tag->name + ": " + symbol.error().message);
  }
  return {};
}

// Chooses among one page a plate, several plates a page and several pages a plate.
Result<void> plan_pages(PrintJob& job, std::size_t tags) {
  const PrintStyle& style = job.style;
  if (!style.paper) return {};
  const Rectangle plate = draw_tag(job.printed, Digits{}).plate;
  if (style.tiled) {
    const Result<TilePlan> tiles =
        plan_tiles(plate, *style.paper, style.overlap, job.png_dots_per_inch());
    if (!tiles) return fail(tiles);
    job.tiles = *tiles;
    return {};
  }
  job.nest = plan_nest(plate, *style.paper, style.bleed, job.png_dots_per_inch(), tags);
  if (!job.nest) return tl::unexpected(paper_too_small(job.printed, plate, style));
  if (job.nest->roll) job.roll = roll_use(plate, *job.nest, tags);
  return {};
}

std::vector<PrintUnit> units_of(const PrintJob& job, const std::vector<const PlacedTag*>& tags) {
  std::vector<PrintUnit> units;
  if (!job.nest) {
    for (const PlacedTag* tag : tags) units.push_back({tag->name, {tag}});
    return units;
  }
  const auto plates = static_cast<std::size_t>(job.nest->plates());
  for (std::size_t first = 0; first < tags.size(); first += plates) {
    const std::size_t last = std::min(first + plates, tags.size());
    units.push_back({fmt::format("sheet-{:03}", units.size() + 1),
                     {tags.begin() + static_cast<std::ptrdiff_t>(first),
                      tags.begin() + static_cast<std::ptrdiff_t>(last)}});
  }
  return units;
}

PageNotes notes_of(const PrintJob& job, const PlacedTag& tag) {
  PageNotes notes = page_notes(*job.survey, tag, job.style.revision);
  if (!job.rounding.empty()) notes.more.push_back(job.rounding);
  if (job.style.bar_adjustment != 0) {
    notes.more.push_back("bars and frame adjusted by " +
                         format_number(job.style.bar_adjustment * 1000, 3) +
                         " mm for the growth of the ink");
  }
  return notes;
}

// Title and subject of a document of several tags.
PageNotes notes_of_several(const PrintJob& job, const std::string& subject) {
  return {job.survey->name, subject + ", template " + job.printed.name,
          survey_keywords(*job.survey, job.style.revision)};
}

Page nested_page(const PrintJob& job, const PrintUnit& unit) {
  std::vector<NamedDrawing> drawings;
  for (const PlacedTag* tag : unit.tags)
    drawings.push_back({tag->name, printed_drawing(job, *tag)});
  const std::string names = unit.tags.size() == 1
                                ? unit.tags.front()->name
                                : unit.tags.front()->name + " to " + unit.tags.back()->name;
  return lay_out_nested(drawings, notes_of_several(job, names), *job.nest);
}

const char* extension_of(SheetFormat format) {
  if (format == SheetFormat::pdf) return ".pdf";
  return format == SheetFormat::svg ? ".svg" : ".png";
}

bool in_one_pdf(const PrintJob& job, SheetFormat format) {
  return job.style.single && format == SheetFormat::pdf;
}

// As PDF states it, for a printer that scales.
Sheet pdf_sheet(const PrintJob& job, const Page& page) {
  const PrinterScale scale = job.printer_scale();
  Sheet sheet = sheet_of(page);
  sheet.text_as_outlines = job.style.outline_text;
  if (scale.is_true()) return sheet;
  const PrinterScale reach = reach_of(scale);
  sheet.width /= reach.right;
  sheet.height /= reach.down;
  return scaled(std::move(sheet), 1 / scale.right, 1 / scale.down);
}

std::vector<Sheet> sheets_of(const PrintJob& job, const std::vector<Page>& pages) {
  std::vector<Sheet> sheets;
  sheets.reserve(pages.size());
  for (const Page& page : pages) sheets.push_back(pdf_sheet(job, page));
  return sheets;
}

// The files of one unit.
Result<void> write_unit(const PrintJob& job, std::size_t unit, const StagedFiles& files) {
  const std::vector<Page> pages = pages_of(job, job.units[unit]);
  const auto bytes_of = [&](const PageInFile& place) -> Result<std::string> {
    const Page& page = pages[place.index];
    if (place.format == SheetFormat::pdf) return render_pdf(sheets_of(job, pages), job.intent());
    if (place.format == SheetFormat::svg) return render_svg(sheet_of(page));
    return render_png(sheet_of(page, false), job.png_dots_per_inch(), PngColours::grey);
  };
  for (const PageInFile& place : pages_in_files(job, unit)) {
    const bool in_pdf = place.format == SheetFormat::pdf;
    if (in_pdf && (job.style.single || place.index > 0)) continue;
    const Result<std::string> bytes = bytes_of(place);
    if (!bytes) return fail(bytes);
    if (auto added = files.add(place.file, *bytes); !added) return added;
  }
  return {};
}

Result<void> write_single(const PrintJob& job, const StagedFiles& files,
                          const std::function<void()>& done) {
  std::size_t count = 0;
  for (const PrintUnit& unit : job.units) count += unit.tags.size();
  const PageNotes notes = notes_of_several(job, counted(count, "position tag"));
  const SheetSource sheets = [&](const std::function<void(const Sheet&)>& add) {
    for (const PrintUnit& unit : job.units) {
      for (Page& page : pages_of(job, unit)) {
        page.notes = notes;
        add(pdf_sheet(job, page));
      }
      done();
    }
  };
  return write_pdf(files.staged(kSinglePdf), sheets, job.intent());
}

}  // namespace

Result<PrintJob> plan_print(const Survey& survey, const std::vector<const PlacedTag*>& tags,
                            const PrintStyle& style) {
  if (tags.empty() && style.moved.empty()) {
    return fail(survey.file.string() + ": has no tags to print");
  }
  PrintJob job;
  job.survey = &survey;
  job.style = style;
  const bool has_pdf = std::ranges::count(style.formats, SheetFormat::pdf) > 0;
  if (job.style.paper && has_pdf) job.style.paper->reach = reach_of(job.printer_scale());
  job.printed = survey.tag_template;
  if (auto drawn = draw_on_dots(job); !drawn) return fail(drawn);
  if (auto adjusted = check_bar_adjustment(job); !adjusted) return fail(adjusted);
  if (auto planned = plan_plate_parts(job, tags); !planned) return fail(planned);
  const std::size_t count = std::max<std::size_t>(tags.size(), 1);
  if (auto planned = plan_pages(job, count); !planned) return fail(planned);
  job.units = units_of(job, tags);
  return job;
}

TagDrawing printed_drawing(const PrintJob& job, const PlacedTag& tag) {
  TagDrawing drawing =
      draw_tag(job.printed, tag.digits, tag_text(*job.survey, tag, job.style.revision));
  if (drawing.logo) drawing.logo = in_room(job.logo, drawing.logo->room);
  if (drawing.qr) {
    drawing.qr =
        qr_symbol(qr_content(*job.survey, tag, job.style.revision), drawing.qr->box).value();
  }
  return job.dots_per_inch() > 0 ? on_whole_dots(std::move(drawing), job.dots_per_inch()) : drawing;
}

std::vector<Page> nominal_pages(const PrintJob& job, const PrintUnit& unit) {
  if (job.nest) return {nested_page(job, unit)};
  const PlacedTag& tag = *unit.tags.front();
  const TagDrawing drawing = printed_drawing(job, tag);
  if (job.tiles) return lay_out_tiles(tag.name, drawing, notes_of(job, tag), *job.tiles);
  const PageStyle style{.bleed = job.style.bleed, .dots_per_inch = job.png_dots_per_inch()};
  return {lay_out_page(tag.name, drawing, notes_of(job, tag), style)};
}

std::vector<Page> pages_of(const PrintJob& job, const PrintUnit& unit) {
  std::vector<Page> pages = nominal_pages(job, unit);
  if (job.style.bar_adjustment == 0) return pages;
  for (Page& page : pages) {
    for (PageTag& tag : page.tags) {
      if (!tag.at_true_scale) continue;
      tag.drawing = with_bar_adjustment(std::move(tag.drawing), job.style.bar_adjustment,
                                        job.dots_per_inch());
    }
  }
  return pages;
}

Page typical_page(const PrintJob& job) {
  const PlacedTag& any = job.survey->tags.front();
  return pages_of(job, job.units.empty() ? PrintUnit{any.name, {&any}} : job.units.front()).back();
}

std::vector<PageInFile> pages_in_files(const PrintJob& job, std::size_t unit) {
  const std::vector<std::string> names =
      job.tiles ? tile_page_names(*job.tiles) : std::vector<std::string>{""};
  std::vector<PageInFile> places;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const SheetFormat format : job.style.formats) {
      PageInFile place{format, job.units[unit].name, 0, i};
      if (format == SheetFormat::pdf) {
        place.number = static_cast<int>(i + (job.style.single ? unit * names.size() : 0)) + 1;
      } else if (!names[i].empty()) {
        place.file += "-" + names[i];
      }
      place.file = in_one_pdf(job, format) ? kSinglePdf : place.file + extension_of(format);
      places.push_back(std::move(place));
    }
  }
  return places;
}

Result<void> write_print(const PrintJob& job, const StagedFiles& files,
                         const std::function<void()>& done) {
  const auto one_pdf = [&](SheetFormat format) { return in_one_pdf(job, format); };
  const bool single = std::ranges::any_of(job.style.formats, one_pdf);
  Result<void> all;
  if (!std::ranges::all_of(job.style.formats, one_pdf)) {
    std::atomic<bool> failed = false;
    const auto write = [&](std::size_t i) {
      Result<void> written = failed ? Result<void>{} : write_unit(job, i, files);
      if (!written) failed = true;
      return written;
    };
    run_in_order(job.units.size(), job.style.jobs, write, [&](std::size_t, Result<void>& written) {
      if (all && !written) all = written;
      if (!single) done();
    });
  }
  return all && single ? write_single(job, files, done) : all;
}

}  // namespace tagsmith::detail
