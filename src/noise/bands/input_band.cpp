// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/input_band.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace straytrace::noise {
namespace {

using Doubles = std::vector<double>;

Doubles psd_of(NoiseTrace const& t, double factor) {
  Doubles psd;
  for (double const h : t.asd) psd.push_back(factor * h * h);
  return psd;
}

// Sum of the PSDs of the routes, each times its own factor; unresolved ones with their observed part, as in the total.
template <class Factor>
Doubles total_psd(NoiseBudget const& b, Factor const& factor) {
  Doubles sum(b.grid.size());
  for (std::size_t r = 0; r < b.routes.size(); ++r) {
    double const f = factor(r);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += f * b.routes[r].asd[i] * b.routes[r].asd[i];
  }
  return sum;
}

double band_power(FrequencyGrid const& grid, Doubles const& psd) {
  double sum = 0;
  for (std::size_t i = 0; i < psd.size(); ++i) sum += psd[i] * grid.width(i);
  return sum;
}

// Logarithms of factors on the PSD, per bin.
class Spread {
 public:
  explicit Spread(Doubles mean) : mean_(std::move(mean)) {}

  // Moves the range; the least and largest factor on the ASD go to the source.
  void range(Doubles const& low, Doubles const& high, InputSource& source) {
    note(low, source);
    note(high, source);
  }
  // One standard deviation either way; both may lie on one side where fringes wrap.
  void sigma(Doubles const& down, Doubles const& up, InputSource& source) {
    squares_low_.resize(mean_.size());
    squares_high_.resize(mean_.size());
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      double const a = log_ratio(down, i), b = log_ratio(up, i);
      squares_low_[i] += std::pow(std::min({a, b, 0.0}), 2);
      squares_high_[i] += std::pow(std::max({a, b, 0.0}), 2);
    }
    range(down, up, source);
  }
  // ASD at the given end of all brackets, with the standard deviations below (-1) or above (+1) it.
  Doubles band(Doubles psd, int towards) const {
    Doubles const& squares = towards < 0 ? squares_low_ : squares_high_;
    for (std::size_t i = 0; i < psd.size(); ++i)
      psd[i] = std::sqrt(psd[i] * (squares.empty() ? 1 : std::exp(towards * std::sqrt(squares[i]))));
    return psd;
  }
  Doubles const& mean() const { return mean_; }

 private:
  double log_ratio(Doubles const& psd, std::size_t i) const {
    return psd[i] > 0 && mean_[i] > 0 ? std::log(psd[i] / mean_[i]) : 0;
  }
  void note(Doubles const& psd, InputSource& source) const {
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      if (!(mean_[i] > 0) || std::isnan(psd[i])) continue;
      source.low = std::min(source.low, std::sqrt(psd[i] / mean_[i]));
      source.high = std::max(source.high, std::sqrt(psd[i] / mean_[i]));
    }
  }
  Doubles mean_, squares_low_, squares_high_;
};

bool stated(MaterialSpread const& m) { return m.low < 1 || m.high > 1 || m.factor > 1; }

std::string words(MaterialSpread const& m) {
  std::string text;
  if (m.low < 1 || m.high > 1) text = fmt::format("bracket: x {:.3g} to {:.3g}", m.low, m.high);
  if (m.factor > 1) text += fmt::format("{}one sigma: factor {:.3g}", text.empty() ? "" : ", ", m.factor);
  return m.status.empty() ? text : fmt::format("{} ({})", text, m.status);
}

struct Materials {
  std::vector<MaterialSpread> const& list;
  CouplingTable const& table;
  double factor(std::size_t m, std::size_t route, double ratio) const {
    return coupling_factor(list[m], table.classes[route], ratio);
  }
  bool known(std::size_t m, std::size_t route) const {
    return !stated(list[m]) || composition_known(list[m], table.classes[route]);
  }
};

double share_of(NoiseBudget const& b, Materials const& all, std::size_t m, double total) {
  Doubles const through = total_psd(b, [&](std::size_t r) { return all.factor(m, r, 2) != 1 ? 1.0 : 0.0; });
  return total > 0 ? band_power(b.grid, through) / total : 0;
}

