// SPDX-License-Identifier: Apache-2.0
// A whole file against the survey: a picture, or a PDF that was printed from it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "decoder/grade/grade.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/verify/evidence.hpp"
#include "decoder/verify/manifest.hpp"
#include "decoder/verify/photo_cameras.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// ---- Print quality of the tags that were found in order.

// The reflectances that are assumed for the template's reference patches: plain white film, solid
// ink.
inline constexpr double kWhitePatchReflectance = 0.85;
inline constexpr double kBlackPatchReflectance = 0.04;

// Light of the plate's reference patches; `corners` are the feature frame's. Nothing when the
// template has none, one leaves the picture, the white one is overexposed, or the two differ by
// less than a tenth of all light.
std::optional<ReflectanceReferences> find_references(const GrayView& image, const TagTemplate& tag,
                                                     const FrameCorners& corners);

// Fills `grade`, or `grade_reason`.
void grade_tag(const GrayView& image, const TagTemplate& tag, VerifiedTag& verified);

// ---- The file.

// A file to be verified, read once: its hash and its picture come from the same bytes.
struct InputFile {
  std::filesystem::path path;
  std::string bytes;
  std::string sha256;
};

// Fails when the file cannot be read, is no regular file, or has more than 512 MiB.
Result<InputFile> read_input_file(const std::filesystem::path& path);

// What files are verified against; the surveys outlive it.
struct VerifyRequest {
  const Survey& survey;
  std::span<const Survey> also{};      // other surveys, whose tags do not belong here
  bool crops = false;                  // whether faults get their pictures
  ManifestCache* manifests = nullptr;  // shared by the files; null = each one's is parsed anew
  // Of photos, where known: their cameras. Both or neither.
  const Rig* rig = nullptr;
  const PhotoCameras* cameras = nullptr;
  // Pictures are scans of so many dots per inch, not photos: sizes are checked as in print files.
  std::optional<double> scan_dpi{};
  std::string also_revisions{};  // of `also`, for conditions_of
  PictureReading read = read_tags;
};

// What the file's result depends on besides its content and the survey: resolution of a scan, its
// name and the manifest beside it, the other surveys, the lens of its camera and which way is up in
// its photos. A result that was found under other conditions cannot be used for the file. (Where
// tags hang, by a rig, is judged from all files again.) Empty = nothing of these; fails as
// find_manifest does.
Result<std::string> conditions_of(const VerifyRequest& request, const std::filesystem::path& path);

// Reads the file and checks its tags. In print files (PDF, SVG, and PNG that the manifest beside it
// names) every page must hold a tag, the printed size must be the template's, and the content what
// the manifest says; the file must be the one that was printed, and not stale. Tiles are put
// together first: the pages of a PDF, or, with the first tile of a plate, its files. The
// installer's documents are not read, the rest is checked. Fails when the file cannot be read at
// all.
Result<VerifiedFile> verify_file(const VerifyRequest& request, const InputFile& file);
Result<VerifiedFile> verify_file(const VerifyRequest& request, const std::filesystem::path& path);

}  // namespace tagsmith::detail
