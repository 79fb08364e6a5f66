// SPDX-License-Identifier: Apache-2.0
// Least squares for models that are not linear in their parameters.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace tagsmith::detail {

// When to stop.
struct DampedSteps {
  int most = 40;          // steps, those that were not taken included
  double settled = 3e-5;  // of the cost: a step that gains or promises less is the last
  // While the cost is greater than this, a step that gains a thousandth of it is the last: where
  // the model explains so little, its parameters are not needed.
  double hopeless = std::numeric_limits<double>::infinity();
  double damping = 1e-3;  // of the first step
};

// Levenberg-Marquardt: steps from `p` on towards the least cost, each damped by a share of the
// normal matrix' diagonal that grows while no step is possible or none gains. `equations_at(p)`
// returns a struct with the normal equations there: `matrix`, `right` (half the cost falls by its
// product with a small step) and `cost`. `constrain(p)` moves parameters back to where the model is
// valid. Moves `p` to the solution and returns the equations there, or those one step of less than
// `settled` before.
template <class Parameters, class EquationsAt, class Constrain>
auto minimise_damped(Parameters& p, const DampedSteps& steps, const EquationsAt& equations_at,
                     const Constrain& constrain) {
  constexpr double kMostDamping = 1e4;
  const auto settled_at = [&](double cost) { return cost > steps.hopeless ? 1e-3 : steps.settled; };
  double damping = steps.damping;
  auto now = equations_at(p);
  for (int step = 0; step < steps.most && damping < kMostDamping; ++step) {
    auto matrix = now.matrix;
    matrix.diagonal() *= 1 + damping;
    const Parameters move = matrix.ldlt().solve(now.right);
    if (!move.allFinite()) {
      damping *= 10;
      continue;
    }
    Parameters next = p + move;
    constrain(next);
    // A step so small gains what the normal equations predict, as far as rounding shows it.
    if (move.dot(now.right) < settled_at(now.cost) * now.cost) {
      p = next;
      break;
    }
    auto tried = equations_at(std::as_const(next));
    if (!(tried.cost < now.cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = now.cost - tried.cost < settled_at(tried.cost) * tried.cost;
    p = next;
    now = std::move(tried);
    damping = std::max(1e-6, damping * 0.2);
    if (settled) break;
  }
  return now;
}

}  // namespace tagsmith::detail
