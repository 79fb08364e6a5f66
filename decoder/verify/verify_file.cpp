// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_file.hpp"

#include <algorithm>
#include <map>
#include <span>

#include <fmt/format.h>

#include "decoder/image/load.hpp"
#include "decoder/image/pixel.hpp"
#include "decoder/reader/survey_options.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/diagnose.hpp"
#include "decoder/verify/frame_bow.hpp"
#include "decoder/verify/grade_tags.hpp"
#include "decoder/verify/hanging.hpp"
#include "decoder/verify/manifest.hpp"
#include "decoder/verify/rasterize.hpp"
#include "tagsmith/tag/printer_dots.hpp"

namespace tagsmith {
namespace {

// True when the point lies inside the corners' convex outline, whichever way it turns.
bool lies_in(const FrameCorners& corners, const PixelPoint& point) {
  int left = 0;
  int right = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PixelPoint& a = corners[i];
    const PixelPoint& b = corners[(i + 1) % corners.size()];
    ++(cross(b - a, point - a) < 0 ? left : right);
  }
  return left == 0 || right == 0;
}

PixelPoint middle_of(const FrameCorners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

bool overlap(const FrameCorners& a, const FrameCorners& b) {
  return lies_in(a, middle_of(b)) || lies_in(b, middle_of(a));
}

bool overlaps_any(const std::vector<Reading>& tags, const FrameCorners& corners) {
  return std::ranges::any_of(tags,
                             [&](const Reading& tag) { return overlap(tag.corners, corners); });
}

// The findings in words: of each tag that is not as it should be.
void describe_tags(FileReport& report) {
  for (const TagFinding& tag : report.tags) {
    if (tag.status == TagStatus::ok || tag.status == TagStatus::cut_off) continue;
    const std::string page = tag.page == 0 ? "" : fmt::format("page {}: ", tag.page);
    report.findings.push_back(fmt::format("{}{}: {}", page, to_string(tag.status), tag.message));
    report.rules.insert(tag.rule);
  }
}

void find_no_tag(FileReport& report, const std::string& page = "") {
  report.findings.push_back(page + "no tag was found");
  report.rules.insert("no-tag");
}

std::vector<TagFinding> verify_page(const VerifyRequest& request, const PageImage& page,
                                    int number) {
  const Survey& survey = request.survey;
  const GrayView image = page.image.view();
  std::vector<TagFinding> tags =
      check_tags(survey, read_for_survey(image, survey), {}, request.also);
  diagnose_tags(image, survey.tag_template, read_options_for(std::span(&survey, 1)), tags);
  find_mirrored(image, survey.tag_template, tags);
  find_upside_down(tags);
  for (TagFinding& tag : tags) {
    tag.page = number;
    if (tag.status != TagStatus::ok) continue;
    const std::optional<std::string> size =
        check_print_size(survey.tag_template, tag.corners, page.metres_per_pixel);
    if (!size) continue;
    tag.status = TagStatus::misprinted;
    tag.rule = "wrong-scale";
    tag.message = fmt::format("{}: {}", tag.tag, *size);
  }
  grade_tags(image, survey.tag_template, tags);
  if (request.crops) crop_faults(image, tags);
  return tags;
}

// A tag that an earlier page already holds.
void find_repeats(std::vector<TagFinding>& tags) {
  std::map<std::string, int> first_page;
  for (TagFinding& tag : tags) {
    if (tag.status != TagStatus::ok) continue;
    const auto [first, is_new] = first_page.emplace(tag.tag, tag.page);
    if (is_new) continue;
    tag.status = TagStatus::duplicate;
    tag.rule = "duplicate";
    tag.message = fmt::format("{} is on page {} already, expected once", tag.tag, first->second);
  }
}

// The camera that took the photo; null when it is not known.
const Camera* camera_of(const VerifyRequest& request, const std::filesystem::path& path) {
  if (request.rig == nullptr || request.cameras == nullptr) return nullptr;
  const std::optional<PhotoOrigin> origin = request.cameras->origin_of(path);
  return origin ? &request.rig->cameras[origin->camera].camera : nullptr;
}

Result<FileReport> verify_picture(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<GrayImage> loaded = load_gray_image(path);
  if (!loaded) return fail(loaded.error().message);
  const Survey& survey = request.survey;
  const GrayView image = loaded->view();
  FileReport report;
  report.file = path;
  report.tags = check_tags(survey, read_for_survey(image, survey),
                           PictureSize{image.width, image.height}, request.also);
  diagnose_tags(image, survey.tag_template, read_options_for(std::span(&survey, 1)), report.tags);
  find_mirrored(image, survey.tag_template, report.tags);
  find_bent(image, survey.tag_template, camera_of(request, path), report.tags);
  find_misplaced(survey, report.tags);
  report.width = image.width;
  report.height = image.height;
  grade_tags(image, survey.tag_template, report.tags);
  if (request.crops) crop_faults(image, report.tags);
  const auto is_cut_off = [](const TagFinding& tag) { return tag.status == TagStatus::cut_off; };
  if (!std::ranges::all_of(report.tags, is_cut_off)) return report;
  if (const std::optional<Diagnosis> light = diagnose_picture(image)) {
    report.findings.push_back("no tag was found: " + light->measured);
    report.rules.insert(light->rule);
  } else {
    find_no_tag(report);
  }
  return report;
}

// A print file's page as one picture.
Result<FileReport> verify_print_picture(const VerifyRequest& request,
                                        const std::filesystem::path& path, const PageImage& image) {
  FileReport report;
  report.file = path;
  report.tags = verify_page(request, image, 0);
  if (report.tags.empty()) find_no_tag(report);
  return report;
}

Result<FileReport> verify_svg(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<PageImage> page = rasterize_svg(path);
  if (!page) return fail(page.error().message);
  return verify_print_picture(request, path, *page);
}

// A PNG that the manifest names has a resolution; any other picture is a photo.
Result<FileReport> verify_png(const VerifyRequest& request, const std::filesystem::path& path,
                              int dots_per_inch) {
  Result<GrayImage> image = load_gray_image(path);
  if (!image) return fail(image.error().message);
  return verify_print_picture(request, path, {std::move(*image), kMetresPerInch / dots_per_inch});
}

Result<FileReport> verify_pdf(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<std::vector<PageSize>> pages = pdf_pages(path);
  if (!pages) return fail(pages.error().message);
  FileReport report;
  report.file = path;
  report.pages = static_cast<int>(pages->size());
  for (int number = 1; number <= report.pages; ++number) {
    const PageSize& size = (*pages)[static_cast<std::size_t>(number - 1)];
    const Result<PageImage> page = rasterize_page(path, number, size);
    if (!page) return fail(page.error().message);
    const std::vector<TagFinding> tags = verify_page(request, *page, number);
    if (tags.empty()) find_no_tag(report, fmt::format("page {}: ", number));
    std::ranges::copy(tags, std::back_inserter(report.tags));
  }
  find_repeats(report.tags);
  return report;
}

Result<FileReport> read_and_check(const VerifyRequest& request, const std::filesystem::path& path,
                                  int dots_per_inch) {
  if (is_pdf(path)) return verify_pdf(request, path);
  if (is_svg(path)) return verify_svg(request, path);
  return dots_per_inch > 0 ? verify_png(request, path, dots_per_inch)
                           : verify_picture(request, path);
}

// A file that `print` wrote: documents hold no tag, tiles none that could be read alone.
Result<FileReport> verify_printed(const VerifyRequest& request, const std::filesystem::path& path,
                                  const PrintManifest& manifest, ManifestEntry entry) {
  FileReport report;
  report.file = path;
  if (entry == ManifestEntry::tags) {
    Result<FileReport> read = read_and_check(request, path, manifest.dots_per_inch);
    if (!read) return read;
    report = check_against_manifest(manifest, std::move(*read));
  }
  return check_freshness(manifest, request.survey, std::move(report));
}

}  // namespace

ReadResult merge_readings(const ReadResult& first, const ReadResult& second) {
  ReadResult merged{first.tags, {}};
  for (const Reading& tag : second.tags) {
    if (!overlaps_any(first.tags, tag.corners)) merged.tags.push_back(tag);
  }
  for (const Rejection& rejection : first.rejected) {
    if (!overlaps_any(merged.tags, rejection.corners)) merged.rejected.push_back(rejection);
  }
  return merged;
}

ReadResult read_for_survey(const GrayView& image, const Survey& survey) {
  const ReadOptions with_code_book = read_options_for(std::span(&survey, 1));
  ReadOptions any_code;
  any_code.layouts = with_code_book.layouts;
  const ReadResult first = read_tags(image, any_code);
  if (with_code_book.code_book.empty()) return merge_readings(first, {});
  return merge_readings(first, read_tags(image, with_code_book));
}

Result<FileReport> verify_file(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<std::optional<PrintManifest>> manifest = find_manifest(path);
  if (!manifest) return fail(manifest.error().message);
  const ManifestEntry entry =
      *manifest ? entry_of(**manifest, path.filename().string()) : ManifestEntry::stranger;
  Result<FileReport> report = entry == ManifestEntry::stranger
                                  ? read_and_check(request, path, 0)
                                  : verify_printed(request, path, **manifest, entry);
  if (report) describe_tags(*report);
  return report;
}

}  // namespace tagsmith
