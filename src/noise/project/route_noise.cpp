// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/route_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math/constants.hpp"
#include "base/math/samples.hpp"

namespace straytrace::noise {
FirstOrderRatio::FirstOrderRatio(PhaseSpectra const& spectra, MotionSet const& motion, CouplingTable const& table,
                                 CouplingClass const& c, Strengths const& paths, std::size_t first) {
  double const total = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  if (c.phase_sensitivities.empty() || c.records.empty() || !(c.coupling.mean > 0) || !(total > 0)) return;
  std::size_t const classes = spectra.classes().size();
  std::vector<KappaSum> const sums = kappa_sums(motion, spectra.classes(), c.phase_sensitivities);
  moments_.all.resize(classes);
  for (std::size_t k = 0; k < classes; ++k) {
    class_known_.push_back(sums[k].known);
    for (double const x : sums[k].of) moments_.all[k] += x / c.coupling.mean;
  }
  for (std::size_t r = 0; r < replica_count; ++r) {
    double const left = 1 - c.replica_sum[r] / total;
    if (!(left > 0)) return;
    for (std::size_t k = 0; k < classes; ++k)
      moments_.without[r].push_back((moments_.all[k] - sums[k].of[r] / c.coupling.mean) / left);
  }
  take_paths(c, paths, first, table.block_size);
  for (std::size_t i = 0; i < spectra.grid().size(); ++i) {
    OfClasses& of_bin = weight_.emplace_back();
    for (std::size_t k = 0; k < classes; ++k) of_bin.push_back(spectra.first_order_weight(k, i));
  }
  known_ = true;
}

void FirstOrderRatio::take_paths(CouplingClass const& c, Strengths const& paths, std::size_t first,
                                 std::uint64_t block_size) {
  std::size_t const classes = class_known_.size();
  OfClasses sum(classes);
  std::array<OfClasses, replica_count> own;
  own.fill(OfClasses(classes));
  double weight = 0;
  std::array<double, replica_count> own_weight = {};
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    double const w = c.records[i].weight;
    std::size_t const r = replica_of(c.records[i].history, block_size);
    weight += w;
    own_weight[r] += w;
    for (std::size_t k = 0; k < classes; ++k) {
      sum[k] += w * paths.of(first + i)[k];
      own[r][k] += w * paths.of(first + i)[k];
    }
  }
  for (double const x : sum) paths_.all.push_back(x / weight);
  for (std::size_t r = 0; r < replica_count; ++r) {
    double const left = weight - own_weight[r];
    bool const alone = left <= 1e-12 * weight;
    for (std::size_t k = 0; k < classes; ++k)
      paths_.without[r].push_back(alone ? paths_.all[k] : (sum[k] - own[r][k]) / left);
  }
}

std::vector<double> FirstOrderRatio::operator()(int moments_without, int paths_without) const {
  OfClasses const &moments = moments_(moments_without), &paths = paths_(paths_without);
  std::vector<double> ratio;
  for (OfClasses const& weight : weight_) {
    double above = 0, below = 0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
      above += weight[k] * (class_known_[k] ? moments[k] : paths[k]);
      below += weight[k] * paths[k];
    }
    ratio.push_back(above > 0 && below > 0 ? above / below : 1);
  }
  return ratio;
}

