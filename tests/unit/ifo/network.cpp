// SPDX-License-Identifier: BSD-3-Clause
// The table `network` of an interferometer (docs/reference/network.md): what is read, and every problem.
#include <cmath>

#include "ifo/layout/read_network.hpp"
#include "unit/ifo/ports_support.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Bare {
  Scene scene;
  std::optional<NetworkModel> model;
  std::string problems;
};

Bare bare(std::string const& network, double wavelength = not_a_number) {
  Bare b{scene_of("interferometer:\n  preset: none\n  network:\n" + network), {}, {}};
  b.scene.root()["interferometer"].has("preset");
  b.model = read_bare_network(b.scene.root()["interferometer"], wavelength);
  b.scene.root()["interferometer"].refuse_unknown("interferometer 'none'");
  b.problems = problems_of(b.scene);
  return b;
}

std::string const components = R"(    components:
      laser: {laser: {power: 1 W}}
      EOM: {modulator: {frequency: 6 MHz, index: 0.1}}
      ITM: {mirror: {transmission: 2 %}}
      ETM: {mirror: {transmission: 0.4 %, tuning: 36 deg, displacement: 1 nm, mass: 42 kg}}
)",
                  spaces = R"(    spaces:
      - {from: laser, to: EOM.in, length: 0 m}
      - {from: EOM.out, to: ITM.front, length: 1 m}
      - {from: ITM.back, to: ETM.front, length: 3 km, phase: -90 deg}
)",
                  questions = R"(    readouts:
      power: {power: ETM.back.out}
      PDH: {demodulate: {at: ITM.front.out, frequency: EOM, phase: best(LENGTH)}}
      BHD: {homodyne: {at: ITM.front.out, angle: 90 deg, local: laser.out}}
    freedoms: {LENGTH: {ETM: 1}}
)",
                  cavity = components + spaces + questions;

TEST(NetworkTable, IsReadInSI) {
  Bare const b = bare("    wavelength: 1 um\n" + cavity);
  ASSERT_TRUE(b.model) << b.problems;
  Network const& n = b.model->network;
  EXPECT_EQ(n.wavelength(), 1e-6);
  EXPECT_EQ(n.polarisation(), LinearPolarisation::s);
  MirrorParameters const etm = std::get<MirrorParameters>(n.at(n.find("ETM")).stated);
  EXPECT_NEAR(etm.displacement, 1e-7 + 1e-9, 1e-20) << "36 deg are a tenth of a wavelength";
  EXPECT_EQ(etm.suspension.mass, 42);
  EXPECT_EQ(etm.transmission, 0.004);
  EXPECT_EQ(n.space_name(2), "ITM.back>ETM.front");
  EXPECT_NEAR(n.spaces()[2].phase, -pi / 2, 1e-15);
  ASSERT_EQ(b.model->readouts.size(), 3u);
  EXPECT_TRUE(b.model->readouts[0].readout.leaving);
  EXPECT_EQ(b.model->readouts[1].readout.hz, 6e6);
  EXPECT_EQ(b.model->readouts[2].readout.angle, pi / 2) << "the light of the laser has phase zero";
}

std::string const curved = R"(    components:
      laser: {laser: {power: 1 W, mode: {radius: 50 mm, wavefront_curvature: -1/(1420 m)}}}
      stop: {aperture: {radius: 1 m, offset: [1 mm, 2 mm]}}
      ITM: {mirror: {transmission: 2 %, curvature: -1/(1420 m)}}
      ETM: {mirror: {transmission: 0.4 %, curvature: 1/(1683 m), tilt: [1 urad, -2 urad]}}
    spaces:
      - {from: laser, to: stop.in, length: 0 m}
      - {from: stop.out, to: ITM.front, length: 0 m}
      - {from: ITM.back, to: ETM.front, length: 3 km, phase: -90 deg}
)";

