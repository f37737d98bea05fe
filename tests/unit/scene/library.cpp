// SPDX-License-Identifier: BSD-3-Clause
// The library that comes with the program as scenes take from it (docs/reference/library.md).
#include <filesystem>
#include <fstream>

#include "base/files/read_write.hpp"
#include "scene/model_tree.hpp"
#include "unit/scene/support.hpp"

namespace straytrace::test::scene_library {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

struct OnDisk {
  fs::path folder;
  OnDisk(std::string const& scene, std::string const& own_metals = "") {
    std::string name = (fs::temp_directory_path() / "library-XXXXXX").string();
    folder = ::mkdtemp(name.data());
    std::ofstream(folder / "arm.yaml") << "straytrace: 1\n" << scene;
    if (own_metals.empty()) return;
    fs::create_directories(folder / "library/materials");
    std::ofstream(folder / "library/materials/metals.yaml") << own_metals;
  }
  ~OnDisk() { fs::remove_all(folder); }
  Scene read() const { return read_scene((folder / "arm.yaml").string()); }
  std::string said() const {
    try {
      read().throw_if_problems();
    } catch (InputError const& e) {
      return e.what();
    }
    return "";
  }
};

std::vector<std::string> names(Scene const& scene, char const* section) {
  std::vector<std::string> all;
  for (auto const& [name, node] : scene.table(section).items()) all.push_back(name);
  return all;
}

std::string const one_plate =
    "include: [library/materials.yaml]\nscene:\n  - {name: plate, shape: {disk: {}}, material: oxidised_steel}\n";

TEST(Library, ComesWithTheProgramAndLeavesOutWhatIsNotNamed) {
  Scene const scene = OnDisk(one_plate).read();
  EXPECT_THAT(names(scene, "materials"), ElementsAre("oxidised_steel"));
  EXPECT_EQ(scene.files().at("library/materials/metals.yaml"), embedded_file("library/materials/metals.yaml"));
  // Again from its own texts alone, as a run file holds them: those, not the library of this program.
  FileTexts texts = scene.files();
  EXPECT_THAT(names(scene_of(texts), "materials"), ElementsAre("oxidised_steel"));
  texts["library/materials/metals.yaml"] = "materials: {oxidised_steel: {x: 7}}\n";
  EXPECT_EQ(scene_of(texts).table("materials").table("oxidised_steel").number("x", dim::plain), 7);
  texts.erase("library/materials/metals.yaml");
  EXPECT_THAT(errors_of(texts), HasSubstr("cannot read file"));
}

// A scene that takes only mirrors and interferometer of a detector has no tube and gives no message about it. Controls:
// a body of its own stays, and so do those of a file of motion, which has no scene to name them.
TEST(Library, BodiesThatNothingNamesAreLeftOut) {
  std::string const detector = "include: [library/detectors/adv.yaml]\n", bench = "bodies: {bench: {motion: still}}\n",
                    mirror = "scene:\n  - {name: ITM, shape: {disk: {}}, body: ITM, material: test_mass}\n";
  EXPECT_THAT(names(OnDisk(detector + bench + mirror).read(), "bodies"), ElementsAre("ITM", "bench"));
  EXPECT_THAT(names(OnDisk(detector).read(), "bodies"), ElementsAre("ITM", "ETM", "tube", "towers"));
}

TEST(Library, TheFolderOfTheUserComesFirst) {
  Scene const scene = OnDisk(one_plate, "materials: {oxidised_steel: {x: 3}}\n").read();
  EXPECT_EQ(scene.table("materials").table("oxidised_steel").number("x", dim::plain), 3);
}

TEST(Library, MessagesNameWhatIsNear) {
  EXPECT_THAT(OnDisk("include: [library/matrials.yaml]\n").said(), HasSubstr("did you mean 'library/materials.yaml'?"));
  EXPECT_THAT(OnDisk(one_plate + "materials: {oxidised_steel: {}}\n").said(),
              HasSubstr("material 'oxidised_steel' is already defined (line 8 of library/materials/metals.yaml)"));
  EXPECT_EQ(OnDisk(one_plate + "materials: {oxidised_steel: {override: true}}\n").said(), "");
  // The reader of a missing name reports it with all available names.
  Scene const misspelt =
      OnDisk("include: [library/materials.yaml]\nscene:\n  - {name: a, material: oxydised_steel}\n").read();
  EXPECT_GT(names(misspelt, "materials").size(), 20u);
}

TEST(Library, PartsBringTheirMaterials) {
  Scene const scene = OnDisk("include: [library/parts.yaml]\nscene:\n  - {name: d, use: v_dump, body: b}\n").read();
  EXPECT_EQ(names(scene, "materials"), (std::vector<std::string>{"black_glass", "black_anodise"}));
  EXPECT_EQ(scene.instances().size(), 9u);
  EXPECT_THAT(names(scene, "parts"), ::testing::Contains("v_dump"));
  EXPECT_THAT(names(scene, "parts"), ::testing::Not(::testing::Contains("tower")));
  // Errors of a part of the library are reported where it is used.
  EXPECT_THAT(OnDisk("include: [library/parts.yaml]\nscene:\n  - {name: d, use: v_dump, depth: 1 cm}\n").said(),
              HasSubstr("arm.yaml:4"));
}

TEST(Like, TakesOverWhatIsNotStated) {
  std::string const base = "materials:\n  a: {specular: {reflect: 1 %}, scatter: {model: x}, source: here}\n";
  Scene const scene = scene_of(base + "  b: {like: a, specular: {reflect: 2 %}, scatter: [{model: y}]}\n");
  ASSERT_NO_THROW(scene.throw_if_problems());
  Node const b = scene.table("materials").table("b");
  EXPECT_EQ(b.table("specular").number("reflect", dim::plain), 0.02);
  EXPECT_EQ(b.word("source"), "here");
  ASSERT_EQ(b.list("scatter").size(), 2u);
  EXPECT_EQ(b.list("scatter")[0].word("model"), "x");
  EXPECT_EQ(b.list("scatter")[1].word("model"), "y");
  EXPECT_EQ(scene.table("materials").table("a").list("scatter").size(), 1u);
  EXPECT_THAT(errors_of(base + "  b: {like: aa}\n"), HasSubstr("did you mean 'a'?"));
  EXPECT_THAT(errors_of(base + "  b: {like: a}\n  c: {like: b}\n"), HasSubstr("'like' cannot copy material 'b'"));
  EXPECT_THAT(errors_of(base + "  b: {like: b}\n"), HasSubstr("'like' cannot copy material 'b'"));
}

TEST(Parameters, StateTheirOrigin) {
  std::string const model =
      "params:\n  a: {value: 2*b, status: assumed, source: no number}\n  b: {value: 3 m, status: published}\n"
      "  c: {value: 1 m, status: assumed}\ntrace: {x: a}\n";
  Scene const scene = scene_of(model);
  EXPECT_EQ(scene.table("trace").number("x", dim::length), 6);
  ASSERT_NO_THROW(scene.throw_if_problems());
  EXPECT_THAT(assumed_parameters(scene), ElementsAre("parameter a = 2*b: assumed; no number"));  // c does not act
  EXPECT_THAT(assumed_parameters(scene_of(model, {"a=1 m"})), ElementsAre());
  EXPECT_EQ(scene_of(model, {"b=1 m"}).table("trace").number("x", dim::length), 2);
  EXPECT_THAT(errors_of("params: {a: {value: 1 m, status: gessed}}\n"), HasSubstr("status"));
  EXPECT_THAT(errors_of("params: {a: {value: 1 m, sorce: x}}\n"), HasSubstr("did you mean 'source'?"));
}

// eq. 8.16: as many as it takes. Control: one less does not reach.
TEST(Repeat, RatioUpToAPlace) {
  auto const places = [](std::string const& keys) {
    Scene const scene =
        scene_of("scene:\n  - {name: b, shape: {disk: {}}, repeat: {along: z, ratio: 2, " + keys + "}}\n");
    scene.throw_if_problems();
    std::vector<double> all;
    for (auto const& i : scene.instances()) all.push_back(i.offset);
    return all;
  };
  EXPECT_THAT(places("from: 10 m, to: 80 m"), ElementsAre(10, 20, 40));
  EXPECT_THAT(places("from: 10 m, to: 81 m"), ElementsAre(10, 20, 40, 80));
  EXPECT_THAT(places("origin: 100 m, from: 90 m, to: 55 m"), ElementsAre(90, 80, 60));
  std::string const bad = "scene:\n  - {name: b, shape: {disk: {}}, repeat: {along: z, from: 10 m, ";
  EXPECT_THAT(errors_of(bad + "ratio: 2, to: 5 m}}\n"), HasSubstr("no progression with this ratio"));
  EXPECT_THAT(errors_of(bad + "ratio: 2, to: 50 m, count: 3}}\n"), HasSubstr("both set the number of instances"));
}

}  // namespace
}  // namespace straytrace::test::scene_library
