// SPDX-License-Identifier: BSD-3-Clause
// Importance tables that steer the walk: patches made of strips of surfaces, the adjoint of each side of a patch, and
// the important patches from there (docs/theory/sampling.md). Every table gives an unbiased result; good
// ones lower the variance. trace/importance/importance.hpp makes them.
#pragma once

#include <cmath>
#include <vector>

#include "base/math/functions.hpp"
#include "base/memory/ids.hpp"

namespace straytrace::world {

struct Strip {
  SurfaceId surface;
  double u_low = 0, u_high = 1;  // first sample coordinate (geometry/strips.hpp)
  double area = 0;               // m^2
  std::uint32_t patch = 0;
};

// Strips that share a row of the tables: one, or several neighbours in scenes with many surfaces. Points are sampled
// uniformly over its area.
struct Patch {
  double area = 0;                     // m^2
  std::uint32_t first = 0, count = 0;  // its members
};
struct Member {
  std::uint32_t strip = 0;
  double before = 0;  // m^2, area of the members before it
};

// One side of a patch. `adjoint`: mean future score of one unit of power that arrives there, each receiver in units of
// its own total.
struct PatchSide {
  double adjoint = 0;
  double alpha = 1;                    // share of directions sampled from the BSDF; 1: no targets
  std::uint32_t first = 0, count = 0;  // its targets
};

struct Target {
  std::uint32_t patch = 0;
  double share = 0;       // probability, if a target is sampled
  double cumulative = 0;  // of the shares up to and including this one
};

struct Steering {
  View<Strip const> strips;
  View<Patch const> patches;
  View<Member const> members;
  View<PatchSide const> sides;                 // two per patch: front, back
  View<std::uint32_t const> first_of_surface;  // strips of surface i: [first_of_surface[i], first_of_surface[i + 1])
  View<Target const> targets;
  View<float const> connections;  // per side and mode; empty: all are made
  std::uint32_t modes = 0;
  double level = 0;  // mean of power x adjoint at first vertices; 0: no weight window

  STRAY_HD bool on() const { return strips.size > 0; }
  // The strip of a surface that has no other; 0xffffffff: it has several.
  STRAY_HD std::uint32_t only_strip(SurfaceId surface) const {
    std::uint32_t const first = first_of_surface[surface.value];
    return first_of_surface[surface.value + 1] - first == 1 ? first : 0xffffffffu;
  }
  // Strip of a surface at the first sample coordinate u.
  STRAY_HD std::uint32_t strip_at(SurfaceId surface, double u) const {
    std::uint32_t const next = first_where(first_of_surface[surface.value] + 1, first_of_surface[surface.value + 1],
                                           [&](std::uint32_t i) { return !(strips[i].u_low <= u); });
    return next - 1;
  }
  // Maps u in (0, 1) uniformly to a point of the patch: its strip and first sample coordinate there.
  struct Place {
    std::uint32_t strip = 0;
    double u = 0;
  };
  STRAY_HD Place place(std::uint32_t patch, double u) const {
    Patch const& p = patches[patch];
    double const x = u * p.area;
    std::uint32_t const after =
        first_where(p.first + 1, p.first + p.count, [&](std::uint32_t i) { return !(members[i].before <= x); });
    Member const& m = members[after - 1];
    Strip const& s = strips[m.strip];
    double const within = p.count == 1 ? u : std::fmin((x - m.before) / s.area, 1);
    return {m.strip, s.u_low + within * (s.u_high - s.u_low)};
  }
  // Density per area on the patch with which the targets of `side` are sampled, 1/m^2.
  STRAY_HD double density(PatchSide const& side, std::uint32_t patch) const {
    std::uint32_t const end = side.first + side.count;  // targets are sorted by patch
    std::uint32_t const at = first_where(side.first, end, [&](std::uint32_t i) { return !(targets[i].patch < patch); });
    return at < end && targets[at].patch == patch ? targets[at].share / patches[patch].area : 0;
  }
  // Probability with which a vertex on `side` is connected to a mode.
  STRAY_HD double connection(std::uint32_t side, std::uint32_t mode) const {
    return connections.size == 0 ? 1 : double(connections[std::size_t(side) * modes + mode]);
  }
  // The target whose interval of cumulative shares holds x in (0, 1).
  STRAY_HD std::uint32_t draw(PatchSide const& side, double x) const {
    return first_where(side.first, side.first + side.count - 1,
                       [&](std::uint32_t i) { return !(targets[i].cumulative < x); });
  }
};

// Owner of the arrays of a Steering.
struct SteeringTables {
  std::vector<Strip> strips;
  std::vector<Patch> patches;
  std::vector<Member> members;
  std::vector<PatchSide> sides;
  std::vector<std::uint32_t> first_of_surface;
  std::vector<Target> targets;
  std::vector<float> connections;
  std::uint32_t modes = 0;
  double level = 0;
  Steering view() const {
    return {{strips.data(), strips.size()},
            {patches.data(), patches.size()},
            {members.data(), members.size()},
            {sides.data(), sides.size()},
            {first_of_surface.data(), first_of_surface.size()},
            {targets.data(), targets.size()},
            {connections.data(), connections.size()},
            modes,
            level};
  }
};

}  // namespace straytrace::world
