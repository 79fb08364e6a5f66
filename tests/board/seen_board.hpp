// SPDX-License-Identifier: Apache-2.0
// Boards for the tests of their sheets, and how the reader looks for their tags.
#pragma once

#include <string>

#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/render/board_page.hpp"
#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail::test {

inline Board board_on(double width, double height, int serial = 0) {
  BoardRequest request{"trial", serial, width, height, board_room(width, height)};
  return make_board(request).value();
}

inline ReadOptions options_for(const Board& board) {
  ReadOptions options;
  options.check = CheckDigit::gs1;
  options.layouts = {layout_of(board.tag)};
  for (const BoardTag& tag : board.tags) options.code_book.push_back(tag.digits);
  return options;
}

// The reading of these digits, or null.
inline const Reading* reading_of(const ReadResult& result, const Digits& digits) {
  for (const Reading& reading : result.tags) {
    if (reading.digits == digits) return &reading;
  }
  return nullptr;
}

}  // namespace tagsmith::detail::test
