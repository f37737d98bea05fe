// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/dual_recycled.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ifo/control_loops.hpp"
#include "ifo/fabry_perot_michelson.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/network_interferometer.hpp"

namespace straytrace::ifo {
namespace {

constexpr double probe_hz = 1e-3;  // far below any pole: the quasi-static response

}  // namespace

DualRecycled::DualRecycled(DualRecycledParameters const& p, std::vector<Modulation> const& modulations,
                           NetworkChanges changes)
    : p_(p), modulations_(modulations), changes_(std::move(changes)), network_(p.wavelength) {
  if (p_.arm_power > 0) p_.input_power = 1;
  build();
  field_ = std::make_unique<SteadyField>(network_);
  if (p_.arm_power > 0) {
    p_.input_power = p_.arm_power / arm_power();
    network_ = Network(p_.wavelength);
    build();
    field_ = std::make_unique<SteadyField>(network_);
  }
  std::uint32_t const dark = network_.number_of({network_.find("dark"), 0});
  bool const offset = p_.dark_fringe_offset != 0;
  if (!offset || p_.squeezer) signal_ = quadratures();
  // With an offset the local oscillator is the carrier at the dark port, as behind an output mode cleaner.
  readout_ = Readout::homodyne(
      dark, offset ? std::arg(field_->in(dark, field_->carrier(0))) : signal_.read + p_.homodyne_angle - pi / 2);
}

// Phases: both sides of an interface reflect i r. An arm of pi/2 one way is resonant and returns the light with -i;
// with pi/2 more in short arm y the port of the signal-recycling mirror is dark. Then 0 in the power-recycling cavity
// is resonant for the carrier, and 0 in the signal-recycling cavity is resonant sideband extraction.
void DualRecycled::build() {
  // The light passes the splitter and the signal cavity twice.
  double const once = 1 - std::sqrt(1 - p_.beam_splitter_loss), kept = std::sqrt(1 - p_.signal_cavity_loss);
  NetworkPort beam{network_.add_laser("laser", p_.input_power), 0};
  for (Modulation const& m : modulations_) {
    ComponentId const eom = network_.add(Network::modulator("EOM" + std::to_string(&m - modulations_.data() + 1),
                                                            {.index = m.index, .hz = m.hz, .of = m.of}));
    network_.link(beam, {eom, 0}, 0);
    beam = {eom, 1};
  }
  ComponentId const prm = network_.add_mirror("PRM", {.transmission = p_.power_recycling_transmission}),
                    splitter = network_.add_splitter(
                        "BS",
                        {.transmission = p_.splitter_transmission * (1 - once), .loss = once, .incidence = pi / 4}),
                    cavity = network_.add_isolator("signal_cavity", kept, kept),
                    srm = network_.add_mirror("SRM", {.transmission = p_.signal_recycling_transmission}),
                    output = network_.add_isolator("output", 1 - p_.injection_loss, 1 - p_.readout_loss),
                    dark = network_.add_dump("dark");
  network_.link(beam, {prm, 0}, 0);
  network_.link({prm, 1}, {splitter, 0}, p_.power_recycling_length);
  network_.link({splitter, 3}, {cavity, 0}, p_.signal_recycling_length, p_.signal_recycling_tuning);
  network_.link({cavity, 1}, {srm, 0}, 0);
  network_.link({srm, 1}, {output, 0}, 0);
  network_.link({output, 1}, {dark, 0}, 0);
  build_arms(splitter);
  apply(changes_, network_);
  if (p_.mirror_mass == infinity) network_.hold();
}

void DualRecycled::build_arms(ComponentId splitter) {
  Suspension const suspension{.mass = p_.mirror_mass, .resonance = p_.pendulum_frequency};
  for (int const arm : {0, 1}) {
    double const sign = arm == 0 ? 0.5 : -0.5, loss = p_.round_trip_loss + sign * p_.loss_difference;
    std::string const name = arm == 0 ? "x" : "y";
    ComponentId const itm = network_.add_mirror("ITM" + name, {.transmission = p_.input_transmission *
                                                                               (1 + sign * p_.transmission_difference),
                                                               .suspension = suspension}),
                      etm = network_.add_mirror("ETM" + name, {.transmission = p_.end_transmission,
                                                               .loss = loss * (1 - p_.end_transmission),
                                                               .displacement = sign * p_.dark_fringe_offset,
                                                               .suspension = suspension}),
                      bench = network_.add_dump("bench_" + name);
    network_.link({splitter, arm == 0 ? 2u : 1u}, {itm, 0}, p_.short_arm + sign * p_.schnupp_asymmetry,
                  arm == 0 ? 0 : pi / 2);
    network_.link({itm, 1}, {etm, 0}, p_.arm_length, pi / 2);
    network_.link({etm, 1}, {bench, 0}, 0);
  }
}

DualRecycled::Quadratures DualRecycled::quadratures() const {
  if (p_.signal_recycling_tuning != 0 || p_.mirror_mass != infinity || p_.dark_fringe_offset != 0) {
    DualRecycledParameters tuned = p_;
    tuned.mirror_mass = infinity;
    tuned.signal_recycling_tuning = tuned.dark_fringe_offset = 0;
    return DualRecycled(tuned, modulations_, changes_).signal_;
  }
  std::uint32_t const dark = network_.number_of({network_.find("dark"), 0});
  Phasor seen[2];
  for (int i : {0, 1}) seen[i] = to_freedom(response(Readout::homodyne(dark, i * pi / 2), probe_hz), Freedom::darm);
  // Both have the same phase far below the pole; unlike the plain sum, the sum of squares cannot vanish.
  Phasor const unit = std::abs(seen[0]) > std::abs(seen[1]) ? seen[0] / std::abs(seen[0]) : seen[1] / std::abs(seen[1]);
  double const read = std::atan2(std::real(seen[1] / unit), std::real(seen[0] / unit));
  return {read, response(Readout::homodyne(dark, read), probe_hz).seen_quadrature(dark)};
}

double DualRecycled::power_at(char const* component, std::uint32_t port) const {
  return field_->power_in(network_.number_of({network_.find(component), port}));
}

double DualRecycled::share_outside(InjectionPoint e) const {
  return e == InjectionPoint::through_end ? p_.end_transmission : 1;
}

double DualRecycled::reference(InjectionPoint e) const {
  Injection const i = injection(e);
  return std::sqrt((i.of_leaving ? field_->power_out(i.port) : field_->power_in(i.port)) / arm_power());
}

bool DualRecycled::sees_darm(double hz) const { return sees(network_, *field_, readout_, freedom(Freedom::darm), hz); }

std::unique_ptr<DualRecycled> DualRecycled::without_radiation_pressure() const {
  DualRecycledParameters heavy = p_;
  heavy.mirror_mass = infinity;
  heavy.arm_power = 0;
  auto d = std::make_unique<DualRecycled>(heavy, modulations_, changes_);
  d->read(readout_);
  return d;
}

Phasor DualRecycled::stray_gain(double hz) const {
  auto const heavy = without_radiation_pressure();
  Injection const arm = injection(InjectionPoint::arm);
  Phasor gain = 0;
  for (char const* end : {"ETMx", "ETMy"}) {
    LinearResponse const r = heavy->response(Readout::power(network_.number_of({network_.find(end), 0})), hz);
    gain += (end[3] == 'x' ? 0.5 : -0.5) / arm_power() * r.to_amplitude(arm);
  }
  return gain;
}

double DualRecycled::pole() const {
  auto const heavy = without_radiation_pressure();
  auto const size = [&](double hz) { return std::abs(heavy->to_freedom(heavy->response(hz), Freedom::darm)); };
  double const last = speed_of_light / (4 * p_.arm_length);  // half of the free spectral range
  double top = size(probe_hz), below = probe_hz;
  for (double hz = last / 1e4; hz < last; hz *= 1.1)
    if (double const s = size(hz); s >= top) top = s, below = hz;
  double above = below;
  while (above < last && size(above) > top / std::sqrt(2)) above *= 1.1;
  if (above >= last) return not_a_number;
  for (int i = 0; i < 60; ++i) {
    double const middle = std::sqrt(below * above);
    (size(middle) > top / std::sqrt(2) ? below : above) = middle;
  }
  return below;
}

double DualRecycled::quantum_noise(double hz) const {
  LinearResponse const r = response(hz);
  Squeezing vacuum{network_.number_of({network_.find("dark"), 0})};
  if (p_.squeezer) {
    vacuum.covariance = p_.squeezer->covariance(hz);
    vacuum.angle = signal_.squeezed;
  } else {
    vacuum.covariance = squeezed_vacuum(p_.squeezing, 1 / p_.squeezing, p_.squeezing_angle);
    vacuum.angle = r.seen_quadrature(vacuum.port);
  }
  return std::sqrt(r.quantum_noise({&vacuum, 1})) / (std::abs(to_freedom(r, Freedom::darm)) * p_.arm_length);
}

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
    table["modulators"].problem("more than three modulators produce too many carriers",
                                "remove the least important ones");
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

constexpr double rounding = 1e-12;  // of a field: smaller values may be pure rounding, which is some 1e-18

std::array<double, 3> probes(Band const& band) { return {band.low, std::sqrt(band.low * band.high), band.high}; }

// A read-out without response to DARM cannot be calibrated.
void refuse_a_blind_readout(Node const& table, DualRecycled const& model, Band const& band) {
  if (table.has("readout")) {
    if (!std::ranges::all_of(probes(band), [&](double hz) { return model.sees_darm(hz); }))
      table["readout"].problem(fmt::format("'{}' does not respond to DARM", table["readout"].text()),
                               "name another read-out, or write 'phase: best(DARM)' in it");
    return;
  }
  if (model.parameters().dark_fringe_offset != 0 && !(model.reference(InjectionPoint::as_port) > rounding))
    return table["dark_fringe_offset"].problem("with this offset no carrier light leaves the dark port",
                                               "write 'dark_fringe_offset: 4 pm'; 0 m for a homodyne detector");
  for (double const hz : probes(band))
    if (!model.sees_darm(hz))
      return (table.has("homodyne_angle") ? table["homodyne_angle"] : table)
          .problem("the homodyne detector reads the quadrature without DARM",
                   "write 'homodyne_angle: 90 deg', or give a 'dark_fringe_offset'");
}

// Keys without effect, and impossible lengths.
void refuse_keys_at_odds(Node const& table, P const& p) {
  if (table.has("homodyne_angle") && p.dark_fringe_offset != 0)
    table["homodyne_angle"].problem("the read-out is the power at the dark port, where 'homodyne_angle' has no effect",
                                    "remove it, or write 'dark_fringe_offset: 0 m' for a homodyne detector");
  if (std::fabs(p.schnupp_asymmetry) > 2 * p.short_arm)
    (table.has("schnupp_asymmetry") ? table["schnupp_asymmetry"] : table)
        .problem(fmt::format("a mean of {:g} m and a difference of {:g} m give one short arm a negative length",
                             p.short_arm, p.schnupp_asymmetry),
                 fmt::format("write 'short_arm: {:g} m' or more", std::fabs(p.schnupp_asymmetry) / 2));
}

void warn_of_idle_servos(Node const& table, std::vector<PortEntry> const& entries) {
  bool const served = std::ranges::any_of(entries, [&](PortEntry const& e) {
    return e.place() == entrance_names[std::size_t(InjectionPoint::input_bench)] && !has_response_files(table, e.name);
  });
  for (char const* key : {"frequency_servo", "intensity_servo"})
    if (table.has(key) && !served)
      table[key].warning(fmt::format("'{}' quiets light at 'input-bench', and no port is there", key),
                         "say by 'at: input-bench' which port is, or leave it out");
}

// What brings light to a dark place.
std::string light_for(PortEntry const& e, P const& p) {
  if (e.way) return "name the beam whose light is scattered by 'lit_by', or give the port a file in 'responses'";
  bool const mirror = e.injection_point == InjectionPoint::signal_cavity && p.signal_recycling_transmission == 1;
  return fmt::format("add '{}' to the interferometer, or give the port a file in 'responses'",
                     mirror                                 ? "signal_recycling_transmission: 20 %"
                     : is_behind_the_end(e.injection_point) ? "end_transmission: 4.4 ppm"
                                                            : "dark_fringe_offset: 4 pm");
}

// A stray field is relative to the light that is scattered. Without light there, or where light from there does not
// reach the read-out, the solution is pure rounding.
void refuse_ports_without_response(Node const& table, RecycledInterferometer const& ifo,
                                   std::vector<PortEntry> const& entries, Band const& band) {
  P const& p = ifo.model().parameters();
  double const whole = strain_per_phase_in_arm(p.wavelength, p.arm_length);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    PortEntry const& e = entries[i];
    if (has_response_files(table, e.name) || !table.healthy()) continue;
    std::string const at = e.place();
    double const light = e.way ? std::sqrt(lighting_power(*e.way, ifo.model().field()) / ifo.model().arm_power())
                               : ifo.model().reference(e.injection_point);
    Node const place = place_of_entrance(table, e.name);
    if (!(light > rounding)) {
      place.problem(
          fmt::format("this interferometer has no light at '{}', so a relative stray field is not defined", at),
          light_for(e, p));
      continue;
    }
    double largest = 0;
    for (double const hz : probes(band))
      largest = std::fmax(largest, ifo.largest_response(PortId{std::uint32_t(i)}, hz));
    if (!(largest > rounding * whole * light))
      place.problem(
          fmt::format("light at '{}' does not reach the read-out: the arms are equal and the fringe is dark", at),
          "add 'dark_fringe_offset', 'loss_difference' or 'transmission_difference' to the interferometer, "
          "or give the port a file in 'responses'");
  }
}

