// SPDX-License-Identifier: Apache-2.0
#include "tests/calibrate_command/board_photo_files.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "decoder/image/load.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/board_file.hpp"

namespace tagsmith::detail::test {

Camera photo_camera() { return {960, 720, 700, 700, 487.3, 351.8, {-0.22, 0.05}}; }

void write_photo(const std::filesystem::path& file, const Camera& camera, const Board& board,
                 const BoardStance& stance, std::uint64_t seed) {
  ViewOptions options;
  options.seed = seed;
  options.sensor.noise_sigma = 2;
  const ScenePlate plate = board_plate(board, camera_from_board(camera, board, stance));
  const View view = render_view(camera, std::span(&plate, 1), options);
  const auto saved = save_gray_image(file, view.image.view());
  REQUIRE_MESSAGE(saved.has_value(), saved.error().message);
}

void write_varied_photos(const std::filesystem::path& folder, const Camera& camera,
                         const Board& board, std::size_t count) {
  Draws draws(3);
  for (std::size_t i = 0; i < count; ++i) {
    write_photo(folder / fmt::format("photo{:02}.png", i), camera, board,
                varied_stance(camera, i, draws), i);
  }
}

std::filesystem::path write_board(const std::filesystem::path& file, const Board& board) {
  REQUIRE(write_file(file, board_file_text(board)));
  return file;
}

}  // namespace tagsmith::detail::test
