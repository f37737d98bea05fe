// SPDX-License-Identifier: BSD-3-Clause
// Small networks whose results another program gives too: phases as eq. N.31 turns them into ours.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "ifo/network.hpp"

namespace straytrace::testing {

inline constexpr double light_wavelength = 1064e-9, slow_hz = 6270777, fast_hz = 56436993;

inline double relative(double a, double b) { return std::fabs(a / b - 1); }
inline double relative(Phasor a, Phasor b) { return std::abs(a / b - 1.0); }

// 1 W, modulated, onto a cavity of 3 km with mirrors of 2 % and 0.4 %; the end mirror is `longer` m further.
struct ModulatedCavity {
  Network network{light_wavelength};
  ComponentId laser, input, end;
  explicit ModulatedCavity(double longer, int order = 1) {
    laser = network.add_laser("laser", 1);
    ComponentId const eom = network.add_modulator("EOM", 0.1, slow_hz, order);
    input = network.add_mirror("M1", {.transmission = 0.02});
    end = network.add_mirror("M2", {.transmission = 0.004, .displacement = longer});
    network.link({laser, 0}, {eom, 0}, 0);
    network.link({eom, 1}, {input, 0}, 0, -pi / 4);
    network.link({input, 1}, {end, 0}, 3000, -pi / 2);
  }
  std::uint32_t inside() const { return network.number_of({input, 1}); }
  std::uint32_t outside() const { return network.number_of({input, 0}); }
  Readout error_signal(double phase) const { return Readout::demodulated(outside(), slow_hz, phase).of_leaving(); }
};

// 1 W, modulated, through a splitter of 52 %; `tuning` of arm x in rad as another program counts it: -x k. With
// `in_space`: as phase of the space, alike for all carriers.
struct ModulatedMichelson {
  Network network{light_wavelength};
  ComponentId splitter, x, y;
  explicit ModulatedMichelson(double tuning, bool in_space = false, MirrorParameters const& of_splitter = standard()) {
    double const k = 2 * pi / light_wavelength;
    ComponentId const laser = network.add_laser("laser", 1), eom = network.add_modulator("EOM", 0.1, fast_hz);
    splitter = network.add_splitter("BS", of_splitter);
    x = network.add_mirror("X", {.transmission = 0.01, .loss = 5e-5, .displacement = in_space ? 0 : -tuning / k});
    y = network.add_mirror("Y", {.transmission = 0.012, .loss = 5e-5, .displacement = in_space ? 0 : -pi / 2 / k});
    network.link({laser, 0}, {eom, 0}, 0);
    network.link({eom, 1}, {splitter, 0}, 1, -pi / 4);
    network.link({splitter, 2}, {x, 0}, 6.115, -pi / 2 + (in_space ? -tuning : 0));
    network.link({splitter, 1}, {y, 0}, 5.885, -pi / 2 + (in_space ? -pi / 2 : 0));
  }
  static MirrorParameters standard() { return {.transmission = 0.52, .loss = 1e-4, .incidence = pi / 4}; }
  std::uint32_t dark() const { return network.number_of({splitter, 3}); }
  Readout power() const { return Readout::power(dark()).of_leaving(); }
  Readout demodulated(double phase) const { return Readout::demodulated(dark(), fast_hz, phase).of_leaving(); }
};

// A triangle of two splitters of 0.25 %, 0.4 m apart, and a curved one 143 m away, moved by `moved` m.
struct Ring {
  Network network;
  ComponentId first, second, third;
  explicit Ring(double moved, LinearPolarisation polarisation = LinearPolarisation::s, bool normal = false)
      : network(light_wavelength, polarisation) {
    double const a = std::asin(0.2 / 143.226);
    ComponentId const laser = network.add_laser("laser", 1);
    MirrorParameters const corner{.transmission = 0.0025, .incidence = normal ? 0 : (pi / 2 - a) / 2};
    first = network.add_splitter("M1", corner);
    second = network.add_splitter("M2", corner);
    third = network.add_splitter(
        "M3", {.transmission = 5e-6, .loss = 100e-6, .displacement = moved, .incidence = normal ? 0 : a});
    network.link({laser, 0}, {first, 0}, 0, -pi / 4);
    network.link({first, 2}, {second, 0}, 0.4, -pi / 2);
    network.link({second, 1}, {third, 0}, 143.226, -pi / 2);
    network.link({third, 1}, {first, 3}, 143.226, -pi / 2);
  }
  std::uint32_t inside() const { return network.number_of({first, 2}); }
  std::uint32_t reflected() const { return network.number_of({first, 1}); }
  std::uint32_t transmitted() const { return network.number_of({second, 2}); }
};

}  // namespace straytrace::testing
