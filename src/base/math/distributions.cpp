// SPDX-License-Identifier: BSD-3-Clause
#include "base/math/distributions.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/expint.hpp>
#include <boost/math/special_functions/gamma.hpp>

namespace straytrace {

namespace bm = boost::math;

double normal_cdf(double x) { return bm::cdf(bm::normal(), x); }
double normal_quantile(double p) { return bm::quantile(bm::normal(), p); }
double normal_tail_quantile(double p) { return bm::quantile(bm::complement(bm::normal(), p)); }

double chi_squared_cdf(double degrees, double x) { return bm::cdf(bm::chi_squared(degrees), x); }
double chi_squared_tail(double degrees, double x) { return bm::cdf(bm::complement(bm::chi_squared(degrees), x)); }
double chi_squared_quantile(double degrees, double p) { return bm::quantile(bm::chi_squared(degrees), p); }
double student_quantile(double degrees, double p) { return bm::quantile(bm::students_t(degrees), p); }
double fisher_cdf(double above, double below, double ratio) { return bm::cdf(bm::fisher_f(above, below), ratio); }
double fisher_tail(double above, double below, double ratio) {
  return bm::cdf(bm::complement(bm::fisher_f(above, below), ratio));
}

double off_centre_chi_squared_tail(double degrees, double off_centre, double x) {
  return bm::cdf(bm::complement(bm::non_central_chi_squared(degrees, off_centre), x));
}
double off_centre_of_chi_squared(double degrees, double x, double p) {
  return bm::non_central_chi_squared::find_non_centrality(degrees, x, p);
}

double bessel_j(int order, double x) { return bm::cyl_bessel_j(order, x); }
double gamma_q(double a, double x) { return bm::gamma_q(a, x); }
double exponential_integral_1(double x) { return bm::expint(1, x); }
double inverse_erf(double x) { return bm::erf_inv(x); }

}  // namespace straytrace
