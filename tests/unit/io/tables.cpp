// SPDX-License-Identifier: BSD-3-Clause
// Tables with a header: all problems of header and rows at once, each with its place and a remedy that fits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "base/every_module.hpp"
#include "base/files/read_write.hpp"
#include "io/delimited_text.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Read {
  CsvTable table;
  std::string said;
};

Read read(std::string const& text, std::span<std::string_view const> numeric = {}) {
  std::vector<Problem> problems;
  Read out{parse_csv_table(text, Comments::whole_lines, "a, b", problems, numeric), ""};
  if (!problems.empty()) out.said = errors_in("t.csv", problems).what();
  return out;
}

TEST(CsvTables, AllProblemsOfAHeaderAtOnce) {
  Read const r = read("a [foo], b, b, [m]\n1, 2, 3, 4\n");
  EXPECT_THAT(r.said, AllOf(HasSubstr("t.csv:1:1: error: cannot read the column name 'a [foo]'"),
                            HasSubstr("t.csv:1:13: error: column 'b' appears twice"),
                            HasSubstr("t.csv:1:16: error: cannot read the column name '[m]'")));
  EXPECT_TRUE(r.table.columns.empty());
  std::string const headless = read("1, 2, 3\n").said;
  EXPECT_THAT(headless, AllOf(HasSubstr("'1'"), Not(HasSubstr("'2'")))) << "one cause, one error";
}

TEST(CsvTables, SoundRowsStayBesideWrongOnes) {
  Read const r = read("a, b\n1, x\n3, 4\n5\n");
  EXPECT_EQ(r.table.columns.size(), 2u);
  ASSERT_EQ(r.table.rows.size(), 1u);
  EXPECT_EQ(r.table.rows[0].values, (std::vector<double>{3, 4}));
  EXPECT_FALSE(r.table.whole);
  EXPECT_THAT(r.said, AllOf(HasSubstr("t.csv:2:4: error: 'x' is not a number"),
                            HasSubstr("t.csv:4:1: error: 1 value, but the header has 2 columns")));
  EXPECT_TRUE(read("a, b\n1, 2\n").table.whole);
}

// All wrong cells of a row, up to ten in all; a sound cell between them is not named.
TEST(CsvTables, EveryWrongCellOfARow) {
  std::string const said = read("a, b, c\nx, 2, y\n3, 4, 5\n6, z, 7\n").said;
  EXPECT_THAT(said, AllOf(HasSubstr("t.csv:2:1: error: 'x' is not a number"),
                          HasSubstr("t.csv:2:7: error: 'y' is not a number"),
                          HasSubstr("t.csv:4:4: error: 'z' is not a number"), Not(HasSubstr("'2'"))));
  std::vector<Problem> problems;
  std::string many = "a, b, c\n";
  for (int i = 0; i < 5; ++i) many += "x, y, z\n";
  parse_csv_table(many, Comments::whole_lines, "a", problems);
  EXPECT_EQ(problems.size(), 10u);
}

// Neither infinity nor 0 in their place, also where only the unit leads out of the range.
TEST(CsvTables, NumbersOutsideTheRangeOfDoublePrecision) {
  EXPECT_THAT(read("a, b\n1e999, -1e-999\n").said,
              AllOf(HasSubstr("t.csv:2:1: error: '1e999' is outside the range of double precision"),
                    HasSubstr("t.csv:2:8: error: '-1e-999' is outside the range of double precision")));
  EXPECT_THAT(read("a [km], b [nm]\n1e308, 1e-323\n").said,
              AllOf(HasSubstr("t.csv:2:1: error: '1e308' is outside"), HasSubstr("'1e-323' is outside")));
  Read const sound = read("a, b\n1e-307, 0e-999\n");  // control
  EXPECT_EQ(sound.said, "");
  EXPECT_EQ(sound.table.rows.at(0).values, (std::vector<double>{1e-307, 0}));
}

