// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/mirror_thermal.hpp"

#include <cmath>
#include <complex>

namespace straytrace {

BesselZeros const& bessel_zeros() {
  static BesselZeros const table = [] {
    BesselZeros b;
    for (int m = 1; m <= 300; ++m) {
      double x = (m + 0.25) * pi;
      x -= 3 / (8 * x);  // McMahon's expansion, then Newton: J1' = J0 - J1/x
      for (int i = 0; i < 4; ++i) {
        double const j1 = std::cyl_bessel_j(1, x);
        x -= j1 / (std::cyl_bessel_j(0, x) - j1 / x);
      }
      b.zero.push_back(x);
      b.j0.push_back(std::cyl_bessel_j(0, x));
    }
    return b;
  }();
  return table;
}

double strain_energy(SubstrateMaterial const& m, MirrorShape shape, double w) {
  double const a = shape.radius, h = shape.thickness, r0 = w / std::sqrt(2);
  BesselZeros const& b = bessel_zeros();
  double edge = 0, bulk = 0;
  for (std::size_t i = 0; i < b.zero.size(); ++i) {
    double const zeta = b.zero[i], kh = zeta * h / a, q = std::exp(-2 * kh);
    double const u = ((1 - q) * (1 + q) + 4 * kh * q) / (std::pow(1 - q, 2) - 4 * kh * kh * q);  // Liu, Thorne eq. 53
    double const gauss = std::exp(-std::pow(zeta * r0 / a, 2) / 4);
    edge += gauss / (zeta * zeta * b.j0[i]);
    bulk += u * gauss * gauss / (zeta * b.j0[i] * b.j0[i]);
  }
  double const sum =
      std::pow(h / a, 4) + 12 * std::pow(h / a, 2) * m.poisson * edge + 72 * (1 - m.poisson) * edge * edge;
  return bulk * (1 - m.poisson * m.poisson) / (pi * a * m.young) + sum * a * a / (6 * pi * h * h * h * m.young);
}

double substrate_brownian_psd(SubstrateMaterial const& m, MirrorShape shape, double w, double hz) {
  double const angle = m.loss * std::pow(hz, m.loss_exponent);
  double const surface =
      m.surface_loss * (1 - 2 * m.poisson) / ((1 - m.poisson) * m.young * pi * w * w);  // losses of a thin front layer
  return 8 * boltzmann * m.temperature / (2 * pi * hz) * (strain_energy(m, shape, w) * angle + surface);
}

namespace {

// Integral over [0, 8] of u^2 exp(-u^2/2) (1 - Re(u/sqrt(u^2 + i x))) times sqrt(2/pi), Simpson's rule: what the flow
// of heat during a period leaves of adiabatic thermo-elastic noise (Cerdonio et al. 2001, eq. 20, one integral done).
double heat_flow(double x) {
  constexpr int n = 400;
  double sum = 0;
  for (int i = 1; i < n; ++i) {
    double const u = 8.0 * i / n;
    double const stays = 1 - (u / std::sqrt(std::complex<double>(u * u, x))).real();
    sum += (i % 2 == 1 ? 4 : 2) * u * u * std::exp(-u * u / 2) * stays;
  }
  return std::sqrt(2 / pi) * sum * 8 / n / 3;
}

}  // namespace

double substrate_thermoelastic_psd(SubstrateMaterial const& m, MirrorShape shape, double w, double hz) {
  double const a = shape.radius, h = shape.thickness, r0 = w / std::sqrt(2), volume_heat = m.heat_capacity * m.density;
  double const half_space = 8 * std::pow((1 + m.poisson) * m.expansion * m.temperature / volume_heat, 2) * boltzmann *
                            m.conductivity / (std::sqrt(2 * pi) * r0 * r0 * r0);  // times 1/w^2, Liu, Thorne eq. 18
  BesselZeros const& b = bessel_zeros();
  double sum = 0, bend = 0;
  for (std::size_t i = 0; i < b.zero.size(); ++i) {
    double const k = b.zero[i] / a, kh = k * h, q = std::exp(-2 * kh);
    double const pressure = std::exp(-std::pow(k * r0, 2) / 4) / (pi * a * a * b.j0[i]);  // times J0, eq. 37
    double const shape_of = (1 - q) * ((1 - q) * (1 + q) + 8 * kh * q) + 4 * kh * kh * q * (1 + q);
    sum += shape_of * k * pressure * pressure * (1 - q) / std::pow(std::pow(1 - q, 2) - 4 * kh * kh * q, 2);
    bend += pressure / (b.zero[i] * b.zero[i]);
  }
  double const c1 = -12 * a * a * bend / (h * h * h) + 1 / (2 * pi * a * a * h);
  double const finite = (sum + h * std::pow(c1 / (1 + m.poisson), 2)) * std::pow(std::sqrt(2 * pi) * r0, 3) * a * a;
  double const omega = 2 * pi * hz;  // finite: eq. 46, 1 for a half space
  return half_space * finite / (omega * omega) * heat_flow(omega * volume_heat * r0 * r0 / m.conductivity);
}

double substrate_thermorefractive_psd(SubstrateMaterial const& m, double thickness, double w, double hz) {
  double const r0 = w / std::sqrt(2), x = pi * hz * r0 * r0 * m.density * m.heat_capacity / m.conductivity;
  // Re(e^{ix} E1(ix)), the integral of t e^{-t}/(t^2 + x^2), over u = ln t; 1/x^2 for large x.
  double sum = 0;
  constexpr double step = 0.01;
  for (double u = -30; u < 5; u += step) {
    double const t = std::exp(u);
    sum += step * t * t * std::exp(-t) / (t * t + x * x);
  }
  return thickness * std::pow(m.index_slope * m.temperature, 2) * boltzmann / (pi * m.conductivity) * sum;
}

}  // namespace straytrace
