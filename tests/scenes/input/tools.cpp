// SPDX-License-Identifier: BSD-3-Clause
// The Python side on a run of the program.
#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

int run_python(std::string const& words) {
  return std::system(("timeout 60 /usr/bin/python3 " + words + " >/dev/null").c_str());
}

TEST(Tools, PythonReadsARun) {
  Folder const folder;
  ASSERT_EQ(straytrace({"run", et_hf, "-p", "rings=40", "-o", folder / "a", "--histories", "200000"}).code, 0);
  std::string const test = "'" + source_folder + "/tests/tools/python/test_run_file.py' ", run = folder / "a/run.h5",
                    curve = folder / "a/h_asd.txt";
  EXPECT_EQ(run_python(test + run + " " + curve), 0);
  EXPECT_NE(run_python(test + curve + " " + curve + " 2>/dev/null"), 0);
}

}  // namespace
}  // namespace straytrace::testing
