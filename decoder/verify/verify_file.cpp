// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "decoder/image/image_header.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/pixel.hpp"
#include "decoder/verify/assemble_tiles.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/diagnose.hpp"
#include "decoder/verify/frame_bow.hpp"
#include "decoder/verify/grade_tags.hpp"
#include "decoder/verify/hanging.hpp"
#include "decoder/verify/hidden_tag.hpp"
#include "decoder/verify/manifest.hpp"
#include "decoder/verify/rasterize.hpp"
#include "decoder/verify/read_for_survey.hpp"
#include "tagsmith/tag/printer_dots.hpp"

namespace tagsmith {
namespace {

// The findings in words: of each tag that is not as it should be.
void describe_tags(FileReport& report) {
  for (const TagFinding& tag : report.tags) {
    if (tag.status == TagStatus::ok || tag.status == TagStatus::cut_off) continue;
    const std::string page = tag.page == 0 ? "" : fmt::format("page {}: ", tag.page);
    report.findings.push_back(fmt::format("{}{}: {}", page, to_string(tag.status), tag.message));
    report.rules.insert(tag.rule);
  }
}

// `page` begins the words.
void find_no_tag(const VerifyRequest& request, FileReport& report, const GrayView& image,
                 const std::string& page = "") {
  const std::optional<Diagnosis> light = diagnose_picture(image);
  // A blank page is no glare.
  const bool is_light = light && (report.width > 0 || light->rule == "too-dark");
  report.findings.push_back(page + "no tag was found" + (is_light ? ": " + light->measured : ""));
  report.rules.insert(is_light ? light->rule : "no-tag");
  if (!request.crops || report.picture) return;
  report.picture = small_picture(image, report.orientation.value_or(1));
}

// `up`: page, or unknown for a scan, which may lie on the glass any way.
std::vector<TagFinding> verify_page(const VerifyRequest& request, const PageImage& page, int number,
                                    UpSource up = UpSource::page) {
  const Survey& survey = request.survey;
  const GrayView image = page.image.view();
  const ReadResult readings = read_for_survey(image, survey, nullptr, request.read);
  std::vector<TagFinding> tags = check_tags(survey, readings, {}, request.also);
  diagnose_tags(image, survey.tag_template, readings, tags);
  find_mirrored(image, survey.tag_template, tags);
  if (up == UpSource::page) find_upside_down(tags);
  if (tags.empty()) {
    if (std::optional<TagFinding> hidden =
            find_hidden_tag(survey, page, readings.frameless, request.read)) {
      tags.push_back(std::move(*hidden));
    }
  }
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

// Of tags that read although they are dirty: where. A grade alone may be the photo's.
void note_dirt(const GrayView& image, const TagTemplate& tag, FileReport& report) {
  constexpr double kClean = 3.5;
  const std::optional<int> up = report.up == UpSource::page ? std::optional(1) : report.orientation;
  for (const TagFinding& finding : report.tags) {
    if (finding.status != TagStatus::ok || !finding.grade || finding.grade->grade >= kClean)
      continue;
    const auto cover = find_cover(image, tag, finding.corners, up);
    if (!cover) continue;
    report.notes.push_back(fmt::format("{} reads, but {}: clean the plate, or replace it",
                                       finding.tag, cover->measured));
  }
}

// The camera that took the photo; null when it is not known.
const Camera* camera_of(const VerifyRequest& request, const std::filesystem::path& path) {
  if (request.rig == nullptr || request.cameras == nullptr) return nullptr;
  const std::optional<PhotoOrigin> origin = request.cameras->origin_of(path);
  return origin ? &request.rig->cameras[origin->camera].camera : nullptr;
}

// How the photo is to be shown; nothing when the camera did not note it.
std::optional<Upright> upright_of(const FileReport& photo) {
  if (!photo.orientation) return std::nullopt;
  return Upright{*photo.orientation, photo.width, photo.height};
}

// Tags on their head. A rig on its wheels knows better than the camera, and is asked when all
// photos are read.
void find_heads(const VerifyRequest& request, const Camera* camera, FileReport& report) {
  const bool of_rig =
      camera != nullptr && camera->width == report.width && camera->height == report.height;
  if (of_rig && stands_level(*request.rig)) {
    report.up = UpSource::rig;
    return;
  }
  const auto in_order = [](const TagFinding& tag) { return tag.status == TagStatus::ok; };
  const auto before = std::ranges::count_if(report.tags, in_order);
  report.up = find_upside_down_by_camera(request.survey, upright_of(report), report.tags);
  if (report.up != UpSource::doubted || before < 2) return;
  report.notes.push_back(fmt::format("all {} tags{}", before, kDoubtedUp));
}

// Which tags the photo would show, were it taken a little to the side.
void name_cut_off(FileReport& photo) {
  std::string names;
  for (const TagFinding& tag : photo.tags) {
    if (!tag.tag.empty()) names += (names.empty() ? "" : ", ") + tag.tag;
  }
  if (!names.empty()) photo.findings.back() += "; not wholly in view: " + names;
}

Result<FileReport> verify_picture(const VerifyRequest& request, const InputFile& file) {
  const Result<DecodedImage> loaded = decode_image(file.path.string(), file.bytes);
  if (!loaded) return fail(loaded.error().message);
  const Survey& survey = request.survey;
  const GrayView image = loaded->image.view();
  FileReport report;
  if (!loaded->warning.empty()) {
    report.notes.push_back(damaged_in_words(loaded->warning));
  }
  report.width = image.width;
  report.height = image.height;
  report.orientation = shown_orientation(file.bytes);
  const Camera* camera = camera_of(request, file.path);
  const ReadResult readings = read_for_survey(image, survey, camera, request.read);
  report.tags = check_tags(survey, readings, PictureSize{image.width, image.height}, request.also);
  diagnose_tags(image, survey.tag_template, readings, report.tags, report.orientation);
  if (readings.tags.empty()) {
    find_hidden_tags(survey, image, camera, readings.frameless, request.read, report.tags);
  }
  find_mirrored(image, survey.tag_template, report.tags);
  find_heads(request, camera, report);
  find_bent(image, survey.tag_template, camera, report.tags);
  find_misplaced(survey, report.tags);
  grade_tags(image, survey.tag_template, report.tags);
  note_dirt(image, survey.tag_template, report);
  if (request.crops) crop_faults(image, report.tags, report.orientation.value_or(1));
  const auto is_cut_off = [](const TagFinding& tag) { return tag.status == TagStatus::cut_off; };
  if (!std::ranges::all_of(report.tags, is_cut_off)) return report;
  find_no_tag(request, report, image);
  name_cut_off(report);
  return report;
}

// A print file's page as one picture, or a scan.
FileReport verify_print_picture(const VerifyRequest& request, const PageImage& image,
                                UpSource up = UpSource::page) {
  FileReport report;
  report.up = up;
  report.tags = verify_page(request, image, 0, up);
  note_dirt(image.image.view(), request.survey.tag_template, report);
  if (report.tags.empty()) find_no_tag(request, report, image.image.view());
  return report;
}

Result<FileReport> verify_svg(const VerifyRequest& request, const InputFile& file) {
  const Result<PageImage> page = rasterize_svg(file.path);
  if (!page) return fail(page.error().message);
  return verify_print_picture(request, *page);
}

// A picture of known resolution: a PNG that the manifest names, or a scan.
Result<FileReport> verify_flat_picture(const VerifyRequest& request, const InputFile& file,
                                       double dots_per_inch, UpSource up) {
  Result<GrayImage> image = decode_gray_image(file.path.string(), file.bytes);
  if (!image) return fail(image.error().message);
  return verify_print_picture(request, {std::move(*image), kMetresPerInch / dots_per_inch, {}}, up);
}

Result<FileReport> verify_pdf(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<std::vector<PageSize>> pages = pdf_pages(path);
  if (!pages) return fail(pages.error().message);
  FileReport report;
  report.up = UpSource::page;
  report.pages = static_cast<int>(pages->size());
  for (int number = 1; number <= report.pages; ++number) {
    const PageSize& size = (*pages)[static_cast<std::size_t>(number - 1)];
    const Result<PageImage> page = rasterize_page(path, number, size);
    if (!page) return fail(page.error().message);
    if (!page->error.empty()) {
      report.notes.push_back(
          fmt::format("page {}: the file is damaged, and others may draw it otherwise: {}", number,
                      page->error));
    }
    const std::vector<TagFinding> tags = verify_page(request, *page, number);
    if (tags.empty())
      find_no_tag(request, report, page->image.view(), fmt::format("page {}: ", number));
    std::ranges::copy(tags, std::back_inserter(report.tags));
  }
  find_repeats(report.tags);
  return report;
}

// The pages that are not of the size they were printed with: no tile of them is at its place.
void check_page_sizes(const TilePlan& plan, const std::vector<PageSize>& pages,
                      FileReport& report) {
  constexpr double kSameSize = 0.001;  // metres
  for (std::size_t i = 0; i < pages.size(); ++i) {
    if (std::abs(pages[i].width - plan.page_width) < kSameSize &&
        std::abs(pages[i].height - plan.page_height) < kSameSize) {
      continue;
    }
    report.rules.insert("wrong-scale");
    report.findings.push_back(
        fmt::format("page {}: is {:.0f} x {:.0f} mm, expected {:.0f} x {:.0f} mm (manifest.json)",
                    i + 1, 1e3 * pages[i].width, 1e3 * pages[i].height, 1e3 * plan.page_width,
                    1e3 * plan.page_height));
    return;
  }
}

// A PDF of tiles: for each tag the assembly sheet, then its tiles.
Result<FileReport> verify_tiled_pdf(const VerifyRequest& request, const InputFile& file,
                                    const TilePlan& plan, std::size_t tags) {
  const Result<std::vector<PageSize>> pages = pdf_pages(file.path);
  if (!pages) return fail(pages.error().message);
  FileReport report;
  report.up = UpSource::page;
  report.pages = static_cast<int>(pages->size());
  const int a_tag = 1 + plan.tiles();
  if (pages->size() != tags * static_cast<std::size_t>(a_tag)) {
    report.rules.insert("missing-in-file");
    report.findings.push_back(
        fmt::format("has {} pages, expected {}: an assembly sheet and {} "
                    "tiles for each tag",
                    pages->size(), tags * static_cast<std::size_t>(a_tag), plan.tiles()));
    return report;
  }
  check_page_sizes(plan, *pages, report);
  if (!report.findings.empty()) return report;
  for (int first = 1; first <= report.pages; first += a_tag) {
    std::vector<TilePage> tiles;
    for (int tile = 1; tile <= plan.tiles(); ++tile) tiles.push_back({file.path, first + tile});
    const Result<PageImage> plate = assemble_tiles(plan, tiles);
    if (!plate) return fail(plate.error().message);
    const std::vector<TagFinding> found = verify_page(request, *plate, first);
    if (found.empty()) {
      find_no_tag(request, report, plate->image.view(),
                  fmt::format("the plate of page {}: ", first));
    }
    std::ranges::copy(found, std::back_inserter(report.tags));
  }
  find_repeats(report.tags);
  return report;
}

// Tiles as SVG or PNG, a file each, NAME-A1.svg the first: with that one the plate is checked.
// Nothing for the other files, which go with it.
Result<std::optional<FileReport>> verify_tile_files(const VerifyRequest& request,
                                                    const InputFile& file, const TilePlan& plan,
                                                    int dots_per_inch) {
  const std::string stem = file.path.stem().string();
  const std::string first = "-" + tile_address(0, 0);
  if (!stem.ends_with(first)) return std::nullopt;
  const std::string name = stem.substr(0, stem.size() - first.size());
  std::vector<TilePage> tiles;
  FileReport incomplete;
  for (int row = 0; row < plan.rows; ++row) {
    for (int column = 0; column < plan.columns; ++column) {
      std::filesystem::path tile = file.path;
      tile.replace_filename(name + "-" + tile_address(column, row) +
                            file.path.extension().string());
      tiles.push_back({tile, 0});
      if (std::filesystem::exists(tile)) continue;
      incomplete.rules.insert("missing-in-file");
      incomplete.findings.push_back("its tile " + tile.filename().string() + " is not here");
    }
  }
  if (!incomplete.findings.empty()) return incomplete;
  const Result<PageImage> plate =
      dots_per_inch > 0 ? assemble_tiles(plan, tiles, dots_per_inch) : assemble_tiles(plan, tiles);
  if (!plate) return fail(plate.error().message);
  return verify_print_picture(request, *plate);
}

Result<FileReport> read_and_check(const VerifyRequest& request, const InputFile& file,
                                  int dots_per_inch) {
  if (is_pdf(file.bytes)) return verify_pdf(request, file.path);
  if (is_called_pdf(file.path)) {
    return fail(file.path.string() + ": is called .pdf and is none: `%PDF-` is not at its start");
  }
  if (is_svg(file.path)) return verify_svg(request, file);
  if (dots_per_inch > 0) return verify_flat_picture(request, file, dots_per_inch, UpSource::page);
  if (request.scan_dpi) {
    return verify_flat_picture(request, file, *request.scan_dpi, UpSource::unknown);
  }
  return verify_picture(request, file);
}

// What the file shows of the tags that the manifest says it holds; nothing when it is no file to
// read: a document, a tile that another file stands for, or tiles of unknown places.
Result<std::optional<FileReport>> read_printed(const VerifyRequest& request, const InputFile& file,
                                               const PrintManifest& manifest, ManifestEntry entry) {
  if (entry == ManifestEntry::tags) {
    Result<FileReport> read = read_and_check(request, file, manifest.dots_per_inch);
    if (!read) return fail(read.error().message);
    return std::optional(std::move(*read));
  }
  if (entry != ManifestEntry::tiles || !manifest.tiles) return std::nullopt;
  if (!is_pdf(file.bytes)) {
    const int dpi = is_svg(file.path) ? 0 : manifest.dots_per_inch;
    return verify_tile_files(request, file, *manifest.tiles, dpi);
  }
  const std::size_t tags = tags_of_file(manifest, file.path.filename().string()).size();
  Result<FileReport> read = verify_tiled_pdf(request, file, *manifest.tiles, tags);
  if (!read) return fail(read.error().message);
  return std::optional(std::move(*read));
}

// A file that `print` wrote.
Result<FileReport> verify_printed(const VerifyRequest& request, const InputFile& file,
                                  const PrintManifest& manifest, ManifestEntry entry) {
  Result<std::optional<FileReport>> read = read_printed(request, file, manifest, entry);
  if (!read) return fail(read.error().message);
  FileReport report = *read ? std::move(**read) : FileReport{};
  report.file = file.path;
  report.sha256 = file.sha256;
  if (*read) report = check_against_manifest(manifest, std::move(report));
  return check_freshness(manifest, request.survey, std::move(report));
}

Result<std::shared_ptr<const PrintManifest>> manifest_of(const VerifyRequest& request,
                                                         const std::filesystem::path& path) {
  if (request.manifests != nullptr) return request.manifests->find(path);
  return ManifestCache().find(path);
}

}  // namespace

Result<FileReport> verify_file(const VerifyRequest& request, const InputFile& file) {
  const Result<std::shared_ptr<const PrintManifest>> manifest = manifest_of(request, file.path);
  if (!manifest) return fail(manifest.error().message);
  const ManifestEntry entry =
      *manifest ? entry_of(**manifest, file.path.filename().string()) : ManifestEntry::stranger;
  Result<FileReport> report = entry == ManifestEntry::stranger
                                  ? read_and_check(request, file, 0)
                                  : verify_printed(request, file, **manifest, entry);
  if (!report) return report;
  report->file = file.path;
  report->sha256 = file.sha256;
  describe_tags(*report);
  return report;
}

Result<FileReport> verify_file(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<InputFile> file = read_input_file(path);
  if (!file) return fail(file.error().message);
  return verify_file(request, *file);
}

}  // namespace tagsmith
