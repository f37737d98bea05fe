// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>

#include "base/math/linear_algebra.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "spectra/curve.hpp"
#include "spectra/spectrum.hpp"

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
  Eigen::VectorXcd const motion = solve(stiffness, Eigen::VectorXcd::Unit(n, n - 1));
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

namespace {

constexpr double gravitation = 6.67430e-11;  // m^3/(kg s^2)

struct Knot {
  double hz, value;
};

// Straight lines in log-log, constant outside.
double between(std::span<Knot const> knots, double hz) {
  if (hz <= knots.front().hz) return knots.front().value;
  for (std::size_t i = 1; i < knots.size(); ++i)
    if (hz <= knots[i].hz)
      return log_log_value(knots[i - 1].value, knots[i].value, log_share(hz, knots[i - 1].hz, knots[i].hz));
  return knots.back().value;
}

// Rough spectra of the platform, public code (gwinc), m/sqrt(Hz).
constexpr Knot platform[] = {{0.01, 3e-6}, {0.03, 1e-6}, {0.1, 2e-7}, {0.2, 2e-7}, {0.5, 8e-10},
                             {1, 1e-11},   {10, 3e-13},  {30, 3e-14}, {300, 3e-14}};
// Own noise of a six-axis seismometer (Mow-Lowry and Martynov 2019); ground below 10 mHz comes through.
constexpr Knot six_axes[] = {{0.01, 1e-7}, {0.03, 1e-9}, {0.1, 3e-11}, {0.2, 6e-12}, {0.5, 3e-13},
                             {1, 1e-13},   {10, 3e-14},  {100, 1e-14}, {300, 1e-14}};

double six_axis_asd(double hz) {
  double const leak = 100 / std::pow(1 + std::pow(hz / 0.01, 2), 2);  // |1/(1 + i f/10 mHz)^4|
  return std::hypot(between(six_axes, hz), leak * 10 * peterson_asd(GroundModel::low, hz));
}

// Pressure PSD of infrasound, Pa^2/Hz (Bowman, Baker and Bahavar 2005), as public code uses it.
constexpr Knot infrasound[] = {{0.01, 22.8},    {0.0155, 4},      {0.0239, 0.7},    {0.0367, 0.14},  {0.0567, 0.027},
                               {0.0874, 0.004}, {0.1345, 0.0029}, {0.2075, 0.0039}, {0.32, 7e-4},    {0.5, 1.44e-4},
                               {0.76, 0.37e-4}, {1.17, 0.12e-4},  {1.8, 0.56e-5},   {2.79, 0.35e-5}, {4.3, 0.26e-5},
                               {6.64, 0.24e-5}, {10, 2e-6},       {100, 2e-6}};

// Mean of `of`(angle) sin^3(angle) over [0, pi/2] times 3/2: Simpson's rule.
template <class F>
double over_directions(F const& of) {
  constexpr int n = 400;
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    double const angle = pi / 2 * i / n, weight = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * std::pow(std::sin(angle), 3) * of(std::sin(angle));
  }
  return 1.5 * sum * pi / 2 / n / 3;
}

double vertical_ground(Ground const& g, double hz) {
  double const low = std::pow(3, -g.abruptness * hz), at_knee = std::pow(3, -g.abruptness * g.knee);
  double const below = at_knee > 0 ? low / (low + at_knee) : hz < g.knee ? 1 : 0;
  return g.level * (below * (g.steeper ? g.knee / hz : 1) + (1 - below) * std::pow(g.knee / hz, 2));
}

}  // namespace

std::span<std::string_view const> platform_names() {
  static constexpr std::array<std::string_view, 8> names = {"BSC",     "6D",   "intermediate", "low",
                                                            "typical", "high", "quiet",        "virgo"};
  return names;
}

double platform_asd(std::string_view name, double hz) {
  if (name == "BSC") return between(platform, hz);
  if (name == "6D") return six_axis_asd(hz);
  if (name == "intermediate") return std::sqrt(between(platform, hz) * six_axis_asd(hz));
  if (name == "low") return peterson_asd(GroundModel::low, hz);
  if (name == "typical") return peterson_asd(GroundModel::typical, hz);
  if (name == "high") return peterson_asd(GroundModel::high, hz);
  if (name == "quiet") return 1e-7 / (hz * hz);
  if (name == "virgo") return 1e-6 / (hz * hz);
  return not_a_number;
}

double rayleigh_newtonian_psd(Ground const& g, double hz) {
  double const w = 2 * pi * hz, k = w / g.rayleigh_speed, kp = w / g.p_speed, ks = w / g.s_speed;
  double const qp = std::sqrt(k * k - kp * kp), qs = std::sqrt(k * k - ks * ks), zeta = std::sqrt(qp / qs);
  double const share = k * (1 - zeta) / (qp - k * zeta);  // of the density change at the surface
  double const pull = 2 * pi * gravitation * g.density * share * vertical_ground(g, hz) / (w * w) / g.subtraction;
  if (g.height >= 0) return std::pow(pull * std::exp(-g.height * k), 2);
  double const surface = -k * (1 + zeta) * std::exp(g.height * k),
               bulk = 2.0 / 3 * (2 * k * std::exp(g.height * qp) + zeta * qs * std::exp(g.height * qs));
  return 2 * std::pow(pull * (surface + bulk) / (k * (1 - zeta)), 2);
}

double body_wave_newtonian_psd(Ground const& g, double hz) {
  double const w = 2 * pi * hz, ground = peterson_asd(GroundModel::low, hz),
               pull = 2 * pi * gravitation * g.density / (w * w);
  auto const wave = [&](double level, double speed, bool pressure) {
    double const x = w / speed * std::fabs(g.height);
    bool const cavern = pressure && g.height < 0;
    double const seen =
        over_directions([&](double s) { return cavern ? std::pow(2 - std::exp(-x * s), 2) : std::exp(-2 * x * s); });
    return std::pow(pull * level * ground, 2) * seen;
  };
  return wave(g.p_level, g.p_speed, true) + wave(g.s_level, g.s_speed, false);
}

double infrasound_newtonian_psd(Air const& a, double hz) {
  double const w = 2 * pi * hz, k = w / a.sound_speed;
  double const pull = 4 * pi / (k * w * w) * gravitation * a.density / (a.adiabatic_index * a.pressure);
  return 2.0 / 3 * pull * pull * between(infrasound, hz);
}

double gas_scattering_psd(Detector const& d, GasSpecies const& gas, double hz) {
  Detector::Spots const beam = d.spots();
  double const kt = boltzmann * d.tube_temperature, speed = std::sqrt(2 * kt / gas.mass);  // most probable speed
  constexpr int n = 400;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double const z = d.arm_length * (i + 0.5) / n,
                 w = beam.waist * std::sqrt(1 + std::pow((z - beam.waist_position) / beam.rayleigh, 2));
    sum += std::exp(-2 * pi * hz * w / speed) / w;
  }
  return 4 * std::pow(2 * pi * gas.polarisability, 2) / (speed * kt) * gas.tube_pressure * sum * d.arm_length / n;
}

double gas_damping_force_psd(Detector const& d, GasSpecies const& gas, double temperature) {
  double const kt = boltzmann * temperature, r = d.mirror_radius;
  double const friction = pi * r * r * gas.chamber_pressure / std::sqrt(kt / gas.mass) * std::sqrt(8 / pi) *
                          (1 + d.mirror_thickness / (2 * r) + pi / 4);
  return 4 * kt * friction;
}

}  // namespace straytrace::noise
