// SPDX-License-Identifier: Apache-2.0
// Bytes as text for data URIs (RFC 4648, section 4).
#pragma once

#include <string>
#include <string_view>

namespace tagsmith::detail {

std::string base64(std::string_view bytes);

}  // namespace tagsmith::detail
