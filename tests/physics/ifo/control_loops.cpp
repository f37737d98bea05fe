// SPDX-License-Identifier: BSD-3-Clause
// Control loops whose sensors receive stray light: docs/theory/interferometer.md, eq. N.4 and N.5.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "ifo/layout/operating_point.hpp"
#include "ifo/layout/signals.hpp"
#include "physics/ifo/network_support.hpp"
#include "physics/ifo/support.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_control {
namespace {

using Kind = ControlLoop::Kind;
constexpr std::size_t carm = 0, mich = 1, prcl = 2, srcl = 3;
constexpr double sensor_hz = 6270777;

TransferFunction constant(double g) { return {{}, {}, g}; }

// Advanced Virgo with a modulator, and a pick-off 2 m behind the power-recycling mirror: light on its way to the
// splitter is returned by a mirror 0.5 m away, which moves.
struct Recycling {
  static constexpr double reflectivity = 1e-9;  // at 1e-7 the static field changes the response by 2e-4
  explicit Recycling(double phase = 0) : detector(parameters(), {{sensor_hz, 0.1}}, with_pick_off(phase)) {
    detector.read(Readout::power(port("SRM", 1)).of_leaving());
  }
  DualRecycled detector;
  NamedReadout sensor{"POP_I", Readout::demodulated(port("BS", 0), sensor_hz, 0)};

