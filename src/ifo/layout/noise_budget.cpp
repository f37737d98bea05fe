// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/noise_budget.hpp"

#include <algorithm>
#include <cmath>

#include "ifo/layout/signals.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {

double vacuum_beside_carriers(Network const& network, SteadyField const& field, Readout const& r,
                              Readout const& other) {
  constexpr auto demodulated = Readout::Kind::demodulated;
  if (r.kind != demodulated || other.kind != demodulated || r.port != other.port || r.leaving != other.leaving ||
      r.hz != other.hz)
    return 0;
  double outside = 0;  // W: each carrier beats with the vacuum on either side
  std::vector<double> const& carriers = field.carriers();
  for (std::size_t n = 0; n < carriers.size(); ++n)
    for (double const beat : {r.hz, -r.hz})
      if (!carrier_at(carriers, carriers[n] + beat))
        for (std::size_t mode = 0; mode < field.modes(); ++mode)
          outside += std::norm(r.leaving ? field.out(r.port, n, mode) : field.in(r.port, n, mode));
  return hbar * network.wavenumber() * speed_of_light / 2 * outside * std::cos(r.angle - other.angle);
}

double vacuum_noise(Network const& network, SteadyField const& field, Readout const& r, double hz) {
  return LinearResponse(network, field, r, hz).quantum_noise() + vacuum_beside_carriers(network, field, r, r);
}

namespace {

void add_total(ReadoutNoise& noise) {
  for (std::size_t i = 0; i < noise.hz.size(); ++i) {
    double sum = 0;
    for (auto const& part : noise.asd) sum += part[i] * part[i];
    noise.total.push_back(std::sqrt(sum));
  }
}

}  // namespace

ReadoutNoise noise_of(NetworkModel const& model, NamedReadout const& readout, NamedFreedom const* referred,
                      std::vector<double> const& hz) {
  SteadyField const field(model.network);
  ReadoutNoise noise{.hz = hz, .names = {"vacuum"}};
  for (NamedNoise const& n : model.noises) noise.names.push_back(n.cause.name);
  noise.asd.resize(noise.names.size());
  for (double const f : hz) {
    LinearResponse const r(model.network, field, readout.readout, f);
    double per = 1;
    if (referred)
      per = std::abs(response_to(r, model.network, {"", NetworkCause::Kind::displacement, referred->moves}, f));
    noise.asd[0].push_back(std::sqrt(vacuum_noise(model.network, field, readout.readout, f)) / per);
    for (std::size_t i = 0; i < model.noises.size(); ++i) {
      NamedNoise const& n = model.noises[i];
      noise.asd[i + 1].push_back(std::abs(response_to(r, model.network, n.cause, f)) * n.asd(f) / per);
    }
  }
  add_total(noise);
  return noise;
}

}  // namespace straytrace::ifo
