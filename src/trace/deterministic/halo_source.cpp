// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/halo_source.hpp"

#include <algorithm>
#include <array>

namespace straytrace::trace {
namespace {

// Least share of the histories, and the largest where receivers count all light alike. Without receivers the noise of
// this light is that of its second scatter, far below that of the first beyond the crossover angle.
constexpr double least_share = 1. / 16, largest_share = 1. / 4;

class HaloBuilder {
 public:
  HaloBuilder(World const& world, ArmCavity const& arm, PlaneIrradiance const& irradiance)
      : world_(world), arm_(arm), irradiance_(irradiance) {}

  HaloTables build() {
    tables_.frame = {arm_.frame.origin, arm_.frame.x, arm_.frame.y, arm_.frame.z};
    for (std::size_t const mirror : {std::size_t{0}, std::size_t{1}}) add_mirror(mirror);
    for (HaloSource& source : tables_.sources) {
      source.emitted_before = tables_.emitted;
      if (world_.footprints()[source.footprint].emits) tables_.emitted += source.power;
    }
    if (tables_.emitted > 0) tables_.share = share();
    return std::move(tables_);
  }

 private:
  // In proportion to power, within limits.
  double share() const {
    if (world_.receivers().empty()) return least_share;
    WorldView const view = world_.view();
    double beyond = 0;
    for (std::size_t i = 0; i < view.emitters.size; ++i) {
      Footprint const& lit = view.lit[view.emitters[i]];
      double const albedo =
          lit.free ? 1 : scatter_albedo(view.laws, *make_vertex(view, lit.surface, lit.centre, lit.travel).optic, 1.0);
      beyond += lit.share * albedo;
    }
    return std::clamp(tables_.emitted / (tables_.emitted + beyond), least_share, largest_share);
  }

  void add_mirror(std::size_t mirror) {
    HaloSource source;
    source.footprint = arm_.mirrors[mirror].footprint;
    source.forward = mirror == 0;
    source.travel = source.forward ? arm_.frame.z : -arm_.frame.z;
    source.first = std::uint32_t(tables_.sections.size());
    source.first_cell = std::uint32_t(tables_.cells.size());
    for (std::size_t rim = 0; rim < arm_.rims.size(); ++rim)
      add_section(
          HaloPlane(world_, arm_, irradiance_, rim, source.forward ? Travel::towards_mirror2 : Travel::towards_mirror1),
          source);
    source.count = std::uint32_t(tables_.sections.size()) - source.first;
    source.cells = std::uint32_t(tables_.cells.size()) - source.first_cell;
    if (!(source.power > 0)) return;
    for (std::uint32_t i = 0; i < source.cells; ++i) tables_.cells[source.first_cell + i].cumulative /= source.power;
    tables_.sources.push_back(source);
  }

  void add_section(HaloPlane const& plane, HaloSource& source) {
    PolarIrradiance const& light = plane.light();
    HaloSection section;
    section.from = plane.from();
    section.to = plane.to();
    section.step = light.step;
    section.sectors = std::uint32_t(light.sectors);
    section.first = std::uint32_t(tables_.cells.size());
    for (int ring = 0; ring < light.rings; ++ring)
      for (int sector = 0; sector < light.sectors; ++sector) add_cells(plane, ring, sector, source);
    section.count = std::uint32_t(tables_.cells.size()) - section.first;
    tables_.sections.push_back(section);
  }

  // The ends of a part are known to an eighth of the ring. The cell reaches one eighth further, within the ring: points
  // drawn beyond the surface miss it.
  void add_cells(HaloPlane const& plane, int ring, int sector, HaloSource& source) {
    PolarIrradiance const& light = plane.light();
    float const irradiance = light.mean[std::size_t(ring * light.sectors + sector)];
    if (!(irradiance > 0)) return;
    double const eighth = light.step / 8, low = ring * light.step, high = low + light.step;
    for (LitPart const& part : plane.parts(ring, sector)) {
      if (!(part.vertex.wi.z > 0)) continue;
      HaloCell cell;
      cell.surface = part.vertex.surface;
      cell.section = std::uint32_t(tables_.sections.size());
      cell.place = std::uint32_t(ring * light.sectors + sector);
      cell.inner = float(std::max(part.inner - eighth, low));
      cell.outer = float(std::min(part.outer + eighth, high));
      cell.irradiance = irradiance;
      double const inner = double(cell.inner), outer = double(cell.outer);
      source.power += pi * (outer * outer - inner * inner) / light.sectors * double(irradiance);
      cell.cumulative = source.power;
      tables_.cells.push_back(cell);
    }
  }

  World const& world_;
  ArmCavity const& arm_;
  PlaneIrradiance const& irradiance_;
  HaloTables tables_;
};

}  // namespace

HaloTables halo_source(World const& world, ArmCavity const& arm, PlaneIrradiance const& irradiance) {
  return HaloBuilder(world, arm, irradiance).build();
}

}  // namespace straytrace::trace
