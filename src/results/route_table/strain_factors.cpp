// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/strain_factors.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "ifo/interferometer.hpp"
#include "noise/project/route_noise.hpp"
#include "results/route_table/route_sums.hpp"

namespace straytrace::results {
namespace {

// S: one-sided PSD of the quadrature of a unit field whose phase moves as the paths of the route do, mean over static
// phases; half of the PSD of the phase where motion is small.
std::vector<StrainFactor> factors_of(CouplingClass const& c, NoiseTrace const& trace, PathRow const& row,
                                     Interferometer const& ifo, double centre, double h) {
  bool const of_rim = c.kind == ClassKind::rim;  // its light is the main beam, without a phase (eq. N.21)
  double const phase = of_rim ? 0 : std::abs(ifo.strain_per_phase(c.port, centre)),
               amplitude = std::abs(of_rim ? ifo.strain_per_passing_amplitude(c.port, centre).value_or(not_a_number)
                                           : ifo.strain_per_amplitude(c.port, centre)),
               copies = ifo.copies(c.port), both = phase * phase + amplitude * amplitude,
               power = c.coupling.mean * c.reverse * copies;
  bool const bound = row.upper_bound();
  return {
      {"C", c.coupling.mean, "", "power that rejoins the mode on this route, of ordered paths, relative", bound},
      {"C_rev", c.reverse, "", "the reverse route adds in amplitude: 2 where it is another route"},
      {"N", copies, "", "equal, independent copies of the port in the detector; powers add"},
      {"kappa", row.phase_sensitivity, "rad/m",
       "rms phase sensitivity of the body that moves it: single path, all bounces counted; of 'other' weighted by "
       "noise"},
      {"phase", std::sqrt(trace.mean_square_phase), "rad", "rms; above 1 fringes wrap"},
      {"S", power > 0 && both > 0 ? h * h / (power * both) : not_a_number, "1/Hz",
       "one-sided PSD of the quadrature of a unit field, mean over static phases (half of the PSD of a small phase)"},
      {"T_phase", phase, "1", "strain per relative field in quadrature with the main field (Im s)"},
      {"T_amplitude", amplitude, "1", "strain per relative field in phase (Re s): radiation pressure"},
      {"h", h, "1/sqrt(Hz)", "sqrt(C C_rev N (T_phase^2 + T_amplitude^2) S): one-sided strain ASD", bound}};
}

}  // namespace

StrainFactors strain_factors(CouplingTable const& table, NoiseBudget const& budget, PathRow const& row,
                             Interferometer const& ifo, double hz) {
  FrequencyGrid const& grid = budget.grid;
  std::size_t const bin = grid.bin_of(hz), route = class_of(table, row);
  if (bin == grid.size())
    throw InputError(fmt::format("{:g} Hz is outside the band of the noise, {:g} Hz to {:g} Hz", hz, grid.edges.front(),
                                 grid.edges.back()),
                     "write --at with a frequency inside it");
  CouplingClass const& c = table.classes[route];
  NoiseTrace const& trace = budget.routes[route];
  double const centre = grid.centre(bin), h = trace.asd[bin];
  return {centre,
          grid.edges[bin],
          grid.edges[bin + 1],
          factors_of(c, trace, row, ifo, centre, h),
          {h, std::hypot(trace.sigma[bin], mirror_error(c.kind, c.coupling) / 2 * h), row.upper_bound()},
          !c.deterministic(),
          trace.resolved,
          trace.why_not,
          trace.linear_share[bin]};
}

}  // namespace straytrace::results
