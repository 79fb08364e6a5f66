// SPDX-License-Identifier: Apache-2.0
// Comma-separated values (RFC 4180).
#pragma once

#include <string>
#include <vector>

namespace tagsmith {

// The fields, quoted where they must be, with CR LF at the end.
std::string csv_row(const std::vector<std::string>& fields);

}  // namespace tagsmith
