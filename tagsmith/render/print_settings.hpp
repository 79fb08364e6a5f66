// SPDX-License-Identifier: Apache-2.0
// What Cairo leaves unsaid in a PDF that must be printed at true scale.
#pragma once

#include <string>

#include "tagsmith/base/result.hpp"

namespace tagsmith {

// The same PDF with
// - /ViewerPreferences that forbid scaling and pick the paper by the page's size (ISO
// 32000-2, 12.2),
// - black as DeviceGray 0, which a printer sets in black ink alone, not as a mixture,
// - no transparency groups and no creation date, and an ID that follows from the content, so that
//   equal input gives equal bytes.
Result<std::string> with_print_settings(const std::string& pdf);

}  // namespace tagsmith
