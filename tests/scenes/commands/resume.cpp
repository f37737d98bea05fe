// SPDX-License-Identifier: BSD-3-Clause
// Runs that are stopped, continued, rerun or in the way (docs/reference/commands.md: exit code 85, manners).
#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char never[] = "h_total < 1e-6 %";

// A scene that is traced quickly: few rings.
Words run_into(std::string const& folder, Words const& more) {
  Words words{"run", et_hf, "-p", "rings=40", "-o", folder};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// Until the program reports progress, which it does half a second after it began to trace.
bool traces(Program& program) { return program.says("histories/s"); }

// The histories of a run: a multiple of 4096 that is larger.
std::string more_than(RunFile const& run) { return std::to_string(run.trace.total.histories + 10 * largest_block); }

TEST(Resume, InterruptedAndContinuedIsOneLongRun) {
  Folder const folder;
  Program running(run_into(folder / "a", {"--until", never}));
  ASSERT_TRUE(traces(running));
  running.interrupt();
  Finished const stopped = running.wait();
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("same command"));
  RunFile const half = read_run(folder / "a/run.h5");
  EXPECT_FALSE(half.complete);
  EXPECT_GT(half.trace.total.histories, 0u);
  EXPECT_THAT(text_of(folder / "a/report.txt"), HasSubstr("histories"));

  std::string const n = more_than(half);
  Finished const continued = straytrace(run_into(folder / "a", {"--histories", n}));
  EXPECT_EQ(continued.code, 0) << continued.err;
  EXPECT_THAT(continued.err, HasSubstr("resuming from"));
  EXPECT_EQ(straytrace(run_into(folder / "b", {"--histories", n})).code, 0);
  EXPECT_TRUE(read_run(folder / "a/run.h5").complete);
  EXPECT_EQ(data_hash(folder / "a/run.h5"), data_hash(folder / "b/run.h5"));
  EXPECT_EQ(straytrace(run_into(folder / "c", {"--histories", n, "--seed", "2"})).code, 0);
  EXPECT_NE(data_hash(folder / "a/run.h5"), data_hash(folder / "c/run.h5"));
}

TEST(Resume, MaxTime) {
  Folder const folder;
  Finished const r = straytrace(run_into(folder / "a", {"--until", never, "--max-time", "0.3s", "--quiet"}));
  EXPECT_EQ(r.code, 85);
  RunFile const run = read_run(folder / "a/run.h5");
  EXPECT_FALSE(run.complete);
  std::string const n = more_than(run);
  EXPECT_EQ(straytrace(run_into(folder / "a", {"--histories", n})).code, 0);
  EXPECT_EQ(straytrace(run_into(folder / "b", {"--histories", n})).code, 0);
  EXPECT_EQ(data_hash(folder / "a/run.h5"), data_hash(folder / "b/run.h5"));
}

// A run that ended before its first block says that it has no answer. Control: it continues to one.
TEST(Resume, NoHistoryIsNoAnswer) {
  Folder const folder;
  Finished const none = straytrace(run_into(folder / "a", {"--until", never, "--max-time", "1e-9s", "--quiet"}));
  EXPECT_EQ(none.code, 85);
  EXPECT_THAT(none.out, HasSubstr("no traced light has rejoined a port: trace more histories"));
  EXPECT_THAT(none.out, ::testing::Not(HasSubstr("nothing")));
  Finished const compared = straytrace({"diff", folder / "a/run.h5", folder / "a/run.h5"});
  EXPECT_EQ(compared.code, 2);
  EXPECT_THAT(compared.err, HasSubstr("no traced light has rejoined a port"));
  Finished const some = straytrace(run_into(folder / "a", {"--histories", "65536", "--quiet"}));
  EXPECT_EQ(some.code, 0) << some.err;
  EXPECT_THAT(some.out, ::testing::Not(HasSubstr("no traced light has rejoined a port")));
}

TEST(Resume, AReachedErrorIsNotTracedAgain) {
  Folder const folder;
  auto const run = [&](std::string const& scene, std::string const& until) {
    Finished const r = straytrace({"run", scene, "-p", "rings=40", "-o", folder / "a", "--until", until});
    EXPECT_EQ(r.code, 0) << r.err;
    return read_run(folder / "a/run.h5").trace.total.histories;
  };
  auto const first = run(et_hf, "h_total < 2 %");
  std::string const bits = data_hash(folder / "a/run.h5");
  EXPECT_EQ(run(et_hf, "h_total < 2 %"), first);
  EXPECT_EQ(data_hash(folder / "a/run.h5"), bits);
  EXPECT_GT(run(et_hf, "h_total < 0.01 %"), first);  // control: another goal is traced for
  // Looks at another motion do not count: the rule is about h, and h has changed.
  write_text(folder / "louder.yaml", edited(text_of(et_hf), "asd: 1e-15 m/sqrt(Hz)", "asd: 1e-14 m/sqrt(Hz)"));
  auto const said = [&](std::string const& scene) {
    return straytrace({"run", scene, "-p", "rings=40", "-o", folder / "a", "--until", "h_total < 0.01 %"}).err;
  };
  EXPECT_THAT(said(et_hf), Not(HasSubstr("starts again")));
  EXPECT_THAT(said(folder / "louder.yaml"), HasSubstr("starts again"));
}

