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

// The row of kind rim; null without one.
json row_of(Folder const& folder, std::string const& scene) {
  write_text(folder / "a.yaml", scene);
  Finished const run =
      straytrace({"run", folder / "a.yaml", "-o", folder / "out", "--histories", "4096", "--quiet", "--force"});
  EXPECT_EQ(run.code, 0) << run.err;
  json const table = json::parse(straytrace({"paths", folder / "out/run.h5", "--format", "json"}).out, nullptr, false);
  for (json const& row : table["routes"])
    if (row["kind"] == "rim") return row;
  return {};
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
