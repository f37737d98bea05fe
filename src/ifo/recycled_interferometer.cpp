// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/recycled_interferometer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ifo/cavity.hpp"
#include "ifo/transmission_range.hpp"

namespace straytrace {
namespace {

using P = DualRecycledParameters;
constexpr Key<P> recycled_keys[] = {
    {"arm_length", &P::arm_length, dim::length, required, 1e-3, 1e8, "length L of one arm"},
    {"input_transmission", &P::input_transmission, dim::plain, required, least_transmission, 0.999,
     "of the input mirrors"},
    {"end_transmission", &P::end_transmission, dim::plain, required, 0, 0.999, "of the end mirrors"},
    {"round_trip_loss", &P::round_trip_loss, dim::plain, required, 0, 0.5, "of power, per round trip of an arm"},
    {"mirror_mass", &P::mirror_mass, dim::mass, required, 1e-9, 1e12, "of each arm mirror"},
    {"power_recycling_transmission", &P::power_recycling_transmission, dim::plain, required, least_transmission, 1,
     "1: no mirror"},
    {"signal_recycling_transmission", &P::signal_recycling_transmission, dim::plain, required, least_transmission, 1,
     "1: no mirror"},
    {"signal_recycling_tuning", &P::signal_recycling_tuning, dim::angle, required, -10, 10,
     "one way; 0: resonant sideband extraction"},
    {"beam_splitter_loss", &P::beam_splitter_loss, dim::plain, required, 0, 0.5, "per round trip, as in eq. 6.11"},
    {"signal_cavity_loss", &P::signal_cavity_loss, dim::plain, required, 0, 0.5, "per round trip, besides"},
    {"splitter_transmission", &P::splitter_transmission, dim::plain, required, 1e-3, 0.999, ""},
    {"power_recycling_length", &P::power_recycling_length, dim::length, required, 0, 1e6, "mirror to splitter"},
    {"signal_recycling_length", &P::signal_recycling_length, dim::length, required, 0, 1e6, "mirror to splitter"},
    {"short_arm", &P::short_arm, dim::length, required, 0, 1e6, "splitter to input mirror, mean"},
    {"schnupp_asymmetry", &P::schnupp_asymmetry, dim::length, required, -1e6, 1e6, "lx - ly"},
    {"transmission_difference", &P::transmission_difference, dim::plain, required, -1, 1,
     "of the input mirrors, x - y, relative"},
    {"loss_difference", &P::loss_difference, dim::plain, required, -0.5, 0.5, "of the round trips, x - y"},
    {"dark_fringe_offset", &P::dark_fringe_offset, dim::length, required, -1e-9, 1e-9,
     "of DARM; its light is the local oscillator"},
    {"homodyne_angle", &P::homodyne_angle, dim::angle, required, -10, 10, "without an offset"},
    {"readout_loss", &P::readout_loss, dim::plain, required, 0, most_transmission, "recycling mirror to photocurrent"},
    {"squeezing", &P::squeezing, dim::plain, required, 1e-4, 1, "noise power over that of the vacuum"},
    {"squeezing_angle", &P::squeezing_angle, dim::angle, required, -10, 10, "from the best one of each frequency"},
    {"injection_loss", &P::injection_loss, dim::plain, required, 0, most_transmission, "of the squeezed light"},
    {"pendulum_frequency", &P::pendulum_frequency, dim::frequency, required, 0, 1e3, "0: free mirrors"},
};

std::vector<Modulation> read_modulators(Node const& table) {
  std::vector<Modulation> list;
  for (Node const& node : table.list("modulators")) {
    list.push_back({node.number("frequency", dim::frequency, required, 1, 1e12),
                    node.number("index", dim::plain, required, 0, 10)});
    node.refuse_unknown("a modulator");
  }
  if (list.size() > 3)
    table["modulators"].problem("more than three modulators make too many carriers", "leave out those of no account");
  return list;
}

void read_power(Node const& table, P& p) {
  if (table.has("arm_power") && table.has("input_power"))
    table["input_power"].problem("'arm_power' and 'input_power' are both given",
                                 "keep one of them: the network computes one from the other");
  if (table.has("arm_power")) {
    p.arm_power = table.number("arm_power", dim::power, required, 1e-30);
  } else if (table.has("input_power") || p.arm_power == 0) {
    p.input_power = table.number("input_power", dim::power, p.input_power, 1e-30);
    p.arm_power = 0;
  }
}

constexpr double rounding = 1e-12;  // of a field: what is below may be rounding alone; it is some 1e-18

std::array<double, 3> probes(Band const& band) { return {band.low, std::sqrt(band.low * band.high), band.high}; }

// A read-out that does not see DARM calibrates nothing.
void refuse_a_blind_readout(Node const& table, DualRecycled const& model, Band const& band) {
  if (model.parameters().dark_fringe_offset != 0 && !(model.reference(InjectionPoint::as_port) > rounding))
    return table["dark_fringe_offset"].problem("with so small an offset no light of the carrier leaves the dark port",
                                               "write 'dark_fringe_offset: 4 pm'; 0 m for a homodyne detector");
  for (double const hz : probes(band))
    if (!model.sees_darm(hz))
      return (table.has("homodyne_angle") ? table["homodyne_angle"] : table)
          .problem("the homodyne detector reads the quadrature in which DARM does not appear",
                   "write 'homodyne_angle: 90 deg', or give a 'dark_fringe_offset'");
}

// Keys that would be read and do nothing, or nothing that can be built.
void refuse_keys_at_odds(Node const& table, P const& p) {
  if (table.has("homodyne_angle") && p.dark_fringe_offset != 0)
    table["homodyne_angle"].problem("the read-out is the power at the dark port, where 'homodyne_angle' does nothing",
                                    "leave it out, or write 'dark_fringe_offset: 0 m' for a homodyne detector");
  if (std::fabs(p.schnupp_asymmetry) > 2 * p.short_arm)
    (table.has("schnupp_asymmetry") ? table["schnupp_asymmetry"] : table)
        .problem(fmt::format("with a mean of {:g} m and a difference of {:g} m one short arm is shorter than nothing",
                             p.short_arm, p.schnupp_asymmetry),
                 fmt::format("write 'short_arm: {:g} m' or more", std::fabs(p.schnupp_asymmetry) / 2));
}

void warn_of_idle_servos(Node const& table, std::vector<PortEntry> const& entries) {
  bool const served = std::any_of(entries.begin(), entries.end(), [&](PortEntry const& e) {
    return e.injection_point == InjectionPoint::input_bench && !has_response_files(table, e.name);
  });
  for (char const* key : {"frequency_servo", "intensity_servo"})
    if (table.has(key) && !served)
      table[key].warning(fmt::format("'{}' quiets light at 'input-bench', and no port is there", key),
                         "say by 'at: input-bench' which port is, or leave it out");
}

// A stray field is relative to the light at its port; where none is, and where what joins does not reach the read-out,
// the solution holds rounding alone.
void refuse_ports_without_response(Node const& table, RecycledInterferometer const& ifo,
                                   std::vector<PortEntry> const& entries, Band const& band) {
  P const& p = ifo.model().parameters();
  double const whole = strain_per_phase_in_arm(p.wavelength, p.arm_length);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    PortEntry const& e = entries[i];
    if (has_response_files(table, e.name) || !table.healthy()) continue;
    std::string_view const at = entrance_names[std::size_t(e.injection_point)];
    double const light = ifo.model().reference(e.injection_point);
    Node const place = place_of_entrance(table, e.name);
    if (!(light > rounding)) {
      place.problem(
          fmt::format("no light is at '{}' of this interferometer, so a stray field has nothing to be "
                      "relative to",
                      at),
          fmt::format("add '{}' to the interferometer, or give the port a file in 'responses'",
                      is_behind_the_end(e.injection_point) ? "end_transmission: 4.4 ppm" : "dark_fringe_offset: 4 pm"));
      continue;
    }
    double largest = 0;
    for (double const hz : probes(band)) largest = std::fmax(largest, ifo.largest_response(e.injection_point, hz));
    if (!(largest > rounding * whole * light))
      place.problem(
          fmt::format("light at '{}' does not reach the read-out: the arms are equal and the fringe is dark", at),
          "add 'dark_fringe_offset', 'loss_difference' or 'transmission_difference' to the interferometer, "
          "or give the port a file in 'responses'");
  }
}

}  // namespace

