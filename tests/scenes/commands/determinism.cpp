// SPDX-License-Identifier: BSD-3-Clause
// A result is a function of scene, seed and number of histories, and of nothing else (docs/develop/architecture.md).
#include <map>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

// data_hash: every dataset and attribute but /timing and `created`.
std::string hash_of_run(Folder const& folder, std::string const& name, Words const& more,
                        std::string const& scene = virgo_arm) {
  Words words{"run", scene, "-o", folder / name, "--histories", "60000", "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  Finished const r = straytrace(words);
  EXPECT_EQ(r.code, 0) << r.err;
  return data_hash(folder / (name + "/run.h5"));
}

TEST(Determinism, ThreadsDoNotMatterSeedsDo) {
  Folder const folder;
  std::string const one = hash_of_run(folder, "one", {"--threads", "1"});
  EXPECT_EQ(hash_of_run(folder, "two", {"--threads", "2"}), one);
  EXPECT_EQ(hash_of_run(folder, "three", {"--threads", "3"}), one);
  EXPECT_NE(hash_of_run(folder, "seed", {"--threads", "2", "--seed", "2"}), one);
}

// A lit mirror, a tube with a baffle, a holder of triangles, and a laser whose light a lens collects on a photodiode.
std::string const everything = R"(straytrace: 1
materials:
  mirror: {specular: {reflect: 90 %}, scatter: {model: lambertian, tis: 1 %}}
  wall: {scatter: {model: lambertian, tis: 10 %}}
  white: {scatter: {model: lambertian, tis: 90 %}}
  bare: {specular: fresnel, scatter: {model: lambertian, tis: 0.1 %}}
media: {silica: {index: 1.45, absorption: 0.1 /m}}
bodies: {all: {motion: still}}
scene:
  - {name: mirror, shape: {disk: {outer_radius: 20 cm}}, facing: [0, 0, 1], body: all, material: mirror}
  - {name: tube, shape: {cylinder: {radius: 50 cm, from: -1 m, to: 9 m}}, body: all, material: wall}
  - {name: baffle, shape: {cone: {inner_radius: 35 cm, outer_radius: 50 cm, half_angle: 60 deg}}, at: [0 m, 0 m, 4 m],
     body: all, material: wall}
  - {name: holder, file: holder.obj, units: mm, at: [10 cm, 0 m, 2 m], facing: [0, 0, -1], body: all, material: wall}
  - {name: card, shape: {disk: {outer_radius: 3 cm}}, at: [0 m, 20 cm, 3 m], facing: [0, 0, -1], body: all,
     material: white}
  - {name: lens, use: lens, diameter: 50 mm, thickness: 8 mm, radius_1: 9 cm, radius_2: 9 cm, medium: silica,
     at: [0 m, 20 cm, 280 cm], facing: [0, 0, -1], body: all, material: bare}
  - {name: photodiode, shape: {disk: {outer_radius: 2 mm}}, at: [0 m, 20 cm, 260 cm], facing: [0, 0, 1], body: all,
     material: wall}
beams:
  spot: {on: mirror, radius: 5 cm, power: 1 W}
  laser: {from: [8 cm, 20 cm, 260 cm], facing: [-0.2, 0, 1], radius: 5 mm, wavefront_curvature: 2 /m, power: 1 W}
ports: {mirror: {beam: spot, at: mirror}}
interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %}
receivers: {photodiode: {on: photodiode, side: front, map: {width: 4 mm, pixels: [8, 8]}}}
trace: {order_limit: 8, window: no}
)";

// The instruction set of search and meshes (world/search/search_kernels.hpp, geometry/mesh/triangle_mesh.cpp); what a
// processor lacks is replaced by what it has.
TEST(Determinism, InstructionSetsDoNotMatter) {
  Folder const folder;
  std::string const mixed = folder / "mixed.yaml";
  write_text(mixed, everything);
  fs::copy_file(source_folder + "/examples/holder.obj", folder / "holder.obj");
  for (std::string const& scene : {virgo_arm, mixed}) {
    std::map<std::string, std::string> hash;
    for (char const* isa : {"portable", "avx2", "avx512"}) {
      ::setenv("STRAYTRACE_ISA", isa, 1);
      hash[isa] = hash_of_run(folder, fs::path(scene).stem().string() + isa, {}, scene);
    }
    ::unsetenv("STRAYTRACE_ISA");
    EXPECT_EQ(hash["avx2"], hash["portable"]) << scene;
    EXPECT_EQ(hash["avx512"], hash["portable"]) << scene;
    EXPECT_NE(hash_of_run(folder, fs::path(scene).stem().string() + "seed", {"--seed", "2"}, scene), hash["portable"]);
  }
}

TEST(Determinism, UnknownInstructionSetIsAnError) {
  ::setenv("STRAYTRACE_ISA", "sse", 1);
  Finished const f = straytrace({"check", virgo_arm});
  ::unsetenv("STRAYTRACE_ISA");
  EXPECT_EQ(f.code, 2);
  EXPECT_NE(f.err.find("'sse'"), std::string::npos) << f.err;
  EXPECT_NE(f.err.find("portable, avx2 or avx512"), std::string::npos) << f.err;
  EXPECT_EQ(straytrace({"check", virgo_arm}).code, 0) << "control";
}

// Rows of a CSV file without its comments, which hold the time.
std::string rows(std::string const& text) {
  std::size_t at = 0;
  while (at < text.size() && text[at] == '#') at = text.find('\n', at) + 1;
  return text.substr(at);
}

// The search structure only proposes candidates: testing every surface gives the same bits.
TEST(Determinism, SearchStructureDoesNotMatter) {
  Folder const folder;
  std::string const good = text_of(written_arm);
  write_text(folder / "brute.yaml", edited(good, "trace: {seed: 1,", "trace: {seed: 1, structure: none,"));
  write_text(folder / "other.yaml", edited(good, "rim: 49.5 cm ", "rim: 49.500001 cm "));
  hash_of_run(folder, "axial", {}, written_arm);
  hash_of_run(folder, "brute", {}, folder / "brute.yaml");
  hash_of_run(folder, "other", {}, folder / "other.yaml");
  std::string const axial = rows(text_of(folder / "axial/paths.csv"));
  EXPECT_GT(axial.size(), 500u);
  EXPECT_EQ(rows(text_of(folder / "brute/paths.csv")), axial);
  EXPECT_NE(rows(text_of(folder / "other/paths.csv")), axial);
}

}  // namespace
}  // namespace straytrace::testing
