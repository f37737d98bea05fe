// SPDX-License-Identifier: BSD-3-Clause
// Stray light between any two beams of a network (docs/theory/interferometer.md, eq. N.12 to N.19). Numbers without a
// closed form are full solutions of FINESSE 3 with a weak pick-off in Advanced Virgo.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "ifo/network_interferometer.hpp"
#include "physics/ifo/support.hpp"

namespace straytrace {
namespace {

constexpr double wavelength = 1064e-9;

DualRecycledParameters advanced_virgo(double mass = infinity) {
  DualRecycledParameters p = dual_recycled_presets()[0].parameters;
  p.mirror_mass = mass;
  return p;
}

// Advanced Virgo read by the power that leaves the signal-recycling mirror, no length held.
class Free {
 public:
  explicit Free(DualRecycledParameters const& p)
      : d_(p), model_(d_.model("adv")), readout_(model_.readout("AS")->readout) {}

  BeamPlace at(char const* beam, double distance = 0) const { return {*find_beam(d_.network(), beam), distance}; }
  StrayWay back(char const* fed, double distance = 0) const {
    return returning(*find_beam(d_.network(), fed), distance);
  }
  LinearResponse read(double hz) const { return d_.response(readout_, hz); }
  StrayResponse to(StrayWay const& way, double hz) const {
    return stray_response(read(hz), d_.network(), d_.field(), way, hz) * (1.0 / darm(hz));
  }
  Phasor darm(double hz) const { return d_.to_freedom(read(hz), Freedom::darm); }
  // m of DARM per unit of field, rms over static phases and times.
  double rms(StrayWay const& way, double hz) const { return to(way, hz).both() / std::sqrt(2); }
  DualRecycled const& detector() const { return d_; }
  NetworkModel const& model() const { return model_; }

