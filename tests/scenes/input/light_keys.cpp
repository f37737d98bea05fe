// SPDX-License-Identifier: BSD-3-Clause
// Wrong values of `lit`, `modulation`, `rims`, `sensors` and `static_phase`: an error with place, reason and remedy.
#include "scenes/program.hpp"

namespace straytrace::testing::light_keys {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string const plates = R"(straytrace: 1
materials: {face: {specular: {reflect: 1 ppm, transmit: 99 %}, scatter: {model: lambertian, brdf: 1e-3 /sr}}, black: {}}
bodies:
  first: {motion: {z: {sine: {amplitude: 1 nm peak, frequency: 10 Hz}}, others: still}}
  second: {motion: {z: {sine: {amplitude: 1 nm peak, frequency: 20 Hz}}, others: still}}
scene:
  - {name: window, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -50 cm], facing: [1, 0, 1], body: first, material: face}
  - {name: plate, shape: {disk: {outer_radius: 60 cm}}, at: [0 m, 0 m, -2 m], facing: [0, 0, 1], body: second, material: face}
beams: {leak: {from: [0 m, 0 m, 0 m], facing: [0, 0, -1], radius: 49 mm, network: ITMx.front.out, lit: yes}}
ports: {CP: {beam: leak, at: plate}}
interferometer: {preset: adv, ports: {CP: {at: ITMx.front.in, copies: 1}}}
rims: off
)";

struct Row {
  char const *from, *to, *at, *reason, *remedy;
  int errors = 1;
};

TEST(LightKeys, WrongValues) {
  Folder const folder;
  for (Row const& row : std::initializer_list<Row>{
           {"lit: yes", "lit: {only: []}", "a.yaml:9:", "'only' names no surface", "remove the key"},
           {"lit: yes", "lit: {except: []}", "a.yaml:9:", "'except' names no surface", "remove the key"},
           {"lit: yes", "lit: {except: {a: b}}", "a.yaml:9:", "'except' is a single text", "write 'except: text'"},
           {"lit: yes", "lit: {behind: BS.3}", "a.yaml:9:", "which this beam is not", "remove it"},
           {"lit: yes", "lit: []", "a.yaml:9:", "'lit' is a switch, got a list", "write on or off"},
           {"lit: yes", "lit: yes, modulation: []", "a.yaml:9:", "'modulation' names no modulation", "amplitude: 1 %"},
           {"rims: off", "rims: {}", "a.yaml:12:", "'rims' is a switch, got a table of keys", "write on or off"},
           {"rims: off", "sensors: {\"\": {port: CP}}", "a.yaml:12:", "a sensor has no name", "write a name"},
           {"rims: off", "sensors: {PD: }", "a.yaml:12:", "'PD' has no value", "write a value"},
           {"rims: off", "noise: {static_phase: {third: 1 deg}}", "a.yaml:12:", "there is no body 'third'",
            "first, second"},
           {"rims: off", "noise: {static_phase: {first: 1 m}}", "a.yaml:12:", "'first' is an angle",
            "write an angle"}}) {
    write_text(folder / "a.yaml", edited(plates, row.from, row.to));
    Finished const done = straytrace({"check", folder / "a.yaml"});
    EXPECT_EQ(done.code, 2) << row.to;
    EXPECT_THAT(done.err, AllOf(HasSubstr(row.at), HasSubstr(row.reason), HasSubstr(row.remedy), HasSubstr("1 error.")))
        << row.to;
  }
}

// The light that a plate scatters moves with the plate and with the mirror that leads the beam there.
TEST(LightKeys, StaticPhaseStatedTwice) {
  Folder const folder;
  std::string const folded =
      edited(edited(edited(plates, "black: {}", "fold: {specular: {reflect: 99.9 %, transmit: 0}}"),
                    "facing: [1, 0, 1], body: first, material: face", "facing: [1, 0, 1], body: first, material: fold"),
             "at: [0 m, 0 m, -2 m], facing: [0, 0, 1]", "at: [1.5 m, 0 m, -50 cm], facing: [-1, 0, 0]");
  auto const finished = [&](std::string const& phases) {
    write_text(folder / "a.yaml", edited(folded, "rims: off", "noise:\n  static_phase: " + phases));
    return straytrace({"check", folder / "a.yaml"});
  };
  Finished const twice = finished("{first: 1 deg,\n    second: 2 deg}");
  EXPECT_EQ(twice.code, 2);
  EXPECT_THAT(twice.err,
              AllOf(HasSubstr("a.yaml:14:13"), HasSubstr("keep one of them"), HasSubstr("1 error."),
                    HasSubstr("'first' and 'second' both state the static phase of the light that 'plate' scatters")));
  for (char const* one : {"{first: 1 deg}", "{second: 1 deg}"}) EXPECT_EQ(finished(one).code, 0) << "control: " << one;
}

// A route over two bodies that only a trace finds has its place too.
TEST(LightKeys, StaticPhaseStatedTwiceOnAWay) {
  Folder const folder;
  std::string const wall =
      edited(edited(plates, "transmit: 99 %", "transmit: 0"),
             "  - {name: window, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, -50 cm], facing: [1, 0, 1]",
             "  - {name: window, shape: {cylinder: {radius: 1 m, from: -2 m, to: 0 m}}");
  write_text(folder / "a.yaml", edited(wall, "rims: off", "noise: {static_phase: {first: 1 deg, second: 2 deg}}"));
  EXPECT_EQ(straytrace({"check", folder / "a.yaml"}).code, 0);
  Finished const run = straytrace({"run", folder / "a.yaml", "-o", folder / "out", "--histories", "8192", "--quiet"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, AllOf(HasSubstr("a.yaml:12:"), HasSubstr("both state the static phase of route"),
                             HasSubstr("keep one of them")));
}

}  // namespace
}  // namespace straytrace::testing::light_keys
