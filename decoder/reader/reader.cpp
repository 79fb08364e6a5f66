// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/detector.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/propose.hpp"
#include "decoder/reader/searched_image.hpp"

namespace tagsmith::detail {
namespace {

// In their order, the cheapest first. The closer look is left out where a caller knows enough after
// the first, and in pictures that are not searched.
constexpr std::array kFirstLook{Proposer{"expected", propose_expected},
                                Proposer{"near bars", propose_near_bars}};
constexpr std::array kCloserLook{
    Proposer{"around bars", propose_around_bars}, Proposer{"pieces", propose_pieces},
    Proposer{"refused", propose_refused}, Proposer{"bars", propose_bars}};

}  // namespace

struct TagSearch::State {
  State(const GrayView& taken, const ReadOptions& how, bool is_linear = false)
      : options(how),
        image(taken),
        by_light(is_linear ? std::optional(linear_as_srgb(taken)) : std::nullopt),
        negative(how.white_on_black && !taken.is_negative
                     ? std::optional(exchange_black_and_white(by_light ? by_light->view() : taken))
                     : std::nullopt),
        picture(negative   ? negative->view()
                : by_light ? by_light->view()
                           : taken),
        detector(picture, options) {}

  void look(std::span<const Proposer> proposers) {
    for (const Proposer& proposer : proposers) {
      detector.note_proposer(proposer.name);
      proposer.propose(search);
    }
    detector.try_doubtful();
    detector.read_parts();
  }

  void look_closer() {
    look(kCloserLook);
    detector.try_likely_codes();
    detector.read_covered_parts();
    tags = detector.found().tags();
  }

  // Reads again in the frames that another look found.
  void look_in_frames(const TagHypotheses& others) {
    const PyramidLevel level{.image = picture.image()};
    for (const TagHypothesis& other : others.all()) {
      if (other.frame) detector.consider(RoughFrame{level, other.frame->corners});
    }
    detector.try_doubtful();
    detector.try_likely_codes();
    tags = detector.found().tags();
  }

  ReadOptions options;
  GrayView image;
  std::optional<GrayImage> by_light;  // where its samples are taken to be in proportion to light
  std::optional<GrayImage> negative;  // of plates that are white on black: read in its place
  SearchedImage picture;
  Detector detector;
  SearchContext search{picture, options, detector.found(),
                       [this](const Proposal& proposal) { detector.consider(proposal); }};
  std::vector<Reading> tags;                 // after each of the two steps
  std::vector<Rejection> refused_as_linear;  // where the look at linear samples was not taken
  bool is_done = false;
};

namespace {

// Whether a picture may be of a camera without a tone curve: through the wrong one blurred bars are
// broader than they were drawn by a fifth of a pixel or more, or nothing is read.
bool may_be_linear(const std::vector<Reading>& tags) {
  return std::ranges::all_of(
      tags, [](const Reading& tag) { return tag.symbol && growth_of(*tag.symbol).px > 0.2; });
}

// A sixteenth of full light or less in the brightest place is not enough: noise of whole grey
// levels would be taken for light.
bool is_lit(const GrayView& image) {
  for (int y = 0; y < image.height; ++y) {
    const std::span row(image.row(y), static_cast<std::size_t>(image.width));
    if (std::ranges::any_of(row, [](std::uint8_t sample) { return sample > 16; })) return true;
  }
  return false;
}

// Whether bars are as broad as they were drawn, to a fifth of a pixel, as through the right curve.
// A tag that is partly covered says too little of that.
bool is_right_tone(const std::vector<Reading>& tags) {
  return std::ranges::all_of(tags, [](const Reading& tag) {
    return tag.symbol && tag.method == ReadingMethod::frame &&
           std::abs(growth_of(*tag.symbol).px) < 0.2;
  });
}

double explained(const std::vector<Reading>& tags) {
  double sum = 0;
  for (const Reading& tag : tags) sum += tag.symbol ? tag.symbol->decoding.fit.explained : 0;
  return sum;
}

// Whether every one of these tags is, at the same place, among the others.
bool are_among(const std::vector<Reading>& tags, const std::vector<Reading>& others) {
  return std::ranges::all_of(tags, [&](const Reading& tag) {
    return std::ranges::any_of(others, [&](const Reading& other) {
      return other.digits == tag.digits && contains(other.corners, centre_of(tag.corners));
    });
  });
}

// Adds the readings that another look refused at places of which this result says nothing.
void add_refused(std::vector<Rejection> others, ReadResult& result) {
  std::erase_if(others, [&](const Rejection& other) {
    const auto is_there = [&](const auto& one) {
      return contains(one.corners, centre_of(other.corners));
    };
    return other.reason != RejectionReason::doubtful ||
           std::ranges::any_of(result.tags, is_there) ||
           std::ranges::any_of(result.rejected, is_there) ||
           std::ranges::any_of(result.parts, is_there);
  });
  std::ranges::move(others, std::back_inserter(result.rejected));
}

}  // namespace

TagSearch::TagSearch(const GrayView& image, const ReadOptions& options)
    : state_(std::make_unique<State>(image, options)) {
  state_->look(kFirstLook);
  state_->tags = state_->detector.found().tags();
}

TagSearch::TagSearch(TagSearch&&) noexcept = default;
TagSearch& TagSearch::operator=(TagSearch&&) noexcept = default;
TagSearch::~TagSearch() = default;

void TagSearch::look_closer() {
  if (!state_->search.is_searched || state_->is_done) return;
  state_->is_done = true;
  state_->look_closer();
  const TagHypotheses& found = state_->detector.found();
  if (!found.has_frames() || !may_be_linear(state_->tags) || !is_lit(state_->image)) return;
  auto linear = std::make_unique<State>(state_->image, state_->options, true);
  linear->is_done = true;
  linear->look_in_frames(found);
  const auto is_better = [&] {
    return explained(linear->tags) > explained(state_->tags) && is_right_tone(linear->tags) &&
           are_among(state_->tags, linear->tags);
  };
  if (is_better()) {
    linear->look(kFirstLook);
    linear->look_closer();
  }
  if (is_better()) {
    state_ = std::move(linear);
  } else {
    state_->refused_as_linear = linear->detector.result().rejected;
  }
}

const std::vector<Reading>& TagSearch::tags() const { return state_->tags; }

ReadResult TagSearch::result() const {
  ReadResult result = state_->detector.result();
  add_refused(state_->refused_as_linear, result);
  return with_frameless(state_->picture, state_->options, std::move(result));
}

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  TagSearch search(image, options);
  search.look_closer();
  return search.result();
}

}  // namespace tagsmith::detail