// Bins where the effect of the material is not known.
std::vector<bool> unknown_bins(NoiseBudget const& b, Materials const& all, std::size_t m) {
  Doubles const mixed = total_psd(b, [&](std::size_t r) { return all.known(m, r) ? 0.0 : 1.0; }),
                total = total_psd(b, [](std::size_t) { return 1.0; });
  std::vector<bool> unknown;
  for (std::size_t i = 0; i < total.size(); ++i) unknown.push_back(mixed[i] > composition_limit * total[i]);
  return unknown;
}

bool none(std::vector<bool> const& bins) { return std::ranges::find(bins, true) == bins.end(); }

Doubles without(Doubles curve, std::vector<bool> const& bins) {
  for (std::size_t i = 0; i < curve.size(); ++i)
    if (bins[i]) curve[i] = not_a_number;
  return curve;
}

// Of the total and of each route alone.
struct Spreads {
  Spread total;
  std::vector<Spread> routes;
};

void add_materials(NoiseBudget& b, Materials const& all, Spreads& spreads) {
  Spread& spread = spreads.total;
  double const total = band_power(b.grid, spread.mean());
  for (std::size_t m = 0; m < all.list.size(); ++m) {
    MaterialSpread const& one = all.list[m];
    InputSource of_route;
    for (std::size_t r = 0; one.factor > 1 && r < b.routes.size(); ++r)
      spreads.routes[r].sigma(psd_of(b.routes[r], all.factor(m, r, 1 / one.factor)),
                              psd_of(b.routes[r], all.factor(m, r, one.factor)), of_route);
    std::vector<bool> const unknown = unknown_bins(b, all, m);
    double const share = none(unknown) ? share_of(b, all, m, total) : not_a_number;
    if (share == 0) continue;  // the route carries no noise
    if (!stated(one)) {
      b.bands.taken_as_exact.push_back(
          fmt::format("material {}{}", one.name, one.status.empty() ? "" : " (" + one.status + ")"));
      continue;
    }
    InputSource source{"material " + one.name, words(one), 1, 1, share};
    auto const scaled = [&](double ratio) {
      return without(total_psd(b, [&](std::size_t r) { return all.factor(m, r, ratio); }), unknown);
    };
    spread.range(scaled(one.low), scaled(one.high), source);
    if (one.factor > 1) spread.sigma(scaled(1 / one.factor), scaled(one.factor), source);
    if (std::ranges::find(unknown, false) == unknown.end()) source.low = source.high = not_a_number;
    b.bands.sources.push_back(std::move(source));
  }
}

// Inputs that move the same bodies come from one measurement and are varied together.
using Cause = std::set<std::uint32_t>;
std::map<Cause, std::vector<std::size_t>> causes(MotionSet const& motion) {
  std::map<Cause, std::vector<std::size_t>> all;
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) {
    Cause bodies;
    for (Gain const& g : motion.inputs[i].gains) bodies.insert(g.body.value);
    all[bodies].push_back(i);
  }
  return all;
}

// `towards` +1, -1: ASDs times and over their factor of uncertainty.
MotionSet moved(MotionSet const& motion, std::vector<std::size_t> const& inputs, int towards) {
  MotionSet out = motion;
  for (std::size_t const i : inputs) {
    double const factor = std::pow(motion.inputs[i].uncertainty, towards);
    for (Gain& g : out.inputs[i].gains) g.value *= factor;
  }
  return out;
}

std::string names_of(MotionSet const& motion, Cause const& bodies) {
  std::string text;
  for (std::uint32_t const b : bodies) text += (text.empty() ? "motion of " : ", ") + motion.bodies[b];
  return text;
}

struct Projection {
  CouplingTable const& table;
  Interferometer const& ifo;
  NoiseSettings const& settings;
};

void add_motion(NoiseBudget& b, MotionSet const& motion, Projection const& projection, Spreads& spreads) {
  for (auto const& [bodies, inputs] : causes(motion)) {
    double factor = 1;
    for (std::size_t const i : inputs) factor = std::max(factor, motion.inputs[i].uncertainty);
    if (factor == 1) {
      b.bands.taken_as_exact.push_back(names_of(motion, bodies));
      continue;
    }
    Doubles ends[2];
    std::vector<Doubles> of_routes[2];
    for (int const towards : {-1, 1}) {
      NoiseBudget other =
          project_noise(projection.table, moved(motion, inputs, towards), projection.ifo, projection.settings);
      ends[towards > 0] = total_psd(other, [](std::size_t) { return 1.0; });
      for (NoiseTrace const& t : other.routes) of_routes[towards > 0].push_back(psd_of(t, 1));
    }
    InputSource source{names_of(motion, bodies), fmt::format("one sigma: factor {:.3g} on the ASD", factor), 1, 1, 0};
    spreads.total.sigma(ends[0], ends[1], source);
    InputSource of_route;
    for (std::size_t r = 0; r < b.routes.size(); ++r)
      spreads.routes[r].sigma(of_routes[0][r], of_routes[1][r], of_route);
    b.bands.sources.push_back(std::move(source));
  }
}

}  // namespace

