// SPDX-License-Identifier: BSD-3-Clause
// straytrace ifo from the command line: the examples, all forms of output, wrong input.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "scenes/program.hpp"

namespace straytrace::testing::app_ifo {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string const cavity = source_folder + "/examples/ifo_cavity.yaml",
                  dual = source_folder + "/examples/ifo_dual.yaml", loops = source_folder + "/examples/ifo_loops.yaml",
                  places = source_folder + "/examples/ifo_places.yaml",
                  modes = source_folder + "/examples/ifo_modes.yaml";

json answer(Words words) {
  words.insert(words.begin(), "ifo");
  words.insert(words.end(), {"--format", "json"});
  Finished const done = straytrace(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return json::parse(done.out, nullptr, false);
}

TEST(IfoCommand, PointIsTheDefault) {
  Finished const text = straytrace({"ifo", cavity});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("ITM-ETM"), HasSubstr("137.45277"), HasSubstr("Energy balance")));
  json const found = answer({cavity});
  EXPECT_NEAR(found["readouts"][1]["value"].get<double>() / 0.4501857917, 1, 1e-9);  // case T1
  EXPECT_NEAR(found["cavities"][0]["finesse"].get<double>() / 259.519, 1, 1e-5);
  EXPECT_EQ(found["units"]["cavities"]["pole"], "Hz");
  Finished const csv = straytrace({"ifo", cavity, "--csv"});
  EXPECT_THAT(csv.out, HasSubstr("# energy\nlight,where,power [W],share\nemitted by,laser,1,1\n"));
}

// Case T2: the slope of the error signal in its best phase.
TEST(IfoCommand, ErrorsScansAndResponses) {
  json const errors = answer({cavity, "--show", "errors"})["errors"];
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_NEAR(errors[0]["slope"].get<double>() / 1.62210783e8, 1, 1e-7);
  json const scan = answer({cavity, "--show", "scan", "LENGTH", "-0.2nm", "0.2 nm", "--points", "3"})["scan"];
  EXPECT_NEAR(std::fabs(scan[2]["PDH"].get<double>()) / 0.03125225501, 1, 1e-6);
  EXPECT_NEAR(scan[0]["LENGTH"].get<double>(), -0.2e-9, 1e-24);
  json const transfer =
      answer({cavity, "--show", "transfer", "LENGTH", "PDH", "--band", "100 Hz, 1 kHz", "--points", "2"})["transfer"];
  EXPECT_NEAR(transfer[0]["magnitude"].get<double>() / std::hypot(7.8016817e7, 8.1050170e7), 1, 1e-6);
  EXPECT_LT(transfer[0]["im"].get<double>() * transfer[0]["re"].get<double>(), 0) << "exp(+iwt): it lags";
  json const sensing = answer({dual, "--show", "sensing", "--at", "10 Hz"})["sensing_10Hz"];
  EXPECT_NEAR(sensing[3]["DARM"].get<double>() / std::hypot(3.2658980e9, 1.5161194e10), 1, 1e-4);  // case T15, 42 kg
}

// Eq. N.3 against closed forms and against a scan.
TEST(IfoCommand, Slopes) {
  auto const slopes_of = [](std::string const& readout) {
    std::map<std::string, json> rows;
    json const all = answer({cavity, "--show", "slopes", readout});
    for (json const& row : all["slopes"]) rows[row["parameter"]] = row;
    return rows;
  };
  std::map<std::string, json> slope = slopes_of("transmitted");
  double const watts = answer({cavity})["readouts"][0]["value"].get<double>();
  EXPECT_NEAR(slope["laser.power"]["slope"].get<double>() / watts, 1, 1e-9);
  EXPECT_EQ(slope["laser.power"]["slope_unit"], "W/W");
  // P is proportional to J_0(m)^2: d ln P/dm = -2 J_1/J_0 at m = 0.1; its sidebands add 1e-4.
  EXPECT_NEAR(slope["EOM.index"]["slope"].get<double>() / watts, -2 * 0.0499375260 / 0.9975015620, 3e-4);
  // At resonance, r_1 and r_2 without other loss: P = J_0^2 T_1 T_2/(1 - r_1 r_2)^2.
  double const t1 = 0.02, t2 = 0.004, r1 = std::sqrt(1 - t1), r2 = std::sqrt(1 - t2);
  EXPECT_NEAR(slope["ITM.transmission"]["slope"].get<double>() / watts, 1 / t1 - r2 / (r1 * (1 - r1 * r2)), 5e-3);
  EXPECT_NEAR(slope["ETM.transmission"]["slope"].get<double>() / watts, 1 / t2 - r1 / (r2 * (1 - r1 * r2)), 1e-2);
  EXPECT_GT(std::fabs(slope["ETM.transmission"]["slope"].get<double>() / watts - 1 / t2), 50) << "control: no build-up";
  EXPECT_TRUE(slope["LENGTH"]["slope"].is_null()) << "at the top of the resonance";
  EXPECT_FALSE(slope.contains("EOM.frequency"));
  // Off resonance, against a step.
  json const scan = answer({cavity, "--show", "scan", "LENGTH", "-0.1 pm", "0.1 pm", "--points", "3"})["scan"];
  slope = slopes_of("PDH");
  double const stepped = (scan[2]["PDH"].get<double>() - scan[0]["PDH"].get<double>()) / 0.2e-12;
  EXPECT_NEAR(slope["LENGTH"]["slope"].get<double>() / stepped, 1, 1e-5);
  EXPECT_NEAR(slope["ETM.tuning"]["slope"].get<double>() / slope["ETM.displacement"]["slope"].get<double>(),
              1064e-9 / (2 * M_PI), 1e-15);
  Finished const wrong = straytrace({"ifo", cavity, "--show", "slopes", "PDHH"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("no read-out 'PDHH'"), HasSubstr("did you mean 'PDH'")));
  // In modes the curvatures of the mirrors count too.
  json const curved = answer({modes, "--show", "slopes", "transmitted"})["slopes"];
  EXPECT_TRUE(std::ranges::any_of(curved, [](json const& r) { return r["parameter"] == "ETM.curvature"; }));
}

