// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "decoder/reader/read_options.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// How to read the tags of these surveys: their templates' layouts, their codes as the code book,
// and their check digit where they agree on one.
ReadOptions read_options_for(std::span<const Survey> surveys);

// The same of surveys that lie apart; none is copied.
ReadOptions read_options_of(std::span<const Survey* const> surveys);

}  // namespace tagsmith::detail
