// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Why a solution cannot be where the vehicle is: it lies in the rock. Empty when it does not.
std::string outside_tunnel(const Tunnel& tunnel, const Eigen::Vector3d& position_in_world);

}  // namespace tagsmith::detail
