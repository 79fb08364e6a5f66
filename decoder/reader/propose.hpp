// SPDX-License-Identifier: Apache-2.0
// Where in a picture tags may be. A proposer has the places that it finds considered one by one, so
// that the result at one place is known before it looks for the next. To add one, write a function
// here and put it into a list of reader.cpp, with the name that `read --explain` gives it; what it
// needs to know from the caller is a member of ReadOptions. A costly one needs a bound and a reason
// to run: docs/decisions/0008-search-and-its-cost.md.
#pragma once

#include <functional>
#include <string_view>

#include "decoder/reader/proposal.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/searched_image.hpp"
#include "decoder/reader/tag_hypotheses.hpp"

namespace tagsmith::detail {

// What proposers see and what they share.
struct SearchContext {
  SearchedImage& picture;
  const ReadOptions& options;
  const TagHypotheses& found;                     // the results of the proposals so far
  std::function<void(const Proposal&)> consider;  // reads a tag there, if there is one
  bool is_searched = false;                       // the whole picture; else no closer look follows
};

struct Proposer {
  std::string_view name;
  void (*propose)(SearchContext& search);
};

// Expected tags where they should be, then what looks like a frame around there.
void propose_expected(SearchContext& search);

// Outlines near bars, all over the picture where the options ask for that.
void propose_near_bars(SearchContext& search);

// Frames whose outline is not visible in one piece, found by the bars inside.
void propose_around_bars(SearchContext& search);

// Outlines joined of two pieces, where nothing was read.
void propose_pieces(SearchContext& search);

// Frames that were refused and may be covered, and the bars in them.
void propose_refused(SearchContext& search);

// Bars that no reading explains, where nothing was read or something was in the way.
void propose_bars(SearchContext& search);

}  // namespace tagsmith::detail
