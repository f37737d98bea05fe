// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/expected_levers.hpp"

#include <cmath>

#include "base/math/constants.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/cavity_rims.hpp"

namespace straytrace::wave {
namespace {

// Nothing of the mode itself meets the rim, and the grid holds the light of this mirror there but not that of the
// other.
bool held(ArmCavity const& arm, ArmRim const& rim, std::size_t mirror) {
  return !rim.in_band && clear_of_mode(arm, rim) && (mirror == 0 ? rim.angle1 : rim.angle2) <= arm.crossover;
}

// Light from a mirror, whose points lie within R of the axis of a ring of radius a, has harmonics up to kaR/l on it,
// and an Airy tail beyond.
int harmonics_on(ArmCavity const& arm, ArmRim const& rim, std::size_t mirror) {
  WaveCavity const& cavity = arm.cavity;
  RoundHole const& hole = (mirror == 0 ? cavity.mirror1 : cavity.mirror2).outline;
  double const distance = mirror == 0 ? rim.centre.z : cavity.length - rim.centre.z;
  double const farthest = hole.radius + std::hypot(hole.x - rim.centre.x, hole.y - rim.centre.y);
  double const x = 2 * pi / cavity.wavelength * rim.rim.radius * farthest / distance;
  return int(std::ceil(x + 4 * std::cbrt(x))) + 8;
}

// By light of a mirror on its way to a rim.
std::vector<PassedEdge> edges_before(ArmCavity const& arm, std::size_t rim, std::size_t mirror) {
  auto const distance = [&](ArmRim const& r) { return mirror == 0 ? r.centre.z : arm.cavity.length - r.centre.z; };
  std::vector<PassedEdge> edges;
  for (ArmRim const& r : arm.rims)
    if (distance(r) < distance(arm.rims[rim])) edges.push_back({distance(r), r.rim.radius});
  return edges;
}

}  // namespace

LightMeter::LightMeter(ArmCavity const& arm, WaveCavity const& cavity) : arm_(arm), cavity_(cavity) {
  light_.at_rims.resize(arm.rims.size());
}

void LightMeter::operator()(Arrival const& arrival) {
  int const last = int(arm_.rims.size()) + 1;
  if (arrival.plane == 0 || arrival.plane == last) {
    WaveMirror const& mirror = arrival.plane == 0 ? cavity_.mirror1 : cavity_.mirror2;
    int const points = points_along(2 * pi * mirror.outline.radius, cavity_.grid.pitch());
    light_.outlines[arrival.plane == 0 ? 0 : 1] =
        leaving_outline(Sampler(arrival.field), mirror, cavity_.wavelength, points);
    return;
  }
  std::size_t const rim = std::size_t(arrival.plane - 1), from = arrival.travel == Travel::towards_mirror2 ? 0 : 1;
  ArmRim const& lit = arm_.rims[rim];
  if (held(arm_, lit, from))
    light_.at_rims[rim][from] =
        field_on_ring(Sampler(arrival.field), lit.centre, lit.rim.radius, harmonics_on(arm_, lit, from));
}

ExpectedLevers::ExpectedLevers(World const& world, ArmCavity const& arm) : arm_(arm) {
  for (std::size_t const i : {0, 1}) brdf_.emplace_back(world, arm.mirrors[i], i == 0 ? -arm.frame.z : arm.frame.z);
}

SpeckledRim ExpectedLevers::lit(std::size_t number, LightOfMirrors const& light) const {
  ArmRim const& rim = arm_.rims[number];
  SpeckledRim s{arm_.cavity.wavelength, rim.rim.radius, rim.centre.z, arm_.cavity.length - rim.centre.z};
  s.spot1 = arm_.mirrors[0].spot;
  s.spot2 = arm_.mirrors[1].spot;
  for (std::size_t const i : {0, 1}) {
    RingField& wave = i == 0 ? s.edge1 : s.edge2;
    double& brdf = i == 0 ? s.brdf1 : s.brdf2;
    if (held(arm_, rim, i)) {
      wave = light.at_rims[number][i];
      continue;
    }
    double const distance = i == 0 ? s.distance1 : s.distance2;
    std::vector<PassedEdge> const edges = edges_before(arm_, number, i);
    wave = diffracted(light.outlines[i], arm_.mirrors[i].radius, s.wavelength, s.radius, distance, edges);
    brdf = brdf_[i](i == 0 ? rim.angle1 : rim.angle2);
    if (clear_of_mode(arm_, rim)) brdf *= share_passed(edges, s.wavelength, arm_.mirrors[i].spot, s.radius, distance);
  }
  return s;
}

SpeckleMeans ExpectedLevers::operator()(std::size_t rim, LightOfMirrors const& light) const {
  return speckle_means(lit(rim, light));
}

SpeckleMeans ExpectedLevers::operator()(std::size_t rim, std::vector<LightOfMirrors> const& draws) const {
  SpeckleMeans mean;
  double const share = 1 / double(draws.size());
  for (LightOfMirrors const& light : draws) {
    SpeckleMeans const means = (*this)(rim, light);
    mean.field += share * means.field;
    mean.transverse += share * means.transverse;
    mean.longitudinal += share * means.longitudinal;
  }
  return mean;
}

}  // namespace straytrace::wave
