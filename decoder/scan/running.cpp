// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/running.hpp"

#include <algorithm>
#include <memory>

#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

// Each of the first `count` samples becomes the greater or the less of it and the one `step` later.
TAGSMITH_WIDE void keep_greater(float* samples, std::size_t step, std::size_t count) {
  TAGSMITH_INDEPENDENT_TURNS
  for (std::size_t i = 0; i < count; ++i) {
    samples[i] = samples[i] < samples[i + step] ? samples[i + step] : samples[i];
  }
}

TAGSMITH_WIDE void keep_less(float* samples, std::size_t step, std::size_t count) {
  TAGSMITH_INDEPENDENT_TURNS
  for (std::size_t i = 0; i < count; ++i) {
    samples[i] = samples[i + step] < samples[i] ? samples[i + step] : samples[i];
  }
}

// The extreme of every window, from those of its two overlapping halves, which are computed in the
// same way.
template <class Take>
std::vector<float> running_extreme(const std::vector<float>& samples, std::size_t window,
                                   const Take& take) {
  if (samples.empty()) return {};
  std::vector<float> padded(samples.size() + 2 * window, samples.back());
  std::fill_n(padded.begin(), window, samples.front());
  std::ranges::copy(samples, padded.begin() + static_cast<std::ptrdiff_t>(window));
  const std::size_t length = 2 * window + 1;
  std::size_t covered = 1;
  while (covered < length) {
    const std::size_t step = std::min(covered, length - covered);
    covered += step;
    take(padded.data(), step, padded.size() - covered + 1);
  }
  padded.resize(samples.size());
  return padded;
}

// By how much the sum over a window changes from each sample to the next: the sample that enters
// minus the one that leaves, so that only one addition depends on the one before.
TAGSMITH_WIDE void changes_of_sum(const float* samples, std::size_t size, std::size_t window,
                                  double* changes) {
  const std::size_t first_left = std::min(size, window + 1);
  const std::size_t last_entered = size > window ? size - window : 0;
  for (std::size_t i = 0; i < last_entered; ++i) {
    changes[i] = static_cast<double>(samples[i + window]);
  }
  for (std::size_t i = last_entered; i < size; ++i) changes[i] = 0;
  for (std::size_t i = first_left; i < size; ++i) {
    changes[i] -= static_cast<double>(samples[i - first_left]);
  }
}

TAGSMITH_WIDE void divide(const double* sums, std::size_t size, std::size_t window, float* means) {
  const std::size_t edge = std::min(size, window);
  const auto mean_at = [&](std::size_t i) {
    const std::size_t begin = i > window ? i - window : 0;
    const std::size_t end = std::min(size, i + window + 1);
    return static_cast<float>(sums[i] / static_cast<double>(end - begin));
  };
  for (std::size_t i = 0; i < edge; ++i) means[i] = mean_at(i);
  const auto whole = static_cast<double>(2 * window + 1);
  const std::size_t middle = std::max(edge, size - edge);
  for (std::size_t i = edge; i < middle; ++i) means[i] = static_cast<float>(sums[i] / whole);
  for (std::size_t i = middle; i < size; ++i) means[i] = mean_at(i);
}

TAGSMITH_WIDE void darkness_between(const float* white, const float* black, float least,
                                    std::vector<float>& light) {
  float* samples = light.data();
  for (std::size_t i = 0; i < light.size(); ++i) {
    const float contrast = white[i] - black[i];
    samples[i] = (white[i] - samples[i]) / (contrast < least ? least : contrast);
  }
}

}  // namespace

std::vector<float> running_maximum(const std::vector<float>& samples, std::size_t window) {
  return running_extreme(samples, window, keep_greater);
}

std::vector<float> running_minimum(const std::vector<float>& samples, std::size_t window) {
  return running_extreme(samples, window, keep_less);
}

std::vector<float> running_mean(const std::vector<float>& samples, std::size_t window) {
  const std::size_t size = samples.size();
  const auto sums = std::make_unique_for_overwrite<double[]>(size);
  changes_of_sum(samples.data(), size, window, sums.get());
  double sum = 0;
  for (std::size_t i = 0; i < std::min(size, window); ++i) sum += static_cast<double>(samples[i]);
  for (std::size_t i = 0; i < size; ++i) sums[i] = sum += sums[i];
  std::vector<float> means(size);
  divide(sums.get(), size, window, means.data());
  return means;
}

std::vector<float> local_darkness(const std::vector<float>& line, std::size_t window) {
  if (line.empty()) return {};
  const std::vector<float> white = running_mean(running_maximum(line, window), window / 2);
  const std::vector<float> black = running_mean(running_minimum(line, window), window / 2);
  const auto [low, high] = std::ranges::minmax_element(line);
  const float least = std::max(kPlace.least_contrast * (*high - *low), 1e-6F);
  std::vector<float> darkness(line);
  darkness_between(white.data(), black.data(), least, darkness);
  return darkness;
}

}  // namespace tagsmith::detail