// Cases T21 and T23: one row per entrance and read-out; the gain of eq. N.19; curves of one entrance.
TEST(IfoCommand, StrayLight) {
  json const rows = answer({places, "--show", "stray"})["stray_10Hz"];
  auto const row = [&](std::string const& entrance, std::string const& readout) {
    for (json const& r : rows)
      if (r["entrance"] == entrance && r["readout"] == readout) return r;
    return json();
  };
  double const arm = row("arm", "h")["gain"], baffle = row("baffle", "h")["gain"], end = row("end-mirror", "h")["gain"];
  EXPECT_NEAR(arm - baffle, 0.25, 1e-2);
  EXPECT_NEAR(arm - end, 0.5, 1e-2) << "control: another recoil";
  EXPECT_EQ(row("baffle", "AS")["unit"], "W");
  EXPECT_TRUE(row("window", "AS")["gain"].is_null());
  json const curve =
      answer({places, "--show", "stray", "window", "h", "--band", "100 Hz, 1 kHz", "--points", "2"})["stray"];
  EXPECT_NEAR(curve[1]["phase"].get<double>() / curve[0]["phase"].get<double>(), 1, 0.02);
  json const same = answer(
      {places, "--show", "transfer", "stray:window", "h", "--band", "100 Hz, 1 kHz", "--points", "2"})["transfer"];
  EXPECT_EQ(same, curve);
  // Light in an arm pushes its end mirror, which is free: its motion falls as 1/f^2.
  json const pushed = answer(
      {places, "--show", "transfer", "stray:arm", "ETMx", "--band", "1 kHz, 2 kHz", "--points", "2"})["transfer"];
  EXPECT_GT(pushed[0]["amplitude"].get<double>(), 3 * pushed[1]["amplitude"].get<double>());
  EXPECT_EQ(straytrace({"ifo", places, "--show", "transfer", "stray:amr", "h"}).code, 2);
  json const all = answer({cavity, "--show", "stray", "all", "--at", "1 Hz"})["stray_1Hz"];
  EXPECT_GT(all.size(), 10u);
  json const beam = answer({cavity, "--show", "stray", "ITM.back.in"})["stray_10Hz"];
  EXPECT_EQ(beam[0]["relative_to"], "ITM.back.out");
}

// Eq. N.6 to N.10; the Gouy phase of a cavity of two mirrors is 2 acos(-sqrt(g1 g2)).
TEST(IfoCommand, Modes) {
  json const found = answer({modes, "--show", "modes"});
  double const g = std::sqrt((1 - 3000 / 1420.0) * (1 - 3000 / 1683.0));
  EXPECT_NEAR(found["resonances"][0]["gouy_x"].get<double>(), 2 * std::acos(-g), 1e-9);
  EXPECT_EQ(found["resonances"][0]["basis"], "basis");
  EXPECT_EQ(found["truncation"][0]["verdict"], "converged");
  EXPECT_GT(found["mismatch"].size(), 0u);
  double sum = 0;
  for (int order = 0; order <= 4; ++order) sum += found["content"][4]["order_" + std::to_string(order)].get<double>();
  EXPECT_NEAR(sum, 1, 1e-12);
  json const point = answer({modes})["ports"];
  EXPECT_LT(point[4]["fundamental"].get<double>(), 0.999);
  EXPECT_TRUE(answer({cavity})["ports"][0]["fundamental"].is_null()) << "plane waves";
}