int scatters_on(MaterialSpread const& m, std::vector<PathStep> const& steps) {
  auto const counts = [&](PathStep const& s) {
    bool const scatters = letter(s.event) == 'S';
    return (m.of_reflection ? s.event == Event::reflect : scatters) &&
           std::binary_search(m.groups.begin(), m.groups.end(), s.group);
  };
  return int(std::ranges::count_if(steps, counts));
}

double coupling_factor(MaterialSpread const& m, CouplingClass const& c, double ratio) {
  if (!c.steps.empty() && c.folded.empty()) return std::pow(ratio, scatters_on(m, c.steps));
  double sum = 0, weight = 0;
  for (FoldedRoute const& f : c.folded) {
    if (f.steps.empty() || !(f.mean > 0)) continue;
    sum += f.mean * std::pow(ratio, scatters_on(m, f.steps));
    weight += f.mean;
  }
  return weight > 0 ? sum / weight : ratio;
}

bool composition_known(MaterialSpread const& m, CouplingClass const& c) {
  if (!c.mixes_routes()) return true;
  if (c.folded.empty() || c.folded.size() != c.folded_routes) return false;
  int const first = scatters_on(m, c.folded.front().steps);
  return std::ranges::all_of(
      c.folded, [&](FoldedRoute const& f) { return !f.steps.empty() && scatters_on(m, f.steps) == first; });
}

namespace {

void hide_unknown(NoiseBudget& b, Materials const& all) {
  for (std::size_t m = 0; m < all.list.size(); ++m) {
    std::vector<bool> const unknown = unknown_bins(b, all, m);
    for (Doubles* const curve : {&b.bands.input_low, &b.bands.input_high}) *curve = without(std::move(*curve), unknown);
    for (std::size_t r = 0; r < b.routes.size(); ++r)
      if (!all.known(m, r))
        for (Doubles* const curve : {&b.routes[r].input_low, &b.routes[r].input_high})
          curve->assign(b.grid.size(), not_a_number);
  }
}

}  // namespace

void add_input_band(NoiseBudget& b, CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                    NoiseSettings const& settings, std::vector<MaterialSpread> const& materials) {
  b.bands.sources.clear();
  b.bands.taken_as_exact.clear();
  Materials const all{materials, table};
  Spreads spreads{Spread(total_psd(b, [](std::size_t) { return 1.0; })), {}};
  for (NoiseTrace const& t : b.routes) spreads.routes.emplace_back(psd_of(t, 1));
  add_materials(b, all, spreads);
  add_motion(b, motion, {table, ifo, settings}, spreads);
  auto const at_ends = [&](std::size_t r, double MaterialSpread::*end) {
    double factor = 1;
    for (std::size_t m = 0; m < materials.size(); ++m) factor *= all.factor(m, r, materials[m].*end);
    return factor;
  };
  auto const low_end = [&](std::size_t r) { return at_ends(r, &MaterialSpread::low); };
  auto const high_end = [&](std::size_t r) { return at_ends(r, &MaterialSpread::high); };
  b.bands.input_low = spreads.total.band(total_psd(b, low_end), -1);
  b.bands.input_high = spreads.total.band(total_psd(b, high_end), 1);
  for (std::size_t i = 0; i < b.grid.size(); ++i)
    if (std::isnan(b.total.asd[i])) b.bands.input_low[i] = b.bands.input_high[i] = not_a_number;
  for (std::size_t r = 0; r < b.routes.size(); ++r) {
    b.routes[r].input_low = spreads.routes[r].band(psd_of(b.routes[r], low_end(r)), -1);
    b.routes[r].input_high = spreads.routes[r].band(psd_of(b.routes[r], high_end(r)), 1);
  }
  hide_unknown(b, all);
}

}  // namespace straytrace::noise
