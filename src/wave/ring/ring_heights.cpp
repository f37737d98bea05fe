// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_heights.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "optics/scatter/mixture.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/heights/defects.hpp"
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

// The axes of the heights of a mirror: y along the normal of the plane of incidence, x to the right of who looks at the
// mirror from the side of the light, from its vertex. 1 where the coordinate x of the light grows along that x, else
// -1.
double sense_of(MirrorFrame const& at) { return dot(at.frame.x, cross(at.across, at.normal)) < 0 ? -1 : 1; }

LightOnMirror light_on(RingCavity const& ring, std::size_t i) {
  RoundHole const& outline = ring.trip.stops[i].opening;
  auto const& [x, y] = ring.stops[i].arriving;
  return {{x.radius, y.radius}, outline.cosine, {-sense_of(ring.frame_at(i)) * outline.x / outline.cosine, -outline.y}};
}

std::size_t number_of(WaveSettings const& settings, SurfaceId surface) {
  return std::size_t(std::ranges::find(settings.mirrors, surface, &WaveSettings::Mirror::surface) -
                     settings.mirrors.begin());
}

// eq. W.20, W.55: what the light that comes at this incidence takes for heights with the spectrum
// S2 = (BRDF cos theta_s) lambda^4/(16 pi^2 cos^2 theta) of the frequencies across it.
std::vector<double> heights_across(NearSpecular const& bsdf, double cosine, double wavelength, Grid const& grid,
                                   double lowest, double highest, WaveSettings::Mirror const& mirror,
                                   std::uint32_t number) {
  int const N = grid.points;
  std::vector<double> const white = synthesise([](double) { return 1.0; }, grid, lowest, highest, mirror.seed, number);
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

void put_on(std::vector<double>& heights, std::vector<double> const& more) {
  if (heights.empty()) heights.resize(more.size());
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += more[i];
}

// On the grid across the light, x as that of the mirror; empty: none.
std::vector<double> heights_of(RingCavity const& ring, std::size_t i, World const& world,
                               WaveSettings const& settings) {
  double const wavelength = ring.trip.wavelength, highest = ring.crossover / wavelength;
  TripStop const& stop = ring.trip.stops[i];
  Grid const grid{ring.trip.grid.points, ring.trip.grid.window * stop.scale};
  std::size_t const number = number_of(settings, ring.stops[i].surface);
  WaveSettings::Mirror const& mirror = settings.mirrors[number];
  LightOnMirror const light = light_on(ring, i);
  std::vector<double> heights;
  std::optional<HeightMap> map = ring.maps[number];
  if (mirror.heights != WaveSettings::Heights::none)
    heights = heights_across(NearSpecular(world, ring.stops[i].surface, ring.frame_at(i)), light.cosine, wavelength,
                             grid, map ? map->nyquist(light.cosine) : 0, highest, mirror, std::uint32_t(number));
  if (map) {
    fill_holes(*map);
    put_on(heights, resample(*map, grid, highest, light));
  }
  for (WaveSettings::Absorber const& a : mirror.absorbers)
    put_on(heights, heights_of_absorber(a, grid, stop.opening.radius, highest, light));
  for (WaveSettings::Ripple const& r : mirror.ripples) put_on(heights, heights_of_ripple(r, grid, light));
  return heights;
}

}  // namespace

void plan_ring_heights(RingCavity& ring, World const& world, WaveSettings const& settings) {
  ring.maps.assign(settings.mirrors.size(), {});
  std::vector<bool> checked(settings.mirrors.size());
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    RingStop& stop = ring.stops[i];
    if (!stop.mirror) continue;
    LightOnMirror const light = light_on(ring, i);
    std::size_t const number = number_of(settings, stop.surface);
    WaveSettings::Mirror const& mirror = settings.mirrors[number];
    double const wavelength = ring.trip.wavelength;
    stop.scattered = NearSpecular(world, stop.surface, ring.frame_at(i)).beyond(ring.crossover);
    for (WaveSettings::Absorber const& a : mirror.absorbers)
      stop.scattered += scattered_by_absorber(a, light, wavelength, ring.crossover);
    ring.trip.stops[i].mirror->scattered = stop.scattered;
    if (checked[number]) continue;  // by light that meets it before
    checked[number] = true;
    check_defects(mirror, {ring.trip.stops[i].opening.radius, light.cosine, wavelength, ring.crossover}, ring.problems);
    if (mirror.heights == WaveSettings::Heights::file)
      ring.maps[number] = checked_map(mirror, light, wavelength, ring.problems);
  }
}

void add_ring_heights(RingCavity& ring, World const& world, WaveSettings const& settings) {
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    if (!ring.stops[i].mirror) continue;
    std::vector<double> heights = heights_of(ring, i, world, settings);
    if (heights.empty()) continue;
    // The heights belong to the mirror: light that meets it twice sees them the same way around.
    if (sense_of(ring.frame_at(i)) < 0) turn_around(heights, ring.trip.grid.points);
    ring.stops[i].roughness = height_rms(heights);
    ring.trip.stops[i].mirror->height = std::move(heights);
  }
}

}  // namespace straytrace::wave
