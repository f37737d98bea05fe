// SPDX-License-Identifier: BSD-3-Clause
#include "wave/plane.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"

namespace straytrace::wave {
namespace {

// Transform of a disc of radius a, 2 pi a J1(qa)/q with q = 2 pi sqrt(m^2 + n^2)/W, for 0 <= n <= m < N/2; of an
// ellipse of half axes a c and a: c times that with q = 2 pi sqrt((c m)^2 + n^2)/W, for 0 <= m, n < N/2. m^2
class DiscSpectrum {
 public:
  DiscSpectrum(RoundHole const& hole, Grid const& grid) : half_(hole.cosine == 1 ? 0 : grid.points / 2) {
    double const radius = hole.radius;
    for (int m = 0; m < grid.points / 2; ++m)
      for (int n = 0; n <= (half_ ? half_ - 1 : m); ++n) {
        double const q = 2 * pi * std::hypot(m * hole.cosine, n) / grid.window;
        double const disc =
            m || n ? 2 * pi * radius * boost::math::cyl_bessel_j(1, q * radius) / q : pi * radius * radius;
        values_.push_back(hole.cosine * disc);
      }
  }
  double operator()(int m, int n) const {
    m = std::abs(m);
    n = std::abs(n);
    if (half_) return values_[std::size_t(m) * std::size_t(half_) + std::size_t(n)];
    int const small = std::min(m, n), large = std::max(m, n);
    return values_[std::size_t(large) * std::size_t(large + 1) / 2 + std::size_t(small)];
  }

 private:
  int half_;  // 0: symmetric in m and n
  std::vector<double> values_;
};

constexpr int ripple_reach = 24;  // points
constexpr int taper_steps = 8192;

}  // namespace

Mask::Mask(RoundHole const& hole, Grid const& grid, Transform const& transform) : values_(grid.size()) {
  int const N = grid.points;
  DiscSpectrum const disc(hole, grid);
  Field spectrum(grid);
  for (int row = 0; row < N; ++row)
    for (int column = 0; column < N; ++column) {
      int const n = row < N / 2 ? row : row - N, m = column < N / 2 ? column : column - N;
      if (n == -N / 2 || m == -N / 2) continue;  // without partner of opposite frequency
      // The axis is at point N/2: a sign for odd frequencies.
      double const turns = 0.5 * ((m + n) & 1) - (m * hole.x + n * hole.y) / grid.window;
      spectrum(row, column) = disc(m, n) / (grid.pitch() * grid.pitch()) * turned(turns);
    }
  transform.inverse(spectrum, N, N);
  std::ranges::transform(spectrum.values, values_.begin(), [](Complex z) { return z.real(); });
  auto const across = [&](double reach) {
    return int(std::min(2 * (std::ceil(reach / grid.pitch()) + ripple_reach), double(N)));
  };
  rows_ = across(std::abs(hole.y) + hole.radius);
  columns_ = across(std::abs(hole.x) + hole.cosine * hole.radius);
}

double Mask::clipped(Field const& field) const {
  double sum = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) sum += (1 - values_[i]) * std::norm(field.values[i]);
  return sum;
}

Field reflection(WaveMirror const& mirror, Mask const& outline, double wavelength, Grid const& grid, double wavefront) {
  Field factor(grid);
  double const kept = std::sqrt(1 - mirror.scattered), cosine = mirror.outline.cosine;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const x = grid.at(column), y = grid.at(row);
      std::size_t const i = std::size_t(row) * std::size_t(grid.points) + std::size_t(column);
      double const height = mirror.height.empty() ? 0 : mirror.height[i];
      double const on_mirror = x / cosine;
      double const path = (on_mirror * on_mirror + y * y) * (mirror.curvature * cosine) + 2 * height * cosine -
                          2 * (mirror.tilt_x * x + mirror.tilt_y * y) - (x * x + y * y) * (wavefront / 2);
      factor.values[i] = kept * outline.values()[i] * turned(-path / wavelength);
    }
  return factor;
}

Leg::Leg(double length, double reach, double wavelength, Grid const& grid) : length_(length) {
  double const k = 2 * pi / wavelength, nyquist = grid.largest_angle(wavelength);
  double const fresnel = std::sqrt(wavelength / length);
  keep_ = std::min(reach / length + fresnel, 0.6 * nyquist);
  cut_ = std::min({keep_ + 4 * fresnel, 0.7 * nyquist, (grid.window - reach) / length});
  if (!(cut_ > keep_))
    throw InputError(fmt::format(
        "a window of {:g} m is too narrow for a leg of {:g} m: light within {:.3g} m of the axis at both ends wraps "
        "around it",
        grid.window, length, reach / 2));
  angle_step_ = wavelength / grid.window;
  columns_ = std::min(2 * (int(std::floor(cut_ / angle_step_)) + 1), grid.points);
  for (int i = 0; i < grid.points; ++i) {
    double const angle = grid.frequency(i) * wavelength;
    Complex const factor = turned(-length * angle * angle / (2 * wavelength));
    paraxial_.insert(paraxial_.end(), {factor.real(), factor.imag()});
  }
  double const largest = k * std::pow(cut_, 4) * length / 8;
  quartic_ = largest > 1e-7 ? k * length / 8 : 0;
  for (int i = 0; i <= taper_steps; ++i) {
    double const angle = std::sqrt(keep_ * keep_ + (cut_ * cut_ - keep_ * keep_) * i / taper_steps);
    taper_.push_back(0.5 * std::erfc(4 * ((angle - keep_) / (cut_ - keep_) - 0.5)));
  }
  taper_.push_back(taper_.back());
}

LegTables Leg::tables() const {
  double const keep2 = keep_ * keep_, cut2 = cut_ * cut_;
  return {paraxial_.data(), taper_.data(), taper_steps, keep2, cut2, taper_steps / (cut2 - keep2),
          angle_step_,      quartic_};
}

void Leg::apply(Field& spectrum, int threads) const {
  int const N = spectrum.grid.points, half = columns_ / 2;
  LegTables const tables = this->tables();
  for_rows(0, N, threads, [&](int row) {
    Complex* const line = &spectrum(row, 0);
    std::fill(line + half, line + N - half, Complex{});
    line_kernels->leg_row(tables, N, row < N / 2 ? row : row - N, half, reinterpret_cast<double*>(line));
  });
}

}  // namespace straytrace::wave