TEST(Resume, AnotherModelIsNotOverwritten) {
  Folder const folder;
  ASSERT_EQ(straytrace(run_into(folder / "a", {"--histories", "4096"})).code, 0);
  std::string const bytes = text_of(folder / "a/run.h5");
  std::string const report = text_of(folder / "a/report.txt");
  for (Words const& other : {Words{"--seed", "3"}, Words{"-p", "R_t=0.51 m"}}) {
    Words words = run_into(folder / "a", {"--histories", "4096"});
    words.insert(words.end(), other.begin(), other.end());
    Finished const rejected = straytrace(words);
    EXPECT_EQ(rejected.code, 2);
    EXPECT_THAT(rejected.err, HasSubstr("contains a run of another model or seed"));
    EXPECT_THAT(rejected.err, HasSubstr("overwrite it with --force"));
    EXPECT_EQ(text_of(folder / "a/run.h5"), bytes);
    EXPECT_EQ(text_of(folder / "a/report.txt"), report);
  }
  EXPECT_EQ(straytrace(run_into(folder / "a", {"--histories", "4096", "--seed", "3", "--force"})).code, 0);
  EXPECT_EQ(read_run(folder / "a/run.h5").trace.coupling.seed, 3u);
  // The commands that write elsewhere obey as well.
  ASSERT_EQ(straytrace(run_into(folder / "b", {"--histories", "4096"})).code, 0);
  std::string const a = text_of(folder / "a/run.h5");
  EXPECT_EQ(straytrace({"noise", folder / "b/run.h5", "-o", folder / "a"}).code, 2);
  EXPECT_EQ(straytrace({"trace", et_hf, "-o", folder / "a/run.h5", "--histories", "4096"}).code, 2);
  EXPECT_EQ(text_of(folder / "a/run.h5"), a);
  EXPECT_EQ(straytrace({"noise", folder / "b/run.h5", "-o", folder / "a", "--force"}).code, 0);
  EXPECT_EQ(read_run(folder / "a/run.h5").trace.coupling.seed, 1u);
}

TEST(Resume, DamagedRunsAreNotContinued) {
  Folder const folder;
  ASSERT_EQ(straytrace(run_into(folder / "a", {"--histories", "4096"})).code, 0);
  std::string bytes = text_of(folder / "a/run.h5");
  bytes[bytes.size() / 2] = char(bytes[bytes.size() / 2] ^ 1);
  write_text(folder / "a/run.h5", bytes);
  Finished const rejected = straytrace(run_into(folder / "a", {"--histories", "8192"}));
  EXPECT_EQ(rejected.code, 2);
  EXPECT_THAT(rejected.err, HasSubstr("damaged"));
  EXPECT_THAT(rejected.err, HasSubstr("--force"));
  EXPECT_EQ(text_of(folder / "a/run.h5"), bytes);
  EXPECT_EQ(straytrace({"paths", folder / "a/run.h5"}).code, 2);
  EXPECT_EQ(straytrace({"noise", folder / "a/run.h5"}).code, 2);
}

// Two runs cannot write into one folder at the same time; the first is not disturbed.
TEST(Resume, AFolderBelongsToOneRunAtATime) {
  Folder const folder;
  Program running(run_into(folder / "a", {"--until", never}));
  ASSERT_TRUE(traces(running));
  Finished const second = Program(run_into(folder / "a", {"--histories", "4096"})).wait();
  EXPECT_EQ(second.code, 2);
  EXPECT_THAT(second.err, HasSubstr("another run is writing"));
  running.interrupt();
  EXPECT_EQ(running.wait().code, 85);
  EXPECT_NO_THROW(read_run(folder / "a/run.h5"));
}

// Where nothing moves there is no error to reduce: the run reports this and ends.
TEST(Resume, AStillSceneEnds) {
  Folder const folder;
  write_text(
      folder / "still.yaml",
      "straytrace: 1\nbodies: {plate: {motion: still}}\nmaterials: {m: {scatter: {model: lambertian, tis: 1 %}}}\n"
      "scene:\n  - {name: plate, shape: {disk: {outer_radius: 5 cm}}, body: plate, material: m}\n"
      "beams: {b: {on: plate, radius: 1 mm}}\nports: {p: {beam: b, at: plate}}\n"
      "interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, arm_power: 1 kW, mirror_mass: 42 kg, "
      "input_transmission: 1.4 %}\ntrace: {until: h_total < 5 %}\n");
  Finished const r = Program({"run", folder / "still.yaml", "-o", folder / "a"}).wait();
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("nothing on its routes moves"));
  EXPECT_THAT(r.err, HasSubstr("no body moves"));
}

}  // namespace
}  // namespace straytrace::testing
