// SPDX-License-Identifier: Apache-2.0
// How much light each module and each edge of a symbol adds to each place of a profile.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "decoder/scan/characters.hpp"
#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/profile.hpp"

namespace tagsmith::detail {

// For one picture of the symbol. Does not depend on the profile's variances.
class ModuleLight {
 public:
  // Floats side by side in loops over features.
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kMostFeatures = 64;  // that add light to one place

  ModuleLight(const ScanProfile& profile, const ImagingModel& image);

  // What features add to a place; in units of the contrast.
  struct Place {
    std::size_t begin = 0;   // the first feature that adds light
    std::size_t count = 0;   // of features that do
    std::size_t offset = 0;  // of their light in light()
    float value = 0;         // darkness of the place, of 0 to 1
  };

  std::span<const Place> places() const { return places_; }
  // At least kLanes zeros follow each place's own.
  const float* light(const Place& place) const { return light_.data() + place.offset; }

  float contrast() const { return contrast_; }
  // Features this far apart have no overlap.
  std::size_t band() const { return band_; }

 private:
  float contrast_;
  std::size_t band_;
  std::vector<Place> places_;
  std::vector<float> light_;
};

}  // namespace tagsmith::detail
