// SPDX-License-Identifier: BSD-3-Clause
#include "wave/cavity_rims.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"

namespace straytrace::wave {
namespace {

struct ComplexVector {
  Complex x, y, z;
};

// eq. W.13; exactly free of divergence for paraxial fields.
ComplexVector flux_vector(WaveValue const& f, WaveValue const& b, double k) {
  Complex const factor = 1.0 / Complex{0, 2 * k};
  return {factor * (b.value * f.dx - f.value * b.dx), factor * (b.value * f.dy - f.value * b.dy), f.value * b.value};
}

ComplexVector crossed(Vec3 a, ComplexVector const& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

void add_scaled(Complex (&sum)[3], ComplexVector const& v, Complex factor) {
  sum[0] += factor * v.x;
  sum[1] += factor * v.y;
  sum[2] += factor * v.z;
}

}  // namespace

std::vector<RimPoint> round_rim(double radius, Vec3 centre, int count) {
  std::vector<RimPoint> rim;
  double const step = 2 * pi * radius / count;
  for (int i = 0; i < count; ++i) {
    SinCos const at = sincos_turn(double(i) / count);
    rim.push_back({centre + Vec3{radius * at.cos, radius * at.sin, 0}, {-step * at.sin, step * at.cos, 0}});
  }
  return rim;
}

RimLevers rim_levers(std::vector<RimPoint> const& rim, WaveAt const& from_mirror1, WaveAt const& from_mirror2,
                     double wavelength, Complex overlap, Vec3 const& reference) {
  double const k = 2 * pi / wavelength;
  Complex const scale = 2.0 / overlap;
  RimLevers levers{};
  for (RimPoint const& point : rim) {
    ComplexVector const flux = flux_vector(from_mirror1(point.place), from_mirror2(point.place), k);
    ComplexVector const pull = crossed(point.step, flux);
    add_scaled(levers.displacement, pull, scale);
    add_scaled(levers.rotation, crossed(point.place - reference, pull), scale);
  }
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(std::norm(levers.displacement[i])) || !std::isfinite(std::norm(levers.rotation[i])))
      throw NumericalError("the levers of an edge are not finite: no mode has settled in the cavity");
  return levers;
}

namespace {

// Height of a mirror and its slopes, on the grid and between its points.
struct Relief {
  Field height;
  std::vector<double> slope_x, slope_y;  // on the grid

  Relief(std::vector<double> const& on_grid, Grid const& grid, Transform const& transform) : height(grid) {
    std::ranges::copy(on_grid, height.values.begin());
    Field spectrum = height;
    transform.forward(spectrum, grid.points, grid.points);
    check_band(spectrum);
    for (bool const along_x : {true, false}) {
      Field slope = spectrum;
      for (int row = 0; row < grid.points; ++row)
        for (int column = 0; column < grid.points; ++column)
          slope(row, column) *= Complex{0, 2 * pi * grid.frequency(along_x ? column : row)};
      transform.inverse(slope, grid.points, grid.points);
      for (Complex z : slope.values) (along_x ? slope_x : slope_y).push_back(z.real());
    }
  }
};

// The Laplacian across the axis.
Field laplacian(Field field, Transform const& transform) {
  Grid const& grid = field.grid;
  transform.forward(field, grid.points, grid.points);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      field(row, column) *= -4 * pi * pi * (std::pow(grid.frequency(row), 2) + std::pow(grid.frequency(column), 2));
  transform.inverse(field, grid.points, grid.points);
  return field;
}

// Integrals over a mirror with the factor M and the field psi that arrives, without their common divisor.
struct MirrorIntegrals {
  WaveMirror const& mirror;
  Grid const& grid;
  double wavelength;
  std::array<Complex, 3> figure{};
  Complex norm{}, x{}, y{}, bend{};  // of M psi^2, of it times x and y, and of M psi times the Laplacian of psi

