// SPDX-License-Identifier: BSD-3-Clause
// Files that are made to hurt: each is refused in a sentence, in bounded time and memory, and nothing is lost.
#include <sys/stat.h>

#include "report/report.hpp"
#include "scenes/limits.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

constexpr rlim_t gigabyte = rlim_t{1} << 30;

std::string many(std::string const& piece, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += piece;
  return all;
}

// Every command that takes a file, each with a name of what is no file.
TEST(Hostile, DevicesAndPipesAreNotRead) {
  Folder const folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.yaml").c_str(), 0600), 0);
  fs::create_symlink("loop.yaml", folder / "loop.yaml");
  Limit const memory(RLIMIT_AS, 2 * gigabyte);
  for (auto const& [name, why] : {std::pair{std::string("/dev/zero"), "it is not a regular file"},
                                  {folder / "pipe.yaml", "it is not a regular file"},
                                  {folder.path(), "it is not a regular file"},
                                  {folder / "loop.yaml", "Too many levels of symbolic links"},
                                  {"/proc/self/mem", "Input/output error"}})
    for (Words words : {Words{"check"},
                        {"paths"},
                        {"noise"},
                        {"report"},
                        {"view"},
                        {"diff", virgo_arm},
                        {"signal", "psd"},
                        {"budget", "aligo", "--compare"},
                        {"--unsaved", "a.yaml=" + name, "check"}}) {
      words.push_back(name);
      Finished const r = straytrace(words, {folder.path(), false, 10});
      EXPECT_EQ(r.code, 2) << words.front() << ' ' << name << ' ' << r.err;
      EXPECT_THAT(r.err, HasSubstr(why)) << words.front() << ' ' << name;
    }
}

// Texts that would take all memory or time: told at their place.
TEST(Hostile, ScenesThatExplode) {
  Folder const folder;
  Limit const memory(RLIMIT_AS, 2 * gigabyte);
  std::string const head = "straytrace: 1\n", nothing = "shape: {disk: {outer_radius: 1 m}}";
  auto const nested = [](int depth) {
    std::string all = "parts:\n  p0: {faces: {f: {shape: {disk: {outer_radius: 1 m}}}}}\n";
    for (int i = 1; i <= depth; ++i)
      all += "  p" + std::to_string(i) + ": {scene: [{name: q, use: p" + std::to_string(i - 1) +
             ", repeat: {axis: z, from: 0 m, pitch: 1 m, count: 1000}}]}\n";
    return all + "scene: [{name: x, use: p" + std::to_string(depth) + "}]\n";
  };
  std::string tower = "1";
  for (int i = 0; i < 60; ++i) tower = "9^" + tower;
  for (auto const& [text, says] :
       {std::pair{"trace: " + many("[", 100000), "nested more than 64 deep"},
        {"trace: {seed: [" + many("1, ", 1000000) + "1]}\n", "error"},
        {"title: " + std::string(100 << 20, 'x') + "\n", "it is larger than 16 MB"},
        {"scene: [{name: a, " + nothing + ", repeat: {axis: z, from: 0 m, pitch: 1 m, count: 1e9}}]\n", "arm.yaml:2:"},
        {nested(6), "arm.yaml:"},
        {"params: {a: " + many("(", 100000) + "1" + many(")", 100000) + "}\nnoise: {margin: a}\n", "arm.yaml:2:"},
        {"params: {a: 1e308*10}\nnoise: {margin: a}\n", "arm.yaml:2:"},
        {"params: {a: " + tower + "}\nnoise: {margin: a}\n", "arm.yaml:2:"},
        {"params: {a: 0/0}\nnoise: {margin: a}\n", "arm.yaml:2:"},
        {"params: {a: nan}\nnoise: {margin: a}\n", "arm.yaml:2:"},
        {"params: {a: b, b: a}\nnoise: {margin: a}\n", "arm.yaml:2:"},
        {"include: [../../../../../../etc/passwd]\n", "etc/passwd"},
        {"include: [arm.yaml]\n", "'arm.yaml' includes itself"}}) {
    write_text(folder / "arm.yaml", head + text);
    Finished const r = straytrace({"run", folder / "arm.yaml", "-o", folder / "out"}, {".", false, 20});
    EXPECT_EQ(r.code, 2) << text.substr(0, 60) << r.err.substr(0, 500);
    EXPECT_THAT(r.err, HasSubstr(says)) << text.substr(0, 60);
    EXPECT_THAT(r.err, HasSubstr("Nothing was run.")) << text.substr(0, 60);
    EXPECT_LT(r.err.size(), 200000u);
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
}

}  // namespace
}  // namespace straytrace::testing
