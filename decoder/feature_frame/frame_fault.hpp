// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tl/expected.hpp>

namespace tagsmith::detail {

// Why an outline could not be fitted as the inner edge of a feature frame.
enum class FrameFault {
  not_framed,      // no white, black, white across its sides
  no_edge,         // a side shows no edge along most of its length
  side_too_short,  // a side has too few pixels
  no_fit,          // a side's edge cannot be fitted near where it was
  not_closed,      // the sides do not meet in four corners
  covered,         // fewer than two sides show
};

template <class T>
using FrameResult = tl::expected<T, FrameFault>;

inline tl::unexpected<FrameFault> fail(FrameFault fault) { return tl::unexpected(fault); }

}  // namespace tagsmith::detail
