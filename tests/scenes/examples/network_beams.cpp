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
using ::testing::Not;

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

// An arm of Advanced Virgo, and 1 m behind the input mirror a plate that scatters to both sides.
std::string arm(std::string const& lit, std::string const& more = "") {
  return "straytrace: 1\nmaterials:\n  itm: {specular: {reflect: 98.6 %, transmit: 1.4 %}}\n"
         "  etm: {specular: {reflect: 99.99 %, transmit: 4 ppm}}\n"
         "  ar: {specular: {reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian, brdf: 1e-3 /sr}}\n"
         "bodies: {m: {motion: still}, b: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: 0, "
         "from: 1 Hz, to: 1 kHz}},"
         " others: still}}}\nscene:\n"
         "  - {name: ITM, shape: {cap: {curvature: 1/(1420 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 0 m],\n"
         "     facing: [0, 0, 1], body: m, material: itm}\n"
         "  - {name: ETM, shape: {cap: {curvature: 1/(1683 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 2999.8 m],\n"
         "     facing: [0, 0, -1], body: m, material: etm}\n"
         "  - {name: face, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -1 m], facing: [0, 0, 1], body: b,\n"
         "     material: ar}\n"
         "beams: {arm: {cavity: [ITM, ETM], power: 667.6 kW" +
         lit + "}}\nports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}\n" +
         "interferometer: {preset: adv}\n" + more;
}

Finished check(Folder const& folder, std::string const& from, std::string const& to) {
  write_text(folder / "a.yaml", edited(plate, from, to));
  return straytrace({"check", folder / "a.yaml"});
}

json traced(Folder const& folder, std::string const& scene, Words command, std::string const& histories = "8192") {
  write_text(folder / "a.yaml", scene);
  Finished const run =
      straytrace({"trace", folder / "a.yaml", "-o", folder / "run.h5", "--histories", histories, "--quiet", "--force"});
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
        Row{"preset: adv, ports: {CP: {at: ITMx.front.in}}",
            "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, "
            "arm_power: 1 kW",
            "no interferometer whose network is solved", "preset: adv"}}) {
    Finished const done = check(folder, row.from, row.to);
    EXPECT_EQ(done.code, 2) << row.reason;
    EXPECT_THAT(done.err, AllOf(HasSubstr(row.reason), HasSubstr(row.remedy)));
  }
  EXPECT_EQ(check(folder, "face, shape", "face, shape").code, 0) << "control";
  write_text(folder / "a.yaml", arm(", lit: {behind: ITMx.frnt}"));
  Finished const behind = straytrace({"check", folder / "a.yaml"});
  EXPECT_EQ(behind.code, 2);
  EXPECT_THAT(behind.err, AllOf(HasSubstr("no port 'ITMx.frnt' with a space"), HasSubstr("'ITMx.front'")));
}

// Couplings refer to the first beam, s to the light that is scattered (eq. 4.9): another beam before it changes
// nothing.
TEST(NetworkBeams, BeamsOfOtherPowersInOneScene) {
  Folder const folder;
  auto const h = [&](std::string const& scene) {
    return traced(folder, scene, {"noise"})["total_strain"][2]["value"].get<double>();
  };
  std::string const bare = edited(plate, ", ports: {CP: {at: ITMx.front.in}}", ""),
                    two = edited(bare, "beams: {", "beams: {first: {on: wall, radius: 1 cm, power: 1 kW, emits: no}, ");
  double const alone = h(bare);
  EXPECT_NEAR(alone / h(plate), 1, 1e-9) << "the port follows from 'network'";
  EXPECT_NEAR(h(two) / alone, 1, 1e-9);
}

json checked(Folder const& folder, std::string const& scene) {
  write_text(folder / "a.yaml", scene);
  Finished const done = straytrace({"check", folder / "a.yaml", "--format", "json"});
  EXPECT_EQ(done.code, 0) << done.err;
  return json::parse(done.out, nullptr, false);
}

