// SPDX-License-Identifier: BSD-3-Clause
// The files of a run: complete, readable by others, and silent about the machine (docs/reference/run_file.md).
#include <cmath>
#include <numeric>
#include <pwd.h>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

std::uint32_t big_endian(std::string const& bytes, std::size_t at) {
  std::uint32_t x = 0;
  for (std::size_t i = 0; i < 4; ++i) x = x << 8 | static_cast<unsigned char>(bytes[at + i]);
  return x;
}
bool is_picture(std::string const& bytes) {  // PNG at least 1000 px wide
  return bytes.size() > 30000 && bytes.starts_with("\x89PNG\r\n\x1a\n") && big_endian(bytes, 16) >= 1000;
}

// The first of the words that names the machine or one of its places; empty: none does.
std::string machine_in(std::string const& text, Folder const& folder) {
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  Words words{host, folder.path(), "/tmp/", "/root/", "/home/", source_folder + "/"};
  if (passwd const* user = ::getpwuid(::getuid())) words.push_back(user->pw_name + std::string("@"));
  for (std::string const& w : words)
    if (w.size() > 3 && text.find(w) != text.npos) return w;
  return "";
}

int python(std::string const& program, std::string const& more = "") {
  return std::system(("cd / && timeout 60 /usr/bin/python3 -c '" + program + "'" + more).c_str());
}

TEST(Files, OfARun) {
  Folder const folder;
  fs::copy_file(virgo_arm, folder / "arm.yaml");
  Finished const r =
      straytrace({"run", folder / "arm.yaml", "-o", folder / "out", "--histories", "20000"}, {".", true});
  ASSERT_EQ(r.code, 0) << r.err;
  Words names;
  for (auto const& entry : fs::directory_iterator(folder / "out")) names.push_back(entry.path().filename());
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("run.h5", "h_asd.txt", "paths.csv", "report.txt", "report.png",
                                                     "report.html"));
  EXPECT_TRUE(is_picture(text_of(folder / "out/report.png")));
  EXPECT_FALSE(is_picture(text_of(folder / "out/report.txt")));
  for (std::string const& name : names)
    EXPECT_EQ(machine_in(text_of(folder / ("out/" + name)), folder), "") << "in " << name;
  EXPECT_NE(machine_in("see " + (folder / "arm.yaml"), folder), "");

  std::string const load =
      "import numpy as np; a = np.loadtxt(\"" + (folder / "out/h_asd.txt") + "\", usecols=(0, 1)); ";
  EXPECT_EQ(python(load + "assert a.shape == (138, 2) and 5 < a[0, 0] < 5.2 and 980 < a[-1, 0] < 1000"), 0);
  EXPECT_NE(python(load + "assert a.shape == (138, 3)", " 2>/dev/null"), 0);
  EXPECT_THAT(text_of(folder / "out/h_asd.txt"),
              HasSubstr("\n# frequency_Hz h_mean h_low h_high input_low input_high speckle_05 speckle_50 speckle_95 "
                        "resolved sigma phase_only amplitude_only coherent design ratio bound_share\n"));
  EXPECT_THAT(text_of(folder / "out/h_asd.txt"), HasSubstr("one-sided strain ASD"));
}

// Every group the light can reach is listed with what arrives there; terms of the energy balance add up to what was
// emitted, per history.
TEST(Files, EnergyBalanceOfTheVirgoArm) {
  Folder const folder;
  ASSERT_EQ(straytrace({"run", virgo_arm, "-o", folder / "out", "--histories", "60000", "--quiet"}).code, 0);
  std::string const report = text_of(folder / "out/report.txt");
  std::size_t const arriving = report.find("Light on objects");
  ASSERT_NE(arriving, report.npos);
  for (std::string const group :
       {"ITM", "ETM", "tube", "baffles_in", "baffles_end", "link_in", "link_end", "tower_in", "tower_end"}) {
    std::size_t const line = report.find("\n" + group + " ", arriving);
    ASSERT_NE(line, report.npos) << group;
    EXPECT_NE(report.substr(line, 60).find("e-0"), report.npos) << group << ": no light";
  }
  BlockSums const sums = read_run(folder / "out/run.h5").trace.total;
  auto const imbalance = [&](int balance_terms) {
    double sum = 0;
    for (int f = 0; f < balance_terms; ++f) sum += sums.energy_balance[std::size_t(f)].sum;
    return std::fabs(sum / sums.emitted.sum - 1);
  };
  EXPECT_LT(imbalance(balance_term_count), 1e-12);  // rounding only
  EXPECT_GT(imbalance(balance_term_count - 1), 1e-9);
  double objects = 0;  // R2.24: what is absorbed is on an object or in a medium
  for (Moments const& m : sums.absorbed) objects += m.sum;
  EXPECT_NEAR(objects / sums.energy_balance[int(BalanceTerm::absorbed)].sum, 1, 1e-12);
  EXPECT_GT(std::fabs((objects - sums.absorbed.front().sum) / sums.energy_balance[int(BalanceTerm::absorbed)].sum - 1),
            1e-9);
  EXPECT_EQ(sums.lost, 0u);
}

TEST(Files, EveryExampleIsAccepted) {
  int seen = 0;
  for (auto const& entry : fs::directory_iterator(source_folder + "/examples")) {
    if (entry.path().extension() != ".yaml") continue;
    ++seen;
    Finished const r = straytrace({"check", entry.path(), "--strict"});
    EXPECT_EQ(r.code, 0) << entry.path() << "\n" << r.err;
    EXPECT_THAT(r.out, HasSubstr("no errors\n"));
    EXPECT_EQ(straytrace({"check", entry.path(), "-p", "no_such=1"}).code, 2);
  }
  EXPECT_GE(seen, 3);
}

}  // namespace
}  // namespace straytrace::testing
