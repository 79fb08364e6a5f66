// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/proof.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <unistd.h>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/verify/rasterize.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

constexpr double kAround = 0.008;         // white around the feature frame that is read too, metres
constexpr double kMaxTagPixels = 50e6;    // of a tag
constexpr double kMaxPagePixels = 150e6;  // of an SVG page, which is drawn as a whole

// A tag and the pages that show it.
struct ProofTag {
  std::string name;
  std::vector<std::pair<const ProofPage*, const PageTag*>> pieces;

  const TagDrawing& drawing() const { return pieces.front().second->drawing; }
  Rectangle frame_on_page() const { return on_page(*pieces.front().second, drawing().frame_outer); }
};

std::vector<ProofTag> tags_on(std::span<const ProofPage> pages) {
  std::vector<ProofTag> tags;
  for (const ProofPage& page : pages) {
    for (const PageTag& shown : page.page->tags) {
      if (!shown.at_true_scale) continue;
      auto tag = std::ranges::find(tags, shown.name, &ProofTag::name);
      if (tag == tags.end()) tag = tags.insert(tag, ProofTag{shown.name, {}});
      tag->pieces.emplace_back(&page, &shown);
    }
  }
  return tags;
}

// A whole fraction of the printer's dots, so that edges on dots lie on pixels.
double resolution_for(const ProofTag& tag, int dots_per_inch) {
  const Rectangle& frame = tag.drawing().frame_outer;
  const double tag_area = (frame.width + 2 * kAround) * (frame.height + 2 * kAround);
  const auto& [proof_page, shown] = tag.pieces.front();
  const bool whole_page = is_svg(proof_page->file);
  const double page_area = proof_page->page->width * proof_page->page->height;
  if (proof_page->file.extension() == ".png") return dots_per_inch;
  for (int part = 1;; ++part) {
    const double per_metre = dots_per_inch / (part * kMetresPerInch);
    const bool fits = tag_area * per_metre * per_metre <= kMaxTagPixels &&
                      (!whole_page || page_area * per_metre * per_metre <= kMaxPagePixels);
    if (fits) return static_cast<double>(dots_per_inch) / part;
  }
}

int pixel_at(double metres, double per_metre) {
  return static_cast<int>(std::lround(metres * per_metre));
}

// The assembled tag. `p`: where P is, in pixels of the image (their centres at whole numbers).
struct ReadyTag {
  GrayImage image;
  PixelPoint p;
};

// The inner corner P of the feature frame on the page.
PlatePoint p_on_page(const PageTag& tag) {
  return on_page(tag, PlatePoint{tag.drawing.frame_inner.x, tag.drawing.frame_inner.y});
}

// The part of the rectangle that lies in the other.
Rectangle common_part(const Rectangle& a, const Rectangle& b) {
  const double left = std::max(a.x, b.x);
  const double top = std::max(a.y, b.y);
  const double right = std::min(a.x + a.width, b.x + b.width);
  const double bottom = std::min(a.y + a.height, b.y + b.height);
  return {left, top, std::max(right - left, 0.0), std::max(bottom - top, 0.0)};
}

// Every piece is where its page shows P; sheets glued together are the pieces laid over each other.
Result<ReadyTag> assemble(const ProofTag& tag, double dots_per_inch) {
  const double per_metre = dots_per_inch / kMetresPerInch;
  const Rectangle outer = tag.frame_on_page();
  const PlatePoint inner = p_on_page(*tag.pieces.front().second);
  const int around = pixel_at(kAround, per_metre);
  const int left = pixel_at(inner.x - outer.x, per_metre) + around;  // pixels from the edge to P
  const int up = pixel_at(inner.y - outer.y, per_metre) + around;
  ReadyTag ready{{pixel_at(outer.width, per_metre) + 2 * around,
                  pixel_at(outer.height, per_metre) + 2 * around,
                  {}},
                 {}};
  GrayImage& image = ready.image;
  image.samples.assign(
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 255);
  for (const auto& [page, shown] : tag.pieces) {
    const PlatePoint p = p_on_page(*shown);
    const int p_x = pixel_at(p.x, per_metre);
    const int p_y = pixel_at(p.y, per_metre);
    Rectangle part = common_part({(p_x - left) / per_metre, (p_y - up) / per_metre,
                                  image.width / per_metre, image.height / per_metre},
                                 {0, 0, page->page->width, page->page->height});
    if (shown->window) part = common_part(part, *shown->window);
    const PixelRegion region{pixel_at(part.x, per_metre), pixel_at(part.y, per_metre),
                             static_cast<int>(part.width * per_metre),
                             static_cast<int>(part.height * per_metre)};
    if (region.width <= 0 || region.height <= 0) continue;
    const Result<GrayImage> piece =
        rasterize_part(page->file, page->number, dots_per_inch, region, page->scale);
    if (!piece) return fail(piece);
    paste(*piece, image, region.x - p_x + left, region.y - p_y + up);
    ready.p = {left + p.x * per_metre - p_x - 0.5, up + p.y * per_metre - p_y - 0.5};
  }
  return ready;
}

