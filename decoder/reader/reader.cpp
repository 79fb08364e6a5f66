// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <array>
#include <optional>
#include <span>

#include "decoder/image/transform.hpp"
#include "decoder/reader/detector.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/propose.hpp"
#include "decoder/reader/searched_image.hpp"

namespace tagsmith::detail {
namespace {

// In their order, the cheapest first. The closer look is left out where a caller knows enough after
// the first, and in pictures that are not searched.
constexpr std::array kFirstLook{propose_expected, propose_near_bars};
constexpr std::array kCloserLook{propose_around_bars, propose_pieces, propose_refused,
                                 propose_bars};

}  // namespace

struct TagSearch::State {
  State(const GrayView& image, const ReadOptions& how)
      : options(how),
        negative(how.white_on_black && !image.is_negative
                     ? std::optional(exchange_black_and_white(image))
                     : std::nullopt),
        picture(negative ? negative->view() : image),
        detector(picture, options) {}

  void look(std::span<const Proposer> proposers) {
    for (const Proposer propose : proposers) propose(search);
    detector.try_doubtful();
    detector.read_parts();
  }

  ReadOptions options;
  std::optional<GrayImage> negative;  // of plates that are white on black: read in its place
  SearchedImage picture;
  Detector detector;
  SearchContext search{picture, options, detector.found(),
                       [this](const Proposal& proposal) { detector.consider(proposal); }};
  std::vector<Reading> tags;  // after each of the two steps
  bool is_done = false;
};

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
  state_->look(kCloserLook);
  state_->detector.try_likely_codes();
  state_->detector.read_covered_parts();
  state_->tags = state_->detector.found().tags();
}

const std::vector<Reading>& TagSearch::tags() const { return state_->tags; }

ReadResult TagSearch::result() const {
  return with_frameless(state_->picture, state_->options, state_->detector.result());
}

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  TagSearch search(image, options);
  search.look_closer();
  return search.result();
}

}  // namespace tagsmith::detail
