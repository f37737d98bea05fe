// SPDX-License-Identifier: BSD-3-Clause
#include "session/decide/reweighted.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "noise/project/route_noise.hpp"
#include "session/light/cavity_waves.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::session {
namespace {

struct RowSums {
  double before = 0, after = 0, squares = 0, unknown = 0;
  std::array<double, replica_count> of_before{}, of_after{};
};

RowSums sums_of(CouplingTable const& table, CouplingClass const& c, std::vector<double> const& factors) {
  RowSums s;
  for (std::size_t j = 0; j < c.records.size(); ++j) {
    double const w = c.records[j].weight, f = std::isnan(factors[j]) ? 0 : factors[j], changed = w * std::exp(f);
    std::size_t const r = replica_of(c.records[j].history, table.block_size);
    s.before += w;
    s.after += changed;
    s.squares += changed * changed;
    s.unknown += std::isnan(factors[j]) ? w : 0;
    s.of_before[r] += w;
    s.of_after[r] += changed;
  }
  return s;
}

void scale_replicas(CouplingClass& c, RowSums const& s) {
  double before = 0, after = 0;
  for (std::size_t r = 0; r < replica_count; ++r) {
    before += c.replica_sum[r];
    c.replica_sum[r] *= s.of_before[r] > 0 ? s.of_after[r] / s.of_before[r] : s.after / s.before;
    after += c.replica_sum[r];
  }
  double const factor = before > 0 ? after / before : s.after / s.before;
  c.coupling.mean *= factor;
  c.coupling.std_error *= factor;
  c.phase_sensitivities.clear();  // moments of the paths as traced
}

ReweightedCouplings by_paths(CouplingTable const& table, PathFactors const& factors) {
  ReweightedCouplings out{{table, {}}, {}};
  std::vector<CouplingClass> lit;
  for (std::size_t k = 0; k < table.classes.size(); ++k) {
    CouplingClass& c = out.light.table.classes[k];
    if (factors[k].empty() || !(c.coupling.mean > 0)) {
      out.light.unknown.push_back(0);
      out.effective.push_back(infinity);
      lit.push_back(std::move(c));
      continue;
    }
    RowSums const s = sums_of(table, c, factors[k]);
    out.light.unknown.push_back(s.unknown / s.before);
    out.effective.push_back(s.after > 0 ? s.after * s.after / s.squares : 0);
    if (!(s.after > 0)) continue;
    for (std::size_t j = 0; j < c.records.size(); ++j)
      if (!std::isnan(factors[k][j])) c.records[j].weight *= std::exp(factors[k][j]);
    scale_replicas(c, s);
    lit.push_back(std::move(c));
  }
  out.light.table.classes = std::move(lit);
  return out;
}

// Factor of a ghost route by the coatings that it meets.
RouteFactor coating_factor(World const& before, World const& after) {
  return [ratios = coating_ratios(before, after)](std::vector<PathStep> const& steps) {
    double factor = 1;
    for (PathStep const& s : steps)
      if (auto const hit = ratios.find(s.group.value); hit != ratios.end())
        factor *= s.event == Event::reflect    ? hit->second.reflect
                  : s.event == Event::transmit ? hit->second.transmit
                                               : 1;
    return factor;
  };
}

void scale_ghosts(CouplingTable& table, RouteFactor const& coatings) {
  CouplingTable ghosts = table;
  std::erase_if(ghosts.classes, [](CouplingClass const& c) { return c.kind != ClassKind::ghost; });
  std::erase_if(table.classes, [](CouplingClass const& c) { return c.kind == ClassKind::ghost; });
  for (CouplingClass& c : scaled_couplings(ghosts, coatings).table.classes) table.classes.push_back(std::move(c));
}

Model as_traced(RunFile const& file, unsigned threads) {
  Model model = model_of(file);
  model.world.block_size = file.trace.coupling.block_size;
  model.waves = file.about.waves;
  light_halo(model, true, threads, {.quiet = true});
  return model;
}

}  // namespace

KeptPaths::KeptPaths(RunFile const& file, unsigned threads)
    : model_(as_traced(file, threads)), laws_(steer(model_.world, threads), file.trace.coupling) {}

std::vector<bool> computed_anew(CouplingTable const& table, MaterialChange const& change) {
  auto const meets = [&](std::vector<PathStep> const& steps) {
    return std::ranges::any_of(
        steps, [&](PathStep const& s) { return std::ranges::find(change.groups, s.group) != change.groups.end(); });
  };
  std::vector<bool> all;
  for (CouplingClass const& c : table.classes) {
    bool const met =
        meets(c.steps) || std::ranges::any_of(c.folded, [&](FoldedRoute const& f) { return meets(f.steps); });
    all.push_back(c.deterministic() && met && c.kind != ClassKind::ghost);
  }
  return all;
}

ReweightedCouplings reweighted(CouplingTable const& table, KeptPaths const& paths, World const& after) {
  PathFactors const factors = paths.laws().factors(after);
  ReweightedCouplings out = by_paths(table, factors);
  for (auto const& of_class : factors)
    out.meets_edge = out.meets_edge || std::ranges::any_of(of_class, [](double f) { return std::isinf(f); });
  scale_ghosts(out.light.table, coating_factor(paths.world(), after));
  return out;
}

}  // namespace straytrace::session
