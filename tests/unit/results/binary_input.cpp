// SPDX-License-Identifier: BSD-3-Clause
// Run files hold input files of any content: meshes are not text.
#include <gtest/gtest.h>

#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

TEST(ReportBinaryInput, ComesBackByteByByte) {
  Folder folder;
  TraceResult const trace = trace_result();
  RunContent run = content(trace, nullptr);
  std::string every;
  for (int i = 0; i < 256; ++i) every += char(i);
  run.files = {{"arm.yaml", "straytrace: 1\n"},
               {"binary.stl", every + std::string(7, '\0')},
               {"zeros.stl", std::string(3, '\0')},
               {"latin.obj", "v \xe9\n"},
               {"cut.obj", "\xe2\x82"},
               {"large.obj", std::string(std::size_t{3} << 20, 'v')},
               {"empty.csv", ""},
               {"micro.csv", "\xc2\xb5m\n"}};
  write_run(folder / "run.h5", run);
  EXPECT_EQ(read_run(folder / "run.h5").about.files, run.files);
  EXPECT_LT(read_file(folder / "run.h5").size(), std::size_t{2} << 20) << "large files are compressed";
}

}  // namespace
}  // namespace straytrace::test
