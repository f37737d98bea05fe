// SPDX-License-Identifier: BSD-3-Clause
// A result is a function of scene, seed and number of histories, and of nothing else (architecture.md 7).
#include "report/report.hpp"
#include "scenes/program.hpp"

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

// Rows of a CSV file without its comments, which hold the time.
std::string rows(std::string const& text) {
  std::size_t at = 0;
  while (at < text.size() && text[at] == '#') at = text.find('\n', at) + 1;
  return text.substr(at);
}

// The search structure only proposes candidates: testing every surface gives the same bits.
TEST(Determinism, SearchStructureDoesNotMatter) {
  Folder const folder;
  std::string const good = text_of(virgo_arm);
  write_text(folder / "brute.yaml", edited(good, "trace: {seed: 1,", "trace: {seed: 1, structure: none,"));
  write_text(folder / "other.yaml", edited(good, "rim: 49.5 cm ", "rim: 49.500001 cm "));
  hash_of_run(folder, "axial", {});
  hash_of_run(folder, "brute", {}, folder / "brute.yaml");
  hash_of_run(folder, "other", {}, folder / "other.yaml");
  std::string const axial = rows(text_of(folder / "axial/paths.csv"));
  EXPECT_GT(axial.size(), 500u);
  EXPECT_EQ(rows(text_of(folder / "brute/paths.csv")), axial);
  EXPECT_NE(rows(text_of(folder / "other/paths.csv")), axial);
}

}  // namespace
}  // namespace straytrace::testing
