// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "base/errors.hpp"
#include "noise/fundamental/fundamental.hpp"

namespace straytrace::noise {
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

// Integral over [0, 8] of u^2 exp(-u^2/2) (1 - Re(u/sqrt(u^2 + i x))) times sqrt(2/pi), Simpson's rule: reduction
// of adiabatic thermo-elastic noise by heat flow during a period (Cerdonio et al. 2001, eq. 20, one integral done).
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

namespace {

double transmission(CoatingStack const& s) { return 1 - std::norm(reflection(s).amplitude); }

std::vector<double> doublets(std::size_t count, CoatedMirror const& mirror) {
  std::vector<double> layers;
  for (std::size_t i = 0; i < count; ++i) {
    layers.push_back(i == 0 ? mirror.cap : mirror.low_layer);
    layers.push_back(0.5 - mirror.low_layer);
  }
  return layers;
}

// Sums over the layers of both materials.
struct Averages {
  double low = 0, high = 0;  // m
  explicit Averages(CoatingStack const& s) {
    for (std::size_t i = 0; i < s.layers.size(); ++i) (i % 2 == 0 ? low : high) += s.thickness(i);
  }
  double total() const { return low + high; }
  double mean(double of_low, double of_high) const { return (of_low * low + of_high * high) / total(); }
};

// Bending of the mirror and the reduced motion of the coating: Braginsky and Vyatchanin 2003, eq. 60 to 92.
double finite_mirror(CoatingStack const& s, MirrorShape shape, double w) {
  Averages const sums(s);
  SubstrateMaterial const& m = s.substrate;
  double const r0 = w / std::sqrt(2), a = shape.radius, h = shape.thickness, sigma = m.poisson;
  auto const mean = [&](auto const& of) { return sums.mean(of(s.low), of(s.high)); };
  double const heat = mean([](CoatingMaterial const& c) { return c.heat_capacity; }) / (m.heat_capacity * m.density);
  double const x =
      mean([](CoatingMaterial const& c) { return c.expansion * (1 + c.poisson) / (1 - c.poisson); }) / m.expansion;
  double const y =
      mean([](CoatingMaterial const& c) { return c.expansion * c.young / (1 - c.poisson); }) / (m.expansion * m.young);
  double const z = mean([](CoatingMaterial const& c) { return 1 / (1 - c.poisson); });
  BesselZeros const& b = bessel_zeros();
  double s1 = 0, s2 = 0;
  for (std::size_t i = 0; i < b.zero.size(); ++i) {
    double const k = b.zero[i] / a, kh = k * h, q = std::exp(-2 * kh), p = std::exp(-k * k * r0 * r0 / 4) / b.j0[i];
    double const l = x - z * (1 + sigma) +
                     (y * (1 - 2 * sigma) + z - 2 * heat) * (1 + sigma) * std::pow(1 - q, 2) /
                         (std::pow(1 - q, 2) - 4 * kh * kh * q);
    s1 += p / (b.zero[i] * b.zero[i]);
    s2 += p * p * l * l;
  }
  s1 *= 12 * a * a / (h * h);
  double const power = std::pow(x - 2 * sigma * y - heat + s1 * (heat - y * (1 - sigma)), 2) + s2;
  double const half_space = -heat + (x / (1 + sigma) + y * (1 - 2 * sigma)) / 2;
  return std::sqrt(r0 * r0 * power / (2 * a * a * std::pow((1 + sigma) * half_space, 2)));
}

}  // namespace

StackReflection reflection(CoatingStack const& s) {
  std::size_t const n = s.layers.size();
  auto const index = [&](std::size_t i) { return i == n ? s.substrate.index : s.material(i).index; };
  std::vector<std::complex<double>> below(n), slope(n);  // what comes back to the top of a layer; d rho/d below
  std::complex<double> rho = (index(n - 1) - index(n)) / (index(n - 1) + index(n));
  for (std::size_t i = n; i-- > 0;) {
    double const above = i == 0 ? 1 : index(i - 1), r = (above - index(i)) / (above + index(i));
    below[i] = std::polar(1.0, 4 * pi * s.layers[i]) * rho;
    rho = (r + below[i]) / (1.0 + r * below[i]);
    slope[i] = (1 - r * r) / std::pow(1.0 + r * below[i], 2);
  }
  StackReflection out{rho, {}};
  std::complex<double> chain = 1.0 / rho;
  for (std::size_t i = 0; i < n; ++i) {
    chain *= slope[i];
    out.log_slope.push_back(std::complex<double>(0, 2) * below[i] * chain);
    chain *= std::polar(1.0, 4 * pi * s.layers[i]);
  }
  return out;
}

CoatingStack coating_stack(Detector const& d, CoatedMirror const& mirror) {
  CoatingStack s{mirror.layers, d.coating->low, d.coating->high, *d.substrate, d.wavelength};
  if (!s.layers.empty()) return s;
  for (std::size_t count = 1; count < 200; ++count) {
    s.layers = doublets(count, mirror);
    if (transmission(s) > mirror.transmission) continue;
    double thin = 0, thick = s.layers.back();
    for (int i = 0; i < 60; ++i) {
      double const middle = (thin + thick) / 2;
      s.layers.back() = middle;
      (transmission(s) > mirror.transmission ? thin : thick) = middle;
    }
    return s;
  }
  throw NumericalError("no coating of up to 200 doublets reaches the transmission");
}

double coating_brownian_psd(CoatingStack const& s, double w, double hz) {
  StackReflection const light = reflection(s);
  SubstrateMaterial const& m = s.substrate;
  double const base = (1 - m.poisson - 2 * m.poisson * m.poisson) / m.young;
  double sum = 0;
  for (std::size_t i = 0; i < s.layers.size(); ++i) {
    CoatingMaterial const& c = s.material(i);
    double const p = c.poisson,
                 phase_sensitivity = 1 - c.index * light.log_slope[i].imag() / 2;  // 1 - Im(eps)/2, eq. 25
    // Table I of the paper: change of thickness and of the height of the surface, by bulk and shear losses.
    double const thick_bulk = std::sqrt((1 + p) / 2), thick_shear = std::sqrt(1 - 2 * p);
    double const high_bulk = base * c.young / std::sqrt(2 * (1 + p)), high_shear = -base * c.young / (2 * thick_shear),
                 high_across = std::sqrt(3) * (1 - p) * base * c.young / (2 * thick_shear * (1 + p));
    double const seen = std::pow(high_bulk + thick_bulk * phase_sensitivity, 2) +
                        std::pow(high_shear + thick_shear * phase_sensitivity, 2) + high_across * high_across;
    sum += s.thickness(i) * c.loss_at(hz) * (1 - p - 2 * p * p) / (c.young * (1 - p) * (1 - p)) * seen;
  }
  return 4 * boltzmann * m.temperature / (3 * pi * hz * pi * w * w) * sum;  // eq. 94 and 96
}

CoatingThermoOptic::CoatingThermoOptic(CoatingStack const& s, MirrorShape shape, double w)
    : substrate_(s.substrate), w_(w) {
  Averages const sums(s);
  SubstrateMaterial const& m = s.substrate;
  thickness_ = sums.total();
  heat_ = sums.mean(s.low.heat_capacity, s.high.heat_capacity);
  conductivity_ = 1 / sums.mean(1 / s.low.conductivity, 1 / s.high.conductivity);
  StackReflection const light = reflection(s);
  elastic_ = -2 * m.expansion * (1 + m.poisson) * heat_ / (m.heat_capacity * m.density) * thickness_;
  refractive_ = 0;
  for (std::size_t i = 0; i < s.layers.size(); ++i) {
    CoatingMaterial const& c = s.material(i);
    double const held = (1 + m.poisson) / (1 - c.poisson) *
                        ((1 + c.poisson) / (1 + m.poisson) + (1 - 2 * m.poisson) * c.young / m.young);
    double const stress = c.expansion * (1 + c.poisson) / (1 - c.poisson);
    elastic_ += c.expansion * held * s.thickness(i);
    refractive_ -= light.log_slope[i].imag() / 2 * (c.index_slope + stress * c.index) * s.thickness(i);
  }
  elastic_ *= finite_mirror(s, shape, w);
}

double CoatingThermoOptic::psd(double hz) const {
  double const w = 2 * pi * hz, volume_heat = substrate_.heat_capacity * substrate_.density;
  double const depth = std::sqrt(2 * substrate_.conductivity / (volume_heat * w));
  double const kelvin = 4 * boltzmann * std::pow(substrate_.temperature / w_, 2) / (pi * w * volume_heat * depth);
  double const r = std::sqrt(heat_ * conductivity_ / (volume_heat * substrate_.conductivity)),
               xi = thickness_ * std::sqrt(2 * w * heat_ / conductivity_);
  double const s = std::sin(xi), c = std::cos(xi), sh = std::sinh(xi), ch = std::cosh(xi);
  double const g0 = 2 * (sh - s) + 2 * r * (ch - c),
               g1 = 8 * std::sin(xi / 2) * (r * std::cosh(xi / 2) + std::sinh(xi / 2)),
               g2 = (1 + r * r) * sh + (1 - r * r) * s + 2 * r * ch,
               gd = (1 + r * r) * ch + (1 - r * r) * c + 2 * r * sh;
  double const sum = elastic_ * elastic_ * g0 + elastic_ * refractive_ * xi * g1 + std::pow(refractive_ * xi, 2) * g2;
  return kelvin * sum / (r * xi * xi * gd);
}

}  // namespace straytrace::noise
