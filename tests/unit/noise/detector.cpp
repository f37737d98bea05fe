// SPDX-License-Identifier: BSD-3-Clause
// The tables `interferometer` and `noise`.
#include "ifo/fabry_perot_michelson.hpp"
#include "noise/noise.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing::noise_detector {
namespace {

using ::testing::HasSubstr;

struct Detector {
  Scene scene;
  std::unique_ptr<Interferometer> ifo;
  std::string problems;
};

Detector detector(std::string const& keys) {
  Detector d{scene_of("interferometer: {" + keys + "}\n"), {}, {}};
  d.ifo = make_interferometer(d.scene.root()["interferometer"], {{"ITM"}, {"ETM"}}, 1064e-9);
  d.problems = problems_of(d.scene);
  return d;
}

std::string const arm =
    "preset: fabry-perot-michelson, arm_length: 10 km, mirror_mass: 200 kg, input_transmission: 0.7 %, "
    "end_transmission: 5 ppm, ";

TEST(ReadInterferometer, PowerGivenOrComputed) {
  Detector const given = detector(arm + "arm_power: 3059.3 kW"),
                 computed = detector(
                     arm + "input_power: 500 W, power_recycling_transmission: 4.5 %, beam_splitter_loss: 1e-3");
  ASSERT_EQ(given.problems + computed.problems, "");
  auto const ratio = std::abs(given.ifo->strain_per_amplitude(PortId{0}, 10)) /
                     std::abs(computed.ifo->strain_per_amplitude(PortId{0}, 10));
  EXPECT_NEAR(ratio, 1, 1e-4);
  EXPECT_EQ(given.ifo->copies(PortId{0}), 2);
  EXPECT_NEAR(given.ifo->strain_per_phase(PortId{1}, 10).real() / (1064e-9 / (4 * pi * 1e4)), 1, 1e-12);
  EXPECT_THAT(given.ifo->description(), HasSubstr("eq. 9.2"));
}

TEST(ReadInterferometer, OverridesOfGainAndPole) {
  Detector const d = detector(arm + "arm_power: 3000 kW, gain: 15.7, cavity_pole: 50 Hz, arms: 1");
  ASSERT_EQ(d.problems, "");
  std::complex<double> const t = d.ifo->strain_per_amplitude(PortId{0}, 50);
  EXPECT_NEAR(std::arg(t) / (-pi / 4), 1, 1e-12);
  EXPECT_NEAR(std::abs(t) * std::sqrt(2) / (8 * 3e6 * 15.7 / (speed_of_light * 200 * std::pow(2 * pi * 50, 2) * 1e4)),
              1, 1e-12);
  EXPECT_EQ(d.ifo->copies(PortId{0}), 1);
}

TEST(ReadInterferometer, Problems) {
  EXPECT_THAT(detector(arm + "arms: 2").problems, HasSubstr("the power in the arms is missing"));
  EXPECT_THAT(detector(arm + "arm_power: 1000 kW, input_power: 1 W").problems, HasSubstr("both given"));
  EXPECT_THAT(detector(arm + "arm_power: 1000 kW, mirror_mas: 1 kg").problems,
              HasSubstr("did you mean 'mirror_mass'?"));
  EXPECT_THAT(detector("preset: fabry-perot-michelsen").problems, HasSubstr("did you mean 'fabry-perot-michelson'?"));
  EXPECT_THAT(detector(arm + "arm_power: 1000 kW, round_trip_loss: 2").problems, HasSubstr("round_trip_loss"));
}

struct Settings {
  Scene scene;
  NoiseSettings settings;
  std::vector<DesignCurve> design;
  std::string problems;
};

Settings settings(std::string const& text, FileTexts files = {}) {
  Settings s{scene_of(text, std::move(files)), {}, {}, {}};
  Node const table = s.scene.root()["noise"];
  s.settings = read_noise_settings(table);
  s.design = read_design_curves(table, s.settings);
  s.problems = problems_of(s.scene);
  return s;
}

TEST(ReadNoise, Defaults) {
  Settings const s = settings("title: none\n");
  EXPECT_EQ(s.problems, "");
  EXPECT_DOUBLE_EQ(s.settings.grid.edges.front(), 3);
  EXPECT_DOUBLE_EQ(s.settings.grid.edges.back(), 1000);
  EXPECT_EQ(s.settings.grid.size(), 151u);  // 60 log10(1000/3), rounded
  EXPECT_DOUBLE_EQ(s.settings.margin, 0.1);
  EXPECT_NEAR(s.settings.grid.centre(0), std::sqrt(3 * s.settings.grid.edges[1]), 1e-12);
}

TEST(ReadNoise, BandAndDesignCurves) {
  Settings const s =
      settings("noise: {band: [10 Hz, 100 Hz], points_per_decade: 10, margin: 1/10, compare: [adv-lal, my.txt]}\n",
               {{"my.txt", "20 1e-22\n80 1e-24\n"}});
  ASSERT_EQ(s.problems, "");
  EXPECT_EQ(s.settings.grid.size(), 10u);
  ASSERT_EQ(s.design.size(), 2u);
  EXPECT_EQ(s.design[0].name, "adv-lal");
  EXPECT_TRUE(std::isnan(s.design[1].asd[0]));
  double const f = s.settings.grid.centre(5);
  EXPECT_NEAR(s.design[1].asd[5] / (1e-22 * std::pow(f / 20, std::log(1e-2) / std::log(4))), 1, 1e-9);
}

TEST(ReadNoise, Problems) {
  EXPECT_THAT(settings("noise: {band: [100 Hz, 10 Hz]}\n").problems, HasSubstr("from a low to a higher frequency"));
  EXPECT_THAT(settings("noise: {compare: [adv-lall]}\n").problems, HasSubstr("did you mean 'adv-lal'?"));
  EXPECT_THAT(settings("noise: {compare: bad.txt}\n", {{"bad.txt", "a b"}}).problems,
              AllOf(HasSubstr("bad.txt:1:1: error: 'a' is not a number"), HasSubstr("a design curve consists of")));
  EXPECT_THAT(settings("noise: {compare: bad.txt}\n", {{"bad.txt", "10,5;1e-23\n20,5;1e-24\n"}}).problems,
              HasSubstr("decimal commas"));
  EXPECT_THAT(settings("noise: {compare: none.txt}\n", {{"none.txt", ""}}).problems, HasSubstr("no numbers in it"));
  EXPECT_THAT(settings("noise: {bnd: [1 Hz, 2 Hz]}\n").problems, HasSubstr("did you mean 'band'?"));
}

}  // namespace
}  // namespace straytrace::testing::noise_detector