// Behind the input mirror the plate is lit from both sides, each time with the power of the network: 4.9 kW of the
// arm, not the 9.3 kW that the mirror passes (eq. 6.4, 6.11).
TEST(NetworkBeams, LitBehindAnInputMirror) {
  Folder const folder;
  json const lit = checked(folder, arm(", lit: yes"))["lit"];
  auto const of = [&](std::string const& beam, std::string const& surface) {
    for (auto const& row : lit)
      if (row["beam"] == beam && row["surface"] == surface) return row;
    ADD_FAILURE() << beam << " on " << surface << "\n" << lit.dump(1);
    return json();
  };
  double const arm_power = 667600.78, out = of("ITMx.front.out", "face")["power"], in = of("BS.3.out", "face")["power"],
               t1 = 0.014, te = 4.4e-6, r2 = std::sqrt(1 - te - 75e-6 * (1 - te)), r1 = std::sqrt(1 - t1),
               entering = std::pow(1 - r1 * r2, 2) / t1, returned = std::pow(t1 * r2 / (1 - r1 * r2) - r1, 2);
  EXPECT_NEAR(out * 667.6e3 / arm_power / (returned * entering), 1, 1e-3);
  EXPECT_NEAR(in * 667.6e3 / arm_power / entering, 1, 1e-3);
  EXPECT_GT(t1 / out, 3.9) << "control: what the input mirror passes";
  // The mode in front of the plate is that of the arm.
  EXPECT_NEAR(
      of("ITMx.front.out", "face")["radii_m"][0].get<double>() / of("BS.3.out", "face")["radii_m"][0].get<double>(), 1,
      1e-6);
}

Finished checked_text(Folder const& folder, std::string const& scene) {
  write_text(folder / "a.yaml", scene);
  return straytrace({"check", folder / "a.yaml", "--format", "json"});
}
double lit_power(json const& lit, std::string const& beam, std::string const& surface) {
  double sum = 0;
  for (auto const& row : lit)
    if (row["beam"] == beam && row["surface"] == surface) sum += row["power"].get<double>();
  return sum;
}
std::string with_entry(std::string const& scene, std::string const& entry) {
  return edited(scene, "  - {name: face", "  - {" + entry + "}\n  - {name: face");
}

// A stated beam that starts inside its space ends at the mirror there, which sends it straight back, and lights the
// plate on the way once.
TEST(NetworkBeams, StatedBeamEndsAtTheMirror) {
  Folder const folder;
  std::string const scene = edited(arm(""), "667.6 kW}",
                                   "667.6 kW}, b: {from: [0 m, 0 m, -1.5 m], facing: [0, 0, 1], radius: 48.65 mm, "
                                   "wavefront_curvature: 1/(1420 m), network: BS.3.out, lit: yes}");
  auto const lit_once = [&](std::string const& text) {
    json const lit = checked(folder, text)["lit"];
    return lit_power(lit, "b", "face") / lit_power(lit, "b", "ITM");
  };
  EXPECT_NEAR(lit_once(scene), 1 / 0.99, 1e-6);
  EXPECT_GT(lit_once(edited(scene, "network: BS.3.out", "power: 5 kW")), 1.5) << "control: other light continues";
  std::string const oblique = with_entry(scene,
                                         "name: fold, shape: {disk: {outer_radius: 20 cm}}, at: [0 m, 0 m, -1.2 m], "
                                         "facing: [1, 0, -1], body: m, material: etm");
  EXPECT_THAT(checked_text(folder, oblique).err, HasSubstr("runs on behind the mirror 'fold'"));
  EXPECT_THAT(checked_text(folder, scene).err, Not(HasSubstr("runs on"))) << "control";
}

// Light from a splitter of glass starts on its surface, which does not cut it, however near the next surface is.
TEST(NetworkBeams, SplitterOfGlassDoesNotCutItsOwnLight) {
  Folder const folder;
  std::string const splitter = edited(
      with_entry(
          with_entry(arm(", lit: yes"),
                     "name: BS, use: plate, radius: 27.5 cm, thickness: 65 mm, medium: fused_silica, at: [0 m, 0 m, "
                     "-6 m], facing: [1, 0, 1], body: m, material: half, surfaces: {back: clear, barrel: black}"),
          "name: near, shape: {disk: {outer_radius: 9.5 cm}}, at: [0 m, 0 m, -5.9 m], facing: [0, 0, 1], body: b, "
          "material: ar"),
      "  ar:",
      "  half: {specular: {reflect: 50 %, transmit: 50 %}}\n  clear: {specular: {reflect: 0, transmit: 1}}\n  black: "
      "{}\n  ar:");
  Finished const done = checked_text(folder, splitter);
  ASSERT_EQ(done.code, 0) << done.err;
  json const lit = json::parse(done.out)["lit"];
  json const bare = checked(folder, arm(", lit: yes"))["lit"];
  EXPECT_NEAR(lit_power(lit, "BS.3.out", "near") / lit_power(bare, "BS.3.out", "face"), 1, 1e-4);
  EXPECT_THAT(done.err, Not(HasSubstr("% on 'BS")));
}

