// SPDX-License-Identifier: BSD-3-Clause
#include "trace/edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trace/beside.hpp"

namespace straytrace {
namespace {

using Complex = std::complex<double>;
using Sum = EdgeSettings::Sum;

// Where the static field of a rim vanishes its motion does not, and levers over that field would be infinite: the
// field is then taken as what the gradient makes of a displacement of this size, m.
constexpr double placed_within = 10e-6;

// Power of the path: that of its field.
double power_of(EdgeWave const& wave) {
  double power = std::norm(wave.amplitude);
  for (EdgeWave::Gradient const& g : wave.gradient) {
    double slope = 0;
    for (int i = 0; i < 3; ++i) slope += std::norm(g.d[i]);
    power = std::fmax(power, slope * placed_within * placed_within);
  }
  return power;
}

// A small displacement x changes the field to (1 + i J x + A x) times itself: J from 8.13, A from 8.12. In the mean
// over the static phase both quadratures make noise like a phase does, so the path is two records of half its power,
// with levers sqrt(2) J and sqrt(2) A.
void add_records(std::vector<PathRecord>& records, EdgeWave const& wave, double weight) {
  double const size = std::abs(wave.amplitude), root = std::sqrt(power_of(wave));
  Complex const turn = size > 0 ? std::conj(wave.amplitude) / size : Complex{1};
  for (bool const phase : {true, false}) {
    PathRecord record;
    record.weight = record.coupling = 0.5 * weight;
    record.path_length = wave.path_length;
    for (EdgeWave::Gradient const& g : wave.gradient) {
      Lever lever{g.body, {}};
      for (int i = 0; i < 6; ++i) {
        Complex const relative = turn * g.d[i] / root;
        lever.d[i] = std::sqrt(2.0) * (phase ? relative.imag() : relative.real());
      }
      record.levers.push_back(lever);
    }
    std::sort(record.levers.begin(), record.levers.end(), [](auto& a, auto& b) { return a.body < b.body; });
    if (record.weight > 0) records.push_back(std::move(record));
  }
}

EdgeWave sum_of(std::vector<EdgeWave> const& waves) {
  EdgeWave sum;
  double weights = 0;
  for (EdgeWave const& wave : waves) {
    sum.amplitude += wave.amplitude;
    weights += std::norm(wave.amplitude);
    sum.path_length += std::norm(wave.amplitude) * wave.path_length;
    for (EdgeWave::Gradient const& g : wave.gradient) {
      auto at = std::find_if(sum.gradient.begin(), sum.gradient.end(), [&](auto& s) { return s.body == g.body; });
      if (at == sum.gradient.end()) at = sum.gradient.insert(at, {g.body, {}});
      for (int i = 0; i < 6; ++i) at->d[i] += g.d[i];
    }
  }
  sum.path_length = weights > 0 ? sum.path_length / weights : waves.front().path_length;
  return sum;
}

// The rims of one group between two mirrors.
struct Group {
  std::vector<EdgeWave> waves;
  double powers = 0, sizes = 0, teeth = 0;  // sums over the rims: of powers, of fields, of what random teeth add
  double patches = 0;                       // mean by power
  EdgeWave together;                        // fields added

  void finish() {
    for (EdgeWave const& wave : waves) {
      powers += power_of(wave);
      sizes += std::sqrt(power_of(wave));
      patches += power_of(wave) * wave.patches;
      for (PathRecord const& r : wave.teeth) teeth += r.weight;
    }
    if (powers > 0) patches /= powers;
    if (!waves.empty()) together = sum_of(waves);
  }
  // In phase: (sum |a|)^2, and no phases of the rims make more noise, for |sum a J x|^2 <= sum |a| sum |a| |J x|^2.
  std::vector<PathRecord> records(Sum sum) const {
    std::vector<PathRecord> all;
    if (sum == Sum::geometric) add_records(all, together, power_of(together));
    for (EdgeWave const& wave : waves) {
      double const power = power_of(wave);
      if (sum != Sum::geometric) add_records(all, wave, sum == Sum::in_phase ? std::sqrt(power) * sizes : power);
      all.insert(all.end(), wave.teeth.begin(), wave.teeth.end());
    }
    return all;
  }
  std::string statement(Sum sum) const {
    constexpr char const* words[] = {"powers added, as millimetres of tolerance shuffle their phases",
                                     "fields added with the phases of the drawn geometry",
                                     "fields added in phase, the worst case"};
    std::string text = fmt::format(
        "upper bound: light scattered towards a rim taken as one smooth spherical wave (docs/theory/diffraction.md, "
        "eq. 8.11); speckle, "
        "about {} around a rim, lowers the coupling by up to that factor",
        std::fmax(patches, 1) < 1.5 ? "1 patch" : fmt::format("{:.0f} patches", patches));
    if (waves.size() > 1)
      text += fmt::format("; {} rims, {}: coupling {:.3g} by powers, {:.3g} by the drawn phases, {:.3g} in phase",
                          waves.size(), words[int(sum)], powers + teeth, std::norm(together.amplitude) + teeth,
                          sizes * sizes + teeth);
    if (teeth > 0) text += fmt::format("; {:.3g} of it from random teeth one by one", teeth);
    return text + "; first order in the motion";
  }
};

CouplingClass class_of(World const& world, std::uint32_t source, std::uint32_t goal, Group const& group, GroupId id) {
  Footprint const &a = world.footprints()[source], &b = world.footprints()[goal];
  auto const group_of = [&](Footprint const& f) { return world.surfaces()[f.surface.value].group; };
  bool const both = a.receives && a.port.valid() && b.emits && world.reverse_routes;
  return deterministic_class(ClassKind::edge,
                             {{group_of(a), Event::emit}, {id, Event::diffract}, {group_of(b), Event::couple}}, b.port,
                             both ? 2 : 1, group.records(world.edges.sum), group.statement(world.edges.sum));
}

std::vector<InnerRim> rims_of(World const& world, GroupId group) {
  std::vector<InnerRim> rims;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (world.surfaces()[id].group == group)
      if (auto const rim = rim_of(world, {id})) rims.push_back(*rim);
  return rims;
}

void add_direction(World const& world, std::uint32_t source, std::uint32_t goal, EdgeClasses& result) {
  for (std::string const& name : world.edges.groups) {
    auto const at = std::find(world.groups().begin(), world.groups().end(), name);
    GroupId const id{std::uint32_t(at - world.groups().begin())};
    Group group;
    double seen = 0;
    for (InnerRim const& rim : rims_of(world, id)) {
      EdgeWave wave = edge_wave(world, source, goal, rim);
      seen = std::fmax(seen, wave.seen);
      if (wave.smooth > 0) group.waves.push_back(std::move(wave));
    }
    group.finish();
    if (!group.waves.empty())
      result.classes.push_back(class_of(world, source, goal, group, id));
    else if (source < goal)
      result.warnings.push_back(fmt::format(
          "edges: {} '{}'",
          seen > 0 ? "the mirrors scatter no light towards the rims of" : "no mirror pair sees a rim of", name));
  }
}

}  // namespace

EdgeClasses edge_classes(World const& world) {
  EdgeClasses result;
  if (world.edges.groups.empty()) return result;
  auto const& spots = world.footprints();
  for (std::uint32_t a = 0; a < spots.size(); ++a)
    for (std::uint32_t b = 0; b < spots.size(); ++b) {
      bool const cavity = a != b && spots[a].beam == spots[b].beam && spots[a].standing && spots[b].standing;
      if (cavity && spots[a].emits && spots[b].receives && spots[b].port.valid()) add_direction(world, a, b, result);
    }
  return result;
}

}  // namespace straytrace
