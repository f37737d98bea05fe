// SPDX-License-Identifier: BSD-3-Clause
#include "optics/mie.hpp"

#include <algorithm>
#include <cmath>

#include "base/functions.hpp"
#include "base/message.hpp"

namespace straytrace {
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

double intensity_at(Coefficients const& c, double cosine) {
  Complex128 s1 = 0, s2 = 0;
  double before = 0, now = 1;  // pi_n-1, pi_n
  for (std::size_t i = 0; i < c.a.size(); ++i) {
    double const n = double(i + 1), tau = n * cosine * now - (n + 1) * before, factor = (2 * n + 1) / (n * (n + 1));
    s1 += factor * (c.a[i] * now + c.b[i] * tau);
    s2 += factor * (c.a[i] * tau + c.b[i] * now);
    double const next = ((2 * n + 1) * cosine * now - (n + 1) * before) / n;
    before = now;
    now = next;
  }
  return (std::norm(s1) + std::norm(s2)) / 2;
}

}  // namespace

MieSphere mie(double x, std::complex<double> index, std::vector<double> const& cosines) {
  if (!(x > 0 && x <= 2e5)) throw NumericalError("Mie scatter: size parameter outside (0, 2e5]");
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
  for (double cosine : cosines) sphere.intensity.push_back(intensity_at(c, cosine));
  return sphere;
}

}  // namespace straytrace
