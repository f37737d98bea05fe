// SPDX-License-Identifier: BSD-3-Clause
// Interpolation of a band-limited field against its Fourier sum, and the levers of a rim from it (docs/theory/wave.md,
// eq. W.14). The negative controls are a field beyond the limit and another place.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "support/recorded.hpp"
#include "wave/cavity_rims.hpp"
#include "wave/lines/line_kernels.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave_sampler {
namespace {

using wave::Complex;
using wave::Field;
using wave::Grid;
using wave::Sampler;
using wave::Transform;
using wave::WaveValue;

constexpr Grid grid{64, 0.5};
constexpr int limit = 23;  // 0.72 of 32, rounded down

Field random_spectrum() {
  Field spectrum(grid);
  Rng random(3, 0, 0, Stream::source);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const rows = grid.frequency(row) * grid.window, columns = grid.frequency(column) * grid.window;
      if (std::fmax(std::fabs(rows), std::fabs(columns)) <= limit)
        spectrum(row, column) = std::polar(random.uniform(), 2 * pi * random.uniform());
    }
  return spectrum;
}

// One plane wave, of unit amplitude in space.
Field plane_wave(int rows, int columns) {
  Field spectrum(grid);
  spectrum((rows + grid.points) % grid.points, (columns + grid.points) % grid.points) = double(grid.size());
  return spectrum;
}

WaveValue fourier_sum(Field const& spectrum, double x, double y) {
  WaveValue sum{};
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const fx = grid.frequency(column), fy = grid.frequency(row);
      Complex const wave = spectrum(row, column) / double(grid.size()) *
                           std::polar(1.0, 2 * pi * (fx * (x - grid.at(0)) + fy * (y - grid.at(0))));
      sum.value += wave;
      sum.dx += Complex{0, 2 * pi * fx} * wave;
      sum.dy += Complex{0, 2 * pi * fy} * wave;
    }
  return sum;
}

Field in_space(Field spectrum) {
  Transform(grid.points).inverse(spectrum, grid.points, grid.points);
  return spectrum;
}

// Largest errors over the largest value and the largest derivative.
struct Errors {
  double value = 0, slope = 0;

  explicit Errors(Field const& spectrum, double stretch = 1) {
    Field const field = in_space(spectrum);
    Sampler const sampler(field);
    double largest = 0, steepest = 0;
    Rng random(4, 0, 0, Stream::source);
    for (int i = 0; i < 300; ++i) {
      double x = grid.window * (random.uniform() - 0.5), y = grid.window * (random.uniform() - 0.5);
      if (i % 10 == 0) x = grid.at(int(64 * random.uniform()));            // on the grid
      if (i % 10 == 1) y = (i % 20 == 1 ? 0.5 : -0.5) * grid.window;       // on the border
      if (i % 10 == 2) x = std::nextafter(grid.at(2 + i % 60), infinity);  // beside the grid
      WaveValue const found = sampler.at(x, y), right = fourier_sum(spectrum, stretch * x, y);
      largest = std::fmax(largest, std::abs(right.value));
      steepest = std::fmax(steepest, std::fmax(std::abs(right.dx), std::abs(right.dy)));
      value = std::fmax(value, std::abs(found.value - right.value));
      slope = std::fmax(slope, std::fmax(std::abs(found.dx - right.dx), std::abs(found.dy - right.dy)));
    }
    value /= largest;
    slope /= steepest;
  }
};

TEST(Sampler, RandomFieldAgainstItsFourierSum) {
  Errors const errors(random_spectrum());
  EXPECT_LT(errors.value, 1e-8);
  EXPECT_LT(errors.slope, 2e-8);
  EXPECT_GT(Errors(random_spectrum(), 1 + 1e-6).value, 1e-6);  // another place
}

TEST(Sampler, PlaneWavesAtTheLimit) {
  for (auto const& [rows, columns] : {std::pair{limit, limit}, {-limit, 5}, {0, -limit}, {1, 0}}) {
    Errors const errors(plane_wave(rows, columns));
    EXPECT_LT(errors.value, 1e-8) << rows << ' ' << columns;
    EXPECT_LT(errors.slope, 2e-8) << rows << ' ' << columns;
  }
}

