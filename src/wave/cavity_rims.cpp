// SPDX-License-Identifier: BSD-3-Clause
#include "wave/cavity_rims.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/math/constants.hpp"

namespace straytrace::wave {
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
