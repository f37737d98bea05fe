// SPDX-License-Identifier: BSD-3-Clause
// Numbers with errors, printed with the digits that the error allows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/results.hpp"

namespace straytrace {
namespace {

int decade(double x) { return int(std::floor(std::log10(x))); }

// value and sigma over 10^exponent, with `decimals` digits behind the point.
struct Rounded {
  std::string value, sigma;
  int exponent = 0, decimals = 0;
};

// Position of the last digit of the error: one digit, two when it begins with 1 (so that rounding costs below 20 %).
int last_place(double sigma) {
  int const top = decade(sigma);
  return sigma / std::pow(10.0, top) < 1.95 ? top - 1 : top;
}

Rounded rounded(double value, double sigma) {
  int const place = last_place(sigma);
  int top = decade(std::max(std::fabs(value), sigma));
  double const unit = std::pow(10.0, place);
  if (std::fabs(std::round(value / unit)) * unit >= std::pow(10.0, top + 1) * (1 - 1e-12)) ++top;
  Rounded r;
  r.exponent = top < -3 || top > 4 ? top : 0;
  r.decimals = std::max(0, r.exponent - place);
  double const scale = std::pow(10.0, r.exponent);
  // Plain numbers with an error above 10 are rounded in front of the point.
  double const step = place > 0 && r.exponent == 0 ? unit : 0;
  auto digits = [&](double x) {
    return fmt::format("{:.{}f}", step > 0 ? std::round(x / step) * step : x / scale, r.decimals);
  };
  r.value = digits(value);
  r.sigma = digits(sigma);
  return r;
}

std::string power(int exponent) { return exponent == 0 ? "" : fmt::format("e{:+03d}", exponent); }

std::string at_most(double value) {
  return value > 0 && std::isfinite(value) ? "at most " + two_digits(value, true) : with_error(value, 0);
}

// Of computed light beside sampled light that hardly counts: no digit worth printing carries the error.
bool tiny(double value, double sigma) { return sigma < 1e-7 * std::fabs(value); }

}  // namespace

std::string with_error(double value, double sigma) {
  if (!std::isfinite(value) || !std::isfinite(sigma) || sigma < 0) return "unresolved";
  if (sigma == 0) return fmt::format("{:.3g} (computed)", value);
  if (tiny(value, sigma)) return fmt::format("{:.4g} ± {:.1g}", value, sigma);
  Rounded const r = rounded(value, sigma);
  return fmt::format("{0}{2} ± {1}{2}", r.value, r.sigma, power(r.exponent));
}

std::string with_brackets(double value, double sigma) {
  if (!std::isfinite(value) || !std::isfinite(sigma) || sigma < 0) return "unresolved";
  if (sigma == 0) return fmt::format("{:.3g} computed", value);
  if (tiny(value, sigma)) return fmt::format("{:.4g}(<1)", value);
  Rounded const r = rounded(value, sigma);
  bool const below_one = r.decimals > 0 && r.sigma.starts_with("0.");
  std::string error = below_one ? r.sigma.substr(2) : r.sigma;
  if (below_one) error.erase(0, std::min(error.find_first_not_of('0'), error.size() - 1));
  return fmt::format("{}({}){}", r.value, error, power(r.exponent));
}

std::string two_digits(double value, bool up) {
  double const unit = std::pow(10.0, decade(value) - 1), digits = value / unit;  // 10 to 100
  constexpr double rounding = 1e-12;
  double const rounded = unit * (up ? std::ceil(digits * (1 - rounding)) : std::floor(digits * (1 + rounding)));
  return rounded < 1e-3 || rounded >= 1e5 ? fmt::format("{:.1e}", rounded) : fmt::format("{:g}", rounded);
}

std::string with_error(WithError const& x) { return x.at_most ? at_most(x.value) : with_error(x.value, x.sigma); }

std::string with_brackets(WithError const& x) { return x.at_most ? at_most(x.value) : with_brackets(x.value, x.sigma); }

std::string percent_text(double share, double sigma) {
  return sigma == 0 && std::isfinite(share) ? fmt::format("{:.3g}", 100 * share)
                                            : with_brackets(100 * share, 100 * sigma);
}

}  // namespace straytrace
