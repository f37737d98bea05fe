// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/coupling_projection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/units/quantity.hpp"
#include "spectra/integration.hpp"

namespace straytrace {
namespace {

void refuse_wrapped(CouplingFunction const& c, double low, double high) {
  std::size_t count = 0;
  CouplingPoint const* first = nullptr;
  for (CouplingPoint const& p : c.points)
    if (p.flag == CouplingFlag::not_linear && p.hz >= low && p.hz <= high && ++count == 1) first = &p;
  if (count > 0)
    throw InputError(
        fmt::format("the coupling of '{}' is not linear at {} frequencies, the first of them {:g} Hz: what it makes "
                    "does not grow with the level of the witness",
                    c.witness, count, first->hz),
        "project the motion in the time domain: straytrace project RUN --body BODY --channel FILE::CHANNEL");
}

bool has_factor(CouplingPoint const& p) {
  return p.flag == CouplingFlag::measured || p.flag == CouplingFlag::upper_limit;
}

// The coupling at a frequency between two points.
CouplingPoint between(CouplingPoint const& a, CouplingPoint const& b, double hz) {
  CouplingPoint p = a;
  p.hz = hz;
  if (!has_factor(a) || !has_factor(b)) {
    p.factor = p.sigma = not_a_number;
    p.flag = std::max(a.flag, b.flag);
    return p;
  }
  double const share = std::log(hz / a.hz) / std::log(b.hz / a.hz);
  p.factor = std::exp((1 - share) * std::log(a.factor) + share * std::log(b.factor));
  p.flag = std::max(a.flag, b.flag);
  p.sigma = p.factor * std::max(a.sigma / a.factor, b.sigma / b.factor);
  return p;
}

CouplingPoint at(CouplingFunction const& c, double hz) {
  auto const next = std::lower_bound(c.points.begin(), c.points.end(), hz,
                                     [](CouplingPoint const& p, double f) { return p.hz < f * (1 - 1e-9); });
  if (next == c.points.end()) return {};
  if (next->hz <= hz * (1 + 1e-9)) return *next;
  if (next == c.points.begin()) return {};
  return between(*(next - 1), *next, hz);
}

struct Conversion {
  double scale = 1;
  int integrations = 0;  // an ASD of m/s^2 over (2 pi f)^2 is one of m
};

// What takes the unit of the spectrum to that of the coupling's witness.
Conversion conversion(CouplingFunction const& c, QuietWitness const& w) {
  auto const have = parse_unit(w.unit), want = parse_unit(c.witness_unit);
  for (int n = 0; have && want && n <= 2; ++n)
    if (auto const reached = times(have->dimension, *power_of(dim::time, n)); reached && *reached == want->dimension)
      return {have->si / want->si, n};
  throw InputError(fmt::format("the coupling is per {}, and the witness is in {}", c.witness_unit, w.unit),
                   "give the witness in the unit of the coupling, or per s or s^2 of it; of counts with what one is: "
                   "--unit \"2e-6 m/s^2\"");
}

}  // namespace

ProjectedCoupling project_coupling(CouplingFunction const& c, QuietWitness const& w) {
  Conversion const to = conversion(c, w);
  ProjectedCoupling out{c.witness, c.target, {}};
  if (w.hz.empty()) return out;
  refuse_wrapped(c, w.hz.front(), w.hz.back());
  for (std::size_t k = 0; k < w.hz.size(); ++k) {
    CouplingPoint const p = w.hz[k] > 0 ? at(c, w.hz[k]) : CouplingPoint{};
    ProjectedPoint q{w.hz[k], not_a_number, not_a_number, p.flag};
    if (has_factor(p)) q.asd = p.factor * integrated_asd(w.asd[k], w.hz[k], to.integrations) * to.scale;
    if (p.flag == CouplingFlag::measured)
      q.sigma = q.asd * std::hypot(p.sigma / p.factor, w.asd[k] > 0 ? w.sigma[k] / w.asd[k] : 0);
    out.points.push_back(q);
  }
  return out;
}

}  // namespace straytrace
