// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/explained.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "decoder/scan/symbol_edges.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// Sums over one stretch of a profile.
struct Share {
  double variation = 0;  // about mid grey
  double unexplained = 0;
  double noise = 0;  // what the variances allow of the latter

  void add(const ScanBin& bin, double expected, double middle) {
    const double residual = bin.darkness - expected;
    const double deviation = bin.darkness - middle;
    unexplained += residual * residual / bin.variance;
    variation += deviation * deviation / bin.variance;
    noise += 1;
  }
};

// Whether a place is among guard patterns or beside them. Each left digit starts with a space and
// ends with a bar, each right digit the reverse.
bool is_known(double at) {
  constexpr std::array<std::array<double, 2>, 3> kKnown{{{-4, 4}, {44, 51}, {91, 99}}};
  return std::ranges::any_of(kKnown,
                             [&](const auto& range) { return at >= range[0] && at <= range[1]; });
}

}  // namespace

std::optional<std::size_t> digit_at(double place) {
  constexpr int kRight = first_module_of_digit(6);
  const int half = place < kRight ? 0 : 1;
  const int first = half == 0 ? first_module_of_digit(0) : kRight;
  const double digit = std::floor((place - first) / kModulesPerDigit);
  if (!(digit >= 0 && digit < 6)) return std::nullopt;
  return static_cast<std::size_t>(6 * half + static_cast<int>(digit));
}

std::vector<double> expected_darkness(const ImagingModel& image, const Digits& digits,
                                      const ScanProfile& profile) {
  const std::vector<float> shares = SymbolEdges(image, digits).shares_at(ScanPlaces(profile));
  std::vector<double> expected(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i) {
    expected[i] = image.white + (image.black - image.white) * static_cast<double>(shares[i]) +
                  image.shading * (2 * profile[i].at / kModuleCount - 1);
  }
  return expected;
}

double explained_by_guards(const ScanProfile& profile, const ImagingModel& image,
                           const std::vector<double>& expected) {
  const double middle = (image.white + image.black) / 2;
  Share share;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (is_known(profile[i].at)) share.add(profile[i], expected[i], middle);
  }
  return share.variation > 0 ? 1 - share.unexplained / share.variation : 0;
}

double guards_in(const ScanProfile& profile, const ImagingModel& image) {
  ScanProfile known;
  std::ranges::copy_if(profile, std::back_inserter(known), is_known, &ScanBin::at);
  return explained_by_guards(known, image, expected_darkness(image, {}, known));
}

bool shows_guards(const ScanProfile& profile, ImagingModel image) {
  if (guards_in(profile, image) >= kDecode.least_guards) return true;
  image.blur *= std::exp(kImaging.log_blur);
  return guards_in(profile, image) >= kDecode.least_guards;
}

std::array<double, kDigitCount> explained_by_digits(const ScanProfile& profile,
                                                    const ImagingModel& image,
                                                    const std::vector<double>& expected) {
  const double middle = (image.white + image.black) / 2;
  std::array<Share, kDigitCount> shares{};
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const auto digit = digit_at(profile[i].at);
    if (digit) shares[*digit].add(profile[i], expected[i], middle);
  }
  std::array<double, kDigitCount> explained{};
  std::ranges::transform(shares, explained.begin(), [](const Share& share) {
    if (share.variation <= 0) return 1.0;
    return 1 - std::max(0.0, share.unexplained - share.noise) / share.variation;
  });
  return explained;
}

}  // namespace tagsmith::detail