namespace {

// Mean coupling without the histories of one replica.
double mean_without(CouplingTable const& table, CouplingClass const& c, std::size_t replica, double total) {
  return (total - c.replica_sum[replica]) / static_cast<double>(table.histories - table.replica_histories[replica]);
}

// Weights of the basis spectra, of all records and of those of each replica.
struct Histogram {
  explicit Histogram(std::size_t size) : all(size) {}
  void add(std::size_t replica, std::span<SpectrumInterpolator::Share const> shares, double weight) {
    std::vector<double>& own = of[replica];
    own.resize(all.size());
    for (SpectrumInterpolator::Share const& s : shares) {
      all[s.basis] += weight * s.weight;
      own[s.basis] += weight * s.weight;
    }
  }
  std::vector<double> all;
  std::array<std::vector<double>, replica_count> of;
};

Bins sum_of(std::span<double const> weight, std::vector<SpectrumInterpolator::Basis> const& basis,
            Bins SpectrumInterpolator::Basis::*part) {
  Bins sum(basis.empty() ? 0 : (basis.front().*part).size());
  for (std::size_t b = 0; b < weight.size(); ++b)
    for (std::size_t i = 0; weight[b] != 0 && i < sum.size(); ++i) sum[i] += weight[b] * (basis[b].*part)[i];
  return sum;
}

Bins times(Bins bins, double factor) {
  for (double& b : bins) b = std::max(0.0, b * factor);
  return bins;
}

// Per unit of power.
struct Shape {
  Bins psd, linear;
};

Bins corrected(Shape const& s, Bins const& ratio) {
  Bins out = s.psd;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += s.linear[i] * (ratio[i] - 1);
  return out;
}

// The shape of `weight` less that of a part, which leaves `left` of the weight.
Shape without(Shape shape, double weight, std::vector<double> const& part,
              std::vector<SpectrumInterpolator::Basis> const& basis, double left) {
  Bins const psd = sum_of(part, basis, &SpectrumInterpolator::Basis::psd),
             linear = sum_of(part, basis, &SpectrumInterpolator::Basis::linear);
  for (std::size_t i = 0; i < psd.size(); ++i) {
    shape.psd[i] = std::max(0.0, weight * shape.psd[i] - psd[i]) / left;
    shape.linear[i] = std::max(0.0, weight * shape.linear[i] - linear[i]) / left;
  }
  return shape;
}

class EffectiveNumber {
 public:
  void add(double x) {
    sum_ += x;
    squares_ += x * x;
  }
  double sum() const { return sum_; }
  double value() const { return squares_ > 0 ? sum_ * sum_ / squares_ : 0; }

 private:
  double sum_ = 0, squares_ = 0;
};

}  // namespace

std::size_t replica_of(std::uint64_t history, std::uint64_t block_size) { return history / block_size % replica_count; }

double mirror_error(ClassKind kind, Estimate const& coupling) {
  return kind == ClassKind::halo && coupling.mean > 0 ? coupling.std_error / coupling.mean : 0;
}

double jackknife_variance(std::span<double const> without) {
  auto const n = static_cast<double>(without.size());
  if (n < 2) return not_a_number;
  double const mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
  double sum = 0;
  for (double x : without) sum += (x - mean) * (x - mean);
  return (n - 1) / n * sum;
}

namespace {

// Draws of one draw of the heights share its speckle: with several, their means are the samples.
double error_of_mean(std::vector<double> const& of_draws, std::size_t heights) {
  std::vector<double> means(heights);
  std::size_t const each = of_draws.size() / heights;
  for (std::size_t i = 0; i < each * heights; ++i) means[i / each] += of_draws[i] / double(each);
  std::vector<double> const& samples = heights > 1 ? means : of_draws;
  return std::sqrt(sample_variance(samples) / double(samples.size()));
}

}  // namespace

DrawBand draw_band(CouplingClass const& c, std::size_t first, SpectrumInterpolator const& nodes) {
  std::uint64_t draws = 0;
  std::size_t heights = 1;
  if (c.kind == ClassKind::wave)
    for (PathRecord const& r : c.records) {
      draws = std::max(draws, r.history + 1);
      heights = std::max(heights, std::size_t(r.event) + 1);
    }
  if (draws < 2) return {};
  std::vector<std::vector<double>> weights(draws, std::vector<double>(nodes.basis().size()));
  std::vector<SpectrumInterpolator::Share> shares;
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    nodes.shares(first + i, shares);
    for (SpectrumInterpolator::Share const& s : shares)
      weights[c.records[i].history][s.basis] += double(draws) * c.records[i].weight * s.weight;
  }
  DrawBand band;
  for (std::vector<double> const& w : weights)
    band.psd.push_back(sum_of(w, nodes.basis(), &SpectrumInterpolator::Basis::psd));
  for (std::size_t bin = 0; bin < band.psd.front().size(); ++bin) {
    std::vector<double> values;
    for (Bins const& of_draw : band.psd) values.push_back(of_draw[bin]);
    band.error.push_back(error_of_mean(values, heights));
    std::ranges::sort(values);
    band.low.push_back(nearest_rank(values, 0.05));
    band.high.push_back(nearest_rank(values, 0.95));
  }
  return band;
}

