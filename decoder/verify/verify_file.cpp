// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_file.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/exif.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/diagnose.hpp"
#include "decoder/verify/findings.hpp"
#include "decoder/verify/hanging.hpp"
#include "decoder/verify/rasterize.hpp"
#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/tiled_pages.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// ---- Grades.

namespace {

// Mean light of the rectangle's inner half; nothing when a part of it is outside the picture.
std::optional<double> mean_light(const GrayView& image, const Homography& image_from_frame,
                                 const TagTemplate& tag, const Rectangle& area) {
  constexpr int kSteps = 8;
  const ToneCurve& tone = ToneCurve::of(image);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = area.x + area.width * (0.25 + 0.5 * (i + 0.5) / kSteps);
      const double y = area.y + area.height * (0.25 + 0.5 * (j + 0.5) / kSteps);
      const auto level = sample_nearest(
          image, image_from_frame(x / tag.frame_inner_length, y / tag.frame_inner_height));
      if (!level) return std::nullopt;
      sum += tone.light_of(*level);
    }
  }
  return sum / (kSteps * kSteps);
}

}  // namespace

std::optional<ReflectanceReferences> find_references(const GrayView& image, const TagTemplate& tag,
                                                     const FrameCorners& corners) {
  if (tag.patch_size <= 0) return std::nullopt;
  const std::optional<ReferencePatches> patches = draw_tag(tag, Digits{}).patches;
  if (!patches) return std::nullopt;
  const Homography image_from_frame = homography_to(corners);
  const std::optional<double> white = mean_light(image, image_from_frame, tag, patches->white);
  const std::optional<double> black = mean_light(image, image_from_frame, tag, patches->black);
  constexpr double kOverexposed = 0.98;
  constexpr double kLeastDifference = 0.1;
  const double brightest = image.is_negative ? 1 - black.value_or(0) : white.value_or(1);
  if (!white || !black || brightest > kOverexposed || *white - *black < kLeastDifference) {
    return std::nullopt;
  }
  if (image.is_negative) {
    return ReflectanceReferences{*white, 1 - kBlackPatchReflectance, *black,
                                 1 - kWhitePatchReflectance};
  }
  return ReflectanceReferences{*white, kWhitePatchReflectance, *black, kBlackPatchReflectance};
}

void grade_tag(const GrayView& image, const TagTemplate& tag, VerifiedTag& verified) {
  Result<SymbolGrade> grade = grade_symbol(image, verified.corners, layout_of(tag),
                                           find_references(image, tag, verified.corners));
  if (grade) {
    verified.grade = *grade;
  } else {
    verified.grade_reason = grade.error().message;
  }
}

// ---- The file.

Result<InputFile> read_input_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMaxBytes = 512U << 20U;
  Result<std::string> bytes = read_regular_file(path, kMaxBytes);
  if (!bytes) return fail(bytes);
  std::string hash = sha256(*bytes);
  return InputFile{path, std::move(*bytes), std::move(hash)};
}

// ---- Plates that were printed in pieces, assembled as the assembly sheet says.

