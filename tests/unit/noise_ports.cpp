// SPDX-License-Identifier: BSD-3-Clause
// The table `interferometer`: presets of networks, ports, servos, responses from files.
#include "ifo/dual_recycled.hpp"
#include "ifo/interferometer.hpp"
#include "noise_support_scene.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Detector {
  Scene scene;
  std::unique_ptr<Interferometer> ifo;
  std::string problems;
};

Detector detector(std::string const& keys, FileTexts files = {}, double wavelength = 1064e-9) {
  Detector d{scene_of("interferometer: {" + keys + "}\n", std::move(files)), {}, {}};
  d.ifo = make_interferometer(d.scene.root()["interferometer"], {"ITM", "bench"}, wavelength);
  d.problems = problems_of(d.scene);
  return d;
}
double phase(Detector const& d, std::uint32_t port, double hz = 100) {
  return std::abs(d.ifo->strain_per_phase(PortId{port}, hz));
}

TEST(ReadPorts, PresetsStandAlone) {
  for (DualRecycledPreset const& p : dual_recycled_presets()) {
    Detector const d = detector("preset: " + std::string(p.name), {}, p.parameters.wavelength);
    ASSERT_THAT(d.problems, IsEmpty()) << p.name;
    EXPECT_NEAR(phase(d, 0, 10) / (p.parameters.wavelength / (4 * pi * p.parameters.arm_length)), 1, 2e-3) << p.name;
    EXPECT_THAT(d.ifo->description(), HasSubstr("Gamma"));
    EXPECT_THAT(d.ifo->description(), HasSubstr("ITM, bench: arm, 2 copies"));
  }
}

TEST(ReadPorts, EntrancesSharesAndCopies) {
  Detector const d = detector(
      "preset: adv, ports: {ITM: {at: as-port, isolation: -37 dB}, bench: {at: end-bench, pick_off: 10 %, copies: 1}}");
  ASSERT_THAT(d.problems, IsEmpty());
  Detector const open = detector("preset: adv, ports: {ITM: {at: as-port}, bench: {at: end-bench}}");
  EXPECT_NEAR(phase(d, 0) / phase(open, 0), std::pow(10, -37.0 / 20), 1e-12);
  EXPECT_NEAR(phase(d, 1) / phase(open, 1), 0.1, 1e-12);
  EXPECT_EQ(d.ifo->copies(PortId{0}), 1);
  EXPECT_EQ(d.ifo->copies(PortId{1}), 1);
  EXPECT_EQ(open.ifo->copies(PortId{1}), 2);
  EXPECT_THAT(d.ifo->description(), HasSubstr("bench: end-bench (field x 0.1), 1 copy"));
}

TEST(ReadPorts, ClosedFormsKnowThemToo) {
  std::string const keys =
      "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, arm_power: 100 "
      "kW, ";
  Detector const d = detector(keys + "end_transmission: 4 ppm, ports: {bench: {at: end-bench}}");
  ASSERT_THAT(d.problems, IsEmpty());
  EXPECT_NEAR(phase(d, 1) / phase(d, 0), 4e-6, 1e-15);
  EXPECT_THAT(detector(keys + "ports: {bench: {at: end-bench}}").problems, HasSubstr("transmits nothing"));
  EXPECT_THAT(detector(keys + "ports: {bench: {at: as-port}}").problems, HasSubstr("offset of the dark fringe"));
  EXPECT_THAT(detector(keys + "ports: {bench: {at: input-bench}}").problems, HasSubstr("preset: adv"));
}

TEST(ReadPorts, OverridesOfAPreset) {
  Detector const weak = detector("preset: adv, input_power: 25 W"), strong = detector("preset: adv");
  ASSERT_THAT(weak.problems, IsEmpty());
  auto const pressure = [](Detector const& d) { return std::abs(d.ifo->strain_per_amplitude(PortId{0}, 20)); };
  EXPECT_NEAR(pressure(strong) / pressure(weak), 5, 0.02);
  Detector const given = detector("preset: adv, arm_power: 100 kW");
  ASSERT_THAT(given.problems, IsEmpty());
  EXPECT_THAT(given.ifo->description(), HasSubstr("P 1e+05 W per arm"));
  Detector const own = detector(
      "preset: dual-recycled, arm_length: 3 km, input_transmission: 1 %, mirror_mass: 40 kg, input_power: 10 W");
  EXPECT_THAT(own.problems, IsEmpty());
  EXPECT_THAT(detector("preset: dual-recycled, arm_length: 3 km").problems, HasSubstr("input_transmission"));
}

