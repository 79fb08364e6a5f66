// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/print_paper.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

const std::array<PrintPaper, 7> kPapers{{{"Letter", 0.2159, 0.2794},
                                         {"A4", 0.210, 0.297},
                                         {"Tabloid", 0.2794, 0.4318},
                                         {"A3", 0.297, 0.420},
                                         {"A2", 0.420, 0.594},
                                         {"A1", 0.594, 0.841},
                                         {"A0", 0.841, 1.189}}};

std::optional<double> millimetres(std::string_view text) {
  const std::optional<double> number = parse_number(text);
  return number ? std::optional(*number / 1000) : std::nullopt;
}

std::optional<PrintPaper> parse_sides(const std::string& text) {
  const std::vector<std::string> sides = split(text, 'x');
  if (sides.size() != 2) return std::nullopt;
  const std::optional<double> width = millimetres(sides[0]);
  const std::optional<double> height = millimetres(sides[1]);
  if (!width || !height) return std::nullopt;
  return PrintPaper{text, *width, *height};
}

std::optional<PrintPaper> parse_size(const std::string& text) {
  if (text.starts_with("roll:")) {
    const std::optional<double> width = millimetres(std::string_view(text).substr(5));
    return width ? std::optional(PrintPaper{text, *width, 0}) : std::nullopt;
  }
  const std::optional<PrintPaper> sides = parse_sides(text);
  if (!sides) return std::nullopt;
  return PrintPaper{text, std::min(sides->width, sides->height),
                    std::max(sides->width, sides->height)};
}

// The least side of a page on which a scale bar fits between the borders.
constexpr double kLeastSide = kScaleBarLength + PaperBorder::kTop + PaperBorder::kBottom;

// `option`: the paper as the user named it. A roll has one side.
Result<PrintPaper> checked(const std::string& option, const PrintPaper& paper) {
  const double shortest = paper.roll() ? paper.width : std::min(paper.width, paper.height);
  if (shortest >= kLeastSide && std::max(paper.width, paper.height) <= kLongestPage) return paper;
  return fail(option + ": expected sides from " + format_number(kLeastSide * 1000) +
              " mm, which a scale bar needs, to " + format_number(kLongestPage * 1000) + " mm");
}

}  // namespace

std::span<const PrintPaper> print_papers() { return kPapers; }

Result<PrintPaper> parse_print_paper(const std::string& text) {
  for (const PrintPaper& paper : kPapers) {
    if (lower_case(paper.name) == lower_case(text)) return paper;
  }
  const std::optional<PrintPaper> paper = parse_size(lower_case(text));
  if (!paper) {
    return fail("--paper " + text +
                ": expected A4, A3, A2, A1, A0, Letter, Tabloid, WIDTHxHEIGHT or roll:WIDTH in "
                "millimetres");
  }
  return checked("--paper " + text, *paper);
}

Result<PrintPaper> parse_print_plate(const std::string& text) {
  const std::optional<PrintPaper> plate = parse_sides(lower_case(text));
  if (!plate) return fail("--plate " + text + ": expected WIDTHxHEIGHT in millimetres");
  return checked("--plate " + text, *plate);
}

Rectangle content_area(double page_width, double page_height) {
  return {PaperBorder::kLeft, PaperBorder::kTop,
          page_width - PaperBorder::kLeft - PaperBorder::kRight,
          page_height - PaperBorder::kTop - PaperBorder::kBottom};
}

void add_paper_notes(Page& page, const std::string& first, const std::string& second,
                     double max_width) {
  constexpr double kBaseline = 0.0085;
  add_note(page, first, kBaseline, max_width);
  add_note(page, second, kBaseline + 1.6 * kNoteHeight, max_width);
}

}  // namespace tagsmith::detail
