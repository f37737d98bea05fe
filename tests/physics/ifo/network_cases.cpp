// SPDX-License-Identifier: BSD-3-Clause
// Networks of other topologies against numbers of another program (FINESSE 3.0.2) and closed forms: eq. N.1, N.2, N.3,
// N.10 of docs/theory/interferometer.md. Values in W, W/m.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "base/every_module.hpp"
#include "ifo/dual_recycled.hpp"
#include "ifo/network.hpp"
#include "physics/ifo/network_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_network_cases {
namespace {

using namespace straytrace::testing;

TEST(NetworkCases, ModulatedCavityT1) {
  auto const powers = [](double longer, int order) {
    ModulatedCavity const c(longer, order);
    SteadyField const f(c.network);
    return std::array{f.power_out(c.inside()), f.power_out(c.outside())};
  };
  EXPECT_LT(deviation(powers(0, 1)[0], 137.4527719), 1e-9);
  EXPECT_LT(deviation(powers(0, 1)[1], 0.4501857917), 1e-9);
  EXPECT_LT(deviation(powers(1e-9, 1)[0], 70.42165462), 1e-9);
  EXPECT_LT(deviation(powers(1e-9, 1)[1], 0.7183102608), 1e-9);
  EXPECT_GT(relative(powers(0, 2)[1], 0.4501857917), 1e-8) << "control: second-order bands";
}

// Eq. N.2, N.3: the error signal, its slope by one adjoint solution, and the response of the same read-out.
TEST(NetworkCases, ErrorSignalAndItsSlopeT2) {
  ModulatedCavity const moved(0.2e-9), locked(0);
  SteadyField const off(moved.network), on(locked.network);
  EXPECT_LT(deviation(value_of(moved.error_signal(0), off), -0.03125225501), 1e-7);
  EXPECT_NEAR(value_of(moved.error_signal(pi / 2), off), 2.343934e-6, 1e-12);
  AdjointSlope const in_phase(locked.network, on, locked.error_signal(0)),
      in_quadrature(locked.network, on, locked.error_signal(pi / 2));
  EXPECT_LT(deviation(in_phase.to_displacement(locked.end), -1.62210783e8), 1e-7);
  EXPECT_LT(deviation(in_quadrature.to_displacement(locked.end), 1.2165863e4), 1e-7);
  auto const response = [&](double hz) {
    return LinearResponse(locked.network, on, locked.error_signal(0), hz).to_displacement(locked.end);
  };
  Phasor const stated{-7.8016817e7, -8.1050170e7};
  EXPECT_LT(relative(response(100), stated), 1e-7);
  EXPECT_LT(relative(response(1e-4), Phasor(in_phase.to_displacement(locked.end))), 2e-6) << "f -> 0";
  EXPECT_GT(relative(std::conj(response(100)), stated), 1) << "control: exp(+iwt)";
  EXPECT_GT(relative(AdjointSlope(moved.network, off, moved.error_signal(0)).to_displacement(moved.end), -1.62210783e8),
            1e-2)
      << "control: elsewhere";
}

// Eq. N.3 for every kind of parameter, by central differences; read-outs of entering and leaving light.
TEST(NetworkCases, AdjointSlopesAreDerivatives) {
  ModulatedMichelson const at(0.1);
  SteadyField const field(at.network);
  ComponentId const laser = at.network.find("laser");
  struct Parameter {
    char const* name;
    double step;
    std::function<double(AdjointSlope const&)> slope;
    std::function<void(Network&, double)> change;
  };
  auto const mirror = [&](double MirrorParameters::*member) {
    return [=, x = at.x](Network& n, double by) {
      MirrorParameters p = std::get<MirrorParameters>(n.at(x).stated);
      p.*member += by;
      n.replace(x, Network::mirror("X", p));
    };
  };
  auto const space = [](std::size_t number, double length, double phase) {
    return [=](Network& n, double by) {
      Network::Space const s = n.spaces()[number];
      n.change(number, s.length + by * length, s.phase + by * phase);
    };
  };
  std::array const parameters = {
      Parameter{"displacement", 1e-12, [&](auto const& s) { return s.to_displacement(at.x); },
                mirror(&MirrorParameters::displacement)},
      Parameter{"transmission", 1e-6, [&](auto const& s) { return s.to_transmission(at.x); },
                mirror(&MirrorParameters::transmission)},
      Parameter{"loss", 1e-6, [&](auto const& s) { return s.to_loss(at.x); }, mirror(&MirrorParameters::loss)},
      Parameter{"power", 1e-4, [&](auto const& s) { return s.to_power(laser); },
                [&](Network& n, double by) { n.replace(laser, Network::laser("laser", {1 + by})); }},
      Parameter{"length", 1e-6, [](auto const& s) { return s.to_length(2); }, space(2, 1, 0)},
      Parameter{"phase", 1e-6, [](auto const& s) { return s.to_phase(2); }, space(2, 0, 1)},
      Parameter{"first length", 1e-6, [](auto const& s) { return s.to_length(1); }, space(1, 1, 0)}};
  std::uint32_t const returned = at.network.number_of({at.network.find("EOM"), 1});
  for (Readout const& r : {at.power(), at.demodulated(0.4), Readout::demodulated(returned, fast_hz, 0.4)}) {
    AdjointSlope const slope(at.network, field, r),
        turned(at.network, field, Readout{r.port, r.kind, 1.9, r.hz, {}, r.leaving});
    for (Parameter const& p : parameters) {
      auto const changed = [&](double by) {
        Network n = at.network;
        p.change(n, by);
        return value_of(r, SteadyField(n));
      };
      double const difference = (changed(p.step) - changed(-p.step)) / (2 * p.step);
      double const rounding = 1e-14 / p.step;
      EXPECT_NEAR(p.slope(slope), difference, 3e-5 * std::fabs(difference) + rounding) << p.name << int(r.kind);
      if (r.kind != Readout::Kind::demodulated) continue;
      ASSERT_GT(std::fabs(difference), 1e3 * rounding) << p.name << ": something to see";
      EXPECT_GT(relative(p.slope(turned), difference), 1e-2) << "control: another phase of demodulation " << p.name;
    }
  }
}

TEST(NetworkCases, ModulatedMichelsonT3) {
  struct Row {
    double degrees, power, in_phase, in_quadrature;
  };
  for (Row const& row :
       {Row{5, 7.848924050e-3, 7.459959347e-4, -2.169797922e-3}, {20, 0.1157481733, 2.761427924e-3, -8.031866220e-3}}) {
    ModulatedMichelson const m(row.degrees * pi / 180), flat(row.degrees * pi / 180, true);
    SteadyField const f(m.network), g(flat.network);
    EXPECT_LT(deviation(value_of(m.power(), f), row.power), 1e-9);
    EXPECT_LT(deviation(value_of(m.demodulated(0), f), row.in_phase), 1e-9);
    EXPECT_LT(deviation(value_of(m.demodulated(pi / 2), f), row.in_quadrature), 1e-9);
    // T4: with one wave number for all carriers, as a phase of the space has, 2e-6 are lost.
    EXPECT_NEAR(relative(value_of(flat.demodulated(0), g), row.in_phase), 2.0e-6, 5e-8) << "control: k_0 for k_n";
  }
}

// Eq. N.1 with cos(alpha): a splitter moved by d along its normal turns the light that it reflects in front and behind
// as end mirrors would, moved by d cos(alpha) and -d cos(alpha).
TEST(NetworkCases, IncidenceOfSplittersT3) {
  double const d = 30e-9, cosine = std::cos(pi / 4);
  auto const dark = [&](double incidence, double x, double y, double of_splitter) {
    MirrorParameters p = ModulatedMichelson::standard();
    p.incidence = incidence;
    p.displacement = of_splitter;
    ModulatedMichelson m(0.1, false, p);
    m.network.move(m.x, m.network.at(m.x).displacement + x);
    m.network.move(m.y, m.network.at(m.y).displacement + y);
    return value_of(m.power(), SteadyField(m.network));
  };
  double const by_mirrors = dark(pi / 4, -d * cosine, d * cosine, 0);
  EXPECT_LT(deviation(dark(pi / 4, 0, 0, d), by_mirrors), 1e-6);
  EXPECT_GT(relative(dark(0, 0, 0, d), by_mirrors), 1e-2) << "control: normal incidence";
}

TEST(NetworkCases, ResponseOfMichelsonT5) {
  ModulatedMichelson const m(5 * pi / 180);
  SteadyField const f(m.network);
  auto const response = [&](Readout const& r) {
    return std::abs(LinearResponse(m.network, f, r, 100).to_displacement(m.x));
  };
  EXPECT_LT(deviation(response(m.power()), 1011538.469), 1e-7);
  EXPECT_LT(deviation(response(m.demodulated(0)), 49967.30495), 1e-7);
  EXPECT_GT(relative(response(m.demodulated(pi / 2)), 49967.30495), 1) << "control: the other quadrature";
}

TEST(NetworkCases, RingT6) {
  auto const powers = [](double moved, bool normal) {
    Ring const r(moved, LinearPolarisation::s, normal);
    SteadyField const f(r.network);
    return std::array{f.power_out(r.network.number_of({r.second, 1})), f.power_out(r.reflected()),
                      f.power_out(r.transmitted())};
  };
  EXPECT_LT(deviation(powers(0, false)[0], 382.7944283), 1e-8);
  EXPECT_NEAR(powers(0, false)[1], 4.2205e-4, 5e-9);
  EXPECT_LT(deviation(powers(0, false)[2], 0.9593845320), 1e-8);
  EXPECT_LT(deviation(powers(1e-10, false)[0], 315.4286273), 1e-8);
  EXPECT_LT(deviation(powers(1e-10, false)[1], 0.1763320562), 1e-8);
  EXPECT_LT(deviation(powers(1e-10, false)[2], 0.7905479379), 1e-8);
  EXPECT_GT(relative(powers(1e-10, true)[0], 315.4286273), 2e-7) << "control: normal incidence on the third mirror";
}

// Eq. N.10: three reflections of p light have the other sign, and the resonance is half a free spectral range further.
TEST(NetworkCases, PolarisationOfRings) {
  auto const inside = [](LinearPolarisation polarisation, double moved) {
    Ring const r(moved, polarisation);
    return SteadyField(r.network).power_out(r.inside());
  };
  double const half = light_wavelength / 4;
  EXPECT_LT(deviation(inside(LinearPolarisation::p, half), inside(LinearPolarisation::s, 0)), 1e-4);
  EXPECT_LT(inside(LinearPolarisation::p, 0), 1e-2);
  EXPECT_LT(inside(LinearPolarisation::s, half), 1e-2) << "control: s light";
  ModulatedMichelson m(0.1);
  Network p(light_wavelength, LinearPolarisation::p);
  for (Network::Component const& c : m.network.components()) p.add(c);
  for (std::size_t i = 0; i < m.network.spaces().size(); ++i) {
    Network::Space const& s = m.network.spaces()[i];
    auto const end = [&](std::uint32_t port) {
      ComponentId const id = p.owner_of(port);
      return NetworkPort{id, port - p.at(id).first_port};
    };
    p.link(end(s.from), end(s.to), s.length, s.phase);
  }
  EXPECT_LT(deviation(value_of(m.power(), SteadyField(p)), value_of(m.power(), SteadyField(m.network))), 1e-12)
      << "two reflections on either way";
}

// 10 W into two coupled cavities; `longer`: of the arm, m.
struct Coupled {
  Network network{light_wavelength};
  ComponentId laser, prm, itm, etm;
  explicit Coupled(double longer, double loss = 75e-6) {
    laser = network.add_laser("laser", 10);
    double const quarter = -light_wavelength / 4;
    prm = network.add_mirror("PRM", {.transmission = 0.05});
    itm = network.add_mirror("ITM", {.transmission = 0.014, .displacement = quarter});
    etm = network.add_mirror("ETM", {.transmission = 4.4e-6, .loss = loss, .displacement = quarter + longer});
    network.link({laser, 0}, {prm, 0}, 0, -pi / 4);
    network.link({prm, 1}, {itm, 0}, 11.952, -pi / 2);
    network.link({itm, 1}, {etm, 0}, 2999.8, -pi / 2);
  }
  std::array<double, 3> powers() const {
    SteadyField const f(network);
    return {f.power_out(network.number_of({prm, 1})), f.power_out(network.number_of({itm, 1})),
            f.power_out(network.number_of({prm, 0}))};
  }
};

TEST(NetworkCases, CoupledCavitiesT13) {
  std::array const on = Coupled(0).powers(), off = Coupled(1e-12).powers();
  std::array const expected_on = {380.7589845, 106823.0917, 1.518246519},
                   expected_off = {377.6475364, 105949.8714, 1.587580211};
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(deviation(on[i], expected_on[i]), 1e-9) << i;
    EXPECT_LT(deviation(off[i], expected_off[i]), 1e-9) << i;
  }
  EXPECT_GT(relative(Coupled(0, 74e-6).powers()[1], expected_on[1]), 1e-4) << "control: 1 ppm of loss";
  Coupled const c(0);
  SteadyField const f(c.network);
  auto const answer = [&](double hz) {
    LinearResponse const r(c.network, f, Readout::power(c.network.number_of({c.etm, 0})), hz);
    return std::abs(r.to_amplitude({c.network.number_of({c.laser, 0}), true, true, 0}));
  };
  double below = 0.1, above = 10;
  for (int i = 0; i < 40; ++i) {
    double const middle = std::sqrt(below * above);
    (answer(middle) > answer(1e-3) / std::sqrt(2) ? below : above) = middle;
  }
  EXPECT_LT(deviation(below, 1.0346), 1e-4);
}

