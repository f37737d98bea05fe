// SPDX-License-Identifier: BSD-3-Clause
// Response of h to one coordinate of one body, from the coupling table: the coupling function of small motion, and the
// response to a large one (docs/theory/spectra.md, eq. 7.2, 7.4, 7.9).
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "noise/noise.hpp"

namespace straytrace::noise {

struct BodyAxis {
  BodyId body;
  int axis = 0;  // 0..2 translations x, y, z; 3..5 rotations about them
};

struct PredictedRoute {
  std::string name;
  std::vector<double> factor, sigma;  // strain per m (per rad for rotations); one standard error, Monte Carlo
  double phase = 0;         // rms of the phase per m (per rad), |J|: over its paths by power, of a row `other` by noise
  double multiplicity = 0;  // |J| lambda/4 pi: equivalent number of normal-incidence bounces; translations only
  bool resolved = true;
  bool upper_bound = false;
  std::string why_not;
  double share = 0;  // of the coupling power of all resolved routes, summed over the band
};

struct PredictedCoupling {
  FrequencyGrid grid;
  std::vector<double> factor, sigma;   // as the total of a budget: mean over static phases of small motion
  std::vector<double> bound_share;     // of factor^2, by routes computed as upper bounds
  std::vector<PredictedRoute> routes;  // those that move with the body, the largest share first
  std::vector<std::string> unresolved;
  // Smallest peak motion at which a route with 1 % of the observed coupling power has a phase of 1 rad: 1/|J|,
  // lambda/4 pi over its multiplicity. Beyond it coupling is not linear; m (rad).
  double linear_to = 0;
  bool has_bounds() const { return std::ranges::any_of(routes, &PredictedRoute::upper_bound); }
};

// h^2(f)/x^2(f) = sum over paths of f_p |J_p|^2/2 (|T_phase|^2 + |T_amplitude|^2): exact for motion so small that no
// phase reaches 1e-3 rad. The other bodies are at rest.
PredictedCoupling predict_coupling(CouplingTable const&, std::vector<std::string> const& bodies, Interferometer const&,
                                   FrequencyGrid const&, BodyAxis);

struct DrivenRoute {
  std::string name;
  double phase_peak = 0;  // rad, rms over its paths: z
  double cutoff = 0;      // Hz, z f_m: the edge of its shelf; of its first line where z is below 1
  bool resolved = true;
};
struct DrivenResponse {
  NoiseBudget budget;  // with the sine alone: averages over bins, 1/sqrt(Hz)
  std::vector<DrivenRoute> routes;
  double phase_peak = 0, cutoff = 0;  // the largest of the routes
};
// The same body driven by a sine of this peak amplitude (m, rad) at f_m, others at rest: exact at any amplitude.
DrivenResponse drive_body(CouplingTable const&, std::vector<std::string> const& bodies, Interferometer const&,
                          FrequencyGrid const&, BodyAxis, double peak, double hz);

// The body's own motion along this coordinate, of a scene: its input spectra, through their transfer functions. Other
// bodies and coordinates are at rest.
MotionSet motion_along(MotionSet const&, BodyAxis);
double rms_of(MotionSet const&, BodyAxis);  // m (rad); tones with their rms, drifts left out

}  // namespace straytrace::noise
