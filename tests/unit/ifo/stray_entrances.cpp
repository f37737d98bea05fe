// SPDX-License-Identifier: BSD-3-Clause
// Ports that name beams of a network: `at`, `lit_by`, distances, and `strain` of a network without a preset.
#include "ifo/network_model.hpp"
#include "unit/ifo/ports_support.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<TracedPort> const one_port = {{.name = "baffle"}};

Detector with_port(std::string const& preset, std::string const& entry) {
  return detector(preset + ", ports: {baffle: {" + entry + "}}", {}, 1064e-9, one_port);
}
std::array<double, 2> strain(Detector const& d, double hz = 30) {
  return {std::abs(d.ifo->strain_per_phase(PortId{0}, hz)), std::abs(d.ifo->strain_per_amplitude(PortId{0}, hz))};
}

// Names of places and the beams that they stand for.
TEST(StrayEntrances, NamesAreSynonymsOfBeams) {
  struct Pair {
    char const *name, *beams;
    double copies;
  };
  for (Pair const& p :
       {Pair{"short-arm", "at: ITMx.front.in", 2}, Pair{"short-arm-to-splitter", "at: BS.3.in", 2},
        Pair{"signal-cavity", "at: SRM.front.in", 1}, Pair{"signal-cavity-to-splitter", "at: BS.4.in", 1},
        Pair{"recycling-cavity", "at: BS.1.in", 1}, Pair{"recycling-cavity-to-mirror", "at: PRM.back.in", 1},
        Pair{"short-arm", "at: ITMx.front.in, lit_by: ITMx.front.out", 2}}) {
    Detector const named = with_port("preset: adv", std::string("at: ") + p.name),
                   stated = with_port("preset: adv", p.beams);
    ASSERT_THAT(named.problems, IsEmpty()) << p.name;
    ASSERT_THAT(stated.problems, IsEmpty()) << p.beams;
    for (double const hz : {3.0, 30.0, 3000.0})
      for (std::size_t q : {0u, 1u}) EXPECT_NEAR(strain(stated, hz)[q] / strain(named, hz)[q], 1, 1e-9) << p.name << hz;
    EXPECT_EQ(named.ifo->copies(PortId{0}), p.copies) << p.name;
    EXPECT_EQ(stated.ifo->copies(PortId{0}), p.copies) << p.beams;
  }
  EXPECT_GT(std::fabs(strain(with_port("preset: adv", "at: BS.3.in"))[1] /
                          strain(with_port("preset: adv", "at: ITMx.front.in"))[1] -
                      1),
            0.05)
      << "control: another direction";
}

// Light of the arm that joins on the way to the end mirror: Gamma - 1/4 (eq. N.19); scattered by that mirror: Gamma -
// 1/2.
TEST(StrayEntrances, JoiningInAnArm) {
  Detector const between = with_port("preset: ce", "at: ETMx.front.in, distance: 20 km"),
                 mirror = with_port("preset: ce", "at: end-mirror"), arm = with_port("preset: ce", "at: arm");
  ASSERT_THAT(between.problems, IsEmpty());
  double const gamma = 1.23;
  EXPECT_NEAR(strain(between, 5)[1] / strain(arm, 5)[1], (gamma - 0.25) / gamma, 0.01);
  EXPECT_NEAR(strain(mirror, 5)[1] / strain(arm, 5)[1], (gamma - 0.5) / gamma, 0.01) << "control: another recoil";
  EXPECT_THAT(between.ifo->description(), HasSubstr("baffle: ETMx.front.in, 2 copies"));
}

TEST(StrayEntrances, ShareAndCopies) {
  Detector const plain = with_port("preset: adv", "at: BS.4.in"),
                 shared = with_port("preset: adv", "at: BS.4.in, pick_off: 1 %, copies: 3");
  EXPECT_NEAR(strain(shared)[0] / strain(plain)[0], 0.01, 1e-12);
  EXPECT_EQ(shared.ifo->copies(PortId{0}), 3);
}

