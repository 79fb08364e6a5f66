// SPDX-License-Identifier: Apache-2.0
// The notes of a camera in its photos (EXIF: CIPA DC-008), and the same in HEIF files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tagsmith::detail {

// The orientation in which a JPEG or TIFF must be shown, 1 (as stored) to 8 (tag Orientation);
// nothing for all others and where it is not stated.
std::optional<int> exif_orientation(std::string_view bytes);

// The same for any format that states it: JPEG and TIFF by this tag, HEIF by its own properties.
std::optional<int> shown_orientation(std::string_view bytes);

// A TIFF with the note that pixels are shown as stored: decoders turn others. All else unchanged.
std::string without_orientation(std::string tiff);

// The camera and its lens as they were when the photo was taken.
struct PhotoLens {
  std::string camera;      // maker and model, printable ASCII
  double focal_mm = 0;     // focal length, millimetres; 0 = not stated
  double focal_35_mm = 0;  // of the lens with the same view on 35 mm film, zoom included

  auto operator<=>(const PhotoLens&) const = default;
};

// From a JPEG, TIFF or HEIF; nothing where the model or the equivalent focal length is not stated.
std::optional<PhotoLens> photo_lens(std::string_view bytes);

// When a JPEG, TIFF or HEIF was taken by its camera's clock, as 2026-03-31T14:05:09 with the offset
// from universal time where the camera notes one (+02:00); nothing where it is not stated, or is no
// time.
std::optional<std::string> photo_moment(std::string_view bytes);

}  // namespace tagsmith::detail