namespace {

// Where one tile is drawn.
struct TilePage {
  std::filesystem::path file;
  int number = 0;        // of the page in a PDF, from 1; 0 in a picture
  PrinterScale scale{};  // of the printer that a PDF is for
};

int pixels(double metres, double per_metre) {
  return static_cast<int>(std::lround(metres * per_metre));
}

// The plate at 150 dpi (pictures: at their own `dots_per_inch`; fewer when it would have more than
// 40 million pixels), each window of the plan pasted where it belongs, as the sheets are glued.
// `pages`: row by row, as many as the plan has tiles. Fails when one cannot be drawn.
Result<PageImage> assemble_tiles(const TilePlan& plan, const std::vector<TilePage>& pages,
                                 double dots_per_inch = 150) {
  constexpr double kMaxPixels = 40e6;
  const double width = (plan.columns - 1) * plan.step_right + plan.window.width;
  const double height = (plan.rows - 1) * plan.step_down + plan.window.height;
  // Pictures are used as they are; pages of documents are drawn at the requested resolution.
  const bool scalable = pages.front().number > 0 || is_svg(pages.front().file);
  const double least = std::sqrt(kMaxPixels / (width * height)) * kMetresPerInch;
  const double dpi = scalable ? std::min(dots_per_inch, least) : dots_per_inch;
  const double per_metre = dpi / kMetresPerInch;
  GrayImage plate{pixels(width, per_metre), pixels(height, per_metre), {}};
  constexpr double kMostPixels = 200e6;
  if (static_cast<double>(plate.width) * plate.height > kMostPixels) {
    return fail(pages.front().file.string() + ": the plate in tiles is too large a picture");
  }
  plate.samples.assign(
      static_cast<std::size_t>(plate.width) * static_cast<std::size_t>(plate.height), 255);
  const PixelRegion window{pixels(plan.window.x, per_metre), pixels(plan.window.y, per_metre),
                           static_cast<int>(plan.window.width * per_metre),
                           static_cast<int>(plan.window.height * per_metre)};
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const auto column = static_cast<int>(i) % plan.columns;
    const auto row = static_cast<int>(i) / plan.columns;
    const Result<GrayImage> tile =
        rasterize_part(pages[i].file, pages[i].number, dpi, window, pages[i].scale);
    if (!tile) return fail(tile);
    paste(*tile, plate, pixels(column * plan.step_right, per_metre),
          pixels(row * plan.step_down, per_metre));
  }
  return PageImage{std::move(plate), 1 / per_metre, {}};
}

// ---- The whole file.

// One file to verify, and what its manifest says of it; null and none without a manifest.
struct Task {
  const VerifyRequest& request;
  const InputFile& input;
  const PrintManifest* manifest = nullptr;
  std::vector<ManifestTag> expected{};

  int dots_per_inch() const { return manifest == nullptr ? 0 : manifest->dots_per_inch; }
};

// `page` begins the text.
void find_no_tag(const VerifyRequest& request, VerifiedFile& file, const GrayView& image,
                 const std::string& page = "") {
  const std::optional<Diagnosis> light = diagnose_picture(image);
  // A blank page is no glare.
  const bool is_light = light && (file.is_photo() || light->rule == "too-dark");
  std::string words = page + "no tag was found" + (is_light ? ": " + light->words : "");
  std::vector<std::string> cut_off;
  for (const VerifiedTag& tag : file.tags) {
    if (file.is_photo() && !tag.tag.empty()) cut_off.push_back(tag.tag);
  }
  if (!cut_off.empty()) {
    words += fmt::format("; not wholly in view: {}", fmt::join(cut_off, ", "));
  }
  file.add_finding(is_light ? light->rule : "no-tag", std::move(words));
  if (!request.crops || file.picture.image) return;
  file.picture.image = small_picture(image, file.orientation.value_or(1));
}

// For a tag that reads although it is dirty: where. A grade alone may be caused by the photo.
void note_dirt(const PictureEvidence& evidence, const VerifiedTag& tag, VerifiedFile& file) {
  constexpr double kClean = 3.5;
  if (!tag.grade || tag.grade->grade >= kClean) return;
  const std::optional<int> up =
      evidence.up == UpSource::page ? std::optional(1) : evidence.orientation;
  const auto cover = find_cover(evidence.image, evidence.survey.tag_template, tag.corners, up);
  if (!cover) return;
  file.notes.push_back(
      fmt::format("{} reads, but {}: clean the plate, or replace it", tag.tag, cover->words));
}

// The picture that is judged instead where the plates are white on black.
std::optional<GrayImage> negative_for(const Survey& survey, const GrayImage& image) {
  if (!survey.tag_template.white_on_black) return std::nullopt;
  return exchange_black_and_white(image.view());
}

