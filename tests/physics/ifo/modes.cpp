// SPDX-License-Identifier: BSD-3-Clause
// Networks in Hermite-Gauss modes: docs/theory/interferometer.md, eq. N.6 to N.11. Expected numbers are those of
// another program with modes.
#include <algorithm>
#include <cmath>
#include <string>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "ifo/dual_recycled.hpp"
#include "ifo/layout/operating_point.hpp"
#include "ifo/mode_bases.hpp"
#include "ifo/network_interferometer.hpp"
#include "ifo/network_ways.hpp"
#include "network_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_modes {
namespace {

using namespace straytrace::ifo;
using namespace straytrace::testing;

constexpr double first_roc = 1420, end_roc = 1683;

// 1 W onto a cavity of 3 km, resonant. The first mirror is concave toward the inside, its back.
struct CurvedCavity {
  Network network{light_wavelength};
  ComponentId laser, input, end;
  explicit CurvedCavity(int order, LaserParameters const& light = {.power = 1}, std::array<double, 2> tilt = {},
                        double longer = 0) {
    laser = network.add(Network::laser("laser", light));
    input = network.add_mirror("M1", {.transmission = 0.02, .curvature = -1 / first_roc});
    end = network.add_mirror("M2",
                             {.transmission = 0.004, .displacement = longer, .curvature = 1 / end_roc, .tilt = tilt});
    network.link({laser, 0}, {input, 0}, 0, -pi / 4);
    network.link({input, 1}, {end, 0}, 3000, -pi / 2);
    network.use_modes(ModeSettings{order});
  }
  std::uint32_t inside() const { return network.number_of({input, 1}); }
  std::uint32_t outside() const { return network.number_of({input, 0}); }
};

double circulating(CurvedCavity const& c) { return SteadyField(c.network).power_out(c.inside()); }
double reflected(CurvedCavity const& c) { return SteadyField(c.network).power_out(c.outside()); }

LaserParameters wide_laser(double factor, double roc = -first_roc) {
  return {.power = 1, .mode = LaserMode{factor * 48.679177e-3, 1 / roc}};
}

std::size_t number_of_mode(SteadyField const& f, int n, int m) {
  for (std::size_t i = 0; i < f.modes(); ++i)
    if (f.bases()->orders(i) == std::array{n, m}) return i;
  return f.modes();
}

// A larger spot of the laser. Negative control: another wavefront.
TEST(Modes, MismatchedLaserT9) {
  EXPECT_LT(deviation(circulating(CurvedCavity(0, wide_laser(1.1))), 136.8948367), 3e-9);
  EXPECT_LT(deviation(circulating(CurvedCavity(2, wide_laser(1.1))), 136.8949372), 3e-9);
  CurvedCavity const fine(4, wide_laser(1.1));
  EXPECT_LT(deviation(circulating(fine), 136.8949376), 3e-9);
  SteadyField const f(fine.network);
  EXPECT_LT(deviation(std::norm(f.out(fine.inside(), 0, number_of_mode(f, 2, 0))), 5.0275965e-5), 3e-7)
      << "the radius has 8 digits";
  EXPECT_LT(deviation(reflected(CurvedCavity(8, wide_laser(1.1))), 0.452420249), 1e-8);
  EXPECT_GT(relative(circulating(CurvedCavity(4, wide_laser(1.1, -1300))), 136.8949376), 1e-3);
}

// N.6: a mirror that leans turns light by twice the angle. Negative control: half of it.
TEST(Modes, TiltedMirrorT10) {
  double const expected[] = {135.6346956, 135.6767721, 135.6768345, 135.6768345};
  int const orders[] = {1, 2, 4, 6};
  for (std::array const tilt : {std::array{0.0, 1e-7}, std::array{1e-7, 0.0}})
    for (int i = 0; i < 4; ++i)
      EXPECT_LT(deviation(circulating(CurvedCavity(orders[i], {.power = 1}, tilt)), expected[i]), 1e-9);
  CurvedCavity const fine(6, {.power = 1}, {0, 1e-7});
  SteadyField const f(fine.network);
  EXPECT_LT(deviation(std::norm(f.out(fine.inside(), 0, number_of_mode(f, 0, 1))), 0.3049579497), 1e-8);
  EXPECT_LT(deviation(f.power_out(fine.outside()), 0.4572926619), 1e-9);
  EXPECT_GT(relative(circulating(CurvedCavity(6, {.power = 1}, {0, 0.5e-7})), 135.6768345), 1e-3);
}

struct CurvedRing : Ring {
  explicit CurvedRing(LinearPolarisation p = LinearPolarisation::s) : Ring(0, p) {
    auto parameters = std::get<MirrorParameters>(network.at(third).stated);
    parameters.curvature = 1 / 185.0;
    network.replace(third, Network::splitter("M3", parameters));
    network.use_modes(ModeSettings{2});
  }
};

// N.10: three reflections turn x round, which moves odd n by half a free spectral range.
TEST(Modes, TriangularCavityT7) {
  CurvedRing const ring;
  CavityMode const mode = mode_of(ring.network, cavities_of(ring.network).at(0));
  EXPECT_LT(deviation(mode.gouy[0], 2.153822690), 1e-8);
  EXPECT_LT(deviation(mode.gouy[1], 2.153819068), 1e-8);
  EXPECT_NEAR(mode.phase_beyond(1, 0) / (2 * pi), 0.842792, 1e-6);
  EXPECT_NEAR(mode.phase_beyond(0, 1) / (2 * pi), 0.342791, 1e-6);
  EXPECT_NEAR(mode.phase_beyond(2, 0) / (2 * pi), 0.685583, 1e-6);
}

// The solved field has the resonances of the table: the laser in one mode alone, and the space longer by its phase.
TEST(Modes, ResonancesOfTheSolutionAreThoseOfTheTable) {
  CurvedRing ring;
  // The ring resonates for 00; a laser beside the axis excites (1,0) and (0,1): N.10 by a tilt of a mirror.
  auto parameters = std::get<MirrorParameters>(ring.network.at(ring.third).stated);
  parameters.tilt = {1e-9, 2e-9};
  ring.network.replace(ring.third, Network::splitter("M3", parameters));
  CavityMode const mode = mode_of(ring.network, cavities_of(ring.network).at(0));
  Network::Space const space = ring.network.spaces()[1];
  for (auto const& [n, m] : {std::pair{1, 0}, std::pair{0, 1}}) {
    auto const power = [&](double phase) {
      ring.network.change(1, space.length, space.phase + phase);
      SteadyField const f(ring.network);
      return std::norm(f.out(ring.inside(), 0, number_of_mode(f, n, m)));
    };
    double const at = mode.phase_beyond(n, m);
    EXPECT_GT(power(at), 30 * power(at + 0.02)) << n << m;
    EXPECT_GT(power(at), 30 * power(at + pi)) << n << m;
  }
}

// 1 W through the end mirror, the arm and the signal mirror, tuned for a broad band; `detuned`: of the curvature of the
// signal mirror, 1/m.
struct SignalCavity {
  Network network{light_wavelength};
  ComponentId out;
  SignalCavity(int order, double detuned, bool even = false) {
    ComponentId const laser = network.add_laser("laser", 1);
    ComponentId const end = network.add_mirror("ETM", {.transmission = 1e-6, .curvature = -1 / end_roc});
    ComponentId const input = network.add_mirror("ITM", {.transmission = 0.014, .curvature = 1 / first_roc});
    out = network.add_mirror("SRM", {.transmission = 0.2, .curvature = 1 / 1431.461068 + detuned});
    network.link({laser, 0}, {end, 0}, 0, -pi / 4);
    network.link({end, 1}, {input, 0}, 2999.8, -pi / 2);
    network.link({input, 1}, {out, 0}, 11.95, -pi / 2);
    network.use_modes(ModeSettings{order, even, {{"ETM", "ITM"}}});
  }
  double power_at(double hz) const {
    Network moved = network;
    for (std::size_t s = 0; s < 3; ++s) {
      Network::Space const space = network.spaces()[s];
      moved.change(s, space.length, space.phase + 2 * pi * hz * space.length / speed_of_light);
    }
    return SteadyField(moved).power_out(network.number_of({out, 1}));
  }
  double pole() const {
    double const half = power_at(1) / 2;
    double low = 1, high = 3000;
    while (high - low > 0.01) (power_at((low + high) / 2) > half ? low : high) = (low + high) / 2;
    return low;
  }
};

TEST(Modes, SignalCavityT11) {
  EXPECT_LT(deviation(SignalCavity(0, 0).power_at(1), 1.5810526e-5), 1e-5);
  EXPECT_LT(deviation(SignalCavity(0, 0).pole(), 1013.30), 1e-4);
  double const poles[] = {824.5, 825.2, 822.7};
  for (int i = 0; i < 3; ++i) EXPECT_LT(deviation(SignalCavity(2 * i, 3e-6).pole(), poles[i]), 2e-4) << i;
  EXPECT_LT(deviation(SignalCavity(8, 3e-6).pole(), 822.8), 2e-4);
  EXPECT_GT(relative(SignalCavity(0, 0).pole(), poles[2]), 0.1) << "the curvature matters";
  double const more[] = {506.5, 575.0, 570.9};
  for (int i = 0; i < 3; ++i) EXPECT_LT(deviation(SignalCavity(2 * i, 1e-5).pole(), more[i]), 2e-4) << i;
  // A mismatch makes even modes alone.
  EXPECT_LT(deviation(SignalCavity(8, 1e-5, true).pole(), 561.7), 2e-4);
  EXPECT_LT(deviation(SignalCavity(12, 1e-5, true).pole(), 561.0), 2e-4);
  EXPECT_LT(relative(SignalCavity(4, 1e-5, true).pole(), SignalCavity(4, 1e-5).pole()), 1e-6);
}

// Two radii of a mirror: each axis has the stability and the Gouy phase of a cavity of that radius, and light of a
// round beam goes to (2,0) and (0,2) by the mismatch of each axis (eq. N.7).
TEST(Modes, MirrorsOfTwoRadii) {
  double const of_y = 1590;
  CurvedCavity c(2);
  auto p = std::get<MirrorParameters>(c.network.at(c.end).stated);
  p.curvature_across = 1 / of_y;
  c.network.replace(c.end, Network::mirror("M2", p));
  CavityMode const mode = mode_of(c.network, cavities_of(c.network).at(0));
  for (int const axis : {0, 1}) {
    double const g = (1 - 3000 / first_roc) * (1 - 3000 / (axis == 0 ? end_roc : of_y));
    EXPECT_NEAR(mode.stability[std::size_t(axis)], 2 * g - 1, 1e-12) << axis;
    EXPECT_NEAR(mode.gouy[std::size_t(axis)], 2 * std::acos(-std::sqrt(g)), 1e-9) << axis;
  }
  EXPECT_GT(std::fabs(mode.stability[0] - mode.stability[1]), 0.05);
  // One round trip through another basis: K is a product of two axes.
  ModeBases const bases(c.network);
  double const w_x = mode.radius(0, light_wavelength), w_y = mode.radius(1, light_wavelength);
  EXPECT_GT(std::fabs(w_x / w_y - 1), 1e-3);
  LaserParameters round{.power = 1, .mode = LaserMode{w_x, mode.curvature[0].real()}};
  Eigen::MatrixXcd const kx = axis_coupling({{round.mode->curvature, mode.curvature[0].imag()}, mode.curvature[0]},
                                            c.network.wavenumber(), 2),
                         ky = axis_coupling({{round.mode->curvature, mode.curvature[0].imag()}, mode.curvature[1]},
                                            c.network.wavenumber(), 2);
  Eigen::MatrixXcd const k = mode_coupling({mode.curvature[0], mode.curvature[0]},
                                           {mode.curvature[0], mode.curvature[1]}, c.network.wavenumber(), 2);
  EXPECT_LT(std::abs(k(mode_index(0, 2), 0) - kx(0, 0) * ky(2, 0)), 1e-12);
  EXPECT_LT(std::abs(k(mode_index(2, 0), 0)), 1e-12);
  EXPECT_GT(std::abs(k(mode_index(0, 2), 0)), 1e-3) << "control: the axes are not alike";
}

// N.3 against steps, and the response at low frequency of heavy mirrors, both in modes.
TEST(Modes, SlopesAndResponsesAgree) {
  std::array const tilt{3e-8, -5e-8};
  CurvedCavity const c(3, wide_laser(1.1), tilt, 0.4e-9);
  SteadyField const f(c.network);
  Readout const r = Readout::power(c.outside()).of_leaving();
  AdjointSlope const slope(c.network, f, r);
  double const step = 1e-13;
  double const expected = (reflected(CurvedCavity(3, wide_laser(1.1), tilt, 0.4e-9 + step)) -
                           reflected(CurvedCavity(3, wide_laser(1.1), tilt, 0.4e-9 - step))) /
                          (2 * step);
  EXPECT_LT(deviation(slope.to_displacement(c.end), expected), 1e-5);
  EXPECT_LT(deviation(slope.to_power(c.laser), f.power_out(c.outside())), 1e-9) << "the power of the laser scales all";
  LinearResponse const response(c.network, f, r, 1e-6);
  EXPECT_LT(relative(response.to_displacement(c.end), Phasor(slope.to_displacement(c.end))), 1e-6);
  CurvedCavity const plain(0, {.power = 1}, {}, 0.4e-9);
  EXPECT_GT(relative(AdjointSlope(plain.network, SteadyField(plain.network), r).to_displacement(c.end), expected), 1e-3)
      << "a matched beam has another slope";
}

// Coherent light has the shot noise of its power whatever its modes: losses and open ports bring the vacuum of every
// mode. Negative control: the power of 00 alone.
TEST(Modes, ShotNoiseOfAllModes) {
  CurvedCavity const c(4, wide_laser(1.5), {1e-7, 2e-7});
  SteadyField const f(c.network);
  Readout const r = Readout::power(c.outside()).of_leaving();
  double const quantum = hbar * c.network.wavenumber() * speed_of_light;  // J
  double const noise = LinearResponse(c.network, f, r, 20).quantum_noise();
  EXPECT_LT(deviation(noise, 2 * quantum * f.power_out(c.outside())), 1e-8);
  EXPECT_GT(relative(noise, 2 * quantum * std::norm(f.out(c.outside(), 0))), 0.01);
}

// Of 00 alone in a matched cavity, all is as in plane waves.
TEST(Modes, MatchedCavityIsThatOfPlaneWaves) {
  CurvedCavity c(4);
  double const modes = circulating(c);
  c.network.use_modes({});
  EXPECT_LT(relative(modes, circulating(c)), 1e-12);
}

TEST(Modes, LensActsAndApertureStops) {
  // A lens in front of a flat cavity mirror stands for its curvature: twice through it is one reflection from 1/(2 f).
  Network n(light_wavelength);
  ComponentId const laser = n.add_laser("laser", 1), input = n.add_mirror("M1", {.transmission = 0.02});
  ComponentId const lens = n.add(Network::lens("L", {2000}));
  ComponentId const stop = n.add(Network::aperture("A", {.radius = 0.05}));
  ComponentId const end = n.add_mirror("M2", {.transmission = 0.004});
  n.link({laser, 0}, {input, 0}, 0, -pi / 4);
  n.link({input, 1}, {stop, 0}, 500);
  n.link({stop, 1}, {lens, 0}, 0);
  n.link({lens, 1}, {end, 0}, 0, -pi / 2);
  n.use_modes(ModeSettings{0});
  CavityMode const mode = mode_of(n, cavities_of(n).at(0));
  EXPECT_NEAR(mode.stability[0], 2 * (1 - 500 / 2000.0) - 1, 1e-12);  // flat and RoC 2000 m: g1 g2 = 1 - L/R
  SteadyField const f(n);
  ModeBases const& bases = *f.bases();
  std::uint32_t const at = n.number_of({stop, 1});
  double const w2 = light_wavelength / (pi * bases.leaving(at)[0].imag());
  double const passed = std::norm(f.out(at, 0) / f.in(n.number_of({stop, 0}), 0));
  EXPECT_LT(deviation(passed, std::pow(1 - std::exp(-2 * 0.05 * 0.05 / w2), 2)), 1e-10) << "N.11";
}

// Eq. N.11: of the light u_00, a stop of radius w takes e^{-2}. The light that it scatters to modes beyond the order is
// not lost but missing, 1 - e^{-2} - sum of |K_n0|^2, so that the modes do not suffice. Control: lost light as what
// enters less what leaves.
TEST(Modes, ScatterOfAStopIsMissingLight) {
  NetworkModel model;
  Network& n = model.network;
  double const w = 1e-3;
  ComponentId const laser = n.add(Network::laser("laser", {.power = 2, .mode = LaserMode{w, 0}}));
  ComponentId const stop = n.add(Network::aperture("stop", {.radius = w}));
  n.link({laser, 0}, {stop, 0}, 0);
  n.use_modes(ModeSettings{4});
  OperatingPoint const point = operating_point(model);
  auto const lost = std::ranges::find(point.energy, "stop", &EnergyRow::name);
  ASSERT_NE(lost, point.energy.end());
  EXPECT_NEAR(lost->power / 2, std::exp(-2), 1e-12);
  double const kept = stop_coupling({w, {}}, {w, w}, 4).col(0).squaredNorm();
  EXPECT_NEAR(point.missing / 2, 1 - std::exp(-2) - kept, 1e-12);
  EXPECT_GT(1 - kept - std::exp(-2), 0.01);
  EXPECT_FALSE(mode_table(model).truncation.converged());
  n.replace(stop, Network::aperture("stop", {.radius = 3 * w}));
  EXPECT_TRUE(mode_table(model).truncation.converged()) << "control: a wide stop";
}

// A round stop in the cavity, a and d of N.11 in radii of the beam there.
struct StoppedCavity {
  Network network{light_wavelength};
  ComponentId stop, end;
  double w = 0;
  StoppedCavity(int order, double a, double d, double moved = 0) {
    ComponentId const laser = network.add_laser("laser", 1),
                      input = network.add_mirror("M1", {.transmission = 0.02, .curvature = -1 / first_roc});
    stop = network.add(Network::aperture("A", {}));
    end = network.add_mirror("M2", {.transmission = 0.004, .curvature = 1 / end_roc});
    network.link({laser, 0}, {input, 0}, 0, -pi / 4);
    network.link({input, 1}, {stop, 0}, 1000);
    network.link({stop, 1}, {end, 0}, 2000, -pi / 2);
    network.use_modes(ModeSettings{order});
    w = std::sqrt(light_wavelength /
                  (pi * SteadyField(network).bases()->leaving(network.number_of({stop, 1}))[0].imag()));
    network.replace(stop, Network::aperture("A", {.radius = a * w, .offset = {d * w + moved, 0}}));
  }
  std::uint32_t behind() const { return network.number_of({end, 1}); }
};

// Eq. N.16: what stray light of mode 00 leaves out of the light that is scattered, and of what it joins.
TEST(Modes, StrayLightBeyondTheFundamentalMode) {
  auto const found = [](CurvedCavity const& c) {
    SteadyField const field(c.network);
    Readout const transmitted = Readout::power(c.network.number_of({c.end, 1})).of_leaving();
    LinearResponse const r(c.network, field, transmitted, 10);
    return beyond_fundamental(r, c.network, field, returning({c.network.number_of({c.end, 0}), true}));
  };
  CurvedCavity const leaning(4, {.power = 1}, {0, 1e-7}, 1e-10);
  SteadyField const field(leaning.network);
  std::uint32_t const end = leaning.network.number_of({leaning.end, 0});
  auto const [light, weight] = found(leaning);
  EXPECT_NEAR(light, 1 - std::norm(field.in(end, 0)) / field.power_in(end), 1e-12);
  EXPECT_NEAR(light, 0.30496 / 135.677, 1e-4) << "T10";
  EXPECT_GT(weight, 1e-4);
  auto const matched = found(CurvedCavity(4, {.power = 1}, {}, 1e-10));
  EXPECT_LT(std::fabs(matched.light), 1e-12) << "control";
  EXPECT_LT(std::fabs(matched.weight), 1e-12) << "control";
  EXPECT_EQ(found(CurvedCavity(0, {.power = 1}, {}, 1e-10)).light, 0) << "one mode";
}

double gain_of(NetworkModel const& model) { return operating_point(model).cavities.at(0).gain; }

// Eq. 6.5 with what a stop takes: two passages by K_00 = 1 - e^{-V} (N.11), and the gain of the solution, T_1 over
// (1 - round trip)^2 without the second stop, which the light meets after it is counted. Control: plane waves.
TEST(Modes, FinesseIncludesWhatAStopTakes) {
  double const a = 1.8, kept = 1 - std::exp(-2 * a * a), mirrors = std::sqrt(0.98 * 0.996);
  StoppedCavity const narrow(0, a, 0);
  NetworkModel const model{.preset = "none", .network = narrow.network};
  NetworkCavity const found = operating_point(model).cavities.at(0).cavity;
  double const round_trip = mirrors * kept * kept;
  EXPECT_NEAR(found.round_trip, round_trip, 1e-12);
  EXPECT_LT(deviation(found.finesse(), pi * std::sqrt(round_trip) / (1 - round_trip)), 1e-9);
  EXPECT_LT(deviation(gain_of(model) * std::pow(1 - found.round_trip, 2), 0.02), 1e-9);
  EXPECT_GT(relative(cavities_of(narrow.network).at(0).finesse(), found.finesse()), 0.1) << "control: plane waves";
  // Higher modes change the loss of the resonator, and with it the gain of the solution.
  StoppedCavity const fine(6, a, 0);
  NetworkModel const many{.preset = "none", .network = fine.network};
  double const more = operating_point(many).cavities.at(0).cavity.round_trip;
  EXPECT_NEAR(gain_of(many) * std::pow(1 - more, 2) / 0.02, 1, 0.01);
  EXPECT_GT(std::fabs(gain_of(many) * std::pow(1 - round_trip, 2) / 0.02 - 1), 0.05) << "control: 00 alone";
  // A tilt moves the mode of the resonator; it takes nothing.
  CurvedCavity const leaning(6, {.power = 1}, {0, 1e-7});
  NetworkModel const tilted{.preset = "none", .network = leaning.network};
  EXPECT_NEAR(operating_point(tilted).cavities.at(0).cavity.round_trip, mirrors, 1e-6);
}

// A stop that moves: the slope of the transmitted power is T_am dK_00/dd, T_am for light that passes both ways (N.21).
// Higher modes return some of what a stop cuts, 47 % of the slope at a = 1.8 w.
TEST(Modes, MovingStop) {
  constexpr double a = 3, d = 0.2, slow = 1e-3;  // slow: Hz, far below the pole
  for (int const order : {0, 4}) {
    StoppedCavity const c(order, a, d);
    double const x = 3e-4 * c.w, k = stop_coupling({a, {d, 0}}, {1, 1}, 0)(0, 0);
    auto const transmitted = [&](double moved) {
      StoppedCavity const other(order, a, d, moved);
      return SteadyField(other.network).power_out(other.behind());
    };
    double const slope = (transmitted(x) - transmitted(-x)) / (2 * x);
    double const per_metre = -4 * a / c.w * std::exp(-2 * (a * a + d * d)) * std::cyl_bessel_i(1, 4 * a * d);
    SteadyField const field(c.network);
    LinearResponse const read(c.network, field, Readout::power(c.behind()).of_leaving(), slow);
    NetworkBeam const beam{c.network.number_of({c.stop, 1}), true};
    double const t = stray_response(read, c.network, field, passing(c.network, beam), slow).amplitude().real();
    EXPECT_NEAR(slope / (t * per_metre / k), 1, order == 0 ? 1e-4 : 5e-3) << order;
    double const once = stray_response(read, c.network, field, {{beam}, {beam}, 0, 0, true}, slow).amplitude().real();
    EXPECT_NEAR(slope / (once * per_metre / k), 2, 0.1) << "control: one way only, order " << order;
  }
}

// A stop between a recycling mirror and the input mirror of a cavity, as in a short arm: two beams of different powers
// pass it, a from the cavity and b to it. The slope of the transmitted power is that of both as fields,
// T_a dK_00/dd + T_b dK_00/dd, which is T_am of either beam (eq. N.21).
TEST(Modes, MovingStopBehindAnInputMirror) {
  constexpr double slow = 1e-3, per_field = -40;  // Hz; dK_00/dd, 1/m
  constexpr double step = 1e-6;                   // of the loss
  auto const network_of = [](double loss) {
    Network network{light_wavelength};
    ComponentId const laser = network.add_laser("laser", 1), first = network.add_mirror("PRM", {.transmission = 0.05}),
                      input = network.add_mirror("M1", {.transmission = 0.02}),
                      end = network.add_mirror("M2", {.transmission = 0.004});
    double const passes = 1 - loss;
    ComponentId const stop = network.add_mirror("A", {.transmission = passes, .loss = 1 - passes});
    network.link({laser, 0}, {first, 0}, 0);
    network.link({first, 1}, {stop, 0}, 3, 0.2);
    network.link({stop, 1}, {input, 0}, 3, 0.3);
    network.link({input, 1}, {end, 0}, 3000, -pi / 2 + 1e-3);
    return std::pair(network, network.number_of({end, 1}));
  };
  auto const [network, behind] = network_of(0);
  auto const transmitted = [&](double loss) { return SteadyField(network_of(loss).first).power_out(behind); };
  SteadyField const field(network);
  LinearResponse const read(network, field, Readout::power(behind).of_leaving(), slow);
  NetworkBeam const to = *find_beam(network, "A.back.out"), from = reversed(to);
  auto const response = [&](StrayWay const& way) {
    return stray_response(read, network, field, way, slow).amplitude().real();
  };
  double const both = response(passing(network, to)), t_b = response({{to}, {to}, 0, 0, true}),
               t_a = response({{from}, {from}, 0, 0, true});
  EXPECT_NEAR((t_a + t_b) / both, 1, 1e-6);
  EXPECT_NEAR(response(passing(network, from)) / both, 1, 1e-9) << "the same of either beam";
  EXPECT_GT(std::fabs(std::hypot(t_a, t_b) / both - 1), 0.05) << "control: added in power";
  // K_00 = 1 - loss/2 of each way.
  double const slope = (transmitted(2 * step) - transmitted(0)) / (2 * step) * -2 * per_field;
  EXPECT_NEAR(both * per_field / slope, 1, 1e-3);
}

// A dual-recycled detector without Schnupp asymmetry, all of its mirrors matched to the arms but for `detuned` of the
// curvature of the signal-recycling mirror, 1/m.
struct Detector {
  DualRecycledParameters p;
  NetworkChanges changes;
  explicit Detector(double detuned) {
    for (DualRecycledPreset const& each : dual_recycled_presets())
      if (each.name == "adv") p = each.parameters;
    p.schnupp_asymmetry = 0;
    changes.modes = ModeSettings{2, true, {{"ITMx", "ETMx"}, {"ITMy", "ETMy"}}};
    for (std::string const arm : {"x", "y"}) {
      changes.shapes.push_back({"ITM" + arm, -1 / first_roc});
      changes.shapes.push_back({"ETM" + arm, 1 / end_roc});
    }
    DualRecycled const flat(p, {}, changes);
    auto const wavefront = [&](char const* mirror, std::uint32_t port) {
      return flat.field().bases()->entering(flat.network().number_of({flat.network().find(mirror), port}))[0].real();
    };
    double const prm = wavefront("PRM", 1), srm = wavefront("SRM", 0);
    changes.shapes.push_back({"PRM", -prm});
    changes.shapes.push_back({"SRM", srm + detuned});
  }
};

// Matched, a detector responds as in plane waves. A signal mirror of another curvature changes its pole and the gain of
// stray light, which a loss of the same power does not.
TEST(Modes, MismatchOfTheSignalCavityChangesTheDetector) {
  Detector const matched(0), wrong(3e-6);
  DualRecycled const plain(matched.p), good(matched.p, {}, matched.changes), bad(wrong.p, {}, wrong.changes);
  auto const darm = [](DualRecycled const& d, double hz) { return d.to_freedom(d.response(hz), Freedom::darm); };
  for (double const hz : {10.0, 1000.0}) EXPECT_LT(relative(darm(good, hz), darm(plain, hz)), 1e-7) << hz;
  EXPECT_LT(relative(good.pole(), plain.pole()), 1e-6);
  EXPECT_LT(relative(good.stray_gain(100), plain.stray_gain(100)), 1e-7);
  EXPECT_GT(relative(bad.pole(), plain.pole()), 0.02);
  EXPECT_GT(relative(std::abs(bad.stray_gain(100)), std::abs(plain.stray_gain(100))), 0.02);
  double const mismatch = 4.7e-4;  // of power, at the mirror
  DualRecycledParameters lossy = matched.p;
  lossy.signal_cavity_loss = 1 - (1 - lossy.signal_cavity_loss) * std::pow(1 - mismatch, 2);
  EXPECT_LT(relative(DualRecycled(lossy).pole(), plain.pole()), 6e-3) << "control: as a loss";
}

TEST(Modes, UnstableCavityIsRefused) {
  CurvedCavity c(2);
  c.network.replace(c.end, Network::mirror("M2", {.transmission = 0.004, .curvature = 1 / 1200.0}));
  try {
    SteadyField const f(c.network);
    FAIL();
  } catch (ModeError const& e) {
    EXPECT_NE(std::string(e.what()).find("cavity M1-M2 is unstable"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace straytrace::ifo_modes