  static DualRecycledParameters parameters() { return dual_recycled_presets()[0].parameters; }
  static NetworkChanges with_pick_off(double phase) {
    return {{Network::splitter("plate", {.transmission = 1 - reflectivity, .incidence = pi / 4}),
             Network::mirror("mirror", {.transmission = 0})},
            {{"PRM.back", "plate.1", 2}, {"plate.3", "BS.1", 3.95}, {"plate.2", "mirror.front", 0.5, phase}}};
  }
  std::uint32_t port(char const* component, std::uint32_t number) const {
    return detector.network().number_of({detector.network().find(component), number});
  }
  // Motion of the mirror, per unit of the field that it turns.
  Phasor stray(LinearResponse const& r) const {
    return r.to_displacement(detector.network().find("mirror")) / (2 * detector.network().wavenumber() * reflectivity);
  }
  using Loops = std::array<ControlLoop, 4>;  // of CARM, MICH, PRCL and SRCL
  Loops loops(double gain, Kind others = Kind::free) const {
    Loops all;
    for (ControlLoop& loop : all) loop.kind = others;
    all[prcl] = {Kind::closed, sensor, constant(gain), {}};
    return all;
  }
  HeldResponse response(double hz, Loops const& loops) const {
    NetworkModel model = detector.model("");
    for (std::size_t i = 0; i < loops.size(); ++i) model.controlled[i].loop = loops[i];
    return HeldResponse(detector, hz, std::move(model));
  }
  double darm(Loops const& loops) const {  // m per unit field
    HeldResponse const r = response(10, loops);
    return std::abs(r.strain().to([&](LinearResponse const& x) { return stray(x); }) / r.strain().per_metre());
  }
};

TEST(ControlLoops, StrayLightIsWrittenOnTheLengthT25) {
  Recycling const t, eighth(pi / 4);  // positions lambda/8 apart: the rms over the static phase
  auto const rms = [&](Recycling::Loops const& loops) {
    return std::hypot(t.darm(loops), eighth.darm(loops)) / std::sqrt(2);
  };
  EXPECT_NEAR(rms(t.loops(0)) / 4.6929e-10, 1, 5e-4);
  EXPECT_NEAR(rms(t.loops(9)) / 4.4012e-10, 1, 5e-4);
  EXPECT_LT(rms({}), 0.1 * rms(t.loops(9))) << "control: held lengths";
}

// One loop P, all others free: x_P = -G T_P s/(R_PP (1 + G)).
TEST(ControlLoops, OneLoopN5) {
  Recycling const t;
  Phasor const g{3, -2};
  Recycling::Loops loops = t.loops(0);
  for (double const hz : {3.0, 30.0, 300.0}) {
    loops[prcl].open_loop = TransferFunction("g", {1, 1000}, {g, g});
    LinearResponse const dark = t.detector.response(hz), sensor = t.detector.response(t.sensor.readout, hz);
    auto const closed = [&](auto const& cause, Phasor gain) {
      Phasor const length = -gain / (1.0 + gain) * cause(sensor) / t.detector.to_freedom(sensor, Freedom::prcl);
      return cause(dark) + t.detector.to_freedom(dark, Freedom::prcl) * length;
    };
    auto const phase = [&](LinearResponse const& r) { return t.stray(r); };
    HeldResponse const response = t.response(hz, loops);
    CalibratedStrain const& solved = response.strain();
    EXPECT_LT(std::abs(solved.to(phase) / closed(phase, g) - 1.0), 1e-9) << hz;
    EXPECT_GT(std::abs(solved.to(phase) / closed(phase, -g) - 1.0), 0.1) << "control: the sign of the loop";
    Phasor const noise =
        -g / (1.0 + g) * t.detector.to_freedom(dark, Freedom::prcl) / t.detector.to_freedom(sensor, Freedom::prcl);
    EXPECT_LT(std::abs(solved.to_sensor_noise(prcl) / noise - 1.0), 1e-9) << hz;
  }
}

// All loops at once against the matrix of eq. N.4, with sensors that are no combination of each other.
TEST(ControlLoops, FourLoopsN4) {
  Recycling const t;
  double const hz = 20;
  auto const demodulated = [&](char const* c, std::uint32_t n, double phase) {
    return NamedReadout{"", Readout::demodulated(t.port(c, n), sensor_hz, phase)};
  };
  Recycling::Loops loops;
  loops[carm] = {Kind::closed, {"", demodulated("PRM", 0, 0).readout.of_leaving()}, constant(1e4), {}};
  loops[mich] = {Kind::closed, demodulated("BS", 0, pi / 2), constant(5), {}};
  loops[prcl] = {Kind::closed, t.sensor, constant(20), {}};
  loops[srcl] = {Kind::closed, {"", demodulated("SRM", 1, 0.3).readout.of_leaving()}, constant(2), {}};
  auto const stray = [&](LinearResponse const& r) { return t.stray(r); };
  constexpr std::array<Freedom, 4> freedoms = {Freedom::carm, Freedom::mich, Freedom::prcl, Freedom::srcl};
  Eigen::Matrix4cd response;
  Eigen::Vector4cd sensed;
  for (int i = 0; i < 4; ++i) {
    LinearResponse const r = t.detector.response(loops[std::size_t(i)].sensor.readout, hz);
    sensed[i] = stray(r);
    for (int j = 0; j < 4; ++j) response(i, j) = t.detector.to_freedom(r, freedoms[std::size_t(j)]);
  }
  Eigen::Matrix4cd control = Eigen::Matrix4cd::Zero();
  for (int i = 0; i < 4; ++i) control(i, i) = loops[std::size_t(i)].open_loop(hz) / response(i, i);
  Eigen::Vector4cd const x = -(Eigen::Matrix4cd::Identity() + control * response).inverse() * control * sensed;
  LinearResponse const dark = t.detector.response(hz);
  Phasor expected = stray(dark), diagonal = expected;
  for (int i = 0; i < 4; ++i) {
    Phasor const seen = t.detector.to_freedom(dark, freedoms[std::size_t(i)]);
    expected += seen * x[i];
    diagonal -= seen * control(i, i) * sensed[i] / (1.0 + control(i, i) * response(i, i));
  }
  HeldResponse const controlled = t.response(hz, loops);
  CalibratedStrain const& solved = controlled.strain();
  EXPECT_LT(std::abs(solved.to(stray) / expected - 1.0), 1e-9);
  EXPECT_GT(std::abs(solved.to(stray) / diagonal - 1.0), 1e-3) << "control: loops that do not act on each other";
  CalibratedStrain::Parts const parts = solved.parts(stray);
  Phasor sum = parts.held;
  for (Phasor const p : parts.by_length) sum += p;
  EXPECT_LT(std::abs(sum / expected - 1.0), 1e-9);
  EXPECT_LT(std::abs(parts.held / HeldResponse(t.detector, hz).strain().to(stray) - 1.0), 1e-9);
}

// Without loops the response is that of the light alone; with infinite gain the sensor hears nothing of the stray
// light; a feed-forward of the whole control signal leaves what the light alone does.
TEST(ControlLoops, LimitsOfGainAndFeedforward) {
  Recycling const t;
  double const hz = 10;
  auto const stray = [&](LinearResponse const& r) { return t.stray(r); };
  LinearResponse const dark = t.detector.response(hz), sensor = t.detector.response(t.sensor.readout, hz);
  Phasor const alone = stray(dark), written = stray(sensor) / t.detector.to_freedom(sensor, Freedom::prcl),
               seen = t.detector.to_freedom(dark, Freedom::prcl);
  auto const with = [&](Recycling::Loops const& loops) { return t.response(hz, loops).strain().to(stray); };
  EXPECT_LT(std::abs(with(t.loops(0)) / alone - 1.0), 1e-9);
  EXPECT_LT(std::abs(with(t.loops(1e9)) / (alone - seen * written) - 1.0), 1e-6);
  Recycling::Loops subtracted = t.loops(9);
  subtracted[prcl].feedforward = constant(1);
  EXPECT_LT(std::abs(with(subtracted) / alone - 1.0), 1e-9);
  subtracted[prcl].feedforward = constant(0.5);
  EXPECT_LT(std::abs(with(subtracted) / (0.5 * (alone + with(t.loops(9)))) - 1.0), 1e-9);
  EXPECT_GT(std::abs(with(t.loops(9)) / alone - 1.0), 0.02) << "control: no feed-forward";
}

// Displacements of the mirrors and of the signal mirror as noises of a detector with free lengths, and POP_I as the
// channel.
struct Subtracted {
  Recycling t;
  NetworkModel model = t.detector.model("");
  explicit Subtracted(std::vector<std::pair<char const*, double>> const& noises, double gain = 0) {
    Recycling::Loops const loops = t.loops(gain);
    for (std::size_t i = 0; i < loops.size(); ++i) model.controlled[i].loop = loops[i];
    for (auto const& [mirror, asd] : noises)
      model.noises.push_back({.cause = *find_cause(model, mirror), .level = asd});
  }
  CalibratedStrain strain(double hz) const { return {model, t.detector.field(), hz}; }
  Phasor moved(CalibratedStrain const& s, char const* mirror) const {
    return s.to([&](LinearResponse const& r) { return r.to_displacement(model.network.find(mirror)); });
  }
};

// The filter is -S_xy/S_x of the noises and the vacuum, and what remains S_y - |S_xy|^2/S_x.
TEST(ControlLoops, BestFilterN33) {
  double const hz = 30, of_prm = 3e-17, of_srm = 1e-12;
  Subtracted s({{"PRM", of_prm}, {"SRM", of_srm}});
  auto const& d = s.t.detector;
  LinearResponse const dark = d.response(hz), channel = d.response(s.t.sensor.readout, hz);
  Phasor cross = dark.vacuum_correlation(channel);
  double own = vacuum_noise(d.network(), d.field(), s.t.sensor.readout, hz), before = dark.quantum_noise();
  for (auto const& [mirror, asd] : {std::pair{"PRM", of_prm}, std::pair{"SRM", of_srm}}) {
    Phasor const y = dark.to_displacement(d.network().find(mirror)),
                 x = channel.to_displacement(d.network().find(mirror));
    cross += y * std::conj(x) * asd * asd;
    own += std::norm(x) * asd * asd;
    before += std::norm(y) * asd * asd;
  }
  s.model.subtracted = {{s.t.sensor, {}}};
  CalibratedStrain const best = s.strain(hz);
  ASSERT_EQ(best.filters().size(), 1);
  EXPECT_LT(std::abs(best.filters()[0] / (-cross / own) - 1.0), 1e-9);
  ComponentId const srm = d.network().find("SRM");
  Phasor const alone = -dark.to_displacement(srm) / channel.to_displacement(srm);
  EXPECT_GT(std::abs(best.filters()[0] / alone - 1.0), 0.01) << "control: the filter of one of the noises";
  CalibratedStrain::Sum const rest = best.whole();
  double const expected = before - std::norm(cross) / own;
  EXPECT_NEAR(std::real(best.spectrum(rest, rest)) / expected, 1, 1e-6);
  EXPECT_LT(expected, 0.05 * before);
  for (double const factor : {0.99, 1.01}) {  // any other filter leaves more
    s.model.subtracted[0].filter =
        TransferFunction("", {hz / 2, 2 * hz}, {factor * best.filters()[0], factor * best.filters()[0]});
    CalibratedStrain const other = s.strain(hz);
    CalibratedStrain::Sum const more = other.whole();
    EXPECT_GT(std::real(other.spectrum(more, more)), expected) << factor;
  }
}

// One noise far above the vacuum disappears, with the loop of its length closed or not; stray light is then that of
// both signals.
TEST(ControlLoops, OneNoiseIsSubtractedWhole) {
  for (double const gain : {0.0, 9.0}) {
    Subtracted s({{"SRM", 1e-10}}, gain);
    double const hz = 30;
    Phasor const before = s.moved(s.strain(hz), "SRM"),
                 light = s.strain(hz).to([&](auto const&r) { return s.t.stray(r); });
    s.model.subtracted = {{s.t.sensor, {}}};
    CalibratedStrain const best = s.strain(hz);
    EXPECT_LT(std::abs(s.moved(best, "SRM") / before), 1e-6) << gain;
    auto const stray = [&](LinearResponse const& r) { return s.t.stray(r); };
    EXPECT_GT(std::abs(best.to(stray) / light - 1.0), 0.01) << "the filter acts on stray light too";
    CalibratedStrain::Parts const parts = best.parts(stray);
    Phasor sum = parts.held;
    for (Phasor const p : parts.by_length) sum += p;
    EXPECT_LT(std::abs(sum / best.to(stray) - 1.0), 1e-9);
    std::vector<CalibratedStrain::Sum> const sums = best.part_sums();
    EXPECT_LT(std::abs(stray(sums[0].response) / parts.held - 1.0), 1e-9);
    EXPECT_LT(std::abs(stray(sums[1 + prcl].response) / parts.by_length[prcl] - 1.0), 1e-6);
    EXPECT_LT(std::abs(stray(best.whole().response) / best.to(stray) - 1.0), 1e-9);
  }
}

// G = g/(1 - i f/p)^n: unity gain and phase margin in closed form; with three poles the gain goes around -1 above 8.
TEST(ControlLoops, Margins) {
  LoopMargins const one = loop_margins({{}, {1}, 100}, {0.01, 1e4});
  EXPECT_NEAR(one.unity_gain / std::sqrt(1e4 - 1), 1, 1e-6);
  EXPECT_NEAR(one.phase_margin, pi - std::atan(std::sqrt(1e4 - 1)), 1e-6);
  EXPECT_FALSE(one.encircles);
  EXPECT_FALSE(loop_margins({{}, {1, 1, 1}, 7}, {0.001, 1e4}).encircles);
  LoopMargins const three = loop_margins({{}, {1, 1, 1}, 9}, {0.001, 1e4});
  EXPECT_TRUE(three.encircles);
  // The wrong sign of a gain above 1, with and without an integrator at low frequencies, and the stable loops of the
  // other sign. One pole at f_p: 1 - g/(1 + i f/f_p) vanishes at a growing frequency for g > 1.
  for (double const gain : {-15.0, 15.0}) {
    EXPECT_EQ(loop_margins({{}, {1}, gain}, {0.001, 1e4}).encircles, gain < 0) << gain;
    EXPECT_EQ(loop_margins({{}, {1e-6}, 1e6 * gain}, {0.001, 1e4}).encircles, gain < 0) << gain;
  }
  EXPECT_FALSE(loop_margins({{}, {1}, -0.9}, {0.001, 1e4}).encircles) << "below 1, either sign is stable";
  EXPECT_LT(three.phase_margin, 0);
  EXPECT_FALSE(loop_margins({{1}, {0, 0}, 100}, {0.001, 1e4}).encircles) << "two integrators";
  EXPECT_NEAR(loop_margins({{}, {}, -0.9}, {1, 100}).least, 0.1, 1e-12);
}

}  // namespace
}  // namespace straytrace::ifo_control
