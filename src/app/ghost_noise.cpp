// SPDX-License-Identifier: BSD-3-Clause
#include "app/ghost_noise.hpp"

#include <array>
#include <cmath>
#include <map>

#include "report/band.hpp"
#include "trace/beside.hpp"

namespace straytrace {
namespace {

char const* statement_of(GhostFamily const& f) {
  return f.sum == GhostSum::coherent
             ? "ghosts with equal levers, fields added with the phases of the geometry as it is written (physics.md "
               "eq. "
               "10.5)"
             : "ghosts with equal levers, powers added: their static phases are independent (physics.md eq. 10.5)";
}

}  // namespace

std::optional<GhostSettings> read_ghosts(Scene const& scene) {
  Node const table = scene.table("ghosts");
  if (!table) return {};
  GhostSettings settings;
  settings.floor = table.number("floor", dim::plain, settings.floor, 1e-40, 1);
  if (table.has("order")) settings.order = std::uint32_t(table.whole("order", 1, 0, 1e6));
  static constexpr std::array<std::string_view, 2> sums = {"independent", "coherent"};
  settings.sum = table.choice("sum", sums, "independent") == "coherent" ? GhostSum::coherent : GhostSum::independent;
  table.refuse_unknown("'ghosts'");
  return settings;
}

std::vector<CouplingClass> ghosts_beside(World const& world, GhostSettings const& settings) {
  std::vector<CouplingClass> all;
  for (BeamLaunch const& launch : launches(world)) {
    if (launch.through_input_mirror()) continue;
    TreeLimits const limits = settings.limits(launch);
    MainBeam const main(world, launch, limits);
    GhostFamilies families(world, launch, main, ghost_port(world, launch, main), settings.sum);
    if (!families.port()) continue;
    find_ghosts(world, launch, limits, main, [&](Ghost const& g) { families.add(g); });
    for (CouplingClass& c : ghost_classes(families)) all.push_back(std::move(c));
  }
  return all;
}

std::vector<CouplingClass> ghost_classes(GhostFamilies const& families) {
  std::map<std::uint64_t, CouplingClass> classes;  // by route: parts that share a name share a row, powers added
  for (GhostFamily const& f : families.all()) {
    if (!(f.share() > 0)) continue;
    PathRecord record;
    record.coupling = record.weight = f.share();
    record.path_length = f.path_length;
    record.levers = f.levers;
    CouplingClass made = deterministic_class(ClassKind::ghost, f.steps, *families.port(), 1, {record}, statement_of(f));
    auto const [at, added] = classes.emplace(made.hash, made);
    if (added) continue;
    at->second.records.push_back(record);
    at->second.coupling.mean += record.weight;
  }
  std::vector<CouplingClass> all;
  for (auto& [hash, c] : classes) all.push_back(std::move(c));
  return all;
}

GhostStrain project_ghosts(Model const& model, GhostFamilies& families) {
  CouplingTable table;
  table.groups = model.world.groups();
  table.bodies = model.world.body_names();
  table.ports = model.world.ports();
  table.wavelength = model.world.wavelength;
  NoiseSettings settings = model.noise;
  settings.grid = logarithmic_grid(5, 200, 60);
  // The strain is linear in the share: each family once with a share of 1, whatever its fields sum to.
  for (std::size_t i = 0; i < families.all().size(); ++i) {
    PathRecord record;
    record.coupling = record.weight = 1;
    record.levers = families.all()[i].levers;
    CouplingClass one =
        deterministic_class(ClassKind::ghost, families.all()[i].steps, *families.port(), 1, {record}, "");
    one.hash = i;
    table.classes.push_back(std::move(one));
  }
  NoiseBudget const budget = project_noise(table, model.motion, *model.detector, settings);
  GhostStrain square{};
  for (std::size_t i = 0; i < families.all().size(); ++i)
    for (std::size_t k = 0; k < ghost_frequencies.size(); ++k) {
      GhostFamily& f = families.all()[i];
      f.per_root_power[k] = strain_at(budget.routes[i], budget.grid, ghost_frequencies[k]).value;
      square[k] += f.share() * f.per_root_power[k] * f.per_root_power[k];
    }
  GhostStrain all;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = std::sqrt(square[k]);
  return all;
}

}  // namespace straytrace
