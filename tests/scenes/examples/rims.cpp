// SPDX-License-Identifier: BSD-3-Clause
// The key `rims`: an iris in short arm x of Advanced Virgo that moves (docs/theory/diffraction.md, eq. N.21).
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/program.hpp"

namespace straytrace::testing::app_rims {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double w = 49e-3, a = 80e-3, d = 20e-3;

std::string const iris = R"(straytrace: 1
title: an iris behind an input mirror
materials: {face: {specular: {reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian, brdf: 1e-3 /sr}}, black: {}}
bodies:
  plate: {motion: {z: {power-law: {asd: 1e-15 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}}, others: still}}
  mount: {motion: {x: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}}, others: still}}
scene:
  - {name: iris, shape: {disk: {inner_radius: 80 mm, outer_radius: 1 m}}, at: [20 mm, 0 m, -10 mm], facing: [0, 0, 1], body: mount, material: black}
  - {name: face, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -1 m], facing: [0, 0, 1], body: plate, material: face}
beams: {leak: {from: [0 m, 0 m, 0 m], facing: [0, 0, -1], radius: 49 mm, network: ITMx.front.out, lit: yes}}
ports: {CP: {beam: leak, at: face}}
rims: on
interferometer: {preset: adv, ports: {CP: {at: ITMx.front.in}}}
)";

int rows = 0;  // of kind rim, that the mount moves, in the last run

// The last row of kind rim that the mount moves; null without one.
json row_of(Folder const& folder, std::string const& scene) {
  write_text(folder / "a.yaml", scene);
  Finished const run =
      straytrace({"run", folder / "a.yaml", "-o", folder / "out", "--histories", "4096", "--quiet", "--force"});
  EXPECT_EQ(run.code, 0) << run.err;
  json const table = json::parse(straytrace({"paths", folder / "out/run.h5", "--format", "json"}).out, nullptr, false);
  json found;
  rows = 0;
  for (json const& row : table["routes"])
    if (row["kind"] == "rim" && row["moving_body"] == "mount") {
      ++rows;
      found = row;
    }
  return found;
}
double strain(json const& row) { return row["strain"][0]["value"]; }
double slope(double off) {
  return 4 * a / (w * w) * std::exp(-2 * (a * a + off * off) / (w * w)) * std::cyl_bessel_i(1, 4 * a * off / (w * w));
}

TEST(RimsKey, RowOfAMovingIris) {
  Folder const folder;
  json const row = row_of(folder, iris);
  ASSERT_TRUE(row.is_object());
  EXPECT_EQ(row["moving_body"], "mount");
  EXPECT_TRUE(row["resolved"].get<bool>());
  double const h = strain(row);
  EXPECT_GT(h, 0);
  EXPECT_NEAR(strain(row_of(folder, edited(iris, "[20 mm, 0 m", "[10 mm, 0 m"))) / h, slope(10e-3) / slope(d), 2e-3);
  EXPECT_NEAR(strain(row_of(folder, edited(iris, "x: {power-law: {asd: 1e-12", "x: {power-law: {asd: 3e-12"))) / h, 3,
              1e-9);
  EXPECT_LT(strain(row_of(folder, edited(iris, "[20 mm, 0 m", "[0 mm, 0 m"))) / h, 1e-6) << "control: centred";
  EXPECT_TRUE(row_of(folder, edited(iris, "rims: on", "rims: off")).is_null()) << "control: off";
}