TEST(IfoCommand, PrintedNetworkOfModesIsAScene) {
  Folder const folder;
  Finished const printed = straytrace({"ifo", modes, "--show", "network"});
  write_text(folder / "net.yaml", printed.out);
  EXPECT_EQ(straytrace({"ifo", folder / "net.yaml", "--show", "network"}).out, printed.out);
  EXPECT_EQ(answer({modes})["ports"], answer({folder / "net.yaml"})["ports"]);
}

TEST(IfoCommand, PrintedNetworkIsAScene) {
  Folder const folder;
  Finished const printed = straytrace({"ifo", dual, "--show", "network"});
  write_text(folder / "net.yaml", printed.out);
  EXPECT_EQ(straytrace({"ifo", folder / "net.yaml", "--show", "network"}).out, printed.out);
  json const original = answer({dual})["ports"], again = answer({folder / "net.yaml"})["ports"];
  EXPECT_EQ(original, again);
  // Its named entrances too: stray light to every read-out, to the last bit. Its strain needs the held lengths.
  write_text(folder / "places.yaml", straytrace({"ifo", places, "--show", "network"}).out);
  json const named = answer({places, "--show", "stray"})["stray_10Hz"];
  json of_readouts = json::array();
  for (json const& row : named)
    if (row["readout"] != "h") of_readouts.push_back(row);
  EXPECT_GT(of_readouts.size(), 40u);
  EXPECT_EQ(answer({folder / "places.yaml", "--show", "stray"})["stray_10Hz"], of_readouts);
  EXPECT_THAT(straytrace({"check", folder / "net.yaml"}).out, HasSubstr("network of 15 components"));
}

TEST(IfoCommand, PicturesAndPage) {
  Folder const folder;
  for (Words const& show :
       std::vector<Words>{{"scan", "LENGTH", "-5nm", "5nm"},
                          {"scan", "LENGTH", "-5nm", "5nm", "laser.power", "1W", "2W", "--points", "5"},
                          {"errors"},
                          {"noise", "PDH", "--referred-to", "LENGTH", "--points", "5"}}) {
    Words words = {"ifo", cavity, "--plot", folder / "a.png", "--show"};
    words.insert(words.end(), show.begin(), show.end());
    Finished const done = straytrace(words, {.picture = true});
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(text_of(folder / "a.png").substr(1, 3), "PNG") << show[0];
    std::filesystem::remove(folder / "a.png");
  }
  Finished const page = straytrace({"ifo", loops, "--html", folder / "a.html"}, {.picture = true});
  EXPECT_EQ(page.code, 0) << page.err;
  EXPECT_THAT(text_of(folder / "a.html"),
              AllOf(HasSubstr("<svg"), HasSubstr("ETMx"), HasSubstr("by_SRCL"),
                    HasSubstr("open-loop gain |G| over frequency"), HasSubstr("suppression |1/(1 + G)| over frequency"),
                    HasSubstr("h [1/sqrt(Hz)] over frequency"), HasSubstr("<polyline")));
}

TEST(IfoCommand, NoiseAndLoops) {
  Folder const folder;
  std::string scene = text_of(cavity);
  scene +=
      "    noises: {laser.frequency: {asd: 1e-3 Hz/sqrt(Hz), exponent: -1}, ETM: {file: etm.txt, columns: [Hz, "
      "nm/sqrt(Hz)]}}\n";
  write_text(folder / "etm.txt", "1 1e-9\n1000 1e-9\n");
  write_text(folder / "noisy.yaml", scene);
  json const noise = answer({folder / "noisy.yaml", "--show", "noise", "PDH", "--referred-to", "LENGTH", "--band",
                             "100 Hz, 2 kHz", "--points", "2"})["noise"];
  EXPECT_NEAR(noise[0]["laser.frequency"].get<double>() / (3000 * 1e-3 * 1064e-9 / 299792458), 1, 1e-3);
  EXPECT_NEAR(noise[0]["ETM"].get<double>() / 1e-18, 1, 1e-9);
  EXPECT_TRUE(noise[1]["ETM"].is_null() && noise[1]["total"].is_null()) << "outside the file";
  json const found = answer({loops, "--show", "loops", "--at", "20 Hz"});
  EXPECT_EQ(found["loops_20Hz"][2]["sensor"], "POP_6");
  EXPECT_NEAR(found["loops_20Hz"][2]["gain"].get<double>(), 30 / std::hypot(1, 20), 1e-6);
  EXPECT_GT(found["stray_20Hz"][10]["total"].get<double>(), 100 * found["stray_20Hz"][10]["held"].get<double>());
}