// The read-out of DARM that the scene names, and its name.
std::string read_by(Node const& table, NetworkModel& asked, DualRecycled& model) {
  if (!table.has("readout")) return {};
  std::string const name = table.word("readout");
  for (char const* key : {"homodyne_angle", "readout_loss"})
    if (table.has(key))
      table[key].problem(fmt::format("'readout' names the read-out, where '{}' has no effect", key),
                         "remove one of them");
  if (NamedReadout const* r = asked.readout(name)) {
    model.read(r->readout);
    asked.strain->readout = r->readout;
  } else if (!name.empty()) {
    std::vector<std::string> names;
    for (NamedReadout const& other : asked.readouts) names.push_back(other.name);
    table["readout"].problem(fmt::format("the network has no read-out '{}'", name),
                             did_you_mean(name, names, "add it to 'readouts' of the 'network'"));
  }
  return name;
}

NetworkChanges read_changes_of_preset(Node const& network, DualRecycled const& preset,
                                      std::vector<DrawnOptic> const& optics) {
  for (char const* key : {"wavelength", "polarisation"})
    if (network.has(key))
      network[key].problem(fmt::format("'{}' is that of the preset", key), "remove it, or write 'preset: none'");
  NetworkChanges changes = read_network_changes(network, preset.network(), optics);
  for (Network::Component const& c : changes.components)
    if (c.name == "laser")
      network["components"][c.name].problem("the light of a preset is its 'input_power' or 'arm_power'",
                                            "give the power there");
  return changes;
}

