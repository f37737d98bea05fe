// SPDX-License-Identifier: BSD-3-Clause
// Autocovariances of the classes of motion, shared by all paths of about the same fringe rate.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "noise/classes/motion_classes.hpp"
#include "noise/wrapped/wrapped_spectrum.hpp"

namespace straytrace {

// R(tau) = sum over classes of kappa_c r_c(tau), of the Gaussian motion below a frequency. What many paths ask for is
// kept: power on the lines of the transform, and r_c; of more than `few` classes at once R is transformed itself. Not
// for several threads at once.
class ClassCovariances {
 public:
  Covariance sum(std::span<MotionClass const>, std::span<double const> kappa, double highest_hz, LagGrid const&);

 private:
  static constexpr std::size_t few = 3;
  using Band = std::vector<Covariance>;  // per class, empty where not needed so far
  Covariance const& of_class(Band&, std::span<MotionClass const>, std::size_t c, double highest_hz, LagGrid const&);
  std::vector<double> const& line_powers(MotionClass const&, std::size_t c, double spacing, std::size_t count);
  std::vector<double> lines(std::span<MotionClass const>, std::span<double const> kappa, double highest_hz,
                            double spacing);

  double spacing_ = 0;
  std::vector<std::vector<double>> power_;                // per class, at k > 0 from (k - 1/2) to (k + 1/2) spacing
  std::map<std::pair<double, std::size_t>, Band> bands_;  // by highest frequency and samples
  std::size_t kept_ = 0;                                  // numbers in them
};

}  // namespace straytrace