TEST(NetworkTable, Modes) {
  Bare const b = bare("    modes: {order: 2, parity: all, cavities: [[ITM, ETM]]}\n" + curved);
  ASSERT_TRUE(b.model) << b.problems;
  Network const& n = b.model->network;
  ASSERT_TRUE(n.modes());
  EXPECT_EQ(n.modes()->order, 2);
  EXPECT_EQ(n.modes()->cavities.at(0).at(1), "ETM");
  auto const etm = std::get<MirrorParameters>(n.at(n.find("ETM")).stated);
  EXPECT_NEAR(etm.curvature, 1 / 1683.0, 1e-18);
  EXPECT_EQ(etm.tilt[1], -2e-6);
  EXPECT_EQ(std::get<ApertureParameters>(n.at(n.find("stop")).stated).offset[1], 2e-3);
  EXPECT_EQ(std::get<LaserParameters>(n.at(n.find("laser")).stated).mode->radius, 0.05);
  std::string two = curved;
  two.replace(two.find("1/(1683 m)"), 10, "[1/(1683 m), 1/(1600 m)]");
  Bare const pair = bare("    modes: {order: 2}\n" + two);
  ASSERT_TRUE(pair.model) << pair.problems;
  Network const& of_two = pair.model->network;
  EXPECT_EQ(std::get<MirrorParameters>(of_two.at(of_two.find("ETM")).stated).curvature_across, 1 / 1600.0);
  EXPECT_THAT(network_text(*pair.model), HasSubstr("curvature: [0.0005941770647653001 /m, 0.000625 /m]"));
  EXPECT_FALSE(bare("    modes: {order: 0}\n" + curved).model->network.modes()) << "plane waves";
}

TEST(NetworkTable, ModesThatCannotBe) {
  struct Row {
    std::string modes, from, to;
    char const *reason, *remedy;
  };
  for (Row const& row : std::vector<Row>{
           {"{order: 2}", "1/(1683 m)", "1/(1500 m)", "the cavity ITM-ETM is unstable: (A + D)/2", "other curvatures"},
           {"{order: 2, cavities: [[ITM, ETN]]}", "", "", "no component 'ETN'", "did you mean 'ETM'?"},
           {"{order: 2, cavities: [[ITM, stop]]}", "", "", "no cavity with ITM, stop", "it has: ITM-ETM"},
           {"{order: 17}", "", "", "'order'", "16"},
           {"{parity: all}", "", "", "'modes' has no 'order'", "'order: 0' is plane waves"},
           {"{order: 2, parity: even}", "", "", "which the tilt of 'ETM' makes", "write 'parity: all'"},
           {"{orders: 2}", "", "", "'orders'", "order"}}) {
    std::string text = curved;
    if (!row.from.empty()) text.replace(text.find(row.from), row.from.size(), row.to);
    Bare const b = bare("    modes: " + row.modes + "\n" + text);
    EXPECT_THAT(b.problems, AllOf(HasSubstr(row.reason), HasSubstr(row.remedy)));
  }
}

// Eq. N.2: the phase of the largest slope, which is positive.
TEST(NetworkTable, BestPhase) {
  Bare const b = bare(cavity);
  ASSERT_TRUE(b.model) << b.problems;
  SteadyField const field(b.model->network);
  auto const slope = [&](double turn) {
    Readout r = b.model->readout("PDH")->readout;
    r.angle += turn;
    return AdjointSlope(b.model->network, field, r).to_displacement(b.model->network.find("ETM"));
  };
  EXPECT_GT(slope(0), 0);
  EXPECT_GT(slope(0), slope(0.01));
  EXPECT_GT(slope(0), slope(-0.01));
  EXPECT_NEAR(slope(pi / 2) / slope(0), 0, 1e-9) << "control: the other quadrature";
}

TEST(NetworkTable, PrintedSceneIsTheSame) {
  Bare const first = bare(cavity);
  ASSERT_TRUE(first.model);
  std::string const text = network_text(*first.model);
  Scene const again = scene_of(text.substr(text.find('\n') + 1));
  auto const second = read_bare_network(again.root()["interferometer"], not_a_number);
  ASSERT_TRUE(second) << problems_of(again);
  EXPECT_EQ(network_text(*second), text);
  std::uint32_t const port = *find_port(first.model->network, "ETM.front");
  EXPECT_EQ(SteadyField(first.model->network).power_in(port), SteadyField(second->network).power_in(port));
}

