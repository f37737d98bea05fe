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
  EXPECT_EQ(t.error, "");
  EXPECT_EQ(t.name, (std::vector<std::string>{"time", "x"}));
  EXPECT_EQ(t.unit, (std::vector<std::string>{"s", "m/s^2"}));
  NumberTable const blank = parse_numbers("# t [s] bench z [um]\n", NonFinite::kept, HeaderRow::allowed);
  EXPECT_EQ(blank.error, "no numbers in it");
}

TEST(SeriesFile, FewDigitsStillGiveTheRate) {  // 1/128 s printed to 0.1 ms; a gap of one sample is still found
  std::string text;
  for (int i = 0; i < 1000; ++i) text += std::to_string(1e6 + double(i) / 128).substr(0, 12) + " 1\n";
  TimeSeries const s = parse_series(text, "a.txt", {.channel = "", .unit = "m", .span = {}});
  EXPECT_EQ(s.rate, 128);
  text += std::to_string(1e6 + 1001.0 / 128) + " 1\n";
  EXPECT_NE(
      message([&] { parse_series(text, "a.txt", {.channel = "", .unit = "m", .span = {}}); }).find("line 1001: a gap"),
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
      parse_numbers("t,x\n0,0,1,5\n0,1,2,5\n", NonFinite::kept, HeaderRow::allowed).error.find("not with a comma"),
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
         {parse_numbers(text).error, parse_numbers(text, NonFinite::kept, HeaderRow::allowed).error,
          parse_curve(text).error, parse_named_curve(text, names).error})
      EXPECT_NE(error.find("decimal commas"), std::string::npos) << line << ": " << error;
  }
  for (std::string const line : {"10,5", "10, 5,1", "10,5 ,1", "10; 5; 1e-9", "10.5;1e-9", "1,2 # 3,4", "10 1e-9"})
    EXPECT_EQ(parse_numbers(line + "\n").error, "") << "control: " << line << " is not meant";
}

TEST(SeriesFile, ErrorsStateARemedy) {
  auto const error_text = [](std::string const& text, SeriesRequest const& wanted) {
    return message([&] { parse_series(text, "a.txt", wanted); });
  };
  EXPECT_EQ(error_text("0 1\n1 2\n", {}),
            "a.txt: error: column 2 has no unit\n  give --unit, or the option for the unit of this record, for "
            "example --unit um/s^2");
  EXPECT_EQ(
      error_text("0 1\n1 nan\n", {"", "m", {}}),
      "a.txt: error: line 2: column 2 is not a number at 1 s\n  choose a span without such samples with --gps A..B");
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
