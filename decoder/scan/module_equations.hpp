// SPDX-License-Identifier: Apache-2.0
// A profile as a quadratic function of the parts of a symbol.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "decoder/scan/characters.hpp"
#include "decoder/scan/module_light.hpp"
#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_fit.hpp"

namespace tagsmith::detail {

// ---- Whether digits may be other ones, corrupted so that they look like these.

// A digit's profile as a quadratic function of the darkness of its modules. The growth of the edges
// stays unchanged: an effect of one edge alone must not support a digit without it.
struct DigitModules {
  using Modules = Eigen::Vector<double, kModulesPerDigit>;
  using Square = Eigen::Matrix<double, kModulesPerDigit, kModulesPerDigit>;
  Modules residuals = Modules::Zero();  // of the digit
  Square products = Square::Zero();     // of the modules' light
};

// For each of the digits, all of them of 0 to 9, the odds that it is another.
std::array<double, kDigitCount> odds_of_corrupted_digits(
    const std::array<DigitModules, kDigitCount>& modules, const Characters& digits);

// ---- The equations.

// The profile as a quadratic function of the light that each module and each edge adds: everything
// that the decoder needs to know of it for one picture of the symbol.
class ModuleNormalEquations {
 public:
  // `light` is of these places, whatever their variances. With `slack`, the picture adapts to each
  // symbol as far as it leaves: costs about a reference are then those after a fit of the picture
  // to each symbol, linearized.
  ModuleNormalEquations(const ScanProfile& profile, const ModuleLight& light,
                        const NuisanceCovariance& slack = {});

  // With a reference, the overlap of characters beyond their neighbours is taken from it, and the
  // picture adapts to what differs from it; without, both are left out.
  CharacterCosts character_costs(const Characters* reference = nullptr) const;

  // How far the profile is from the symbol of these characters, module by module: the square of the
  // residuals' projection on the light of each module, over its variance. About 1 where the
  // profile's variances cover everything that the symbol does not explain.
  std::array<float, kModuleCount> misfits(const Characters& characters) const;

  // For each digit, the odds that it is another one, corrupted by anything that makes it look like
  // this: modules of any darkness about that digit's, against modules that are printed and lit
  // nearly evenly, or corrupted too, about this one's.
  std::array<double, kDigitCount> odds_of_corrupted_digits(const Characters& characters) const;

 private:
  static constexpr std::size_t kSlack = NuisanceCovariance::value_type::SizeAtCompileTime;
  using Pull = NuisanceCovariance::value_type;

  float gram(std::size_t a, std::size_t b) const;
  const float* gram_row(std::size_t a) const { return gram_.data() + a * stride_; }
  std::array<float, kFeatures> residuals_of(const Characters& characters) const;

  void add_places(const ScanProfile& profile, const ModuleLight& light,
                  const NuisanceCovariance& slack);
  void add_place(const ModuleLight::Place& place, const float* light, float weight);
  void add_pull(const ModuleLight::Place& place, const float* light, float weight,
                const Pull& slack);
  void take_out(const std::array<std::uint8_t, kFeatures>& present);
  CharacterLanes costs_alone(std::size_t position) const;
  void set_pair_costs(std::size_t position,
                      std::array<CharacterCosts::Row, kCharacterCount>& pair) const;
  void add_far_costs(const Characters& reference, CharacterCosts& costs) const;
  void adapt_picture(const Characters& reference, CharacterCosts& costs) const;

  std::size_t band_;    // features this far apart have no overlap
  std::size_t stride_;  // of rows of gram_: band_ or more
  float constant_ = 0;
  bool adapts_;
  std::array<float, kFeatures + ModuleLight::kLanes> right_{};
  std::vector<Pull> pull_;   // of a feature on the picture
  std::vector<float> gram_;  // row a: of the features a, a + 1, ... with a
};

}  // namespace tagsmith::detail
