// SPDX-License-Identifier: BSD-3-Clause
// Outputs of commands: lists of materials, the energy balance, figures of merit, and small errors.
#include <nlohmann/json.hpp>

#include <regex>
#include <sstream>

#include "scenes/program.hpp"

namespace straytrace::testing::app_answers {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string const two_mirrors = source_folder + "/examples/two_mirrors.yaml";

// R3.35: the materials of the iris scene.
constexpr char iris[] =
    "newmtl glass_a\nTR 0.5 0.3\nIOR 1.45 1064\nPPM 100 1\nnewmtl glass_b\nTR 0.3 0.5\nIOR 1.5 1.064\nPPM 1 100\n"
    "newmtl splitter\nTR 0.5 0.3\nnewmtl absorber\nTR 0 0\n";

TEST(Answers, AListOfMaterialsBecomesAFileToInclude) {
  Folder const folder;
  write_text(folder / "iris.mtl", iris);
  Finished const r = straytrace({"inspect", folder / "iris.mtl"});
  EXPECT_EQ(r.code, 0) << r.err;
  for (char const* part : {"glass_a: {index: 1.45}", "glass_b: {index: 1.5}", "specular: {reflect: 0.3, transmit: 0.5}",
                           "specular: {reflect: 0.5, transmit: 0.3}", "tis: 100 ppm, through: yes", "tis: 1 ppm}"})
    EXPECT_THAT(r.out, HasSubstr(part));
  write_text(folder / "materials.yaml", r.out);
  auto const scene = [&](std::string const& material) {
    write_text(folder / "a.yaml",
               "straytrace: 1\ninclude: [materials.yaml]\nbodies: {b: {motion: still}}\nscene:\n"
               "  - {name: x, use: plate, medium: glass_a, body: b, material: " +
                   material + "}\nbeams: {s: {on: x/front, radius: 1 mm}}\nreceivers: {back: {on: x/back}}\n");
    return straytrace({"check", folder / "a.yaml", "--strict"});
  };
  EXPECT_EQ(scene("glass_a").code, 0) << scene("glass_a").err;
  EXPECT_EQ(scene("glass_c").code, 2);  // negative control
  auto const list = nlohmann::json::parse(straytrace({"inspect", folder / "iris.mtl", "--format", "json"}).out);
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(list[1]["index"], 1.5);
  EXPECT_NEAR(list[0]["scatter_transmit"], 1e-4, 1e-16);
  EXPECT_NEAR(list[0]["scatter_reflect"], 1e-6, 1e-18);
}

TEST(Answers, AListThatCreatesLightIsAnErrorWithItsPlace) {
  Folder const folder;
  write_text(folder / "a.mtl", "newmtl a\nTR 0.5 0.3\nnewmtl b\nTR 0.5 0.5\nPPM 100 1\n");
  Finished const r = straytrace({"inspect", folder / "a.mtl"});
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr("a.mtl:3:8: error: material 'b' violates energy conservation"));
  EXPECT_EQ(straytrace({"inspect", folder / "none.mtl"}).code, 2);
}

// Requirements 8.1: all rows that ship keep R + T + S at 1 or below, and can be included.
TEST(Answers, TheMaterialsOfTheEndBenchAreSound) {
  Finished const r =
      straytrace({"inspect", source_folder + "/library/materials/end_bench_2018.yaml", "--format", "json"});
  EXPECT_EQ(r.code, 0) << r.err;
  std::istringstream lines(r.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    auto const normal = nlohmann::json::parse(line)["tis"][0];
    EXPECT_NEAR(normal["scattered"].get<double>() + normal["reflect"].get<double>() + normal["transmit"].get<double>() +
                    normal["absorbed"].get<double>(),
                1, 1e-12);
    EXPECT_GE(normal["absorbed"].get<double>(), -1e-12) << line;
  }
  EXPECT_EQ(count, 22);
}

