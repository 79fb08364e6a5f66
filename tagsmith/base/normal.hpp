// SPDX-License-Identifier: Apache-2.0
// The standard normal distribution, from tables: the decoder needs millions of values.
#pragma once

namespace tagsmith {

// Integral of the density up to z, to 1e-7.
double normal_integral(double z);

double normal_density(double z);

}  // namespace tagsmith
