// SPDX-License-Identifier: Apache-2.0
// Copies of verified photos that show what was found where.
#pragma once

#include <filesystem>

#include "decoder/verify/finding.hpp"
#include "decoder/verify/input_file.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith {

// Saves NAME-HASH.jpg (of lossless pictures .png), HASH being of the whole path: photos of several
// folders often have one name. Each tag is outlined in the colour of its status, with its name,
// status, grade and what is wrong. Print files (PDF, SVG) have no copy. Fails when the picture
// cannot be decoded or the file cannot be written.
Result<void> save_annotated(const std::filesystem::path& folder, const InputFile& file,
                            const FileReport& report);

}  // namespace tagsmith