// Advanced Virgo with two modulators, unequal arms, heavy mirrors and no offset. A mirror a quarter of a wavelength off
// makes the dark fringe, as where the numbers come from; the preset turns the space.
struct TwoModulators {
  DualRecycled detector;
  Network network;
  SteadyField field;
  explicit TwoModulators(ModulatorParameters::Of of)
      : detector(parameters(), {{slow_hz, 0.1, of}, {fast_hz, 0.1, of}}),
        network(with_displaced_arm(detector.network())),
        field(network) {}
  static DualRecycledParameters parameters() {
    DualRecycledParameters p = dual_recycled_presets()[0].parameters;
    p.mirror_mass = infinity;
    p.dark_fringe_offset = 0;
    p.transmission_difference = 0.01;
    p.loss_difference = 10e-6;
    return p;
  }
  static Network with_displaced_arm(Network n) {
    for (std::size_t i = 0; i < n.spaces().size(); ++i)
      if (n.space_name(i) == "BS.2>ITMy.front") n.change(i, n.spaces()[i].length, 0);
    for (char const* mirror : {"ITMy", "ETMy"}) n.move(n.find(mirror), -light_wavelength / 4);
    return n;
  }
  std::uint32_t port(char const* component, std::uint32_t number) const {
    return network.number_of({network.find(component), number});
  }
  double to(Freedom f, std::uint32_t at, double hz, double phase) const {
    LinearResponse const r(network, field, Readout::demodulated(at, hz, phase).of_leaving(), 10);
    return std::abs(detector.to_freedom(r, f));
  }
};