// Makes the findings, and adds the picture's tags to the file. True when there are some.
bool judge(const VerifyRequest& request, PictureEvidence& evidence, VerifiedFile& file) {
  const GrayView& image = evidence.image;
  find_faults(evidence);
  std::vector<VerifiedTag> tags;
  for (TagEvidence& seen : evidence.tags) {
    VerifiedTag& tag = tags.emplace_back(std::move(seen.tag));
    if (tag.finding.status != TagStatus::ok) continue;
    grade_tag(image, evidence.survey.tag_template, tag);
    if (evidence.page == 0) note_dirt(evidence, tag, file);
  }
  if (request.crops) crop_faults(image, tags, evidence.orientation.value_or(1));
  std::ranges::move(tags, std::back_inserter(file.tags));
  return !tags.empty();
}

// `page`: 0 for a file without pages; `name` begins the message on a page without a tag.
void judge_page(const Task& task, const PageImage& page, int number, const std::string& name,
                VerifiedFile& file) {
  const std::optional<GrayImage> negative = negative_for(task.request.survey, page.image);
  PictureEvidence evidence{task.request.survey, negative ? negative->view() : page.image.view(),
                           task.request.also};
  evidence.page = number;
  evidence.metres_per_pixel = page.metres_per_pixel;
  evidence.expected = task.expected;
  evidence.other_pages = file.tags;
  evidence.up = file.up;
  see_tags(task.request.read, evidence);
  if (!judge(task.request, evidence, file)) {
    find_no_tag(task.request, file, evidence.image, name);
  }
}

// The rig's camera that took the photo; null when it is not known.
const RigCamera* rig_camera_of(const VerifyRequest& request, const std::filesystem::path& path) {
  if (request.rig == nullptr || request.cameras == nullptr) return nullptr;
  const Result<PhotoOrigin> origin = request.cameras->origin_of(path);
  return origin ? &request.rig->cameras[origin->camera] : nullptr;
}

// Its lens, where the photo is of its size.
const Camera* camera_of(const VerifyRequest& request, const std::filesystem::path& path,
                        const GrayView& image) {
  const RigCamera* taken = rig_camera_of(request, path);
  if (taken == nullptr) return nullptr;
  const Camera& camera = taken->camera;
  return camera.width == image.width && camera.height == image.height ? &camera : nullptr;
}

// When the photo was taken: by its camera, else by the run. A file's own date is that of a copy.
std::string moment_of(const Task& task) {
  if (const auto noted = photo_moment(task.input.bytes)) return *noted;
  if (task.request.cameras == nullptr) return {};
  const Result<PhotoOrigin> origin = task.request.cameras->origin_of(task.input.path);
  return origin && origin->time ? unix_moment(*origin->time).value_or("") : "";
}

// Which way is up in a photo. A rig on its wheels determines it better than the camera, and is used
// when all photos have been read.
void find_up(const VerifyRequest& request, PictureEvidence& evidence, VerifiedFile& file) {
  const bool of_rig = evidence.camera != nullptr && stands_level(*request.rig);
  file.up = evidence.up = of_rig ? UpSource::rig : up_of_photo(evidence);
  const auto count = std::ranges::count_if(
      evidence.tags, [&](const TagEvidence& seen) { return reads_well(evidence, seen); });
  if (file.up == UpSource::doubted && count > 1) {
    file.notes.push_back(fmt::format("all {} tags{}", count, kDoubtedUp));
  }
}

Result<VerifiedFile> verify_photo(const Task& task) {
  const VerifyRequest& request = task.request;
  const Result<DecodedImage> loaded = decode_image(task.input.path.string(), task.input.bytes);
  if (!loaded) return fail(loaded);
  const std::optional<GrayImage> negative = negative_for(request.survey, loaded->image);
  const GrayView image = negative ? negative->view() : loaded->image.view();
  VerifiedFile file;
  if (!loaded->warning.empty()) file.notes.push_back(damaged_in_words(loaded->warning));
  file.width = image.width;
  file.height = image.height;
  file.orientation = shown_orientation(task.input.bytes);
  file.lens = photo_lens(task.input.bytes);
  file.taken = moment_of(task);
  PictureEvidence evidence{request.survey, image, request.also};
  evidence.is_photo = true;
  evidence.orientation = file.orientation;
  evidence.camera = camera_of(request, task.input.path, image);
  see_tags(request.read, evidence);
  find_up(request, evidence, file);
  judge(request, evidence, file);
  const auto is_cut_off = [](const VerifiedTag& tag) {
    return tag.finding.status == TagStatus::cut_off;
  };
  if (std::ranges::all_of(file.tags, is_cut_off)) find_no_tag(request, file, image);
  return file;
}

