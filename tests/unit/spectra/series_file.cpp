// SPDX-License-Identifier: BSD-3-Clause
// Series from text and CSV. HDF5 is compared with h5py by tests/tools/compare/test_signal.py.
#include "spectra/files/series_file.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"

namespace straytrace {
namespace {

std::string message(std::function<void()> const& action) {
  try {
    action();
  } catch (InputError const& e) {
    return e.what();
  }
  return "no error was reported";
}

// Of the first problem of a table or curve; empty without one.
std::string error_of(auto const& read) { return read.problems.empty() ? "" : read.problems.front().what; }

TEST(SeriesFile, CsvWithUnitsAndComments) {
  std::string const text = "# a title, with commas\ntime [ms],\"x [um]\",y [V]\n0,1,5\n250,2,6 # aside\n500,3,7\n";
  TimeSeries const x = parse_series(text, "a.csv", {.channel = "x", .unit = "", .span = {}});
  EXPECT_EQ(x.name, "x");
  EXPECT_EQ(x.unit, "um");
  EXPECT_EQ(x.rate, 4);
  EXPECT_EQ(x.samples, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(parse_series(text, "a.csv", {.channel = "2", .unit = "", .span = {}}).unit, "V");
  EXPECT_EQ(parse_series(text, "a.csv", {.channel = "y", .unit = "count", .span = {}}).unit, "count");
}

TEST(SeriesFile, ByteOrderMarkIsNoName) {  // or the first row would be taken for names, and its sample lost
  TimeSeries const x = parse_series(
      "\xef\xbb\xbf"
      "0,1\n1,2\n2,3\n",
      "a.csv", {.channel = "", .unit = "m", .span = {}});
  EXPECT_EQ(x.samples, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(x.start, 0);
}

TEST(SeriesFile, NamesInCommentsOfText) {  // the comment with units goes before the one without
  NumberTable const t = parse_numbers("# made today by us\n# time [s], x [m/s^2]\n# time x\n0 1\n1 2\n",
                                      NonFinite::kept, HeaderRow::allowed);
  EXPECT_EQ(error_of(t), "");
  EXPECT_EQ(t.name, (std::vector<std::string>{"time", "x"}));
  EXPECT_EQ(t.unit, (std::vector<std::string>{"s", "m/s^2"}));
  NumberTable const blank = parse_numbers("# t [s] bench z [um]\n", NonFinite::kept, HeaderRow::allowed);
  EXPECT_EQ(error_of(blank), "no numbers in it");
}

TEST(SeriesFile, FewDigitsStillGiveTheRate) {  // 1/128 s printed to 0.1 ms; a gap of one sample is still found
  std::string text;
  for (int i = 0; i < 1000; ++i) text += std::to_string(1e6 + double(i) / 128).substr(0, 12) + " 1\n";
  TimeSeries const s = parse_series(text, "a.txt", {.channel = "", .unit = "m", .span = {}});
  EXPECT_EQ(s.rate, 128);
  text += std::to_string(1e6 + 1001.0 / 128) + " 1\n";
  EXPECT_NE(message([&] {
              parse_series(text, "a.txt", {.channel = "", .unit = "m", .span = {}});
            }).find("a.txt:1001: error: a gap"),
            std::string::npos);
  // outside of the span nobody minds
  EXPECT_EQ(parse_series(text, "a.txt", {.channel = "", .unit = "m", .span = {1e6, 1e6 + 5}}).samples.size(), 640u);
}

TEST(SeriesFile, DecimalCommasAreNamed) {
  for (char const* text : {"0,0 1,5\n0,1 2,5\n", "t;x\n0,0;1,5\n0,1;2,5\n", "0;1,5\n1;2,5\n"})
    EXPECT_NE(
        message([&] { parse_series(text, "a.csv", {.channel = "", .unit = "m", .span = {}}); }).find("decimal commas"),
        std::string::npos)
        << text;
  EXPECT_NE(
      error_of(parse_numbers("t,x\n0,0,1,5\n0,1,2,5\n", NonFinite::kept, HeaderRow::allowed)).find("not with a comma"),
      std::string::npos);
  EXPECT_EQ(parse_numbers("0,1\n1,2\n", NonFinite::kept, HeaderRow::allowed).column.size(), 2u)
      << "whole numbers between commas";
}

// A comma between digits is not a separator when the file uses another one: "10,5;1e-9" is not a row of three.
TEST(NumberTable, DecimalCommasAreErrorsForEveryReader) {
  std::string_view const names[] = {"h_mean"};
  for (std::string const line : {"10,5;1e-9", "10,5;1,2e-9", "10;1,5", "10,5\t1e-9", "10,5 1e-9 # 10,5", "-1,5 2"}) {
    std::string const text = line + "\n" + line + "\n";
    for (std::string const& error :
         {error_of(parse_numbers(text)), error_of(parse_numbers(text, NonFinite::kept, HeaderRow::allowed)),
          error_of(parse_curve(text)), error_of(parse_named_curve(text, names))})
      EXPECT_NE(error.find("decimal commas"), std::string::npos) << line << ": " << error;
  }
  for (std::string const line : {"10,5", "10, 5,1", "10,5 ,1", "10; 5; 1e-9", "10.5;1e-9", "1,2 # 3,4", "10 1e-9"})
    EXPECT_EQ(error_of(parse_numbers(line + "\n")), "") << "control: " << line << " is not meant";
}

// Each wrong row at its place, up to ten; before the first row of numbers one problem stands for all.
TEST(NumberTable, AllWrongRowsAreReported) {
  NumberTable const t = parse_numbers("0 1\n1 x\n2 2\n3\n4 4\n5 y\n");
  ASSERT_EQ(t.problems.size(), 3u);
  EXPECT_EQ(t.problems[0].place.line, 2u);
  EXPECT_EQ(t.problems[0].place.column, 3u);
  EXPECT_EQ(t.problems[0].what, "'x' is not a number (comments start with #)");
  EXPECT_EQ(t.problems[1].place.line, 4u);
  EXPECT_EQ(t.problems[1].what, "this line has 1 number, the lines before have 2");
  EXPECT_EQ(t.problems[2].place.line, 6u);
  EXPECT_EQ(t.rows(), 0u);
  std::string many = "0 1\n", words;
  for (int i = 0; i < 20; ++i) many += "1 x\n", words += "one two\n";
  EXPECT_EQ(parse_numbers(many).problems.size(), 10u);
  EXPECT_EQ(parse_numbers(words).problems.size(), 1u);
  EXPECT_TRUE(parse_numbers("0 1\n1 2\n").problems.empty());
  std::string const said =
      message([&] { parse_series("0 1\n1 x\n2 2\n3 y\n", "a.txt", {.channel = "", .unit = "m", .span = {}}); });
  EXPECT_NE(said.find("a.txt:2:3: error: 'x' is not a number"), std::string::npos) << said;
  EXPECT_NE(said.find("a.txt:4:3: error: 'y' is not a number"), std::string::npos) << said;
}

// Neither 0 nor infinity in their place.
TEST(NumberTable, NumbersOutsideTheRangeOfDoublePrecisionAreErrors) {
  for (NonFinite const words : {NonFinite::refused, NonFinite::kept})
    for (std::string const number : {"1e999", "1e-999", "-1e-999"})
      EXPECT_NE(error_of(parse_numbers("0 1\n1 " + number + "\n", words))
                    .find("'" + number + "' is outside the range of double precision, 1e-307 to 1e308"),
                std::string::npos);
  EXPECT_NE(error_of(parse_numbers("0 1\n1 1e-999x\n")).find("'1e-999x' is not a number"), std::string::npos);
  NumberTable const t = parse_numbers("0 0e-999\n1 1e-300\n");  // control
  ASSERT_EQ(error_of(t), "");
  EXPECT_EQ(t.column[1], (std::vector<double>{0, 1e-300}));
}

// In a line without any number the first word stands for all.
TEST(NumberTable, EveryWrongWordOfARow) {
  NumberTable const t = parse_numbers("0 1 2\nx 1 y\n3 4 5\na b c\n");
  ASSERT_EQ(t.problems.size(), 3u);
  EXPECT_EQ(t.problems[0].place.column, 1u);
  EXPECT_EQ(t.problems[1].place.column, 5u);
  EXPECT_EQ(t.problems[1].what, "'y' is not a number (comments start with #)");
  EXPECT_EQ(t.problems[2].place.line, 4u);
}

TEST(SeriesFile, StepsThatVaryStateTheMedian) {
  std::string const said =
      message([&] { parse_series("1 1\n10 2\n100 3\n", "a.txt", {.channel = "", .unit = "m", .span = {}}); });
  EXPECT_NE(said.find("a.txt:2: error: the times are not regular: a step of 9 s; the median step is 90 s"),
            std::string::npos)
      << said;
}

TEST(SeriesFile, ErrorsStateARemedy) {
  auto const error_text = [](std::string const& text, SeriesRequest const& wanted) {
    return message([&] { parse_series(text, "a.txt", wanted); });
  };
  EXPECT_EQ(error_text("0 1\n1 2\n", {}),
            "a.txt: error: column 2 has no unit\n  give --unit, or the option for the unit of this record, for "
            "example --unit um/s^2");
  EXPECT_EQ(error_text("0 1\n1 nan\n", {"", "m", {}}),
            "a.txt:2: error: column 2 is not a number at 1 s\n  choose a span without such samples with --gps A..B");
  EXPECT_EQ(error_text("0 1\n1 2\n2 3\n3 4\n", {"", "m", {7, 8}}).substr(0, 54),
            "error: 'a.txt' covers GPS 0..4, not the requested 7..8");
  EXPECT_EQ(error_text("5\n6\n", {"", "m", {}}),
            "a.txt: error: it has one column; a series also needs the times\n  write two columns: time in s, value");
  EXPECT_EQ(error_text("t x [um] \n", {}).substr(0, 14), "a.txt: error: ");
  EXPECT_EQ(error_text("0 1\n1e-310 2\n2e-310 3\n", {"", "m", {}}),
            "a.txt: error: its step is 1e-310 s\n  times are in seconds; state any other unit: time [ms]");
}

}  // namespace
}  // namespace straytrace