TEST(NetworkTable, ProblemsHaveRemedies) {
  struct Row {
    std::string network;
    char const *reason, *remedy;
  };
  std::string const more = "      - {from: ETM.back, to: ITM.front, length: 1 m}\n",
                    second = "      - {from: ETM.back, to: ETM.back, length: 1 m}\n";
  for (
      Row const& row : std::vector<Row>{
          {components + spaces + more + questions, "two spaces are at 'ITM.front'", "the other leads from 'EOM.out'"},
          {components + spaces + second, "a space leads from a port to itself", "name another port"},
          {components + "    spaces: [{from: laser, to: ITM.top, length: 0 m}]\n", "no port 'ITM.top'",
           "its ports: ITM.front, ITM.back"},
          {components + "    spaces: [{from: lazer, to: ITM.front, length: 0 m}]\n", "no port 'lazer'",
           "did you mean 'laser'?"},
          {components + "    spaces: [{from: laser, to: ITM.front}]\n", "'length'", "length: "},
          {components + spaces + "    readouts: {a: {power: ITM.front}}\n", "no beam 'ITM.front'", "did you mean"},
          {components + spaces + "    readouts: {a: {}}\n", "has 0 kinds", "power, demodulate, homodyne"},
          {components + spaces +
               "    readouts: {a: {demodulate: {at: ITM.front.out, frequency: 7 MHz, phase: 0 deg}}}\n",
           "no modulator makes such sidebands", "name a modulator"},
          {components + spaces +
               "    readouts: {a: {demodulate: {at: ITM.front.out, frequency: EOM, phase: best(X)}}}\n",
           "no degree of freedom 'X'", "add it to 'freedoms'"},
          {components + spaces +
               "    readouts: {a: {demodulate: {at: EOM.out.out, frequency: EOM, phase: best(L)}}}\n"
               "    freedoms: {L: {ETM: 1}}\n",
           "'L' has no effect on this signal", "demodulate another beam"},
          {components + spaces + "    freedoms: {L: {ITM: 0, ETM: 0}}\n", "nothing moves with 'L'", "{ETM: 1}"},
          {components + spaces + "    freedoms: {L: {EOM: 1}}\n", "no mirror or splitter 'EOM'", "did you mean 'ETM'?"},
          {"    components: {laser: {laser: {power: 1 W}}, a: {mirror: {transmission: 60 %, loss: 50 %}}}\n",
           "more than all light", "at most 1 together"},
          {"    components: {laser: {laser: {power: 1 W}}, a: {mirror: {transmission: 1}, dump: {}}}\n",
           "component 'a' has 2 kinds", "one of: mirror, splitter"},
          {"    components: {laser: {laser: {power: 1 W}}, a.b: {dump: {}}}\n", "'a.b' is not a name", "letters"},
          {"    components: {laser: {laser: {power: 1 W}}, a: {modulator: {frequency: 1 MHz, index: 1, order: 2, kind: "
           "amplitude}}}\n",
           "first order only", "remove 'order'"},
          {"    components: {laser: {laser: {power: 0 W}}}\n", "no laser of the network emits light", "power: 1 W"},
          {components + spaces +
               "    readouts: {a: {homodyne: {at: ITM.front.out, angle: 0 rad, local: ITM.back.in}, b: 1}}\n",
           "unknown key 'b'", ""},
          {"    components: {laser: {laser: {power: 1 W}}, a: {dump: {}}}\n"
           "    readouts: {r: {homodyne: {at: a.in, angle: 0 rad, local: a.in}}}\n",
           "no carrier light is there", "name a beam with light"}}) {
    Bare const b = bare(row.network);
    EXPECT_FALSE(b.model) << row.reason;
    EXPECT_THAT(b.problems, AllOf(HasSubstr("scene.yaml:"), HasSubstr(row.reason), HasSubstr(row.remedy)));
  }
  EXPECT_THAT(bare(cavity).problems, IsEmpty()) << "control: nothing is wrong";
}

