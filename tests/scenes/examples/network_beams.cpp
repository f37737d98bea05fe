// SPDX-License-Identifier: BSD-3-Clause
// Beams of a scene with the power of a beam of the solved network: light behind an input mirror
// (docs/theory/recoupling.md, docs/theory/interferometer.md, eq. 6.4, 6.11, N.12).
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/program.hpp"

namespace straytrace::testing::app_network_beams {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

// A plate in short arm x of Advanced Virgo, 1 m behind the input mirror, and a receiver that sees it.
std::string const plate = R"(straytrace: 1
title: a plate behind an input mirror
materials: {face: {specular: {reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian, brdf: 1e-3 /sr}}, black: {}}
bodies: {b: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}}, others: still}}}
scene:
  - {name: face, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -1 m], facing: [0, 0, 1], body: b, material: face}
  - {name: wall, shape: {disk: {inner_radius: 30 cm, outer_radius: 1 m}}, at: [0 m, 0 m, 0 m], facing: [0, 0, -1], body: b,
     material: black}
beams: {leak: {from: [0 m, 0 m, 0 m], facing: [0, 0, -1], radius: 49 mm, network: ITMx.front.out, lit: yes}}
ports: {CP: {beam: leak, at: face}}
receivers: {PD: {on: wall}}
interferometer: {preset: adv, ports: {CP: {at: ITMx.front.in}}}
)";

Finished check(Folder const& folder, std::string const& from, std::string const& to) {
  write_text(folder / "a.yaml", edited(plate, from, to));
  return straytrace({"check", folder / "a.yaml"});
}

json traced(Folder const& folder, std::string const& scene, Words command) {
  write_text(folder / "a.yaml", scene);
  Finished const run =
      straytrace({"trace", folder / "a.yaml", "-o", folder / "run.h5", "--histories", "8192", "--quiet"});
  EXPECT_EQ(run.code, 0) << run.err;
  command.insert(command.begin() + 1, folder / "run.h5");
  command.insert(command.end(), {"--format", "json"});
  return json::parse(straytrace(command).out, nullptr, false);
}

// The arm returns r_arm^2 of what comes in; the light that its input mirror passes is four times that.
TEST(NetworkBeams, PowerBehindAnInputMirror) {
  Folder const folder;
  double const power = traced(folder, plate, {"paths", "--by", "receiver"})["beam_power_W"], arm = 667600.78,
               t1 = 0.014, te = 4.4e-6, r2 = std::sqrt(1 - te - 75e-6 * (1 - te)), r1 = std::sqrt(1 - t1),
               entering = arm * std::pow(1 - r1 * r2, 2) / t1, returned = t1 * r2 / (1 - r1 * r2) - r1;
  EXPECT_NEAR(power / (returned * returned * entering), 1, 1e-3);
  EXPECT_NEAR(t1 * arm / power, 4, 0.05) << "control: what the input mirror passes";
}

TEST(NetworkBeams, NoiseOfAPortIsRelativeToTheLightScattered) {
  Folder const folder;
  auto const h = [&](std::string const& scene) {
    return traced(folder, scene, {"noise"})["total_strain"][2]["value"].get<double>();
  };
  double const network = h(plate), stated = h(edited(plate, "network: ITMx.front.out", "power: 5 kW")),
               named = h(edited(plate, "at: ITMx.front.in", "at: short-arm"));
  EXPECT_NEAR(stated / network, 1, 1e-9);
  EXPECT_NEAR(named / network, 1, 1e-9);
  std::string const other =
      edited(edited(plate, "network: ITMx.front.out", "network: BS.3.out"), "ITMx.front.in", "BS.3.in");
  EXPECT_GT(std::fabs(h(other) / network - 1), 0.01) << "control: from the splitter";
}

TEST(NetworkBeams, Problems) {
  Folder const folder;
  struct Row {
    char const *from, *to, *reason, *remedy;
  };
  for (Row const& row :
       {Row{"network: ITMx.front.out", "network: ITMx.frnt.out", "no beam 'ITMx.frnt.out'", "'ITMx.front.out'"},
        Row{"network: ITMx", "power: 1 W, network: ITMx", "'network' and 'power' are both given", "keep one"},
        Row{"network: ITMx.front.out", "network: dark.out", "no light runs in the beam 'dark.out'", "write 'power'"},
        Row{"at: ITMx.front.in", "at: BS.3.in", "port 'CP' is not relative to it", "{at: ITMx.front.in}"},
        Row{", ports: {CP: {at: ITMx.front.in}}", "", "port 'CP' is not relative to it", "lit_by: ITMx.front.out"},
        Row{"beams: {", "beams: {first: {on: wall, radius: 1 cm, power: 1 W}, ",
            "couplings are relative to the first beam", "beam 'leak' and its ports alone"},
        Row{"preset: adv, ports: {CP: {at: ITMx.front.in}}",
            "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, "
            "arm_power: 1 kW",
            "no interferometer whose network is solved", "preset: adv"}}) {
    Finished const done = check(folder, row.from, row.to);
    EXPECT_EQ(done.code, 2) << row.reason;
    EXPECT_THAT(done.err, AllOf(HasSubstr(row.reason), HasSubstr(row.remedy)));
  }
  EXPECT_EQ(check(folder, "face, shape", "face, shape").code, 0) << "control";
}

}  // namespace
}  // namespace straytrace::testing::app_network_beams
