// SPDX-License-Identifier: BSD-3-Clause
// --backend on the command line: with a GPU the same bits, without one a message with a remedy.
#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

TEST(BackendOption, UnknownNamesAreErrors) {
  Folder const folder;
  for (Words const& words : {Words{"trace", virgo_arm, "-o", folder / "a.h5", "--backend", "gpu"},
                             Words{"run", virgo_arm, "-o", folder / "a", "--backend", "CUDA"}}) {
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2);
    EXPECT_THAT(r.err, HasSubstr("there is no backend '" + words.back() + "'"));
    EXPECT_THAT(r.err, HasSubstr("cuda"));
  }
  EXPECT_THAT(straytrace({"run", virgo_arm, "-o", folder / "a", "--backend", "mpi"}).err,
              HasSubstr("mpi is for trace"));
  EXPECT_FALSE(fs::exists(folder / "a.h5"));
  EXPECT_FALSE(fs::exists(folder / "a/run.h5"));
}

TEST(BackendOption, CudaGivesTheSameNumbersOrAReason) {
  Folder const folder;
  auto const asd = [&](std::string const& name, std::string const& backend) {
    return straytrace({"run", virgo_arm, "-o", folder / name, "--histories", "8192", "--backend", backend});
  };
  Finished const cpu = asd("cpu", "cpu"), cuda = asd("cuda", "cuda");
  ASSERT_EQ(cpu.code, 0) << cpu.err;
  if (cuda.code == 0) {
    auto const numbers = [&](std::string const& name) {
      std::ifstream in(folder / name + "/h_asd.txt");
      std::string all;
      for (std::string line; std::getline(in, line);)
        if (!line.starts_with('#')) all += line + '\n';  // the header contains the time
      return all;
    };
    EXPECT_GT(numbers("cpu").size(), 1000u);
    EXPECT_EQ(numbers("cuda"), numbers("cpu"));
  } else {
    EXPECT_EQ(cuda.code, 2);
    EXPECT_THAT(cuda.err, ::testing::AnyOf(HasSubstr("no GPU"), HasSubstr("built without CUDA")));
    EXPECT_THAT(cuda.err, HasSubstr("--backend cpu"));
    EXPECT_FALSE(fs::exists(folder / "cuda/run.h5"));
  }
  EXPECT_THAT(straytrace({"--version"}).out, HasSubstr("\ncuda: "));
}

}  // namespace
}  // namespace straytrace::testing
