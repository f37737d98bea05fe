// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/mode_table.hpp"

#include <algorithm>
#include <cmath>

#include "ifo/layout/operating_point.hpp"

namespace straytrace::ifo {
namespace {

BeamModes modes_at(Network const& n, SteadyField const& f, std::uint32_t port) {
  ModeBases const& bases = *f.bases();
  BeamModes beam{.port = n.port_name(port), .power = f.power_out(port)};
  for (std::size_t axis : {0, 1}) beam.w[axis] = std::sqrt(n.wavelength() / (pi * bases.leaving(port)[axis].imag()));
  beam.share.resize(std::size_t(n.modes()->order) + 1);
  for (std::size_t mode = 0; mode < f.modes(); ++mode)
    for (std::size_t c = 0; c < f.carriers().size(); ++c)
      beam.share[std::size_t(bases.orders(mode)[0] + bases.orders(mode)[1])] += std::norm(f.out(port, c, mode));
  for (double& s : beam.share) s = beam.power > 0 ? s / beam.power : not_a_number;
  return beam;
}

Truncation truncation_of(NetworkModel const& model, SteadyField const& f) {
  Network const& n = model.network;
  Truncation t{.order = n.modes()->order, .lower = std::max(0, n.modes()->order - 2)};
  double most = 0;
  for (std::uint32_t p = 0; p < n.ports(); ++p) most = std::max(most, f.power_out(p));
  for (int const less : {2, 4}) {  // one order alone may couple to nothing, as at some radii of an aperture
    Network coarse = n;
    ModeSettings settings = *n.modes();
    settings.order = std::max(0, t.order - less);
    if (less > 2 && settings.order < 2) continue;  // the fundamental mode is no comparison
    coarse.use_modes(settings);
    SteadyField const g(coarse);
    for (std::uint32_t p = 0; p < n.ports(); ++p) {
      double const power = f.power_out(p);
      if (!(power > Truncation::least_power * most)) continue;
      double const change = std::fabs(g.power_out(p) / power - 1);
      if (change > t.change || t.beam.empty())
        t.change = change, t.beam = n.port_name(p) + ".out", t.lower = settings.order;
    }
  }
  OperatingPoint const point = operating_point(model);
  t.missing = point.missing;
  t.emitted = point.emitted;
  return t;
}

}  // namespace

ModeTable mode_table(NetworkModel const& model) {
  Network const& n = model.network;
  if (!n.modes()) ModeBases{n};  // says why not
  SteadyField const f(n);
  ModeBases const& bases = *f.bases();
  ModeTable table;
  for (std::uint32_t p = 0; p < n.ports(); ++p)
    if (f.power_out(p) > 0) table.beams.push_back(modes_at(n, f, p));
  for (NetworkCavity const& c : cavities_of(n)) {
    CavityMode const mode = mode_of(n, c);
    bool const basis =
        std::ranges::any_of(bases.cavities(), [&](CavityMode const& b) { return b.cavity.name == c.name; });
    table.resonances.push_back({c.name, n.port_name(c.beams.front()), mode.stable(), basis, mode});
  }
  table.mismatches = bases.mismatches();
  table.truncation = truncation_of(model, f);
  return table;
}

}  // namespace straytrace::ifo
