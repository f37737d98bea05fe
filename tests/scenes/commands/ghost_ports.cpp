// SPDX-License-Identifier: BSD-3-Clause
// Ghosts at ports: relative to what, how equal phase sensitivities add, behind which mirrors, and the messages about
// omissions.
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

#include "scenes/program.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::app_ghost_ports {
namespace {

using nlohmann::json;
using ::testing::HasSubstr, ::testing::Not;

constexpr double lambda = 1.064e-6, k = 2 * M_PI / lambda;

std::string const detector =
    "interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %,"
    " arm_power: 100 kW}\n";

json ghosts_of(std::string const& text, Words words = {}) {
  Folder const folder;
  write_text(folder / "a.yaml", "straytrace: 1\n" + text);
  words.insert(words.begin(), {"ghosts", folder / "a.yaml", "--format", "json", "--quiet"});
  Finished const done = straytrace(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return json::parse(done.out, nullptr, false).at(0);
}

// A wide beam along z: faces at the metres of their numbers. `entry` and `sensor` have the given reflectance.
std::string line(std::string const& port, double entry, double sensor, std::string const& filter = "transmit: 50 %",
                 std::string const& lit = "yes") {
  auto const face = [](char const* name, int z) {
    return "  - {name: " + std::string(name) + ", shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, " +
           std::to_string(z) + " m], facing: [0, 0, -1], body: b, material: " + name + "}\n";
  };
  auto const share = [](double r) { return std::to_string(1e6 * r) + " ppm"; };
  return "materials:\n  entry: {specular: {reflect: " + share(entry) + ", transmit: " + share(1 - entry) + "}}\n" +
         "  filter: {specular: {" + filter + "}}\n" + "  sensor: {specular: {reflect: " + share(sensor) +
         "}, scatter: {model: lambertian, brdf: 1e-4 /sr}}\nbodies: {b: {motion: still}}\nscene:\n" + face("entry", 1) +
         face("filter", 2) + face("sensor", 3) +
         "beams: {laser: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 50 mm, lit: " + lit +
         "}}\nports: {P: {beam: laser, at: " + port + "}}\n";
}
double at_port(std::string const& text) { return ghosts_of(text)["port"]["recoupled"]; }

// f_r = T^2 R of eq. 5.4, of the launched mode, for a port before the filter and behind it. Controls: over
// the light at the sensor, over its square.
TEST(GhostPorts, a_filter_is_passed_twice) {
  for (char const* port : {"entry", "filter", "sensor"}) {
    double const f = at_port(line(port, 0, 1e-6));
    EXPECT_NEAR(f / 2.5e-7, 1, 1e-3) << port;
    EXPECT_GT(std::fabs(f / 5e-7 - 1), 0.4) << "control: divided by the share at the sensor";
    EXPECT_GT(std::fabs(f / 1e-6 - 1), 0.4) << "control: divided by its square";
  }
}

// A beam that carries the share q of the main light counts with q^2, as its scattered light does (eq. 1.2).
TEST(GhostPorts, the_share_of_the_beam_counts_twice) {
  double const f = at_port(edited(line("entry", 0, 1e-6), "radius: 50 mm", "radius: 50 mm, share: 10 %"));
  EXPECT_NEAR(f / 2.5e-9, 1, 1e-3);
  EXPECT_GT(std::fabs(f / 2.5e-7 - 1), 0.5) << "control: relative to the launched beam";
}

// A ghost formed before the first surface with a port has not passed the filter.
TEST(GhostPorts, a_ghost_formed_upstream_of_the_port) {
  double const f = at_port(line("sensor", 1e-6, 0));
  EXPECT_NEAR(f / 1e-6, 1, 1e-3);
  EXPECT_GT(std::fabs(f / 4e-6 - 1), 0.5) << "control: divided by T^2 of the filter";
}

// Both at once move as one body: powers add unless the scene asks for the fields of the drawn geometry.
TEST(GhostPorts, equal_phase_sensitivities_add_in_power_or_as_fields) {
  std::string const scene = line("entry", 1e-6, 4e-6);  // two ghosts of 1e-6
  json const powers = ghosts_of(scene)["port"], fields = ghosts_of(scene + "ghosts: {sum: coherent}\n")["port"];
  EXPECT_EQ(powers["families"], 1);
  EXPECT_NEAR(powers["recoupled"].get<double>() / 2e-6, 1, 1e-3);
  double const drawn = 2 + 2 * std::cos(2 * k * 2);                    // 2 m apart
  EXPECT_NEAR(fields["recoupled"].get<double>() / 1e-6, drawn, 5e-3);  // the Gouy phase of 2 m is 3e-4
  EXPECT_GT(std::fabs(drawn / 2 - 1), 0.05) << "control: the other sum";
  EXPECT_NEAR(powers["recoupled_worst_case"].get<double>() / 4e-6, 1, 1e-3);
  EXPECT_NEAR(powers["recoupled_as_drawn"].get<double>(), fields["recoupled"].get<double>(), 1e-12);
}

// Two faces on one body, of 1e-6 each: one row each, so that either can be left out, and h^2 falls to a half; 0.1 %.
// Their static phases are independent. Control: as fields they are one row, which states its parts and is not divided.
TEST(GhostPorts, each_ghost_is_a_row) {
  Folder const folder;
  std::string const scene = edited(line("entry", 1e-6, 4e-6), "motion: still",
                                   "motion: {z: {power-law: {asd: 1e-14 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 "
                                   "Hz, to: 1 kHz}}, others: still}") +
                            detector;
  auto const run = [&](std::string const& sum) {
    write_text(folder / "a.yaml", "straytrace: 1\n" + scene + "ghosts: {sum: " + sum + "}\n");
    Finished const done =
        straytrace({"run", folder / "a.yaml", "-o", folder / sum, "--histories", "131072", "--quiet"});
    EXPECT_EQ(done.code, 0) << done.err;
    return std::string(folder / (sum + "/run.h5"));
  };
  std::string const apart = run("independent"), fields = run("coherent");
  json const table = json::parse(straytrace({"paths", apart, "--format", "json"}).out);
  for (char const* face : {"entry·R", "sensor·R"}) {
    std::size_t rows = 0;
    for (json const& row : table["routes"]) {
      if (row["kind"] != "ghost" || row["sequence"].get<std::string>().find(face) == std::string::npos) continue;
      EXPECT_NEAR(row["coupling"]["value"].get<double>() / 1e-6, 1, 1e-3) << face;
      ++rows;
    }
    EXPECT_EQ(rows, 1u) << face;
  }
  json const less = json::parse(straytrace({"paths", apart, "--without", "sensor", "--format", "json"}).out);
  EXPECT_NEAR(less["without"]["strain"][0]["factor"]["value"].get<double>() / std::sqrt(0.5), 1, 1e-3);
  Finished const whole = straytrace({"paths", fields}), part = straytrace({"paths", fields, "--without", "sensor"});
  EXPECT_THAT(whole.out, HasSubstr("entry·R and 1 more"));
  EXPECT_THAT(whole.out,
              HasSubstr("  entry·T > filter·T > sensor·R > filter·T > entry·T: 1e-06 computed: added as a field"));
  Finished const via = straytrace({"paths", fields, "--where", "via(\"sensor\") and kind(\"ghost\")"});
  EXPECT_THAT(via.out, HasSubstr("entry·R and 1 more"));  // whose strongest ghost does not meet it
  EXPECT_EQ(part.code, 2) << "control";
  EXPECT_THAT(part.err, HasSubstr("cannot be divided"));
}

// Faces on bodies of their own: the second moves half as far as the first, on one motion. Weak motion: h^2 goes with
// |E_1 + E_2/2|^2 (eq. 10.5), through the run file and again without tracing. Control: powers added.
TEST(GhostPorts, unequal_phase_sensitivities_add_as_fields_in_a_run) {
  Folder const folder;
  std::string const ground =
      "{z: {power-law: {asd: 1e-14 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}}, ";
  std::string scene = edited(line("entry", 1e-6, 4e-6), "bodies: {b: {motion: still}}",
                             "bodies:\n  b: {motion: " + ground +
                                 "others: still}}\n  half: {motion: {z: {from: b, "
                                 "scale: 0.5}, others: still}}");
  scene = edited(scene, "body: b, material: sensor", "body: half, material: sensor") + detector;
  auto const strain = [&](std::string const& sum) {
    write_text(folder / "a.yaml", "straytrace: 1\n" + scene + "ghosts: {sum: " + sum + "}\n");
    std::string const run = folder / (sum + ".h5");
    Finished const traced = straytrace({"trace", folder / "a.yaml", "-o", run, "--histories", "131072", "--quiet"});
    EXPECT_EQ(traced.code, 0) << traced.err;
    json const noise = json::parse(straytrace({"noise", run, "--format", "json", "--quiet"}).out);
    json const listed = json::parse(straytrace({"ghosts", folder / "a.yaml", "--format", "json", "--quiet"}).out);
    double const h = noise["total_strain"][2]["value"];
    EXPECT_NEAR(listed[0]["strain"]["100"].get<double>() / h, 1, 1e-3) << sum;
    return h;
  };
  double const ratio = strain("coherent") / strain("independent"), phase = 2 * k * 2;  // 2 m apart
  EXPECT_NEAR(ratio, std::sqrt((1.25 + std::cos(phase)) / 1.25), 3e-3);
  EXPECT_GT(std::fabs(ratio - 1), 0.03) << "control: powers added";
  Finished const table = straytrace({"paths", folder / "coherent.h5"});
  EXPECT_THAT(table.out, HasSubstr(" and 1 more"));
  EXPECT_THAT(table.out, HasSubstr("coherent family: 2 ghosts of 2 different phase sensitivities"));
  Finished const in_time = straytrace({"project", folder / "coherent.h5", "--duration", "4s", "--format", "json"});
  ASSERT_EQ(in_time.code, 0) << in_time.err;
  EXPECT_EQ(json::parse(in_time.out)["fields"], 4);  // two ghosts, two arms; both polarisations are one field
}

// More phase sensitivities than can be added as fields: the strongest are, and a warning names the rest.
TEST(GhostPorts, a_family_that_is_too_large_is_a_warning) {
  Folder const folder;
  std::string text =
                  "straytrace: 1\nmaterials: {face: {specular: {reflect: 1 ppm, transmit: 99.9 %}, scatter: {model: "
                  "lambertian, brdf: 1e-6 /sr}}}\nscene:\n",
              bodies = "bodies:\n";
  for (int i = 1; i <= 70; ++i) {
    std::string const n = std::to_string(i);
    bodies += "  b" + n + ": {motion: still}\n";
    text += "  - {name: f" + n + ", shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, " + n +
            " m], facing: [0, 0, -1], body: b" + n + ", material: face}\n";
  }
  text += bodies +
          "beams: {laser: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 50 mm, lit: yes}}\n"
          "ports: {P: {beam: laser, at: f1}}\nghosts: {sum: coherent, order: 1}\n" +
          detector;
  write_text(folder / "a.yaml", text);
  std::string const said =
      "70 different phase sensitivities: the fields of the strongest 64 add; the others, 0.08 of the light, add";
  EXPECT_THAT(straytrace({"ghosts", folder / "a.yaml"}).err, HasSubstr("beam 'laser': " + said));
  Finished const traced = straytrace({"trace", folder / "a.yaml", "-o", folder / "run.h5", "--histories", "4096"});
  EXPECT_THAT(traced.err, HasSubstr("ghosts of the beam 'laser': " + said));
}

// A way and its reverse are two ghosts of one phase: 4 f, whatever the phases of others (eq. 1.5).
TEST(GhostPorts, a_path_and_its_reverse_add_as_fields) {
  double const r = 1e-2;  // three equal faces: z1 z2 z3 and back; the pair entry-sensor in both orders
  json const all =
      ghosts_of(line("entry", r, r, "reflect: 1 %, transmit: 99 %"), {"--show", "500", "--floor", "1e-12"});
  double twice = 0, once = 0, expected = 0;
  std::map<Words, json> found;
  for (json const& g : all["ghosts"]) {
    if (g["recoupled"].is_null() || !g["recoupled_against"].get<bool>()) continue;
    std::vector<std::string> steps = g["steps"], back(steps.rbegin(), steps.rend());
    double const f = g["recoupled"];
    once += f;
    (steps == back ? expected : twice) += f;
    found[steps] = g;
  }
  for (auto const& [steps, g] : found) {
    auto const reverse = found.find(Words(steps.rbegin(), steps.rend()));
    ASSERT_NE(reverse, found.end());
    EXPECT_NEAR(reverse->second["recoupled"].get<double>() / g["recoupled"].get<double>(), 1, 1e-6);
    EXPECT_NEAR(reverse->second["difference_m"].get<double>(), g["difference_m"].get<double>(), 1e-9);
  }
  EXPECT_GT(twice / once, 1e-6);
  EXPECT_NEAR(all["port"]["recoupled_powers_added"].get<double>() / (expected + 2 * twice), 1, 1e-9);
  EXPECT_GT(std::fabs((expected + 2 * twice) / once - 1), 1e-6) << "control: powers alone";
}

// An attenuator is part of the main beam, and objects behind it are lit by its share; the reflection of a coated
// mirror that transmits as little continues there.
TEST(GhostPorts, light_continues_behind_an_attenuator) {
  Folder const folder;
  auto const lit = [&](std::string const& filter) {
    write_text(folder / "a.yaml", "straytrace: 1\n" + line("sensor", 0, 0, filter) + detector);
    return straytrace({"check", folder / "a.yaml", "--format", "json", "--quiet"}).out;
  };
  for (char const* filter : {"transmit: 1 %", "transmit: 1 %, reflect: 4 %"}) {
    json const rows = json::parse(lit(filter))["lit"];
    double share = 0;
    for (json const& row : rows)
      if (row["surface"] == "sensor") share = row["power"];
    EXPECT_NEAR(share, 0.01, 1e-9) << filter;
  }
  EXPECT_THAT(lit("transmit: 1 %, reflect: 90 %"), Not(HasSubstr("\"surface\":\"sensor\"")));  // control: a mirror
}

// An arm whose input mirror passes 1.4 %, with a face behind each mirror.
std::string arm(std::string const& lit, std::string const& more = "") {
  return "materials:\n  itm: {specular: {reflect: 98.6 %, transmit: 1.4 %}}\n"
         "  etm: {specular: {reflect: 1 - 4 ppm, transmit: 4 ppm}}\n"
         "  ar: {specular: {reflect: 0.1 %, transmit: 99.8 %}, scatter: {model: lambertian, tis: 1e-5}}\n"
         "bodies: {b: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}},"
         " others: still}}, m: {motion: still}}\nscene:\n"
         "  - {name: ITM, shape: {cap: {curvature: 1/(1420 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 0 m],\n"
         "     facing: [0, 0, 1], body: m, material: itm}\n"
         "  - {name: ETM, shape: {cap: {curvature: 1/(1683 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 3 km],\n"
         "     facing: [0, 0, -1], body: m, material: etm}\n"
         "  - {name: near, shape: {disk: {outer_radius: 17 cm}}, at: [0 m, 0 m, -1 m], facing: [0, 0, 1], body: b,\n"
         "     material: ar}\n"
         "  - {name: far, shape: {cap: {curvature: 1/(1684 m), outer_radius: 30 cm}}, at: [0 m, 0 m, 3001 m],\n"
         "     facing: [0, 0, -1], body: b, material: ar}\n"
         "beams: {arm: {cavity: [ITM, ETM], power: 100 kW" +
         lit + "}}\nports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}\n" +
         "interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: "
         "1.4 %}\n" +
         more;
}

// Light through an input mirror interferes with the light of the splitter: an error with a remedy; light through an
// end mirror passes is all there is.
TEST(GhostPorts, lit_behind_an_input_mirror_is_an_error) {
  Folder const folder;
  auto const check = [&](std::string const& lit) {
    write_text(folder / "a.yaml", "straytrace: 1\n" + arm(lit));
    return straytrace({"check", folder / "a.yaml"});
  };
  Finished const rejected = check(", lit: yes");
  EXPECT_EQ(rejected.code, 2);
  EXPECT_THAT(rejected.err, HasSubstr("\"near\" is lit through 'ITM', which passes 0.014 of the light"));
  EXPECT_THAT(rejected.err, HasSubstr("'lit: {except: [\"near\"]}'"));
  EXPECT_THAT(rejected.err, HasSubstr("'lit: {behind: ITM.front}'"));
  for (char const* lit : {", lit: {except: [\"near\"]}", ", lit: {only: [far]}", ""})
    EXPECT_EQ(check(lit).code, 0) << lit;
}

// Ghosts behind it have no h, and those behind the end mirror do: with the floor and the order that a beam in free
// space takes. Return through the mirror does not count as a departure.
TEST(GhostPorts, defaults_find_ghosts_behind_an_end_mirror) {
  for (Words const& words : {Words{}, Words{"--order", "1"}}) {
    Words all{"--beam", "ETM"};
    all.insert(all.end(), words.begin(), words.end());
    json const end = ghosts_of(arm(""), all);
    EXPECT_NEAR(end["port"]["recoupled"].get<double>() / (4e-6 * 4e-6 * 1e-3), 1, 0.02);
    EXPECT_EQ(end["ghosts"].at(1)["route"], "main > far·R > out");
  }
  EXPECT_TRUE(ghosts_of(arm(""), {"--beam", "ETM", "--order", "0"})["port"]["recoupled"] == 0.0);  // negative control
  json const input = ghosts_of(arm(""), {"--beam", "ITM"});
  EXPECT_FALSE(input.contains("port"));
  EXPECT_THAT(input["notes"].dump(), HasSubstr("Light from the splitter interferes behind 'ITM'"));
  Folder const folder;
  write_text(folder / "a.yaml", "straytrace: 1\n" + arm("", "ghosts: {}\n"));
  EXPECT_THAT(straytrace({"check", folder / "a.yaml"}).err,
              HasSubstr("ghosts behind 'ITM' are not counted: light from the splitter interferes there"));
}

// The alternative: a separate beam, as it leaves the input mirror, with a port in the short arm. h = (lambda/4 pi L)
// (pi/2F) |1 + i f/f_cav| sqrt(f_sc) 2 k x for two arms and the mean over phases (eq. 9.5), f_sc = beta lambda^2/(pi
// w^2). Control: what the mirror passes, in the arm (eq. 9.3 with the transmission of the input mirror).
TEST(GhostPorts, a_separate_beam_in_the_short_arm_eq_9_5) {
  Folder const folder;
  write_text(
      folder / "a.yaml",
      "straytrace: 1\nmaterials: {face: {specular: {reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian,"
      " brdf: 1e-3 /sr}}}\nbodies: {b: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: 0,"
      " from: 1 Hz, to: 1 kHz}}, others: still}}}\nscene:\n"
      "  - {name: face, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -1 m], facing: [0, 0, 1], body: b,"
      " material: face}\n"
      "beams: {leak: {from: [0 m, 0 m, 0 m], facing: [0, 0, -1], radius: 49 mm, power: 1 kW, lit: yes}}\n"
      "ports: {CP: {beam: leak, at: face}}\n"
      "interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, round_trip_loss: 0,"
      " input_transmission: 1.4 %, arm_power: 300 kW, ports: {CP: {at: short-arm}}}\n");
  double const r1 = std::sqrt(1 - 0.014), finesse = M_PI * std::sqrt(r1) / (1 - r1),
               pole = 299792458.0 / (4 * 3000 * finesse), arm = lambda / (4 * M_PI * 3000) * 2 * k * 1e-12,
               response = arm * M_PI / (2 * finesse) * std::hypot(1, 100 / pole);
  json const ghost =
      json::parse(straytrace({"ghosts", folder / "a.yaml", "--format", "json", "--quiet"}).out)[0]["ghosts"][1];
  EXPECT_NEAR(ghost["strain"]["100"].get<double>() / (response * 1e-3), 1, 0.01);
  Finished const traced =
      straytrace({"trace", folder / "a.yaml", "-o", folder / "run.h5", "--histories", "262144", "--quiet"});
  ASSERT_EQ(traced.code, 0) << traced.err;
  json const run = json::parse(straytrace({"noise", folder / "run.h5", "--format", "json", "--quiet"}).out);
  double const f_sc = 1e-3 * lambda * lambda / (M_PI * 0.049 * 0.049), h = run["total_strain"][2]["value"];
  EXPECT_NEAR(h / (response * std::sqrt(f_sc)), 1, 0.01);
  EXPECT_GT(arm * 0.014 * std::sqrt(f_sc) / h, 1.8) << "control: 1.4 % into the arm";
  double const slow = run["total_strain"][0]["value"];
  EXPECT_NEAR(arm * 0.014 * std::sqrt(f_sc) / slow, 4, 0.1);  // far below the pole: 4, T_1 against T_1/4
}

// Ghosts that may be below the floor, and edges that cut the main beam, are reported on stderr and in the text.
TEST(GhostPorts, warnings_of_the_floor_and_of_rims) {
  Folder const folder;
  auto const told = [&](std::string const& text, Words words) {
    write_text(folder / "a.yaml", "straytrace: 1\n" + text);
    words.insert(words.begin(), {"ghosts", folder / "a.yaml"});
    return straytrace(words);
  };
  Finished const deep = told(line("entry", 0, 1e-6), {}), high = told(line("entry", 0, 1e-6), {"--floor", "1e-3"});
  EXPECT_THAT(deep.err, Not(HasSubstr("below the floor")));
  EXPECT_THAT(high.err, HasSubstr("below the floor could recouple, more than the 0 found: lower 'floor'"));
  EXPECT_THAT(high.out, HasSubstr("below the floor could recouple"));
  std::string const wide = edited(line("entry", 0, 1e-6), "radius: 50 mm", "radius: 2 m");
  EXPECT_THAT(told(wide, {}).err,
              HasSubstr("0.61 of the light of 'laser' falls beside 'entry'"));  // exp(-2/4), eq. 5.5
  EXPECT_THAT(deep.err, Not(HasSubstr("falls beside")));
}

}  // namespace
}  // namespace straytrace::testing::app_ghost_ports
