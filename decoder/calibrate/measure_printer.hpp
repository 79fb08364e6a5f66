// SPDX-License-Identifier: Apache-2.0
// A printer's profile from a scan of its test sheet.
#pragma once

#include <string>

#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

struct PrinterMeasurement {
  PrinterProfile profile;
  double growth_spread = 0;  // of single bars about the growth, root mean square, metres
  double mark_error = 0;     // of the marks' corners about the fitted sheet, the same
};

// The scan may have any direction. The scale relies on the scan's stated resolution: the scanner's
// own error is part of it. Fails when a mark was not read, the sheet does not lie flat, its size
// says another resolution, or it has too little contrast; `name` begins the message.
Result<PrinterMeasurement> measure_printer(const std::string& name, const GrayView& scan,
                                           double dots_per_inch);

}  // namespace tagsmith::detail
