// SPDX-License-Identifier: BSD-3-Clause
// Parameters from the command line, includes, overrides, files (docs/reference/scene.md).
#include <filesystem>
#include <fstream>

#include "unit/scene/support.hpp"

namespace straytrace::test::scene_include {
namespace {

using ::testing::HasSubstr;

double aperture_of(std::vector<std::string> const& overrides) {
  Scene const scene = scene_of("params: {aperture: 84 cm, half: aperture/2, n: 3}\ntrace: {x: half}\n", overrides);
  double const x = scene.table("trace").number("x", dim::length);
  scene.throw_if_problems();
  EXPECT_EQ(scene.overrides(), overrides);
  return x;
}

TEST(Overrides, ReplaceParametersOfTheModel) {
  EXPECT_EQ(aperture_of({}), 0.42);
  EXPECT_EQ(aperture_of({"aperture=60cm"}), 0.3);
  EXPECT_EQ(aperture_of({"aperture=n*10 cm", "n=40"}), 2);
  EXPECT_EQ(aperture_of({"aperture=0"}), 0);
}

TEST(Overrides, ErrorsStateThePlace) {
  std::string const model = "params: {aperture: 84 cm}\n";
  EXPECT_EQ(errors_of(model, {"aperure=60cm"}),
            R"(command line:1:4: error: parameter 'aperure' is not defined in the model
    1 | -p aperure=60cm
      |    ^^^^^^^ did you mean 'aperture'?
1 error. Nothing was run.
)");
  EXPECT_THAT(errors_of(model, {"aperture=60"}),
              HasSubstr("command line:1:13: error: 'aperture' is a length, got \"60\" without a unit"));
  EXPECT_THAT(errors_of(model, {"aperture=60 s"}), HasSubstr("(a time)"));
  EXPECT_THAT(errors_of(model, {"aperture"}), HasSubstr("'aperture' does not set a parameter"));
  EXPECT_THAT(errors_of(model, {"=3 m"}), HasSubstr("does not set a parameter"));
  EXPECT_THAT(errors_of(model, {"aperture=60 cm", "aperture=x\ny"}), HasSubstr("command line:2"));
}

TEST(Overrides, ReplaceValuesByTheirPlace) {
  std::string const model = "params: {a: 3 m}\nmaterials:\n  steel: {x: 1 m, laws: [{x: 2 m}, {name: second, x: a}]}\n";
  auto const values = [&](std::vector<std::string> const& overrides) {
    Scene const scene = scene_of(model, overrides);
    Node const steel = scene.table("materials").table("steel");
    std::vector<double> x{steel.number("x", dim::length), steel.number("y", dim::length, 0)};
    for (Node const& law : steel.list("laws")) x.push_back(law.number("x", dim::length));
    scene.throw_if_problems();
    return x;
  };
  EXPECT_EQ(values({}), (std::vector<double>{1, 0, 2, 3}));
  EXPECT_EQ(values({"materials.steel.x=5 m", "materials.steel.y=6 m"}), (std::vector<double>{5, 6, 2, 3}));
  EXPECT_EQ(values({"materials.steel.laws[0].x=7 m", "materials.steel.laws.second.x=2*a", "params.a=4 m"}),
            (std::vector<double>{1, 0, 7, 8}));
  EXPECT_THAT(errors_of(model, {"materials.stel.x=5 m"}),
              HasSubstr("command line:1:4: error: 'materials' has no 'stel'\n    1 | -p materials.stel.x=5 m\n"));
  EXPECT_THAT(errors_of(model, {"materials.stel.x=5 m"}), HasSubstr("did you mean 'steel'?"));
  EXPECT_THAT(errors_of(model, {"materials.steel=5 m"}), HasSubstr("'materials.steel' is a table, not a value"));
  EXPECT_THAT(errors_of(model, {"materials.steel.laws.2.x=5 m"}), HasSubstr("'laws' has no '2'"));
  EXPECT_THAT(errors_of(model, {"steel.x=5 m"}), HasSubstr("the model has no 'steel'"));
  EXPECT_THAT(errors_of(model, {"materials.steel.x.z=5 m"}), HasSubstr("it is a single value"));
}

// The table `set` does what -p does, before it; the command line has the last word.
TEST(Overrides, TheTableSet) {
  auto const x_of = [](std::string const& set, std::vector<std::string> const& overrides = {}) {
    Scene const scene = scene_of("materials: {steel: {x: 1 m}}\nset: {" + set + "}\n", overrides);
    double const x = scene.table("materials").table("steel").number("x", dim::length);
    scene.throw_if_problems();
    return x;
  };
  EXPECT_EQ(x_of(""), 1);
  EXPECT_EQ(x_of("materials.steel.x: 5 m"), 5);
  EXPECT_EQ(x_of("materials.steel.x: 5 m", {"materials.steel.x=6 m"}), 6);
  auto const errors = [](std::string const& set) {
    return errors_of("materials: {steel: {x: 1 m}}\nset: {" + set + "}\n");
  };
  EXPECT_THAT(errors("materials.stel.x: 5 m"), HasSubstr("arm.yaml:3:7: error: 'materials' has no 'stel'"));
  EXPECT_THAT(errors("x: 5 m"), HasSubstr("'x' is not the place of a value"));
  EXPECT_THAT(errors("materials.steel.x: [5 m]"), HasSubstr("'materials.steel.x' is not set to a single value"));
}

FileTexts included(std::string const& main, std::string const& lib) {
  return {{"arm.yaml", "straytrace: 1\ninclude: [lib/a.yaml]\n" + main}, {"lib/a.yaml", lib}};
}

TEST(Include, MergesByName) {
  FileTexts texts = included(
      "params: {b: a*2}\nmaterials: {hr: {x: 1}}\nscene:\n  - {name: m, use: mirror}\n",
      "include: b.yaml\nparams: {a: c + 1 m}\nmaterials: {steel: {x: 2}}\nscene:\n  - {name: k, use: mirror}\n");
  texts["lib/b.yaml"] = "straytrace: 1\nparams: {c: 2 m}\ntitle: library\n";
  Scene const scene = scene_of(texts);
  ASSERT_NO_THROW(scene.throw_if_problems());
  EXPECT_EQ(scene.table("params").items().size(), 3u);
  EXPECT_EQ(scene.table("params").number("b", dim::length), 6);
  EXPECT_EQ(scene.table("materials").items().size(), 2u);
  ASSERT_EQ(scene.instances().size(), 2u);
  EXPECT_EQ(scene.instances()[0].name, "k");
  EXPECT_EQ(scene.files(), texts);
  EXPECT_EQ(scene.title(), "library");
}

TEST(Include, LaterDefinitionsNeedTheWord) {
  std::string const lib = "params: {a: 1 m}\nmaterials: {steel: {x: 2}}\ntrace: {seed: 1}\n";
  EXPECT_THAT(errors_of(included("materials: {steel: {x: 3}}\n", lib)),
              HasSubstr("arm.yaml:3:13: error: material 'steel' is already defined (line 2 of lib/a.yaml)"));
  EXPECT_THAT(errors_of(included("params: {a: 2 m}\n", lib)), HasSubstr("parameter 'a' is already defined"));
  EXPECT_THAT(errors_of(included("trace: {seed: 2}\n", lib)),
              HasSubstr("'trace' is already defined (line 3 of lib/a.yaml)"));
  EXPECT_THAT(errors_of("parts: {mirror: {faces: {a: {shape: {disk: {}}}}}}\n"),
              HasSubstr("part 'mirror' is already defined (line 3 of built-in parts)"));

  Scene const scene =
      scene_of(included("materials: {steel: {x: 3, override: true}}\nparams: {override: true, a: 2 m}\ntrace: "
                        "{override: true, seed: 5}\n",
                        lib));
  ASSERT_NO_THROW(scene.throw_if_problems());
  EXPECT_EQ(scene.table("materials").table("steel").number("x", dim::plain), 3);
  EXPECT_EQ(scene.table("params").number("a", dim::length), 2);
  EXPECT_EQ(scene.table("trace").number("seed", dim::plain), 5);
  for (char const* section : {"trace"}) scene.table(section).refuse_unknown(section);
  scene.table("materials").table("steel").refuse_unknown("material");
  EXPECT_NO_THROW(scene.throw_if_problems());

  EXPECT_THAT(errors_of(included("materials: {steal: {x: 3, override: true}}\n", lib)),
              HasSubstr("did you mean 'steel'?"));
  EXPECT_THAT(errors_of(included("noise: {override: true}\n", lib)),
              HasSubstr("'override: true' but no earlier 'noise'"));
}

TEST(Include, CyclesAndDiamonds) {
  EXPECT_THAT(errors_of(included("", "include: [a.yaml]\n")),
              HasSubstr("lib/a.yaml:1:11: error: 'lib/a.yaml' includes itself"));
  EXPECT_THAT(errors_of(included("", "include: [../arm.yaml]\n")),
              HasSubstr("'arm.yaml' includes itself through other files"));
  FileTexts diamond = included("", "include: [b.yaml, c.yaml]\n");
  diamond["lib/b.yaml"] = "include: [d.yaml]\n";
  diamond["lib/c.yaml"] = "include: [d.yaml]\n";
  diamond["lib/d.yaml"] = "params: {a: 1 m}\n";
  EXPECT_EQ(errors_of(diamond), "");
}

TEST(Include, FilesThatCannotBeRead) {
  EXPECT_THAT(errors_of("include: [b.yaml]\n"),
              HasSubstr("arm.yaml:2:11: error: cannot read file 'b.yaml': the stored model does not contain it"));
  EXPECT_THAT(errors_of("include: [/etc/passwd]\n"), HasSubstr("'/etc/passwd' is an absolute path"));
  EXPECT_THAT(errors_of("include: ['C:\\b.yaml']\n"), HasSubstr("is an absolute path"));
  EXPECT_THAT(errors_of("include: [~/b.yaml]\n"), HasSubstr("is an absolute path"));
  EXPECT_THAT(errors_of("include: [[b.yaml]]\n"), HasSubstr("'include' takes file names"));
  // Syntax errors of all files come together.
  FileTexts texts = included("include2: [\n", "title: a: b\n");
  texts["arm.yaml"] = "straytrace: 1\ninclude: [lib/a.yaml, lib/c.yaml]\ntitle: &x b\n";
  texts["lib/c.yaml"] = "materials: {a: [}\n";
  std::string const said = errors_of(texts);
  EXPECT_THAT(said, HasSubstr("arm.yaml:3:8"));
  EXPECT_THAT(said, HasSubstr("lib/a.yaml:1:9"));
  EXPECT_THAT(said, HasSubstr("lib/c.yaml:1:"));
  EXPECT_THROW(read_scene("/no/such/folder/arm.yaml"), InputError);
  EXPECT_THROW(scene_of(FileTexts{}), InputError);
}

class OnDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string const test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::path(::testing::TempDir()) / ("straytrace_scene_" + test);  // tests run side by side
    std::filesystem::remove_all(folder_);
    write("models/arm.yaml",
          "straytrace: 1\ninclude: [../shared/a.yaml]\ntrace: {file: data/x.csv}\nscene:\n"
          "  - {name: b, use: baffle, repeat: {table: data/z.csv}}\n");
    write("shared/a.yaml",
          "parts: {baffle: {params: {aperture: 1 m}, faces: {f: {shape: {disk: {r: aperture}}}}}}\nnoise: {file: "
          "y.csv}\n");
    write("models/data/x.csv", "1, 2\n");
    write("models/data/z.csv", "z [m], aperture [cm]\n1, 50\n2.5, 60\n");
    write("shared/y.csv", "3, 4\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(std::string const& name, std::string const& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  static std::string signature(Scene const& scene) {
    std::string out =
        scene.table("trace").data_file("data/x.csv") + scene.table("noise").data_file("y.csv") + scene.resolved();
    for (Scene::Instance const& i : scene.instances())
      out += i.name + std::to_string(i.node.table("shape").table("disk").number("r", dim::length));
    scene.throw_if_problems();
    return out;
  }

