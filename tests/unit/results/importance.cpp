// SPDX-License-Identifier: BSD-3-Clause
// The map of importance in run files.
#include <gtest/gtest.h>

#include <H5Cpp.h>
#include <fstream>

#include "base/errors.hpp"
#include "results/run_file/run_file.hpp"
#include "unit/results/same.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

TEST(ReportImportance, ComesBackBitByBit) {
  Folder const folder;
  TraceResult const trace = trace_result();
  ImportanceMap const was = content(trace, nullptr).importance;
  write_run(folder / "run.h5", content(trace, nullptr));
  ImportanceMap const back = read_run(folder / "run.h5").about.importance;
  EXPECT_TRUE(same(back, was));
  ImportanceMap other = was;
  other.strips[2].patch = 0;
  EXPECT_FALSE(same(back, other)) << "negative control";
  RunContent wrong = content(trace, nullptr);
  wrong.importance.strips[0].patch = 2;
  write_run(folder / "wrong.h5", wrong);
  EXPECT_THROW(read_run(folder / "wrong.h5"), InputError);
}

// Files before schema 1.3 have none.
TEST(ReportImportance, IsAbsentInOlderFiles) {
  Folder const folder;
  TraceResult const trace = trace_result();
  write_run(folder / "run.h5", content(trace, nullptr));
  std::string image = unsealed(read_file(folder / "run.h5"), "run.h5");
  {
    std::ofstream(folder / "bare.h5", std::ios::binary) << image;
    H5::H5File file(folder / "bare.h5", H5F_ACC_RDWR);
    file.unlink("importance");
  }
  write_file(folder / "old.h5", sealed(read_file(folder / "bare.h5")));
  RunFile const old = read_run(folder / "old.h5");
  EXPECT_TRUE(old.about.importance.strips.empty());
  EXPECT_TRUE(same(trace.coupling, old.trace.coupling));
}

}  // namespace
}  // namespace straytrace::test