namespace {

// The paths of a route: their shares of the nodes, by replica, and their mean-square phases.
struct WeighedPaths {
  Histogram histogram;
  std::array<double, replica_count> own = {};
  double weight = 0;

  WeighedPaths(CouplingTable const& table, CouplingClass const& c, std::size_t first, SpectrumInterpolator const& nodes,
               std::span<double const> mean_square_phase, RouteSpectrum& route)
      : histogram(nodes.basis().size()) {
    EffectiveNumber power, noise;
    std::vector<SpectrumInterpolator::Share> shares;
    for (std::size_t i = 0; i < c.records.size(); ++i) {
      double const w = c.records[i].weight, strength = mean_square_phase[first + i];
      std::size_t const replica = replica_of(c.records[i].history, table.block_size);
      nodes.shares(first + i, shares);
      histogram.add(replica, shares, w);
      own[replica] += w;
      weight += w;
      route.mean_square_phase += w * strength;
      power.add(w);
      double const loud = w * strength / (1 + strength);  // the power of wrapped fringes is bounded
      noise.add(loud);
      route.mean_square_phase_of_noise += loud * strength;
    }
    if (noise.sum() > 0) route.mean_square_phase_of_noise /= noise.sum();
    if (weight > 0) route.mean_square_phase /= weight;
    route.paths_of_power = power.value();
    route.paths_of_noise = noise.value();
  }
};

// The spectrum without the paths of each replica in turn.
void add_replicas(RouteSpectrum& route, CouplingTable const& table, CouplingClass const& c, WeighedPaths const& paths,
                  Shape const& shape, SpectrumInterpolator const& nodes, FirstOrderRatio const& ratio) {
  double const total = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  for (std::size_t r = 0; r < replica_count; ++r) {
    if (table.replica_histories[r] == 0 || table.replica_histories[r] == table.histories) continue;
    double const left = paths.weight - paths.own[r], mean = mean_without(table, c, r, total);
    bool const alone = left <= 1e-12 * paths.weight;  // no record elsewhere: only the mean changes
    Shape const other = alone ? shape : without(shape, paths.weight, paths.histogram.of[r], nodes.basis(), left);
    auto const put = [&](ErrorPart part, Shape const& s, int moments, int of_paths, double coupling) {
      Bins const factor = ratio.known() ? ratio(moments, of_paths) : Bins(s.psd.size(), 1);
      route.without[std::size_t(part)][r] = times(corrected(s, factor), coupling);
    };
    int const replica = int(r), all = FirstOrderRatio::all;
    put(ErrorPart::all, other, replica, replica, mean);
    put(ErrorPart::power, shape, all, all, mean);
    put(ErrorPart::phase_sensitivities, shape, replica, all, c.coupling.mean);
    put(ErrorPart::paths, other, all, replica, c.coupling.mean);
  }
}

}  // namespace