  std::filesystem::path folder_;
};

TEST_F(OnDisk, TextsGiveTheSameTreeWithoutTheDisk) {
  Scene const first = read_scene((folder_ / "models/arm.yaml").string());
  std::string const expected = signature(first);
  FileTexts const texts = first.files();
  std::vector<std::string> names;
  for (auto const& [name, text] : texts) names.push_back(name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"../shared/a.yaml", "../shared/y.csv", "arm.yaml", "data/x.csv", "data/z.csv"}));
  EXPECT_EQ(first.main_file(), "arm.yaml");
  std::filesystem::remove_all(folder_);
  Scene const again = read_scene(first.main_file(), first.overrides(), &texts);
  EXPECT_EQ(signature(again), expected);
  EXPECT_EQ(again.files(), texts);
  // Negative control: one changed digit in one stored text shows.
  FileTexts changed = texts;
  changed["data/z.csv"] = "z [m], aperture [cm]\n1, 50\n2.5, 61\n";
  EXPECT_NE(signature(read_scene("arm.yaml", {}, &changed)), expected);
}

TEST_F(OnDisk, NoNameOfThisMachineIsKept) {
  Scene const scene = read_scene((folder_ / "models/arm.yaml").string());
  std::string const all = signature(scene);
  EXPECT_EQ(all.find(folder_.string()), std::string::npos);
  for (auto const& [name, text] : scene.files()) EXPECT_FALSE(name.starts_with('/')) << name;
  write("models/arm.yaml", "straytrace: 1\ninclude: [missing.yaml, ../shared]\n");
  try {
    read_scene((folder_ / "models/arm.yaml").string());
    FAIL();
  } catch (InputError const& e) {
    EXPECT_EQ(std::string(e.what()).find(folder_.string()), std::string::npos);
    EXPECT_THAT(e.what(), HasSubstr("there is no such file"));
    EXPECT_THAT(e.what(), HasSubstr("it is not a regular file"));
  }
}

}  // namespace
}  // namespace straytrace::test::scene_include