// U+00A0, U+2007, U+2009, U+202F, between words and before units. Places count code points.
TEST(CsvTables, NoBreakSpacesAreSpacesExceptBetweenDigits) {
  for (std::string const space : {"\xc2\xa0", "\xe2\x80\x87", "\xe2\x80\x89", "\xe2\x80\xaf"}) {
    Read const r = read("a" + space + "[m /" + space + "s], b\n" + space + "1," + space + "2" + space + "\n");
    EXPECT_EQ(r.said, "");
    EXPECT_EQ(r.table.rows.at(0).values, (std::vector<double>{1, 2}));
    EXPECT_THAT(read("a, b\n" + space + "1, x\n").said, HasSubstr("t.csv:2:5: error: 'x'"));
    EXPECT_THAT(read("a, b\n1" + space + "000, 2\n").said, HasSubstr("between its digits"));
    NumberTable const t = parse_numbers("1" + space + " 2\n3 " + space + "4\n");
    ASSERT_TRUE(t.problems.empty()) << t.problems[0].what;
    EXPECT_EQ(t.column.at(1), (std::vector<double>{2, 4}));
    NumberTable const grouped = parse_numbers("10 1\n1" + space + "000 2\n");
    ASSERT_EQ(grouped.problems.size(), 1u) << "not three columns";
    EXPECT_THAT(grouped.problems[0].what, HasSubstr("has a no-break space (U+"));
    std::vector<Problem> problems;
    WordReader words("KEY" + space + "1 2", problems);
    words.next();
    EXPECT_EQ(words.numbers(2, "number"), (std::vector<double>{1, 2}));
  }
  EXPECT_THAT(read("a\n1\xe2\x80\xaf"
                   "000\n")
                  .said,
              HasSubstr("(U+202F)"));
}

TEST(CsvTables, DecimalCommasAreBlamedOnlyWithoutPoints) {
  EXPECT_THAT(read("a, b\n1,5, 2\n").said, HasSubstr("use decimal points, not decimal commas"));
  EXPECT_THAT(read("a, b\n1.5, 2, 3\n").said,
              AllOf(HasSubstr("give one value per column"), Not(HasSubstr("decimal commas"))));
}

TEST(CsvTables, WhatSpreadsheetsWriteIsRead) {
  Read const r = read("\"a\",b [mm],\r\n\"1.5\",2,,\r\n");
  EXPECT_EQ(r.said, "");
  ASSERT_EQ(r.table.rows.size(), 1u);
  EXPECT_EQ(r.table.rows[0].values, (std::vector<double>{1.5, 2e-3}));
  EXPECT_THAT(read("a,b\n1,,2\n").said, HasSubstr("3 values")) << "control: an empty cell between others";
}

TEST(CsvTables, ColumnsOfTextMayEndEarly) {
  std::array<std::string_view, 1> const numeric{"x"};
  Read const r = read("name,x,note\n\"tower\",1,soft\nlink,2\n", numeric);
  EXPECT_EQ(r.said, "");
  ASSERT_EQ(r.table.rows.size(), 2u);
  EXPECT_EQ(r.table.rows[0].cells[0].text, "tower");
  EXPECT_EQ(r.table.rows[1].cells[2].text, "");
  EXPECT_THAT(read("name,x,note\nlink\n", numeric).said, HasSubstr("1 value, but the header has 3 columns"));
  EXPECT_THAT(read("name,x,note\nlink,two\n", numeric).said, HasSubstr("t.csv:2:6: error: 'two' is not a number"));
}

TEST(BinaryFiles, AreToldFromText) {
  using namespace std::string_literals;
  EXPECT_TRUE(is_binary("1 2\0 3"s));
  EXPECT_TRUE(is_binary("\x7f\x01\x02 abc"));
  EXPECT_FALSE(is_binary("1,2\t3\r\n\xc3\xa4\xc3\xb6"));
  EXPECT_FALSE(is_binary("one stray \x01 byte in a long line"));
  EXPECT_FALSE(is_binary(""));
}

// Decimal commas are blamed only for numbers without points.
TEST(NumberTables, SurplusNumbersUnderTheNames) {
  auto const said = [](char const* text) {
    return parse_numbers(text, NonFinite::kept, HeaderRow::allowed).problems.at(0).what;
  };
  EXPECT_THAT(said("time value\n0.1 2 3\n"), AllOf(HasSubstr("3 numbers"), Not(HasSubstr("comma"))));
  EXPECT_THAT(said("time value\n1 2 3\n"), HasSubstr("not with a comma"));
}

}  // namespace
}  // namespace straytrace::testing
