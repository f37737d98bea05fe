// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/fabry_perot_michelson.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::ifo {
namespace {

double pole_of(double product, double length) {  // product of the two amplitude reflectivities
  return speed_of_light * (1 - product) / (4 * pi * length * std::sqrt(product));
}

}  // namespace

double ArmCavity::r1() const { return std::sqrt(1 - input_transmission); }
double ArmCavity::r2() const { return std::sqrt((1 - end_transmission) * (1 - round_trip_loss)); }

double finesse(ArmCavity const& arm) {
  double const product = arm.r1() * arm.r2();
  return pi * std::sqrt(product) / (1 - product);
}

double cavity_pole(ArmCavity const& arm) { return pole_of(arm.r1() * arm.r2(), arm.length); }

DifferentialMode differential_mode(ArmCavity const& arm, double signal_transmission) {
  double const between = arm.r1() * std::sqrt(1 - signal_transmission);
  double const transmission = arm.input_transmission * signal_transmission / std::pow(1 - between, 2);
  double const product = std::sqrt(1 - transmission) * arm.r2();
  return {1 / (1 - product), pole_of(product, arm.length)};
}

double arm_power(ArmCavity const& arm, double input_power, double recycling_transmission, double beam_splitter_loss) {
  double const t1 = std::sqrt(arm.input_transmission), gain = t1 / (1 - arm.r1() * arm.r2()),
               reflected = arm.r1() - t1 * arm.r2() * gain;  // about -1 on resonance
  double const recycled = std::sqrt(recycling_transmission) /
                          (1 + std::sqrt(1 - recycling_transmission) * reflected * std::sqrt(1 - beam_splitter_loss));
  return input_power * std::pow(gain * recycled, 2) / 2;
}

double strain_per_phase_in_arm(double wavelength, double length) { return wavelength / (4 * pi) / length; }

std::complex<double> strain_per_amplitude_in_arm(double hz, double power, double mass, double length,
                                                 DifferentialMode mode) {
  double const slow = 8 * power * mode.gain / (speed_of_light * mass * std::pow(2 * pi * hz, 2) * length);
  return slow / std::complex<double>(1, hz / mode.pole);
}

std::complex<double> strain_per_phase_in_short_arm(ArmCavity const& arm, double wavelength, double hz) {
  double const slow = strain_per_phase_in_arm(wavelength, arm.length) * pi / (2 * finesse(arm));
  return slow * std::complex<double>(1, hz / cavity_pole(arm));
}

std::complex<double> strain_at_antisymmetric_port(double dark_fringe_offset, double length, double hz,
                                                  DifferentialMode mode) {
  return dark_fringe_offset / length * std::complex<double>(1, hz / mode.pole);
}

namespace {

struct K {
  double arm_length, mirror_mass, input_transmission, end_transmission, round_trip_loss, signal_recycling_transmission,
      arms, dark_fringe_offset;
};
constexpr Key<K> michelson_keys[] = {
    {"arm_length", &K::arm_length, dim::length, required, 1e-3, 1e8, "length L of one arm"},
    {"mirror_mass", &K::mirror_mass, dim::mass, required, 1e-9, 1e9, "mass M of each arm mirror"},
    {"input_transmission", &K::input_transmission, dim::plain, required, least_transmission, most_transmission,
     "power transmission of the input mirror"},
    {"end_transmission", &K::end_transmission, dim::plain, 0, 0, most_transmission,
     "power transmission of the end mirror"},
    {"round_trip_loss", &K::round_trip_loss, dim::plain, 75e-6, 0, most_transmission,
     "loss of power per round trip of an arm"},
    {"signal_recycling_transmission", &K::signal_recycling_transmission, dim::plain, 1, least_transmission, 1,
     "power transmission of the signal-recycling mirror; 1: none (eq. 6.8)"},
    {"arms", &K::arms, dim::plain, 2, 1, 1000, "number of equal arms, of which one is traced; powers add"},
    {"dark_fringe_offset", &K::dark_fringe_offset, dim::length, 0, -1e-9, 1e-9, "of DARM, for eq. 9.6"},
};

// Circulating power of one arm: given here or with the beam, or from the power at the recycling mirror by eq. 6.11.
double read_arm_power(Node const& t, ArmCavity const& arm, std::vector<TracedPort> const& ports,
                      std::vector<PortEntry> const& entries) {
  if (t.has("arm_power")) {
    if (t.has("input_power"))
      t["input_power"].problem("'arm_power' and 'input_power' are both given",
                               "keep one of them: eq. 6.11 computes the first from the second");
    return t.number("arm_power", dim::power, required, 0);
  }
  if (!t.has("input_power")) {
    if (double const of_beam = beam_power_in_arm(t, ports, entries); of_beam > 0) return of_beam;
    t.problem("the power in the arms is missing",
              "give the beam of the arm a 'power', or add 'arm_power: 650 kW' here, or 'input_power' and "
              "'power_recycling_transmission'");
    return not_a_number;
  }
  return arm_power(arm, t.number("input_power", dim::power, required, 0),
                   t.number("power_recycling_transmission", dim::plain, 1, least_transmission, 1),
                   t.number("beam_splitter_loss", dim::plain, 0, 0, most_transmission));
}

// All but the power.
FabryPerotMichelson::Parameters read_parameters(Node const& table, double wavelength) {
  K k{};
  read_keys<K>(table, michelson_keys, k);
  FabryPerotMichelson::Parameters p;
  p.arm = {k.arm_length, k.input_transmission, k.end_transmission, k.round_trip_loss};
  p.wavelength = wavelength;
  p.mass = k.mirror_mass;
  p.arms = k.arms;
  p.dark_fringe_offset = k.dark_fringe_offset;
  if (k.arms != std::floor(k.arms))
    table["arms"].problem("'arms' is the number of arms", "write a whole number, for example 2");
  p.mode = differential_mode(p.arm, k.signal_recycling_transmission);
  if (table.has("gain")) p.mode.gain = table.number("gain", dim::plain, required, least_transmission);
  if (table.has("cavity_pole")) p.mode.pole = table.number("cavity_pole", dim::frequency, required, least_transmission);
  return p;
}

}  // namespace

