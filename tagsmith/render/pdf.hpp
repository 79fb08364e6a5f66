// SPDX-License-Identifier: Apache-2.0
// Sheets as a PDF.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

// A PDF of these sheets at true scale: vectors only but for pictures, black as the black ink alone,
// fonts embedded, cut contours in a spot colour, told to print unscaled (print_settings.hpp). The
// same sheets give the same bytes. Lengths are kept to 0.0014 mm. Title, subject and keywords are
// the first sheet's. Fails without sheets, and on sheets whose sides PDF cannot say (over 5.08 m:
// ISO 32000-1, Annex C.2).
Result<std::string> render_pdf(std::span<const Sheet> sheets);

// Calls the first argument with each sheet of a document in turn.
using SheetSource = std::function<void(const std::function<void(const Sheet&)>&)>;

// The same PDF, written to the file sheet by sheet: only one is in memory at any time. The file's
// folder must be there.
Result<void> write_pdf(const std::filesystem::path& path, const SheetSource& sheets);

}  // namespace tagsmith::detail