// The text that zbar reads in the image, reduced to about 4 pixels a module; nothing when it reads
// none.
std::optional<std::string> read_by_zbar(const GrayImage& image, double module_px) {
  constexpr double kEnough = 4;
  const int factor = std::max(1, static_cast<int>(module_px / kEnough));
  const int longer = std::max(image.width, image.height);
  const GrayImage small = shrunk_to(image.view(), (longer + factor - 1) / factor);
  std::string path = (fs::temp_directory_path() / "tagsmith-proof-XXXXXX.png").string();
  const int descriptor = ::mkstemps(path.data(), 4);
  if (descriptor < 0) return std::nullopt;
  ::close(descriptor);
  std::optional<std::string> text;
  if (save_gray_image(path, small.view())) {
    const Result<ProcessOutput> output = run_process({"zbarimg", "--quiet", "--raw", path});
    if (output) text = std::string(trim(output->out));
  }
  std::error_code ignored;
  fs::remove(path, ignored);
  return text;
}

void compare_digits(const Survey& survey, const ProofTag& tag, const Reading& reading,
                    TagProof& proof) {
  proof.digits = to_string(reading.digits);
  const PlacedTag* expected = find_tag(survey, tag.name);
  if (expected->digits == reading.digits) return;
  proof.problem = "reads " + proof.digits + ", the survey says " + to_string(expected->digits);
}

// Where the frame's own edges will be once the ink adds what drawing it thinner took away. Bars are
// not used: their edges stand on the nearest dots, so they are less exact than a drawn frame.
FrameCorners corners_when_printed(const Reading& reading, double bar_adjustment_px) {
  return widened(reading.symbol.value().frame.corners, bar_adjustment_px / 2);
}

void compare_corners(const Survey& survey, const ProofTag& tag, const FrameCorners& corners,
                     const PixelPoint& p, double metres_per_pixel, TagProof& proof) {
  const PageTag& shown = *tag.pieces.front().second;
  const std::array<PlatePoint, 4> drawn = corners_of(tag.drawing().frame_inner);
  const PlatePoint origin = p_on_page(shown);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const PlatePoint corner = on_page(shown, drawn[i]);
    const PixelPoint expected{p.x + (corner.x - origin.x) / metres_per_pixel,
                              p.y + (corner.y - origin.y) / metres_per_pixel};
    proof.corner_error =
        std::max(proof.corner_error, distance(corners[i], expected) * metres_per_pixel);
  }
  const TagTemplate& plate = survey.tag_template;
  proof.length_error = length_of(corners) * metres_per_pixel - plate.frame_inner_length;
  proof.height_error = height_of(corners) * metres_per_pixel - plate.frame_inner_height;
  const double allowed = std::max(0.00015, 1.5 * metres_per_pixel);
  if (proof.corner_error <= allowed || !proof.problem.empty()) return;
  proof.problem = fmt::format(
      "a corner of the feature frame is {} mm from its place, expected at "
      "most {}",
      format_number(proof.corner_error * 1e3, 2), format_number(allowed * 1e3, 2));
}

void ask_zbar(const Survey& survey, const ProofTag& tag, const GrayImage& image, double module_px,
              TagProof& proof) {
  if (survey.code.check != CheckDigit::gs1) return;
  const std::optional<std::string> text = read_by_zbar(
      survey.tag_template.white_on_black ? exchange_black_and_white(image.view()) : image,
      module_px);
  if (!text) return;
  proof.zbar = text->empty() ? "nothing" : *text;
  const std::string expected = "0" + to_string(find_tag(survey, tag.name)->digits);  // as EAN-13
  if (*text == expected || !proof.problem.empty()) return;
  proof.problem = "zbar reads " + proof.zbar + ", expected " + expected;
}

Result<TagProof> prove(const Survey& survey, const ProofTag& tag, int dots_per_inch) {
  TagProof proof;
  proof.tag = tag.name;
  proof.file = tag.pieces.front().first->file.filename().string();
  proof.dots_per_inch = resolution_for(tag, dots_per_inch);
  const Result<ReadyTag> ready = assemble(tag, proof.dots_per_inch);
  if (!ready) return fail(ready);
  ReadOptions options = read_options_for(std::span(&survey, 1));
  options.code_book.clear();
  const ReadResult read = read_tags(ready->image.view(), options);
  if (read.tags.empty()) {
    proof.problem = "was not read";
    if (!read.rejected.empty()) proof.problem += ": " + describe(read.rejected.front());
    return proof;
  }
  const double metres_per_pixel = kMetresPerInch / proof.dots_per_inch;
  compare_digits(survey, tag, read.tags.front(), proof);
  const double adjustment = tag.pieces.front().first->bar_adjustment;
  compare_corners(survey, tag,
                  corners_when_printed(read.tags.front(), adjustment / metres_per_pixel), ready->p,
                  metres_per_pixel, proof);
  ask_zbar(survey, tag, ready->image, read.tags.front().module_px, proof);
  return proof;
}

}  // namespace

Result<std::vector<TagProof>> prove_pages(const Survey& survey, std::span<const ProofPage> pages,
                                          int dots_per_inch) {
  std::vector<TagProof> proofs;
  for (const ProofTag& tag : tags_on(pages)) {
    Result<TagProof> proof = prove(survey, tag, dots_per_inch);
    if (!proof) return fail(proof);
    proofs.push_back(std::move(*proof));
  }
  return proofs;
}

}  // namespace tagsmith::detail
