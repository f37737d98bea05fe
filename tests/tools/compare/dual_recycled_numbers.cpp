// SPDX-License-Identifier: BSD-3-Clause
// Prints, as JSON, dual-recycled interferometers and the results of the network solver, for test_finesse.py:
// powers at every port of every component, in W, and how the power at the dark port answers. With the argument `gain`,
// for tools/pictures/draw_gain.py: the value that replaces Gamma in eq. 9.2 at each frequency.
#include <fmt/core.h>

#include <cmath>
#include <string>

#include "base/every_module.hpp"
#include "ifo/control_loops.hpp"
#include "ifo/dual_recycled.hpp"

namespace {

using namespace straytrace;

std::string pair(Phasor z) { return fmt::format("[{:.17g}, {:.17g}]", z.real(), z.imag()); }

void print(std::string const& name, DualRecycledParameters const& p, std::vector<Modulation> const& modulators) {
  DualRecycled const d(p, modulators);
  fmt::print("\"{}\": {{\"parameters\": {{", name);
  auto const number = [](char const* key, double value) { fmt::print("\"{}\": {:.17g}, ", key, value); };
  number("wavelength", p.wavelength);
  number("arm_length", p.arm_length);
  number("input_transmission", p.input_transmission);
  number("end_transmission", p.end_transmission);
  number("round_trip_loss", p.round_trip_loss);
  number("mirror_mass", p.mirror_mass);
  number("input_power", p.input_power);
  number("power_recycling_transmission", p.power_recycling_transmission);
  number("signal_recycling_transmission", p.signal_recycling_transmission);
  number("signal_recycling_tuning", p.signal_recycling_tuning);
  number("beam_splitter_loss", p.beam_splitter_loss);
  number("splitter_transmission", p.splitter_transmission);
  number("power_recycling_length", p.power_recycling_length);
  number("signal_recycling_length", p.signal_recycling_length);
  number("short_arm", p.short_arm);
  number("schnupp_asymmetry", p.schnupp_asymmetry);
  number("transmission_difference", p.transmission_difference);
  number("loss_difference", p.loss_difference);
  number("dark_fringe_offset", p.dark_fringe_offset);
  fmt::print("\"modulators\": [");
  for (std::size_t i = 0; i < modulators.size(); ++i)
    fmt::print("{}[{:.17g}, {:.17g}]", i > 0 ? ", " : "", modulators[i].hz, modulators[i].index);
  fmt::print("]}},\n \"powers\": {{");
  bool first = true;
  for (Network::Component const& c : d.network().components())
    for (std::uint32_t port = 0; port < c.ports; ++port) {
      fmt::print("{}\"{} {}\": [{:.17g}, {:.17g}]", first ? "" : ", ", c.name, port,
                 d.field().power_in(c.first_port + port), d.field().power_out(c.first_port + port));
      first = false;
    }
  fmt::print("}},\n \"responses\": [");
  Readout const power = Readout::power(d.network().number_of({d.network().find("dark"), 0}));
  for (int i = 0; i <= 24; ++i) {
    double const hz = std::pow(10, 0.5 + i / 8.0);
    LinearResponse const r = d.response(power, hz);
    Injection const input = d.injection(InjectionPoint::input_bench);
    fmt::print("{}{{\"hz\": {:.17g}, \"DARM\": {}, \"laser amplitude\": {}, \"laser phase\": {}}}",
               i > 0 ? ",\n  " : "", hz, pair(d.to_freedom(r, Freedom::darm)), pair(r.to_amplitude(input)),
               pair(r.to_phase(input)));
  }
  fmt::print("]}}");
}

// Lines "name tuning hz value": |h per Re s| of light in an arm over 8 P/(c M (2 pi f)^2 L).
void print_gains() {
  for (DualRecycledPreset const& preset : dual_recycled_presets())
    for (double const tuning : {0.0, -0.3}) {
      if (tuning != 0 && !preset.name.starts_with("et-")) continue;
      DualRecycledParameters p = preset.parameters;
      p.signal_recycling_tuning = tuning;
      DualRecycled const d(p);
      NetworkModel const model = d.model("");
      Injection const arm = d.injection(InjectionPoint::arm);
      for (int i = 0; i <= 80; ++i) {
        double const hz = std::pow(10, i / 40.0);
        CalibratedStrain const r(model, d.field(), hz);
        double const h = std::abs(r.to([&](LinearResponse const& x) { return x.to_amplitude(arm); }) / r.per_metre());
        fmt::print("{} {} {:.6g} {:.6g}\n", preset.name, tuning, hz,
                   h * speed_of_light * p.mirror_mass * std::pow(2 * pi * hz, 2) / (8 * d.arm_power()));
      }
    }
}

}  // namespace

int main(int count, char** words) {
  if (count > 1 && std::string_view(words[1]) == "gain") {
    print_gains();
    return 0;
  }
  DualRecycledParameters const tuned = dual_recycled_presets()[0].parameters;
  DualRecycledParameters detuned = tuned;
  detuned.signal_recycling_tuning = 0.3;  // an optical spring
  detuned.beam_splitter_loss = 1e-3;
  detuned.splitter_transmission = 0.49;
  detuned.transmission_difference = 0.01;
  detuned.loss_difference = 30e-6;
  detuned.dark_fringe_offset = 20e-12;
  fmt::print("{{");
  print("tuned", tuned, {});
  fmt::print(",\n");
  print("detuned, arms not equal", detuned, {});
  fmt::print(",\n");
  print("with sidebands", tuned, {{6270777, 0.1}});
  fmt::print("}}\n");
}