// Eq. N.33: the best filter of one noise removes it, down to the vacuum; curves of the loops.
TEST(IfoCommand, SubtractedNoiseAndCurvesOfLoops) {
  Folder const folder;
  std::string scene = text_of(loops);
  scene.replace(scene.find("  loops:\n"), 9, "    noises: {SRM: {asd: 1e-12 m/sqrt(Hz)}}\n  loops:\n");
  write_text(folder / "as_read.yaml", scene);
  write_text(folder / "best.yaml", scene + "  subtract: [{channel: POP_56, filter: best}]\n");
  Words const of_noise = {"--show", "loops", "noise", "--band", "10 Hz, 40 Hz", "--points", "3"};
  auto const noise = [&](char const* file) {
    Words words = {folder / file};
    words.insert(words.end(), of_noise.begin(), of_noise.end());
    return answer(words)["strain_noise"];
  };
  json const before = noise("as_read.yaml"), after = noise("best.yaml");
  EXPECT_FALSE(before[1].contains("as_read"));
  EXPECT_NEAR(after[1]["as_read"].get<double>() / before[1]["total"].get<double>(), 1, 1e-9);
  EXPECT_LT(after[1]["SRM"].get<double>(), 1e-4 * before[1]["SRM"].get<double>());
  EXPECT_GT(before[1]["SRM"].get<double>(), 100 * before[1]["vacuum"].get<double>()) << "control: it counts";
  json const table = answer({folder / "best.yaml", "--show", "loops", "--at", "20 Hz"});
  EXPECT_EQ(table["filters_20Hz"][0]["kind"], "best");
  EXPECT_NEAR(table["noise_20Hz"][1]["total"].get<double>() / after[1]["SRM"].get<double>(), 1, 1e-3);
  json const curves =
      answer({loops, "--show", "loops", "suppression", "--band", "20 Hz, 40 Hz", "--points", "2"})["suppression"];
  EXPECT_NEAR(curves[0]["SRCL"].get<double>(), 1 / std::hypot(1 + 10 / 401.0, 200 / 401.0), 1e-9);
  EXPECT_EQ(straytrace({"ifo", loops, "--show", "loops", "gain"}).code, 2);
  for (char const* curve : {"suppression", "noise"}) {
    Finished const drawn =
        straytrace({"ifo", folder / "best.yaml", "--show", "loops", curve, "--points", "3", "--plot", folder / "a.png"},
                   {.picture = true});
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_EQ(text_of(folder / "a.png").substr(1, 3), "PNG") << curve;
    std::filesystem::remove(folder / "a.png");
  }
}

// A network without a preset: no length is controlled, and subtraction acts as with loops.
TEST(IfoCommand, SubtractedChannelWithoutAPreset) {
  Folder const folder;
  std::string scene = straytrace({"ifo", places, "--show", "network"}).out;
  scene += "  strain: {readout: AS, freedom: DARM, arm_length: 2999.8 m}\n";
  std::size_t const at = scene.find("    readouts:\n");
  ASSERT_NE(at, scene.npos);
  scene.insert(at, "    noises: {laser.amplitude: {asd: 1e-6 /sqrt(Hz)}}\n");
  write_text(folder / "as_read.yaml", scene);
  write_text(folder / "best.yaml", scene + "  subtract: [{channel: REFL, filter: best}]\n");
  json const before = answer({folder / "as_read.yaml", "--show", "loops", "--at", "20 Hz"}),
             after = answer({folder / "best.yaml", "--show", "loops", "--at", "20 Hz"});
  EXPECT_FALSE(before.contains("loops_20Hz"));
  EXPECT_EQ(after["filters_20Hz"][0]["channel"], "REFL");
  EXPECT_LT(after["noise_20Hz"][1]["total"].get<double>(), 0.1 * before["noise_20Hz"][1]["total"].get<double>());
  json const curve = answer({folder / "best.yaml", "--show", "loops", "noise", "--points", "3"})["strain_noise"];
  EXPECT_LT(curve[1]["total"].get<double>(), curve[1]["as_read"].get<double>());
  EXPECT_GT(after["stray_20Hz"].size(), 10u);
  // h per m of its own degree of freedom is 1/L at every frequency.
  json const darm = answer({folder / "as_read.yaml", "--show", "transfer", "DARM", "h", "--points", "3"})["transfer"];
  for (json const& row : darm) EXPECT_NEAR(row["re"].get<double>() * 2999.8, 1, 1e-9);
  json const srm = answer({folder / "as_read.yaml", "--show", "transfer", "SRM", "h", "--points", "3"})["transfer"];
  EXPECT_LT(srm[0]["magnitude"].get<double>() * 2999.8, 0.9) << "control";
}

