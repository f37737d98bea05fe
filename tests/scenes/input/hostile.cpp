// SPDX-License-Identifier: BSD-3-Clause
// Hostile files: each gives an error message, in bounded time and memory, and no result is lost.
#include <sys/stat.h>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/limits.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr rlim_t gigabyte = rlim_t{1} << 30;

std::string many(std::string const& piece, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += piece;
  return all;
}

// Every command that takes a file, each with the name of something that is not a file.
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
      bool const scene = name.ends_with(".yaml");
      bool const wants_run =
          scene && (words.front() == "paths" || words.front() == "noise" || words.front() == "report");
      EXPECT_THAT(r.err, HasSubstr(wants_run ? "is a scene, not a run" : why)) << words.front() << ' ' << name;
    }
}

// Texts that would use all memory or time: errors with their place.
TEST(Hostile, ScenesThatExplode) {
  Folder const folder;
  Limit const memory(RLIMIT_AS, 2 * gigabyte);
  std::string const disk = "shape: {disk: {outer_radius: 1 m}}";
  std::string wide = "parts:\n  p0: {faces: {f: {" + disk + "}}}\n", tower = "1";  // 30^7 instances
  for (int i = 1; i < 8; ++i) {
    wide += "  p" + std::to_string(i) + ": {faces: {";
    for (int k = 0; k < 30; ++k) wide += "a" + std::to_string(k) + ": {use: p" + std::to_string(i - 1) + "}, ";
    wide += "}}\n";
  }
  for (int i = 0; i < 60; ++i) tower = "9^" + tower;
  auto const expression = [](std::string const& text) { return "params: {a: " + text + "}\nnoise: {margin: a}\n"; };
  for (auto const& [text, says] :
       {std::pair{"trace: " + many("[", 100000), "nested more than 64 deep"},
        {"trace: {seed: [" + many("1, ", 100000) + "1]}\n", "'seed' is a plain number, got a list"},
        {"title: " + std::string(100 << 20, 'x') + "\n", "it is larger than 16 MB"},
        {"scene: [{name: a, " + disk + ", repeat: {along: z, from: 0 m, pitch: 1 m, count: 1e9}}]\n",
         "arm.yaml:2:104: error: 'count' must be between 1 and 1e+06, got \"1e9\""},
        {wide + "scene: [{name: x, use: p7}]\n", "the scene has more than 1000000 instances"},
        {"parts: {p: {faces: {f: {use: q}}}, q: {faces: {f: {use: p}}}}\nscene: [{name: x, use: p}]\n",
         "part 'p' contains itself"},
        {expression(many("(", 100000) + "1" + many(")", 100000)), "the expression is nested too deeply"},
        {expression(many("-", 100000) + "1"), "the expression is nested too deeply"},
        {expression("1e308*10"), "arm.yaml:2:13: error: the result is not a finite number"},
        {expression(tower), "the result is not a finite number"},
        {expression("0/0"), "division by zero"},
        {expression("nan"), "'nan' is not a finite number"},
        {"params: {a: b, b: a}\nnoise: {margin: a}\n", "parameter 'a' depends on itself (a -> b -> a)"},
        {"noise: {band: [1e-300 Hz, 1e300 Hz]}\n", "the band exceeds 1 nHz to 1 THz"},
        {"include: [../../../../../../../../proc/self/mem]\n", "proc/self/mem': Input/output error"},
        {"include: [arm.yaml]\n", "'arm.yaml' includes itself"}}) {
    write_text(folder / "arm.yaml", "straytrace: 1\n" + text);
    Finished const r = straytrace({"run", folder / "arm.yaml", "-o", folder / "out"}, {".", false, 20});
    EXPECT_EQ(r.code, 2) << text.substr(0, 60) << r.err.substr(0, 500);
    EXPECT_THAT(r.err, HasSubstr(says)) << text.substr(0, 60);
    EXPECT_THAT(r.err, HasSubstr("Nothing was run.")) << text.substr(0, 60);
    EXPECT_LT(r.err.size(), 200000u);
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
}

// Words and texts longer than a stack is deep: std::regex ends the program at them.
TEST(Hostile, EndlessWords) {
  Folder const folder;
  std::string const digits(120000, '1'), out = folder / "out";
  write_text(folder / "arm.yaml", edited(text_of(et_hf), "trace: {seed: 1, histories: 1000000,",
                                         "trace: {seed: 1, until: '" + digits + "s',"));
  for (Words const& words : {Words{"check", folder / "arm.yaml"},
                             {"trace", et_hf, "-o", out, "--max-time", digits + "s"},
                             {"trace", et_hf, "-o", out, "--max-time", "1e999s"},
                             {"trace", et_hf, "-o", out, "--until", digits + "s"},
                             {"trace", et_hf, "-o", out, "--slice", std::string(120000, ' ') + "1/2"},
                             {"trace", et_hf, "-o", out, "--format", digits},
                             {"trace", et_hf, "-o", out, "--histories", digits},
                             {"scan", et_hf, "rings=" + digits, "-o", out},
                             {"scan", et_hf, "rings=1e999,2", "-o", out},
                             {"scan", et_hf, "--invert", digits},
                             {"submit", et_hf, "--backend", "slurm", "--jobs", "2", "--histories", "1e5", "-o", out,
                              "--accounting", digits}}) {
    Finished const r = straytrace(words, {folder.path(), false, 20});
    EXPECT_EQ(r.code, 2) << words.front() << ' ' << words.back().substr(0, 20) << r.err.substr(0, 200);
    EXPECT_THAT(r.err, HasSubstr("error: ")) << words.front();
    EXPECT_EQ(r.err.find("stod"), r.err.npos) << words.front();
    EXPECT_FALSE(fs::exists(out + "/run.h5"));
  }
}

// Text of a file reaches the terminal as letters, not as control sequences; and a header of a million names is read
// once.
TEST(Hostile, TextsForTheTerminal) {
  Folder const folder;
  Words const scan{"scan", et_hf, "--points", folder / "points.csv", "--histories", "4096", "-o", folder / "out"};
  write_text(folder / "points.csv", "\x1b]0 owned\x07 \x1b[2J\n1\n");
  Finished const binary = straytrace(scan);
  EXPECT_EQ(binary.code, 2);
  EXPECT_THAT(binary.err, AllOf(HasSubstr("this is a binary file"), Not(HasSubstr("\x1b"))));
  write_text(folder / "points.csv",
             "a\xc2\x9b"
             "31m\n1\n");  // a control character that is text in UTF-8
  Finished const orders = straytrace(scan);
  EXPECT_EQ(orders.code, 2);
  EXPECT_THAT(orders.err, AllOf(HasSubstr("parameter 'a?31m' is not defined"), Not(HasSubstr("\xc2\x9b"))));
  write_text(folder / "points.csv", std::string(1000000, ',') + "\n1\n");
  EXPECT_EQ(straytrace(scan, {".", false, 20}).code, 2);
  write_text(folder / "points.csv", std::string(1000000, '[') + "\n1\n");
  EXPECT_LT(straytrace(scan).err.size(), 20000u);
}

// A run cut short or changed in one bit: every command reports it and writes no files.
TEST(Hostile, NoCommandReadsADamagedRun) {
  Folder const folder;
  ASSERT_EQ(straytrace({"trace", et_hf, "-p", "rings=40", "-o", folder / "good.h5", "--histories", "4096"}).code, 0);
  std::string const good = text_of(folder / "good.h5");
  std::string bad = good;
  bad[bad.size() / 2] = char(bad[bad.size() / 2] ^ 1);
  std::string const out = folder / "out.html";
  for (std::string const& bytes : {bad, good.substr(0, good.size() - 100)}) {
    write_text(folder / "bad.h5", bytes);
    for (Words words : {Words{"paths"},
                        {"noise"},
                        {"report", "-o", out},
                        {"view", "-o", out},
                        {"maps", "-o", out},
                        {"diff", folder / "good.h5"},
                        {"fringes"},
                        {"budget", "aligo"},
                        {"importance"},
                        {"couple", "predict", "--body", "tube", "--axis", "z"},
                        {"run", "-o", out},
                        {"trace", "--history", "1"},
                        {"project", "-o", out},
                        {"scan", "--invert", "motion(tube)"}}) {
      words.push_back(folder / "bad.h5");
      Finished const r = straytrace(words, {folder.path(), false, 20});
      EXPECT_EQ(r.code, 2) << words.front();
      EXPECT_THAT(r.err, HasSubstr("its content does not match its checksum")) << words.front();
      EXPECT_FALSE(fs::exists(out)) << words.front();
    }
  }
  EXPECT_EQ(straytrace({"paths", folder / "good.h5"}).code, 0);
}

}  // namespace
}  // namespace straytrace::testing
