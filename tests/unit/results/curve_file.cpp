// SPDX-License-Identifier: BSD-3-Clause
// Curves as text, CSV, JSON; tests/tools/compare/test_signal.py tests HDF5 and pictures.
#include "results/curves/curve_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"
#include "spectra/files/series_file.hpp"

namespace straytrace {
namespace {

CurveSheet sheet() {
  CurveSheet s{"a title", {"a note"}, {"frequency", "Hz", {1, 2, 4}}, true, true, {}};
  s.y = {{"h mean", "1/sqrt(Hz)", {1e-22, NAN, 3e-22}}, {"limit", "1/sqrt(Hz)", {1, 2, 3}, "upper-limit"}};
  return s;
}

TEST(CurveFile, TextIsReadBack) {
  std::string const text = curve_format::text(sheet());
  EXPECT_EQ(text,
            "# a title\n# a note\n# frequency [Hz], h mean [1/sqrt(Hz)], limit [1/sqrt(Hz)]\n# frequency h_mean "
            "limit\n1 1e-22 "
            "1\n2 nan 2\n4 3e-22 3\n");
  std::string_view const name[] = {"h_mean"};
  EXPECT_EQ(parse_named_curve(text, name).value[2], 3e-22) << "budget --compare finds the column by its word";
  EXPECT_EQ(parse_numbers(text, NonFinite::kept, HeaderRow::allowed).unit[1], "1/sqrt(Hz)");
  EXPECT_EQ(parse_numbers(curve_format::csv(sheet()), NonFinite::kept, HeaderRow::allowed).name[1], "h mean");
}

TEST(CurveFile, JsonKeepsStylesAndWritesNull) {
  std::string const json = curve_format::json(sheet());
  EXPECT_NE(json.find("\"upper-limit\""), std::string::npos);
  EXPECT_NE(json.find("null"), std::string::npos);
}

TEST(CurveFile, IrregularAxesNameTheTextFile) {
  EXPECT_EQ(curve_format::regular_step({1, 2, 4}), 0);
  EXPECT_NEAR(curve_format::regular_step({1, 1.1, 1.2}), 0.1, 1e-12);
  std::vector<double> gps;
  for (int i = 0; i < 1000; ++i) gps.push_back(1234567890 + i / 100.0);
  EXPECT_EQ(curve_format::regular_step(gps), 0.01) << "to the last bit, in spite of the rounding of GPS times";
  try {
    curve_format::hdf5(sheet(), "out/h.hdf5");
    FAIL() << "an irregular axis was written";
  } catch (InputError const& e) {
    EXPECT_NE(std::string(e.what()).find("-o out/h.txt"), std::string::npos);
  }
  EXPECT_THROW(check_curve_ending("x.jpg"), InputError);
  EXPECT_NO_THROW(check_curve_ending("x.hdf5"));
}

}  // namespace
}  // namespace straytrace
