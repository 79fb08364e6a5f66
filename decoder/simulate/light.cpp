// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/light.hpp"

#include <algorithm>

namespace tagsmith::detail {

double irradiance(const Lighting& lighting, double distance, double cosine) {
  const double reach = std::max(distance, lighting.lamp_near);
  return lighting.ambient + lighting.lamp * std::max(cosine, 0.0) / (reach * reach);
}

}  // namespace tagsmith::detail
