// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace tagsmith {

// A check of an option's text, which says what is wrong: accepts a number of these limits.
// CLI::Range lets "nan" through.
std::function<std::string(const std::string&)> number_between(double low, double high);

}  // namespace tagsmith
