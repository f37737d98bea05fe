// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/input_band.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace straytrace::noise {
namespace {

using Doubles = std::vector<double>;

// PSD of a route, each bin times its factor(bin).
template <class Factor>
Doubles psd_of(NoiseTrace const& t, Factor const& factor) {
  Doubles psd;
  for (std::size_t i = 0; i < t.asd.size(); ++i) psd.push_back(factor(i) * t.psd(i));
  return psd;
}
Doubles psd_of(NoiseTrace const& t) {
  return psd_of(t, [](std::size_t) { return 1.0; });
}

// Sum of the PSDs of the routes, each times its factor(route, bin); unresolved ones with their observed part, as in the
// total.
template <class Factor>
Doubles total_psd(NoiseBudget const& b, Factor const& factor) {
  Doubles sum(b.grid.size());
  for (std::size_t r = 0; r < b.routes.size(); ++r)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor(r, i) * b.routes[r].psd(i);
  return sum;
}
Doubles total_psd(NoiseBudget const& b) {
  return total_psd(b, [](std::size_t, std::size_t) { return 1.0; });
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

// Materials of a stated spread among all, and what the noise of the routes is composed of by them.
struct Materials {
  std::vector<MaterialSpread> const& list;
  CouplingTable const& table;
  std::vector<std::size_t> place = {};  // of each of the list among those stated
  std::vector<MaterialSpread> spread = {};
  std::optional<Composition> parts = {};

  Materials(std::vector<MaterialSpread> const& all, CouplingTable const& traced) : list(all), table(traced) {
    for (MaterialSpread const& m : list) {
      place.push_back(spread.size());
      if (stated(m)) spread.push_back(m);
    }
  }
  void divide(MotionSet const& motion, Interferometer const& ifo, NoiseSettings const& settings) {
    parts.emplace(table, spread, motion, ifo, settings);
  }
  bool passes(std::size_t m, std::size_t route) const { return coupling_factor(list[m], table.classes[route], 2) != 1; }
  double factor(std::size_t m, std::size_t route, std::size_t bin, double ratio) const {
    return parts->factor(route, bin, place[m], ratio);
  }
  double unknown(std::size_t m, std::size_t route, std::size_t bin) const {
    return stated(list[m]) ? parts->unknown(route, bin, place[m]) : 0;
  }
};

double share_of(NoiseBudget const& b, Materials const& all, std::size_t m, double total) {
  Doubles const through = total_psd(b, [&](std::size_t r, std::size_t i) {
    if (!stated(all.list[m])) return all.passes(m, r) ? 1.0 : 0.0;
    double share = 0;
    for (RowPart const& part : all.parts->parts(r)) share += part.scatters[all.place[m]] > 0 ? part.at(i) : 0;
    return share;
  });
  return total > 0 ? band_power(b.grid, through) / total : 0;
}

// Bins where the effect of the material is not known.
std::vector<bool> unknown_bins(NoiseBudget const& b, Materials const& all, std::size_t m) {
  Doubles const mixed = total_psd(b, [&](std::size_t r, std::size_t i) { return all.unknown(m, r, i); }),
                total = total_psd(b);
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
    auto const of_one = [&](std::size_t r, double ratio) {
      return psd_of(b.routes[r], [&](std::size_t i) { return all.factor(m, r, i, ratio); });
    };
    InputSource of_route;
    for (std::size_t r = 0; one.factor > 1 && r < b.routes.size(); ++r)
      spreads.routes[r].sigma(of_one(r, 1 / one.factor), of_one(r, one.factor), of_route);
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
      return without(total_psd(b, [&](std::size_t r, std::size_t i) { return all.factor(m, r, i, ratio); }), unknown);
    };
    spread.range(scaled(one.low), scaled(one.high), source);
    if (one.factor > 1) spread.sigma(scaled(1 / one.factor), scaled(one.factor), source);
    if (std::ranges::find(unknown, false) == unknown.end()) source.low = source.high = not_a_number;
    b.bands.sources.push_back(std::move(source));
  }
}

struct Projection {
  CouplingTable const& table;
  Interferometer const& ifo;
  NoiseSettings const& settings;
};

