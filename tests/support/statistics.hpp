// SPDX-License-Identifier: BSD-3-Clause
// How a Monte-Carlo number is compared with theory (docs/develop/testing.md).
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "support/recorded.hpp"

namespace straytrace::testing {

struct SampleMean {
  double mean, std_error;
  long long n;
};

inline SampleMean scaled(SampleMean s, double factor) {
  return {s.mean * factor, s.std_error * std::fabs(factor), s.n};
}
inline SampleMean difference(SampleMean a, SampleMean b) {  // of independent samples
  return {a.mean - b.mean, std::hypot(a.std_error, b.std_error), a.n + b.n};
}

// A comparison that can neither flake nor sleep.
//   z_false = 5: correct code misses by chance once in 1.7 million (the seed is fixed anyway);
//   z_power = 3: code that is wrong by `smallest_effect` is found 99.87 % of the time, or the test fails as blind.
inline void expect_mean(char const* what, SampleMean s, double expected, double smallest_effect, double z_false = 5,
                        double z_power = 3) {
  ASSERT_TRUE(std::isfinite(s.mean) && std::isfinite(s.std_error)) << what << ": not finite";
  ASSERT_GT(s.std_error, 0) << what << ": zero spread, so this compares a constant";
  double const need = smallest_effect / (z_false + z_power);
  EXPECT_TRUE(s.std_error <= need) << what << ": blind. Needs about "
                                   << std::ceil(double(s.n) * std::pow(s.std_error / need, 2))
                                   << " samples to see an effect of " << smallest_effect;
  bool const agrees = std::abs(s.mean - expected) <= z_false * s.std_error;
  EXPECT_TRUE(agrees) << what << ": " << s.mean << " +- " << s.std_error << ", expected " << expected;
  if (agrees) record_mean(what, s.mean, s.std_error, expected);
}

// For a closed form that holds to `accuracy`, in the unit of the number: expect_mean() accepts this much more than 5
// standard errors.
inline SampleMean within(SampleMean s, double accuracy) { return {s.mean, s.std_error + std::abs(accuracy) / 5, s.n}; }

// The negative control of expect_mean: a wrong trace against the right number, or a right trace against a wrong one.
inline void expect_rejected(char const* what, SampleMean s, double expected, double z_false = 5) {
  ASSERT_TRUE(std::isfinite(s.mean) && s.std_error > 0) << what;
  EXPECT_TRUE(std::abs(s.mean - expected) > z_false * s.std_error)
      << what << ": the negative control passed, " << s.mean << " +- " << s.std_error << " against " << expected;
}

// Mean of independent values.
class Sampler {
 public:
  void add(double x) {
    ++n_;
    double const step = x - mean_;
    mean_ += step / double(n_);
    square_ += step * (x - mean_);
  }
  SampleMean mean() const { return {mean_, std::sqrt(square_ / (double(n_) * double(n_ - 1))), n_}; }

 private:
  long long n_ = 0;
  double mean_ = 0, square_ = 0;
};

}  // namespace straytrace::testing