TEST(NetworkCases, TwoModulatorsT14) {
  auto const powers = [](ModulatorParameters::Of of) {
    TwoModulators const t(of);
    return std::array{t.field.power_in(t.port("ETMx", 0)), t.field.power_in(t.port("BS", 0)),
                      t.field.power_out(t.port("SRM", 1)), t.field.power_out(t.port("PRM", 0))};
  };
  std::array const found = powers(ModulatorParameters::Of::carrier), all = powers(ModulatorParameters::Of::all),
                   expected = {657782.3265, 4800.808598, 0.1676620636, 19.87435737};
  for (int i = 0; i < 4; ++i) EXPECT_LT(deviation(found[i], expected[i]), 1e-8) << i;
  EXPECT_NEAR(all[2], 0.16771, 5e-6) << "control: sidebands of sidebands";
  EXPECT_NEAR(all[3], 19.8774, 5e-5) << "control: sidebands of sidebands";
}

TEST(NetworkCases, SensingT15) {
  TwoModulators const t(ModulatorParameters::Of::carrier);
  std::uint32_t const dark = t.port("SRM", 1), reflected = t.port("PRM", 0);
  struct Row {
    std::uint32_t port;
    double hz;
    Freedom freedom;
    double in_phase, in_quadrature;
  };
  // Of the largest in the row of the sensing matrix, DARM or CARM.
  for (Row const& row : {Row{dark, fast_hz, Freedom::darm, 3.265897994e9, 1.516119477e10},
                         {dark, slow_hz, Freedom::mich, 3.126021820e5, 6.663371360e6},
                         {reflected, slow_hz, Freedom::carm, 1.603584943e11, 8.133597415e9},
                         {reflected, slow_hz, Freedom::prcl, 4.308477584e9, 2.183036648e8},
                         {reflected, fast_hz, Freedom::mich, 1.027429278e7, 2.635573326e7},
                         {reflected, fast_hz, Freedom::srcl, 6.186987091e7, 2.795200700e7}}) {
    Freedom const strong = row.port == dark ? Freedom::darm : Freedom::carm;
    double const largest = std::hypot(t.to(strong, row.port, row.hz, 0), t.to(strong, row.port, row.hz, pi / 2));
    EXPECT_NEAR(t.to(row.freedom, row.port, row.hz, 0), row.in_phase, 1e-8 * largest) << int(row.freedom);
    EXPECT_NEAR(t.to(row.freedom, row.port, row.hz, pi / 2), row.in_quadrature, 1e-8 * largest) << int(row.freedom);
  }
  LinearResponse const r(t.network, t.field, Readout::demodulated(dark, fast_hz, 0).of_leaving(), 10);
  Phasor const transposed = r.to_displacement(t.network.find("ETMx")) - r.to_displacement(t.network.find("ETMy"));
  EXPECT_GT(relative(std::abs(transposed), 3.265897994e9), 0.9) << "control: DARM as a column for the row";
}