// What stops the light between two components of the network.
TEST(NetworkBeams, ObstacleInALightOfTheNetwork) {
  Folder const folder;
  std::string const dump =
      "name: dump, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -3 m], facing: [0, 0, 1], body: b, "
      "material: grey";
  auto const said = [&](std::string const& lit, std::string const& beam, std::string const& transmit) {
    Finished const done = checked_text(
        folder, edited(edited(with_entry(arm(lit), dump),
                              "  ar:", "  grey: {specular: {reflect: 0, transmit: " + transmit + "}}\n  ar:"),
                       "beams: {", "beams: {" + beam));
    EXPECT_EQ(done.code, 0) << done.err;
    return done.err;
  };
  std::string const stated =
      "a: {from: [0 m, 0 m, -1 mm], facing: [0, 0, -1], radius: 48.65 mm, network: ITMx.front.out}, ";
  for (std::string const& text : {said(", lit: yes", "", "0"), said("", stated, "0")})
    EXPECT_THAT(text, AllOf(HasSubstr("'dump' stands in the light 'ITMx.front.out' and stops 100 % of it"),
                            HasSubstr("a.yaml")));
  EXPECT_THAT(said("", stated, "20 %"), HasSubstr("stops 80 % of it"));
  EXPECT_THAT(said("", stated, "99.5 %"), Not(HasSubstr("stands in the light"))) << "control";
}

TEST(NetworkBeams, NamesOfTheNetworkAreTaken) {
  Folder const folder;
  auto const finished = [&](std::string const& text) {
    write_text(folder / "a.yaml", text);
    return straytrace({"check", folder / "a.yaml"});
  };
  for (char const* name : {"ITMx.front.in", "ITMx.front", "BS.3.out"}) {
    Finished const port = finished(edited(edited(plate, "ports: {CP: {beam", fmt::format("ports: {{{}: {{beam", name)),
                                          "ports: {CP: {at", fmt::format("ports: {{{}: {{at", name)));
    EXPECT_EQ(port.code, 2);
    EXPECT_THAT(port.err, AllOf(HasSubstr("a.yaml:10"), HasSubstr("has the name of a place of the interferometer"),
                                HasSubstr("choose another name")));
  }
  Finished const beam =
      finished(edited(edited(plate, "beams: {leak", "beams: {ITMx.front.in"), "beam: leak", "beam: ITMx.front.in"));
  EXPECT_EQ(beam.code, 2);
  EXPECT_THAT(beam.err, HasSubstr("a.yaml:9"));
  EXPECT_EQ(
      finished(edited(edited(plate, "beams: {leak", "beams: {ITMx.front.out"), "beam: leak", "beam: ITMx.front.out"))
          .code,
      0)
      << "control: the name of its own light";
}

// A ghost of one light along the other is not that light.
TEST(NetworkBeams, GhostsAreNotTheOtherLight) {
  Folder const folder;
  std::string const two = with_entry(arm(", lit: {order: 1, floor: 1e-12}"),
                                     "name: fixed, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -1.5 m], "
                                     "facing: [0, 0, 1], body: m, material: ar");
  EXPECT_THAT(checked_text(folder, two).err, Not(HasSubstr("counted twice")));
  std::string const again =
      edited(two, "beams: {", "beams: {s: {on: face, radius: 48.7 mm, travel: [0, 0, -1], power: 1 W}, ");
  EXPECT_THAT(checked_text(folder, again).err, HasSubstr("counted twice")) << "control: a light stated again";
}

