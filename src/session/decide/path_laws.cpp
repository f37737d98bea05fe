// SPDX-License-Identifier: BSD-3-Clause
#include "session/decide/path_laws.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "noise/project/route_noise.hpp"
#include "optics/coating/specular.hpp"
#include "optics/scatter/mixture.hpp"
#include "session/light/cavity_waves.hpp"
#include "trace/importance/importance.hpp"
#include "world/model/vertex.hpp"

namespace straytrace::session {
namespace {

// What the surface makes of the light at a vertex: BSDF, reflectance or transmittance; 1 where nothing acts.
double law_at(WorldView const& world, trace::PassedVertex const& passed) {
  if (!passed.surface.valid() || passed.event == Event::receive || passed.event == Event::start) return 1;
  Vertex const v = make_vertex(world, passed.surface, passed.point, passed.in);
  if (letter(passed.event) == 'S')
    return scatter_eval(world.laws, *v.optic, v.wi, v.frame.to_local(passed.out), passed.n_in, passed.n_out);
  double const scattered = scatter_albedo(world.laws, *v.optic, v.wi.z);
  SpecularShares const s =
      specular_shares(world.interfaces, *v.optic, v.wi.z, passed.n_in, passed.n_out, v.front, scattered);
  return passed.event == Event::reflect ? s.reflect : passed.event == Event::transmit ? s.transmit : 1;
}

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

constexpr std::array incidences{0.0, 1.0, 30.0, 60.0, 80.0};  // degrees

// Calls `action` with the BSDF before and after, in directions by 1 % of the distance from the specular one.
template <class Action>
void compare(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after, Action const& action) {
  for (double const degrees : incidences)
    for (double offset = 1e-7; offset < 1.5; offset *= 1.01)
      for (double const towards : {offset, -offset})
        for (int const side : {1, -1})
          action(bsdf_at(a, before, degrees, towards, side), bsdf_at(b, after, degrees, towards, side));
}

}  // namespace

std::optional<double> common_factor(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after) {
  double low = infinity, high = 0;
  compare(a, before, b, after, [&](double x, double y) {
    if (!(x > 0) && !(y > 0)) return;
    double const ratio = x > 0 ? std::max(y, 0.0) / x : infinity;
    low = std::min(low, ratio);
    high = std::max(high, ratio);
  });
  if (low > high) return 1.0;
  return high <= low * (1 + 1e-9) ? std::optional(high) : std::nullopt;
}

double largest_ratio(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after) {
  double largest = 0;
  compare(a, before, b, after, [&](double x, double y) {
    if (y > 0) largest = std::max(largest, x > 0 ? y / x : infinity);
  });
  return largest;
}

bool same_coating(WorldView const& a, Optic const& before, WorldView const& b, Optic const& after) {
  return std::ranges::all_of(incidences, [&](double degrees) {
    MaterialShares const x = shares_at(a, before, degrees), y = shares_at(b, after, degrees);
    return std::fabs(x.reflect - y.reflect) <= 1e-3 * x.reflect && std::fabs(x.transmit - y.transmit) <= 1e-3 * x.transmit;
  });
}

MaterialChange change_of(World const& before, World const& after) {
  MaterialChange change;
  WorldView const a = before.view(), b = after.view();
  std::vector<PlacedMaterial> const placed = placed_materials(before);
  for (std::size_t i = 0; i < before.materials.size() && i < after.materials.size(); ++i) {
    Optic const &was = a.optics[before.materials[i].optic], &is = b.optics[after.materials[i].optic];
    std::optional<double> const factor = common_factor(a, was, b, is);
    bool const coating = !same_coating(a, was, b, is);
    change.shape = change.shape || !factor;
    change.coating = change.coating || coating;
    if (factor == 1.0 && !coating) continue;
    for (PlacedMaterial const& m : placed)
      if (m.name == before.materials[i].name)
        change.groups.insert(change.groups.end(), m.groups.begin(), m.groups.end());
  }
  return change;
}

std::vector<bool> computed_anew(CouplingTable const& table, MaterialChange const& change) {
  auto const meets = [&](std::vector<PathStep> const& steps) {
    return std::ranges::any_of(steps, [&](PathStep const& s) { return std::ranges::find(change.groups, s.group) != change.groups.end(); });
  };
  std::vector<bool> all;
  for (CouplingClass const& c : table.classes) {
    bool const met = meets(c.steps) || std::ranges::any_of(c.folded, [&](FoldedRoute const& f) { return meets(f.steps); });
    all.push_back(c.deterministic() && met && c.kind != ClassKind::ghost);
  }
  return all;
}

double PathLaws::log_factor(World const& other, Path const& path) const {
  WorldView const before = model_.world.view(), after = other.view();
  double sum = 0;
  for (trace::PassedVertex const& vertex : path.vertices) {
    double const was = law_at(before, vertex), is = law_at(after, vertex);
    if (was != is) sum += std::log(is / was);
  }
  for (std::uint32_t const end : {path.source, path.goal}) {
    if (end >= before.lit.size || end >= after.lit.size) continue;  // a receiver
    double const was = before.lit[end].share, is = after.lit[end].share;
    if (was != is) sum += std::log(is / was);
  }
  return sum;
}

PathLaws::PathLaws(RunFile const& file, unsigned threads) : table_(file.trace.coupling), model_(model_of(file)) {
  model_.world.block_size = table_.block_size;
  model_.waves = file.about.waves;
  light_halo(model_, true, threads, {.quiet = true});
  SteeredWorld const world = trace::steer(model_.world, threads);
  for (CouplingClass const& c : table_.classes) {
    auto& rows = paths_.emplace_back();
    for (PathRecord const& r : c.records) {
      if (c.deterministic()) break;
      auto path = trace::replay(world, table_.seed, r.history, r.event, r.connection);
      rows.push_back(path ? Path{std::move(path->vertices), path->source, path->goal} : Path{});
    }
  }
}

PathFactors PathLaws::factors(Model const& other) const {
  PathFactors all;
  for (auto const& paths : paths_) {
    auto& of_class = all.emplace_back();
    for (Path const& path : paths)
      of_class.push_back(path.vertices.empty() ? not_a_number : log_factor(other.world, path));
  }
  return all;
}

std::vector<double> PathLaws::largest_ratios(Model const& other) const {
  World const& world = model_.world;
  WorldView const before = world.view(), after = other.world.view();
  std::vector<double> largest(world.materials.size());
  auto const look = [&](trace::PassedVertex const& passed) {
    if (!passed.surface.valid() || letter(passed.event) != 'S') return;
    Surface const& surface = world.surfaces()[passed.surface.value];
    bool const front = make_vertex(before, passed.surface, passed.point, passed.in).front;
    std::uint32_t const optic = world.material_optic(front ? surface.front : surface.back);
    double const ratio = law_at(after, passed) / law_at(before, passed);
    for (std::size_t m = 0; m < largest.size(); ++m)
      if (world.materials[m].optic == optic && std::isfinite(ratio)) largest[m] = std::max(largest[m], ratio);
  };
  for (auto const& paths : paths_)
    for (Path const& path : paths) std::ranges::for_each(path.vertices, look);
  return largest;
}

ReweightedCouplings reweighted(CouplingTable const& table, PathFactors const& factors) {
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

namespace {

// Factor of a ghost route by its coatings, those of the groups that it meets.
RouteFactor coating_factor(World const& before, World const& after) {
  struct Ratio {
    double reflect = 1, transmit = 1;
  };
  std::map<std::uint32_t, Ratio> ratios;  // by group
  WorldView const a = before.view(), b = after.view();
  std::vector<PlacedMaterial> const placed = placed_materials(before);
  for (std::size_t i = 0; i < before.materials.size() && i < after.materials.size(); ++i) {
    MaterialShares const was = shares_at(a, a.optics[before.materials[i].optic], 0),
                         is = shares_at(b, b.optics[after.materials[i].optic], 0);
    Ratio const ratio{was.reflect > 0 ? is.reflect / was.reflect : 1, was.transmit > 0 ? is.transmit / was.transmit : 1};
    if (ratio.reflect == 1 && ratio.transmit == 1) continue;
    for (PlacedMaterial const& m : placed)
      if (m.name == before.materials[i].name)
        for (GroupId const group : m.groups) ratios[group.value] = ratio;
  }
  return [ratios](std::vector<PathStep> const& steps) {
    double factor = 1;
    for (PathStep const& s : steps)
      if (auto const hit = ratios.find(s.group.value); hit != ratios.end())
        factor *= s.event == Event::reflect ? hit->second.reflect : s.event == Event::transmit ? hit->second.transmit : 1;
    return factor;
  };
}

}  // namespace

ReweightedCouplings reweighted(CouplingTable const& table, PathFactors const& factors, World const& before,
                               World const& after) {
  ReweightedCouplings out = reweighted(table, factors);
  RouteFactor const coatings = coating_factor(before, after);
  ScaledCouplings ghosts = scaled_couplings(out.light.table, [&](std::vector<PathStep> const& steps) { return coatings(steps); });
  for (CouplingClass& c : out.light.table.classes) {
    if (c.kind != ClassKind::ghost) continue;
    auto const same = [&](CouplingClass const& other) { return other.hash == c.hash && other.port.value == c.port.value; };
    if (auto const hit = std::ranges::find_if(ghosts.table.classes, same); hit != ghosts.table.classes.end()) c = *hit;
  }
  return out;
}

}  // namespace straytrace::session
