// SPDX-License-Identifier: BSD-3-Clause
// The Python side on a run file written here: tests/tools/python/test_plot.py, and the picture through a child process.
#include "results/text/picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

// Sets a variable of the environment for one test.
class Variable {
 public:
  Variable(char const* name, std::string const& value) : name_(name) { ::setenv(name, value.c_str(), 1); }
  Variable(Variable const&) = delete;
  Variable& operator=(Variable const&) = delete;
  ~Variable() { ::unsetenv(name_); }

 private:
  char const* name_;
};

class ReportPicture : public ::testing::Test {
 protected:
  void SetUp() override {
    TraceResult const trace = trace_result();
    NoiseBudget const noise = noise_budget(trace.coupling);
    write_run(folder / "run.h5", content(trace, &noise));
    write_file(folder / "h_asd.txt", asd_text(content(trace, &noise)));
  }
  std::string const source = STRAY_SOURCE_DIR;
  Folder folder;
  Variable package{"STRAYTRACE_PYTHONPATH", source + "/python"};
  std::string message;
};

TEST_F(ReportPicture, IsDrawn) {
  ASSERT_TRUE(draw_picture(folder / "run.h5", folder / "report.png", message)) << message;
  std::string const png = read_file(folder / "report.png");
  EXPECT_TRUE(png.starts_with("\x89PNG"));
  EXPECT_GT(png.size(), 50000u);
}

TEST_F(ReportPicture, NamesThePackagesToInstall) {
  Variable const python("STRAYTRACE_PYTHON", "/no/such/python");
  EXPECT_FALSE(draw_picture(folder / "run.h5", folder / "report.png", message));
  EXPECT_THAT(message, HasSubstr("apt install python3-matplotlib python3-h5py"));
  EXPECT_FALSE(std::filesystem::exists(folder / "report.png"));
}

TEST_F(ReportPicture, PassesOnTheMessagesOfPython) {
  EXPECT_FALSE(draw_picture(folder / "missing.h5", folder / "report.png", message));
  EXPECT_THAT(message, HasSubstr("cannot read"));
}

// Names with spaces and quotes reach Python unchanged, without a shell.
TEST_F(ReportPicture, TakesOddNames) {
  std::string const odd = folder / "my $(run) 'a'.h5";
  std::filesystem::rename(folder / "run.h5", odd);
  EXPECT_TRUE(draw_picture(odd, folder / "a b.png", message, 10, 500)) << message;
}

TEST_F(ReportPicture, PythonReadsRunAndCurves) {
  std::string const script = source + "/tests/tools/python/test_plot.py";
  std::string const command =
      "/usr/bin/python3 '" + script + "' '" + (folder / "run.h5") + "' '" + (folder / "h_asd.txt") + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace straytrace::test
