// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/board_page.hpp"

#include <array>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/print_paper.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {
namespace {

// What is printed along the borders, from the sheet's edges.
constexpr double kLeftInk = 0.0125;  // the vertical scale bar's text ends there
constexpr double kTopInk = 0.0135;   // the second note
constexpr double kLowerInk = 0.013;  // the horizontal scale bar's text
constexpr double kBlank = 0.005;     // printers leave it so

constexpr double kMarkArm = 0.0025;
constexpr double kMarkRoom = 0.018;  // of cross and letter, from the sheet's edge
constexpr double kLeastNoteHeight = 0.0018;

// A cross and its letter, towards the middle of the sheet.
void add_mark(Page& page, const PlatePoint& at, const std::string& letter) {
  constexpr double kGap = 0.0018;
  page.lines.push_back({{at.x - kMarkArm, at.y}, {at.x + kMarkArm, at.y}});
  page.lines.push_back({{at.x, at.y - kMarkArm}, {at.x, at.y + kMarkArm}});
  const bool on_left = at.x < page.width / 2;
  const double aside = kMarkArm + kGap + (on_left ? 0 : kNoteHeight);
  page.texts.push_back({.text = letter,
                        .x = on_left ? at.x + aside : at.x - aside,
                        .y = at.y + kNoteHeight / 2,
                        .height = kNoteHeight,
                        .max_width = 2 * kNoteHeight});
}

void add_marks(Page& page) {
  constexpr std::array<const char*, 4> kLetters{"A", "B", "C", "D"};
  const auto marks = board_marks(page.width, page.height);
  for (std::size_t i = 0; i < marks.size(); ++i) add_mark(page, marks[i], kLetters[i]);
}

std::string print_note(const Board& board, const BoardNotes& notes) {
  return board.name + "  \u00b7  serial " + std::to_string(board.serial) + "  \u00b7  " +
         notes.program + "  \u00b7  print at 100 %, not \"fit to page\": both bars are " +
         mm_text(kScaleBarLength) + " mm";
}

std::string measure_note(const Board& board, const BoardNotes& notes) {
  const auto [right, down] = drawn_distances(board.width, board.height);
  const std::string glue =
      notes.to_glue ? "glue on a flat plate (glass, aluminium composite), " : "keep flat, ";
  return glue + "check with a straight edge  \u00b7  A\u2013B " + mm_text(right) + ", A\u2013C " +
         mm_text(down) + " mm: measure, write into " + notes.board_file;
}

std::string sheet_note(const Board& board, const BoardNotes& notes) {
  return notes.sheet + " " + mm_text(board.width) + " \u00d7 " + mm_text(board.height) + " mm";
}

std::string module_note(const Board& board) {
  return "module " + mm_text(module_width(board.tag), 4) + " mm, " +
         std::to_string(board.tag.dots_per_inch) + " dpi";
}

// On either side of the horizontal scale bar, where there is room.
void add_lower_notes(Page& page, const std::string& left, const std::string& right) {
  const double room = (page.width - kScaleBarLength) / 2 - kMarkRoom - 0.004;
  const auto add = [&](const std::string& text, double middle) {
    if (text_width(text, kLeastNoteHeight) > room) return;
    page.texts.push_back({.text = text,
                          .x = middle,
                          .y = page.height - kScaleBarInset,
                          .height = kNoteHeight,
                          .max_width = room,
                          .centred = true});
  };
  add(left, kMarkRoom + room / 2);
  add(right, page.width - kMarkRoom - room / 2);
}

PageNotes page_notes(const Board& board, const BoardNotes& notes) {
  return {.title = "calibration board " + board.name,
          .subject = std::to_string(board.grid.columns) + " x " + std::to_string(board.grid.rows) +
                     " tags, serial " + std::to_string(board.serial) + ", " +
                     sheet_note(board, notes),
          .keywords = notes.program};
}

}  // namespace

Rectangle board_room(double width, double height) {
  return {kLeftInk, kTopInk, width - kLeftInk - kBlank, height - kTopInk - kLowerInk};
}

Page lay_out_board(const Board& board, const BoardNotes& notes) {
  Page page;
  page.notes = page_notes(board, notes);
  page.width = board.width;
  page.height = board.height;
  for (const BoardTag& tag : board.tags) {
    const TagDrawing drawing = draw_tag(board.tag, tag.digits);
    page.tags.push_back({to_string(tag.digits), moved(drawing, tag.corner.x, tag.corner.y)});
  }
  add_scale_bars(page, kScaleBarInset, page.height - kScaleBarInset);
  add_marks(page);
  add_paper_notes(page, print_note(board, notes), measure_note(board, notes),
                  page.width - 2 * kMarkRoom);
  add_lower_notes(page, sheet_note(board, notes), module_note(board));
  return page;
}

}  // namespace tagsmith::detail