TEST(ReadPorts, ServosQuietTheInputBench) {
  std::string const bench = "preset: adv, loss_difference: 20 ppm, ports: {bench: {at: input-bench}}";
  Detector const open = detector(bench),
                 closed = detector(bench + ", frequency_servo: {gain: 9}, intensity_servo: {gain: 99}");
  ASSERT_THAT(closed.problems, IsEmpty());
  EXPECT_NEAR(phase(closed, 1) / phase(open, 1), 0.1, 1e-12);
  auto const amplitude = [](Detector const& d) { return std::abs(d.ifo->strain_per_amplitude(PortId{1}, 100)); };
  EXPECT_NEAR(amplitude(closed) / amplitude(open), 0.01, 1e-12);
  EXPECT_EQ(phase(closed, 0), phase(open, 0));
}

TEST(ReadPorts, ResponsesFromFiles) {
  FileTexts const files = {{"phase.txt", "# Hz re im\n10 3e-12 0\n1000 0 -3e-12\n"},
                           {"amplitude.txt", "10, -200, 0\n1000, -280, -90\n"},
                           {"darm.txt", "10 1e9 0\n1000 1e9 0\n"},
                           {"bad.txt", "10 1\n"},
                           {"back.txt", "10 1 0\n5 1 0\n"}};
  Detector const re =
      detector("preset: adv, responses: {bench: {phase: phase.txt, columns: [Hz, re, im], unit: strain}}", files);
  ASSERT_THAT(re.problems, IsEmpty());
  EXPECT_NEAR(phase(re, 1) / 3e-12, 1, 1e-12);
  EXPECT_EQ(std::abs(re.ifo->strain_per_amplitude(PortId{1}, 100)), 0);
  EXPECT_THAT(re.ifo->description(), HasSubstr("port bench: responses from files (phase phase.txt)"));
  EXPECT_THROW(phase(re, 1, 2000), InputError);
  EXPECT_NEAR(phase(re, 0) / 2.82e-11, 1, 0.01);
  Detector const db = detector(
      "preset: adv, responses: {bench: {amplitude: amplitude.txt, columns: [Hz, dB, deg], unit: m, per: power}}",
      files);
  ASSERT_THAT(db.problems, IsEmpty());
  EXPECT_NEAR(std::abs(db.ifo->strain_per_amplitude(PortId{1}, 100)) / (2e-12 / 2999.8), 1, 1e-9);
  Detector const watts = detector(
      "preset: adv, responses: {bench: {phase: phase.txt, darm: darm.txt, columns: [Hz, re, im], unit: W}}", files);
  ASSERT_THAT(watts.problems, IsEmpty());
  EXPECT_NEAR(phase(watts, 1) / (3e-21 / 2999.8), 1, 1e-9);
}

TEST(ReadPorts, Problems) {
  FileTexts const files = {{"bad.txt", "10 1\n"}, {"back.txt", "10 1 0\n5 1 0\n"}};
  EXPECT_THAT(detector("preset: advv").problems, HasSubstr("did you mean 'adv'?"));
  EXPECT_THAT(detector("preset: adv, arm_lenght: 3 km").problems, HasSubstr("did you mean 'arm_length'?"));
  EXPECT_THAT(detector("preset: adv, ports: {bnch: {at: end-bench}}").problems, HasSubstr("did you mean 'bench'?"));
  EXPECT_THAT(detector("preset: adv, ports: {bench: {at: end-bnch}}").problems, HasSubstr("did you mean 'end-bench'?"));
  EXPECT_THAT(detector("preset: adv, ports: {bench: end-bench}").problems, HasSubstr("write {at: end-bench}"));
  EXPECT_THAT(detector("preset: adv, arm_power: 1 kW, input_power: 1 W").problems, HasSubstr("both given"));
  EXPECT_THAT(detector("preset: adv, transmission_difference: 1, input_transmission: 90 %").problems,
              HasSubstr("make them smaller"));
  EXPECT_THAT(detector("preset: adv, responses: {bench: {phase: bad.txt, unit: strain}}", files).problems,
              HasSubstr("columns: [Hz, re, im]"));
  std::string const columns = ", columns: [Hz, re, im], unit: strain}}";
  EXPECT_THAT(detector("preset: adv, responses: {bench: {phase: bad.txt" + columns, files).problems,
              HasSubstr("bad.txt:1:1: error: this line is not three numbers"));
  EXPECT_THAT(detector("preset: adv, responses: {bench: {phase: back.txt" + columns, files).problems,
              HasSubstr("back.txt:2:1: error: frequencies must be positive and rise"));
  EXPECT_THAT(detector("preset: adv, frequency_servo: 3").problems, HasSubstr("a transfer function is a table"));
}

}  // namespace
}  // namespace straytrace::testing
