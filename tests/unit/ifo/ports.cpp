// SPDX-License-Identifier: BSD-3-Clause
// The table `interferometer`: presets of networks, ports, servos, responses from files.
#include <fmt/format.h>

#include "ifo/dual_recycled.hpp"
#include "unit/ifo/ports_support.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

double phase(Detector const& d, std::uint32_t port, double hz = 100) {
  return std::abs(d.ifo->strain_per_phase(PortId{port}, hz));
}

TEST(ReadPorts, PresetsExcludeOtherKeys) {
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

TEST(ReadPorts, ClosedFormsHaveThemToo) {
  std::string const keys =
      "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, arm_power: 100 "
      "kW, ";
  Detector const d = detector(keys + "end_transmission: 4 ppm, ports: {bench: {at: end-bench}}");
  ASSERT_THAT(d.problems, IsEmpty());
  EXPECT_NEAR(phase(d, 1) / phase(d, 0), 4e-6, 1e-15);
  EXPECT_THAT(detector(keys + "ports: {bench: {at: end-bench}}").problems, HasSubstr("whose transmission is zero"));
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

// Light that returns at an end mirror joins there unless the table states another place: Gamma - 1/2 instead of Gamma,
// 0.6 of the radiation pressure for Cosmic Explorer 1.
TEST(ReadPorts, EndMirrorsOfTheScene) {
  std::vector<TracedPort> const ports = {{.name = "ITM"},
                                         {.name = "ETM", .injection_point = InjectionPoint::end_mirror}};
  auto const pressure = [&](std::string const& keys) {
    Detector const d = detector("preset: ce" + keys, {}, 1064e-9, ports);
    EXPECT_THAT(d.problems, IsEmpty());
    return std::abs(d.ifo->strain_per_amplitude(PortId{1}, 20));
  };
  double const found = pressure(""), inside = pressure(", ports: {ETM: {at: arm}}");
  EXPECT_EQ(found, pressure(", ports: {ETM: {at: end-mirror}}"));
  EXPECT_EQ(found, pressure(", ports: {ETM: {copies: 1}}"));
  EXPECT_NEAR(inside / found, 1.68, 0.01) << "control: as at the input mirror";
}

// Light that was followed through the end mirror has T_E in its coupling: what a bench does, over T_E (eq. 9.3, 9.4).
TEST(ReadPorts, LightFollowedThroughTheEndMirror) {
  std::vector<TracedPort> const ports = {{.name = "ITM"},
                                         {.name = "bench", .injection_point = InjectionPoint::through_end}};
  auto const response = [&](std::string const& keys) {
    Detector const d = detector("preset: ce" + keys, {}, 1064e-9, ports);
    EXPECT_THAT(d.problems, IsEmpty());
    return std::pair(std::abs(d.ifo->strain_per_phase(PortId{1}, 20)),
                     std::abs(d.ifo->strain_per_amplitude(PortId{1}, 20)));
  };
  auto const found = response(""), bench = response(", ports: {bench: {at: end-bench}}"),
             end = response(", ports: {bench: {at: end-mirror}}");
  EXPECT_NEAR(bench.first / found.first / 5e-6, 1, 1e-9);
  EXPECT_NEAR(bench.second / found.second / 5e-6, 1, 1e-9);
  EXPECT_NEAR(found.first / end.first, 1, 0.01);  // eq. 9.1
  EXPECT_NEAR(end.second / found.second, 0.75, 0.02) << "control: as at the end mirror, Gamma - 1/2 for Gamma - 1/4";
}

// Without light at its place a stray field is relative to rounding.
TEST(ReadPorts, PortsWithoutLight) {
  for (DualRecycledPreset const& p : dual_recycled_presets())
    for (char const* at : {"as-port", "signal-cavity", "symmetric-port", "recycling-cavity", "input-bench"}) {
      bool const leaks = p.parameters.dark_fringe_offset != 0;
      std::string const keys = fmt::format("preset: {}, ports: {{bench: {{at: {}}}}}", p.name, at),
                        problems = detector(keys, {}, p.parameters.wavelength).problems;
      EXPECT_EQ(problems.empty(), leaks) << p.name << " " << at;
      if (!leaks) {
        EXPECT_THAT(problems, HasSubstr("dark_fringe_offset")) << p.name << " " << at;
      }
      EXPECT_THAT(detector(keys + ", dark_fringe_offset: 1e-15 m", {}, p.parameters.wavelength).problems, IsEmpty());
    }
  Detector const d = detector("preset: et-hf, ports: {bench: {at: as-port}}");
  EXPECT_THAT(d.problems, HasSubstr("scene.yaml:2:53: error: this interferometer has no light at 'as-port'"));
  FileTexts const files = {{"phase.txt", "10 3e-12 0\n1000 0 -3e-12\n"}};
  EXPECT_THAT(detector("preset: et-hf, ports: {bench: {at: as-port}}, responses: {bench: {phase: phase.txt, columns: "
                       "[Hz, re, im], unit: strain}}",
                       files)
                  .problems,
              IsEmpty());
  EXPECT_THAT(detector("preset: adv, end_transmission: 0, ports: {bench: {at: end-bench}}").problems,
              HasSubstr("add 'end_transmission: 4.4 ppm'"));
  EXPECT_THAT(detector("preset: adv, ports: {bench: {at: end-bench, pick_off: 0}}").problems, HasSubstr("'pick_off'"));
}

// A read-out at which the slope of DARM is rounding would calibrate everything by it.
TEST(ReadPorts, ReadoutsThatAreBlind) {
  for (char const* keys : {"preset: et-hf, homodyne_angle: 0 rad", "preset: ce, homodyne_angle: 180 deg",
                           "preset: adv, dark_fringe_offset: 0 m, homodyne_angle: 0 rad"})
    EXPECT_THAT(detector(keys).problems, HasSubstr("the quadrature without DARM")) << keys;
  EXPECT_THAT(detector("preset: adv, dark_fringe_offset: 1e-22 m").problems,
              HasSubstr("with this offset no carrier light"));
  EXPECT_THAT(detector("preset: et-hf, homodyne_angle: 1 deg").problems, IsEmpty());
  EXPECT_THAT(detector("preset: et-lf, homodyne_angle: 0 rad", {}, 1550e-9).problems, IsEmpty());  // detuned
}

TEST(ReadPorts, InvalidFiles) {
  FileTexts const files = {{"short.txt", "20 1 0\n50 1 0\n"}, {"one.txt", "20 1 0\n"}};
  std::string const columns = ", columns: [Hz, re, im], unit: strain}}";
  EXPECT_THAT(detector("preset: adv, responses: {bench: {phase: short.txt" + columns, files).problems,
              HasSubstr("scene.yaml:2:58: error: 'short.txt' covers 20 Hz to 50 Hz, and the band of the noise needs "
                        "10 Hz to 100 Hz"));
  EXPECT_THAT(detector("preset: adv, frequency_servo: {file: short.txt, columns: [Hz, re, im]}", files).problems,
              HasSubstr("error: 'short.txt' covers"));
  EXPECT_THAT(detector("preset: adv, responses: {bench: {phase: one.txt" + columns, files).problems,
              HasSubstr("needs at least two frequencies"));
  std::string const missing = detector("preset: adv, responses: {bench: {phase: none.txt" + columns).problems;
  EXPECT_THAT(missing, HasSubstr("cannot read file 'none.txt'"));
  EXPECT_THAT(missing, HasSubstr("1 error"));
}

// The factor that is printed is the one of eq. 9.2, also where a detuned mirror makes it another than that of the
// field.
TEST(ReadPorts, PrintedGainIsThatOfRadiationPressure) {
  Detector const d = detector("preset: et-lf", {}, 1550e-9);
  double const unit = 8 * 18.18e3 / (speed_of_light * 211 * std::pow(2 * pi * 10, 2) * 10e3);
  EXPECT_NEAR(std::abs(d.ifo->strain_per_amplitude(PortId{0}, 10)) / unit, 80.7, 0.1);
  EXPECT_THAT(d.ifo->description(),
              HasSubstr("Gamma of eq. 9.2 80.68 and gain of a field in the arm without radiation pressure 43.78"));
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
              HasSubstr("bad.txt:1:1: error: this line has 2 numbers, not 3"));
  EXPECT_THAT(detector("preset: adv, responses: {bench: {phase: back.txt" + columns, files).problems,
              HasSubstr("back.txt:2:1: error: frequencies must be positive and rise"));
  EXPECT_THAT(detector("preset: adv, frequency_servo: 3").problems, HasSubstr("a transfer function is a table"));
}

}  // namespace
}  // namespace straytrace::testing