// One message each for a pair of one value, a file that is not there and one with a column too many.
TEST(NetworkTable, EachProblemIsToldOnce) {
  auto const told = [](std::string const& mirror, std::string const& rest) {
    return bare("    components:\n      laser: {laser: {power: 1 W}}\n      ETM: {mirror: {transmission: 1 %" + mirror +
                "}}\n" + rest)
        .problems;
  };
  EXPECT_THAT(told(", tilt: [1 urad]", ""), AllOf(HasSubstr("'tilt' needs 2 values"), HasSubstr("1 error.")));
  EXPECT_THAT(told("", "    noises: {ETM: {file: none.txt, columns: [Hz, m/sqrt(Hz)]}}\n"),
              AllOf(HasSubstr("none.txt"), HasSubstr("1 error.")));
}

// Twelve modulators of order 20 would make 41^12 carriers.
TEST(NetworkTable, CarriersAreLimited) {
  auto const with = [](int modulators, char const* of) {
    std::string text = "    components:\n      laser: {laser: {power: 1 W}}\n";
    for (int i = 0; i < modulators; ++i)
      text += "      E" + std::to_string(i) + ": {modulator: {frequency: " + std::to_string(1 + 0.01 * i) +
              " MHz, index: 0.1, order: 20, of: " + of + "}}\n";
    return bare(text + "    readouts: {a: {demodulate: {at: E0.in.in, frequency: E0, phase: 0 deg}}}\n").problems;
  };
  EXPECT_THAT(with(2, "all"), HasSubstr("make 1681 carriers"));
  EXPECT_THAT(with(12, "all"), AllOf(HasSubstr("reduce 'order', or write 'of: carrier'"), HasSubstr("1 error.")));
  EXPECT_THAT(with(8, "carrier"), IsEmpty()) << "control: 321 carriers";
}

TEST(NetworkTable, AllProblemsAtOnce) {
  Bare const b = bare(components + "    spaces:\n      - {from: lazer, to: ITM.top, length: 1 s}\n    extra: 1\n");
  EXPECT_THAT(b.problems, AllOf(HasSubstr("no port 'lazer'"), HasSubstr("no port 'ITM.top'"), HasSubstr("is a length"),
                                HasSubstr("unknown key 'extra'")));
}

TEST(NetworkTable, WavelengthOfTheBeams) {
  EXPECT_EQ(bare(cavity, 1550e-9).model->network.wavelength(), 1550e-9);
  EXPECT_THAT(bare("    wavelength: 1064 nm\n" + cavity, 1550e-9).problems,
              HasSubstr("the beams of the scene have 1550 nm"));
}

std::string const with_modulator = R"(preset: adv, network: {
  components: {EOM: {modulator: {frequency: 6 MHz, index: 0.1}}},
  spaces: [{from: laser, to: EOM.in, length: 0 m}, {from: EOM.out, to: PRM.front, length: 0 m}],
  readouts: {P: {demodulate: {at: BS.1.in, frequency: EOM, phase: best(PRCL)}}}})";

TEST(NetworkOfPreset, IsExtended) {
  Detector const d = detector(with_modulator);
  ASSERT_THAT(d.problems, IsEmpty());
  NetworkModel const& m = *d.ifo->network();
  EXPECT_EQ(m.network.carriers().size(), 3u);
  EXPECT_TRUE(m.readout("AS") && m.readout("P") && m.freedom("SRCL"));
  EXPECT_THAT(d.ifo->description(), HasSubstr("network changed by the scene"));
  Detector const plain = detector("preset: adv");
  EXPECT_EQ(plain.ifo->network()->network.carriers().size(), 1u);
  EXPECT_LT(std::abs(d.ifo->strain_per_phase(PortId{0}, 100)), infinity);
}

