// SPDX-License-Identifier: Apache-2.0
// The series of pictures that bench_campaign reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tests/bench/mass_picture.hpp"
#include "tests/bench/pieces.hpp"

namespace tagsmith::detail::bench {

// Frames with anything inside, half of them read with a code book of 400 codes; the stated
// confidence is compared with what was right.
// `nothing_given`: read without a book and without a named scheme, not each way in turn.
Series frame_series(const std::string& name, std::function<mass::Picture(std::uint64_t)> draw,
                    bool nothing_given = false);

// The same frames cut by the picture's border, read as parts with a book.
Series half_series();

// Frames of which something hides digits, read as parts with a book.
Series hidden_series();

// Cuttings of the photos below a folder, which show no tag: turned, enlarged, brightened at random.
Result<Series> photo_series(const std::filesystem::path& folder);

// How many readings were believed, how many of them were wrong, and what share of wrong ones that
// leaves possible (Clopper and Pearson's upper bound at 95 %, by its approximation for few).
void print_bound(double pictures, double believed, double wrong);

}  // namespace tagsmith::detail::bench
