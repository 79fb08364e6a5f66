// SPDX-License-Identifier: Apache-2.0
// How well the published method, with two tags of facing walls and the distance to the left wall,
// would know a vehicle's place: what plan_drive compares with, where PlanOptions::paper asks for
// it.
#pragma once

#include <optional>
#include <span>

#include "tagsmith/placement/drive_plan.hpp"

namespace tagsmith::detail {

// Of the sights, the pair of tags that the method takes (see localize_by_paper), with D1 and D2
// from the corners P and Q. Nothing without such a pair, without a range to the left wall, or with
// a stagger of zero. D1, D2 and d are varied by their standard deviations over a fixed set of 52
// draws, because the method is far from linear where it has hardly a solution left.
std::optional<PaperExpectation> expect_by_paper(const Survey& survey, const Rig& rig,
                                                const VehiclePose& pose,
                                                std::span<const PlateSight> sights,
                                                const AccuracyOptions& options);

}  // namespace tagsmith::detail
