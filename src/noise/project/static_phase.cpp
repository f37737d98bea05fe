// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/static_phase.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"

namespace straytrace::noise {
namespace {

bool moved_by(CouplingClass const& c, std::uint32_t body) {
  auto const moves = [&](PhaseSensitivity const& s) {
    return s.body.value == body && std::ranges::any_of(s.d, [](double d) { return d != 0; });
  };
  return std::ranges::any_of(c.records,
                             [&](PathRecord const& r) { return std::ranges::any_of(r.phase_sensitivities, moves); });
}

}  // namespace

std::vector<std::optional<double>> known_phases(CouplingTable const& table, MotionSet const& motion,
                                                std::vector<StaticPhase> const& stated,
                                                ifo::Interferometer const& ifo) {
  std::vector<std::optional<double>> phases(table.classes.size());
  for (std::size_t r = 0; !stated.empty() && r < table.classes.size(); ++r) {
    CouplingClass const& c = table.classes[r];
    if (c.deterministic() && (c.kind != ClassKind::ghost || c.adds_fields())) continue;
    StaticPhase const* by = nullptr;
    for (StaticPhase const& s : stated) {
      auto const body = std::ranges::find(motion.bodies, s.body);
      if (body == motion.bodies.end() || !moved_by(c, std::uint32_t(body - motion.bodies.begin()))) continue;
      if (by)
        throw InputError(fmt::format("'{}' and '{}' both state the static phase of route '{}'", by->body, s.body,
                                     route_name(table, c)),
                         "keep one of them in 'static_phase' of 'noise'");
      by = &s;
    }
    if (!by) continue;
    if (ifo.copies(c.port) != 1)
      throw InputError(
          fmt::format("'static_phase' of '{}' is that of one scatterer, and port '{}' has {:g} equal copies", by->body,
                      table.ports[c.port.value], ifo.copies(c.port)),
          "write 'copies: 1' for this port in the interferometer, or 'arms: 1'");
    phases[r] = by->phase;
  }
  return phases;
}

namespace {

struct Strength {
  std::vector<double> kappa;
  double weight = 0, square = 0;  // square: mean-square phase
};

// Shares of equal power in the order of strength, each by the path in its middle.
std::vector<Strength> chosen(std::vector<Strength> all) {
  if (all.size() <= representatives) return all;
  std::ranges::stable_sort(all, {}, &Strength::square);
  double const power =
      std::accumulate(all.begin(), all.end(), 0.0, [](double sum, Strength const& s) { return sum + s.weight; });
  std::vector<Strength> some;
  double before = 0;
  for (Strength const& s : all) {
    double const after = before + s.weight / power * double(representatives);
    double const middles = std::floor(after + 0.5) - std::floor(before + 0.5);
    if (middles > 0) {
      some.push_back(s);
      some.back().weight = middles;
    }
    before = after;
  }
  return some;
}

}  // namespace

std::vector<double> phase_relation(PhaseSpectra const& spectra, MotionSet const& motion, CouplingClass const& c) {
  std::vector<Strength> all;
  for (PathRecord const& r : c.records) {
    if (!(r.weight > 0)) continue;
    Strength s{kappa_of(motion, spectra.classes(), r.phase_sensitivities), r.weight, 0};
    s.square = spectra.mean_square_phase(s.kappa);
    all.push_back(std::move(s));
  }
  std::vector<double> ratio(spectra.grid().size());
  if (all.empty()) return ratio;
  std::vector<PhasePair> same, opposite;
  for (Strength const& s : chosen(std::move(all))) {
    std::vector<double> turned = s.kappa;
    for (double& k : turned) k = -k;
    same.push_back({s.weight, s.kappa, s.kappa});
    opposite.push_back({s.weight, s.kappa, std::move(turned)});
  }
  PairSpectrum const mean = pair_spectrum(spectra, same), relation = pair_spectrum(spectra, opposite);
  for (std::size_t i = 0; i < ratio.size(); ++i)
    ratio[i] = mean.psd[i] > 0 ? std::clamp(relation.psd[i] / mean.psd[i], -1.0, 1.0) : 0;
  return ratio;
}

}  // namespace straytrace::noise
