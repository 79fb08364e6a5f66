// SPDX-License-Identifier: Apache-2.0
// Lines of comma-separated values (RFC 4180).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tagsmith {

// A line's fields, trimmed; a quoted field ends on its own line. Nothing when a quote is not closed
// or stands in the middle of a field.
std::optional<std::vector<std::string>> split_csv(std::string_view line);

// The fields joined by commas, quoted where they need it, and CR LF.
std::string csv_row(const std::vector<std::string>& fields);

}  // namespace tagsmith