// The light of a mismatched and tilted cavity fits into modes up to order 4, and not up to order 1.
TEST(IfoCommand, WarnsOfMissingModes) {
  EXPECT_EQ(straytrace({"ifo", modes}).err, "");
  Folder const folder;
  std::string text = text_of(modes);
  text.replace(text.find("order: 4"), 8, "order: 1");
  write_text(folder / "a.yaml", text);
  Finished const few = straytrace({"ifo", folder / "a.yaml"});
  EXPECT_EQ(few.code, 0);
  EXPECT_THAT(few.err, HasSubstr("the modes up to order 1 do not take"));
  EXPECT_EQ(straytrace({"ifo", folder / "a.yaml", "--quiet"}).err, "");
  // As all messages of this format: a list.
  json const listed = json::parse(straytrace({"ifo", folder / "a.yaml", "--format", "json"}).err, nullptr, false);
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0]["severity"], "warning");
  EXPECT_THAT(listed[0]["what"].get<std::string>(), HasSubstr("up to order 1"));
  // The answer holds them too, those of the scene first.
  EXPECT_EQ(answer({folder / "a.yaml"})["warnings"], listed);
  EXPECT_EQ(answer({modes})["warnings"], json::array());
  std::string tilted = text_of(cavity);
  tilted.replace(tilted.find("ETM: {mirror: {"), 15, "ETM: {mirror: {tilt: [1 urad, 0 rad], ");
  write_text(folder / "c.yaml", tilted);
  json const told = answer({folder / "c.yaml"})["warnings"];
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0]["what"].get<std::string>(), HasSubstr("plane waves leave out the tilt"));
  EXPECT_GT(told[0]["line"].get<int>(), 1);
}

// A scan that leaves the range of stable cavities names the end of it: for mirrors of curvatures c1, c2 in a distance
// L, (1 - L c1)(1 - L c2) = 1 at c2 = c1/(L c1 - 1).
TEST(IfoCommand, ScanIntoAnUnstableCavity) {
  Finished const far = straytrace({"ifo", modes, "--show", "scan", "ETM.curvature", "0.0006/m", "0.003/m"});
  EXPECT_EQ(far.code, 2) << far.err;
  EXPECT_THAT(far.err, AllOf(HasSubstr("no modes at 'ETM.curvature' = "), HasSubstr("ITM-ETM is unstable")));
  double const c1 = 1 / 1420.0, end = c1 / (3000 * c1 - 1);
  std::string const word = "on this side at ";
  ASSERT_NE(far.err.find(word), std::string::npos) << far.err;
  EXPECT_NEAR(std::stod(far.err.substr(far.err.find(word) + word.size())) / end, 1, 1e-5);
  EXPECT_EQ(
      straytrace({"ifo", modes, "--show", "scan", "ETM.curvature", "0.0006/m", "0.00062/m", "--points", "2"}).code, 0)
      << "control";
}

// A recycled arm as drawn: RoC 1430 m, 1420 m and 1683 m at -6 m, 6.115 m and 3005.915 m, and a splitter at 45 deg.
std::string drawn(std::string const& components, std::string const& spaces, std::string const& rest = "") {
  return "straytrace: 1\n"
         "materials: {hr: {scatter: {model: lambertian, tis: 5 ppm}}}\n"
         "bodies: {itm: {motion: {z: {peterson: high}, others: still}}, etm: {motion: still}}\n"
         "scene:\n"
         "  - {name: PR, shape: {cap: {outer_radius: 17 cm, curvature: 1/(1430 m)}}, at: [0 m, 0 m, -6 m], facing: [0, "
         "0, "
         "1], body: itm, material: hr}\n"
         "  - {name: BS, shape: {disk: {outer_radius: 20 cm}}, at: [0 m, 0 m, 0 m], facing: [0, 1, -1], body: itm, "
         "material: hr}\n"
         "  - {name: ITM, shape: {cap: {outer_radius: 17 cm, curvature: 1/(1420 m)}}, at: [0 m, 0 m, 6.115 m], facing: "
         "[0, 0, 1], body: itm, material: hr}\n"
         "  - {name: ETM, shape: {cap: {outer_radius: 17 cm, curvature: 1/(1683 m)}}, at: [0 m, 0 m, 3005.915 m], "
         "facing: "
         "[0, 0, -1], body: etm, material: hr}\n"
         "beams: {arm: {cavity: [ITM, ETM]}}\n"
         "ports: {ITM: {beam: arm, at: ITM}}\n"
         "interferometer:\n"
         "  preset: none\n"
         "  strain: {readout: REFL, arm_length: 3 km}\n"
         "  ports: {ITM: {at: ITMx.back.out}}\n"
         "  network:\n"
         "    modes: {order: 2}\n"
         "    readouts: {REFL: {power: PRM.front.out}}\n"
         "    freedoms: {DARM: {ETMx: 1}}\n"
         "    components: {laser: {laser: {power: 1 W}}, " +
         components +
         "}\n"
         "    spaces: [{from: laser, to: PRM.front, length: 0 m}, " +
         spaces + "]\n" + rest;
}
std::string const as_drawn =
    "PRM: {mirror: {transmission: 5 %, optic: PR}}, BS: {splitter: {transmission: 50 %, optic: BS}}, ITMx: {mirror: "
    "{transmission: 1.4 %, optic: ITM}}, ETMx: {mirror: {transmission: 5 ppm, displacement: 3 pm, optic: ETM}}";