// A preset with the changes of a scene, where light still reaches the arms.
std::unique_ptr<DualRecycled> changed(Node const& network, P const& p, std::vector<Modulation> const& modulators,
                                      NetworkChanges const& changes) {
  auto model = std::make_unique<DualRecycled>(p, modulators, changes);
  if (model->arm_power() > 0) return model;
  network.problem("no light reaches arm x of the preset", "lead the light from 'laser' to 'PRM.front' by 'spaces'");
  return nullptr;
}

}  // namespace

RecycledInterferometer::Answer RecycledInterferometer::solved(double hz) const {
  CalibratedStrain const r(asked_, model_->field(), hz);
  std::complex<double> const darm = r.calibration();
  if (!(std::abs(darm) > 0)) throw NumericalError("the read-out of the interferometer has no response to DARM");
  Answer a;
  for (std::size_t e = 0; e < entrance_names.size(); ++e) {
    Injection const i = model_->injection(InjectionPoint(e));
    std::complex<double> const per_field = darm * model_->share_outside(InjectionPoint(e));
    a.phase[e] = r.to([&](LinearResponse const& x) { return x.to_phase(i); }) / per_field;
    a.amplitude[e] = r.to([&](LinearResponse const& x) { return x.to_amplitude(i); }) / per_field;
  }
  for (PortEntry const& e : ports_) {
    a.by_port.push_back(e.way ? r.to_stray(*e.way) * (1.0 / darm) : StrayResponse{});
    Injection const i = model_->injection(e.injection_point);
    NetworkBeam const lit = e.way ? e.way->lit.beam : NetworkBeam{i.port, i.of_leaving};
    a.passing.push_back(r.to_stray(passing(asked_.network, lit)).amplitude() / darm);
  }
  return a;
}

