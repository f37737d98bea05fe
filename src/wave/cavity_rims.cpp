// SPDX-License-Identifier: BSD-3-Clause
#include "wave/cavity_rims.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/math/constants.hpp"

namespace straytrace::wave {
namespace {

// Fields at the points of a rim; single precision, because there may be thousands of rims.
struct Samples {
  std::vector<std::array<std::complex<float>, 3>> values;

  Samples(Sampler const& field, std::vector<RimPoint> const& rim) {
    for (RimPoint const& point : rim) {
      WaveValue const v = field.at(point.place.x, point.place.y);
      values.push_back({std::complex<float>(v.value), std::complex<float>(v.dx), std::complex<float>(v.dy)});
    }
  }
};

// eq. W.14, times B.
RimResponse response(RimCurve const& rim, Samples const& from_mirror1, Sampler const& from_mirror2, double wavelength) {
  std::vector<WaveValue> forward, backward;
  Complex widening = 0;
  for (std::size_t i = 0; i < rim.points.size(); ++i) {
    auto const& v = from_mirror1.values[i];
    forward.push_back({Complex(v[0]), Complex(v[1]), Complex(v[2])});
    backward.push_back(from_mirror2.at(rim.points[i].place.x, rim.points[i].place.y));
    widening += 2 * length(rim.points[i].step) * forward.back().value * backward.back().value;
  }
  auto const in_order = [](std::vector<WaveValue> const& values) -> WaveAt {
    return [at = values.begin()](Vec3 const&) mutable { return *at++; };
  };
  return {rim_levers(rim.points, in_order(forward), in_order(backward), wavelength, 1, rim.reference), widening};
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
  int const count = points_along(2 * pi * mirror.outline.radius, cavity);
  std::vector<RimPoint> const rim =
      round_rim(mirror.outline.radius, {mirror.outline.x, mirror.outline.y, place}, count);
  Sampler const field(arrival.spectrum, waves.transform(), arrival.columns);
  std::array<Complex, 2> sum{};
  for (RimPoint const& point : rim) {
    Vec3 const p = point.place;
    double const height = relief ? relief->between.at(p.x, p.y).value.real() : 0;
    double const path =
        (p.x * p.x + p.y * p.y) * mirror.curvature + 2 * height - 2 * (mirror.tilt_x * p.x + mirror.tilt_y * p.y);
    Complex const psi = field.at(p.x, p.y).value,
                  flux = std::sqrt(1 - mirror.scattered) * turned(-path / cavity.wavelength) * psi * psi;
    sum[0] += point.step.y * flux;
    sum[1] -= point.step.x * flux;
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

// Integral of (1 - T) psi_f psi_b over the whole plane; the series of the mask and the product of the fields are exact
// together, also where the mask overshoots.
Complex taken(Mask const& mask, Field const& forward, Field const& backward) {
  Complex sum = 0;
  for (std::size_t i = 0; i < forward.values.size(); ++i)
    sum += (1 - mask.values()[i]) * forward.values[i] * backward.values[i];
  return sum * (forward.grid.pitch() * forward.grid.pitch());
}

}  // namespace

int points_along(double length, WaveCavity const& cavity) {
  double const largest_frequency = 0.7 / (2 * cavity.grid.pitch());  // of one field
  return 4 * std::max(16, int(std::ceil(2.5 * length * 2 * largest_frequency / 4)));
}

RimCurve round_curve(WaveBaffle const& baffle, WaveCavity const& cavity) {
  Vec3 const centre{baffle.rim.x, baffle.rim.y, baffle.place};
  return {round_rim(baffle.rim.radius, centre, points_along(2 * pi * baffle.rim.radius, cavity)), centre};
}

CavityRims rim_responses(CavityWaves const& waves, WaveMode const& mode,
                         std::vector<std::vector<RimCurve>> const& curves, Observer const& also) {
  WaveCavity const& cavity = waves.cavity();
  std::size_t const n = cavity.baffles.size();
  CavityRims result;
  result.responses.resize(n);
  result.clipped.resize(n);
  std::vector<std::optional<Field>> forward(n);  // of baffles with curves
  std::vector<std::vector<Samples>> outward(n);
  Field departing = mode.spectrum, work = mode.spectrum;
  waves.transform().inverse(departing, cavity.grid.points, cavity.grid.points);
  waves.round_trip(work, [&](Arrival const& arrival) {
    auto const plane = std::size_t(arrival.plane);
    if (also) also(arrival);
    if (plane == 0) {
      result.overlap = waves.overlap(departing, arrival.field);
      result.mirror1 = mirror_levers(waves, cavity.mirror1, arrival, 0);
      return;
    }
    if (plane == n + 1) {
      result.mirror2 = mirror_levers(waves, cavity.mirror2, arrival, cavity.length);
      return;
    }
    if (curves[plane - 1].empty()) return;
    Sampler const field(arrival.spectrum, waves.transform(), arrival.columns);
    for (std::size_t i = 0; i < curves[plane - 1].size(); ++i) {
      RimCurve const& curve = curves[plane - 1][i];
      if (arrival.travel == Travel::towards_mirror2)
        outward[plane - 1].emplace_back(field, curve.points);
      else
        result.responses[plane - 1].push_back(response(curve, outward[plane - 1][i], field, cavity.wavelength));
    }
    if (arrival.travel == Travel::towards_mirror2)
      forward[plane - 1] = arrival.field;
    else
      result.clipped[plane - 1] = 2.0 * taken(waves.mask(plane - 1), *forward[plane - 1], arrival.field);
  });
  // At mirror 1 the field departs as gamma times that of the mode, so that the integral of M psi^2 is gamma B.
  for (Complex& lever : result.mirror1) lever /= mode.eigenvalue * result.overlap;
  for (Complex& lever : result.mirror2) lever /= result.overlap;
  for (Complex& s : result.clipped) s /= result.overlap;
  for (auto& baffle : result.responses)
    for (RimResponse& r : baffle) {
      for (int i = 0; i < 3; ++i) r.levers.displacement[i] /= result.overlap;
      for (int i = 0; i < 3; ++i) r.levers.rotation[i] /= result.overlap;
      r.widening /= result.overlap;
    }
  return result;
}

}  // namespace straytrace::wave
