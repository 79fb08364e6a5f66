// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/read_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Core>

#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/sharpening.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/cut_frame.hpp"
#include "decoder/reader/judge.hpp"
#include "decoder/reader/occluders.hpp"
#include "decoder/reader/part_of_height.hpp"
#include "decoder/reader/placed_corners.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/decode_part.hpp"
#include "decoder/scan/explanation.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// ---- Reading.

namespace {

// Which rows a profile is made of: those that agree, or, where there is dirt on them, all, each
// with its own light.
enum class RowsTaken { agreeing, all };

SymbolProfile profile_of(const RobustProfile& rows, RowsTaken taken) {
  return taken == RowsTaken::agreeing ? rows.of_agreeing_rows()
                                      : rows.of_all_rows(rows.rows_in_sight(), AddedLight::even);
}

// A part while it is being read. The frame's corner 0 is treated as P; the symbol runs along side
// 0, or from its other end.
struct Part {
  RefinedFrame frame;
  SymbolLayout layout;
  RobustProfile rows;
  RowsTaken taken;
  SymbolProfile profile;
  PartDecoding decoding{};
};

// The picture's camera if it is known, otherwise one with a usual lens.
Camera camera_for(const GrayView& image, const ReadOptions& options) {
  if (options.camera) return *options.camera;
  const double focal_length = kPart.usual_focal * std::max(image.width, image.height);
  return camera_from_sensor(image.width, image.height, focal_length, image.width, image.height);
}

// The profile when the symbol is `by` times as long as the frame says that was cut out of the
// picture: that frame's side 3 is in its place, and so is the point where its upper and lower
// sides meet.
ScanProfile stretched(ScanProfile profile, double by, const SymbolLayout& layout) {
  const double quiet = layout.quiet_zone_modules;
  for (ScanBin& bin : profile) bin.at = (bin.at + quiet) / by - quiet;
  std::erase_if(profile, [&](const ScanBin& bin) {
    return bin.at < -kProfile.beyond || bin.at > kModuleCount + kProfile.beyond;
  });
  return profile;
}

std::optional<PartDecoding> decode(const ScanProfile& profile, double blur,
                                   const ReadOptions& options) {
  ImagingModel start;
  start.blur = std::clamp(blur, 0.1, 3.0);
  return decode_part(profile, start, {options.check, options.code_book});
}

struct SeenModule {
  double at = 0;  // in modules of the profile
  double variance = 0;
  double bend = 0;  // of the bars, standard deviations of what the frame's sides may miss of it
};

// Where the bars of a profile that runs from side 3 on put the far side of the frame. It is hardly
// bent, because the frame's sides give its foreshortening.
SeenModule seen_far_side(const ScanProfile& from_side, const Decoding& decoding,
                         const SymbolLayout& layout) {
  const double quiet = layout.quiet_zone_modules;
  const auto seen_in = [&](const ScanProfile& profile, double sought) {
    const SeenPlaces seen =
        seen_places(profile, decoding.digits, decoding.fit.image, kPart.bend_sigma);
    const Eigen::RowVector3d by = SeenPlaces::by_displacement(sought);
    return SeenModule{seen.place_of(sought), by * seen.covariance * by.transpose(),
                      seen.displacement[2] / kPart.bend_sigma};
  };
  if (!decoding.upside_down) return seen_in(from_side, kModuleCount + quiet);
  const SeenModule seen = seen_in(turned(from_side), -quiet);
  return {kModuleCount - seen.at, seen.variance, seen.bend};
}

// The profile without the places of digits that are not certain: something may lie on them.
ScanProfile certain_places(ScanProfile profile, const PartDecoding& part) {
  std::erase_if(profile, [&](const ScanBin& bin) {
    const double at = part.decoding.upside_down ? kModuleCount - bin.at : bin.at;
    const auto digit = digit_at(at);
    return digit && !part.certain[*digit];
  });
  return profile;
}

// The frame's far side as given by the bars of the upper and the lower half of their height.
struct FarSide {
  PixelPoint upper, lower;            // on it
  double sigma_px = 0;                // of each, along the symbol
  double at_upper = 0, at_lower = 0;  // heights of these, shares of the frame's
  double contradiction = 1;           // chi-square of the bars' bend, at least 1
};

FarSide far_side_of(const Part& part) {
  const FrameHomography map(part.frame.corners, part.frame.lens);
  const SymbolLayout& layout = part.layout;
  const Decoding& decoding = part.decoding.decoding;
  FarSide side;
  side.at_upper = middle_height({0, 0.5}, layout);
  side.at_lower = middle_height({0.5, 1}, layout);
  const auto place = [&](HeightShare half, double v) {
    const ScanProfile rows = certain_places(part.rows.of_agreeing_rows(half).bins, part.decoding);
    const SeenModule seen = seen_far_side(rows, decoding, layout);
    const PixelPoint at = map(layout.width_share(seen.at), v);
    const double module_px = distance(at, map(layout.width_share(seen.at + 1), v));
    side.sigma_px = std::max(side.sigma_px, module_px * std::sqrt(seen.variance));
    side.contradiction = std::max(side.contradiction, seen.bend * seen.bend);
    return at;
  };
  side.upper = place({0, 0.5}, side.at_upper);
  side.lower = place({0.5, 1}, side.at_lower);
  return side;
}

// A frame with its side 1 along a line, where the lens bends nothing.
std::optional<Quad> with_far_side(const Quad& quad, const FarSide& side,
                                  const LensDistortion& lens) {
  const auto flat = straightened(lens, quad);
  const auto upper = lens.straightened(side.upper), lower = lens.straightened(side.lower);
  if (!flat || !upper || !lower) return std::nullopt;
  auto whole = corners_of(
      {side_of(*flat, 0), line_through(*upper, *lower), side_of(*flat, 2), side_of(*flat, 3)});
  if (!whole) return std::nullopt;
  for (PixelPoint& corner : *whole) {
    const auto pixel = lens.bent(corner);
    if (!pixel) return std::nullopt;
    corner = *pixel;
  }
  return whole;
}

// What the bars say of how well side 1 is known at its begin and end, from two places on it.
Eigen::Matrix2d covariance_of(const FarSide& side) {
  const double apart = side.at_lower - side.at_upper;
  Eigen::Matrix2d ends_by_places;
  ends_by_places << side.at_lower, -side.at_upper, -(1 - side.at_lower), 1 - side.at_upper;
  ends_by_places /= apart;
  const double sigma = std::hypot(side.sigma_px, kCorner.side);
  return sigma * sigma * ends_by_places * ends_by_places.transpose();
}

// The frame fitted anew with its far side where the bars put it, and the symbol read anew in it.
std::optional<Part> read_anew(const GrayView& image, const Quad& corners,
                              const LensDistortion& lens, const SymbolLayout& layout,
                              RowsTaken taken, const ReadOptions& options,
                              bool was_sharpened = false) {
  auto frame = fit_cut_frame(image, corners, layout.frame, lens, was_sharpened);
  if (!frame) return std::nullopt;
  const RobustProfile rows(image, *frame, layout);
  Part part{*std::move(frame), layout, rows, taken, profile_of(rows, taken)};
  auto decoding = decode(part.profile.bins, part.profile.blur, options);
  if (!decoding) return std::nullopt;
  part.decoding = *std::move(decoding);
  return part;
}

// Lengths of the symbol against the frame's, up to so many steps longer and shorter; first those
// whose guard patterns in sight are explained best.
std::vector<double> likely_lengths(const SymbolProfile& profile, const SymbolLayout& layout,
                                   int steps) {
  std::vector<std::pair<double, double>> by_guards;
  for (int k = -steps; k <= steps; ++k) {
    const double by = std::exp(kPart.step * k);
    ImagingModel image;
    image.blur = std::clamp(profile.blur / by, 0.1, 3.0);
    by_guards.emplace_back(guards_in(stretched(profile.bins, by, layout), image), by);
  }
  std::ranges::stable_sort(by_guards, std::ranges::greater{}, &std::pair<double, double>::first);
  std::vector<double> lengths;
  for (const auto& [guards, by] : by_guards) {
    if (guards >= kJudge.like_symbol) lengths.push_back(by);
  }
  return lengths;
}

// How many plates of no survey look like a part with so many digits in sight.
double alike_strangers(std::ptrdiff_t digits, const ReadOptions& options) {
  return kOdds.strangers * static_cast<double>(options.code_book.size()) /
         std::pow(10, static_cast<double>(digits));
}

// Whether a profile reaches over as many digits as are believed, were the symbol so many times as
// long as the frame says.
bool shows_enough(const ScanProfile& profile, double by, const SymbolLayout& layout,
                  const ReadOptions& options) {
  if (profile.empty()) return false;
  const double quiet = layout.quiet_zone_modules;
  const double end = (profile.back().at + quiet) / by - quiet;
  int digits = 0;
  while (digits < kDigitCount && first_module_of_digit(digits) + kModulesPerDigit <= end) ++digits;
  return alike_strangers(digits, options) < kPart.most_alike;
}

// The part at the length at which the bars are explained best.
std::optional<Part> read_at_any_length(const GrayView& image, const RefinedFrame& frame,
                                       const SymbolLayout& layout, RowsTaken taken,
                                       const ReadOptions& options) {
  const SymbolProfile profile = profile_of(RobustProfile(image, frame, layout), taken);
  const int most = options.camera ? kPart.steps : kPart.steps_unknown;
  if (!shows_enough(profile.bins, std::exp(-kPart.step * most), layout, options)) {
    return std::nullopt;
  }
  std::optional<PartDecoding> best;
  double length = 1;
  for (const double by : likely_lengths(profile, layout, most)) {
    auto decoding = decode(stretched(profile.bins, by, layout), profile.blur / by, options);
    if (!decoding) continue;
    if (best && decoding->decoding.fit.explained <= best->decoding.fit.explained) continue;
    best = std::move(decoding);
    length = by;
    if (best->decoding.fit.explained > kJudge.explained) break;
  }
  if (!best || best->decoding.fit.explained < kJudge.like_symbol) return std::nullopt;
  // The far side at this length, as the fit of the bars corrects it.
  const FrameHomography map(frame.corners, frame.lens);
  const double quiet = layout.quiet_zone_modules;
  const SeenModule seen =
      seen_far_side(stretched(profile.bins, length, layout), best->decoding, layout);
  const double far = layout.width_share((seen.at + quiet) * length - quiet);
  Quad quad = frame.corners;
  quad[1] = map(far, 0);
  quad[2] = map(far, 1);
  return read_anew(image, quad, frame.lens, layout, taken, options);
}

// The share of the frame's inner width, from side 3 on, that the profile shows.
double width_in_sight(const Part& part) {
  return part.layout.width_share(part.profile.bins.back().at);
}

// Whether the bars in sight end where the layout has them in this frame.
bool bars_end_right(const GrayView& image, const Part& part) {
  const SymbolLayout& layout = part.layout;
  const FrameHomography map(part.frame.corners, part.frame.lens);
  const double end = width_in_sight(part);
  const Quad shown{map(0, 0), map(end, 0), map(end, 1), map(0, 1)};
  const double first = layout.width_share(0) / end;
  return bars_end_near(image,
                       {shown, first, 1, layout.bars_top, layout.bars_bottom, part.frame.lens});
}

// Whether something lies along the bars over all of their height: it may change a digit to another.
bool is_crossed(const GrayView& image, const Part& part) {
  const double end = width_in_sight(part);
  const auto strips = strips_along_bars(image, part.frame, part.layout);
  return std::ranges::any_of(strips, [&](const Occluder& strip) {
    const auto [from, to] = hidden_width(strip, 0.5);
    return from < end;
  });
}

// Whether what is in sight is certain, and enough that few plates of no survey look alike.
bool is_certain(const PartDecoding& part, const ReadOptions& options) {
  return alike_strangers(std::ranges::count(part.certain, true), options) < kPart.most_alike &&
         !objection_to(part.decoding, options);
}

bool is_believed(const GrayView& image, const Part& part, const ReadOptions& options) {
  return is_certain(part.decoding, options) && bars_end_right(image, part) &&
         !is_crossed(image, part) &&
         (part.taken == RowsTaken::all || is_beyond_doubt(part.decoding.decoding) ||
          !halves_contradict(part.rows, part.decoding.decoding));
}

// The bars in sight of all heights must lie on a straight line, as those of whole tags.
CornerCovariance covariance_by_motion(const GrayView& image, const Part& part,
                                      const SymbolHypothesis& symbol) {
  SeenBands bands;
  double middle = 0;
  for (int i = 0; i < 4; ++i) {
    const bool turn = symbol.decoding.upside_down;
    ScanProfile bins =
        certain_places(part.rows.of_agreeing_rows(band_of(turn ? 3 - i : i)).bins, part.decoding);
    if (turn) bins = turned(bins);
    SeenPlaces& bars = bands[static_cast<std::size_t>(i)];
    bars = seen_places(bins, symbol.decoding.digits, symbol.decoding.fit.image, kPart.bend_sigma);
    bars.covariance *= kCorner.alike;
    middle += (bins.front().at + bins.back().at) / 8;
  }
  return covariance_by_motion(image, bands, middle, symbol);
}

std::optional<PartReading> reading_of(const GrayView& image, const Part& part) {
  const Decoding& decoding = part.decoding.decoding;
  const FarSide far = far_side_of(part);
  const std::size_t first = decoding.upside_down ? 2 : 0;
  RefinedFrame frame = part.frame;
  const auto fitted = with_far_side(frame.corners, far, frame.lens);
  if (!fitted) return std::nullopt;
  frame.corners = *fitted;
  frame.sides[1].covariance = covariance_of(far);
  const SymbolHypothesis symbol{turned_to(frame, first), part.layout, part.profile, decoding};
  // The bars put the far side where it is, however they grew.
  const auto placed =
      with_far_side(widened(part.frame.corners, growth_of(symbol).px / 2), far, frame.lens);
  if (!placed) return std::nullopt;
  frame.corners = *placed;
  PartReading reading;
  reading.corners = turned_to(frame, first).corners;
  for (std::size_t i = 0; i < 4; ++i) {
    reading.corner_in_sight[i] = is_in_picture(image, reading.corners[i]);
  }
  // A lens that is not as stated bends the sides, too, and the bars show it.
  reading.corner_covariance = far.contradiction * covariance_by_frame(image, symbol) +
                              covariance_by_motion(image, part, symbol);
  reading.candidates = part.decoding.candidates;
  reading.in_sight = part.decoding.certain;
  reading.share = std::clamp(part.profile.bins.back().at / kModuleCount, 0.0, 1.0);
  reading.module_px = part.profile.module_px;
  reading.confidence = decoding.confidence;
  return reading;
}

// The part in a picture as it is.
std::optional<Part> believed_part(const GrayView& image, const Quad& cut, const Camera& camera,
                                  const ReadOptions& options) {
  const LensDistortion lens(camera);
  for (const SymbolLayout& layout : options.layouts) {
    const auto rough = completed_by_shape(cut, layout.frame, camera);
    if (!rough) continue;
    const auto fitted = fit_cut_frame(image, *rough, layout.frame, lens);
    if (!fitted) continue;
    const auto whole = completed_by_shape(fitted->corners, layout.frame, camera);
    if (!whole) continue;
    RefinedFrame frame = *fitted;
    frame.corners = *whole;
    for (const RowsTaken taken : {RowsTaken::agreeing, RowsTaken::all}) {
      auto part = read_at_any_length(image, frame, layout, taken, options);
      if (!part || !shows_enough(part->profile.bins, 1, layout, options)) break;
      if (is_believed(image, *part, options)) return part;
    }
  }
  return std::nullopt;
}

// A symbol of which something hides digits.
struct CoveredSymbol {
  SymbolHypothesis symbol;
  PartDecoding decoding;
};

// A frame from P on with its symbol's rows, which are cut out once for all kinds of light.
struct CoveredRows {
  RefinedFrame frame;
  RobustProfile rows;
  SymbolRows in_sight;
};

// In each direction in which the symbol may run, and each layout.
std::vector<CoveredRows> covered_rows(const GrayView& image, const RefinedFrame& frame,
                                      const ReadOptions& options) {
  std::vector<CoveredRows> all;
  for (const std::size_t first : possible_first_corners(image, frame.corners)) {
    for (const SymbolLayout& layout : options.layouts) {
      const RefinedFrame turned = turned_to(frame, first);
      const RobustProfile rows(image, turned, layout);
      all.push_back({turned, rows, rows.rows_in_sight()});
    }
  }
  return all;
}

// What explains best what is in sight in a frame.
std::optional<CoveredSymbol> best_in_sight(const std::vector<CoveredRows>& all,
                                           const ReadOptions& options, AddedLight added) {
  std::optional<CoveredSymbol> best;
  for (const auto& [frame, rows, in_sight] : all) {
    SymbolProfile profile = rows.of_all_rows(in_sight, added);
    auto part = decode(profile.bins, profile.blur, options);
    if (!part) continue;
    const Decoding& decoding = part->decoding;
    if (best && decoding.fit.explained <= best->decoding.decoding.fit.explained) continue;
    SymbolHypothesis symbol{turned_to(frame, decoding.upside_down ? 2 : 0), rows.layout(),
                            std::move(profile), decoding};
    best = CoveredSymbol{std::move(symbol), *std::move(part)};
  }
  return best;
}

// The share of a symbol's modules that a profile does not hide.
double share_in_sight(const ScanProfile& profile) {
  const auto hidden = static_cast<double>(std::ranges::count_if(profile, is_hidden));
  return 1 - hidden / static_cast<double>(profile.size());
}

PartReading reading_of(CoveredSymbol covered, const Reading& whole) {
  PartReading reading;
  reading.candidates = std::move(covered.decoding.candidates);
  reading.in_sight = covered.decoding.certain;
  reading.share = share_in_sight(covered.symbol.profile.bins);
  reading.corners = whole.corners;
  reading.corner_in_sight.fill(true);
  reading.corner_covariance = whole.corner_covariance;
  reading.module_px = whole.module_px;
  reading.confidence = whole.confidence;
  return reading;
}

}  // namespace