TEST(StrayEntrances, Problems) {
  auto const said = [](std::string const& entry) { return with_port("preset: adv", entry).problems; };
  EXPECT_THAT(said("at: ITMx.frnt.in"), AllOf(HasSubstr("no beam 'ITMx.frnt.in'"), HasSubstr("'ITMx.front.in'")));
  EXPECT_THAT(said("at: ITMx.front.in, lit_by: BS.3"), HasSubstr("no beam 'BS.3'"));
  EXPECT_THAT(said("at: short-arm, lit_by: BS.3.out"), HasSubstr("'lit_by' needs a beam"));
  EXPECT_THAT(said("at: ITMx.front.in, distance: 7 m"), HasSubstr("is 6.115 m long"));
  EXPECT_THAT(said("at: ITMx.front.in, lit_distance: 7 m"), HasSubstr("needs a beam in 'lit_by'"));
  EXPECT_THAT(said("at: BS.3.in, lit_by: BS.3.out, both_sides: yes"), HasSubstr("'lit_by' has no effect"));
  EXPECT_THAT(said("at: short-arm, both_sides: yes"), HasSubstr("'both_sides' needs a beam"));
  EXPECT_THAT(said("at: PRM.front.in, lit_by: dark.out"), HasSubstr("no light at 'PRM.front.in lit by dark.out'"));
  EXPECT_THAT(
      with_port("preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, "
                "arm_power: 1 kW",
                "at: BS.3.in")
          .problems,
      HasSubstr("closed forms have no beam 'BS.3.in'"));
}

// A Michelson of 3 km whose end mirrors hang; X is lit by half the laser.
std::string const michelson = R"(preset: none, network: {
  components: {laser: {laser: {power: 8 W}}, BS: {splitter: {transmission: 50 %, incidence: 45 deg}},
    X: {mirror: {transmission: 0}}, Y: {mirror: {transmission: 0, tuning: 90 deg, displacement: 1 nm}}},
  spaces: [{from: laser, to: BS.1, length: 1 m}, {from: BS.3, to: X.front, length: 3 km},
    {from: BS.2, to: Y.front, length: 3 km}],
  readouts: {dark: {power: BS.4.out}}, freedoms: {DARM: {X: 0.5, Y: -0.5}}})";

// A field s in one arm turns it by Im s, as a motion of lambda Im s/4 pi of its end mirror (eq. 9.1).
TEST(StrayEntrances, NetworkWithoutPreset) {
  Detector const d = with_port(michelson + ", strain: {readout: dark, freedom: DARM, arm_length: 3 km}", "at: BS.3.in");
  ASSERT_THAT(d.problems, IsEmpty());
  EXPECT_NEAR(strain(d, 10)[0] / (1064e-9 / (4 * pi * 3000)), 1, 1e-4);
  EXPECT_EQ(d.ifo->copies(PortId{0}), 1);
  EXPECT_THAT(d.ifo->description(), AllOf(HasSubstr("read-out 'dark' calibrated as 'DARM' over 3000 m"),
                                          HasSubstr("baffle: BS.3.in, 1 copy")));
  EXPECT_EQ(d.ifo->network()->entrances.size(), 1u);
}

TEST(StrayEntrances, WhatANetworkWithoutPresetNeeds) {
  auto const said = [](std::string const& keys) { return detector(michelson + keys, {}, 1064e-9, one_port).problems; };
  EXPECT_THAT(said(""), AllOf(HasSubstr("becomes strain"), HasSubstr("'strain: {readout: AS")));
  std::string const stated = ", strain: {readout: dark, arm_length: 3 km}";
  EXPECT_THAT(said(stated), AllOf(HasSubstr("where light of port 'baffle' joins"), HasSubstr("at: ITM.front.in")));
  std::string const port = ", ports: {baffle: {at: X.front.in}}";
  EXPECT_THAT(said(port + stated), IsEmpty());
  EXPECT_THAT(said(", ports: {baffle: {at: end-mirror}}" + stated), HasSubstr("this network has no such place"));
  std::string both = michelson;
  both.replace(both.find("DARM: {X: 0.5, Y: -0.5}"), 23, "DARM: {X: 0, Y: 0}");
  EXPECT_THAT(detector(both + port + stated, {}, 1064e-9, one_port).problems, HasSubstr("nothing moves with 'DARM'"));
  EXPECT_THAT(said(port + ", strain: {readout: drak, arm_length: 3 km}"),
              AllOf(HasSubstr("no read-out 'drak'"), HasSubstr("'dark'")));
  EXPECT_THAT(said(port + ", strain: {readout: dark, freedom: MICH, arm_length: 3 km}"),
              HasSubstr("no degree of freedom 'MICH'"));
  EXPECT_THAT(said(port + ", strain: {readout: dark}"), HasSubstr("arm_length"));
  EXPECT_THAT(said(", ports: {baffle: {at: laser.out, lit_by: X.back.out}}" + stated),
              HasSubstr("no light comes from"));
}

}  // namespace
}  // namespace straytrace::testing