RecycledInterferometer::Answer const& RecycledInterferometer::answer(double hz) const {
  std::scoped_lock const lock(mutex_);
  auto const found = answers_.find(hz);
  return found != answers_.end() ? found->second : answers_.emplace(hz, solved(hz)).first->second;
}

std::complex<double> RecycledInterferometer::phase(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  Answer const& a = answer(hz);
  return e.way ? a.by_port[port.value].phase() : a.phase[std::size_t(e.injection_point)];
}
std::complex<double> RecycledInterferometer::amplitude(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  Answer const& a = answer(hz);
  return e.way ? a.by_port[port.value].amplitude() : a.amplitude[std::size_t(e.injection_point)];
}

std::complex<double> RecycledInterferometer::strain_per_phase(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  std::complex<double> const quieted =
      e.place() == entrance_names[std::size_t(InjectionPoint::input_bench)] ? suppression(servos_.frequency(hz)) : 1.0;
  return e.field_share * quieted * phase(port, hz);
}
std::complex<double> RecycledInterferometer::strain_per_amplitude(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  std::complex<double> const quieted =
      e.place() == entrance_names[std::size_t(InjectionPoint::input_bench)] ? suppression(servos_.intensity(hz)) : 1.0;
  return e.field_share * quieted * amplitude(port, hz);
}
std::optional<std::complex<double>> RecycledInterferometer::strain_per_passing_amplitude(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  if (!e.way && is_behind_the_end(e.injection_point)) return 0;
  if (e.picked_off()) return {};
  std::complex<double> const quieted =
      e.place() == entrance_names[std::size_t(InjectionPoint::input_bench)] ? suppression(servos_.intensity(hz)) : 1.0;
  return quieted * answer(hz).passing[port.value];
}
double RecycledInterferometer::largest_response(PortId port, double hz) const {
  return std::fmax(std::abs(phase(port, hz)), std::abs(amplitude(port, hz)));
}