// The ghost of two plates runs on along the light. In the two beams of a short arm it gives h = (lambda/4 pi L)(pi/F)
// sigma 2 k x, flat (eq. N.18), for two arms and the mean over static phases; sigma = R. Each of the two trees finds
// it, and each counts half. At 100 Hz the masses of 42 kg change 1 %.
TEST(NetworkBeams, GhostAlongTheLightOfAShortArm) {
  Folder const folder;
  auto const strain_along = [&](std::string const& scene) {
    json const noise = traced(folder, scene, {"noise"});
    double sum = 0;
    for (auto const& row : noise["routes"])
      if (std::string const port = row["port"]; port.find("lit by") != port.npos || port.find("along") != port.npos)
        sum += std::pow(row["strain"][2]["value"].get<double>(), 2);
    return std::sqrt(sum);
  };
  std::string const plates =
      edited(edited(arm(", lit: yes", "ghosts: {order: 2}\n"),
                    "reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian, brdf: 1e-3 /sr}}",
                    "reflect: 1e-4, transmit: 1 - 1e-4}}"),
             "  - {name: face",
             "  - {name: fixed, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -1.5 m], facing: [0, 0, 1], body: "
             "m, material: ar}\n"
             "  - {name: face");
  double const r1 = std::sqrt(1 - 0.014), r2 = std::sqrt(1 - 4.4e-6 - 75e-6),
               finesse = pi * std::sqrt(r1 * r2) / (1 - r1 * r2), lambda = 1.064e-6,
               expected = lambda / (4 * pi * 2999.8) * pi / finesse * 1e-4 * (4 * pi / lambda) * 1e-12;
  EXPECT_NEAR(strain_along(plates) / expected, 1, 0.015);
  // One beam alone, which the scene states: the response has both terms (eq. N.12).
  std::string const one = edited(plates, "lit: yes}",
                                 "lit: no}, a: {from: [0 m, 0 m, -1 mm], facing: [0, 0, -1], radius: 48.65 mm, "
                                 "wavefront_curvature: 1/(-1420 m), network: ITMx.front.out, lit: yes}");
  EXPECT_NEAR(strain_along(one) / expected, 1, 0.015);
}

// A plate square to the light returns that of both sides as one field (eq. N.20); FINESSE 3, m of DARM per root of its
// reflectivity and m of its motion, lengths free, heavy mirrors.
TEST(NetworkBeams, FaceLitFromBothSides) {
  Folder const folder;
  std::string const square =
      edited(edited(arm(", lit: yes", "ghosts: {order: 1}\n"),
                    "reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian, brdf: 1e-3 /sr}}",
                    "reflect: 1e-4, transmit: 1 - 1e-4}}"),
             "preset: adv", "preset: adv, mirror_mass: 1e12 kg");
  json const routes = traced(folder, square, {"paths"})["routes"];
  auto const face = std::ranges::find_if(routes, [](json const& row) {
    return row["port"] == "ITMx.front.out + BS.3.out" &&
           row["sequence"].get<std::string>().find("face·R") != std::string::npos;
  });
  ASSERT_NE(face, routes.end()) << routes.dump(1);
  double lit = 0;
  json const spots = checked(folder, square)["lit"];
  for (json const& row : spots)
    if (row["beam"] == "ITMx.front.out" && row["surface"] == "face") lit = row["power"];  // over that in the arm
  double const sigma = std::sqrt((*face)["coupling"]["value"].get<double>()) / lit;
  json const noise = traced(folder, square, {"noise"})["total_strain"];
  double const arm_length = 2999.8, motion = std::sqrt(2) * 1e-12;  // of two arms, independent
  EXPECT_NEAR(noise[0]["value"].get<double>() / (4.98484e-3 * sigma * motion / arm_length), 1, 2e-3);
  EXPECT_NEAR(noise[2]["value"].get<double>() / (4.98493e-3 * sigma * motion / arm_length), 1, 2e-3);
  // A port that the scene states is a row of its own: its powers add to those of the other side.
  json const apart =
      traced(folder, edited(square, "1e12 kg", "1e12 kg, ports: {BS.3.out: {at: BS.3.in}}"), {"noise"})["total_strain"];
  EXPECT_LT(apart[0]["value"].get<double>(), 0.75 * noise[0]["value"].get<double>()) << "control: powers of both sides";
  // The number of arms is no response: one arm has half of the power.
  json const one = traced(folder, edited(square, "1e12 kg", "1e12 kg, ports: {ITMx.front.out: {copies: 1}}"),
                          {"noise"})["total_strain"];
  EXPECT_NEAR(one[0]["value"].get<double>() / noise[0]["value"].get<double>(), std::sqrt(0.5), 1e-6);
  write_text(folder / "a.yaml", edited(square, "1e12 kg", "1e12 kg, ports: {BS.3.out: {both_sides: yes}}"));
  Finished const twice = straytrace({"check", folder / "a.yaml"});
  EXPECT_EQ(twice.code, 2);
  EXPECT_THAT(twice.err, HasSubstr("would count twice"));
}

