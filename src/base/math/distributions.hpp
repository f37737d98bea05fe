// SPDX-License-Identifier: BSD-3-Clause
// Distributions of probability and the functions that they need, by Boost, compiled once: each takes a second or more
// in every file that uses it. `cdf` is the probability up to x, `tail` that beyond; p lies between 0 and 1.
#pragma once

#include "base/namespaces.hpp"

namespace straytrace {

double normal_cdf(double x);
double normal_quantile(double p);
double normal_tail_quantile(double p);  // the x beyond which p lies, precise for a small p

// `degrees` of freedom: above 0, any number.
double chi_squared_cdf(double degrees, double x);
double chi_squared_tail(double degrees, double x);
double chi_squared_quantile(double degrees, double p);
double student_quantile(double degrees, double p);
// Of the ratio of two independent chi-squared variables, each over its degrees of freedom.
double fisher_cdf(double above, double below, double ratio);
double fisher_tail(double above, double below, double ratio);

// Sum of squares of normal variables of unit variance whose squared means add up to `off_centre`.
double off_centre_chi_squared_tail(double degrees, double off_centre, double x);
// The off_centre of which the cdf at x is p.
double off_centre_of_chi_squared(double degrees, double x, double p);

double bessel_j(int order, double x);
double gamma_q(double a, double x);       // upper incomplete gamma function over gamma(a)
double exponential_integral_1(double x);  // integral of exp(-t)/t from x > 0 to infinity
double inverse_erf(double x);

}  // namespace straytrace