// A print file's page as one picture, or a scan. `up`: page, or unknown for a scan, which may lie
// on the glass any way.
VerifiedFile verify_print_picture(const Task& task, const PageImage& image,
                                  UpSource up = UpSource::page) {
  VerifiedFile file;
  file.up = up;
  judge_page(task, image, 0, "", file);
  return file;
}

// A picture of known resolution: a PNG that the manifest names, or a scan.
Result<VerifiedFile> verify_flat_picture(const Task& task, double dots_per_inch, UpSource up) {
  Result<GrayImage> image = decode_gray_image(task.input.path.string(), task.input.bytes);
  if (!image) return fail(image);
  return verify_print_picture(task, {std::move(*image), kMetresPerInch / dots_per_inch, {}}, up);
}

Result<VerifiedFile> verify_pdf(const Task& task) {
  const std::filesystem::path& path = task.input.path;
  const Result<std::vector<PageSize>> pages = pdf_pages(path);
  if (!pages) return fail(pages);
  VerifiedFile file;
  file.up = UpSource::page;
  file.pages = static_cast<int>(pages->size());
  if (task.input.bytes.find("/UserUnit") != std::string::npos) {
    file.add_finding("wrong-scale",
                     "its pages have a unit of their own (UserUnit), by which printers scale them: "
                     "take the file that was made from the survey");
  }
  for (int number = 1; number <= file.pages; ++number) {
    const Result<PageImage> page =
        rasterize_page(path, number, (*pages)[static_cast<std::size_t>(number - 1)],
                       task.manifest ? task.manifest->scale : PrinterScale{});
    if (!page) return fail(page);
    if (!page->error.empty()) {
      file.notes.push_back(
          fmt::format("page {}: the file is damaged, and others may draw it otherwise: {}", number,
                      page->error));
    }
    judge_page(task, *page, number, fmt::format("page {}: ", number), file);
  }
  return file;
}

// What is wrong with the pages of a PDF of tiles: their number, or the size they were printed with.
// Then no tile is at its place.
void find_wrong_pages(const TilePlan& plan, const PrinterScale& reach, std::size_t expected,
                      const std::vector<PageSize>& pages, VerifiedFile& file) {
  constexpr double kSameSize = 0.001;  // metres
  const PageSize size{plan.page_width / reach.right, plan.page_height / reach.down};
  if (pages.size() != expected) {
    file.add_finding("missing-in-file",
                     fmt::format("has {} pages, expected {}: an assembly sheet and {} tiles for "
                                 "each tag",
                                 pages.size(), expected, plan.tiles()));
    return;
  }
  const auto other = std::ranges::find_if(pages, [&](const PageSize& page) {
    return std::abs(page.width - size.width) >= kSameSize ||
           std::abs(page.height - size.height) >= kSameSize;
  });
  if (other == pages.end()) return;
  file.add_finding(
      "wrong-scale",
      fmt::format("page {}: is {:.0f} x {:.0f} mm, expected {:.0f} x {:.0f} mm (manifest.json)",
                  other - pages.begin() + 1, 1e3 * other->width, 1e3 * other->height,
                  1e3 * size.width, 1e3 * size.height));
}