TEST(Sampler, BeyondTheLimitAndTheWindowAreErrors) {
  EXPECT_NO_THROW(wave::check_band(plane_wave(0, limit)));
  EXPECT_THROW(wave::check_band(plane_wave(0, limit + 1)), NumericalError);
  EXPECT_THROW(wave::check_band(plane_wave(-limit - 1, 0)), NumericalError);
  Field const field = in_space(plane_wave(1, 1));
  Sampler const sampler(field);
  EXPECT_NO_THROW(sampler.at(0.25, -0.25));
  EXPECT_THROW(sampler.at(0.2501, 0), NumericalError);
  EXPECT_THROW(sampler.at(0, not_a_number), NumericalError);
  EXPECT_THROW(sampler.at({{0, 0, 0}, {0, 0.2501, 0}}, 2), NumericalError);
}

TEST(Sampler, SameBitsOnAnyProcessorAndNumberOfThreads) {
  Field const field = in_space(random_spectrum());
  Sampler const sampler(field);
  auto const places = wave::round_rim(0.24, {0.004, 0, 0}, 100);
  std::vector<Vec3> at;
  for (wave::RimPoint const& p : places) at.push_back(p.place);
  wave::LineKernels const* const chosen = wave::line_kernels;
  wave::line_kernels = wave::find_line_kernels("portable");
  std::vector<WaveValue> const first = sampler.at(at, 1);
  auto const same = [&](std::vector<WaveValue> const& values) {
    return std::memcmp(values.data(), first.data(), first.size() * sizeof(WaveValue)) == 0;
  };
  for (char const* const name : {"portable", "avx2", "avx512"}) {
    wave::line_kernels = wave::find_line_kernels(name);
    if (!wave::line_kernels) continue;  // not this processor
    for (int const threads : {1, 3}) EXPECT_TRUE(same(sampler.at(at, threads))) << name << ", " << threads;
  }
  wave::line_kernels = chosen;
  at[50].x = std::nextafter(at[50].x, 0.0);
  EXPECT_FALSE(same(sampler.at(at, 1))) << "another place is not noticed";
}

// A Gaussian beam of a curved wavefront, off the axis, in closed form and from a grid.
WaveValue beam(double x, double y, double curvature) {
  double const w = 0.03, u = x - 0.004, v = y + 0.003;
  Complex const slope{-2 / (w * w), curvature}, value = std::exp(0.5 * slope * (u * u + v * v));
  return {value, slope * u * value, slope * v * value};
}

// Eq. W.14 from fields on a grid, as the cavity has them.
TEST(Sampler, LeversOfARimBetweenThePoints) {
  Grid const wide{96, 0.4};
  auto const on_grid = [&](double curvature) {
    Field field(wide);
    for (int row = 0; row < wide.points; ++row)
      for (int column = 0; column < wide.points; ++column)
        field(row, column) = beam(wide.at(column), wide.at(row), curvature).value;
    return field;
  };
  Field const fields[] = {on_grid(3000), on_grid(-1000)};
  Sampler const first(fields[0]), second(fields[1]);
  auto const rim = wave::round_rim(0.035, {0.001, 0, 0}, 256);
  auto const sampled = rim_levers(
      rim, [&](Vec3 const& p) { return first.at(p.x, p.y); }, [&](Vec3 const& p) { return second.at(p.x, p.y); },
      1.064e-6, 1, {0.02, 0.01, 0});
  auto const expected = rim_levers(
      rim, [](Vec3 const& p) { return beam(p.x, p.y, 3000); }, [](Vec3 const& p) { return beam(p.x, p.y, -1000); },
      1.064e-6, 1, {0.02, 0.01, 0});
  auto const apart = [](Complex a, Complex b) { return std::abs(a - b) / std::abs(b); };
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(apart(sampled.displacement[i], expected.displacement[i]), 1e-7) << i;
    EXPECT_LT(apart(sampled.rotation[i], expected.rotation[i]), 1e-7) << i;
  }
}

}  // namespace
}  // namespace straytrace::wave_sampler
