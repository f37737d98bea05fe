// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/fringe_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/integration.hpp"

namespace straytrace::analysis {

TimeSeries as_strain(TimeSeries x) {
  auto const unit = parse_unit(x.unit);
  if (!unit || unit->dimension != dim::plain)
    throw InputError(fmt::format("--target: '{}' is in '{}', not a plain number", x.name, x.unit),
                     "give the unit with --target-unit");
  for (double& v : x.samples) v = to_si(v, *unit);
  x.unit = "1";
  return x;
}

namespace {

// Number of integrations to m or rad.
int integrations_of(TimeSeries const& x, bool& rotation, std::string const& option) {
  for (bool const angle : {false, true})
    if (auto const times = integrations_to(angle ? dim::angle : dim::length, x.unit)) {
      rotation = angle;
      return *times;
    }
  throw InputError(
      fmt::format("{}: '{}' is in '{}', which is not a unit of motion", option, x.name, x.unit),
      fmt::format("give m or rad, or one of them per s or s^2; set the unit with {}-unit, of counts the calibration: "
                  "what one is: \"2e-6 m/s^2\"",
                  option));
}

// Half the range of x_1 - ratio x_2.
double half_range(FringeRecords const& r, double ratio) {
  double low = infinity, high = -infinity;
  TimeSeries const& x = r.witnesses[0];
  bool const two = r.witnesses.size() > 1;
  std::vector<double> second;
  if (two) second = interpolated(r.witnesses[1], x.start, x.rate, x.samples.size());
  for (std::size_t i = 0; i < x.samples.size(); ++i) {
    double const u = x.samples[i] - (two ? ratio * second[i] : 0);
    low = std::min(low, u);
    high = std::max(high, u);
  }
  return (high - low) / 2;
}

double correlation_of(FringeFit const& fit, std::string const& a, std::string const& b) {
  auto const at = [&](std::string const& name) {
    return std::size_t(std::find(fit.names.begin(), fit.names.end(), name) - fit.names.begin());
  };
  std::size_t const n = fit.names.size();
  return at(a) < n && at(b) < n ? fit.correlation[at(a) * n + at(b)] : 0;
}

}  // namespace

void add_witness(FringeRecords& records, TimeSeries x, std::optional<double> corner, std::string const& option) {
  double unseen = 0;
  bool rotation = false;
  int const times = integrations_of(x, rotation, option);
  if (times == 0) {
    if (corner)
      throw InputError(fmt::format("--corner: '{}' is in {} and is not integrated", x.name, x.unit),
                       "remove the option");
    auto const unit = parse_unit(x.unit);
    for (double& v : x.samples) v = to_si(v, *unit);
  } else {
    if (!corner)
      throw InputError(
          fmt::format("{}: '{}' is in {} and needs a high pass for its integration", option, x.name, x.unit),
          "write --corner \"0.05 Hz\", below all motion that causes fringes");
    unseen = rms_below(x, times, *corner);
    x = settled(integrated(x, times, *corner), *corner);
  }
  x.unit = rotation ? "rad" : "m";
  records.witnesses.push_back(std::move(x));
  records.unseen.push_back(unseen);
}

bool is_rotation(FringeRecords const& r) { return r.witnesses.front().unit == "rad"; }
Dimension multiplicity_dimension(FringeRecords const& r) { return is_rotation(r) ? dim::length : dim::plain; }
std::string multiplicity_unit(FringeRecords const& r) { return is_rotation(r) ? "m" : ""; }

SearchRange usual_multiplicity(FringeRecords const& r, FringeFitSettings const& s) {
  double const single = 2 * fastest_motion(r, std::max(std::fabs(s.ratio.low), std::fabs(s.ratio.high))) / s.wavelength;
  double const most = 0.99 * r.target.rate / (2.2 * single);
  return {0.5, most > 1 ? std::min(6.0, most) : 6.0};
}

Fitted effective_peak(FringeRecords const& records, FringeFit const& fit, std::size_t path) {
  Fitted const w = fit.paths[path].multiplicity, ratio = fit.ratio;
  double const half = half_range(records, ratio.value);
  double const step = 1e-3 * std::max(1.0, std::fabs(ratio.value));
  double const of_ratio =
      (half_range(records, ratio.value + step) - half_range(records, ratio.value - step)) / (2 * step);
  double const from_w = half * w.sigma * (w.value < 0 ? -1 : 1),
               from_ratio = std::fabs(w.value) * of_ratio * ratio.sigma;
  double const both = 2 * correlation_of(fit, fmt::format("multiplicity {}", path + 1), "ratio") * from_w * from_ratio;
  return {std::fabs(w.value) * half, std::sqrt(std::max(0.0, from_w * from_w + from_ratio * from_ratio + both))};
}

double unseen_phase(FringeRecords const& records, FringeFit const& fit, double wavelength, std::size_t path) {
  double const first = records.unseen[0], second = records.unseen.size() > 1 ? fit.ratio.value * records.unseen[1] : 0;
  return 4 * pi / wavelength * std::fabs(fit.paths[path].multiplicity.value) * std::hypot(first, second);
}

}  // namespace straytrace::analysis