std::string const drawn_spaces =
    "{from: PRM.back, to: BS.1}, {from: BS.3, to: ITMx.front, length: scene}, {from: ITMx.back, to: ETMx.front, phase: "
    "90 deg}";

TEST(IfoCommand, NetworkOfDrawnOptics) {
  Folder const folder;
  write_text(folder / "drawn.yaml", drawn(as_drawn, drawn_spaces));
  // The same in numbers: concave seen from the front is positive, and the arm is behind ITMx and in front of ETMx.
  write_text(folder / "stated.yaml",
             drawn("PRM: {mirror: {transmission: 5 %, curvature: -1/(1430 m)}}, BS: {splitter: {transmission: 50 %, "
                   "incidence: 45 deg}}, ITMx: {mirror: {transmission: 1.4 %, curvature: -1/(1420 m)}}, ETMx: {mirror: "
                   "{transmission: 5 ppm, displacement: 3 pm, curvature: 1/(1683 m)}}",
                   "{from: PRM.back, to: BS.1, length: 6 m}, {from: BS.3, to: ITMx.front, length: 6.115 m}, {from: "
                   "ITMx.back, to: ETMx.front, length: 2999.8 m, phase: 90 deg}"));
  json const found = answer({folder / "drawn.yaml"}), stated = answer({folder / "stated.yaml"});
  ASSERT_EQ(found["ports"].size(), stated["ports"].size());
  for (std::size_t i = 0; i < stated["ports"].size(); ++i)
    EXPECT_NEAR(found["ports"][i]["leaves"].get<double>(), stated["ports"][i]["leaves"].get<double>(),
                1e-9 * stated["ports"][i]["leaves"].get<double>());
  EXPECT_NEAR(found["cavities"][0]["length"].get<double>(), stated["cavities"][0]["length"].get<double>(), 1e-9);
  Finished const printed = straytrace({"ifo", folder / "drawn.yaml", "--show", "network"});
  EXPECT_THAT(printed.out, AllOf(HasSubstr("# optic ITM, body itm\n"), HasSubstr("# length as drawn\n")));
  // Stated numbers that agree are no error, others are, at their place.
  std::string both = as_drawn;
  both.replace(both.find("optic: ITM"), 10, "optic: ITM, curvature: -1/(1420 m)");
  write_text(folder / "both.yaml", drawn(both, drawn_spaces));
  EXPECT_EQ(straytrace({"ifo", folder / "both.yaml"}).code, 0);
  // A beam with a power of the network, whose end mirror leans: light of mode 10.
  std::string beam = drawn(as_drawn, drawn_spaces);
  beam.replace(beam.find("[ITM, ETM]}"), 11, "[ITM, ETM], network: ITMx.back.out}");
  EXPECT_THAT(straytrace({"check", folder / "drawn.yaml"}).err, ::testing::Not(HasSubstr("not in mode 00")))
      << "control";
  beam.replace(beam.find("optic: ETM"), 10, "optic: ETM, tilt: [0.2 urad, 0 rad]");
  write_text(folder / "beam.yaml", beam);
  Finished const checked = straytrace({"check", folder / "beam.yaml"});
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_THAT(checked.err, HasSubstr("of the weight of the beam it joins are not in mode 00"));
  // A preset: its mirrors keep all but the curvature.
  std::string preset = drawn("", "");
  preset =
      preset.substr(0, preset.find("interferometer:")) +
      "interferometer: {preset: adv, network: {modes: {order: 2, cavities: [[ITMx, ETMx], [ITMy, ETMy]]}, components: "
      "{ITMx: {mirror: {optic: ITM}}, ETMx: {mirror: {optic: ETM}}, ITMy: {mirror: {curvature: -1/(1420 m)}}, ETMy: "
      "{mirror: {curvature: 1/(1683 m)}}}}}\n";
  write_text(folder / "preset.yaml", preset);
  EXPECT_THAT(straytrace({"ifo", folder / "preset.yaml", "--show", "network", "--quiet"}).out,
              AllOf(HasSubstr("curvature: -0.0007042253521126761 /m, mass: 42 kg}}  # optic ITM"),
                    HasSubstr("curvature: 0.0005941770647653001 /m, mass: 42 kg}}  # optic ETM")));
  // The run keeps what its network needs.
  Finished const run = straytrace({"run", folder / "drawn.yaml", "-o", folder / "out", "--histories", "2000"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(straytrace({"noise", folder / "out/run.h5"}).code, 0);
}

TEST(IfoCommand, WrongDrawnOptics) {
  Folder const folder;
  auto const changed = [&](char const* from, std::string const& to) {
    std::string components = as_drawn;
    components.replace(components.find(from), std::string(from).size(), to);
    return drawn(components, drawn_spaces);
  };
  struct Row {
    std::string scene;
    char const *reason, *remedy;
  };
  for (Row const& row : std::vector<Row>{
           {changed("optic: ITM", "optic: ITM, curvature: 1/(1420 m)"),
            "a.yaml:19:", "has a curvature of -0.000704225352 /m, seen from the front of 'ITMx'"},
           {changed("optic: BS", "optic: BS, incidence: 44 deg"), "makes 45 deg with the normal of 'BS', not 44 deg",
            "remove 'incidence', or 'optic'"},
           {changed("optic: ITM", "optic: ITMM"), "the scene has no mirror 'ITMM'", "did you mean 'ITM'?"},
           {changed("optic: PR", "curvature: -1/(1430 m)"), "key 'length' (a length) is missing", "add 'length: 1 m'"},
           {changed("optic: ETM", "optic: BS"), "makes 45 deg with the normal of 'BS', not 0 deg",
            "make it a splitter"},
           {drawn(as_drawn, "{from: BS.3, to: ITMx.front}, {from: ITMx.back, to: PRM.back}"),
            "'BS' is drawn behind 'ITM' and 'PR' behind it", "exchange the sides"},
           {drawn(as_drawn, "{from: PRM.back, to: BS.1, length: 6 m}, {from: BS.2, to: laser, length: scene}"),
            "'scene' is the way between two optics, and 'laser' names none", "write the length"},
           {drawn("PRM: {mirror: {transmission: 5 %, optic: PR}}", "{from: PRM.back, to: PRM.back, length: 1 m}"),
            "which side of 'PR' is the front of 'PRM' is not known", "state 'curvature'"},
           {"straytrace: 1\ninterferometer: {preset: none, network: {components: {laser: {laser: {power: 1 W}}, M: "
            "{mirror: {transmission: 1, optic: ITM}}}, spaces: [{from: laser, to: M.front, length: 0 m}]}}\n",
            "a.yaml:2:", "the scene draws no mirror"}}) {
    write_text(folder / "a.yaml", row.scene);
    Finished const done = straytrace({"ifo", folder / "a.yaml"});
    EXPECT_EQ(done.code, 2) << row.reason << done.err;
    EXPECT_THAT(done.err, AllOf(HasSubstr(row.reason), HasSubstr(row.remedy)));
  }
}

TEST(IfoCommand, WrongInput) {
  struct Row {
    Words words;
    char const *reason, *remedy;
  };
  Folder const folder;
  write_text(folder / "closed.yaml",
             "straytrace: 1\ninterferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, "
             "input_transmission: 1.4 %, arm_power: 1 kW}\n");
  write_text(folder / "none.yaml", "straytrace: 1\nnoise: {band: [5 Hz, 10 Hz]}\n");
  write_text(
      folder / "lens.yaml",
      "straytrace: 1\ninterferometer: {preset: none, network: {components: {laser: {laser: {power: 1 W}}, L: {lens: "
      "{focal_length: 0 m}}}, spaces: [{from: laser, to: L.in, length: 0 m}]}}\n");
  write_text(folder / "list.yaml",
             "straytrace: 1\ninterferometer: {preset: none, network: {components: {laser: {laser: {power: 1 W}}, M: "
             "{mirror: {transmission: 1, curvature: [1 /m]}}}, spaces: [{from: laser, to: M.front, length: 0 m}]}}\n");
  std::string even = text_of(modes);
  even.replace(even.find("order: 4"), 8, "order: 4, parity: even");
  even.replace(even.find(", tilt: ["), even.find("]", even.find(", tilt: [")) + 1 - even.find(", tilt: ["), "");
  write_text(folder / "even.yaml", even);
  even = folder / "even.yaml";
  write_text(folder / "etm.txt", "1 1e-9 3\n1000 1e-9 3\n");
  write_text(folder / "columns.yaml",
             text_of(cavity) + "    noises: {ETM: {file: etm.txt, columns: [Hz, nm/sqrt(Hz)]}}\n");
  for (Row const& row : std::vector<Row>{
           {{cavity, "--show", "scan", "LENGTH"}, "--show scan takes 3 words, got 1", "--show scan PARAMETER FROM TO"},
           {{cavity, "--show", "scan", "LENGTH", "0 m", "1nm", "EOM.index", "0", "1", "--points", "2000"},
            "a map of 2000 by 2000 points is too large",
            "--points 1000"},
           {{modes, "--show", "scan", "ETM.tilt_x", "-0.2rad", "0.2rad"}, "'-0.2rad' is outside the range", "0.1 rad"},
           {{folder / "lens.yaml"}, "lens.yaml:2:", "a lens cannot focus within 1 um"},
           {{cavity, "--show", "scn"}, "--show cannot be 'scn'", "did you mean 'scan'?"},
           {{cavity, "--show", "scan", "ETM.tunings", "0", "1deg"}, "no parameter 'ETM.tunings'", "'ETM.tuning'"},
           {{cavity, "--show", "scan", "ETM.tuning", "1 m", "2 m"}, "'1 m' is not a value of 'ETM.tuning'", "0.1 deg"},
           {{cavity, "--show", "scan", "ETM.transmission", "0", "120 %"},
            "'120 %' is outside the range",
            "between 0 and 1"},
           {{cavity, "--show", "transfer", "X", "PDH"}, "no cause 'X'", "LENGTH, "},
           {{cavity, "--show", "transfer", "LENGTH", "PDI"}, "no read-out or mirror 'PDI'", "did you mean 'PDH'?"},
           {{cavity, "--plot", folder / "a.png"}, "--plot draws a scan, a response", "--show scan"},
           {{cavity, "--show", "noise", "PDX"}, "no read-out 'PDX'", "did you mean 'PDH'?"},
           {{cavity, "--show", "noise", "PDH", "--referred-to", "L"}, "no degree of freedom 'L'", "LENGTH"},
           {{cavity, "--referred-to", "LENGTH"}, "--referred-to has no effect on --show point", "--show noise READOUT"},
           {{cavity, "--at", "10 Hz"}, "--at has no effect on --show point", "--show sensing, loops and stray"},
           {{cavity, "--show", "errors", "--points", "3"}, "--points has no effect on --show errors", "--show scan"},
           {{cavity, "--show", "sensing", "--band", "1 Hz, 2 Hz"}, "--band has no effect", "--show transfer, noise"},
           {{places, "--show", "stray", "window", "h", "--at", "1 Hz"}, "--at has no effect", "remove it"},
           {{folder / "columns.yaml"}, "etm.txt:1:1: error: this line has 3 numbers, not 2", "two columns"},
           {{cavity, "--show", "modes"}, "solved in plane waves", "'modes: {order: 2}'"},
           {{cavity, "--show", "loops"}, "the loops and the noise of h need a strain", "'strain: {readout: AS"},
           {{even, "--show", "scan", "ETM.tilt_x", "0", "1urad"}, "'ETM.tilt_x' makes odd modes", "'parity: all'"},
           {{cavity, "--show", "scan", "ETM.tilt_x", "0", "1urad"},
            "plane waves do not depend on",
            "'modes: {order: 2}'"},
           {{folder / "list.yaml"}, "list.yaml:2:", "'[1/(1420 m), 1/(1400 m)]'"},
           {{places, "--show", "transfer", "stray:all", "h"},
            "one entrance of stray light, not of 'all'",
            "--show stray"},
           {{places, "--show", "transfer", "stray:arm", "nothing"}, "no read-out or mirror 'nothing'", "ETMy, h"},
           {{cavity, "--html", folder / "a.png"}, "does not have a known ending", "end it with .html"},
           {{cavity, "--show", "scan", "LENGTH", "0", "1nm", "LENGTH", "0", "1nm"},
            "both axes of the scan are 'LENGTH'",
            "two parameters"},
           {{places, "--show", "stray", "bafle"}, "no entrance or beam 'bafle'", "did you mean 'baffle'?"},
           {{places, "--show", "stray", "window", "BS"}, "no read-out 'BS'", "AS"},
           {{places, "--show", "stray", "all", "h"}, "too much for one curve", "name one entrance"},
           {{cavity, "--show", "stray"}, "names no entrances", "--show stray all"},
           {{cavity, "--show", "network", "--csv"}, "--show network prints a scene", "remove --csv"},
           {{folder / "closed.yaml"}, "closed forms have no network", "'preset: none'"},
           {{folder / "none.yaml"}, "no 'interferometer'", "preset: adv"}}) {
    Words words = row.words;
    words.insert(words.begin(), "ifo");
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 2) << row.reason;
    EXPECT_THAT(done.err, AllOf(HasSubstr(row.reason), HasSubstr(row.remedy)));
  }
}

}  // namespace
}  // namespace straytrace::testing::app_ifo