std::span<Key<P> const> dual_recycled_keys() { return recycled_keys; }

RecycledInterferometer::Answer RecycledInterferometer::solved(double hz) const {
  HeldResponse const r(*model_, hz);
  std::complex<double> const darm = r.to_freedom(Freedom::darm) * model_->parameters().arm_length;
  if (!(std::abs(darm) > 0)) throw NumericalError("the read-out of the interferometer does not see DARM");
  Answer a;
  for (std::size_t e = 0; e < entrance_names.size(); ++e) {
    Injection const i = model_->injection(InjectionPoint(e));
    std::complex<double> const per_field = darm * model_->share_outside(InjectionPoint(e));
    a.phase[e] = r.to_phase(i) / per_field;
    a.amplitude[e] = r.to_amplitude(i) / per_field;
  }
  return a;
}

RecycledInterferometer::Answer const& RecycledInterferometer::answer(double hz) const {
  std::scoped_lock const lock(mutex_);
  auto const found = answers_.find(hz);
  return found != answers_.end() ? found->second : answers_.emplace(hz, solved(hz)).first->second;
}

std::complex<double> RecycledInterferometer::strain_per_phase(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  std::complex<double> const quieted =
      e.injection_point == InjectionPoint::input_bench ? suppression(servos_.frequency(hz)) : 1.0;
  return e.field_share * quieted * answer(hz).phase[std::size_t(e.injection_point)];
}
std::complex<double> RecycledInterferometer::strain_per_amplitude(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  std::complex<double> const quieted =
      e.injection_point == InjectionPoint::input_bench ? suppression(servos_.intensity(hz)) : 1.0;
  return e.field_share * quieted * answer(hz).amplitude[std::size_t(e.injection_point)];
}
double RecycledInterferometer::largest_response(InjectionPoint e, double hz) const {
  Answer const& a = answer(hz);
  return std::fmax(std::abs(a.phase[std::size_t(e)]), std::abs(a.amplitude[std::size_t(e)]));
}

