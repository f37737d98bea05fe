// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>

#include <cmath>

#include "noise/fundamental/fundamental.hpp"

namespace straytrace::noise {
namespace {

using Complex = std::complex<double>;

struct Wire {
  double section, end_section, inertia;  // m^2, m^2, m^4 at the bending point
  double surface_stretch, surface_bend;  // surface to volume, weighted by strain energy, 1/m
};

// Gretarsson and Harry 1999 (round), Gretarsson et al. 2000 (ribbons).
Wire wire_of(SuspensionStage const& s) {
  double const r = s.wire_radius;
  Wire w{pi * r * r, pi * r * r, pi * std::pow(r, 4) / 4, 2 / r, 4 / r};
  if (std::isfinite(s.ribbon_thickness)) {
    double const t = s.ribbon_thickness, perimeter = 2 * (r + t) / (r * t);
    w = {r * t, r * t, r * t * t * t / 12, perimeter, perimeter * (3 * s.wires * r + t) / (s.wires * r + t)};
  } else if (std::isfinite(s.end_radius)) {
    w.end_section = pi * s.end_radius * s.end_radius;
    w.inertia = pi * std::pow(s.end_radius, 4) / 4;
    w.surface_bend = 4 / s.end_radius;
  }
  return w;
}

double debye(double strength, double time, double w) { return strength * w * time / (1 + std::pow(w * time, 2)); }

// Loss angle of bending: bulk, surface, thermo-elastic with the part of the tension (Cagnoli and Willems 2002).
double bending_loss(SuspensionStage const& s, Wire const& wire, WireMaterial const& m, double temperature,
                    double tension, double w) {
  double const per_volume = m.density * m.heat_capacity;
  double const time = std::isfinite(s.ribbon_thickness)
                          ? per_volume * std::pow(s.ribbon_thickness / pi, 2) / m.conductivity
                          : 0.0737 * per_volume * 4 * wire.end_section / (pi * m.conductivity);  // Zener 1938
  double const expansion = m.expansion - tension * m.modulus_slope / (wire.end_section * m.young);
  return m.loss * (1 + wire.surface_bend * m.surface_depth) +
         debye(expansion * expansion * m.young * temperature / per_volume, time, w);
}

double blade_loss(SuspensionStage const& s, double w) {
  WireMaterial const& m = s.blades;
  double const per_volume = m.density * m.heat_capacity;
  double const time = per_volume * std::pow(s.blade / pi, 2) / m.conductivity;
  return m.loss + debye(m.young * m.expansion * m.expansion * s.upper_temperature / per_volume, time, w);
}

// Spring between a mass and its support; its losses at the upper and the lower joints.
struct Spring {
  Complex constant;             // N/m
  double upper = 0, lower = 0;  // imaginary parts, N/m
};

Spring horizontal(SuspensionStage const& s, double weight, bool last, double w) {
  Wire const wire = wire_of(s);
  double const tension = weight / s.wires;
  double const upper = bending_loss(s, wire, s.upper, s.upper_temperature, tension, w),
               lower = bending_loss(s, wire, s.lower, s.temperature, tension, w);
  if (!last) {
    double const bend = std::sqrt(s.lower.young * wire.inertia / tension), k = weight / s.length,
                 dilution = std::isfinite(s.dilution) ? s.dilution : s.length / bend;
    Spring spring{k, k * upper / dilution / 2, k * lower / dilution / 2};
    spring.constant += Complex(0, spring.upper + spring.lower);
    return spring;
  }
  // Stiff string under tension, Gonzalez 2000 eq. 8 and 9.
  double const k = std::sqrt(s.lower.density * wire.section / tension) * w;
  Complex const bend = std::sqrt(s.lower.young * Complex(1, (upper + lower) / 2) * wire.inertia / tension);
  double const c = std::cos(k * s.length), sn = std::sin(k * s.length);
  Complex const constant = weight * k * (c + k * bend * sn) / (sn - 2.0 * k * bend * c);
  double const share = upper / (upper + lower);
  return {constant, share * constant.imag(), (1 - share) * constant.imag()};
}

// Longitudinal wave in N fibres; tapered ones are three in series.
Complex stretch(SuspensionStage const& s, Wire const& wire, double w) {
  Complex const young = s.lower.young * Complex(1, s.lower.loss * (1 + wire.surface_stretch * s.lower.surface_depth));
  Complex const k = std::sqrt(s.lower.density / young) * w;
  auto const part = [&](double section, double length) { return s.wires * section * young * k / std::tan(k * length); };
  if (!std::isfinite(s.end_length)) return part(wire.section, s.length);
  return 1.0 / (2.0 / part(wire.end_section, s.end_length) + 1.0 / part(wire.section, s.length - 2 * s.end_length));
}

Spring vertical(SuspensionStage const& s, bool last, double w) {
  bool const blades = std::isfinite(s.vertical_spring);
  Complex constant =
      blades ? s.vertical_spring * Complex(1, std::isfinite(s.blade) ? blade_loss(s, w) : s.blades.loss) : 0.0;
  if (last || !blades) {
    Complex const fibres = stretch(s, wire_of(s), w);
    constant = blades ? 1.0 / (1.0 / fibres + 1.0 / constant) : fibres;
  }
  return {constant, constant.imag(), 0};
}

}  // namespace

ChainResponse chain_response(SuspensionChain const& chain, Direction direction, double hz) {
  double const w = 2 * pi * hz;
  auto const n = Eigen::Index(chain.stages.size());
  std::vector<Spring> springs(chain.stages.size());
  double weight = 0;
  for (std::size_t i = chain.stages.size(); i-- > 0;) {
    SuspensionStage const& s = chain.stages[i];
    bool const last = i + 1 == chain.stages.size();
    weight += s.mass * standard_gravity;
    springs[i] = direction == Direction::horizontal ? horizontal(s, weight, last, w) : vertical(s, last, w);
  }
  Eigen::MatrixXcd stiffness = Eigen::MatrixXcd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    stiffness(i, i) += springs[std::size_t(i)].constant - w * w * chain.stages[std::size_t(i)].mass;
    if (i == 0) continue;
    stiffness(i - 1, i - 1) += springs[std::size_t(i)].constant;
    stiffness(i - 1, i) -= springs[std::size_t(i)].constant;
    stiffness(i, i - 1) -= springs[std::size_t(i)].constant;
  }
  // Motion of all masses per force on the test mass; by reciprocity also of the test mass per force on any.
  Eigen::VectorXcd const motion = stiffness.partialPivLu().solve(Eigen::VectorXcd::Unit(n, n - 1));
  ChainResponse r{springs[0].constant * motion[0], motion[n - 1], 0};
  for (Eigen::Index i = 0; i < n; ++i) {  // a lossy spring of temperature T pulls at both ends with 4 kT Im(k)/w
    SuspensionStage const& s = chain.stages[std::size_t(i)];
    Spring const& spring = springs[std::size_t(i)];
    double const opened = std::norm(motion[i] - (i > 0 ? motion[i - 1] : 0.0));
    r.thermal_psd += 4 * boltzmann / w * (s.upper_temperature * spring.upper + s.temperature * spring.lower) * opened;
  }
  return r;
}

double suspension_thermal_psd(SuspensionChain const& chain, double hz) {
  return chain_response(chain, Direction::horizontal, hz).thermal_psd +
         std::pow(chain.vertical_coupling, 2) * chain_response(chain, Direction::vertical, hz).thermal_psd;
}

double seismic_transfer_squared(SuspensionChain const& chain, double hz) {
  return std::norm(chain_response(chain, Direction::horizontal, hz).from_top) +
         std::norm(chain.vertical_coupling * chain_response(chain, Direction::vertical, hz).from_top);
}

}  // namespace straytrace::noise
