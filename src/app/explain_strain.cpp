// SPDX-License-Identifier: BSD-3-Clause
// h^2(f) = C C_rev N (|T_phase|^2 + |T_amplitude|^2) S(f), with S the one-sided PSD of the quadrature of a unit field
// whose phase moves as the paths of the route do, mean over static phases: 1/2 of the PSD of the phase where motion is
// small (physics.md 1.7, eq. 7.2, section 9).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/explain.hpp"
#include "app/open_run.hpp"
#include "app/session.hpp"

namespace straytrace {
namespace {

struct Factor {
  char const* name;
  double value;
  char const *unit, *what;
};

std::size_t bin_at(FrequencyGrid const& grid, double hz) {
  auto const above = std::upper_bound(grid.edges.begin(), grid.edges.end(), hz);
  if (above == grid.edges.begin() || above == grid.edges.end())
    throw InputError(
        fmt::format("error: {:g} Hz is outside the band of the noise, {:g} Hz to {:g} Hz\n  write --at with "
                    "a frequency inside it",
                    hz, grid.edges.front(), grid.edges.back()));
  return std::size_t(above - grid.edges.begin()) - 1;
}

CouplingClass const& class_of(CouplingTable const& table, PathRow const& row, std::size_t& index) {
  for (index = 0; index < table.classes.size(); ++index)
    if (table.classes[index].hash == row.hash && table.ports[table.classes[index].port.value] == row.port)
      return table.classes[index];
  throw InputError("error: the run has no class of this path\n  trace it again");
}

std::vector<Factor> chain(CouplingClass const& c, NoiseTrace const& trace, PathRow const& row,
                          Interferometer const& ifo, double centre, std::size_t bin) {
  double const phase = std::abs(ifo.strain_per_phase(c.port, centre)),
               amplitude = std::abs(ifo.strain_per_amplitude(c.port, centre)), copies = ifo.copies(c.port),
               both = phase * phase + amplitude * amplitude, h = trace.asd[bin],
               power = c.coupling.mean * c.reverse * copies;
  return {
      {"C", c.coupling.mean, "", "power that rejoins the mode on this route, of ordered paths, relative"},
      {"C_rev", c.reverse, "", "the reverse route adds in amplitude: 2 where it is another route"},
      {"N", copies, "", "equal, independent copies of the port in the detector; powers add"},
      {"kappa", row.lever, "rad/m", "rms lever of the body that moves it: single path, all bounces counted"},
      {"phase", std::sqrt(trace.mean_square_phase), "rad", "rms; above 1 fringes wrap"},
      {"S", power > 0 && both > 0 ? h * h / (power * both) : not_a_number, "1/Hz",
       "one-sided PSD of the quadrature of a unit field, mean over static phases (half of the PSD of a small phase)"},
      {"T_phase", phase, "1", "strain per relative field in quadrature with the main field (Im s)"},
      {"T_amplitude", amplitude, "1", "strain per relative field in phase (Re s): radiation pressure"},
      {"h", h, "1/sqrt(Hz)", "sqrt(C C_rev N (T_phase^2 + T_amplitude^2) S): one-sided strain ASD"}};
}

}  // namespace

Explanation explain_strain(std::string const& run_file, std::size_t path, double hz) {
  OpenRun const run(run_file);
  Model const& model = run.model;
  NoiseBudget const budget = model.project(run.file.trace.coupling);
  CouplingTable const& table = run.file.trace.coupling;
  PathTable const paths = table_for(table, &budget, model);
  if (path < 1 || path > paths.rows.size())
    throw InputError(fmt::format("error: the run has no path {}; it has {}\n  see straytrace paths {}", path,
                                 paths.rows.size(), run_file));
  PathRow const& row = paths.rows[path - 1];
  std::size_t index = 0, bin = bin_at(budget.grid, hz);
  CouplingClass const& c = class_of(table, row, index);
  NoiseTrace const& trace = budget.routes[index];
  double const centre = budget.grid.centre(bin);
  Explanation a;
  a.json = {{"path", path},
            {"route", row.sequence},
            {"port", row.port},
            {"hz", centre},
            {"resolved", trace.resolved},
            {"sigma", trace.sigma[bin]},
            {"linear_share", trace.linear_share[bin]}};
  a.text = fmt::format("path {}: {}, port {}, bin {:.4g} to {:.4g} Hz\n", path, row.sequence, row.port,
                       budget.grid.edges[bin], budget.grid.edges[bin + 1]);
  for (Factor const& f : chain(c, trace, row, *model.detector, centre, bin)) {
    a.json["factors"][f.name] = {{"value", f.value}, {"unit", f.unit}, {"what", f.what}};
    a.text += fmt::format("  {:<11} {:<10.4g} {:<11} {}\n", f.name, f.value, f.unit, f.what);
  }
  a.text += fmt::format(
      "  h = {} /sqrt(Hz), Monte-Carlo error; moved by {}; {:.0f} % of its power to first order in the motion of the "
      "bin\n",
      with_error(trace.asd[bin], trace.sigma[bin]), row.moves.empty() ? "nothing" : row.moves,
      100 * trace.linear_share[bin]);
  if (!trace.resolved) a.text += fmt::format("  unresolved, the numbers are hints: {}\n", trace.why_not);
  a.text += "see docs/theory/spectra.md\n";
  return a;
}

}  // namespace straytrace
