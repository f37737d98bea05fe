// SPDX-License-Identifier: BSD-3-Clause
// Tables of text for people.
#include "results/text/columns.hpp"

#include <gtest/gtest.h>

#include "base/every_module.hpp"

namespace straytrace::testing::report_columns {
namespace {

TEST(ReportColumns, AlignByCharactersNotBytes) {
  EXPECT_EQ(width_of("ITM·S"), 5u);
  EXPECT_EQ(aligned({{"a", "b"}, {true}, {{"·", "10"}, {"xx", "5"}}}), "a    b\n------\n·   10\nxx   5\n");
}

TEST(ReportColumns, NamesSteerNoTerminal) {
  EXPECT_EQ(aligned({{"channel"}, {true}, {{"a\x1b[2Jb"}}}), "channel\n-------\na?[2Jb\n");
}

}  // namespace
}  // namespace straytrace::testing::report_columns