DetectorNumbers RecycledInterferometer::numbers() const {
  P const& p = model_->parameters();
  ArmCavity const arm{p.arm_length, p.input_transmission, p.end_transmission, p.round_trip_loss};
  return {p.arm_length, model_->arm_power(), p.mirror_mass, finesse(arm),
          differential_mode(arm, p.signal_recycling_transmission).gain};
}

std::string RecycledInterferometer::description() const {
  P const& p = model_->parameters();
  constexpr double hz = 10;
  double const inertia = speed_of_light * p.mirror_mass * std::pow(2 * pi * hz, 2) * p.arm_length,
               gain = std::abs(answer(hz).amplitude[std::size_t(InjectionPoint::arm)]) * inertia /
                      (8 * model_->arm_power());
  std::string const readout =
      p.dark_fringe_offset != 0
          ? fmt::format("power of the carrier with {:g} pm of DARM offset", p.dark_fringe_offset * 1e12)
          : fmt::format("homodyne at {:g} deg", p.homodyne_angle * 180 / pi);
  return fmt::format(
             "dual-recycled Fabry-Perot Michelson '{}', plane waves with radiation pressure, free of closed forms; "
             "read-out: {}, calibrated as DARM, h = (dLx - dLy)/L, CARM, MICH, PRCL and SRCL held; lambda "
             "{:g} nm, L {:g} m, P {:.5g} W per arm from "
             "{:.4g} W, M {:g} kg, signal recycling {:g} % tuned to {:g} deg, at {:g} Hz Gamma of "
             "eq. 9.2 {:.4g} and gain of a field in the arm without radiation pressure {:.4g}, f_p {:.4g} Hz",
             name_, readout, p.wavelength * 1e9, p.arm_length, model_->arm_power(), p.input_power, p.mirror_mass,
             100 * p.signal_recycling_transmission, p.signal_recycling_tuning * 180 / pi, hz, gain,
             std::abs(model_->stray_gain(hz).amplitude), model_->pole()) +
         describe(ports_, *this, band_);
}

std::unique_ptr<Interferometer> read_recycled_interferometer(Node const& table, DualRecycledPreset const& preset,
                                                             std::vector<TracedPort> const& ports, double wavelength,
                                                             Band const& band) {
  P p = preset.parameters;
  for (Key<P> const& k : recycled_keys) p.*(k.member) = table.number(k.name, k.dimension, p.*(k.member), k.low, k.high);
  read_power(table, p);
  if (!std::isnan(preset.parameters.arm_length) && !(std::fabs(wavelength / p.wavelength - 1) <= 1e-3))
    table.warning(fmt::format("'{}' runs at {:g} nm, the beams of the scene at {:g} nm", preset.name,
                              p.wavelength * 1e9, wavelength * 1e9),
                  fmt::format("give the beams 'wavelength: {:g} nm'; the interferometer now takes that of the beams",
                              p.wavelength * 1e9));
  p.wavelength = wavelength;
  RecycledInterferometer::Servos servos;
  if (Node const loop = table["frequency_servo"]) servos.frequency = read_transfer_function(loop, band);
  if (Node const loop = table["intensity_servo"]) servos.intensity = read_transfer_function(loop, band);
  std::vector<Modulation> const modulators = read_modulators(table);
  std::vector<PortEntry> entries = read_port_entries(table, ports, double(table.whole("arms", 2, 1, 1000)));
  if (p.transmission_difference != 0 || p.loss_difference != 0) {
    double const largest = p.input_transmission * (1 + std::fabs(p.transmission_difference) / 2);
    if (!(largest < 1) || !(std::fabs(p.loss_difference) / 2 <= p.round_trip_loss))
      table.problem("the differences of the arms leave a mirror with a share below 0 or above 1", "make them smaller");
  }
  refuse_keys_at_odds(table, p);
  warn_of_idle_servos(table, entries);
  if (!table.healthy()) return nullptr;
  auto model = std::make_unique<DualRecycled>(p, modulators);
  refuse_a_blind_readout(table, *model, band);
  warn_of_other_arms(table, ports, entries, model->arm_power(), p.arm_length);
  auto ifo =
      std::make_unique<RecycledInterferometer>(std::string(preset.name), std::move(model), entries, servos, band);
  refuse_ports_without_response(table, *ifo, entries, band);
  return ifo;
}

}  // namespace straytrace