TEST(NetworkCases, AdvancedVirgoT16T17) {
  DualRecycledParameters p = dual_recycled_presets()[0].parameters;
  DualRecycled const d(p);
  Network const& n = d.network();
  auto const port = [&](char const* c, std::uint32_t number) { return n.number_of({n.find(c), number}); };
  EXPECT_LT(deviation(d.field().power_in(port("ETMx", 0)), 667600.7838), 1e-9);
  EXPECT_LT(deviation(d.field().power_in(port("BS", 0)), 4759.182457), 1e-9);
  EXPECT_LT(deviation(d.field().power_out(port("SRM", 1)), 0.01177073116), 1e-9);
  EXPECT_LT(deviation(d.field().power_out(port("PRM", 0)), 18.97366541), 1e-9);
  auto const darm = [&](DualRecycled const& of, double hz) {
    return std::abs(of.to_freedom(of.response(Readout::power(port("SRM", 1)).of_leaving(), hz), Freedom::darm));
  };
  EXPECT_LT(deviation(darm(d, 10), 5.88463731e9), 1e-8);
  EXPECT_LT(deviation(darm(d, 100), 5.85689370e9), 1e-8);
  EXPECT_LT(deviation(darm(d, 1000), 4.18955604e9), 1e-8);
  p.mirror_mass = infinity;
  EXPECT_GT(relative(darm(DualRecycled(p), 10), 5.88463731e9), 5e-5) << "control: no radiation pressure";
}

