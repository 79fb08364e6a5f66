// SPDX-License-Identifier: Apache-2.0
// What a camera notes in its photos (EXIF: CIPA DC-008), and what HEIF files say in its place.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tagsmith::detail {

// Which way up a JPEG or TIFF is to be shown, 1 (as stored) to 8 (tag Orientation); nothing for all
// others and where it is not said.
std::optional<int> exif_orientation(std::string_view bytes);

// The same of any format that says it: JPEG and TIFF by this tag, HEIF by its own properties.
std::optional<int> shown_orientation(std::string_view bytes);

// A TIFF whose pixels are to be shown as they are stored: decoders turn others. All else unchanged.
std::string without_orientation(std::string tiff);

// The camera and its lens as they were when the photo was taken.
struct PhotoLens {
  std::string camera;      // maker and model, printable ASCII
  double focal_mm = 0;     // focal length, millimetres; 0 = not said
  double focal_35_mm = 0;  // of the lens with the same view on 35 mm film, zoom included

  auto operator<=>(const PhotoLens&) const = default;
};

// Of a JPEG, TIFF or HEIF; nothing where the model or the equivalent focal length is not said.
std::optional<PhotoLens> photo_lens(std::string_view bytes);

// When a JPEG, TIFF or HEIF was taken by its camera's clock, as 2026-03-31T14:05:09 with the offset
// from universal time where the camera notes one (+02:00); nothing where it is not said, or is no
// time.
std::optional<std::string> photo_moment(std::string_view bytes);

}  // namespace tagsmith::detail