DetectorNumbers RecycledInterferometer::numbers() const {
  P const& p = model_->parameters();
  ArmCavity const arm{p.arm_length, p.input_transmission, p.end_transmission, p.round_trip_loss};
  return {p.arm_length,
          model_->arm_power(),
          p.mirror_mass,
          finesse(arm),
          differential_mode(arm, p.signal_recycling_transmission).gain,
          p.input_transmission,
          p.end_transmission};
}

std::string RecycledInterferometer::description() const {
  P const& p = model_->parameters();
  constexpr double hz = 10;
  double const inertia = speed_of_light * p.mirror_mass * std::pow(2 * pi * hz, 2) * p.arm_length,
               gain = std::abs(answer(hz).amplitude[std::size_t(InjectionPoint::arm)]) * inertia /
                      (8 * model_->arm_power());
  std::string const readout =
      !readout_.empty() ? fmt::format("'{}'", readout_)
      : p.dark_fringe_offset != 0
          ? fmt::format("power of the carrier with {:g} pm of DARM offset", p.dark_fringe_offset * 1e12)
          : fmt::format("homodyne at {:g} deg", p.homodyne_angle * 180 / pi);
  return fmt::format(
             "dual-recycled Fabry-Perot Michelson '{}', {} with radiation pressure, free of closed forms; "
             "read-out: {}, calibrated as DARM, h = (dLx - dLy)/L, {}; lambda "
             "{:g} nm, L {:g} m, P {:.5g} W per arm from "
             "{:.4g} W, M {:g} kg, signal recycling {:g} % tuned to {:g} deg, at {:g} Hz Gamma of "
             "eq. 9.2 {:.4g} and gain of a field in the arm without radiation pressure {:.4g}, f_p {:.4g} Hz",
             name_, wave_text(model_->network()), readout, describe(asked_), p.wavelength * 1e9, p.arm_length,
             model_->arm_power(), p.input_power, p.mirror_mass, 100 * p.signal_recycling_transmission,
             p.signal_recycling_tuning * 180 / pi, hz, gain, std::abs(model_->stray_gain(hz)), model_->pole()) +
         (model_->changed() ? ", network changed by the scene" : "") + describe(ports_, *this, band_);
}

