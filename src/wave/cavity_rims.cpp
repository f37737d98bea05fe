// SPDX-License-Identifier: BSD-3-Clause
#include "wave/cavity_rims.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/math/constants.hpp"

namespace straytrace::wave {
namespace {

std::vector<RimPoint> rim_of_hole(RoundHole const& hole, double place, double largest_frequency) {
  double const periods = 2 * pi * hole.radius * 2 * largest_frequency;  // of the product of two fields, along the rim
  int const count = 4 * std::max(16, int(std::ceil(periods)));
  return round_rim(hole.radius, {hole.x, hole.y, place}, count);
}

double largest_frequency(Arrival const& arrival) { return arrival.columns / (2 * arrival.field.grid.window); }

std::vector<WaveValue> sampled(Arrival const& arrival, Transform const& transform, std::vector<RimPoint> const& rim) {
  Sampler const sampler(arrival.spectrum, transform, arrival.columns);
  std::vector<WaveValue> values;
  for (RimPoint const& point : rim) values.push_back(sampler.at(point.place.x, point.place.y));
  return values;
}

// Values in the order of the points of the rim.
WaveAt in_order(std::vector<WaveValue> const& values) {
  return [at = values.begin()](Vec3 const&) mutable { return *at++; };
}

// Height of a mirror and its slopes, on the grid and between its points.
struct Relief {
  std::vector<double> slope_x, slope_y;  // on the grid
  Sampler between;

  Relief(std::vector<double> const& height, Grid const& grid, Transform const& transform)
      : between(spectrum_of(height, grid, transform), transform, grid.points) {
    for (bool const along_x : {true, false}) {
      Field slope = spectrum_of(height, grid, transform);
      for (int row = 0; row < grid.points; ++row)
        for (int column = 0; column < grid.points; ++column)
          slope(row, column) *= Complex{0, 2 * pi * grid.frequency(along_x ? column : row)};
      transform.inverse(slope, grid.points, grid.points);
      for (Complex z : slope.values) (along_x ? slope_x : slope_y).push_back(z.real());
    }
  }
  static Field spectrum_of(std::vector<double> const& height, Grid const& grid, Transform const& transform) {
    Field field(grid);
    std::ranges::copy(height, field.values.begin());
    transform.forward(field, grid.points, grid.points);
    return field;
  }
};

// Derivatives of s by a displacement of a mirror, times B: the rim of its outline (eq. W.14, passed once), and the
// gradient of the phase of its surface.
std::array<Complex, 2> mirror_levers(CavityWaves const& waves, WaveMirror const& mirror, Arrival const& arrival,
                                     double place) {
  WaveCavity const& cavity = waves.cavity();
  Grid const& grid = cavity.grid;
  double const k = 2 * pi / cavity.wavelength;
  std::optional<Relief> relief;
  if (!mirror.height.empty()) relief.emplace(mirror.height, grid, waves.transform());
  std::vector<RimPoint> const rim = rim_of_hole(mirror.outline, place, 2 * largest_frequency(arrival));
  std::vector<WaveValue> const values = sampled(arrival, waves.transform(), rim);
  std::array<Complex, 2> sum{};
  for (std::size_t i = 0; i < rim.size(); ++i) {
    Vec3 const p = rim[i].place;
    double const height = relief ? relief->between.at(p.x, p.y).value.real() : 0;
    double const path =
        (p.x * p.x + p.y * p.y) * mirror.curvature + 2 * height - 2 * (mirror.tilt_x * p.x + mirror.tilt_y * p.y);
    Complex const flux =
        std::sqrt(1 - mirror.scattered) * turned(-path / cavity.wavelength) * values[i].value * values[i].value;
    sum[0] += rim[i].step.y * flux;
    sum[1] -= rim[i].step.x * flux;
  }
  Field const factor = reflection(mirror, Mask(mirror.outline, grid, waves.transform()), cavity.wavelength, grid);
  Complex const scale{0, 2 * k * grid.pitch() * grid.pitch()};
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      std::size_t const i = std::size_t(row) * std::size_t(grid.points) + std::size_t(column);
      Complex const psi = arrival.field.values[i], share = scale * factor.values[i] * psi * psi;
      sum[0] += share * (grid.at(column) * mirror.curvature - mirror.tilt_x + (relief ? relief->slope_x[i] : 0));
      sum[1] += share * (grid.at(row) * mirror.curvature - mirror.tilt_y + (relief ? relief->slope_y[i] : 0));
    }
  return sum;
}

// The points of a grid that see a baffle, and the share of amplitude that it takes there.
class Screen {
 public:
  Screen(WaveBaffle const& baffle, Mask const& mask, Grid const& grid) {
    double const ripple = 12 * grid.pitch();  // reach of the overshoot of the mask
    double const from = baffle.rim.radius - ripple, to = std::max(baffle.lit_radius, baffle.rim.radius) + ripple;
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points; ++column) {
        double const r = std::hypot(grid.at(column) - baffle.rim.x, grid.at(row) - baffle.rim.y);
        if (r > from && r < to) at_.push_back(std::size_t(row) * std::size_t(grid.points) + std::size_t(column));
      }
    for (std::size_t i : at_) taken_.push_back((1 - mask.values()[i]) * grid.pitch() * grid.pitch());
  }
  void keep(Field const& field) {
    for (std::size_t i : at_) kept_.push_back(field.values[i]);
  }
  Complex overlap(Field const& field) const {
    Complex sum = 0;
    for (std::size_t i = 0; i < at_.size(); ++i) sum += taken_[i] * kept_[i] * field.values[at_[i]];
    return sum;
  }

