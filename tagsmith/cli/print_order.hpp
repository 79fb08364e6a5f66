// SPDX-License-Identifier: Apache-2.0
// What a sign maker gets with the print files.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/print_manifest.hpp"
#include "tagsmith/cli/staged_files.hpp"

namespace tagsmith::detail {

// Names of the order's files: order.pdf, and a cut file for each page. None in an order that is not
// asked for; tiles have no cut files, for their plates are larger than a page.
std::vector<std::string> order_files(const PrintJob& job);

// Makes these files.
Result<void> write_order(const PrintJob& job, const PrintRecord& record, const StagedFiles& files);

}  // namespace tagsmith::detail
