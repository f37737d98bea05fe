// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/threads.hpp"
#include "trace/camera.hpp"

namespace straytrace {
namespace {

constexpr std::uint32_t finer = 2;  // rays per pixel along each side
constexpr Rgb background{0.97, 0.97, 0.97};

Rgb mix(Rgb a, Rgb b, double share) {
  return {a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b)};
}

// What is kept of a ray until all its neighbours are known.
struct Dot {
  Rgb colour;
  Vec3 point, normal;
  double distance = infinity;
  std::uint32_t surface = WorldView::none, group = WorldView::none;
  std::uint64_t glass = 0;  // name of the panes before it
  Vec3 pane;                // normal of the first one
};

Dot dot_of(WorldView const& world, Sight const& s, Vec3 dir, Paint const& paint) {
  Dot d;
  d.colour = background;
  if (s.solid.surface.valid()) {
    double const facing = std::fabs(dot(dir, s.solid.normal));
    d.colour = mix({}, paint(s.solid), 0.35 + 0.65 * facing);
    d.point = s.solid.point;
    d.normal = s.solid.normal;
    d.distance = s.solid.distance;
    d.surface = s.solid.surface.value;
    d.group = world.surfaces[d.surface].group.value;
  }
  for (int i = s.panes; i-- > 0;) {
    double const grazing = 1 - std::fabs(dot(dir, s.glass[i].normal));
    d.colour = mix(d.colour, paint(s.glass[i]), 0.13 + 0.6 * grazing * grazing * grazing);
    d.glass = d.glass * 1000003 + s.glass[i].surface.value + 1;
    d.pane = s.glass[i].normal;
  }
  return d;
}

// Share of ink between two neighbours: outlines of groups, creases, one part of a surface before another.
double edge(Dot const& a, Dot const& b) {
  if (a.group != b.group) return 0.75;
  double ink = 0;
  if (a.surface != WorldView::none) {
    double const step = std::fabs(dot(b.point - a.point, a.normal));
    bool const crease = dot(a.normal, b.normal) < 0.8;
    bool const apart = step > 0.03 * std::min(a.distance, b.distance);
    if (crease || apart) ink = 0.5;
  }
  if (a.glass != b.glass || (a.glass != 0 && dot(a.pane, b.pane) < 0.8)) ink = std::max(ink, 0.4);
  return ink;
}

std::uint8_t byte(double x) { return std::uint8_t(std::lround(255 * std::clamp(x, 0.0, 1.0))); }

}  // namespace

std::vector<std::uint8_t> shaded(WorldView const& world, Camera const& camera, LookSettings const& settings,
                                 Paint const& paint, std::vector<bool>& visible) {
  std::size_t const wide = std::size_t{camera.columns} * finer;
  std::uint32_t const high = camera.rows * finer;
  std::vector<Dot> dots(wide * high);
  std::vector<std::atomic<bool>> seen(world.surfaces.size);
  in_parallel(high, settings.threads, [&](std::size_t row) {
    for (std::size_t column = 0; column < wide; ++column) {
      Ray const ray = camera.ray((double(column) + 0.5) / finer, (double(row) + 0.5) / finer);
      Sight const s = sight(world, ray, camera.from, settings);
      if (s.solid.surface.valid()) seen[s.solid.surface.value] = true;
      for (int i = 0; i < s.panes; ++i) seen[s.glass[i].surface.value] = true;
      dots[row * wide + column] = dot_of(world, s, ray.dir, paint);
    }
  });
  visible.assign(seen.begin(), seen.end());
  std::vector<std::uint8_t> rgb(std::size_t{3} * camera.columns * camera.rows);
  in_parallel(camera.rows, settings.threads, [&](std::size_t row) {
    for (std::size_t column = 0; column < camera.columns; ++column) {
      Rgb sum;
      for (std::uint32_t k = 0; k < finer * finer; ++k) {
        std::size_t const x = column * finer + k % finer, y = row * finer + k / finer;
        Dot const& d = dots[y * wide + x];
        double ink = 0;
        if (x + 1 < wide) ink = edge(d, dots[y * wide + x + 1]);
        if (y + 1 < high) ink = std::max(ink, edge(d, dots[(y + 1) * wide + x]));
        Rgb const c = mix(d.colour, {0.1, 0.1, 0.12}, ink);
        sum = {sum.r + c.r, sum.g + c.g, sum.b + c.b};
      }
      std::uint8_t* const out = &rgb[3 * (row * camera.columns + column)];
      double const scale = 1.0 / (finer * finer);
      out[0] = byte(scale * sum.r);
      out[1] = byte(scale * sum.g);
      out[2] = byte(scale * sum.b);
    }
  });
  return rgb;
}

}  // namespace straytrace
