// SPDX-License-Identifier: Apache-2.0
// What the paper reports, for comparison.
#pragma once

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

// Mean errors over the points of an experiment of Xu et al. 2017, metres.
struct PublishedErrors {
  const char* experiment;
  double mean_plane;   // (27)
  double mean_height;  // (25)
};

inline constexpr PublishedErrors kPublishedStraight{"straight corridor", 0.142, 0.083};
inline constexpr PublishedErrors kPublishedCurved{"curved tunnel", 0.381, 0.151};

// Of the experiment whose tunnel is of this kind.
inline const PublishedErrors& published_errors_for(const Centerline& centerline) {
  for (const CenterlineElement& element : centerline.elements()) {
    if (element.curvature != 0) return kPublishedCurved;
  }
  return kPublishedStraight;
}

}  // namespace tagsmith::detail
