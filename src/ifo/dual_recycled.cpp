// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/dual_recycled.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace straytrace {
namespace {

constexpr double probe_hz = 1e-3;  // far below any pole: the shape of the slow answer

}  // namespace

DualRecycled::DualRecycled(DualRecycledParameters const& p, std::vector<Modulation> const& modulations)
    : p_(p), modulations_(modulations), network_(p.wavelength) {
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
    ComponentId const eom =
        network_.add_modulator("modulator " + std::to_string(&m - modulations_.data()), m.index, m.hz);
    network_.link(beam, {eom, 0}, 0);
    beam = {eom, 1};
  }
  ComponentId const prm = network_.add_mirror("PRM", {.transmission = p_.power_recycling_transmission}),
                    splitter = network_.add_splitter(
                        "BS",
                        {.transmission = p_.splitter_transmission * (1 - once), .loss = once, .incidence = pi / 4}),
                    cavity = network_.add_isolator("signal cavity", kept, kept),
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
}

void DualRecycled::build_arms(ComponentId splitter) {
  Suspension const suspension{.mass = p_.mirror_mass, .resonance = p_.pendulum_frequency};
  for (int const arm : {0, 1}) {
    double const sign = arm == 0 ? 0.5 : -0.5, loss = p_.round_trip_loss + sign * p_.loss_difference;
    std::string const name = arm == 0 ? " x" : " y";
    ComponentId const itm = network_.add_mirror("ITM" + name, {.transmission = p_.input_transmission *
                                                                               (1 + sign * p_.transmission_difference),
                                                               .suspension = suspension}),
                      etm = network_.add_mirror("ETM" + name, {.transmission = p_.end_transmission,
                                                               .loss = loss * (1 - p_.end_transmission),
                                                               .displacement = sign * p_.dark_fringe_offset,
                                                               .suspension = suspension}),
                      bench = network_.add_dump("bench" + name);
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
    return DualRecycled(tuned, modulations_).signal_;
  }
  std::uint32_t const dark = network_.number_of({network_.find("dark"), 0});
  Phasor seen[2];
  for (int i : {0, 1}) seen[i] = to_freedom(response(Readout::homodyne(dark, i * pi / 2), probe_hz), Freedom::darm);
  // Both are of one phase so far below the pole; the sum of squares does not vanish as the plain sum can.
  Phasor const unit = std::abs(seen[0]) > std::abs(seen[1]) ? seen[0] / std::abs(seen[0]) : seen[1] / std::abs(seen[1]);
  double const read = std::atan2(std::real(seen[1] / unit), std::real(seen[0] / unit));
  return {read, response(Readout::homodyne(dark, read), probe_hz).seen_quadrature(dark)};
}

double DualRecycled::power_at(char const* component, std::uint32_t port) const {
  return field_->power_in(network_.number_of({network_.find(component), port}));
}

double DualRecycled::recycling_gain() const { return power_at("BS", 0) / p_.input_power; }

// Lengths become displacements with the splitter at rest.
Phasor DualRecycled::to_freedom(LinearResponse const& r, Freedom f) const {
  Eigen::Matrix<double, 6, 1> const length = lengths_of_freedoms().col(Eigen::Index(f));
  auto const of = [&](Length l) { return length[Eigen::Index(l)]; };
  auto const to = [&](char const* name) { return r.to_displacement(network_.find(name)); };
  Phasor sum = to("SRM") * of(Length::signal) - to("PRM") * of(Length::recycling);
  sum += to("ITM x") * of(Length::short_x) + to("ETM x") * (of(Length::short_x) + of(Length::arm_x));
  return sum + to("ITM y") * of(Length::short_y) + to("ETM y") * (of(Length::short_y) + of(Length::arm_y));
}

Injection DualRecycled::injection(InjectionPoint injection_point) const {
  struct Way {
    char const* component;
    std::uint32_t port;
    bool joins_leaving, of_leaving;
    double turn;
  };
  // The light of a bench passes the end mirror twice, t against the i r of reflection: a bench at such a distance that
  // Re s comes back in phase with the light in the arm.
  constexpr std::array<Way, entrance_names.size()> ways = {{{"ITM x", 1, true, true, 0},
                                                            {"ETM x", 0, true, true, 0},
                                                            {"ETM x", 1, false, true, pi / 2},
                                                            {"ETM x", 1, false, true, pi / 2},
                                                            {"ITM x", 0, false, false, 0},
                                                            {"BS", 0, false, false, 0},
                                                            {"SRM", 0, false, false, 0},
                                                            {"SRM", 1, false, true, 0},
                                                            {"PRM", 0, false, true, 0},
                                                            {"PRM", 0, false, false, 0}}};
  Way const& way = ways[std::size_t(injection_point)];
  std::uint32_t const port = network_.number_of({network_.find(way.component), way.port});
  return {port, way.joins_leaving, way.of_leaving, way.turn};
}

