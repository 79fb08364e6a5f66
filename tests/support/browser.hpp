// SPDX-License-Identifier: Apache-2.0
// Opens web pages in headless Chromium.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tagsmith::detail::test {

struct PageVisit {
  std::string result;                // what the script returned, as JSON
  std::vector<std::string> console;  // messages of the page: errors, refused loads, logs
};

// Shows the page in a window of this many pixels without any network, and runs the body of an async
// function of `page` (its window) and `doc` (its document). Throws when Chromium is not installed,
// does not end within 60 s, or the script throws.
PageVisit visit_page(const std::filesystem::path& page, int width, int height,
                     const std::string& script);

}  // namespace tagsmith::detail::test
