// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/calibrate_photos.hpp"

#include <utility>

#include "tagsmith/cli/parallel.hpp"

namespace tagsmith::detail {
namespace {

using ReadView = std::function<BoardView(const GrayView&, std::size_t)>;

// All photos read; the first one that cannot be loaded is the error.
Result<std::vector<BoardView>> read_all(const PhotoSource& photos, std::size_t already_done,
                                        const PhotoCalibrationOptions& options,
                                        const ReadView& read) {
  const std::size_t count = photos.files.size();
  std::vector<BoardView> views(count);
  std::optional<Error> error;
  run_in_order(count, options.jobs, [&](std::size_t i) -> Delivery {
    const Result<GrayImage> image = photos.load(i);
    if (!image) {
      return [&error, what = image.error()] {
        if (!error) error = what;
      };
    }
    views[i] = read(image->view(), i);
    return [&options, already_done, i, count] {
      if (options.on_read) options.on_read(already_done + i + 1, 2 * count);
    };
  });
  if (error) return tl::unexpected(*error);
  return views;
}

}  // namespace

Result<PhotoCalibration> calibrate_photos(const PhotoSource& photos, std::span<const Board> boards,
                                          const PhotoCalibrationOptions& options) {
  if (auto checked = check_boards(boards); !checked) return tl::unexpected(checked.error());
  auto views = read_all(photos, 0, options, [&](const GrayView& image, std::size_t i) {
    return read_board_view(image, photos.files[i], boards);
  });
  if (!views) return tl::unexpected(views.error());
  auto first = calibrate_camera(*views, boards);
  if (!first) return tl::unexpected(first.error());
  auto again =
      read_all(photos, photos.files.size(), options, [&](const GrayView& image, std::size_t i) {
        return read_board_view_again(image, (*views)[i], boards, guess_for(*first, i));
      });
  if (!again) return tl::unexpected(again.error());
  auto calibration = calibrate_camera(*again, boards);
  if (!calibration) return tl::unexpected(calibration.error());
  return PhotoCalibration{std::move(*calibration), std::move(*again)};
}

}  // namespace tagsmith::detail
