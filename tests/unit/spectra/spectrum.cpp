// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "spectra/curve.hpp"

namespace straytrace {
namespace {

TEST(Spectrum, PowerLawsIntegrateExactly) {
  for (double n : {-4.0, -1.0, -1 + 1e-10, -0.5, 0.0, 2.0}) {
    Spectrum const s({0.1, 100}, {std::pow(0.1, n), std::pow(100, n)});
    double const exact =
        std::fabs(n + 1) < 1e-6 ? std::log(20 / 0.3) : (std::pow(20, n + 1) - std::pow(0.3, n + 1)) / (n + 1);
    EXPECT_NEAR(s.power(0.3, 20) / exact, 1, 1e-9) << n;
    EXPECT_NEAR(s.at(7) / std::pow(7, n), 1, 1e-12) << n;
  }
}

TEST(Spectrum, BinsAddUpToTheTotal) {
  Spectrum const s = peterson(GroundModel::typical, 0.01, 100);
  double sum = 0;
  for (double f = 0.001; f < 200; f *= 1.37) sum += s.power(f, f * 1.37);
  EXPECT_NEAR(sum / s.total(), 1, 1e-12);
  EXPECT_EQ(s.power(200, 300), 0);
  EXPECT_EQ(s.at(0.009), 0);
  EXPECT_EQ(s.power(3, 3), 0);
}

TEST(Spectrum, RateOfALine) {
  Spectrum const s = gaussian_line(3, 0.01, 2e-6);
  EXPECT_NEAR(std::sqrt(s.total()) / 2e-6, 1, 1e-12);
  EXPECT_NEAR(std::sqrt(s.rate_power(infinity)) / (2 * pi * 3 * 2e-6), 1, 1e-4);
}

TEST(Spectrum, SumsAreExactAndScale) {
  Spectrum const a({1, 10}, {1, 1e-4}), b({5, 50}, {2, 2}), sum = a + b;
  for (double f : {2.0, 5.0, 7.0, 10.0, 30.0}) EXPECT_DOUBLE_EQ(sum.at(f), a.at(f) + b.at(f));
  EXPECT_DOUBLE_EQ(sum.total(), a.total() + b.total());
  EXPECT_DOUBLE_EQ(sum.scaled(3).total(), 3 * sum.total());
  EXPECT_EQ(sum.lowest(), 1);
  EXPECT_EQ(sum.highest(), 50);
  EXPECT_EQ(sum.hz(), (std::vector<double>{1, 5, 10, 50}));
  EXPECT_EQ(Spectrum().total(), 0);
  EXPECT_EQ(Spectrum().at(1), 0);
}

TEST(Spectrum, ZeroNeighbourIsAStraightLine) {
  Spectrum const s({1, 2, 3}, {4, 0, 2});
  EXPECT_DOUBLE_EQ(s.at(1.5), 2);
  EXPECT_DOUBLE_EQ(s.total(), 2 + 1);
  EXPECT_NEAR(s.rate_power(2), 4 * pi * pi * (4 * (2 * 7.0 / 3 - 15.0 / 4)), 1e-9);  // integral of f^2 (8 - 4 f)
}

TEST(Spectrum, ShapesAreComparedUpToAFactor) {
  Spectrum const s = peterson(GroundModel::low, 0.05, 100);
  EXPECT_TRUE(same_shape(s, s.scaled(0.49)));
  EXPECT_TRUE(same_shape(s + s, s.scaled(2)));
  EXPECT_FALSE(same_shape(s, peterson(GroundModel::high, 0.05, 100)));
  EXPECT_FALSE(same_shape(s, peterson(GroundModel::low, 0.05, 90)));
  EXPECT_FALSE(same_shape(Spectrum({1, 10}, {1, 1}), Spectrum({1, 10}, {1, 1.0001})));
}

TEST(Shapes, PowerLawOfTheAsd) {
  Spectrum const s = power_law_asd(1e-6, 1, -2, 0.05, 1000);
  EXPECT_NEAR(std::sqrt(s.at(10)) / 1e-8, 1, 1e-12);
  EXPECT_NEAR(s.total() / (1e-12 / 3 * (std::pow(0.05, -3) - 1e-9)), 1, 1e-12);
}

TEST(Shapes, ResonanceKeepsItsPower) {  // white motion through a mode: pi/2 f0 Q (1 + 1/Q^2) of it, closed form
  for (double q : {5.0, 1000.0}) {
    Spectrum const s = through_resonance(Spectrum({0.001, 10000}, {1, 1}), 1.14, q);
    EXPECT_NEAR(s.total() / (pi / 2 * 1.14 * q * (1 + 1 / (q * q))), 1, 5e-3) << q;
    EXPECT_NEAR(s.at(1.14) / (1 + q * q), 1, 1e-9);
    EXPECT_NEAR(s.at(100) / transmissibility(100, 1.14, q), 1, 1e-3);
  }
}

// Of the first problem of a curve; empty without one.
std::string error_of(Curve const& read) { return read.problems.empty() ? "" : read.problems.front().what; }

TEST(TextTable, ReadsColumns) {
  Curve const c = parse_curve("# Hz, m\n0 5\n1\t2 7\n10, 3e-2; 8 % end\n\n+20 1E-3 9\n", 1, 2);
  EXPECT_NE(error_of(c), "");  // the first row has two columns, the others three
  Curve const d = parse_curve("# Hz, m\r\n0 5 1\r\n1\t2 7\r\n10, 3e-2; 8 % end\n\n+20 1E-3 9", 1, 3);
  ASSERT_EQ(error_of(d), "");
  EXPECT_EQ(d.hz, (std::vector<double>{1, 10, 20}));
  EXPECT_EQ(d.value, (std::vector<double>{7, 8, 9}));
}

// Of many columns the named one, not the second. Control: without its name nothing is guessed.
TEST(TextTable, TakesTheNamedColumnOfMany) {
  std::string const rows = "1 5 nan 7\n10 5 8 nan\n";
  Curve const total =
      parse_named_curve("# a b c d\n# Hz Quantum_strain dark_strain total_strain\n" + rows, strain_columns);
  ASSERT_EQ(error_of(total), "");
  EXPECT_EQ(total.value[0], 7);
  EXPECT_TRUE(std::isnan(total.value[1]));
  EXPECT_EQ(parse_named_curve("# frequency_Hz h_mean sigma\n1 2 3\n4 5 nan\n", strain_columns).value,
            (std::vector<double>{2, 5}));
  EXPECT_EQ(parse_named_curve("# Hz much\n1 2\n4 5\n", strain_columns).value, (std::vector<double>{2, 5}));
  std::string const other = error_of(parse_named_curve("# Hz Quantum_strain dark_strain sum\n" + rows, strain_columns));
  EXPECT_EQ(other, "it has 4 columns (Hz, Quantum_strain, dark_strain, sum), and none is named total_strain or h_mean");
  EXPECT_NE(error_of(parse_named_curve(rows, strain_columns)).find("4 columns without names"), std::string::npos);
}

TEST(TextTable, ErrorsAreExplained) {
  EXPECT_EQ(parse_curve("1 2\nf x").problems.at(0).place.line, 2u);
  EXPECT_EQ(error_of(parse_curve("1 2\nf x")), "'f' is not a number (comments start with #)");
  EXPECT_NE(error_of(parse_curve("1 2\n1 3")).find("does not increase"), std::string::npos);
  EXPECT_NE(error_of(parse_curve("1 2\n2 -3")).find("negative"), std::string::npos);
  EXPECT_NE(error_of(parse_curve("1 2\n2 3", 1, 3)).find("2 columns"), std::string::npos);
  EXPECT_NE(error_of(parse_curve("")), "");
  EXPECT_NE(error_of(parse_curve("1 nan\n2 3")), "");
}

}  // namespace
}  // namespace straytrace