// A PDF of tiles: for each tag the assembly sheet, then its tiles.
Result<VerifiedFile> verify_tiled_pdf(const Task& task) {
  const TilePlan& plan = *task.manifest->tiles;
  const Result<std::vector<PageSize>> pages = pdf_pages(task.input.path);
  if (!pages) return fail(pages);
  VerifiedFile file;
  file.up = UpSource::page;
  file.pages = static_cast<int>(pages->size());
  const int a_tag = 1 + plan.tiles();
  find_wrong_pages(plan, reach_of(task.manifest->scale),
                   task.expected.size() * static_cast<std::size_t>(a_tag), *pages, file);
  if (!file.findings.empty()) return file;
  for (int first = 1; first <= file.pages; first += a_tag) {
    std::vector<TilePage> tiles;
    for (int tile = 1; tile <= plan.tiles(); ++tile) {
      tiles.push_back({task.input.path, first + tile, task.manifest->scale});
    }
    const Result<PageImage> plate = assemble_tiles(plan, tiles);
    if (!plate) return fail(plate);
    judge_page(task, *plate, first, fmt::format("the plate of page {}: ", first), file);
  }
  return file;
}

// Tiles as SVG or PNG, a file each, the first named NAME-A1.svg: with that one the plate is
// checked. Nothing for the other files, which belong to it.
Result<std::optional<VerifiedFile>> verify_tile_files(const Task& task) {
  const TilePlan& plan = *task.manifest->tiles;
  const std::filesystem::path& path = task.input.path;
  const std::string stem = path.stem().string();
  const std::string first = "-" + tile_address(0, 0);
  if (!stem.ends_with(first)) return std::nullopt;
  const std::string name = stem.substr(0, stem.size() - first.size());
  std::vector<TilePage> tiles;
  VerifiedFile incomplete;
  for (int row = 0; row < plan.rows; ++row) {
    for (int column = 0; column < plan.columns; ++column) {
      std::filesystem::path tile = path;
      tile.replace_filename(name + "-" + tile_address(column, row) + path.extension().string());
      tiles.push_back({tile, 0});
      if (std::filesystem::exists(tile)) continue;
      incomplete.add_finding("missing-in-file",
                             "its tile " + tile.filename().string() + " is not here");
    }
  }
  if (!incomplete.findings.empty()) return incomplete;
  const int dpi = is_svg(path) ? 0 : task.dots_per_inch();
  const Result<PageImage> plate =
      dpi > 0 ? assemble_tiles(plan, tiles, dpi) : assemble_tiles(plan, tiles);
  if (!plate) return fail(plate);
  return verify_print_picture(task, *plate);
}

Result<VerifiedFile> read_and_check(const Task& task) {
  const InputFile& input = task.input;
  if (is_pdf(input.bytes)) return verify_pdf(task);
  if (is_called_pdf(input.path)) {
    return fail(input.path.string() + ": is called .pdf and is none: `%PDF-` is not at its start");
  }
  if (is_svg(input.path)) {
    const Result<PageImage> page = rasterize_svg(input.path);
    if (!page) return fail(page);
    return verify_print_picture(task, *page);
  }
  if (task.dots_per_inch() > 0) {
    return verify_flat_picture(task, task.dots_per_inch(), UpSource::page);
  }
  if (task.request.scan_dpi) {
    return verify_flat_picture(task, *task.request.scan_dpi, UpSource::unknown);
  }
  return verify_photo(task);
}

// What the file shows of the tags that it holds according to the manifest; nothing when it is no
// file to read: a document, a tile that is checked with another file, or tiles of unknown places.
Result<std::optional<VerifiedFile>> read_printed(const Task& task, ManifestEntry entry) {
  const bool is_tiles = entry == ManifestEntry::tiles && task.manifest->tiles;
  if (is_tiles && !is_pdf(task.input.bytes)) return verify_tile_files(task);
  if (!is_tiles && entry != ManifestEntry::tags) return std::nullopt;
  Result<VerifiedFile> file = is_tiles ? verify_tiled_pdf(task) : read_and_check(task);
  if (!file) return fail(file);
  return std::optional(std::move(*file));
}

// Null where there is none.
Result<std::shared_ptr<const PrintManifest>> manifest_beside(const VerifyRequest& request,
                                                             const std::filesystem::path& path) {
  return request.manifests != nullptr ? request.manifests->find(path) : ManifestCache().find(path);
}

