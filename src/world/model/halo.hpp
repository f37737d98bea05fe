// SPDX-License-Identifier: BSD-3-Clause
// Light of a cavity below the crossover angle on the surfaces between its mirrors, as a source of paths and a receiver
// of them (docs/theory/wave.md, "Elsewhere"). trace/deterministic/halo_source.hpp makes the
// tables.
#pragma once

#include <cmath>
#include <vector>

#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "base/memory/storage.hpp"

namespace straytrace::world {

// The part of a cell of the polar grid in the plane of a baffle that one surface fills. The irradiance is even over it.
struct HaloCell {
  SurfaceId surface;
  std::uint32_t section = 0;
  std::uint32_t place = 0;     // ring * sectors + sector
  float inner = 0, outer = 0;  // radii, m
  float irradiance = 0;        // across the beam, over the power of the mode, 1/m^2
  double cumulative = 0;       // power of the cells of this mirror up to and including it, over that of all
};

// What light of one mirror meets at one baffle: along the axis, from halfway to the baffle before to halfway to the
// next.
struct HaloSection {
  double from = 0, to = 0;  // m along z of the frame
  double step = 0;          // width of a ring, m
  std::uint32_t sectors = 0;
  std::uint32_t first = 0, count = 0;  // its cells, ascending by place
};

// The light that leaves one mirror.
struct HaloSource {
  std::uint32_t footprint = 0;         // of the mode on it
  Vec3 travel;                         // of the light, along the axis
  double power = 0;                    // on all its cells, over that of the mode
  double emitted_before = 0;           // of the sources before it that emit
  bool forward = true;                 // along +z of the frame
  std::uint32_t first = 0, count = 0;  // its sections, ascending by `from`
  std::uint32_t first_cell = 0, cells = 0;
};

// A point that the light of a mirror meets.
struct HaloPoint {
  Ray line;  // along the axis, from the start of the section
  std::uint32_t cell = 0;
};

struct Halo {
  View<HaloSource const> sources;
  View<HaloSection const> sections;
  View<HaloCell const> cells;
  Pose frame;          // z from mirror 1 to mirror 2, from the centre of mirror 1
  double emitted = 0;  // power of all sources that emit, over that of the mode
  double share = 0;    // of the histories that start here
  double level = 0;    // mean of power x adjoint where they start; 0: not known

  STRAY_HD bool on() const { return sources.size > 0; }
  // A point of the light of a source, drawn by power.
  STRAY_HD HaloPoint draw(HaloSource const& source, double choice, double u, double v) const {
    std::uint32_t const drawn = first_where(source.first_cell, source.first_cell + source.cells - 1,
                                            [&](std::uint32_t i) { return !(cells[i].cumulative < choice); });
    HaloCell const& cell = cells[drawn];
    std::uint32_t const sectors = sections[cell.section].sectors;
    double const inner = double(cell.inner) * double(cell.inner), outer = double(cell.outer) * double(cell.outer);
    SinCos const turn = sincos_turn((cell.place % sectors + v) / sectors);
    double const radius = std::sqrt(inner + u * (outer - inner));
    return {line_at(source, sections[cell.section], radius * turn.cos, radius * turn.sin), drawn};
  }
  STRAY_HD Ray line_at(HaloSource const& source, HaloSection const& section, double x, double y) const {
    Ray line{frame.point({x, y, source.forward ? section.from : section.to}), source.travel};
    line.t_max = section.to - section.from;
    return line;
  }
  static constexpr std::uint32_t none = 0xffffffffu;
  // The cell of a source that holds a point of a surface, given in the frame.
  STRAY_HD std::uint32_t cell_at(HaloSource const& source, SurfaceId surface, Vec3 local) const {
    if (source.count == 0) return none;
    std::uint32_t const next = first_where(source.first + 1, source.first + source.count,
                                           [&](std::uint32_t i) { return !(sections[i].from <= local.z); });
    HaloSection const& section = sections[next - 1];
    if (!(section.from <= local.z && local.z < section.to)) return none;
    double const radius = std::sqrt(local.x * local.x + local.y * local.y), turn = turn_of(local.x, local.y);
    auto const ring = static_cast<std::uint32_t>(radius / section.step);
    auto sector = static_cast<std::uint32_t>(turn * section.sectors);
    if (sector >= section.sectors) sector = section.sectors - 1;
    std::uint32_t const place = ring * section.sectors + sector, end = section.first + section.count;
    std::uint32_t at = first_where(section.first, end, [&](std::uint32_t i) { return !(cells[i].place < place); });
    for (; at < end && cells[at].place == place; ++at)
      if (cells[at].surface == surface && double(cells[at].inner) <= radius && radius < double(cells[at].outer))
        return at;
    return none;
  }
};

// Owner of the arrays of a Halo.
struct HaloTables {
  std::vector<HaloSource> sources;
  std::vector<HaloSection> sections;
  std::vector<HaloCell> cells;
  Pose frame;
  double emitted = 0, share = 0, level = 0;
  Halo view() const {
    return {{sources.data(), sources.size()},
            {sections.data(), sections.size()},
            {cells.data(), cells.size()},
            frame,
            emitted,
            share,
            level};
  }
};

}  // namespace straytrace::world
