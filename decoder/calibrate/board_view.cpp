// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/board_view.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "decoder/reader/reader.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {
namespace {

// The board and the tag that a code belongs to.
using TagsByCode = std::map<Digits, std::pair<std::size_t, std::size_t>>;

TagsByCode tags_by_code(std::span<const Board> boards) {
  TagsByCode tags;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    for (std::size_t t = 0; t < boards[b].tags.size(); ++t) {
      tags.try_emplace(boards[b].tags[t].digits, b, t);
    }
  }
  return tags;
}

ReadOptions read_options_of(std::span<const Board> boards) {
  ReadOptions options;
  options.check = CheckDigit::gs1;
  options.layouts.clear();
  for (const Board& board : boards) {
    for (const BoardTag& tag : board.tags) options.code_book.push_back(tag.digits);
    const SymbolLayout layout = layout_of(board.tag);
    if (std::ranges::find(options.layouts, layout) == options.layouts.end()) {
      options.layouts.push_back(layout);
    }
  }
  return options;
}

SeenBoardTag seen_tag(const Reading& reading, std::size_t board, std::size_t tag) {
  SeenBoardTag seen{board, tag, CornerPixels::Zero(), reading.corner_covariance};
  for (std::size_t i = 0; i < reading.corners.size(); ++i) {
    seen.pixels.segment<2>(static_cast<Eigen::Index>(2 * i)) << reading.corners[i].x,
        reading.corners[i].y;
  }
  return seen;
}

bool is_same_tag(const SeenBoardTag& a, const SeenBoardTag& b) {
  return a.board == b.board && a.tag == b.tag;
}

// A code that is read twice counts for no board: at least one of the two is a copy or a reflection.
// Where there are several, there is another print of the board, and others of its tags may be among
// those that are read once.
void take_tags(const ReadResult& result, std::span<const Board> boards, BoardView& view) {
  const TagsByCode tags = tags_by_code(boards);
  std::vector<SeenBoardTag> seen;
  std::vector<bool> is_twice;
  for (const Reading& reading : result.tags) {
    const auto tag = tags.find(reading.digits);
    if (tag == tags.end() || reading.corner_covariance.isZero(0)) continue;
    const SeenBoardTag one = seen_tag(reading, tag->second.first, tag->second.second);
    const auto other =
        std::ranges::find_if(seen, [&](const SeenBoardTag& o) { return is_same_tag(o, one); });
    if (other == seen.end()) {
      seen.push_back(one);
      is_twice.push_back(false);
    } else {
      is_twice[static_cast<std::size_t>(other - seen.begin())] = true;
    }
  }
  const auto twice = std::ranges::count(is_twice, true);
  if (twice > 1) {
    const std::size_t board =
        seen[static_cast<std::size_t>(std::ranges::find(is_twice, true) - is_twice.begin())].board;
    view.objection = fmt::format(
        "shows {} tags of {} twice: there are two prints of the board, of which each needs a "
        "--serial, or a reflection",
        twice, boards[board].name);
    return;
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!is_twice[i]) view.tags.push_back(seen[i]);
  }
}

Eigen::Vector2d middle_of(const SeenBoardTag& tag) {
  return tag.pixels.reshaped(2, 4).rowwise().mean();
}

Eigen::Vector2d middle_of(const Board& board, const BoardTag& tag) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const PlatePoint& corner : corners_of(board, tag)) {
    middle += Eigen::Vector2d(corner.x, corner.y) / 4;
  }
  return middle;
}

std::vector<const SeenBoardTag*> tags_of(const BoardView& view, std::size_t board) {
  std::vector<const SeenBoardTag*> tags;
  for (const SeenBoardTag& tag : view.tags) {
    if (tag.board == board) tags.push_back(&tag);
  }
  return tags;
}

// Whether the board's tags are mirrored compared with the board: by the affine map that fits their
// middles best. No lens mirrors them. Fewer than three tags, or tags in a row, do not show it.
bool is_mirrored(const BoardView& view, std::size_t board, const Board& on) {
  const std::vector<const SeenBoardTag*> seen = tags_of(view, board);
  const auto count = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixX2d places(count, 2), pixels(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SeenBoardTag& tag = *seen[static_cast<std::size_t>(i)];
    places.row(i) = middle_of(on, on.tags[tag.tag]);
    pixels.row(i) = middle_of(tag);
  }
  if (count < 3) return false;
  places.rowwise() -= places.colwise().mean().eval();
  pixels.rowwise() -= pixels.colwise().mean().eval();
  const Eigen::Matrix2d spread = places.transpose() * places;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spreads(spread, Eigen::EigenvaluesOnly);
  constexpr double kInARow = 1e-3;  // of the squared spread along the row
  if (spreads.eigenvalues()[0] < kInARow * spreads.eigenvalues()[1]) return false;
  return (spread.inverse() * places.transpose() * pixels).determinant() < 0;
}