  // The outline as a rim (eq. W.14, passed once).
  void add_outline(std::optional<Relief> const& relief, Sampler const& field, int count) {
    RoundHole const& hole = mirror.outline;
    for (RimPoint const& point : round_rim(hole.radius, {hole.x, hole.y, 0}, count)) {
      Vec3 const p = point.place;
      double const height = relief ? Sampler(relief->height).at(p.x, p.y).value.real() : 0;
      double const path =
          (p.x * p.x + p.y * p.y) * mirror.curvature + 2 * height - 2 * (mirror.tilt_x * p.x + mirror.tilt_y * p.y);
      Complex const psi = field.at(p.x, p.y).value;
      Complex const flux = std::sqrt(1 - mirror.scattered) * turned(-path / wavelength) * psi * psi;
      figure[0] += point.step.y * flux;
      figure[1] -= point.step.x * flux;
      figure[2] -= (p.x * point.step.x + p.y * point.step.y) * flux;
    }
  }
  void add_area(std::optional<Relief> const& relief, Field const& factor, Field const& psi, Field const& curved) {
    double const area = grid.pitch() * grid.pitch();
    Complex const phase{0, 4 * pi / wavelength};  // 2ik
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points; ++column) {
        std::size_t const i = std::size_t(row) * std::size_t(grid.points) + std::size_t(column);
        double const at_x = grid.at(column), at_y = grid.at(row);
        Complex const once = area * factor.values[i] * psi.values[i], share = once * psi.values[i];
        norm += share;
        x += at_x * share;
        y += at_y * share;
        bend += once * curved.values[i];
        if (!relief) continue;
        double const slope_x = relief->slope_x[i], slope_y = relief->slope_y[i];
        figure[0] += phase * slope_x * share;
        figure[1] += phase * slope_y * share;
        figure[2] += phase * (at_x * slope_y - at_y * slope_x) * share;
      }
  }
};

}  // namespace

MirrorLevers mirror_levers(CavityWaves const& waves, Arrival const& arrival) {
  WaveCavity const& cavity = waves.cavity();
  Grid const& grid = cavity.grid;
  bool const first = arrival.plane == 0;
  WaveMirror const& mirror = first ? cavity.mirror1 : cavity.mirror2;
  double const side = first ? 1 : -1;  // of the light, along z
  std::optional<Relief> relief;
  if (!mirror.height.empty()) relief.emplace(mirror.height, grid, waves.transform());
  MirrorIntegrals sum{mirror, grid, cavity.wavelength};
  sum.add_outline(relief, Sampler(arrival.field), points_along(2 * pi * mirror.outline.radius, grid.pitch()));
  Field const factor = reflection(mirror, Mask(mirror.outline, grid, waves.transform()), cavity.wavelength, grid);
  sum.add_area(relief, factor, arrival.field, laplacian(arrival.field, waves.transform()));

  Complex const phase{0, 4 * pi / cavity.wavelength}, x = sum.x / sum.norm, y = sum.y / sum.norm;
  MirrorLevers levers;
  for (std::size_t i = 0; i < 3; ++i) levers.figure[i] = sum.figure[i] / sum.norm;
  RimLevers& whole = levers.whole;
  whole.displacement[0] = levers.figure[0] + phase * (x * mirror.curvature - mirror.tilt_x);
  whole.displacement[1] = levers.figure[1] + phase * (y * mirror.curvature - mirror.tilt_y);
  // Light that is not parallel to the axis gains less phase on a longer way.
  whole.displacement[2] = -side * Complex{0, cavity.wavelength / (2 * pi)} * sum.bend / sum.norm;
  whole.rotation[0] = -side * phase * y;
  whole.rotation[1] = side * phase * x;
  whole.rotation[2] = levers.figure[2] + phase * (mirror.tilt_x * y - mirror.tilt_y * x);
  return levers;
}

