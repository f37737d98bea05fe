// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/quantum.hpp"

#include <Eigen/LU>

#include <cmath>

#include "ifo/linear_response.hpp"

namespace straytrace {
namespace {

// The network of a detector, and the ports that the read-out needs.
struct Recycled {
  Network network;
  ComponentId end_x, end_y;  // differential motion: x - y
  std::uint32_t output = 0;  // where the light of the dark port is detected
  std::uint32_t dark = 0;    // where the vacuum comes in from outside
};

// Loses a share of the power of what passes, both ways.
ComponentId add_loss(Network& n, char const* name, double share) {
  double const transmission = 1 - share;
  return n.add_mirror(name, {.transmission = transmission, .loss = 1 - transmission});
}

Recycled built(Detector const& d, bool free, double laser_power) {
  Recycled r{Network(d.wavelength), {}, {}, 0, 0};
  Network& n = r.network;
  Suspension held;
  if (free) {
    held.mass = d.mirror_mass;
    if (d.suspension) held.resonance = std::sqrt(9.80665 / d.suspension->stages.back().length) / (2 * pi);
  }
  MirrorParameters const input{.transmission = d.input.transmission, .loss = d.mirror_loss, .suspension = held},
      end{.transmission = d.end.transmission, .loss = d.mirror_loss, .suspension = held};
  ComponentId const laser = n.add_laser("laser", laser_power),
                    recycling = n.add_mirror("PRM", {.transmission = d.power_recycling}),
                    splitter = n.add_splitter("BS", {.transmission = 0.5}), in_x = n.add_mirror("IX", input),
                    in_y = n.add_mirror("IY", input), lossy = add_loss(n, "signal cavity", d.signal_loss / 2),
                    signal = n.add_mirror("SRM", {.transmission = d.signal_recycling}),
                    detection = add_loss(n, "detection", 1 - d.detection_efficiency), diode = n.add_dump("diode");
  r.end_x = n.add_mirror("EX", end);
  r.end_y = n.add_mirror("EY", end);
  n.link({laser, 0}, {recycling, 0}, 0);
  n.link({recycling, 1}, {splitter, 0}, 0);
  n.link({splitter, 2}, {in_x, 0}, 0);
  n.link({splitter, 1}, {in_y, 0}, 0, pi / 2);  // the other arm is a quarter wave longer: the dark port is dark
  n.link({in_x, 1}, {r.end_x, 0}, d.arm_length, pi / 2);  // resonant: both ends reflect i r
  n.link({in_y, 1}, {r.end_y, 0}, d.arm_length, pi / 2);
  n.link({splitter, 3}, {lossy, 0}, d.signal_length, -d.signal_detuning / 2);  // sign: as public budgets count
  n.link({lossy, 1}, {signal, 0}, 0);
  n.link({signal, 1}, {detection, 0}, 0);
  n.link({detection, 1}, {diode, 0}, 0);
  r.output = n.number_of({diode, 0});
  r.dark = n.number_of({signal, 1});
  return r;
}

// The carrier is resonant in the arms and in the recycling cavity, the dark port dark. `free` mirrors move. The power
// in the arms is that of the detector.
Recycled network_of(Detector const& d, bool free) {
  Recycled const r = built(d, free, 1);
  double const one_watt = SteadyField(r.network).power_in(r.network.number_of({r.end_x, 0}));
  return built(d, free, d.circulating_power() / one_watt);
}

// Squeezing as it reaches the dark port: covariance of the two quadratures over that of the vacuum, at one frequency.
// First quadrature: the one in which the signal leaves.
Eigen::Matrix2cd rotation(double angle) {
  Eigen::Matrix2cd m;
  m << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return m;
}

Eigen::Matrix2cd in_quadratures(Phasor upper, Phasor lower) {  // both sidebands, the lower one conjugated
  Phasor const i{0, 1};
  Phasor const sum = (upper + lower) / 2.0, difference = i * (upper - lower) / 2.0;
  Eigen::Matrix2cd m;
  m << sum, difference, -difference, sum;
  return m;
}

Eigen::Matrix2cd after_cavity(FilterCavity const& c, double hz, Eigen::Matrix2cd const& before) {
  double const r1 = std::sqrt(1 - c.input_transmission), r2 = std::sqrt(1 - c.end_transmission),
               round = r1 * r2 * std::sqrt(1 - c.loss);
  struct Answer {
    Phasor reflected, from_end, from_loss;
  };
  auto const answer = [&](double sideband) {
    double const phase = 4 * pi * (sideband - c.detuning) * c.length / speed_of_light;
    Phasor const turn = std::polar(1.0, phase), gain = 1.0 / (1.0 - round * turn), half = std::polar(1.0, phase / 2);
    return Answer{r1 - r2 * c.input_transmission * turn * gain,
                  std::sqrt(c.input_transmission * c.end_transmission) * half * gain,
                  std::sqrt(c.input_transmission * c.loss) * half * gain};
  };
  Answer const u = answer(hz), l = answer(-hz);
  Eigen::Matrix2cd const f = in_quadratures(u.reflected, std::conj(l.reflected)),
                         e = in_quadratures(u.from_end, std::conj(l.from_end)),
                         s = in_quadratures(u.from_loss, std::conj(l.from_loss)), turned = rotation(c.rotation);
  return turned * (f * before * f.adjoint() + e * e.adjoint() + s * s.adjoint()) * turned.adjoint();
}

Eigen::Matrix2cd covariance(Squeezer const& q, double hz, double angle) {
  double const decibel = std::log(10) / 10, anti = std::isfinite(q.anti_decibels) ? q.anti_decibels : q.decibels;
  Eigen::Matrix2cd v = Eigen::Matrix2cd::Zero();
  v(0, 0) = std::exp(-decibel * q.decibels);
  v(1, 1) = std::exp(decibel * anti);
  v = rotation(angle) * v * rotation(angle).adjoint();
  v = (1 - q.loss) * v + q.loss * Eigen::Matrix2cd::Identity();
  for (FilterCavity const& c : q.cavities) v = after_cavity(c, hz, v);
  return v;
}

// Angle of the local oscillator that reads the signal, and phase of the sidebands of the quadrature that it reads, of
// the interferometer with fixed mirrors and a tuned signal cavity, far below its pole.
struct Frame {
  double signal = 0, vacuum = 0;  // rad
};
Frame frame_of(Detector d) {
  d.signal_detuning = 0;
  Recycled const r = network_of(d, false);
  SteadyField const field(r.network);
  double const low = 1e-3;  // Hz
  auto const answer = [&](double angle) {
    LinearResponse const response(r.network, field, Readout::homodyne(r.output, angle), low);
    return response.to_displacement(r.end_x) - response.to_displacement(r.end_y);
  };
  Phasor const zero = answer(0), quarter = answer(pi / 2), larger = std::abs(zero) > std::abs(quarter) ? zero : quarter;
  Frame f;
  f.signal = std::atan2((quarter * std::conj(larger)).real(), (zero * std::conj(larger)).real());
  LinearResponse const response(r.network, field, Readout::homodyne(r.output, f.signal), low);
  f.vacuum = std::arg(response.to_vacuum(r.dark, 1) / response.to_vacuum(r.dark, 0)) / 2;
  return f;
}

// What squeezing at the dark port changes, of the noise in units of the vacuum of one sideband.
double squeezed_excess(LinearResponse const& response, Recycled const& r, Squeezer const& q, double phase, double hz) {
  Phasor const u = response.to_vacuum(r.dark, 0) * std::polar(1.0, phase),
               l = response.to_vacuum(r.dark, 1) * std::polar(1.0, -phase), i{0, 1};
  Eigen::RowVector2cd weights;
  weights << (u + l) / std::sqrt(2), i * (u - l) / std::sqrt(2);
  double const c = std::pow(std::cos(q.phase_noise), 2);
  Eigen::Matrix2cd const v = c * covariance(q, hz, q.angle) + (1 - c) * covariance(q, hz, q.angle + pi / 2);
  Phasor const with = (weights * v * weights.adjoint())(0, 0);
  return with.real() - std::norm(u) - std::norm(l);
}

std::vector<double> psd_of(Detector const& d, std::span<double const> hz, bool free) {
  Frame const frame = frame_of(d);
  Recycled const r = network_of(d, free);
  SteadyField const field(r.network);
  Readout const readout = Readout::homodyne(r.output, frame.signal - (d.readout_angle - pi / 2));
  std::vector<double> psd;
  for (double const f : hz) {
    LinearResponse const response(r.network, field, readout, f);
    double noise = response.quantum_noise();
    if (d.squeezer)
      noise += LinearResponse::vacuum_psd(d.wavelength) * squeezed_excess(response, r, *d.squeezer, frame.vacuum, f);
    Phasor const per_metre = (response.to_displacement(r.end_x) - response.to_displacement(r.end_y)) / 2.0;
    psd.push_back(noise / std::norm(per_metre) * d.strain_per_length_squared(f));
  }
  return psd;
}

}  // namespace

std::vector<double> quantum_psd(Detector const& d, std::span<double const> hz) { return psd_of(d, hz, true); }
std::vector<double> shot_psd(Detector const& d, std::span<double const> hz) { return psd_of(d, hz, false); }

}  // namespace straytrace
