// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/path_laws.hpp"

#include <algorithm>
#include <cmath>

#include "optics/coating/specular.hpp"
#include "optics/scatter/mixture.hpp"
#include "world/model/vertex.hpp"

namespace straytrace::trace {
namespace {

// What the surface makes of the light at a vertex: BSDF, reflectance or transmittance; 1 where nothing acts.
double law_at(WorldView const& world, PassedVertex const& passed) {
  if (!passed.surface.valid() || passed.event == Event::receive || passed.event == Event::start) return 1;
  Vertex const v = make_vertex(world, passed.surface, passed.point, passed.in);
  if (letter(passed.event) == 'S')
    return scatter_eval(world.laws, *v.optic, v.wi, v.frame.to_local(passed.out), passed.n_in, passed.n_out);
  double const scattered = scatter_albedo(world.laws, *v.optic, v.wi.z);
  SpecularShares const s =
      specular_shares(world.interfaces, *v.optic, v.wi.z, passed.n_in, passed.n_out, v.front, scattered);
  return passed.event == Event::reflect ? s.reflect : passed.event == Event::transmit ? s.transmit : 1;
}

}  // namespace

PathLaws::PathLaws(SteeredWorld const& world, CouplingTable const& table) : world_(world) {
  Replay replay(world, table.seed);
  for (CouplingClass const& c : table.classes) {
    std::vector<Path>& rows = paths_.emplace_back();
    for (PathRecord const& r : c.records) {
      if (c.deterministic()) break;
      auto path = replay(r.history, r.event, r.connection);
      rows.push_back(path ? Path{std::move(path->vertices), path->source, path->goal} : Path{});
    }
  }
}

double PathLaws::log_factor(WorldView const& before, WorldView const& after, Path const& path) const {
  double sum = 0;
  for (PassedVertex const& vertex : path.vertices) {
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

PathFactors PathLaws::factors(World const& other) const {
  WorldView const before = world_.view(), after = other.view();
  PathFactors all;
  for (auto const& paths : paths_) {
    auto& of_class = all.emplace_back();
    for (Path const& path : paths)
      of_class.push_back(path.vertices.empty() ? not_a_number : log_factor(before, after, path));
  }
  return all;
}

std::vector<double> PathLaws::largest_ratios(World const& other) const {
  World const& world = world_;
  WorldView const before = world.view(), after = other.view();
  std::vector<double> largest(world.materials.size());
  auto const look = [&](PassedVertex const& passed) {
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

}  // namespace straytrace::trace