TEST(NetworkCases, OpticalSpringT18) {
  struct Spring {
    Network network{light_wavelength};
    ComponentId end;
    explicit Spring(double longer) {
      ComponentId const laser = network.add_laser("laser", 1e4),
                        itm = network.add_mirror("ITM", {.transmission = 0.014});
      end = network.add_mirror(
          "ETM", {.transmission = 1e-6, .loss = 75e-6, .displacement = longer, .suspension = {.mass = 42}});
      network.link({laser, 0}, {itm, 0}, 0, -pi / 4);
      network.link({itm, 1}, {end, 0}, 3000, -pi / 2);
    }
    Phasor per_force(double hz) const {
      SteadyField const f(network);
      LinearResponse const r(network, f, Readout::motion({{end, 1}}), hz);
      return r.to_displacement(end) * network.at(end).suspension.compliance(hz);
    }
  };
  Spring const s(0.3e-9);
  EXPECT_LT(deviation(SteadyField(s.network).power_in(s.network.number_of({s.end, 0})), 2245647.353), 1e-9);
  EXPECT_LT(relative(s.per_force(1), Phasor(5.00691e-8, -1.42196e-9)), 2e-6);  // digits of the reference
  EXPECT_LT(relative(s.per_force(10), Phasor(4.9180343e-8, -1.4450089e-8)), 1e-6);
  EXPECT_GT(relative(Spring(-0.3e-9).per_force(1), Phasor(5.00691e-8, -1.42196e-9)), 1) << "control: sign of detuning";
}

}  // namespace
}  // namespace straytrace::ifo_network_cases
