// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_order.hpp"

#include <set>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/cut_file.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kOrderPdf = "order.pdf";

std::string cut_file_of(const PrintUnit& unit) { return unit.name + "-cut.dxf"; }

struct OrderLine {
  std::string name;
  std::string value;
};

std::string holes_text(const TagTemplate& tag) {
  if (tag.holes.empty()) return "none";
  std::set<std::string> diameters;
  for (const DrillHole& hole : tag.holes) diameters.insert(mm_text(hole.diameter));
  std::string text = fmt::format("{} a plate, diameter", tag.holes.size());
  for (const std::string& diameter : diameters) text += " " + diameter;
  return text + " mm";
}

std::string paper_text(const PrintJob& job) {
  if (job.roll) {
    return fmt::format("{}: {} m, {} % of it waste", job.style.paper->name,
                       format_number(job.roll->length, 2),
                       format_number(job.roll->waste() * 100, 0));
  }
  return job.style.paper ? job.style.paper->name : "a page a plate";
}

std::size_t page_count(const PrintJob& job) {
  return job.units.size() * pages_in_files(job, 0).size() / job.style.formats.size();
}

std::string contours_text(const PrintJob& job) {
  if (job.printed.cut.contour) {
    return std::string("spot colour CutContour in the PDF files") +
           (job.tiles ? "" : ", and the DXF files");
  }
  return job.tiles ? "by the crop marks" : "the DXF files; the PDF files have crop marks";
}

std::vector<OrderLine> order_lines(const PrintJob& job, const PrintRecord& record) {
  const TagTemplate& tag = job.printed;
  const Page page = pages_of(job, job.units.front()).back();
  std::vector<OrderLine> lines{
      {"Survey",
       job.survey->name + (job.style.revision.empty() ? "" : ", revision " + job.style.revision)},
      {"Plates", fmt::format("{}, each different", record.tags.size())},
      {"Plate", fmt::format("{}: {} x {} mm", tag.name, mm_text(tag.plate_length),
                            mm_text(tag.plate_height))},
      {"Material", tag.material.empty() ? "to be agreed: matt, flat, rigid" : tag.material},
      {"Corners",
       tag.cut.corner_radius > 0 ? "radius " + mm_text(tag.cut.corner_radius) + " mm" : "square"},
      {"Holes", holes_text(tag)},
      {"Feature frame inside",
       fmt::format("{} x {} mm: measure it on the first print", mm_text(tag.frame_inner_length),
                   mm_text(tag.frame_inner_height))},
      {"Paper", paper_text(job)},
      {"Pages", fmt::format("{} of {} x {} mm, bleed {} mm", page_count(job), mm_text(page.width),
                            mm_text(page.height), mm_text(job.style.bleed))},
      {"Print", "at 100 %, no fitting to the page, black ink alone"},
      {"Contours", contours_text(job)}};
  if (job.style.printer)
    lines.push_back({"Printer", job.style.printer->name + " only: the PDF "
                                                          "files are scaled for it"});
  return lines;
}

Sheet order_sheet(const PrintJob& job, const PrintRecord& record) {
  constexpr double kLeft = 0.020;
  constexpr double kValues = 0.065;
  constexpr double kRight = 0.190;
  constexpr double kHeight = 0.0025;
  constexpr double kStep = 0.0085;
  Sheet sheet{0.210, 0.297, job.survey->name + " order", "Order of position tags", {}};
  SheetLayer layer{"order", {}};
  const auto add = [&](const std::string& text, double x, double y, double height, double width) {
    layer.items.push_back(
        SheetText{.text = text, .at = {x, y}, .height = height, .max_width = width});
  };
  double y = 0.030;
  add("Order of position tags: " + job.survey->name, kLeft, y, 0.0042, kRight - kLeft);
  for (const OrderLine& line : order_lines(job, record)) {
    y += kStep;
    add(line.name, kLeft, y, kHeight, kValues - kLeft - 0.003);
    for (const std::string& part : lines_of(line.value, kRight - kValues, kHeight)) {
      add(part, kValues, y, kHeight, kRight - kValues);
      y += 1.8 * kHeight;
    }
    y -= 1.8 * kHeight;
  }
  sheet.layers.push_back(std::move(layer));
  return sheet;
}

}  // namespace

std::vector<std::string> order_files(const PrintJob& job) {
  if (!job.style.order) return {};
  std::vector<std::string> names{kOrderPdf};
  if (job.tiles) return names;
  for (const PrintUnit& unit : job.units) names.push_back(cut_file_of(unit));
  return names;
}

Result<void> write_order(const PrintJob& job, const PrintRecord& record, const StagedFiles& files) {
  if (!job.style.order) return {};
  const Sheet sheet = order_sheet(job, record);
  const Result<std::string> pdf = render_pdf({&sheet, 1});
  if (!pdf) return fail(pdf.error().message);
  auto added = files.add(kOrderPdf, *pdf);
  if (job.tiles) return added;
  for (const PrintUnit& unit : job.units) {
    if (!added) return added;
    added = files.add(cut_file_of(unit), render_cut_file(nominal_pages(job, unit).front()));
  }
  return added;
}

}  // namespace tagsmith::detail
