// SPDX-License-Identifier: Apache-2.0
// Pages as a PDF.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/page.hpp"

namespace tagsmith {

// A PDF of these pages at true scale: vectors only, pure black, fonts embedded, cut contours in the
// spot colour CutContour, told to print unscaled (print_settings.hpp). The same pages give the same
// bytes. Lengths are kept to 0.0014 mm. Title, subject and keywords are the first page's, unless
// given. Fails without pages, and on pages whose sides PDF cannot say (over 5.08 m: ISO 32000-1,
// Annex C.2).
Result<std::string> render_pdf(std::span<const Page> pages);
Result<std::string> render_pdf(std::span<const Page> pages, const PageNotes& notes);

// Calls the first argument with each page of a document in turn.
using PageSource = std::function<void(const std::function<void(const Page&)>&)>;

// The same PDF, written to the file page by page: only one page is in memory at any time. The
// file's folder must be there.
Result<void> write_pdf(const std::filesystem::path& path, const PageSource& pages,
                       const PageNotes& notes);

}  // namespace tagsmith