 private:
  std::vector<std::size_t> at_;
  std::vector<double> taken_;
  std::vector<Complex> kept_;
};

}  // namespace

CavityRims fields_at_rims(CavityWaves const& waves, WaveMode const& mode) {
  WaveCavity const& cavity = waves.cavity();
  std::size_t const n = cavity.baffles.size();
  CavityRims result;
  result.baffles.resize(n);
  result.clipped.resize(n);
  std::vector<Screen> screens;
  for (std::size_t j = 0; j < n; ++j) screens.emplace_back(cavity.baffles[j], waves.mask(j), cavity.grid);
  Field departing = mode.spectrum, work = mode.spectrum;
  waves.transform().inverse(departing, cavity.grid.points, cavity.grid.points);
  waves.round_trip(work, [&](Arrival const& arrival) {
    auto const plane = std::size_t(arrival.plane);
    if (plane == 0) {
      result.overlap = waves.overlap(departing, arrival.field);
      result.mirror1 = mirror_levers(waves, cavity.mirror1, arrival, 0);
    } else if (plane == n + 1) {
      result.mirror2 = mirror_levers(waves, cavity.mirror2, arrival, cavity.length);
    } else if (RimFields& at = result.baffles[plane - 1]; arrival.travel == Travel::towards_mirror2) {
      WaveBaffle const& baffle = cavity.baffles[plane - 1];
      at.rim = rim_of_hole(baffle.rim, baffle.place, largest_frequency(arrival));
      at.from_mirror1 = sampled(arrival, waves.transform(), at.rim);
      screens[plane - 1].keep(arrival.field);
    } else {
      at.from_mirror2 = sampled(arrival, waves.transform(), at.rim);
      result.clipped[plane - 1] = 2.0 * screens[plane - 1].overlap(arrival.field);
    }
  });
  for (Complex& s : result.clipped) s /= result.overlap;
  // At mirror 1 the field departs as gamma times that of the mode, so that the integral of M psi^2 is gamma B.
  for (Complex& lever : result.mirror1) lever /= mode.eigenvalue * result.overlap;
  for (Complex& lever : result.mirror2) lever /= result.overlap;
  return result;
}

RimLevers levers_of(CavityRims const& rims, std::size_t baffle, WaveCavity const& cavity) {
  RimFields const& at = rims.baffles[baffle];
  WaveBaffle const& b = cavity.baffles[baffle];
  return rim_levers(at.rim, in_order(at.from_mirror1), in_order(at.from_mirror2), cavity.wavelength, rims.overlap,
                    {b.rim.x, b.rim.y, b.place});
}

}  // namespace straytrace::wave
