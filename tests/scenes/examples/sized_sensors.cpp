// SPDX-License-Identifier: BSD-3-Clause
// `straytrace sensors` with sizes of sensors, modulated sources and light without overlap (docs/theory/time_domain.md,
// eq. N.22, N.23, N.25).
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/benches.hpp"

namespace straytrace::testing::sized_sensors {
namespace {

using ::testing::HasSubstr;

// A lamp on a shaking plate lights a photodiode, whose main light is another beam.
std::string scene(std::string const& sensors, std::string const& modulation = "{amplitude: 1 %, frequency: 40 Hz}") {
  return "straytrace: 1\n"
         "materials: {white: {scatter: {model: lambertian, tis: 5 %}}}\n"
         "bodies:\n"
         "  table: {motion: still}\n"
         "  shaker: {motion: {x: still, y: still, z: {sine: {amplitude: 1 nm peak, frequency: 10 Hz}}}}\n"
         "scene:\n"
         "  - {name: plate, shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], side: "
         "front,\n"
         "     body: shaker, material: white}\n"
         "  - {name: PD, shape: {disk: {outer_radius: 5 mm}}, at: [5 cm, 0 m, 0 m], facing: [0, 0, 1], side: front,\n"
         "     body: table, material: white}\n"
         "beams:\n"
         "  laser: {on: plate, radius: 1 mm, travel: [0, 0, 1], power: 1 W, modulation: " +
         modulation +
         "}\n"
         "  local: {on: PD, radius: 2 mm, travel: [0, 0, -1], power: 10 mW, emits: off}\n"
         "ports: {PD: {beam: local, at: PD}}\n"
         "receivers: {face: {on: PD, side: front}}\n" +
         sensors +
         "interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: "
         "1.4 "
         "%, arm_power: 100 kW}\n"
         "trace: {histories: 8192, seed: 1, order_limit: 3}\n"
         "noise: {band: [5 Hz, 500 Hz]}\n";
}

nlohmann::json table_of(Folder const& folder, std::string const& text, Words more = {}) {
  write_file(folder / "a.yaml", text);
  traced_in(folder, "a.h5", {folder / "a.yaml", "--force"});
  Words words{"sensors", folder / "a.h5", "--at", "10 Hz, 40 Hz", "--format", "json"};
  words.insert(words.end(), more.begin(), more.end());
  return nlohmann::json::parse(expect_done(words).out);
}

nlohmann::json row_of(nlohmann::json const& table, std::string const& signal) {
  for (auto const& row : table["sources"])
    if (row["signal"] == signal) return row;
  ADD_FAILURE() << "no row of " << signal;
  return {};
}

// Light of modulated amplitude makes noise although nothing moves. Control: without modulation.
TEST(SizedSensors, AmplitudeAloneIsNotStill) {
  Folder const folder;
  std::string const shaking = "z: {sine: {amplitude: 1 nm peak, frequency: 10 Hz}}",
                    modulation = ", modulation: {amplitude: 1 %, frequency: 40 Hz}";
  std::string text = scene("");
  text.replace(text.find(shaking), shaking.size(), "z: still");
  auto const printed = [&](std::string const& name) {
    write_file(folder / (name + ".yaml"), text);
    traced_in(folder, name + ".h5", {folder / (name + ".yaml"), "--force"});
    return expect_done({"noise", folder / (name + ".h5"), "--quiet"}).out;
  };
  EXPECT_THAT(printed("modulated"), ::testing::Not(HasSubstr("still")));
  text.replace(text.find(modulation), modulation.size(), "");
  EXPECT_THAT(printed("steady"), HasSubstr("still")) << "control";
}

// The beat relative to the main light rises by 1/sqrt(eta), and light without overlap by 1/eta.
TEST(SizedSensors, CutAndLightWithoutOverlapN22N23) {
  Folder const folder;
  auto const whole = table_of(folder, scene("sensors: {QPD: {port: PD, receiver: face}}\n")),
             cut = table_of(folder, scene("sensors: {QPD: {port: PD, receiver: face, radius: 1 mm, spot: 2 mm}}\n"));
  double const eta = 1 - std::exp(-2 * 0.25);
  EXPECT_EQ(whole["sensors"][0]["sensor"], "QPD");
  EXPECT_NEAR(cut["sensors"][0]["light"].get<double>() / (eta * 0.01), 1, 1e-9);
  auto const beat = [](nlohmann::json const& t) { return row_of(t, "beat")["asd_10Hz"].get<double>(); };
  EXPECT_NEAR(beat(cut) / beat(whole), 1 / std::sqrt(eta), 1e-9);
  EXPECT_GT(std::fabs(1 / std::sqrt(eta) - 1), 0.5) << "control: the formula without the cut";

  // lambda^2 beta E/P_main, the irradiance E by a laser of 1 W from 1 m, 5 cm aside; control: the share of the sensor's
  // own beam counted at its end, as in the table of couplings.
  double const beta = 0.05 / M_PI, aside = 1 / 1.0025, seen = whole["sources"][0]["coupling"].get<double>();
  double const expected = 1064e-9 * 1064e-9 * beta * beta * aside * aside / 0.01;
  EXPECT_NEAR(seen / expected, 1, 0.02);
  RunFile const run = read_run(folder / "a.h5");
  EXPECT_NEAR(route_of(run, "plate·S > PD·S").coupling.mean / (1e-4 * expected), 1, 0.02);
  auto const power = row_of(cut, "power");
  double const watts = route_of(run, "plate·S > PD·D").coupling.mean;  // of a laser of 1 W
  EXPECT_EQ(power["source"], "plate·S > PD·D");
  EXPECT_NEAR(power["power"].get<double>() / watts, 1, 1e-9);
  FrequencyGrid const grid = logarithmic_grid(5, 500, 60);
  double const width = grid.width(grid.bin_of(40)), line = 2 * 0.01 * watts / (eta * 0.01);  // peak of dP/P
  EXPECT_NEAR(power["asd_40Hz"].get<double>() / (line / std::sqrt(2 * width)), 1, 1e-6);
  EXPECT_EQ(power["asd_10Hz"].get<double>(), 0) << "the light itself does not shake";
  EXPECT_GT(cut["sensors"][0]["asd_40Hz"].get<double>(), 0.9 * power["asd_40Hz"].get<double>());
}

// The beat has the line of the amplitude too: at 40 Hz m/2 of the field against 2k 1 nm/sqrt(2) at 10 Hz, both
// over random phases (eq. N.25). Control: a phase of the laser, 0.01 rad, which the other beam does not share.
TEST(SizedSensors, BeatWithAModulatedLampN25) {
  Folder const folder;
  FrequencyGrid const grid = logarithmic_grid(5, 500, 60);
  double const widths = std::sqrt(grid.width(grid.bin_of(10)) / grid.width(grid.bin_of(40)));
  auto const ratio = [&](std::string const& modulation) {
    auto const row = row_of(table_of(folder, scene("", modulation)), "beat");
    return row["asd_40Hz"].get<double>() / row["asd_10Hz"].get<double>() / widths;
  };
  auto const table = table_of(folder, scene(""));
  double const moved = ratio("{amplitude: 1 %, frequency: 40 Hz}"),
               phase = ratio("{phase: 0.01 rad, frequency: 40 Hz}");
  double const k = 2 * M_PI / 1064e-9, angle = std::atan2(0.05, 1.0);
  EXPECT_NEAR(moved / (0.01 / (k * (1 + std::cos(angle)) * 1e-9)), 1, 0.02);  // rays of a spot of 1 mm
  EXPECT_NEAR(phase / moved, 1, 1e-3) << "half of the phase power is in Im s, half of that of the amplitude";
  EXPECT_LT(ratio("{phase: 0.01 rad, frequency: 200 Hz}"), 1e-4) << "control: a tone elsewhere";
}

TEST(SizedSensors, MistakesAreNamed) {
  Folder const folder;
  auto const error = [&](std::string const& sensors) {
    write_file(folder / "b.yaml", scene("sensors: " + sensors + "\n"));
    Finished const f = straytrace({"check", folder / "b.yaml"});
    EXPECT_EQ(f.code, 2);
    return f.err;
  };
  EXPECT_THAT(error("{A: {port: PDD}}"), HasSubstr("there is no port 'PDD'"));
  EXPECT_THAT(error("{A: {port: PD, receiver: fac}}"), HasSubstr("did you mean 'face'?"));
  EXPECT_THAT(error("{A: {port: PD, radius: 1 mm}}"), HasSubstr("spot"));
  EXPECT_THAT(error("{A: {port: PD}, B: {port: PD}}"), HasSubstr("'A' is already the sensor of port 'PD'"));
  EXPECT_THAT(error("{A: {port: PD, radius: 1 mm, spot: 1 mm, offset: 9 mm}}"), HasSubstr("falls on this sensor"));
  EXPECT_THAT(error("{A: {port: PD, size: 1 mm}}"), HasSubstr("size"));
}

}  // namespace
}  // namespace straytrace::testing::sized_sensors