TEST(NetworkOfPreset, ReplacedMirrorChangesTheStrain) {
  std::vector<TracedPort> const port = {{.name = "bench", .injection_point = InjectionPoint::signal_cavity}};
  auto const strain = [&](std::string const& keys) {
    Detector const d = detector(keys, {}, 1064e-9, port);
    EXPECT_THAT(d.problems, IsEmpty());
    return std::abs(d.ifo->strain_per_phase(PortId{0}, 500));
  };
  double const stated = strain("preset: adv, signal_recycling_transmission: 40 %"), plain = strain("preset: adv"),
               replaced = strain("preset: adv, network: {components: {SRM: {mirror: {transmission: 40 %}}}}");
  EXPECT_NEAR(replaced / stated, 1, 1e-12);
  EXPECT_GT(std::fabs(stated / plain - 1), 1e-3) << "control: the mirror matters";
}

// A mirror of which only curvature and tilt are stated keeps its transmission, displacement and mass.
TEST(NetworkOfPreset, ModesAndCurvatures) {
  std::string const curvatures =
      "components: {ITMx: {mirror: {curvature: -1/(1420 m)}}, ITMy: {mirror: {curvature: -1/(1420 m)}}, "
      "ETMx: {mirror: {curvature: 1/(1683 m), tilt: [0 rad, 1 nrad]}}, ETMy: {mirror: {curvature: 1/(1683 m)}}, "
      "PRM: {mirror: {curvature: -1/(1431.5 m)}}, SRM: {mirror: {curvature: 1/(1431.5 m)}}}";
  Detector const d =
      detector("preset: adv, network: {modes: {order: 2, cavities: [[ITMx, ETMx], [ITMy, ETMy]]}, " + curvatures + "}");
  ASSERT_THAT(d.problems, IsEmpty());
  auto const etm = [](Detector const& of) {
    Network const& n = of.ifo->network()->network;
    return std::get<MirrorParameters>(n.at(n.find("ETMx")).stated);
  };
  Detector const plain = detector("preset: adv");
  EXPECT_EQ(etm(d).displacement, etm(plain).displacement);
  EXPECT_EQ(etm(d).suspension.mass, etm(plain).suspension.mass);
  EXPECT_EQ(etm(d).transmission, etm(plain).transmission);
  EXPECT_NEAR(etm(d).tilt[1], 1e-9, 1e-20);
  EXPECT_THAT(d.ifo->description(), HasSubstr("modes up to order 2 with radiation pressure"));
  EXPECT_THAT(detector("preset: adv, network: {modes: {order: 2}}").problems,
              AllOf(HasSubstr("is unstable"), HasSubstr("other curvatures")))
      << "flat mirrors";
}

TEST(NetworkOfPreset, OtherProblemsDoNotMakeItsKeyUnknown) {
  EXPECT_THAT(detector("preset: adv, arm_length: 3 kg, network: {components: {}}").problems,
              AllOf(HasSubstr("is a length"), HasSubstr("1 error.")));
}

TEST(NetworkOfPreset, Problems) {
  auto const said = [](std::string const& network) {
    Detector const d = detector("preset: adv, network: {" + network + "}", {}, 1064e-9, {});
    return d.problems + d.scene.warnings();
  };
  EXPECT_THAT(said("components: {BS: {mirror: {transmission: 1 %}}}"), HasSubstr("'BS' of the preset is a splitter"));
  EXPECT_THAT(said("components: {laser: {laser: {power: 1 W}}}"), HasSubstr("'input_power' or 'arm_power'"));
  EXPECT_THAT(said("wavelength: 1064 nm"), HasSubstr("'wavelength' is that of the preset"));
  EXPECT_THAT(said("components: {a: {lens: {focal_length: 1 m}}}, spaces: [{from: laser, to: a.in, length: 0 m}]"),
              AllOf(HasSubstr("no light reaches arm x"), HasSubstr("add a space to 'PRM.front'")));
  EXPECT_THAT(detector("preset: none, network: {components: {laser: {laser: {power: 1 W}}}}").problems,
              HasSubstr("does not say how light of the ports becomes strain"));
  EXPECT_THAT(detector("preset: none", {}, 1064e-9, {}).problems, HasSubstr("'preset: none' needs a 'network'"));
}

}  // namespace
}  // namespace straytrace::testing