void add_motion(NoiseBudget& b, MotionSet const& motion, Projection const& projection, Spreads& spreads) {
  for (MotionCause const& cause : motion_causes(motion)) {
    if (cause.uncertainty == 1) {
      b.bands.taken_as_exact.push_back(cause.name);
      continue;
    }
    Doubles ends[2];
    std::vector<Doubles> of_routes[2];
    for (int const towards : {-1, 1}) {
      MotionSet const moved =
          with_scaled_inputs(motion, cause, [&](double uncertainty) { return std::pow(uncertainty, towards); });
      NoiseBudget other = project_noise(projection.table, moved, projection.ifo, projection.settings);
      ends[towards > 0] = total_psd(other);
      for (NoiseTrace const& t : other.routes) of_routes[towards > 0].push_back(psd_of(t));
    }
    InputSource source{cause.name, fmt::format("one sigma: factor {:.3g} on the ASD", cause.uncertainty), 1, 1, 0};
    spreads.total.sigma(ends[0], ends[1], source);
    InputSource of_route;
    for (std::size_t r = 0; r < b.routes.size(); ++r)
      spreads.routes[r].sigma(of_routes[0][r], of_routes[1][r], of_route);
    b.bands.sources.push_back(std::move(source));
  }
}

}  // namespace

namespace {

void hide_unknown(NoiseBudget& b, Materials const& all) {
  for (std::size_t m = 0; m < all.list.size(); ++m) {
    std::vector<bool> const unknown = unknown_bins(b, all, m);
    for (Doubles* const curve : {&b.bands.input_low, &b.bands.input_high}) *curve = without(std::move(*curve), unknown);
    for (std::size_t r = 0; r < b.routes.size(); ++r)
      for (Doubles* const curve : {&b.routes[r].input_low, &b.routes[r].input_high})
        for (std::size_t i = 0; i < curve->size(); ++i)
          if (all.unknown(m, r, i) > composition_limit) (*curve)[i] = not_a_number;
  }
}

}  // namespace

std::vector<MotionCause> motion_causes(MotionSet const& motion) {
  std::map<std::set<std::uint32_t>, MotionCause> all;  // by the bodies moved
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) {
    std::set<std::uint32_t> bodies;
    for (Gain const& g : motion.inputs[i].gains) bodies.insert(g.body.value);
    MotionCause& cause = all[bodies];
    cause.inputs.push_back(i);
    cause.uncertainty = std::max(cause.uncertainty, motion.inputs[i].uncertainty);
    if (!cause.name.empty()) continue;
    for (std::uint32_t const b : bodies) cause.name += (cause.name.empty() ? "motion of " : ", ") + motion.bodies[b];
  }
  std::vector<MotionCause> out;
  for (auto& [bodies, cause] : all) out.push_back(std::move(cause));
  return out;
}

MotionSet with_scaled_inputs(MotionSet const& motion, MotionCause const& cause,
                             std::function<double(double uncertainty)> const& factor) {
  MotionSet out = motion;
  for (std::size_t const i : cause.inputs)
    for (Gain& g : out.inputs[i].gains) g.value *= factor(motion.inputs[i].uncertainty);
  return out;
}

void add_input_band(NoiseBudget& b, CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                    NoiseSettings const& settings, std::vector<MaterialSpread> const& materials) {
  b.bands.sources.clear();
  b.bands.taken_as_exact.clear();
  Materials all(materials, table);
  all.divide(motion, ifo, settings);
  Spreads spreads{Spread(total_psd(b)), {}};
  for (NoiseTrace const& t : b.routes) spreads.routes.emplace_back(psd_of(t));
  add_materials(b, all, spreads);
  add_motion(b, motion, {table, ifo, settings}, spreads);
  Doubles lows, highs;
  for (MaterialSpread const& m : all.spread) {
    lows.push_back(m.low);
    highs.push_back(m.high);
  }
  auto const at_ends = [&](Doubles const& ends) {
    return [&](std::size_t r, std::size_t i) { return all.parts->factor(r, i, ends); };
  };
  auto const low_end = at_ends(lows), high_end = at_ends(highs);
  b.bands.input_low = spreads.total.band(total_psd(b, low_end), -1);
  b.bands.input_high = spreads.total.band(total_psd(b, high_end), 1);
  for (std::size_t i = 0; i < b.grid.size(); ++i)
    if (std::isnan(b.total.asd[i])) b.bands.input_low[i] = b.bands.input_high[i] = not_a_number;
  for (std::size_t r = 0; r < b.routes.size(); ++r) {
    auto const of_route = [&](auto const& end) {
      return psd_of(b.routes[r], [&](std::size_t i) { return end(r, i); });
    };
    b.routes[r].input_low = spreads.routes[r].band(of_route(low_end), -1);
    b.routes[r].input_high = spreads.routes[r].band(of_route(high_end), 1);
  }
  hide_unknown(b, all);
}

}  // namespace straytrace::noise