std::string digits_in_sight(const PartReading& part) {
  std::string text = to_string(part.candidates.front().digits);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    if (!part.in_sight[i]) text[i] = '-';
  }
  return text;
}

// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
std::optional<PartReading> read_part(const GrayView& image, const Quad& cut,
                                     const ReadOptions& options) {
  const Camera camera = camera_for(image, options);
  const std::vector<std::size_t> first = possible_first_corners(image, cut);
  std::optional<Part> part;
  if (first.front() == 0) part = believed_part(image, cut, camera, options);
  if (!part && first.back() == 0) return std::nullopt;
  if (!part)
    return read_part_of_height(image, cut, camera, options);  // the bars run into the border
  const auto halos = sharpening_of(image, part->frame, part->layout.frame);
  if (!halos) return reading_of(image, *part);
  UnsharpenedImage plain(image);
  plain.undo(*halos, cut);
  auto again = read_anew(plain.view(), part->frame.corners, part->frame.lens, part->layout,
                         part->taken, options, true);
  if (!again || !is_believed(plain.view(), *again, options)) return reading_of(image, *part);
  add_halo_doubt(part->frame.corners, again->frame);
  return reading_of(plain.view(), *again);
}

CoveredReading read_covered(const GrayView& image, const RefinedFrame& frame,
                            const ReadOptions& options) {
  CoveredReading reading;
  const std::vector<CoveredRows> rows = covered_rows(image, frame, options);
  for (const AddedLight added : {AddedLight::even, AddedLight::slanted}) {
    auto covered = best_in_sight(rows, options, added);
    if (!covered || covered->decoding.decoding.fit.explained < kJudge.like_symbol) break;
    // Uncertain digits add no more than their limit to the doubt; a doubt above it is a
    // contradiction.
    reading.is_contradicted |= covered->decoding.decoding.doubt.misprints > kOdds.near_stranger;
    if (std::ranges::all_of(covered->decoding.certain, std::identity{})) break;
    if (!is_certain(covered->decoding, options)) continue;
    const auto whole =
        reading_where_bars_end(image, covered->symbol, options, ReadingMethod::partly_covered);
    if (!whole) continue;
    reading.part = reading_of(*std::move(covered), *whole);
    break;
  }
  return reading;
}

// ---- Searching.

namespace {

constexpr std::array<bool, 4> kAllButSide1{true, false, true, true};

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
