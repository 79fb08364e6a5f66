// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>

namespace tagsmith::detail {

// The next line without its end; nothing at the stream's end. Of a longer line than `most` bytes,
// its first `most` + 1: the rest is still to be read.
std::optional<std::string> read_line(std::istream& stream, std::size_t most);

}  // namespace tagsmith::detail
