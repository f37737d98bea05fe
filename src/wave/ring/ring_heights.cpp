// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_heights.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "optics/scatter/mixture.hpp"
#include "wave/heights/height_map.hpp"
#include "world/model/vertex.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

// The BSDF of a mirror about the specular direction.
class NearSpecular {
 public:
  NearSpecular(World const& world, SurfaceId surface, MirrorFrame const& at)
      : view_(world.view()),
        vertex_(make_vertex(view_, surface, at.point, at.frame.travel)),
        out_(at.frame.behind(at.normal)) {}

  // 1/sr, times the cosine of the angle of scatter; at slopes along x and y from the specular direction.
  double operator()(double x, double y) const { return towards(unit(out_.travel + x * out_.x + y * out_.y)); }
  double towards(Vec3 direction) const {
    Vec3 const wo = vertex_.frame.to_local(direction);
    return wo.z > 0 ? scatter_eval(view_.laws, *vertex_.optic, vertex_.wi, wo, vertex_.n_in, vertex_.n_out) * wo.z : 0;
  }
  // eq. W.2, in steps of a factor 1.2 of the angle, to all directions in front of the mirror.
  double beyond(double angle) const {
    constexpr int azimuths = 32;
    GaussPoints const gauss(8);
    double sum = 0;
    for (double from = angle; from < pi;) {
      double const to = std::fmin(1.2 * from, pi);
      for (std::size_t i = 0; i < gauss.at.size(); ++i) {
        double const a = from + (to - from) * gauss.at[i];
        double ring = 0;
        for (int k = 0; k < azimuths; ++k) {
          SinCos const turn = sincos_turn((k + 0.5) / azimuths);
          Vec3 const across = turn.cos * out_.x + turn.sin * out_.y;
          ring += towards(std::cos(a) * out_.travel + std::sin(a) * across) / azimuths;
        }
        sum += (to - from) * gauss.weight[i] * ring * 2 * pi * std::sin(a);
      }
      from = to;
    }
    return sum;
  }

 private:
  WorldView view_;
  Vertex vertex_;
  CrossFrame out_;
};

// x to -x. The column of the largest -x has no partner.
void turn_around(std::vector<double>& heights, int points) {
  for (auto line = heights.begin(); line != heights.end(); line += points) std::reverse(line + 1, line + points);
}

// eq. W.20, W.55: what the light that comes at this incidence takes for heights with the spectrum
// S2 = (BRDF cos theta_s) lambda^4/(16 pi^2 cos^2 theta) of the frequencies across it.
std::vector<double> heights_across(NearSpecular const& bsdf, double cosine, double wavelength, Grid const& grid,
                                   double highest, WaveSettings::Mirror const& mirror, std::uint32_t number) {
  int const N = grid.points;
  std::vector<double> const white = synthesise([](double) { return 1.0; }, grid, 0, highest, mirror.seed, number);
  Transform const transform(N, 0);
  Field field(grid);
  std::ranges::copy(white, field.values.begin());
  transform.forward(field, N, N);
  for (int row = 0; row < N; ++row)
    for (int column = 0; column < N; ++column) {
      if (field(row, column) == Complex{}) continue;
      double const x = grid.frequency(column) * wavelength, y = grid.frequency(row) * wavelength;
      double const both = 0.5 * (bsdf(x, y) + bsdf(-x, -y));  // heights are real
      field(row, column) *= std::sqrt(height_spectrum(both, wavelength)) / cosine;
    }
  transform.inverse(field, N, N);
  std::vector<double> heights;
  for (Complex const z : field.values) heights.push_back(z.real());
  return heights;
}

}  // namespace

void add_scattered(RingCavity& ring, World const& world) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < ring.stops.size(); ++i)
    if (RingStop& stop = ring.stops[i]; stop.mirror)
      stop.scattered = ring.trip.stops[i].mirror->scattered =
          NearSpecular(world, stop.surface, ring.frames[next++]).beyond(ring.crossover);
}

void add_ring_heights(RingCavity& ring, World const& world, WaveSettings const& settings) {
  double const wavelength = ring.trip.wavelength;
  std::size_t next = 0;
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    RingStop& stop = ring.stops[i];
    if (!stop.mirror) continue;
    MirrorFrame const& at = ring.frames[next++];
    auto const found = std::ranges::find(settings.mirrors, stop.surface, &WaveSettings::Mirror::surface);
    if (found->heights == WaveSettings::Heights::none) continue;
    WaveMirror& mirror = *ring.trip.stops[i].mirror;
    Grid const grid{ring.trip.grid.points, ring.trip.grid.window * ring.trip.stops[i].scale};
    mirror.height =
        heights_across(NearSpecular(world, stop.surface, at), mirror.outline.cosine, wavelength, grid,
                       ring.crossover / wavelength, *found, std::uint32_t(found - settings.mirrors.begin()));
    // The heights belong to the mirror: light that meets it twice sees them the same way around.
    if (dot(at.frame.x, cross(at.across, at.normal)) < 0) turn_around(mirror.height, grid.points);
    stop.roughness = height_rms(mirror.height);
  }
}

}  // namespace straytrace::wave
