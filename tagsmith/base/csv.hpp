// SPDX-License-Identifier: Apache-2.0
// Lines of comma-separated values (RFC 4180).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tagsmith::detail {

// A line's fields between the separators, trimmed, without the apostrophe that csv_field puts
// before text; a quoted field ends on its own line. Nothing when a quote is not closed or stands in
// the middle of a field.
std::optional<std::vector<std::string>> split_csv(std::string_view line, char separator = ',');

// A field as it is written: in quotes where it needs them. Text that a spreadsheet would read as a
// formula, because it begins with = + - @, a tab or CR after any apostrophes, gets an apostrophe in
// front; numbers stay unchanged.
std::string csv_field(const std::string& text);

// The fields as csv_field writes them, joined by commas, and CR LF.
std::string csv_row(const std::vector<std::string>& fields);

}  // namespace tagsmith::detail