// Whether two photos show the boards from one place: each board that either shows, in both. A
// camera or board in the hand moves by more.
bool shows_the_same(const BoardView& a, const BoardView& b, std::size_t boards) {
  constexpr double kSame = 0.3;  // pixels, root mean square
  bool any = false;
  for (std::size_t board = 0; board < boards; ++board) {
    const auto here = tags_of(a, board), there = tags_of(b, board);
    double squares = 0;
    std::size_t common = 0;
    for (const SeenBoardTag* tag : here) {
      const auto other = std::ranges::find(there, tag->tag, &SeenBoardTag::tag);
      if (other == there.end()) continue;
      squares += (tag->pixels - (*other)->pixels).squaredNorm() / 8;
      ++common;
    }
    const std::size_t most = std::max(here.size(), there.size());
    if (most == 0) continue;
    any = true;
    if (2 * common <= most || squares >= kSame * kSame * static_cast<double>(common)) return false;
  }
  return any;
}

// A tag's inner corners in the photo; nothing where one is out of it, or the tag too small.
std::optional<FrameCorners> expected_corners(const BoardGuess& guess, const PlacedBoard& placed,
                                             const Board& board, const BoardTag& tag) {
  constexpr double kLeastModule = 0.4;  // pixels; the reader cannot read smaller ones
  FrameCorners corners{};
  const std::array<PlatePoint, 4> on_board = corners_of(board, tag);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d point(on_board[i].x, on_board[i].y, 0);
    const auto pixel = project(guess.camera, placed.camera_from_board * point);
    if (!pixel || !in_image(guess.camera, *pixel)) return std::nullopt;
    corners[i] = {pixel->x(), pixel->y()};
  }
  const double modules = board.tag.frame_inner_length / module_width(board.tag);
  if (distance(corners[0], corners[1]) < kLeastModule * modules) return std::nullopt;
  return corners;
}

std::vector<ExpectedTag> expected_board_tags(std::span<const Board> boards,
                                             const BoardGuess& guess) {
  std::vector<ExpectedTag> expected;
  for (const PlacedBoard& placed : guess.boards) {
    const Board& board = boards[placed.board];
    for (const BoardTag& tag : board.tags) {
      const auto corners = expected_corners(guess, placed, board, tag);
      if (corners) expected.push_back({*corners});
    }
  }
  return expected;
}

}  // namespace

Result<void> check_boards(std::span<const Board> boards) {
  std::map<Digits, const Board*> owner;
  for (const Board& board : boards) {
    for (const BoardTag& tag : board.tags) {
      const auto [first, is_new] = owner.try_emplace(tag.digits, &board);
      if (is_new) continue;
      return fail(fmt::format(
          "{}: the code {} is on the board {} too, expected every board of a calibration to have "
          "a serial of its own",
          board.file.empty() ? board.name : board.file.string(), to_string(tag.digits),
          first->second->name));
    }
  }
  return {};
}

BoardView read_board_view(const GrayView& image, std::string file, std::span<const Board> boards) {
  BoardView view{std::move(file), image.width, image.height, {}};
  take_tags(read_tags(image, read_options_of(boards)), boards, view);
  return view;
}

void object_to_views(std::span<const Board> boards, std::vector<BoardView>& views) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    BoardView& view = views[i];
    for (std::size_t b = 0; b < boards.size() && view.objection.empty(); ++b) {
      if (is_mirrored(view, b, boards[b])) {
        view.objection = "is mirrored, as by a mirror or a camera's preview: take it unmirrored";
      }
    }
    for (std::size_t j = 0; j < i && view.objection.empty(); ++j) {
      if (view.width != views[j].width) continue;
      if (!shows_the_same(view, views[j], boards.size())) continue;
      view.objection =
          fmt::format("shows the boards from where {} does: no new photo", views[j].file);
    }
    if (!view.objection.empty()) view.tags.clear();
  }
}

BoardView read_board_view_again(const GrayView& image, const BoardView& first,
                                std::span<const Board> boards, const BoardGuess& guess) {
  const bool is_of_size = image.width == guess.camera.width && image.height == guess.camera.height;
  if (!is_of_size || !first.objection.empty()) return first;
  ReadOptions options = read_options_of(boards);
  options.camera = guess.camera;
  options.expected = expected_board_tags(boards, guess);
  options.search = Search::never;
  BoardView again{first.file, image.width, image.height, {}};
  take_tags(read_tags(image, options), boards, again);
  if (!again.objection.empty()) return again;
  const std::vector<SeenBoardTag> found = again.tags;
  for (const SeenBoardTag& tag : first.tags) {
    const auto is_it = [&](const SeenBoardTag& other) { return is_same_tag(other, tag); };
    if (std::ranges::none_of(found, is_it)) again.tags.push_back(tag);
  }
  return again;
}

}  // namespace tagsmith::detail
