// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/halo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "trace/step/connect.hpp"
#include "trace/tally/coupling_table.hpp"
#include "trace/tally/replay.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::trace {
namespace {

constexpr int octants = 8;  // around the axis: the records of one plane, and the samples of the error

// One mirror, and the light that leaves it.
struct LitSide {
  World const& world;
  WorldView view;
  ArmWaves const& waves;
  std::size_t mirror;       // of waves.arm.mirrors
  std::uint32_t footprint;  // of that mirror
  Vec3 travel;              // of the light that leaves it

  LitSide(World const& w, ArmWaves const& a, std::size_t m)
      : world(w), view(w.view()), waves(a), mirror(m), footprint(spot_of(w, a.arm.mirrors[m].surface)) {
    travel = mirror == 0 ? waves.arm.frame.z : -waves.arm.frame.z;
  }
  static std::uint32_t spot_of(World const& world, SurfaceId surface) {
    auto const at = std::ranges::find_if(world.footprints(), [&](Footprint const& f) {
      return f.standing && f.beam == world.wave.beam && f.surface == surface;
    });
    return std::uint32_t(at - world.footprints().begin());
  }
  Footprint const& spot() const { return world.footprints()[footprint]; }
  bool couples() const { return spot().receives && spot().port.valid(); }
  std::size_t rims() const { return waves.arm.rims.size(); }
  // Planes in the order of the light: 0 is this mirror.
  double place(std::size_t step) const {  // m from mirror 1
    std::size_t const plane = mirror == 0 ? step : rims() + 1 - step;
    return plane == 0 ? 0 : plane <= rims() ? waves.arm.cavity.baffles[plane - 1].place : waves.arm.cavity.length;
  }
  PolarIrradiance const& irradiance(std::size_t step) const {
    return waves.irradiance.of(int(mirror == 0 ? step : rims() + 1 - step),
                               mirror == 0 ? Travel::towards_mirror2 : Travel::towards_mirror1);
  }
};

// Surfaces that the light of a plane meets, sought along the axis halfway to the planes on both sides.
class LitColumn {
 public:
  LitColumn(LitSide const& side, std::size_t step) : side_(side) {
    double const here = side.place(step), before = 0.5 * (side.place(step - 1) + here),
                 after = 0.5 * (here + side.place(step + 1));
    start_ = side.waves.arm.frame.origin + before * side.waves.arm.frame.z;
    length_ = std::fabs(after - before);
  }
  // None: the light passes, or the point lies behind a wall.
  std::optional<Vertex> at(double radius, double azimuth) const {
    CavityFrame const& frame = side_.waves.arm.frame;
    Vec3 const out = std::cos(azimuth) * frame.x + std::sin(azimuth) * frame.y;
    if (side_.view.occluded({start_, out, radius}, {})) return {};
    Hit const hit = side_.view.closest({start_ + radius * out, side_.travel, length_}, {});
    if (!hit.surface.valid()) return {};
    return make_vertex(side_.view, hit.surface, start_ + radius * out + hit.distance * side_.travel, side_.travel,
                       hit.piece);
  }

 private:
  LitSide const& side_;
  Vec3 start_;
  double length_;
};

// BSDF back to where the light came from, in the state of polarisation of the mode.
double back_scatter(LitSide const& side, Vertex const& vertex) {
  if (!(vertex.wi.z > 0)) return 0;
  double const bsdf = scatter_eval(side.view.laws, *vertex.optic, vertex.wi, vertex.wi);
  if (!side.world.polarised) return bsdf;
  Polarisation const mode = side.spot().polarisation;
  return bsdf * polarisation_overlap(scattered(mode, side.travel, -side.travel, false, vertex.optic->depolarise), mode,
                                     -side.travel);
}

// Light from the mirror to a surface and back. Its phase sensitivities are those of the way over `vertex`.
PathRecord record_of(LitSide const& side, Vertex const& vertex, double weight) {
  Footprint const& f = side.spot();
  Vec3 const span = vertex.point - f.centre, out = unit(span);
  std::vector<PassedVertex> const way = {{f.surface, f.centre, f.direction(f.centre), out, Event::emit},
                                         {vertex.surface, vertex.point, out, -out, Event::scatter},
                                         {f.surface, f.centre, -out, -f.direction(f.centre), Event::couple}};
  PathRecord record;
  record.weight = record.coupling = weight;
  record.path_length = 2 * length(span);
  record.phase_sensitivities = phase_sensitivities_of(side.world, way, side.footprint, side.footprint);
  return record;
}

void add_weighted(PathRecord& sum, PathRecord const& one) {
  double const before = sum.weight, share = one.weight / (before + one.weight);
  if (before == 0) {
    sum = one;
    return;
  }
  for (PhaseSensitivity const& s : one.phase_sensitivities) {
    auto at = std::ranges::find(sum.phase_sensitivities, s.body, &PhaseSensitivity::body);
    if (at == sum.phase_sensitivities.end()) at = sum.phase_sensitivities.insert(at, {s.body, {}});
  }
  for (PhaseSensitivity& s : sum.phase_sensitivities) {
    auto const at = std::ranges::find(one.phase_sensitivities, s.body, &PhaseSensitivity::body);
    for (int i = 0; i < 6; ++i) {
      double const other = at == one.phase_sensitivities.end() ? 0 : at->d[i];
      s.d[i] += share * (other - s.d[i]);
    }
  }
  sum.path_length += share * (one.path_length - sum.path_length);
  sum.weight = sum.coupling = before + one.weight;
}

struct LitGroup {
  std::vector<PathRecord> records;
  double of_octant[octants] = {};
  double mixed = 0;  // of it, light below the crossover angle on one way and beyond it on the other
  std::size_t planes = 0;