// Behind an input mirror that `lit` passes: the light that leaves the arm and the light from the splitter pass one rim,
// and the response to it holds both ways, so it is one row, the same as of a beam that is stated (eq. N.21).
TEST(RimsKey, IrisInAShortArmLitThroughTheInputMirror) {
  Folder const folder;
  std::string const head = iris.substr(0, iris.find("  - {name: face"));
  std::string const arm =
      edited(edited(head, "black: {}}",
                    "black: {}, itm: {specular: {reflect: 98.6 %, transmit: 1.4 %}}, etm: {specular: {reflect: "
                    "99.99 %, transmit: 4 ppm}}}"),
             "bodies:\n", "bodies:\n  test_mass: {motion: still}\n") +
      "  - {name: ITM, shape: {cap: {curvature: 1/(1420 m), outer_radius: 17 cm}}, facing: [0, 0, 1], body: test_mass, "
      "material: itm}\n"
      "  - {name: ETM, shape: {cap: {curvature: 1/(1683 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 2999.8 m], facing: "
      "[0, 0, -1], body: test_mass, material: etm}\n"
      "  - {name: face, shape: {disk: {outer_radius: 60 cm}}, at: [0 m, 0 m, -1 m], facing: [0, 0, 1], body: plate, "
      "material: face}\n";
  std::string const lit =
      arm +
      "beams: {arm: {cavity: [ITM, ETM], power: 667.6 kW, lit: yes}}\n"
      "ports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}\nrims: on\ninterferometer: {preset: adv}\n";
  std::string const
      one =
          "a: {from: [0 m, 0 m, -1 mm], facing: [0, 0, -1], radius: 48.65 mm, wavefront_curvature: 1/(-1420 m), "
          "network: ITMx.front.out, lit: yes}",
      other =
          ", b: {from: [0 m, 0 m, -6 m], facing: [0, 0, 1], radius: 48.65 mm, wavefront_curvature: 1/(1420 m), "
          "network: BS.3.out, lit: yes}",
      rest =
          "}\nports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}\nrims: on\ninterferometer: {preset: adv}\n",
      stated = arm + "beams: {arm: {cavity: [ITM, ETM], power: 667.6 kW}, " + one;
  double const h = strain(row_of(folder, lit));
  EXPECT_GT(h, 0);
  EXPECT_NEAR(strain(row_of(folder, stated + rest)) / h, 1, 1e-3);
  EXPECT_NEAR(strain(row_of(folder, stated + other + rest)) / h, 1, 1e-3) << "not once for each beam";
  EXPECT_EQ(rows, 1);
  EXPECT_TRUE(row_of(folder, edited(lit, "[20 mm, 0 m, -10 mm], facing: [0, 0, 1], body: mount",
                                    "[20 mm, 0 m, 3001 m], facing: [0, 0, 1], body: mount"))
                  .is_null())
      << "control: behind the end mirror light does not come back";
}

// A sensor leaves the light of rims out, and says so in words of the kind that was asked; not with --quiet.
TEST(RimsKey, SensorsLeaveRimsOut) {
  Folder const folder;
  row_of(folder, iris);
  auto const said = [&](Words more) {
    Words words{"sensors", folder / "out/run.h5"};
    words.insert(words.end(), more.begin(), more.end());
    return straytrace(words).err;
  };
  EXPECT_THAT(said({}), AllOf(HasSubstr("1 route of rims left out"), Not(HasSubstr("quadrant"))));
  EXPECT_THAT(said({"--kind", "quadrant"}), Not(HasSubstr("across a quadrant"))) << "no other computed light";
  EXPECT_EQ(said({"--quiet"}), "");
  EXPECT_EQ(said({"--kind", "quadrant", "--quiet"}), "");
}

// A new motion needs no new trace; rims and rays of the mount do not interfere.
TEST(RimsKey, IsProjectedAgain) {
  Folder const folder;
  double const before = strain(row_of(folder, iris));
  write_text(folder / "motion.yaml",
             "straytrace: 1\nbodies:\n  plate: {motion: still}\n  mount: {motion: {x: {power-law: {asd: 2e-12 "
             "m/sqrt(Hz), at: 10 Hz, "
             "exponent: 0, from: 1 Hz, to: 1 kHz}}, others: still}}\n");
  json const again = json::parse(
      straytrace({"noise", folder / "out/run.h5", "--motion", folder / "motion.yaml", "--format", "json"}).out, nullptr,
      false);
  EXPECT_NEAR(again["total_strain"][0]["value"].get<double>() / (2 * before), 1, 1e-6);
}

TEST(RimsKey, ClosedFormsKnowNoAmplitudeThere) {
  Folder const folder;
  std::string scene = edited(iris, "network: ITMx.front.out", "power: 1 kW");
  scene = edited(scene, "preset: adv, ports: {CP: {at: ITMx.front.in}}",
                 "preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, "
                 "arm_power: 1 kW, ports: {CP: {at: short-arm}}");
  write_text(folder / "a.yaml", scene);
  Finished const done = straytrace({"check", folder / "a.yaml"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, AllOf(HasSubstr("a.yaml:12"), HasSubstr("main beam at port 'CP'"), HasSubstr("rims: off")));
  write_text(folder / "a.yaml", edited(scene, "rims: on", "rims: off"));
  EXPECT_EQ(straytrace({"check", folder / "a.yaml"}).code, 0) << "control: without the key";
}

}  // namespace
}  // namespace straytrace::testing::app_rims