namespace {

// Of the field turned about the axis by `roll`.
std::vector<WaveValue> values_at(Field const& field, std::vector<RimPoint> const& rim, double roll, int threads) {
  double const c = std::cos(roll), s = std::sin(roll);
  std::vector<Vec3> places;
  for (RimPoint const& point : rim)
    places.push_back({c * point.place.x + s * point.place.y, c * point.place.y - s * point.place.x, 0});
  std::vector<WaveValue> values = Sampler(field).at(places, threads);
  for (WaveValue& v : values) v = {v.value, c * v.dx - s * v.dy, s * v.dx + c * v.dy};
  return values;
}

// eq. W.14, times B.
RimResponse response(RimCurve const& rim, std::vector<WaveValue> const& forward, std::vector<WaveValue> const& backward,
                     double wavelength) {
  Complex widening = 0;
  for (std::size_t i = 0; i < rim.points.size(); ++i)
    widening += 2 * length(rim.points[i].step) * forward[i].value * backward[i].value;
  auto const in_order = [](std::vector<WaveValue> const& values) -> WaveAt {
    return [at = values.begin()](Vec3 const&) mutable { return *at++; };
  };
  return {rim_levers(rim.points, in_order(forward), in_order(backward), wavelength, 1, rim.reference), widening};
}

// Integral of (1 - T) psi_f psi_b over the whole plane; the series of the mask and the product of the fields are exact
// together, also where the mask overshoots.
Complex taken(Mask const& mask, Field const& forward, Field const& backward, int threads) {
  Grid const& grid = forward.grid;
  std::vector<Complex> rows(static_cast<std::size_t>(grid.points));
  for_rows(0, grid.points, threads, [&](int row) {
    double const* const screen = mask.values().data() + std::size_t(row) * std::size_t(grid.points);
    Complex sum = 0;
    for (int i = 0; i < grid.points; ++i) sum += (1 - screen[i]) * forward(row, i) * backward(row, i);
    rows[std::size_t(row)] = sum;
  });
  return std::accumulate(rows.begin(), rows.end(), Complex()) * (grid.pitch() * grid.pitch());
}

void divide_by_overlap(CavityRims& rims) {
  for (Complex& s : rims.clipped) s /= rims.overlap;
  for (auto& baffle : rims.responses)
    for (RimResponse& r : baffle) {
      for (int i = 0; i < 3; ++i) r.levers.displacement[i] /= rims.overlap;
      for (int i = 0; i < 3; ++i) r.levers.rotation[i] /= rims.overlap;
      r.widening /= rims.overlap;
    }
}

}  // namespace

int points_along(double length, double pitch) {
  double const largest_frequency = 0.7 / (2 * pitch);  // of one field
  return 4 * std::max(16, int(std::ceil(2.5 * length * 2 * largest_frequency / 4)));
}

RimCurve round_curve(WaveBaffle const& baffle, WaveCavity const& cavity) {
  Vec3 const centre{baffle.rim.x, baffle.rim.y, baffle.place};
  return {round_rim(baffle.rim.radius, centre, points_along(2 * pi * baffle.rim.radius, cavity.grid.pitch())), centre};
}

CavityRims rim_responses(CavityWaves const& waves, WaveMode const& mode,
                         std::vector<std::vector<RimCurve>> const& curves, Observer const& also) {
  WaveCavity const& cavity = waves.cavity();
  std::size_t const n = cavity.baffles.size();
  CavityRims result;
  result.responses.resize(n);
  result.clipped.resize(n);
  std::vector<std::optional<Field>> forward(n);  // of baffles with curves
  std::vector<std::vector<std::vector<WaveValue>>> outward(n);
  Field departing = mode.spectrum, work = mode.spectrum;
  waves.transform().inverse(departing, cavity.grid.points, cavity.grid.points);
  auto const see = [&](Arrival const& arrival) {
    auto const plane = std::size_t(arrival.plane);
    if (also) also(arrival);
    if (plane == 0) {
      result.overlap = waves.overlap(departing, arrival.field);
      result.mirrors[0] = mirror_levers(waves, arrival);
      return;
    }
    if (plane == n + 1) {
      result.mirrors[1] = mirror_levers(waves, arrival);
      return;
    }
    if (curves[plane - 1].empty()) return;
    bool const outwards = arrival.travel == Travel::towards_mirror2;
    for (std::size_t i = 0; i < curves[plane - 1].size(); ++i) {
      RimCurve const& curve = curves[plane - 1][i];
      std::vector<WaveValue> values =
          values_at(arrival.field, curve.points, curve.roll[outwards ? 0 : 1], waves.threads());
      if (outwards)
        outward[plane - 1].push_back(std::move(values));
      else
        result.responses[plane - 1].push_back(response(curve, outward[plane - 1][i], values, cavity.wavelength));
    }
    if (outwards)
      forward[plane - 1] = arrival.field;
    else
      result.clipped[plane - 1] =
          2.0 * taken(waves.mask(plane - 1), *forward[plane - 1], arrival.field, waves.threads());
  };
  waves.round_trip(work, see, [&](int plane, Travel) {
    return also || plane == 0 || plane == int(n) + 1 || !curves[std::size_t(plane) - 1].empty();
  });
  divide_by_overlap(result);
  return result;
}

}  // namespace straytrace::wave