// Light that a tube scatters from one side of the plate to the other joins the beam of the other light. Both directions
// are one coupling.
TEST(NetworkBeams, ScatterBetweenTheTwoBeams) {
  Folder const folder;
  std::string const tube = edited(
      edited(arm(", lit: yes"), "  ar:", "  tube: {scatter: {model: lambertian, tis: 50 %}}\n  ar:"), "beams: {arm",
      "  - {name: pipe, shape: {cylinder: {radius: 60 cm, from: -2 m, to: 0 m}}, side: inner, body: m, material: "
      "tube}\nbeams: {arm");
  json const routes = traced(folder, tube, {"paths"}, "32768")["routes"];
  auto const of = [&](std::string const& port) {
    for (auto const& row : routes)
      if (row["port"] == port && row["sequence"] == "face·S > pipe·S > pipe·S > face·S") return row;
    ADD_FAILURE() << port << routes.dump(1);
    return json();
  };
  json const there = of("BS.3.out lit by ITMx.front.out"), back = of("ITMx.front.out lit by BS.3.out");
  double const a = there["coupling"]["value"], b = back["coupling"]["value"],
               error = std::hypot(there["coupling"]["sigma"].get<double>(), back["coupling"]["sigma"].get<double>());
  EXPECT_LT(std::fabs(a - b), 4 * error);
  EXPECT_EQ(there["C_rev"], 0.5);
  std::string const off = tube + "trace: {reverse_routes: no}\n";  // N.12 holds the reverse all the same
  for (auto const& row : traced(folder, off, {"paths"}, "32768")["routes"]) {
    if (row["sequence"] != there["sequence"]) continue;
    bool const between = row["port"] == there["port"] || row["port"] == back["port"];
    EXPECT_EQ(row["C_rev"], between ? 0.5 : 1) << row["port"];
  }
  EXPECT_GT(of("BS.3.out")["C_rev"], 0.5) << "control: the way back into the beam it came from";
}

// Light that the input mirror scatters on the arm's side reaches the plate behind it by the tube around both, and back.
// Both directions are one coupling, and have one response (eq. N.12).
TEST(NetworkBeams, ScatterBetweenTheArmAndABeamBehindIt) {
  Folder const folder;
  std::string const tube =
      edited(edited(edited(arm(", lit: yes"), "  ar:", "  tube: {scatter: {model: lambertian, tis: 50 %}}\n  ar:"),
                    "reflect: 98.6 %, transmit: 1.4 %}",
                    "reflect: 98.5 %, transmit: 1.4 %}, scatter: {model: lambertian, tis: 1e-4}"),
             "beams: {arm",
             "  - {name: pipe, shape: {cylinder: {radius: 60 cm, from: -2 m, to: 2 m}}, body: m, material: "
             "tube}\nbeams: {arm");
  json const routes = traced(folder, tube, {"noise"}, "16384")["routes"];
  auto const of = [&](std::string const& port, std::string const& sequence) {
    for (auto const& row : routes)
      if (row["port"] == port && row["sequence"] == sequence) return row;
    ADD_FAILURE() << port << routes.dump(1);
    return json();
  };
  json const into = of("ITMx.front.out lit by ITMx.back.in", "ITM·S > pipe·S > face·S"),
             out = of("ITMx.back.in lit by ITMx.front.out", "face·S > pipe·S > ITM·S");
  for (char const* what : {"coupling", "strain"}) {
    auto const number = [&](json const& row) { return *what == 's' ? row[what][2] : row[what]; };
    double const a = number(into)["value"], b = number(out)["value"],
                 error = std::hypot(number(into)["sigma"].get<double>(), number(out)["sigma"].get<double>());
    EXPECT_LT(std::fabs(a - b), 4 * error) << what;
    EXPECT_LT(error, 0.15 * a) << what;
  }
  EXPECT_EQ(into["C_rev"], 0.5);
  // With light of the mirror in the place of that of the arm, the response would be smaller by the root of their
  // powers.
  json const both = of("BS.3.out lit by ITMx.front.out", "face·S > pipe·S > pipe·S > face·S");
  auto const per_field = [](json const& row) {
    return row["strain"][2]["value"].get<double>() / std::sqrt(row["coupling"]["value"].get<double>());
  };
  EXPECT_GT(per_field(into) / per_field(both), 2) << "control: the response of the beams behind";
}

}  // namespace
}  // namespace straytrace::testing::app_network_beams
