// SPDX-License-Identifier: BSD-3-Clause
// The table `interferometer` against the beams of the scene and against itself.
#include "unit/ifo/ports_support.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// The power of a beam is that of the arms only where its port is in an arm.
TEST(PortConflicts, PowerOfTheBeam) {
  std::vector<TracedPort> const ports = {{.name = "ITM"}, {.name = "bench", .power = 1}};
  auto const warnings = [&](std::string const& keys) {
    Detector const d = detector(keys, {}, 1064e-9, ports);
    EXPECT_THAT(d.problems, IsEmpty());
    return d.scene.warnings();
  };
  EXPECT_THAT(warnings("preset: adv"), HasSubstr("the beam of port 'bench' has 1 W"));
  EXPECT_THAT(warnings("preset: adv, ports: {bench: {at: end-mirror}}"), HasSubstr("the beam of port 'bench' has 1 W"));
  EXPECT_THAT(warnings("preset: adv, ports: {bench: {at: end-bench}}"), IsEmpty());
  std::string const closed =
      "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %";
  EXPECT_THAT(detector(closed, {}, 1064e-9, ports).ifo->description(), HasSubstr("P 1 W per arm"));
  EXPECT_THAT(detector(closed + ", ports: {bench: {at: short-arm}}", {}, 1064e-9, ports).problems,
              HasSubstr("the power in the arms is missing"));
}

// Which of two powers the arms have is not for the order of the ports to decide.
TEST(PortConflicts, PowersOfTwoBeams) {
  TracedPort const weak = {.name = "ITM", .power = 3}, strong = {.name = "bench", .power = 650e3};
  std::string const closed =
      "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %";
  for (auto const& ports : {std::vector{weak, strong}, std::vector{strong, weak}}) {
    auto const said = [&](std::string const& keys) { return detector(keys, {}, 1064e-9, ports); };
    EXPECT_THAT(said(closed).problems, HasSubstr("two beams in the arms state different powers"));
    Detector const apart = said(closed + ", ports: {ITM: {at: short-arm}}");
    ASSERT_THAT(apart.problems, IsEmpty());
    EXPECT_THAT(apart.ifo->description(), HasSubstr("P 6.5e+05 W per arm"));
    EXPECT_THAT(apart.scene.warnings(), IsEmpty());
    for (std::string const& keys : {closed + ", arm_power: 660 kW", std::string("preset: adv")}) {
      Detector const stated = said(keys);
      EXPECT_THAT(stated.problems, IsEmpty()) << keys;
      EXPECT_THAT(stated.scene.warnings(), HasSubstr("the beam of port 'ITM' has 3 W")) << keys;
      EXPECT_THAT(stated.scene.warnings(), Not(HasSubstr("'bench'"))) << "control: within 10 %";
    }
  }
  std::vector<TracedPort> const near = {strong, {.name = "ETM", .power = 660e3}};
  EXPECT_THAT(detector(closed, {}, 1064e-9, near).problems, IsEmpty());
}

// Strain takes the length from the interferometer: a cavity of another one would be scaled without a word.
TEST(PortConflicts, LengthsOfCavities) {
  std::vector<TracedPort> const ports = {{.name = "ITM", .cavity_length = 3000},
                                         {.name = "bench", .cavity_length = 10}};
  std::string const bench = ", ports: {bench: {at: end-bench}}",
                    closed =
                        "preset: fabry-perot-michelson, mirror_mass: 42 kg, input_transmission: 1.4 %, "
                        "end_transmission: 4 ppm, arm_power: 1 kW, arm_length: ";
  auto const warnings = [&](std::string const& keys) {
    Detector const d = detector(keys + bench, {}, 1064e-9, ports);
    EXPECT_THAT(d.problems, IsEmpty()) << keys;
    return d.scene.warnings();
  };
  for (std::string const& longer : {std::string("preset: ce"), closed + "40 km"})
    EXPECT_THAT(warnings(longer), HasSubstr("the cavity of port 'ITM' is 3000 m long, and the arms of the "
                                            "interferometer 40000 m"));
  for (std::string const& same : {std::string("preset: adv"), closed + "3.02 km"})
    EXPECT_THAT(warnings(same), IsEmpty()) << "control: within 1 %, and a cavity outside the arms";
}

// Keys without effect, or with values that cannot be built, are reported.
TEST(PortConflicts, KeysThatDoNothing) {
  FileTexts const files = {{"phase.txt", "10 3e-12 0\n1000 0 -3e-12\n"}};
  EXPECT_THAT(detector("preset: adv, homodyne_angle: 80 deg").problems, HasSubstr("power at the dark port"));
  EXPECT_THAT(detector("preset: adv, dark_fringe_offset: 0 m, homodyne_angle: 80 deg").problems, IsEmpty());
  EXPECT_THAT(detector("preset: adv, short_arm: 5 m, schnupp_asymmetry: 20 m").problems,
              HasSubstr("write 'short_arm: 10 m' or more"));
  EXPECT_THAT(detector("preset: adv, short_arm: 5 m, schnupp_asymmetry: -9 m").problems, IsEmpty());
  std::string const unit =
      "preset: adv, responses: {bench: {phase: phase.txt, darm: phase.txt, columns: [Hz, re, im], unit: ";
  EXPECT_THAT(detector(unit + "m}}", files).problems, HasSubstr("'darm' would have no effect"));
  EXPECT_THAT(detector(unit + "W}}", files).problems, IsEmpty());
  std::string const servo = "preset: adv, loss_difference: 20 ppm, frequency_servo: {gain: 9}";
  EXPECT_THAT(detector(servo).scene.warnings(), HasSubstr("'frequency_servo' quiets light at 'input-bench'"));
  EXPECT_THAT(detector(servo + ", ports: {bench: {at: input-bench}}").scene.warnings(), IsEmpty());
}

// Errors inside an entry of an unknown port are reported with its name.
TEST(PortConflicts, FaultsOfUnknownPorts) {
  std::string const problems =
      detector(
          "preset: adv, ports: {bnch: {at: end-bnch}}, responses: {bnch: {phase: none.txt, columns: [Hz, re, im], "
          "unit: kg}}")
          .problems;
  EXPECT_THAT(problems, HasSubstr("did you mean 'bench'?"));
  EXPECT_THAT(problems, HasSubstr("did you mean 'end-bench'?"));
  EXPECT_THAT(problems, HasSubstr("none.txt"));
  EXPECT_THAT(problems, HasSubstr("kg"));
}

}  // namespace
}  // namespace straytrace::testing
