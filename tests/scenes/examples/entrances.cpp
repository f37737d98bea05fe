// SPDX-License-Identifier: BSD-3-Clause
// Where the ports of a scene join the interferometer (docs/theory/interferometer.md), given by the scene and by its
// table.
#include "scenes/program.hpp"

namespace straytrace::testing::app_entrances {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// An arm of 40 km; a disk behind the end mirror that the beam lights through it.
std::string const arm = R"(straytrace: 1
title: an arm and what stands behind it
materials:
  coat: {specular: {reflect: 1 - 100 ppm, transmit: 5 ppm}, scatter: {model: lambertian, tis: 4 ppm}}
  black: {scatter: {model: lambertian, tis: 1 %}}
bodies: {mirrors: {motion: still}, bench: {motion: {z: {line: {at: 1 Hz, width: 0.1 Hz, rms: 1 um rms}}, others: still}}}
scene:
  - {name: ITM, use: mirror, radius: 35 cm, radius_of_curvature: 25 km, facing: [0, 0, 1], body: mirrors, material: coat}
  - {name: ETM, use: mirror, radius: 35 cm, radius_of_curvature: 25 km, at: [0 m, 0 m, 40 km], facing: [0, 0, -1],
     body: mirrors, material: coat}
  - {name: disk, shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, 40.005 km], facing: [0, 0, -1], side: front,
     body: bench, material: black}
beams:
  arm: {cavity: [ITM, ETM], lit: {only: [disk]}}
ports:
  ITM: {beam: arm, at: ITM}
  ETM: {beam: arm, at: ETM}
  disk: {beam: arm, at: disk}
interferometer:
  preset: ce
trace: {histories: 4096, seed: 1}
noise: {band: [10 Hz, 100 Hz]}
)";

// Description of the interferometer by `check`.
std::string described(Folder const& folder, std::string const& keys) {
  write_text(folder / "arm.yaml", edited(arm, "preset: ce\n", "preset: ce\n" + keys));
  Finished const r = straytrace({"check", folder / "arm.yaml"});
  EXPECT_EQ(r.code, 0) << r.err;
  std::size_t const at = r.out.find("dual-recycled"), end = r.out.find('\n', at);
  EXPECT_NE(at, r.out.npos) << r.out;
  return r.out.substr(at, end - at);
}

// The second mirror of a cavity is its end mirror, and light from behind it joins there too.
TEST(Entrances, EndMirrorsAreFound) {
  Folder const folder;
  std::string const found = described(folder, "");
  EXPECT_THAT(found, HasSubstr("; ITM: arm, 2 copies"));
  EXPECT_THAT(found, HasSubstr("; ETM: end-mirror, 2 copies"));
  EXPECT_THAT(found, HasSubstr("; disk: through-end, 2 copies"));
  EXPECT_EQ(found, described(folder, "  ports: {ETM: {at: end-mirror}, disk: {at: through-end}}\n"));
  EXPECT_THAT(described(folder, "  ports: {ETM: {at: arm}, disk: {at: arm}}\n"), HasSubstr("; ITM, ETM, disk: arm"))
      << "control: the table overrides";
}

// Light that was followed through the mirror counts its transmission once: with the scene and with a later
// interferometer.
TEST(Entrances, TransmissionIsNotCountedTwice) {
  Folder const folder;
  std::string const twice = "preset: ce\n  ports: {disk: {at: end-bench}}\n";
  write_text(folder / "arm.yaml", edited(arm, "preset: ce\n", twice));
  Finished const checked = straytrace({"check", folder / "arm.yaml"});
  EXPECT_EQ(checked.code, 2);
  EXPECT_THAT(checked.err, HasSubstr("it would count twice"));
  write_text(folder / "arm.yaml", arm);
  ASSERT_EQ(straytrace({"trace", folder / "arm.yaml", "-o", folder / "arm.h5"}).code, 0);
  for (std::string const at : {"end-bench", "short-arm", "end-mirror"}) {
    write_text(folder / "other.yaml",
               "straytrace: 1\ninterferometer:\n  preset: adv\n  ports: {disk: {at: " + at + "}}\n");
    Finished const r =
        straytrace({"noise", folder / "arm.h5", "--motion", folder / "other.yaml", "-o", folder / "noise"});
    bool const rejected = at != "end-mirror";
    EXPECT_EQ(r.code, rejected ? 2 : 0) << at << r.err;
    if (rejected) {
      EXPECT_THAT(r.err, HasSubstr("other.yaml:4:22: error: 'lit' already includes")) << at;
    }
    EXPECT_EQ(fs::exists(folder / "noise"), !rejected) << at;
  }
}

// A wider band exceeds the files of the run: an error before anything is computed.
TEST(Entrances, FilesCoverTheRequestedBand) {
  Folder const folder;
  write_text(folder / "phase.txt", "10 1e-12 0\n100 1e-12 0\n");
  std::string const responses =
      "preset: ce\n  responses: {ETM: {phase: phase.txt, columns: [Hz, re, im], unit: strain}}\n";
  write_text(folder / "arm.yaml", edited(arm, "preset: ce\n", responses));
  ASSERT_EQ(straytrace({"trace", folder / "arm.yaml", "-o", folder / "arm.h5"}).code, 0);
  write_text(folder / "wide.yaml", "straytrace: 1\nnoise: {band: [5 Hz, 100 Hz]}\n");
  Finished const wide =
      straytrace({"noise", folder / "arm.h5", "--motion", folder / "wide.yaml", "-o", folder / "noise"});
  EXPECT_EQ(wide.code, 2);
  EXPECT_THAT(wide.err, HasSubstr("error: 'phase.txt' covers 10 Hz to 100 Hz"));
  write_text(folder / "arm.yaml", edited(text_of(folder / "arm.yaml"), "[10 Hz, 100 Hz]", "[10 Hz, 1 kHz]"));
  Finished const checked = straytrace({"check", folder / "arm.yaml"});
  EXPECT_EQ(checked.code, 2);
  EXPECT_THAT(checked.err, HasSubstr("arm.yaml:21:28: error: 'phase.txt' covers"));
}

// A mistake in an entry does not make its name unknown elsewhere.
TEST(Entrances, OneMistakeIsOneMessage) {
  Folder const folder;
  struct {
    std::string from, to;
  } const mistakes[] = {{"{disk: {outer", "{disc: {outer"},
                        {"cavity: [ITM, ETM]", "cavity: [ITM, ETN]"},
                        {"tis: 1 %", "tis: 1 m"},
                        {"outer_radius: 1 m", "outer_radius: 1"},
                        {"disk: {beam: arm,", "disk: {beam: arn,"}};
  for (auto const& m : mistakes) {
    std::string const text =
        edited(arm, "preset: ce\n", "preset: ce\n  ports: {disk: {copies: 1}, ETM: {copies: 1}}\n");
    write_text(folder / "arm.yaml", edited(text, m.from, m.to));
    Finished const r = straytrace({"check", folder / "arm.yaml"});
    EXPECT_EQ(r.code, 2) << m.to;
    EXPECT_THAT(r.err, HasSubstr("\n1 error.")) << m.to;
  }
}

}  // namespace
}  // namespace straytrace::testing::app_entrances
