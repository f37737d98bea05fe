// SPDX-License-Identifier: BSD-3-Clause
// The border between fields and rays (R2.31): light scattered by a rough mirror to small angles as a
// diffracted field, to larger ones as rays of the BSDF model. The total must not depend on where the border lies.
#include <gtest/gtest.h>
#include <unsupported/Eigen/FFT>

#include <cmath>
#include <complex>

#include "base/math/rng.hpp"
#include "optics/scatter/roughness.hpp"
#include "support/laws.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::optics_hand_over {
namespace {

using Field = Eigen::MatrixXcd;
constexpr int points = 1024;
constexpr double pitch = 2;                    // wavelengths: directions up to 0.25 rad
constexpr double waist = 320;                  // wavelengths; the window is 6.4 of it
constexpr double step = 1 / (points * pitch);  // of the projected direction alpha, rad
constexpr double knee = 60, rms = 2e-3,
                 tail = 3;  // of the law, in wavelengths: most of the light near 1/knee = 17 mrad

double alpha_of(int i) { return step * (i < points / 2 ? i : i - points); }

void transform(Field& f, bool forth) {
  Eigen::FFT<double> fft;
  Eigen::VectorXcd in(points), out(points);
  for (int turn = 0; turn < 2; ++turn) {
    for (int i = 0; i < points; ++i) {
      in = f.col(i);
      forth ? fft.fwd(out, in) : fft.inv(out, in);
      f.col(i) = out;
    }
    f.transposeInPlace();
  }
}

// Heights in wavelengths with the two-sided spectrum of the law (eq. 3.6): each frequency gets a complex normal number
// of its own; the real part holds half of the variance.
Eigen::MatrixXd heights(Roughness const& law, std::uint64_t seed) {
  Field f(points, points);
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j) {
      double const rho = std::hypot(alpha_of(i), alpha_of(j));
      Rng rng(seed, static_cast<std::uint64_t>(i * points + j), 0, Stream::source);
      double const size = std::sqrt(-std::log1p(-rng.uniform()) * law.spectrum(rho)) * step;
      f(i, j) = std::polar(size, 2 * pi * rng.uniform());
    }
  transform(f, false);
  return std::sqrt(2) * (points * points) * f.real();
}

// Share of the power of a Gaussian beam that the heights put at angles below the border, without the mirrored beam.
class ScatteredField {
 public:
  explicit ScatteredField(Eigen::MatrixXd const& h) : spectrum_(points, points) {
    for (int i = 0; i < points; ++i)
      for (int j = 0; j < points; ++j) {
        double const x = pitch * (i - points / 2), y = pitch * (j - points / 2);
        double const u = std::sqrt(2 / pi) / waist * std::exp(-(x * x + y * y) / (waist * waist));
        spectrum_(i, j) = u * (std::polar(1.0, 4 * pi * h(i, j)) - 1.0);
      }
    transform(spectrum_, true);
  }
  double below(double border) const {
    double sum = 0;
    for (int i = 0; i < points; ++i)
      for (int j = 0; j < points; ++j)
        if (std::hypot(alpha_of(i), alpha_of(j)) < border) sum += std::norm(spectrum_(i, j));
    return sum * pitch * pitch / (points * points);  // Parseval, over the unit power of the beam
  }

 private:
  Field spectrum_;
};

// Share that rays of the law carry beyond the border.
double rays_beyond(Roughness const& law, double border) {
  constexpr int histories = 1 << 18;
  int beyond = 0;
  Rng rng(31, 0, 0, Stream::direction);
  for (int i = 0; i < histories; ++i) {
    double const u = rng.uniform(), v = rng.uniform();
    Vec3 const out = law.sample({0, 0, 1}, u, v).wo;
    beyond += std::hypot(out.x, out.y) > border;
  }
  return law.albedo(1) * beyond / histories;
}

// 1 % of the total, which is that of eq. 3.10. The controls have a gap of a fifth of the border, or from a
// law of half the spectrum (a profile taken as one-sided).
TEST(diffraction_border, total_does_not_depend_on_the_border_r2_31) {
  Roughness const law = k_correlation(Theory::rayleigh_rice, rms, knee, tail);
  ScatteredField const field(heights(law, 31));
  double const total = field.below(0.05) + rays_beyond(law, 0.05);
  EXPECT_NEAR(total / tis_smooth(rms, 1, 1), 1, 0.03);
  for (double border : {0.1, 0.15, 0.2}) {
    double const other = field.below(border) + rays_beyond(law, border);
    EXPECT_NEAR(other / total, 1, 0.01) << border;
  }
  double const gap = field.below(0.05) + rays_beyond(law, 0.06),
               half = field.below(0.05) + 0.5 * rays_beyond(law, 0.05);
  double const far = field.below(0.2) + rays_beyond(law, 0.2);
  EXPECT_GT(std::fabs(gap / far - 1), 0.01);
  EXPECT_GT(std::fabs(half / far - 1), 0.01);
}

}  // namespace
}  // namespace straytrace::testing::optics_hand_over