 private:
  DualRecycled d_;
  NetworkModel model_;
  Readout readout_;
};

void expect_three(Free const& f, StrayWay const& way, std::array<double, 3> const& expected, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    double const hz = std::pow(10, double(i) + 1);
    EXPECT_NEAR(f.rms(way, hz) / expected[i], 1, tolerance) << hz << " Hz";
  }
}

TEST(StrayResponse, PickOffInAnArm) {
  Free const heavy(advanced_virgo());
  StrayWay const way = heavy.back("ITMx.back.in", 1000);
  expect_three(heavy, way, {5.98838578e-8, 5.98735107e-8, 5.98734062e-8}, 2e-4);
  EXPECT_NEAR(heavy.rms(way, 1000) / (wavelength / (4 * pi * std::sqrt(2))), 1, 1e-3) << "eq. 9.1";
  EXPECT_GT(std::fabs(heavy.rms(heavy.back("BS.3.in"), 1000) / 5.98734062e-8 - 1), 0.9) << "control: in a short arm";
}

// Both ways of a short arm, relative to the light that is scattered.
TEST(StrayResponse, PickOffInAShortArm) {
  Free const heavy(advanced_virgo());
  StrayWay const out = heavy.back("BS.3.in", 3), in = heavy.back("ITMx.front.in", 3.115);
  std::array<double, 3> const from_splitter = {2.1678e-10, 4.3455e-10, 3.78888e-9},
                              from_mirror = {2.1202e-10, 4.2852e-10, 3.74631e-9};
  expect_three(heavy, out, from_splitter, 1e-4);
  expect_three(heavy, in, from_mirror, 1e-4);
  double const joined =
      std::sqrt(lighting_power(in, heavy.detector().field()) / heavy.detector().field().power_in(in.fed.beam.port));
  EXPECT_GT(std::fabs(heavy.rms(in, 100) / joined / from_mirror[1] - 1), 0.01) << "control: relative to light joined";
}

// Eq. N.18: the way and its reverse feed different beams and interfere.
TEST(StrayResponse, WithTheLightOfAShortArm) {
  Free const heavy(advanced_virgo());
  StrayWay way{.lit = heavy.at("BS.3.out", 3), .fed = heavy.at("BS.3.out", 3.5)};
  std::array<double, 3> const expected = {4.2211e-10, 4.2206e-10, 4.2363e-10};
  expect_three(heavy, way, expected, 1e-4);
  DualRecycledParameters const p = advanced_virgo();
  double const closed = wavelength / (4 * pi) * pi / finesse(arm_of(p)) / std::sqrt(2);
  for (double const hz : {10.0, 100.0, 1000.0}) EXPECT_NEAR(heavy.rms(way, hz) / closed, 1, 0.01) << hz;
  way.alone = true;
  EXPECT_GT(heavy.rms(way, 1000) / heavy.rms(way, 10), 8) << "control: one term rises";
  EXPECT_NEAR(heavy.rms(way, 10) / closed, 0.5, 0.02);
}

// Eq. N.17: (1 + ix) towards the arm, (1 - ix) away from it. Eq. 9.5 is relative to the light that is joined, which is
// r_arm of the light scattered on the way from the splitter, and 1/r_arm on the way back.
TEST(StrayResponse, DirectionsOfAShortArmAreConjugate) {
  DualRecycledParameters p = advanced_virgo();
  p.dark_fringe_offset = 0;
  Free const heavy(p);
  auto const turned = [&](StrayWay way, double hz) {
    turn_to_local_light(way, heavy.detector().network(), heavy.detector().field());
    DualRecycled const& d = heavy.detector();
    LinearResponse const r = d.response(hz);
    return stray_response(r, d.network(), d.field(), way, hz).phase() / d.to_freedom(r, Freedom::darm);
  };
  double const pole = cavity_pole(arm_of(p)), size = wavelength / (4 * pi) * pi / (2 * finesse(arm_of(p)));
  for (double const hz : {10.0, pole, 300.0}) {
    SteadyField const& field = heavy.detector().field();
    std::uint32_t const port = heavy.at("ITMx.front.in").beam.port;
    double const arm = std::sqrt(field.power_out(port) / field.power_in(port));
    Phasor const towards = turned(heavy.back("ITMx.front.in"), hz) / size,
                 away = turned(heavy.back("BS.3.in"), hz) / size, x(0, hz / pole);
    EXPECT_NEAR(std::abs(towards / (1.0 + x)) / arm, 1, 0.01) << hz;
    EXPECT_NEAR(std::abs(away / (1.0 - x)) * arm, 1, 0.01) << hz;
    EXPECT_NEAR(std::fabs(std::remainder(std::arg(away / towards) - std::arg((1.0 - x) / (1.0 + x)), pi)), 0, 0.01)
        << hz;
  }
  Phasor const x(0, 1);
  EXPECT_GT(std::fabs(std::remainder(std::arg((1.0 - x) / (1.0 + x)), pi)), 1) << "control: the same direction";
}

TEST(StrayResponse, PickOffInTheRecyclingCavities) {
  Free const heavy(advanced_virgo());
  expect_three(heavy, heavy.back("PRM.back.in", 2), {7.82897e-12, 7.87038e-13, 8.0803e-14}, 1e-4);
  StrayWay const to_mirror = heavy.back("BS.4.in", 2), from_mirror = heavy.back("BS.4.out", 2);
  expect_three(heavy, to_mirror, {1.50781e-12, 3.04801e-12, 2.66467e-11}, 1e-4);
  expect_three(heavy, from_mirror, {1.36345e-12, 2.73357e-12, 2.38344e-11}, 1e-4);
  SteadyField const& field = heavy.detector().field();
  double const joined =
      std::sqrt(field.power_out(from_mirror.fed.beam.port) / field.power_in(from_mirror.fed.beam.port));
  EXPECT_NEAR(joined, 1 / std::sqrt(0.8), 1e-9) << "control: relative to the light joined 11.8 % more";
}

// Radiation pressure at 10 Hz: gains Gamma - 3/4 and Gamma - 1/4 of light that joins in an arm (eq. N.19).
TEST(StrayResponse, RecoilOfTheMirrors) {
  Free const f(advanced_virgo(42));
  constexpr double hz = 10;
  double const to_input = f.rms(f.back("ITMx.back.in", 1000), hz), to_end = f.rms(f.back("ETMx.front.in", 1999.8), hz);
  EXPECT_NEAR(to_input / 5.7521e-7, 1, 3e-4);
  EXPECT_NEAR(to_end / 6.1276e-7, 1, 3e-4);
  EXPECT_NEAR(f.rms(f.back("BS.3.in", 3), hz) / 3.59707e-8, 1, 3e-4);
  EXPECT_NEAR(f.rms(f.back("ITMx.front.in", 3.115), hz) / 3.96836e-8, 1, 3e-4);
  EXPECT_NEAR(f.rms({.lit = f.at("BS.3.out", 3), .fed = f.at("BS.3.out", 3.5)}, hz) / 4.5923e-9, 1, 3e-4);
  EXPECT_NEAR(f.rms(f.back("BS.4.in", 2), hz) / 2.82536e-10, 1, 3e-4);
  double const gamma = differential_mode(arm_of(f.detector().parameters()), 0.2).gain,
               at_input = f.to(f.back("ITMx.back.out"), hz).both() / std::sqrt(2);
  EXPECT_NEAR(to_input / to_end / ((gamma - 0.75) / (gamma - 0.25)), 1, 3e-3);
  EXPECT_NEAR(to_end / at_input / ((gamma - 0.25) / gamma), 1, 0.01);
  EXPECT_GT(std::fabs(to_input / to_end - 1), 0.05) << "control: Gamma for all";
}

// A thin lossless mirror of amplitude r: i r e^{2ikx} in front, i r e^{-2ikx} behind. m of DARM per r and per m of its
// motion, rms of two places an eighth of the wavelength apart.
double moved(Free const& f, StrayWay const& front, double hz, bool coherent = true) {
  double const k = 2 * pi / wavelength;
  StrayResponse const a = f.to(front, hz), b = f.to(returning(reversed(front.fed.beam), front.fed.distance), hz);
  double sum = 0;
  for (double const place : {0.0, wavelength / 8}) {
    // d(i r e^{2ikx})/dx = -2 k r e^{2ikx}, behind +2 k r e^{-2ikx}; half of a real motion is at f, half at -f.
    Phasor const c = -k * std::polar(1.0, 2 * k * place), e = k * std::polar(1.0, -2 * k * place);
    Phasor const ahead = a.upper * c + a.lower * std::conj(c), behind = b.upper * e + b.lower * std::conj(e);
    sum += 0.5 * (coherent ? std::norm(ahead + behind) : std::norm(ahead) + std::norm(behind));
  }
  return std::sqrt(sum);
}

TEST(StrayResponse, TwoSidedMirror) {
  Free const f(advanced_virgo());
  struct Case {
    StrayWay way;
    std::array<double, 3> expected;
  };
  std::array<Case, 3> const cases = {{{f.back("ITMx.back.in", 1000), {1.414223, 1.414210, 1.412981}},
                                      {f.back("BS.3.in", 3), {4.98484e-3, 4.98493e-3, 4.99439e-3}},
                                      {f.back("PRM.back.in", 2), {1.33938e-6, 1.34765e-7, 4.29832e-7}}}};
  for (Case const& c : cases)
    for (std::size_t i = 0; i < 3; ++i) {
      double const hz = std::pow(10, double(i) + 1);
      EXPECT_NEAR(moved(f, c.way, hz) / c.expected[i], 1, 2e-5) << hz;
      EXPECT_GT(std::fabs(moved(f, c.way, hz, false) / c.expected[i] - 1), 0.2) << "control: sides added as powers";
    }
}

// Eq. N.20: one way that holds both sides. Over the place of the mirror, Im s and Re s have half of (2 k r x)^2 each.
TEST(StrayResponse, BothSidesOfAFace) {
  Free const f(advanced_virgo());
  struct Case {
    char const* beam;
    double distance;
    std::array<double, 3> expected;
  };
  for (Case const& c : {Case{"ITMx.back.in", 1000, {1.414223, 1.414210, 1.412981}},
                        Case{"BS.3.in", 3, {4.98484e-3, 4.98493e-3, 4.99439e-3}},
                        Case{"PRM.back.in", 2, {1.33938e-6, 1.34765e-7, 4.29832e-7}}}) {
    StrayWay one = f.back(c.beam, c.distance), both = one;
    both.both_sides = true;
    for (std::size_t i = 0; i < 3; ++i) {
      double const hz = std::pow(10, double(i) + 1), scale = 4 * pi / wavelength;
      EXPECT_NEAR(scale * f.rms(both, hz) / c.expected[i], 1, 2e-5) << c.beam << " " << hz;
      double const powers = std::hypot(f.rms(one, hz), f.rms(returning(reversed(one.fed.beam), c.distance), hz));
      EXPECT_GT(std::fabs(scale * powers / c.expected[i] - 1), 0.2) << "control: sides added as powers";
    }
  }
}

// What a rim takes from the light of an arm, each way, is a loss: s = -L/4 per way for the loss L of the end mirror,
// whose effect on the read-out has an adjoint solution of its own (eq. N.21).
TEST(StrayResponse, LightThatPassesARim) {
  Free const still(advanced_virgo());
  constexpr double slow = 1e-4;  // Hz, far below all poles
  Network const& network = still.detector().network();
  NetworkBeam const beam = *find_beam(network, "ETMx.front.in");
  StrayWay const way = passing(network, beam);
  double const per_field = still.to(way, slow).amplitude().real() * still.darm(slow).real(),
               per_loss = AdjointSlope(network, still.detector().field(), still.model().readout("AS")->readout)
                              .to_loss(network.find("ETMx"));
  EXPECT_NEAR(-per_field / 4 / per_loss, 1, 1e-3);
  StrayWay const back = still.back("ETMx.front.in", 1000);
  EXPECT_GT(std::fabs(still.to(back, slow).amplitude().real() * still.darm(slow).real() / per_field - 1), 0.1)
      << "control: light that is scattered back";
  EXPECT_NEAR(std::abs(still.to(passing(network, *find_beam(network, "ITMx.back.out")), slow).amplitude()) /
                  std::abs(still.to(way, slow).amplitude()),
              1, 1e-9);

  // Radiation pressure: both ways of eq. N.19 together, 2 Gamma - 1.
  DualRecycledParameters p = advanced_virgo(42);
  Free const f(p);
  constexpr double hz = 10;
  double const gamma = differential_mode(arm_of(p), p.signal_recycling_transmission).gain,
               found = std::abs(f.to(passing(f.detector().network(), beam), hz).amplitude()),
               at_input = f.to(f.back("ITMx.back.out"), hz).both();
  EXPECT_NEAR(found / at_input / ((2 * gamma - 1) / gamma), 1, 0.02);
  EXPECT_GT(std::fabs(found / at_input / 2 - 1), 0.03) << "control: with the recoil of the mirror";
}

}  // namespace
}  // namespace straytrace
