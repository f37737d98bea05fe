// SPDX-License-Identifier: BSD-3-Clause
// A round trip in blocks of columns and rows against the same one plane by plane, with transforms of whole fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/every_module.hpp"
#include "unit/wave/uneven_cavity.hpp"
#include "wave/wave_device.hpp"

namespace straytrace {
namespace {

using testing::distance_of;
using testing::uneven_cavity;
using wave::Complex;

Field after_two_round_trips(int points, int threads) {
  CavityWaves const waves(uneven_cavity(points), threads);
  Field field = waves.hermite_gauss(1, 0);
  for (int i = 0; i < 2; ++i) waves.round_trip(field);
  return field;
}

// Leg by leg with transforms of the whole plane. The fields that arrive, and the spectrum that comes back as the last.
std::vector<Field> plane_by_plane(CavityWaves const& waves, Field field) {
  WaveCavity const& cavity = waves.cavity();
  std::vector<wave::TripStop> const& stops = waves.trip().trip().stops;
  Transform const& transform = waves.transform();
  int const N = cavity.grid.points;
  auto const reach = [](wave::TripStop const& stop) {
    return stop.opening.radius + std::hypot(stop.opening.x, stop.opening.y);
  };
  std::vector<Field> arriving;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    wave::Mask const& mask = waves.trip().mask(i);
    wave::Leg(stops[i].leg, reach(stops[i]) + reach(i > 0 ? stops[i - 1] : stops.back()), cavity.wavelength,
              cavity.grid)
        .apply(field);
    transform.inverse(field, N, N);
    arriving.push_back(field);
    Field const factor =
        stops[i].mirror ? wave::reflection(*stops[i].mirror, mask, cavity.wavelength, cavity.grid) : Field(cavity.grid);
    for (std::size_t p = 0; p < field.values.size(); ++p)
      field.values[p] *= stops[i].mirror ? factor.values[p] : mask.values()[p];
    transform.forward(field, mask.rows(), N);
  }
  wave::Leg const first(stops[0].leg, reach(stops[0]) + reach(stops.back()), cavity.wavelength, cavity.grid);
  for (int row = 0; row < N; ++row)
    std::fill(&field(row, first.columns() / 2), &field(row, 0) + N - first.columns() / 2, Complex{});
  arriving.push_back(field);
  return arriving;
}

TEST(HostTrip, IsTheWayPlaneByPlane) {
  for (int const points : {90, 128, 250}) {
    CavityWaves const waves(uneven_cavity(points));
    Field const start = waves.hermite_gauss(1, 0);
    std::vector<Field> const expected = plane_by_plane(waves, start);
    std::size_t stop = 0;
    Field seen = start, unseen = start;
    waves.round_trip(seen, [&](Arrival const& arrival) {
      EXPECT_LT(distance_of(arrival.field, expected[stop]), 1e-13) << points << ", stop " << stop;
      ++stop;
    });
    waves.round_trip(unseen);
    EXPECT_EQ(stop, 8u);
    EXPECT_LT(distance_of(seen, expected[stop]), 1e-13) << points;
    EXPECT_EQ(distance_of(seen, unseen), 0) << points;
    EXPECT_GT(distance_of(start, expected[stop]), 1e-6) << "one round trip more is not noticed";
  }
}

// Where somebody looks, and nowhere else.
TEST(HostTrip, ShowsOnlyWhatIsLookedAt) {
  CavityWaves const waves(uneven_cavity(90));
  Field const start = waves.hermite_gauss(1, 0);
  std::vector<Field> const expected = plane_by_plane(waves, start);
  Field field = start;
  int arrivals = 0;
  waves.round_trip(
      field,
      [&](Arrival const& arrival) {
        ++arrivals;
        EXPECT_EQ(arrival.plane, 2);
        EXPECT_LT(distance_of(arrival.field, expected[arrival.travel == Travel::towards_mirror2 ? 1 : 5]), 1e-13);
      },
      [](int plane, Travel) { return plane == 2; });
  EXPECT_EQ(arrivals, 2);
  EXPECT_LT(distance_of(field, expected.back()), 1e-13);
}

TEST(HostTrip, SameBitsOnAnyProcessorAndNumberOfThreads) {
  wave::LineKernels const* const chosen = wave::line_kernels;
  wave::line_kernels = wave::find_line_kernels("portable");
  for (int const points : {90, 128, 250}) {
    Field const first = after_two_round_trips(points, 1);
    for (char const* const name : {"portable", "avx2", "avx512"}) {
      wave::LineKernels const* const kernels = wave::find_line_kernels(name);
      if (!kernels) continue;  // not this processor
      wave::line_kernels = kernels;
      for (int const threads : {1, 3}) {
        Field const field = after_two_round_trips(points, threads);
        EXPECT_EQ(std::memcmp(field.values.data(), first.values.data(), field.values.size() * sizeof(Complex)), 0)
            << points << ", " << name << ", " << threads << " threads";
      }
    }
    wave::line_kernels = wave::find_line_kernels("portable");
  }
  wave::line_kernels = chosen;
}

// Heights that are exchanged in a cavity that exists.
TEST(HostTrip, TakesNewHeights) {
  WaveCavity cavity = uneven_cavity(90);
  CavityWaves waves(cavity);
  std::array<std::vector<double>, 2> heights;
  for (std::size_t mirror : {0, 1})
    for (std::size_t i = 0; i < cavity.grid.size(); ++i)
      heights[mirror].push_back(1e-9 * double((7 * i + mirror) % 11));
  Field const start = waves.hermite_gauss();
  Field before = start, after = start, built = start;
  waves.round_trip(before);
  waves.set_heights(heights);
  waves.round_trip(after);
  cavity.mirror1.height = heights[0];
  cavity.mirror2.height = heights[1];
  CavityWaves(cavity).round_trip(built);
  EXPECT_EQ(distance_of(after, built), 0);
  EXPECT_GT(distance_of(after, before), 1e-4) << "the heights are not noticed";
}

}  // namespace
}  // namespace straytrace