std::complex<double> FabryPerotMichelson::strain_per_phase(PortId port, double hz) const {
  PortEntry const& e = entry(port);
  double const in_arm = strain_per_phase_in_arm(p_.wavelength, p_.arm.length);
  if (e.injection_point == InjectionPoint::end_bench)
    return e.field_share * p_.arm.end_transmission * in_arm;  // eq. 9.3
  if (e.injection_point == InjectionPoint::short_arm)
    return e.field_share * strain_per_phase_in_short_arm(p_.arm, p_.wavelength, hz);
  if (e.injection_point == InjectionPoint::as_port)
    return e.field_share * strain_at_antisymmetric_port(p_.dark_fringe_offset, p_.arm.length, hz, p_.mode);
  return e.field_share * in_arm;
}

std::complex<double> FabryPerotMichelson::strain_per_amplitude(PortId port, double hz) const {
  PortEntry const& e = entry(port);
  if (e.injection_point == InjectionPoint::short_arm || e.injection_point == InjectionPoint::as_port)
    return 0;                                                                                         // no closed form
  double const share = e.injection_point == InjectionPoint::end_bench ? p_.arm.end_transmission : 1;  // eq. 9.4
  return e.field_share * share * strain_per_amplitude_in_arm(hz, p_.power, p_.mass, p_.arm.length, p_.mode);
}

std::optional<std::complex<double>> FabryPerotMichelson::strain_per_passing_amplitude(PortId port, double hz) const {
  PortEntry const& e = entry(port);
  if (is_behind_the_end(e.injection_point)) return 0;
  if (!is_inside_an_arm(e.injection_point) || e.field_share != 1) return {};
  // Both ways, Gamma - 1/4 and Gamma - 3/4 of eq. N.19: what passes a place has no recoil there.
  auto const pushes = [&](DifferentialMode mode) {
    return strain_per_amplitude_in_arm(hz, p_.power, p_.mass, p_.arm.length, mode);
  };
  return 2.0 * pushes(p_.mode) - pushes({1, infinity});
}

std::string FabryPerotMichelson::description() const {
  std::string const text = fmt::format(
      "Fabry-Perot Michelson, stray light inside an arm: h = (lambda/4 pi L) Im s (phase, eq. 9.1) and "
      "h = 8 P Gamma Re s/(c M (2 pi f)^2 L)/(1 + i f/f_p) (radiation pressure, eq. 9.2); lambda {:g} nm, L {:g} m, "
      "P {:.5g} W per arm, M {:g} kg, Gamma {:.4g}, f_p {:.4g} Hz, finesse {:.4g}, {:g} equal arms",
      p_.wavelength * 1e9, p_.arm.length, p_.power, p_.mass, p_.mode.gain, p_.mode.pole, finesse(p_.arm), p_.arms);
  bool const all_inside = std::ranges::all_of(ports_, [&](PortEntry const& e) {
    return is_inside_an_arm(e.injection_point) && e.field_share == 1 && e.copies == p_.arms;
  });
  return all_inside ? text : text + describe(ports_, *this, band_);
}

namespace {

// Ports without a closed form.
void refuse_without_closed_form(Node const& table, FabryPerotMichelson::Parameters const& p,
                                std::vector<PortEntry> const& entries) {
  for (PortEntry const& e : entries) {
    if (has_response_files(table, e.name)) continue;
    if (!e.at.empty()) {
      table["ports"][e.name].problem(fmt::format("closed forms have no beam '{}'", e.at),
                                     "take a preset that solves the network, for example 'preset: adv'");
      continue;
    }
    InjectionPoint const at = e.injection_point;
    if (at == InjectionPoint::recycling_cavity || at == InjectionPoint::signal_cavity ||
        at == InjectionPoint::symmetric_port || at == InjectionPoint::input_bench)
      table["ports"][e.name].problem(fmt::format("light at '{}' has no closed form", entrance_names[std::size_t(at)]),
                                     "take a preset that solves the network, for example 'preset: adv'");
    if (at == InjectionPoint::as_port && p.dark_fringe_offset == 0)
      table["ports"][e.name].problem("at the antisymmetric port stray light needs an offset of the dark fringe",
                                     "add 'dark_fringe_offset: 4 pm' to the interferometer");
    if (at == InjectionPoint::end_bench && p.arm.end_transmission == 0)
      table["ports"][e.name].problem("light from an end bench passes the end mirror, whose transmission is zero",
                                     "add 'end_transmission: 4.4 ppm' to the interferometer");
  }
}

}  // namespace

std::unique_ptr<Interferometer> read_closed_forms(Node const& table, std::vector<TracedPort> const& ports,
                                                  double wavelength, Band const& band) {
  FabryPerotMichelson::Parameters p = read_parameters(table, wavelength);
  std::vector<PortEntry> entries = read_port_entries(table, ports, p.arms);
  p.power = read_arm_power(table, p.arm, ports, entries);
  if (table.healthy()) warn_of_other_arms(table, ports, entries, p.power, p.arm.length);
  refuse_without_closed_form(table, p, entries);
  return std::make_unique<FabryPerotMichelson>(p, std::move(entries), band);
}

}  // namespace straytrace::ifo
