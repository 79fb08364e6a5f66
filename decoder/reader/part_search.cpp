// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/part_search.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/reader/cut_frame.hpp"
#include "decoder/reader/read_part.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::array<bool, 4> kAllButSide1{true, false, true, true};

Quad beginning_at(const Quad& quad, std::size_t corner) {
  return {quad[corner % 4], quad[(corner + 1) % 4], quad[(corner + 2) % 4], quad[(corner + 3) % 4]};
}

// Adds an outline that is not among them yet with the same side 1.
void add_new(const Quad& outline, double scale, std::vector<Quad>& outlines) {
  const double tolerance = kPart.border_px * scale;
  const auto same = [&](const Quad& other) {
    return distance(other[1], outline[1]) < tolerance && nearly_equal(other, outline, tolerance);
  };
  if (std::ranges::none_of(outlines, same)) outlines.push_back(outline);
}

// In pixels of the picture that it is a part of.
std::optional<PartReading> read_part_beside(const PictureBeside& beside, ReadOptions options) {
  if (options.camera) {
    options.camera->cx -= beside.first.x;
    options.camera->cy -= beside.first.y;
    options.camera->width = beside.view.width;
    options.camera->height = beside.view.height;
  }
  auto part = read_part(beside.view, beside.quad, options);
  if (!part) return std::nullopt;
  for (PixelPoint& corner : part->corners) corner = corner + beside.first;
  return part;
}

}  // namespace

PartSearch::PartSearch(const ReadOptions& options) : options_(options) {
  if (options_.code_book.empty()) options_.code_book = options_.likely_codes;
}

void PartSearch::note_cut(const Outline& outline, const FrameShape& shape) {
  if (options_.code_book.empty()) return;
  const auto cut = cut_by_border(outline.level, outline.quad);
  if (cut && looks_framed(outline.level.image, *cut, shape, kAllButSide1)) {
    add_new(to_full(outline.level, *cut), outline.level.scale, cut_);
  }
}

void PartSearch::note_hidden_side(const Outline& outline, const FrameShape& shape) {
  const auto& [level, quad] = outline;
  if (options_.code_book.empty() || cut_by_border(level, quad)) return;
  for (std::size_t i = 0; i < 4; ++i) {
    const Quad turned = beginning_at(quad, i);
    if (looks_framed(level.image, turned, shape, kAllButSide1))
      add_new(to_full(level, turned), level.scale, hidden_sides_);
  }
}

bool PartSearch::has_part_at(PixelPoint point) const {
  return std::ranges::any_of(
      parts_, [&](const PartReading& part) { return contains(part.corners, point); });
}

void PartSearch::read_cut(const GrayView& image, const IsRead& is_read) {
  for (; read_cuts_ < cut_.size(); ++read_cuts_) {
    const Quad& cut = cut_[read_cuts_];
    if (is_read(centre_of(cut)) || has_part_at(centre_of(cut))) continue;
    if (auto part = read_part(image, cut, options_)) parts_.push_back(*std::move(part));
  }
}

void PartSearch::note_hidden_end(const GrayView& image, const Quad& frame) {
  if (options_.code_book.empty()) return;
  for (const std::size_t first : possible_first_corners(image, frame)) {
    add_new(beginning_at(frame, first), 1, hidden_sides_);
    add_new(beginning_at(frame, first + 2), 1, hidden_sides_);
  }
}

void PartSearch::read_covered(const GrayView& image, const RefinedFrame& frame,
                              const IsRead& is_read) {
  const PixelPoint centre = centre_of(frame.corners);
  const auto same = [&](const Quad& other) {
    return nearly_equal(other, frame.corners, kSearch.same_px);
  };
  if (options_.code_book.empty() || is_read(centre) || has_part_at(centre)) return;
  if (std::ranges::any_of(covered_, same)) return;
  covered_.push_back(frame.corners);
  CoveredReading covered = detail::read_covered(image, frame, options_);
  if (covered.part) parts_.push_back(*std::move(covered.part));
  if (covered.is_contradicted) strangers_.push_back(frame.corners);
}

void PartSearch::read_beside(const GrayView& image, const IsRead& is_read) {
  if (options_.code_book.empty()) return;
  for (const Quad& outline : hidden_sides_) {
    const PixelPoint centre = centre_of(outline);
    const auto is_there = [&](const Quad& stranger) { return contains(stranger, centre); };
    if (is_read(centre) || has_part_at(centre)) continue;
    if (std::ranges::any_of(strangers_, is_there)) continue;
    const auto beside = picture_beside(image, outline);
    auto part = beside ? read_part_beside(*beside, options_) : std::nullopt;
    if (part) parts_.push_back(*std::move(part));
  }
}

}  // namespace tagsmith::detail
