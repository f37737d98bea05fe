// SPDX-License-Identifier: BSD-3-Clause
// The tables `loops` and `readout` of an interferometer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ifo/dual_recycled.hpp"
#include "unit/ifo/ports_support.hpp"

namespace straytrace::ifo_loop_tables {
namespace {

using straytrace::testing::detector;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string const modulated =
    "preset: adv, modulators: [{frequency: 6.27 MHz, index: 0.1}], network: {readouts: {"
    "POP_I: {demodulate: {at: BS.1.in, frequency: EOM1, phase: best(PRCL)}}, "
    "BHD: {homodyne: {at: SRM.back.out, angle: 90 deg}}, AS_I: {demodulate: {at: SRM.back.out, frequency: EOM1}}}}";
std::string with_loop(std::string const& prcl) { return modulated + ", loops: {PRCL: " + prcl + "}"; }

TEST(ControlLoopTables, WhatLoopsDoIsDescribed) {
  auto const described = [](std::string const& keys) { return detector(keys).ifo->description(); };
  EXPECT_THAT(described("preset: adv"), HasSubstr("CARM, MICH, PRCL and SRCL held;"));
  EXPECT_THAT(described(with_loop("{sensor: POP_I, open_loop: {gain: 9}}, SRCL: free")),
              HasSubstr("CARM and MICH held, PRCL controlled by POP_I, SRCL free;"));
  EXPECT_THAT(described(modulated + ", readout: AS"), HasSubstr("read-out: 'AS'"));
}

TEST(ControlLoopTables, StrainDependsOnThem) {
  std::string const port = ", ports: {bench: {at: recycling-cavity}}";
  auto const strain = [&](std::string const& keys) {
    return std::abs(detector(keys + port).ifo->strain_per_phase(PortId{1}, 10));
  };
  double const held = strain(modulated), closed = strain(with_loop("{sensor: POP_I, open_loop: {gain: 99}}"));
  EXPECT_GT(std::fabs(closed / held - 1), 0.05) << closed << " " << held;
  EXPECT_DOUBLE_EQ(strain(with_loop("held")), held) << "control";
  EXPECT_GT(std::fabs(strain(modulated + ", readout: AS") / held - 1), 1e-6) << "sidebands reach this read-out";
}

TEST(ControlLoopTables, WrongTables) {
  auto const problems = [](std::string const& keys) { return detector(keys).problems; };
  EXPECT_THAT(problems(with_loop("{sensor: POP_I, open_loop: {gain: 9}}")), IsEmpty());
  EXPECT_THAT(problems(with_loop("{sensor: POP_Y, open_loop: {gain: 9}}")),
              AllOf(HasSubstr("no read-out 'POP_Y'"), HasSubstr("did you mean 'POP_I'?")));
  EXPECT_THAT(problems(with_loop("{sensor: POP_I, opn_loop: {gain: 9}, feedforward: 3}")),
              AllOf(HasSubstr("did you mean 'open_loop'?"), HasSubstr("3")));
  EXPECT_THAT(problems(with_loop("{sensor: BHD, open_loop: {gain: 9}}")), HasSubstr("homodyne detector"));
  EXPECT_THAT(problems(with_loop("closed")), HasSubstr("must be a table"));
  EXPECT_THAT(problems(modulated + ", loops: {DARM: {sensor: AS, open_loop: {gain: 9}}}"), HasSubstr("cancels in h"));
  EXPECT_THAT(problems(modulated + ", loops: {PRLC: held}"), HasSubstr("did you mean 'PRCL'?"));
  EXPECT_THAT(problems("preset: adv, dark_fringe_offset: 0 m, loops: {MICH: {sensor: AS, open_loop: {gain: 9}}}"),
              HasSubstr("'AS' does not respond to MICH"));
  EXPECT_THAT(problems(modulated + ", readout: AZ"), HasSubstr("did you mean 'AS'?"));
  EXPECT_THAT(problems(modulated + ", readout: AS, readout_loss: 1 %"), HasSubstr("'readout_loss' has no effect"));
  EXPECT_THAT(problems("preset: adv, dark_fringe_offset: 0 m, readout: AS"), HasSubstr("does not respond to DARM"));
}

TEST(SubtractedChannels, TablesAndProblems) {
  std::string const noisy =
      "preset: adv, modulators: [{frequency: 6.27 MHz, index: 0.1}], network: {readouts: {"
      "POP_I: {demodulate: {at: BS.1.in, frequency: EOM1, phase: best(PRCL)}}}, noises: {SRM: {asd: 1e-16 "
      "m/sqrt(Hz)}}}, "
      "readout: AS, subtract: [";
  auto const problems = [&](std::string const& entry) { return detector(noisy + entry + "]").problems; };
  auto const read = detector(noisy + "{channel: POP_I, filter: best}, {channel: REFL, filter: {gain: 2}}]");
  EXPECT_THAT(read.problems, IsEmpty());
  ASSERT_EQ(read.ifo->network()->subtracted.size(), 2u);
  EXPECT_FALSE(read.ifo->network()->subtracted[0].filter);
  EXPECT_EQ((*read.ifo->network()->subtracted[1].filter)(10), 2.0);
  EXPECT_THAT(read.ifo->description(), HasSubstr("POP_I and REFL subtracted"));
  EXPECT_THAT(problems("{channel: POP_J, filter: best}"),
              AllOf(HasSubstr("'POP_J'"), HasSubstr("did you mean 'POP_I'?")));
  EXPECT_THAT(problems("{channel: POP_I}"), AllOf(HasSubstr("no 'filter'"), HasSubstr("'filter: best'")));
  EXPECT_THAT(problems("{channel: POP_I, filter: bets}"), HasSubstr("a filter cannot be 'bets'"));
  EXPECT_THAT(problems("POP_I"), HasSubstr("must be a table"));
  EXPECT_THAT(problems("{channel: AS, filter: best}"), HasSubstr("the read-out of strain itself"));
  EXPECT_THAT(problems("{channel: POP_I, filter: best}, {channel: POP_I, filter: best}"),
              HasSubstr("subtracted twice"));
  EXPECT_THAT(detector(modulated + ", subtract: [{channel: POP_I, filter: best}]").problems,
              AllOf(HasSubstr("the network states none"), HasSubstr("add 'noises'")));
}

TEST(ControlLoopTables, WarnsOfLoopsNearInstability) {
  auto const warnings = [](std::string const& gain) {
    return detector(with_loop("{sensor: POP_I, open_loop: " + gain + "}")).scene.warnings();
  };
  EXPECT_THAT(warnings("{gain: 9}"), IsEmpty());
  EXPECT_THAT(warnings("{gain: -0.8}"), HasSubstr("|1 + G| of PRCL is 0.2"));
  EXPECT_THAT(warnings("{gain: 1000, poles: [20 Hz, 20 Hz, 20 Hz]}"), HasSubstr("unstable"));
}

TEST(NetworkWarnings, PlaneWavesLeaveOutAperturesAndTilts) {
  std::string const stop = "preset: adv, network: {components: {stop: {aperture: {radius: 1 mm}}}";
  EXPECT_THAT(detector(stop + "}").scene.warnings(), HasSubstr("plane waves leave out the aperture of 'stop'"));
  EXPECT_THAT(detector("preset: adv").scene.warnings(), IsEmpty());
}

}  // namespace
}  // namespace straytrace::ifo_loop_tables