double DualRecycled::share_outside(InjectionPoint e) const {
  return e == InjectionPoint::through_end ? p_.end_transmission : 1;
}

double DualRecycled::reference(InjectionPoint e) const {
  Injection const i = injection(e);
  return std::sqrt((i.of_leaving ? field_->power_out(i.port) : field_->power_in(i.port)) / arm_power());
}

bool DualRecycled::sees_darm(double hz) const {
  auto const size = [&](double turn) {
    Readout const r = Readout::homodyne(readout_.port, readout_.angle + turn);
    return std::abs(to_freedom(response(r, hz), Freedom::darm));
  };
  return size(0) > 1e-9 * size(pi / 2);
}

std::unique_ptr<DualRecycled> DualRecycled::without_radiation_pressure() const {
  DualRecycledParameters heavy = p_;
  heavy.mirror_mass = infinity;
  heavy.arm_power = 0;
  return std::make_unique<DualRecycled>(heavy, modulations_);
}

StrayGain DualRecycled::stray_gain(double hz) const {
  auto const heavy = without_radiation_pressure();
  Injection const arm = injection(InjectionPoint::arm);
  StrayGain gain;
  for (char const* end : {"ETM x", "ETM y"}) {
    LinearResponse const r = heavy->response(Readout::power(network_.number_of({network_.find(end), 0})), hz);
    double const factor = (end[4] == 'x' ? 0.5 : -0.5) / arm_power();
    gain.amplitude += factor * r.to_amplitude(arm);
    gain.phase += factor * r.to_phase(arm);
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

constexpr std::array<Freedom, 4> locked = {Freedom::carm, Freedom::mich, Freedom::prcl, Freedom::srcl};

// The length itself as a read-out, with the splitter at rest.
Readout length_of(Network const& n, Freedom f) {
  Eigen::Matrix<double, 1, 6> const of = freedoms_of_lengths().row(Eigen::Index(f));
  auto const part = [&](Length l) { return of[Eigen::Index(l)]; };
  double const x = part(Length::arm_x), y = part(Length::arm_y);
  return Readout::motion({{n.find("ETM x"), x},
                          {n.find("ITM x"), part(Length::short_x) - x},
                          {n.find("ETM y"), y},
                          {n.find("ITM y"), part(Length::short_y) - y},
                          {n.find("PRM"), -part(Length::recycling)},
                          {n.find("SRM"), part(Length::signal)}});
}

}  // namespace

HeldResponse::HeldResponse(DualRecycled const& d, double hz) : d_(d), read_(d.response(hz)) {
  Eigen::Matrix<Phasor, loops, loops> moves;
  Eigen::Matrix<Phasor, 1, loops> seen;
  for (int i = 0; i < loops; ++i) {
    lengths_.push_back(d.response(length_of(d.network(), locked[std::size_t(i)]), hz));
    seen[i] = d.to_freedom(read_, locked[std::size_t(i)]);
    for (int j = 0; j < loops; ++j) moves(i, j) = d.to_freedom(lengths_.back(), locked[std::size_t(j)]);
  }
  per_length_ = seen * moves.inverse();
}

template <class Cause>
Phasor HeldResponse::held(Cause const& cause) const {
  Phasor sum = cause(read_);
  for (int i = 0; i < loops; ++i) sum -= per_length_[i] * cause(lengths_[std::size_t(i)]);
  return sum;
}
Phasor HeldResponse::to_freedom(Freedom f) const {
  return held([&](LinearResponse const& r) { return d_.to_freedom(r, f); });
}
Phasor HeldResponse::to_phase(Injection const& i) const {
  return held([&](LinearResponse const& r) { return r.to_phase(i); });
}
Phasor HeldResponse::to_amplitude(Injection const& i) const {
  return held([&](LinearResponse const& r) { return r.to_amplitude(i); });
}

}  // namespace straytrace