// A file that `print` wrote. One with plates of another drawing is not read: it would be searched
// for the present ones.
Result<VerifiedFile> verify_printed(const Task& task, ManifestEntry entry) {
  const bool is_old = !task.expected.empty() && task.manifest->survey == task.request.survey.name &&
                      !printed_otherwise(*task.manifest, task.request.survey.tag_template).empty();
  Result<std::optional<VerifiedFile>> read = std::nullopt;
  if (!is_old) read = read_printed(task, entry);
  if (!read) return fail(read);
  VerifiedFile file = *read ? std::move(**read) : VerifiedFile{};
  file.file = task.input.path;
  file.sha256 = task.input.sha256;
  if (*read) find_missing(task.expected, file);
  find_stale(*task.manifest, task.request.survey, file);
  return file;
}

// A print file that no manifest lists, but that says which tag it is of.
void find_stale_by_itself(const Task& task, VerifiedFile& file) {
  const auto stated = stated_tag(task.input.path, task.input.bytes);
  const auto digits = stated ? parse_digits(stated->digits) : std::nullopt;
  if (!digits) return;
  find_stale({stated->name, *digits, {}}, task.request.survey, file);
}

// On what a photo's result depends of its camera: the lens, and which way is up; empty when it is
// not known which camera took the photo.
std::string camera_conditions(const VerifyRequest& request, const std::filesystem::path& path) {
  const RigCamera* taken = rig_camera_of(request, path);
  if (taken == nullptr) return {};
  const Camera& camera = taken->camera;
  const Eigen::Vector3d down = taken->vehicle_from_camera.rotation.row(2);
  const std::string state =
      fmt::format("{} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(camera.lens), camera.width,
                  camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                  fmt::join(camera.distortion, " "), down.x(), down.y(), down.z());
  return fmt::format("camera {} {}", taken->name, sha256(state).substr(0, 12));
}

}  // namespace

Result<std::string> conditions_of(const VerifyRequest& request, const std::filesystem::path& path) {
  const auto manifest = manifest_beside(request, path);
  if (!manifest) return fail(manifest);
  std::vector<std::string> conditions;
  if (*manifest) {
    conditions.push_back(
        fmt::format("{} of manifest {}", path.filename().string(), (*manifest)->sha256_of_file));
  }
  if (request.scan_dpi) conditions.push_back(format_number(*request.scan_dpi) + " dpi");
  if (!request.also_revisions.empty()) conditions.push_back(request.also_revisions);
  if (std::string camera = camera_conditions(request, path); !camera.empty()) {
    conditions.push_back(std::move(camera));
  }
  return fmt::format("{}", fmt::join(conditions, "; "));
}

Result<VerifiedFile> verify_file(const VerifyRequest& request, const InputFile& input) {
  const auto manifest = manifest_beside(request, input.path);
  if (!manifest) return fail(manifest);
  const std::string name = input.path.filename().string();
  const ManifestEntry entry = *manifest ? entry_of(**manifest, name) : ManifestEntry::unlisted;
  const bool is_printed = entry != ManifestEntry::unlisted;
  Task task{request, input};
  if (is_printed) {
    task.manifest = manifest->get();
    task.expected = tags_of_file(**manifest, name);
  }
  Result<VerifiedFile> file = is_printed ? verify_printed(task, entry) : read_and_check(task);
  if (!file) return file;
  if (!is_printed && file->up == UpSource::page) {
    if (*manifest) find_unlisted(**manifest, *file);
    find_stale_by_itself(task, *file);
  }
  file->file = input.path;
  file->sha256 = input.sha256;
  return file;
}

Result<VerifiedFile> verify_file(const VerifyRequest& request, const std::filesystem::path& path) {
  const Result<InputFile> input = read_input_file(path);
  if (!input) return fail(input);
  return verify_file(request, *input);
}

}  // namespace tagsmith::detail
