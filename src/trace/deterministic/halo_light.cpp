// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/halo_light.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/math/constants.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {

HaloPlane::HaloPlane(World const& world, ArmCavity const& arm, PlaneIrradiance const& irradiance, std::size_t rim,
                     Travel travel)
    : view_(world.view()), frame_(&arm.frame), light_(&irradiance.of(int(rim) + 1, travel)), travel_(travel) {
  auto const& baffles = arm.cavity.baffles;
  double const before = rim == 0 ? 0 : baffles[rim - 1].place,
               after = rim + 1 == baffles.size() ? arm.cavity.length : baffles[rim + 1].place;
  bool const forward = travel == Travel::towards_mirror2;
  place_ = baffles[rim].place;
  distance_ = forward ? place_ : arm.cavity.length - place_;
  from_ = 0.5 * (before + place_);
  to_ = 0.5 * (place_ + after);
  direction_ = forward ? arm.frame.z : -arm.frame.z;
  start_ = arm.frame.origin + (forward ? from_ : to_) * arm.frame.z;
}

std::optional<Vertex> HaloPlane::at(double radius, double azimuth) const {
  Vec3 const out = std::cos(azimuth) * frame_->x + std::sin(azimuth) * frame_->y;
  if (view_.occluded({start_, out, radius}, {})) return {};
  Hit const hit = view_.closest({start_ + radius * out, direction_, to_ - from_}, {});
  if (!hit.surface.valid()) return {};
  return make_vertex(view_, hit.surface, start_ + radius * out + hit.distance * direction_, direction_, hit.piece);
}

std::vector<LitPart> HaloPlane::parts(int ring, int sector) const {
  constexpr int eighths = 8;
  double const azimuth = light_->azimuth(sector), step = light_->step / eighths, inner = ring * light_->step;
  auto const radius = [&](int i) { return inner + (i + 0.5) * step; };
  auto const first = at(radius(0), azimuth), last = at(radius(eighths - 1), azimuth);
  if (!first && !last) return {};
  if (first && last && first->surface == last->surface) return {{*first, 1, inner, inner + light_->step}};
  std::vector<LitPart> found;
  for (int i = 0; i < eighths; ++i) {
    auto const vertex = at(radius(i), azimuth);
    if (!vertex) continue;
    double const share = radius(i) / light_->radius(ring) / eighths;
    auto const known = std::ranges::find(found, vertex->surface, [](LitPart const& p) { return p.vertex.surface; });
    if (known == found.end()) {
      found.push_back({*vertex, share, inner + i * step, inner + (i + 1) * step});
    } else {
      known->share += share;
      known->outer = inner + (i + 1) * step;
    }
  }
  return found;
}

HaloLight::HaloLight(World const& world, ArmCavity const& arm, PlaneIrradiance const& irradiance) : frame_(&arm.frame) {
  for (Travel const travel : {Travel::towards_mirror2, Travel::towards_mirror1})
    for (std::size_t rim = 0; rim < arm.rims.size(); ++rim) planes_.emplace_back(world, arm, irradiance, rim, travel);
}

double HaloLight::on(SurfaceId surface, Vec3 point, bool front) const {
  constexpr double same_point = 1e-3;  // m: a camera finds points at 10 km to some micrometres
  Vec3 const local = frame_->to_local(point);
  double const radius = std::hypot(local.x, local.y), azimuth = std::atan2(local.y, local.x);
  double sum = 0;
  for (HaloPlane const& plane : planes_) {
    PolarIrradiance const& light = plane.light();
    int const ring = int(radius / light.step);
    if (!plane.holds(local.z) || ring >= light.rings) continue;
    auto const lit = plane.at(radius, azimuth);
    if (!lit || lit->surface != surface || lit->front != front || length(lit->point - point) > same_point) continue;
    double const turn = azimuth / (2 * pi);
    int const sector = std::min(light.sectors - 1, int((turn < 0 ? turn + 1 : turn) * light.sectors));
    sum += lit->wi.z * double(light.mean[std::size_t(ring * light.sectors + sector)]);
  }
  return sum;
}

namespace {

// Part of a ring, with what it takes of the light.
struct LitRing {
  double inner, outer, inner_place, outer_place;  // m
  double power, area;                             // over that of the mode; of the surface, m^2
};

LitRing ring_of(LitPart const& part, CavityFrame const& frame, double mean, double cell) {
  Vec3 const at = frame.to_local(part.vertex.point), normal = part.vertex.frame.e3;
  double const radius = std::hypot(at.x, at.y), out = dot(normal, at.x * frame.x + at.y * frame.y) / radius,
               slope = -out / dot(normal, frame.z);  // along the axis over that across
  return {part.inner,
          part.outer,
          at.z + slope * (part.inner - radius),
          at.z + slope * (part.outer - radius),
          part.share * cell * mean,
          part.share * cell / part.vertex.wi.z};
}

// Rings of one sector, as patches whose ends lie on the surface.
void add_patches(std::vector<LitRing> const& rings, int sector, std::size_t merged, HaloSurface& surface) {
  for (std::size_t first = 0; first < rings.size(); first += merged) {
    std::size_t const last = std::min(first + merged, rings.size()) - 1;
    LitRing const &one = rings[first], &other = rings[last];
    HaloPatch patch{sector, one.inner, other.outer, one.inner_place, other.outer_place, 0};
    double power = 0, area = 0;
    for (std::size_t i = first; i <= last; ++i) {
      power += rings[i].power;
      area += rings[i].area;
    }
    patch.irradiance = area > 0 ? power / area : 0;
    surface.share += power;
    surface.patches.push_back(patch);
  }
}

}  // namespace

std::vector<HaloSurface> HaloLight::surfaces(int most) const {
  std::vector<HaloSurface> all;
  for (HaloPlane const& plane : planes_) {
    PolarIrradiance const& light = plane.light();
    std::map<std::uint32_t, std::map<int, std::vector<LitRing>>> found;  // by surface and sector
    for (int ring = 0; ring < light.rings; ++ring)
      for (int sector = 0; sector < light.sectors; ++sector)
        for (LitPart const& part : plane.parts(ring, sector)) {
          if (!(part.vertex.wi.z > 0)) continue;
          double const mean = double(light.mean[std::size_t(ring * light.sectors + sector)]);
          found[part.vertex.surface.value][sector].push_back(ring_of(part, *frame_, mean, light.cell_area(ring)));
        }
    for (auto const& [id, sectors] : found) {
      std::size_t longest = 0;
      for (auto const& [sector, rings] : sectors) longest = std::max(longest, rings.size());
      HaloSurface surface{{id}, plane.travel()};
      for (auto const& [sector, rings] : sectors)
        add_patches(rings, sector, (longest + std::size_t(most) - 1) / std::size_t(most), surface);
      if (surface.share > 0) all.push_back(std::move(surface));
    }
  }
  return all;
}

}  // namespace straytrace::trace
