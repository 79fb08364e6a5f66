// SPDX-License-Identifier: Apache-2.0
// A printer's test sheet to be printed.
#pragma once

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/print_paper.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// In the middle of the paper, which stands upright. `profile`: the correction for the printer's
// growth and scale; the default corrects nothing. Fails on paper that is too small for it.
Result<Sheet> printer_sheet(const PrintPaper& paper, const PrinterProfile& profile = {});

}  // namespace tagsmith::detail
