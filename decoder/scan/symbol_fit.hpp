// SPDX-License-Identifier: Apache-2.0
// How a symbol's bars appear in a scan profile, and the adjustment of that picture to the profile.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_edges.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// How well a symbol explains a profile.
struct SymbolFit {
  ImagingModel image;
  double cost = 0;       // sum of squared residuals over variances
  double explained = 0;  // share of the profile's variation that is explained, at most 1
  bool is_grey = false;  // the blur is 4 modules, the most that is tried: no bar shows
};

// Adjusts all of `start` to the profile by Gauss-Newton for the given digits. The parameters are
// held near nominal by weak priors, so that no profile can bend the symbol into another one.
SymbolFit fit_symbol(const ScanProfile& profile, const Digits& digits, const ImagingModel& start);

// How a profile's bars are displaced, and with which uncertainty.
struct SeenPlaces {
  Eigen::Vector3d displacement;  // shift, stretch and bend of an ImagingModel
  Eigen::Matrix3d covariance;    // as if all places of the profile were independent of each other
  std::vector<float> residuals;  // of the places, in standard deviations
  // How lopsided the point spread is along the symbol: its third central moment by its variance,
  // modules, and the standard deviation of that. A picture of two moments shows it.
  double lopsided = 0;
  double lopsided_sigma = 0;

  // How the place of a module changes with the displacement.
  static Eigen::RowVector3d by_displacement(double module);
  double place_of(double module) const {
    return module + by_displacement(module).dot(displacement);
  }
};

// The displacement of bars that show these digits: it and the levels are free, except for a bend
// with a prior of 0 and its standard deviation (infinite: free). `start` as for fit_symbol.
SeenPlaces seen_places(const ScanProfile& profile, const Digits& digits, const ImagingModel& start,
                       double bend_sigma = std::numeric_limits<double>::infinity());

// The freedom that is left in the picture of a symbol after a fit: at each place of the profile,
// the change of the darkness by one standard deviation of eight independent combinations of the
// parameters, as the profile and the priors leave them.
using NuisanceCovariance = std::vector<Eigen::Matrix<float, 8, 1>>;

// `bars` are the shares of the symbol's bars in the profile's places, with the derivatives there.
NuisanceCovariance nuisance_covariance(const ScanProfile& profile, const ImagingModel& image,
                                       const std::vector<BarShare>& bars);

std::vector<BarShare> bar_shares(const ScanProfile& profile, const ImagingModel& image,
                                 const Digits& digits);

}  // namespace tagsmith::detail
