// SPDX-License-Identifier: BSD-3-Clause
// Run files whose seal is right and whose numbers are not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <H5Cpp.h>
#include <cmath>

#include "results/run_file/run_file.hpp"
#include "support/message_of.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

void set_last(std::string const& file, char const* path, double value) {
  H5::H5File const changed(file, H5F_ACC_RDWR);
  H5::DataSet const set = changed.openDataSet(path);
  std::vector<double> values(std::size_t(set.getSpace().getSimpleExtentNpoints()));
  set.read(values.data(), H5::PredType::NATIVE_DOUBLE);
  values.back() = value;
  set.write(values.data(), H5::PredType::NATIVE_DOUBLE);
}

TEST(ReportRunNumbers, ImpossibleSumsAreDamage) {
  Folder const folder;
  TraceResult const trace = trace_result();
  write_run(folder / "run.h5", content(trace, nullptr));
  for (double const value : {0.5, std::nan(""), HUGE_VAL}) {
    write_file(folder / "bare.h5", unsealed(read_file(folder / "run.h5"), "run.h5"));
    set_last(folder / "bare.h5", "/nodes/emitted", value);
    write_file(folder / "sealed.h5", sealed(read_file(folder / "bare.h5")));
    EXPECT_THAT(
        message_of([&] { (void)read_run(folder / "sealed.h5"); }),
        ::testing::HasSubstr(std::isfinite(value) ? "no error" : "'/nodes/emitted' holds a sum that is not a number"));
  }
}

}  // namespace
}  // namespace straytrace::test
