// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "scenes.hpp"

namespace straytrace::bench {
namespace {

struct Rim {
  double radius, height;  // m, about the axis of the shape
};

std::vector<Rim> profile(Disk const& s, double) { return {{s.inner_radius, 0}, {s.outer_radius, 0}}; }
std::vector<Rim> profile(Cylinder const& s, double section) {
  int const n = std::max(1, int(std::lround((s.to - s.from) / section)));
  std::vector<Rim> rims;
  for (int i = 0; i <= n; ++i) rims.push_back({s.radius, s.from + (s.to - s.from) * i / n});
  return rims;
}
std::vector<Rim> profile(Cap const& s, double) {
  std::vector<Rim> rims;
  for (int i = 0; i <= 8; ++i) {
    double const r = s.inner_radius + (s.outer_radius - s.inner_radius) * i / 8;
    rims.push_back({r, s.curvature * s.depth(r)});
  }
  return rims;
}
std::vector<Rim> profile(Cone const& s, double) { return {{s.inner_radius, 0}, {s.outer_radius, s.height()}}; }
std::vector<Rim> profile(Sphere const& s, double) {
  std::vector<Rim> rims;
  for (int i = 0; i <= 16; ++i) rims.push_back({s.radius * std::sin(pi * i / 16), -s.radius * std::cos(pi * i / 16)});
  return rims;
}

Triangle triangle(Vec3 a, Vec3 b, Vec3 c) {
  auto const f = [](double x) { return float(x); };
  return {{{f(a.x), f(a.y), f(a.z)}, {f(b.x), f(b.y), f(b.z)}, {f(c.x), f(c.y), f(c.z)}}};
}

void revolve(std::vector<Rim> const& rims, Pose const& pose, int segments, std::vector<Triangle>& out) {
  double const outside = 1 / std::cos(pi / segments);
  auto const at = [&](Rim const& rim, int k) {
    double const angle = 2 * pi * k / segments, r = rim.radius * outside;
    return pose.point({r * std::cos(angle), r * std::sin(angle), rim.height});
  };
  for (std::size_t i = 0; i + 1 < rims.size(); ++i)
    for (int k = 0; k < segments; ++k) {
      Vec3 const a = at(rims[i], k), b = at(rims[i], k + 1), c = at(rims[i + 1], k + 1), d = at(rims[i + 1], k);
      if (rims[i].radius > 0) out.push_back(triangle(a, b, c));
      if (rims[i + 1].radius > 0) out.push_back(triangle(a, c, d));
    }
}

}  // namespace

std::vector<Triangle> tessellate(World const& world, int segments, double section) {
  std::vector<Triangle> out;
  WorldView const view = world.view();
  for (Surface const& surface : world.surfaces())
    view.shapes.visit(surface.shape, [&](auto const& s) {
      if constexpr (requires { profile(s, section); })
        revolve(profile(s, section), facing_along(s.reference(), s.axis), segments, out);
    });
  return out;
}

}  // namespace straytrace::bench
