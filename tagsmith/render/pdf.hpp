// SPDX-License-Identifier: Apache-2.0
// Sheets as a PDF.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/pdf_x.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

// A PDF of these sheets at true scale: vectors only except for pictures, black as the black ink
// alone, fonts embedded, cut contours in a spot colour, marked to be printed unscaled
// (print_settings.hpp). The same sheets give the same bytes. Lengths are exact to 0.0014 mm. Title,
// subject and keywords are the first sheet's. Fails without sheets, and on sheets whose sides PDF
// cannot express (over 5.08 m: ISO 32000-1, Annex C.2). With an output intent it is PDF/X-4, which
// has no colours except black, white and spot colours: fails then on contours where the press has
// no process inks.
Result<std::string> render_pdf(std::span<const Sheet> sheets, const OutputIntent* intent = nullptr);

// Calls the first argument with each sheet of a document in turn.
using SheetSource = std::function<void(const std::function<void(const Sheet&)>&)>;

// The same PDF, written to the file sheet by sheet: only one is in memory at any time. The file's
// folder must be there.
Result<void> write_pdf(const std::filesystem::path& path, const SheetSource& sheets,
                       const OutputIntent* intent = nullptr);

}  // namespace tagsmith::detail
