// SPDX-License-Identifier: BSD-3-Clause
#include "base/math/distributions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace straytrace::testing::distributions {
namespace {

// Values of tables (Abramowitz and Stegun, chapters 5, 9 and 26) and closed forms. The control of each: the argument
// that would be confused with it gives another number.
TEST(Distributions, QuantilesAreThoseOfTables) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
  EXPECT_NEAR(normal_tail_quantile(1e-20), 9.262340089798408, 1e-12);
  EXPECT_NEAR(normal_cdf(normal_quantile(0.3)), 0.3, 1e-15);
  EXPECT_NEAR(chi_squared_quantile(1, 0.95), 3.841458820694124, 1e-13);
  double const p = 0.975;  // Student's t of two degrees of freedom has the quantile (2p - 1)/sqrt(2p(1 - p))
  EXPECT_NEAR(student_quantile(2, p), (2 * p - 1) / std::sqrt(2 * p * (1 - p)), 1e-13);
  EXPECT_GT(student_quantile(2, p), normal_quantile(p) + 2) << "control";
}

TEST(Distributions, TailsAreClosedForms) {
  for (double const x : {0.1, 2.0, 30.0}) {
    EXPECT_NEAR(chi_squared_tail(2, x), std::exp(-x / 2), 1e-15);
    EXPECT_NEAR(chi_squared_cdf(2, x), -std::expm1(-x / 2), 1e-15);
    EXPECT_NEAR(gamma_q(1, x), std::exp(-x), 1e-15);
    EXPECT_NEAR(fisher_tail(2, 6, x), std::pow(1 + x / 3, -3), 1e-14);
    EXPECT_NEAR(fisher_cdf(2, 6, x) + fisher_tail(2, 6, x), 1, 1e-15);
    EXPECT_NEAR(off_centre_chi_squared_tail(2, 0, x), std::exp(-x / 2), 1e-14);
  }
  EXPECT_GT(std::fabs(fisher_tail(6, 2, 2) - fisher_tail(2, 6, 2)), 0.1) << "control: degrees of freedom exchanged";
}

TEST(Distributions, TheOffCentreIsFoundAgain) {
  double const off_centre = off_centre_of_chi_squared(4, 30, 0.05);
  EXPECT_NEAR(off_centre_chi_squared_tail(4, off_centre, 30), 0.95, 1e-9);
  EXPECT_LT(off_centre_chi_squared_tail(4, 0.5 * off_centre, 30), 0.5) << "control";
}

TEST(Distributions, FunctionsAreThoseOfTables) {
  EXPECT_NEAR(bessel_j(0, 2.404825557695773), 0, 1e-15);
  EXPECT_NEAR(bessel_j(1, 1), 0.4400505857449335, 1e-15);
  EXPECT_NEAR(exponential_integral_1(1), 0.21938393439552029, 1e-15);
  EXPECT_NEAR(inverse_erf(std::erf(0.7)), 0.7, 1e-15);
  EXPECT_GT(std::fabs(bessel_j(2, 1) - bessel_j(1, 1)), 0.3) << "control: another order";
}

}  // namespace
}  // namespace straytrace::testing::distributions
