// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/network_interferometer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "base/errors.hpp"
#include "ifo/control_loops.hpp"
#include "ifo/layout/read_network.hpp"

namespace straytrace::ifo {

NetworkInterferometer::NetworkInterferometer(NetworkModel model, std::string readout, std::vector<PortEntry> ports,
                                             Band const& band)
    : model_(std::move(model)),
      readout_(std::move(readout)),
      field_(model_.network),
      ports_(std::move(ports)),
      band_(band) {}

std::vector<NetworkInterferometer::Answer> const& NetworkInterferometer::answer(double hz) const {
  std::scoped_lock const lock(mutex_);
  if (auto const found = answers_.find(hz); found != answers_.end()) return found->second;
  CalibratedStrain const strain(model_, field_, hz);
  if (!(std::abs(strain.calibration()) > 0))
    throw NumericalError(
        fmt::format("the read-out '{}' has no response to '{}'", readout_, model_.strain->freedom.name));
  std::vector<Answer> all;
  for (PortEntry const& e : ports_) {
    Answer& a = all.emplace_back();
    if (!e.way) continue;
    a.stray = strain.to_stray(*e.way) * (e.field_share / strain.calibration());
    a.passing = strain.to_stray(passing(model_.network, e.way->lit.beam)) * (1.0 / strain.calibration());
  }
  return answers_.emplace(hz, std::move(all)).first->second;
}

std::complex<double> NetworkInterferometer::strain_per_phase(PortId port, double hz) const {
  return answer(hz).at(port.value).stray.phase();
}
std::complex<double> NetworkInterferometer::strain_per_amplitude(PortId port, double hz) const {
  return answer(hz).at(port.value).stray.amplitude();
}

std::optional<std::complex<double>> NetworkInterferometer::strain_per_passing_amplitude(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  if (!e.way || e.picked_off()) return {};
  return answer(hz).at(port.value).passing.amplitude();
}

std::string NetworkInterferometer::description() const {
  StrainScale const& s = *model_.strain;
  return fmt::format(
             "network of the scene, {} with radiation pressure: read-out '{}' calibrated as '{}' over {:g} m, "
             "no length held{}; lambda {:g} nm",
             wave_text(model_.network), readout_, s.freedom.name, s.length, describe(model_),
             model_.network.wavelength() * 1e9) +
         describe(ports_, *this, band_);
}

namespace {

template <class Named>
Named const* find_named(Node const& node, std::string const& name, std::vector<Named> const& all, char const* what,
                        char const* key) {
  auto const hit = std::ranges::find(all, name, &Named::name);
  if (hit != all.end()) return &*hit;
  std::vector<std::string> names;
  for (Named const& n : all) names.push_back(n.name);
  node.problem(fmt::format("the network has no {} '{}'", what, name),
               did_you_mean(name, names, fmt::format("add it to '{}' of the network", key)));
  return nullptr;
}

struct Stated {
  std::string readout;
  StrainScale scale;
};

std::optional<Stated> read_strain(Node const& interferometer, NetworkModel const& model) {
  Node const node = interferometer.table("strain");
  if (!node) return {};
  std::string const readout = node.word("readout"), freedom = node.word("freedom", "DARM");
  double const length = node.number("arm_length", dim::length, required, 1e-6, 1e12);
  node.refuse_unknown("the strain of a network");
  if (!interferometer.healthy()) return {};
  NamedReadout const* const r = find_named(node["readout"], readout, model.readouts, "read-out", "readouts");
  NamedFreedom const* const f = find_named(node.has("freedom") ? node["freedom"] : node, freedom, model.freedoms,
                                           "degree of freedom", "freedoms");
  if (!r || !f) return {};
  return Stated{readout, {r->readout, *f, length}};
}

// What a port of a network without a preset needs.
void refuse_ports_without_beams(Node const& table, std::vector<PortEntry> const& entries) {
  for (PortEntry const& e : entries)
    if (e.at.empty() && !table["ports"][e.name].has("at") && !has_response_files(table, e.name))
      place_of_entrance(table, e.name)
          .problem(fmt::format("the network does not say where light of port '{}' joins", e.name),
                   fmt::format("name the beam that it joins: 'ports: {{{}: {{at: ITM.front.in}}}}'", e.name));
}

// A stray field is relative to the light that is scattered: without any, the solution is rounding.
void refuse_dark_places(Node const& table, NetworkInterferometer const& ifo, std::vector<PortEntry> const& entries) {
  double most = 0;
  for (std::uint32_t p = 0; p < ifo.network()->network.ports(); ++p) most = std::fmax(most, ifo.field().power_out(p));
  for (PortEntry const& e : entries)
    if (e.way && !(lighting_power(*e.way, ifo.field()) > 1e-24 * most))
      place_of_entrance(table, e.name)
          .problem(fmt::format("no light comes from '{}', so a relative stray field is not defined",
                               beam_name(ifo.network()->network, e.way->lit.beam)),
                   "name the beam whose light is scattered by 'lit_by'");
}

// Without a response to the degree of freedom nothing becomes strain.
void refuse_blind_strain(Node const& strain, NetworkInterferometer const& ifo, Band const& band) {
  StrainScale const& s = *ifo.network()->strain;
  if (!sees(ifo.network()->network, ifo.field(), s.readout, s.freedom, std::sqrt(band.low * band.high)))
    strain["readout"].problem(
        fmt::format("'{}' does not respond to '{}'", strain["readout"].text(), s.freedom.name),
        "name a read-out with light that changes with it; at a dark fringe or the top of a resonance, state an offset");
}

}  // namespace

void warn_of_other_modes(Node const& table, NetworkModel const& model, SteadyField const& field,
                         std::vector<PortEntry> const& entries, Band const& band) {
  constexpr double small = 1e-3;
  if (!model.network.modes()) return;
  CalibratedStrain const strain(model, field, std::sqrt(band.low * band.high));
  LinearResponse const response = strain.whole().response;
  for (PortEntry const& e : entries) {
    auto const place = e.way ? std::nullopt : entrance_in(model.network, field, e.injection_point);
    if (has_response_files(table, e.name) || (!e.way && !place)) continue;
    auto const [light, weight] = beyond_fundamental(response, model.network, field, e.way ? *e.way : place->way);
    if (!(std::fmax(light, weight) > small)) continue;
    place_of_entrance(table, e.name)
        .warning(
            fmt::format("at port '{}', {:.2g} of the light and {:.2g} of the weight of the beam it joins are not in "
                        "mode 00, and the response to stray light leaves them out (eq. N.16)",
                        e.name, light, weight),
            "match curvatures and tilts of the network; --show modes says where they do not match");
  }
}

std::unique_ptr<Interferometer> read_network_interferometer(Node const& table, std::vector<TracedPort> const& ports,
                                                            double wavelength, Band const& band,
                                                            std::vector<DrawnOptic> const& optics) {
  std::optional<NetworkModel> model = read_bare_network(table, wavelength, optics);
  if (!table.has("strain")) {
    if (!ports.empty())
      table["preset"].problem("a network without a preset does not say how light of the ports becomes strain",
                              "add 'strain: {readout: AS, freedom: DARM, arm_length: 3 km}' with names of the network, "
                              "and to 'ports' the beam that each joins: '{at: ITM.front.in}'; or start from a preset");
    return nullptr;
  }
  std::vector<PortEntry> entries = read_port_entries(table, ports, 1);
  refuse_ports_without_beams(table, entries);
  if (!model || !table.healthy()) return nullptr;
  auto const strain = read_strain(table, *model);
  resolve_beams(table, model->network, 1, entries);
  resolve_places(table, model->network, entries);
  if (!strain || !table.healthy()) return nullptr;
  model->strain = strain->scale;
  add_entrances(entries, *model);
  read_subtracted_channels(table, *model, band);
  auto ifo = std::make_unique<NetworkInterferometer>(*std::move(model), strain->readout, entries, band);
  refuse_dark_places(table, *ifo, entries);
  if (table.healthy()) refuse_blind_strain(table["strain"], *ifo, band);
  if (table.healthy()) warn_of_other_modes(table, *ifo->network(), ifo->field(), entries, band);
  return table.healthy() ? std::move(ifo) : nullptr;
}

}  // namespace straytrace::ifo