namespace {

// Numbers of a preset with those of the table in their place.
P read_numbers(Node const& table, DualRecycledPreset const& preset, double wavelength) {
  P p = preset.parameters;
  if (std::isnan(wavelength)) wavelength = p.wavelength;
  for (Key<P> const& k : recycled_keys) p.*(k.member) = table.number(k.name, k.dimension, p.*(k.member), k.low, k.high);
  read_power(table, p);
  if (!std::isnan(preset.parameters.arm_length) && !(std::fabs(wavelength / p.wavelength - 1) <= 1e-3))
    table.warning(fmt::format("'{}' runs at {:g} nm, the beams of the scene at {:g} nm", preset.name,
                              p.wavelength * 1e9, wavelength * 1e9),
                  fmt::format("give the beams 'wavelength: {:g} nm'; the interferometer now takes that of the beams",
                              p.wavelength * 1e9));
  p.wavelength = wavelength;
  if (p.transmission_difference != 0 || p.loss_difference != 0) {
    double const largest = p.input_transmission * (1 + std::fabs(p.transmission_difference) / 2);
    if (!(largest < 1) || !(std::fabs(p.loss_difference) / 2 <= p.round_trip_loss))
      table.problem("the differences of the arms give a mirror a transmission or loss below 0 or above 1",
                    "make them smaller");
  }
  refuse_keys_at_odds(table, p);
  return p;
}

struct SolvedPreset {
  std::unique_ptr<DualRecycled> detector{};
  NetworkModel asked{};
};

// With the changes and questions of the table; nothing with a problem.
std::optional<SolvedPreset> solve_preset(Node const& table, std::string_view name, P const& p,
                                         std::vector<Modulation> const& modulators,
                                         std::vector<DrawnOptic> const& optics) {
  SolvedPreset solved{std::make_unique<DualRecycled>(p, modulators)};
  Node const network = table.table("network");
  if (network) {
    NetworkChanges const changes = read_changes_of_preset(network, *solved.detector, optics);
    if (!changes.empty() && table.healthy()) solved.detector = changed(network, p, modulators, changes);
    if (!table.healthy()) return {};
  }
  solved.asked = solved.detector->model(std::string(name));
  if (network) {
    read_network_questions(network, solved.asked);
    network.refuse_unknown("a network");
    if (!table.healthy()) return {};
  }
  return solved;
}

}  // namespace

std::optional<NetworkModel> read_preset_network(Node const& table, DualRecycledPreset const& preset, double wavelength,
                                                std::vector<DrawnOptic> const& optics) {
  P const p = read_numbers(table, preset, wavelength);
  std::vector<Modulation> const modulators = read_modulators(table);
  if (!table.healthy()) return {};
  auto solved = solve_preset(table, preset.name, p, modulators, optics);
  return solved ? std::optional(std::move(solved->asked)) : std::nullopt;
}

std::unique_ptr<Interferometer> read_recycled_interferometer(Node const& table, DualRecycledPreset const& preset,
                                                             std::vector<TracedPort> const& ports, double wavelength,
                                                             Band const& band, std::vector<DrawnOptic> const& optics) {
  table.has("network");  // known, though only read where the preset can be solved
  P const p = read_numbers(table, preset, wavelength);
  RecycledInterferometer::Servos servos;
  if (Node const loop = table["frequency_servo"]) servos.frequency = read_transfer_function(loop, band);
  if (Node const loop = table["intensity_servo"]) servos.intensity = read_transfer_function(loop, band);
  std::vector<Modulation> const modulators = read_modulators(table);
  auto const arms = double(table.whole("arms", 2, 1, 1000));
  std::vector<PortEntry> entries = read_port_entries(table, ports, arms);
  warn_of_idle_servos(table, entries);
  if (!table.healthy()) return nullptr;
  auto solved = solve_preset(table, preset.name, p, modulators, optics);
  if (!solved) return nullptr;
  DualRecycled const& model = *solved->detector;
  resolve_beams(table, model.network(), arms, entries);
  if (!table.healthy()) return nullptr;
  NetworkModel& asked = solved->asked;
  add_entrances(entries, asked);
  std::string const readout = read_by(table, asked, *solved->detector);
  refuse_a_blind_readout(table, model, band);
  read_control_loops(table, asked, band);
  read_subtracted_channels(table, asked, band);
  if (table.healthy()) check_control_loops(table, asked, model.field(), band);
  if (table.healthy()) warn_of_other_modes(table, asked, model.field(), entries, band);
  warn_of_other_arms(table, ports, entries, model.arm_power(), p.arm_length);
  auto ifo = std::make_unique<RecycledInterferometer>(std::string(preset.name), std::move(solved->detector), entries,
                                                      servos, band, std::move(asked), readout);
  refuse_ports_without_response(table, *ifo, entries, band);
  return ifo;
}

}  // namespace straytrace::ifo
