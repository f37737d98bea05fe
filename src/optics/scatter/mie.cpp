// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/mie.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "base/math/functions.hpp"
#include "base/process/threads.hpp"

namespace straytrace::optics {
namespace {

using Complex128 = std::complex<double>;

struct Coefficients {
  std::vector<Complex128> a, b;  // of order n at n - 1
};

// Logarithmic derivatives of the Riccati-Bessel function of z by downward recurrence, stable for any z.
std::vector<Complex128> logarithmic_derivatives(Complex128 z, std::size_t orders) {
  std::size_t const start = std::max(orders, std::size_t(std::abs(z))) + 16;
  std::vector<Complex128> d(start + 1);
  for (std::size_t n = start; n > 0; --n) {
    Complex128 const ratio = double(n) / z;
    d[n - 1] = ratio - 1.0 / (d[n] + ratio);
  }
  return d;
}

Coefficients coefficients(double x, Complex128 m) {
  if (!(x > 0 && x <= 2e5)) throw NumericalError("Mie scatter: size parameter outside (0, 2e5]");
  auto const orders = std::size_t(x + 4.05 * std::cbrt(x) + 2);
  auto const d = logarithmic_derivatives(m * x, orders);
  Coefficients c;
  SinCos const start = sincos_turn(x / (2 * pi));
  double psi0 = start.cos, psi1 = start.sin, chi0 = -start.sin, chi1 = start.cos;
  for (std::size_t n = 1; n <= orders; ++n) {
    double const k = double(2 * n - 1) / x, psi = k * psi1 - psi0, chi = k * chi1 - chi0;
    Complex128 const xi(psi, -chi), xi1(psi1, -chi1);
    Complex128 const electric = d[n] / m + double(n) / x, magnetic = m * d[n] + double(n) / x;
    c.a.push_back((electric * psi - psi1) / (electric * xi - xi1));
    c.b.push_back((magnetic * psi - psi1) / (magnetic * xi - xi1));
    psi0 = psi1;
    psi1 = psi;
    chi0 = chi1;
    chi1 = chi;
  }
  return c;
}

// Sum over spheres of number times (|S1|^2 + |S2|^2)/2 at these cosines, eight at once: S1 + S2 is the sum over n of
// (2n + 1)/(n (n + 1)) (a + b) (pi + tau), S1 - S2 that of (a - b) (pi - tau).
constexpr std::size_t lanes = 8;
struct Angular {
  double plus[lanes], minus[lanes];  // pi_n + tau_n, pi_n - tau_n
};
struct Sphere {
  double number;
  std::vector<Complex128> sum, difference;  // with their factors
};

Sphere sphere_of(Coefficients const& c, double number) {
  Sphere sphere{number, {}, {}};
  for (std::size_t i = 0; i < c.a.size(); ++i) {
    double const n = double(i + 1), factor = (2 * n + 1) / (n * (n + 1));
    sphere.sum.push_back(factor * (c.a[i] + c.b[i]));
    sphere.difference.push_back(factor * (c.a[i] - c.b[i]));
  }
  return sphere;
}

void fill_angular(double const* cosine, std::vector<Angular>& all) {
  double before[lanes] = {}, now[lanes];  // pi_n-1, pi_n
  std::fill_n(now, lanes, 1.0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    double const n = double(i + 1), inverse = 1 / n;
    for (std::size_t k = 0; k < lanes; ++k) {
      double const tau = n * cosine[k] * now[k] - (n + 1) * before[k];
      double const after = ((2 * n + 1) * cosine[k] * now[k] - (n + 1) * before[k]) * inverse;
      all[i].plus[k] = now[k] + tau;
      all[i].minus[k] = now[k] - tau;
      before[k] = now[k];
      now[k] = after;
    }
  }
}

void add_intensity(Sphere const& sphere, std::vector<Angular> const& angular, double* out) {
  double s[4][lanes] = {};
  for (std::size_t i = 0; i < sphere.sum.size(); ++i) {
    Angular const& at = angular[i];
    double const re = sphere.sum[i].real(), im = sphere.sum[i].imag(), re2 = sphere.difference[i].real(),
                 im2 = sphere.difference[i].imag();
    for (std::size_t k = 0; k < lanes; ++k) {
      s[0][k] += re * at.plus[k];
      s[1][k] += im * at.plus[k];
      s[2][k] += re2 * at.minus[k];
      s[3][k] += im2 * at.minus[k];
    }
  }
  for (std::size_t k = 0; k < lanes; ++k)
    out[k] += sphere.number * (s[0][k] * s[0][k] + s[1][k] * s[1][k] + s[2][k] * s[2][k] + s[3][k] * s[3][k]) / 4;
}

std::vector<double> intensities(std::vector<Sphere> const& spheres, std::vector<double> const& cosines) {
  std::size_t orders = 0;
  for (Sphere const& s : spheres) orders = std::max(orders, s.sum.size());
  std::vector<double> all(cosines.size());
  in_parallel((cosines.size() + lanes - 1) / lanes, 0, [&](std::size_t part) {
    std::size_t const start = part * lanes, filled = std::min(lanes, cosines.size() - start);
    double cosine[lanes] = {}, sum[lanes] = {};
    std::copy_n(&cosines[start], filled, cosine);
    std::vector<Angular> angular(orders);
    fill_angular(cosine, angular);
    for (Sphere const& s : spheres) add_intensity(s, angular, sum);
    std::copy_n(sum, filled, &all[start]);
  });
  return all;
}

// The next number of steps from `degree` on that is 2^k or 3 2^k, so that spheres of similar size share one grid.
std::size_t steps_for(std::size_t degree) {
  for (std::size_t steps = 8;; steps *= 2) {
    if (steps >= degree) return steps;
    if (3 * steps / 2 >= degree) return 3 * steps / 2;
  }
}

double cosine_of_step(std::size_t i, std::size_t steps) { return sincos_turn(double(i) / double(2 * steps)).cos; }

// Adds the cosine series of the even function with these values at even steps of Theta from 0 to 180 deg.
void add_series(std::vector<double> const& values, std::vector<double>& series) {
  std::size_t const steps = values.size() - 1;
  std::vector<double> cosine(2 * steps);
  for (std::size_t i = 0; i < cosine.size(); ++i) cosine[i] = cosine_of_step(i, steps);
  if (series.size() <= steps) series.resize(steps + 1);
  in_parallel(steps + 1, 0, [&](std::size_t l) {
    double sum = 0.5 * (values[0] + (l % 2 ? -values[steps] : values[steps]));
    std::size_t turn = 0;
    for (std::size_t i = 1; i < steps; ++i) {
      turn += l;
      if (turn >= 2 * steps) turn -= 2 * steps;
      sum += values[i] * cosine[turn];
    }
    series[l] += (l == 0 || l == steps ? 1 : 2) * sum / double(steps);
  });
}

}  // namespace

MieSphere mie(double x, std::complex<double> index, std::vector<double> const& cosines) {
  Coefficients const c = coefficients(x, index);
  MieSphere sphere;
  double cosine_sum = 0;
  for (std::size_t i = 0; i < c.a.size(); ++i) {
    double const n = double(i + 1);
    sphere.q_ext += (2 * n + 1) * (c.a[i] + c.b[i]).real();
    sphere.q_sca += (2 * n + 1) * (std::norm(c.a[i]) + std::norm(c.b[i]));
    cosine_sum += (2 * n + 1) / (n * (n + 1)) * (c.a[i] * std::conj(c.b[i])).real();
    if (i + 1 < c.a.size())
      cosine_sum += n * (n + 2) / (n + 1) * (c.a[i] * std::conj(c.a[i + 1]) + c.b[i] * std::conj(c.b[i + 1])).real();
  }
  sphere.q_ext *= 2 / (x * x);
  sphere.q_sca *= 2 / (x * x);
  sphere.asymmetry = 4 / (x * x) * cosine_sum / sphere.q_sca;
  sphere.intensity = intensities({sphere_of(c, 1)}, cosines);
  return sphere;
}

std::vector<double> mie_series(std::vector<SphereNumber> const& spheres, std::complex<double> index) {
  std::map<std::size_t, std::vector<Sphere>> by_steps;  // of their grid
  for (SphereNumber const& sphere : spheres) {
    Coefficients const c = coefficients(sphere.x, index);
    std::size_t const degree = 2 * c.a.size();  // of the intensity as a polynomial in the cosine
    by_steps[steps_for(degree)].push_back(sphere_of(c, sphere.number));
  }
  std::vector<double> series;
  for (auto const& [steps, some] : by_steps) {
    std::vector<double> cosines;
    for (std::size_t i = 0; i <= steps; ++i) cosines.push_back(cosine_of_step(i, steps));
    add_series(intensities(some, cosines), series);
  }
  return series;
}

}  // namespace straytrace::optics