TEST(Answers, HIsShortForTheTotal) {
  Folder const folder;
  auto const run = [&](std::string const& out, std::string const& rule) {
    return straytrace({"run", et_hf, "-p", "rings=40", "-o", folder / out, "--until", rule, "--quiet"});
  };
  Finished const short_form = run("a", "h < 20 %"), long_form = run("b", "h_total < 20 %");
  EXPECT_EQ(short_form.code, 0) << short_form.err;
  EXPECT_EQ(short_form.out, long_form.out);
  EXPECT_EQ(run("c", "hh < 20 %").code, 2);  // negative control
}

// emitted = sum of the terms, one line each.
TEST(Answers, TracePrintsTheEnergyBalance) {
  Folder const folder;
  Finished const r = straytrace({"trace", two_mirrors, "-o", folder / "a.h5", "--histories", "40960"});
  EXPECT_EQ(r.code, 0) << r.err;
  for (char const* balance_term : {"emitted", "absorbed", "escaped", "truncated", "roulette", "sampling"})
    EXPECT_TRUE(std::regex_search(r.out, std::regex("\n" + std::string(balance_term) + " +[0-9n-]")))
        << balance_term << r.out;
  EXPECT_THAT(r.out, HasSubstr("Closure: emitted power and the sum of the terms differ by"));
  Finished const json =
      straytrace({"trace", two_mirrors, "-o", folder / "b.h5", "--histories", "4096", "--format", "json"});
  EXPECT_THAT(json.out, Not(HasSubstr("Closure")));
}

// The figure depends on time: on stderr, with a unit, and not with --quiet.
TEST(Answers, FiguresOfMeritArePrinted) {
  Folder const folder;
  Words words{"trace", two_mirrors, "-o", folder / "a.h5", "--histories", "409600"};
  Finished const r = straytrace(words);
  EXPECT_TRUE(std::regex_search(r.err, std::regex("figure of merit +[0-9.e+]+ /s  receiver "))) << r.err;
  EXPECT_THAT(r.out, Not(HasSubstr("figure of merit")));
  words.insert(words.end(), {"--quiet", "--force"});
  EXPECT_THAT(straytrace(words).err, Not(HasSubstr("figure of merit")));
}

TEST(Answers, PicturesArePng) {
  Folder const folder;
  Finished const r = straytrace({"render", two_mirrors, "-o", folder / "x.jpg", "--pixels", "32x32"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("write -o " + folder.path() + "/x.png"));
  EXPECT_FALSE(fs::exists(folder / "x.jpg"));
  EXPECT_EQ(straytrace({"render", two_mirrors, "-o", folder / "x.PNG", "--pixels", "32x32"}).code,
            0);  // negative control
}

TEST(Answers, ReceiversMayBeCameraPositions) {
  Folder const folder;
  auto const from = [&](std::string const& name) {
    return straytrace({"render", two_mirrors, "-o", folder / "x.png", "--pixels", "32x32", "--from", name});
  };
  EXPECT_EQ(from("PD").code, 0);
  EXPECT_THAT(from("PDX").err, HasSubstr("did you mean 'PD'?"));
  EXPECT_THAT(from("nothing_like_it").err, HasSubstr("PD,"));
}

TEST(Answers, FirstOrderKeepsToTheRequestedEnds) {
  auto const first = [](Words more) {
    Words words{"paths", two_mirrors, "--first-order", "--histories", "4096"};
    words.insert(words.end(), more.begin(), more.end());
    return straytrace(words);
  };
  EXPECT_THAT(first({}).out, HasSubstr("Seen from receiver PD"));
  EXPECT_THAT(first({"--by", "receiver"}).out, HasSubstr("Seen from receiver PD"));
  Finished const ports = first({"--by", "port"});
  EXPECT_EQ(ports.code, 2);
  EXPECT_THAT(ports.err, HasSubstr("the scene has no ports"));
}

}  // namespace
}  // namespace straytrace::testing::app_answers