  double total() const {
    double sum = 0;
    for (double t : of_octant) sum += t;
    return sum;
  }
  // Relative standard error of the mean over mirrors, from the spread around the axis.
  double error() const {
    double const mean = total() / octants;
    double squares = 0;
    for (double t : of_octant) squares += (t - mean) * (t - mean);
    return mean > 0 ? std::sqrt(squares * octants / (octants - 1)) / total() : 0;
  }
};
using LitGroups = std::map<std::uint32_t, LitGroup>;

// Mean irradiance by scatter of the mirror beyond the crossover angle (eq. W.17).
double irradiance_beyond(LitSide const& side, double distance, double radius) {
  ArmMirror const& m = side.waves.arm.mirrors[side.mirror];
  double const crossover = side.waves.arm.crossover;
  auto const brdf = [&](double angle) {
    return angle < crossover ? 0 : mirror_brdf(side.world, m, -side.travel, angle);
  };
  return mean_irradiance(brdf, m.spot, m.curvature, distance, radius);
}

// The part of a cell that a surface covers, and a point on it. An edge within the ring is resolved to an eighth of its
// width.
struct LitCell {
  Vertex vertex;
  double share = 1;
};
std::optional<LitCell> lit_cell(LitColumn const& column, PolarIrradiance const& light, int ring, int sector) {
  constexpr int parts = 8;
  double const azimuth = light.azimuth(sector), inner = ring * light.step;
  auto const low = column.at(inner + 0.5 / parts * light.step, azimuth),
             high = column.at(inner + (parts - 0.5) / parts * light.step, azimuth);
  if (low && high && low->surface == high->surface) return LitCell{*low, 1};
  if (!low && !high) return {};
  LitCell cell{low ? *low : *high, 0};
  for (int i = 0; i < parts; ++i) {
    double const radius = inner + (i + 0.5) / parts * light.step;
    auto const at = column.at(radius, azimuth);
    if (at && at->surface == cell.vertex.surface) cell.share += radius / light.radius(ring) / parts;
  }
  return cell;
}

// The light of one plane.
void add_plane(LitSide const& side, std::size_t step, LitGroups& groups) {
  PolarIrradiance const& light = side.irradiance(step);
  double const wavelength = side.world.wavelength, distance = std::fabs(side.place(step) - side.place(0));
  LitColumn const column(side, step);
  std::map<std::uint32_t, std::array<PathRecord, octants>> records;
  for (int ring = 0; ring < light.rings; ++ring) {
    double beyond = -1;  // not known yet
    for (int sector = 0; sector < light.sectors; ++sector) {
      auto const cut = lit_cell(column, light, ring, sector);
      if (!cut) continue;
      Vertex const* const vertex = &cut->vertex;
      double const bsdf = back_scatter(side, *vertex);
      if (!(bsdf > 0)) continue;
      if (beyond < 0) beyond = irradiance_beyond(side, distance, light.radius(ring));
      std::size_t const cell = std::size_t(ring * light.sectors + sector);
      double const scale = wavelength * wavelength * bsdf * cut->share * light.cell_area(ring);  // cos theta is in
      double const mixed = scale * 4 * double(light.mean[cell]) * beyond;
      double const weight = scale * double(light.square[cell]) + mixed;
      if (!(weight > 0)) continue;
      std::uint32_t const id = side.world.surfaces()[vertex->surface.value].group.value;
      int const octant = sector * octants / light.sectors;
      groups[id].of_octant[octant] += weight;
      groups[id].mixed += mixed;
      add_weighted(records[id][std::size_t(octant)], record_of(side, *vertex, weight));
    }
  }
  for (auto& [id, of_octant] : records) {
    ++groups[id].planes;
    for (PathRecord& record : of_octant)
      if (record.weight > 0) groups[id].records.push_back(std::move(record));
  }
}

std::string statement(LitSide const& side, LitGroup const& group) {
  return fmt::format(
      "light of the cavity within {:.4g} urad of the specular direction of its mirrors (docs/theory/wave.md, eq. "
      "W.19), scattered back by surfaces at {} planes, of it {:.2g} with light beyond that angle on one of the two "
      "ways; one draw of the mirrors, {:.2g} % from their mean by the spread around the axis",
      1e6 * side.waves.arm.crossover, group.planes, group.mixed / group.total(), 100 * group.error());
}

}  // namespace

HaloClasses halo_classes(World const& world, ArmWaves const& waves) {
  HaloClasses result;
  for (std::size_t mirror : {std::size_t{0}, std::size_t{1}}) {
    LitSide const side(world, waves, mirror);
    if (!side.couples()) continue;
    LitGroups groups;
    for (std::size_t step = 1; step <= side.rims(); ++step) add_plane(side, step, groups);
    GroupId const own = world.surfaces()[side.spot().surface.value].group;
    for (auto& [id, group] : groups) {
      std::string const text = statement(side, group);
      std::vector<PathStep> steps{{own, Event::emit}, {{id}, Event::scatter}, {own, Event::couple}};
      result.classes.push_back(
          deterministic_class(ClassKind::halo, std::move(steps), side.spot().port, 1, std::move(group.records), text));
    }
  }
  return result;
}

}  // namespace straytrace::trace