RouteSpectrum route_spectrum(CouplingTable const& table, CouplingClass const& c, std::size_t first,
                             SpectrumInterpolator const& nodes, std::span<double const> mean_square_phase,
                             FirstOrderRatio const& ratio) {
  RouteSpectrum route;
  route.exact = c.deterministic();
  WeighedPaths const paths(table, c, first, nodes, mean_square_phase, route);
  double const weight = paths.weight;
  route.psd = sum_of(paths.histogram.all, nodes.basis(), &SpectrumInterpolator::Basis::psd);
  route.linear = sum_of(paths.histogram.all, nodes.basis(), &SpectrumInterpolator::Basis::linear);
  if (!(weight > 0)) return route;
  if (nodes.sampled()) {
    route.drawn.assign(route.psd.size(), 0);
    nodes.add_variance(paths.histogram.all, route.drawn);
    route.drawn = times(std::move(route.drawn), std::pow(c.coupling.mean / weight, 2));
  }
  Shape const shape{times(route.psd, 1 / weight), times(route.linear, 1 / weight)};
  Bins const one = ratio.known() ? ratio(ratio.all, ratio.all) : Bins(route.psd.size(), 1);
  route.psd = times(corrected(shape, one), c.coupling.mean);
  for (std::size_t i = 0; i < route.linear.size(); ++i) route.linear[i] = shape.linear[i] * one[i] * c.coupling.mean;
  if (!route.exact) add_replicas(route, table, c, paths, shape, nodes, ratio);
  return route;
}

namespace {

// The input whose class has the most phase power in a path; a drift counts by its rate.
std::string strongest_motion(MotionSet const& motion, PhaseSpectra const& spectra, std::span<double const> kappa) {
  std::size_t most = 0;
  double highest = -1;
  for (std::size_t c = 0; c < kappa.size(); ++c) {
    double const power = std::fabs(kappa[c]) * (spectra.classes()[c].drift ? 1 : spectra.variance(c));
    if (power > highest) most = c;
    highest = std::max(highest, power);
  }
  return motion.inputs[spectra.classes()[most].members.front().input].name;
}

}  // namespace

std::string sharing_note(CouplingTable const& table, MotionSet const& motion, PhaseSpectra const& spectra,
                         Strengths const& paths, SpectrumInterpolator const& nodes, DrawnError const& added) {
  std::string const error = added.share > 0 ? fmt::format("up to {:.2g} % of h to its error, at {:.3g} Hz",
                                                          100 * added.share, spectra.grid().centre(added.bin))
                                            : "nothing to the error of the total";
  std::string const drawn = fmt::format(
      "the spectra of {} paths rest on {} of them, drawn at random among paths of like strength; this adds {}",
      paths.size(), nodes.drawn(), error);
  if (nodes.checks().empty()) return drawn + ". Their strengths differ too much for shared spectra";
  SpotCheck const worst =
      *std::ranges::max_element(nodes.checks(), [](auto const& a, auto const& b) { return a.error < b.error; });
  auto const after = std::ranges::upper_bound(paths.first, worst.path);
  CouplingClass const& route = table.classes[static_cast<std::size_t>(after - paths.first.begin()) - 1];
  return fmt::format(
      "{}. Shared spectra were off by up to {:.2g} of the PSD of a path, at {:.3g} Hz on route '{}' (moved most by "
      "'{}')",
      drawn, worst.error, spectra.grid().centre(worst.bin), route_name(table, route),
      strongest_motion(motion, spectra, paths.of(worst.path)));
}

RouteSpectrum family_spectrum(PhaseSpectra const& spectra, MotionSet const& motion, CouplingClass const& c,
                              std::span<double const> mean_square_phase) {
  std::vector<PhasePair> pairs;
  for (std::size_t const state : {0, 1}) {
    std::vector<CoherentPath> paths;
    for (PathRecord const& r : c.records)
      if (std::norm(r.field[state]) > 0) paths.push_back({r.field[state], r.phase_sensitivities});
    for (PhasePair& p : coherent_family(motion, spectra.classes(), paths)) pairs.push_back(std::move(p));
  }
  PairSpectrum sum = pair_spectrum(spectra, pairs);
  RouteSpectrum route;
  route.exact = true;
  route.psd = std::move(sum.psd);
  route.linear = std::move(sum.linear);
  for (double& x : route.psd) x = std::max(0.0, x);  // rounding, where fields cancel
  double power = 0;
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    route.mean_square_phase += c.records[i].weight * mean_square_phase[i];
    power += c.records[i].weight;
  }
  if (power > 0) route.mean_square_phase /= power;
  return route;
}

}  // namespace straytrace::noise
