// SPDX-License-Identifier: BSD-3-Clause
#include "noise/interpolate/spectrum_interpolator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"

namespace straytrace::noise {
namespace {

constexpr double largest_widening = 1e4;  // times the first step: all strengths of a sign share a cell
constexpr double drift_step = 0.02;       // of ln kappa: 1 % in frequency, a quarter of a usual bin

int reach(std::size_t strong_classes) { return strong_classes == 1 ? 4 : 2; }

struct Offset {
  std::size_t class_a, class_b;
  int a, b;  // steps; b = 0 on an axis
};

// Around a cell: its centre, points on each axis, corners of each pair of axes.
std::vector<Offset> offsets(std::span<std::size_t const> strong, std::vector<MotionClass> const& classes) {
  std::vector<Offset> out = {{0, 0, 0, 0}};
  for (std::size_t c : strong) {
    int const m = classes[c].drift ? 1 : reach(strong.size());
    for (int k = -m; k <= m; ++k)
      if (k != 0) out.push_back({c, c, k, 0});
  }
  for (std::size_t i = 0; i < strong.size(); ++i)
    for (std::size_t j = i + 1; j < strong.size(); ++j)
      for (int a : {-1, 1})
        for (int b : {-1, 1}) out.push_back({strong[i], strong[j], a, b});
  return out;
}

}  // namespace

std::size_t SpectrumInterpolator::Hash::operator()(Address const& a) const {
  std::uint64_t h = 0;
  for (std::int32_t x : a) h = (h ^ static_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ULL, h ^= h >> 29;
  return h;
}

SpectrumInterpolator::SpectrumInterpolator(PhaseSpectra const& spectra, Strengths const& paths, Options options)
    : spectra_(spectra), paths_(paths), checks_(spectra, paths, options.checks), weak_(paths.classes) {
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t c = 0; c < paths.classes; ++c)
      if (double const k = paths.of(i)[c]; k != 0 && !spectra.classes()[c].drift && !weak_[c])
        weak_[c] = !spectra.is_strong(c, k);
  bool const falls_back = options.refine && options.direct > 0;
  try {
    interpolate(options);
  } catch (NumericalError const&) {  // of nodes far beyond any path: those of paths were thrown by the checks
    if (!falls_back) throw;
    unshared_ = true;
    found_.clear();
    compute_paths(options.direct);
    return;
  }
  bool const off = std::ranges::any_of(found_, [](SpotCheck const& c) { return !(c.error <= tolerance); });
  if (off && falls_back) compute_paths(options.direct);
}

void SpectrumInterpolator::interpolate(Options const& options) {
  if (any_negative()) {
    start(0.1, options.most, false);
    use_means(std::move(lattice_));
    if (options.refine)
      refine_cells(options.most);
    else
      accurate();
    return;
  }
  if (use_mixture(options)) return;
  start(options.step, options.most, true);
  while (!use_strengths()) {
    compute();
    bool const enough = !options.refine || smooth();
    std::size_t const nodes = kappa_.size();
    if ((accurate() && enough) || !options.refine || !halve(options.most) || kappa_.size() == nodes) return;
  }
}

bool SpectrumInterpolator::sort_into(Lattice& lattice, std::size_t most) const {
  std::unordered_map<Address, std::uint32_t, Hash> index;
  std::vector<MotionClass> const& classes = spectra_.classes();
  Address a(paths_.classes);
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    std::span<double const> const kappa = paths_.of(i);
    for (std::size_t c = 0; c < a.size(); ++c) {
      a[c] = none;
      if (!spectra_.is_strong(c, kappa[c])) continue;
      double const position = std::log(std::fabs(kappa[c])) / lattice.step_of(classes[c]);
      a[c] = static_cast<std::int32_t>(std::lround(position)) * 2 + (kappa[c] < 0);
    }
    auto const [hit, fresh] = index.try_emplace(a, static_cast<std::uint32_t>(lattice.cells.size()));
    lattice.of.push_back(hit->second);
    if (!fresh) continue;
    if (lattice.cells.size() == most) return false;
    Cell& cell = lattice.cells.emplace_back();
    cell.at = a;
    for (std::size_t c = 0; c < a.size(); ++c)
      if (a[c] != none) cell.strong.push_back(c);
  }
  return true;
}

std::uint32_t SpectrumInterpolator::node_at(Lattice const& lattice, Address const& at) {
  auto const [hit, fresh] = node_.try_emplace(at, static_cast<std::uint32_t>(kappa_.size()));
  if (!fresh) return hit->second;
  std::vector<double>& kappa = kappa_.emplace_back(at.size());
  for (std::size_t c = 0; c < at.size(); ++c)
    if (at[c] != none)
      kappa[c] = (at[c] & 1 ? -1 : 1) * std::exp((at[c] >> 1) * lattice.step_of(spectra_.classes()[c]));
  return hit->second;
}

void SpectrumInterpolator::place_nodes(Lattice& lattice) {
  for (Cell& cell : lattice.cells) {
    for (Offset const& o : offsets(cell.strong, spectra_.classes())) {
      Address at = cell.at;
      if (o.a != 0) at[o.class_a] += 2 * o.a;
      if (o.b != 0) at[o.class_b] += 2 * o.b;
      cell.nodes.push_back(node_at(lattice, at));
    }
  }
}

bool SpectrumInterpolator::any_negative() const {
  for (std::size_t i = 0; i < paths_.size(); ++i)
    for (std::size_t c = 0; c < paths_.classes; ++c)
      if (double const k = paths_.of(i)[c]; k < 0 && spectra_.is_strong(c, k)) return true;
  return false;
}

// The widest lattice still has a cell for each set of classes that are strong together, which may be too many.
void SpectrumInterpolator::start(double step, std::size_t most, bool stencils) {
  for (double widening = 1; widening < largest_widening; widening *= 1.5) {
    Lattice lattice{step * widening, drift_step * widening, {}, {}};
    if (!sort_into(lattice, most)) continue;
    node_.clear();
    kappa_.clear();
    if (stencils) place_nodes(lattice);
    if (kappa_.size() > most && lattice.cells.size() > 1) continue;
    lattice_ = std::move(lattice);
    return;
  }
  throw NumericalError(fmt::format("the motion has too many sets of strong classes for {} shared spectra", most));
}

bool SpectrumInterpolator::halve(std::size_t most) {
  Lattice finer{lattice_.step / 2, lattice_.drift_step, {}, {}};
  if (!sort_into(finer, most)) return false;
  auto old_nodes = std::move(node_);
  std::size_t const old_count = kappa_.size();
  node_.clear();
  for (auto const& [at, node] : old_nodes) {
    Address moved = at;
    for (std::size_t c = 0; c < at.size(); ++c)
      if (at[c] != none && !spectra_.classes()[c].drift) moved[c] = (at[c] >> 1) * 4 + (at[c] & 1);
    node_.emplace(std::move(moved), node);
  }
  place_nodes(finer);
  if (kappa_.size() > most) {
    kappa_.resize(old_count);
    node_ = std::move(old_nodes);
    return false;
  }
  lattice_ = std::move(finer);
  return true;
}

bool SpectrumInterpolator::use_strengths() {
  Lattice exact{same, same, {}, {}};
  if (!sort_into(exact, kappa_.size())) return false;
  use_means(std::move(exact));
  found_.clear();
  return true;
}

void SpectrumInterpolator::use_means(Lattice cells) {
  kappa_.assign(cells.cells.size(), std::vector<double>(paths_.classes));
  std::vector<double> weight(kappa_.size());
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    std::uint32_t const n = cells.of[i];
    double const w = paths_.weight.empty() ? 1 : paths_.weight[i];
    weight[n] += w;
    double const share = weight[n] > 0 ? w / weight[n] : 1;
    for (std::size_t c : cells.cells[n].strong) kappa_[n][c] += (paths_.of(i)[c] - kappa_[n][c]) * share;
  }
  for (std::size_t n = 0; n < kappa_.size(); ++n) cells.cells[n].nodes = {static_cast<std::uint32_t>(n)};
  lattice_ = std::move(cells);
  first_basis_.clear();
  basis_.clear();
  known_.clear();
  compute();
}

double SpectrumInterpolator::position(Cell const& cell, std::size_t c, double kappa) const {
  return std::log(std::fabs(kappa)) / lattice_.step_of(spectra_.classes()[c]) - (cell.at[c] >> 1);
}

// Along each axis and for each pair of axes, in the order of `offsets`.
void SpectrumInterpolator::weigh(Cell const& cell, std::span<double const> kappa, std::vector<double>& weight) const {
  weight.assign(cell.nodes.size(), 0);
  weight[0] = 1;
  if (cell.nodes.size() == 1) return;
  std::size_t const strong = cell.strong.size();
  thread_local std::vector<double> x;
  thread_local std::vector<std::size_t> beside;  // the next point on each axis, on the side of the path
  thread_local std::vector<int> above;
  x.clear();
  beside.clear();
  above.clear();
  std::size_t next = 1;
  for (std::size_t c : cell.strong) {
    bool const drift = spectra_.classes()[c].drift;
    int const m = drift ? 1 : reach(strong);
    double const at = position(cell, c, kappa[c]);
    std::array<double, 9> p = lagrange(at, m);
    if (drift) p = {std::max(-at, 0.0), 1 - std::fabs(at), std::max(at, 0.0)};
    weight[0] += p[m] - 1;
    x.push_back(std::fabs(at));
    above.push_back(at >= 0);
    beside.push_back(next + m - (at < 0));
    for (int k = 0; k <= 2 * m; ++k)
      if (k != m) weight[next++] += p[k];
  }
  for (std::size_t i = 0; i < strong; ++i) {
    for (std::size_t j = i + 1; j < strong; ++j, next += 4) {
      double const cross = x[i] * x[j];
      weight[0] += cross;
      weight[beside[i]] -= cross;
      weight[beside[j]] -= cross;
      weight[next + 2 * above[i] + above[j]] += cross;
    }
  }
}

void SpectrumInterpolator::shares(std::size_t path, std::vector<Share>& out) const {
  out.clear();
  if (!drawn_.empty()) {
    std::uint32_t const stratum = sample_->stratum(path), basis = drawn_[stratum];
    bool const single = sample_->strata()[stratum].single;
    out.push_back({basis, single ? 1 : 0.5});
    if (!single) out.push_back({basis + 1, 0.5});
  }
  if (unshared_) return;
  if (mixture_) return mixed_shares(path, out);
  std::span<double const> const kappa = paths_.of(path);
  Cell const& cell = lattice_.cells[lattice_.of[path]];
  thread_local std::vector<double> weight;
  weigh(cell, kappa, weight);
  double weak_power = 0;
  for (std::size_t c = 0; c < kappa.size(); ++c)
    if (cell.at[c] == none) weak_power += kappa[c] * spectra_.variance(c);
  for (std::size_t n = 0; n < weight.size(); ++n) {
    if (weight[n] == 0) continue;
    std::uint32_t basis = first_basis_[cell.nodes[n]];
    out.push_back({basis, weight[n] * (1 - weak_power)});
    for (std::size_t c = 0; c < kappa.size(); ++c) {
      if (cell.at[c] != none || !weak_[c]) continue;
      ++basis;
      if (kappa[c] != 0) out.push_back({basis, weight[n] * kappa[c]});
    }
  }
}

// Spectra of the nodes, and their interpolation error.

namespace {

constexpr double below_highest = 1e-12;  // bins that decide on the step

}  // namespace

void SpectrumInterpolator::compute() {
  for (std::size_t n = first_basis_.size(); n < kappa_.size(); ++n) {
    first_basis_.push_back(static_cast<std::uint32_t>(basis_.size()));
    if (auto const hit = known_.find(kappa_[n]); hit != known_.end()) {
      basis_.insert(basis_.end(), hit->second.begin(), hit->second.end());
      continue;
    }
    std::vector<bool> responses = weak_;
    for (std::size_t c = 0; c < responses.size(); ++c)
      responses[c] = responses[c] && kappa_[n][c] == 0 && (n == still_ || !is_mixed(c));
    PhaseSpectrum s = spectra_.strong(kappa_[n], responses);
    basis_.push_back({std::move(s.psd), std::move(s.linear)});
    for (std::size_t c = 0; c < responses.size(); ++c)
      if (responses[c]) basis_.push_back({s.response[c], s.response[c]});
  }
}

void SpectrumInterpolator::forget_nodes() {
  for (std::size_t n = 0; n < first_basis_.size(); ++n) {
    auto const end = n + 1 < first_basis_.size() ? first_basis_[n + 1] : basis_.size();
    known_[kappa_[n]].assign(basis_.begin() + first_basis_[n], basis_.begin() + static_cast<std::ptrdiff_t>(end));
  }
  first_basis_.clear();
  basis_.clear();
}

// Compares each node with its next one along each axis.
bool SpectrumInterpolator::smooth() const {
  for (auto const& [at, node] : node_) {
    auto const strong = std::ranges::count_if(at, [](std::int32_t a) { return a != none; });
    double const limit = std::exp(strong == 1 ? 0.8 : 0.4);
    std::vector<double> const& here = basis_[first_basis_[node]].psd;
    double const floor = below_highest * *std::ranges::max_element(here);
    for (std::size_t c = 0; c < at.size(); ++c) {
      if (at[c] == none || spectra_.classes()[c].drift) continue;
      Address next = at;
      next[c] += 2;
      auto const hit = node_.find(next);
      if (hit == node_.end()) continue;
      std::vector<double> const& there = basis_[first_basis_[hit->second]].psd;
      for (std::size_t i = 0; i < here.size(); ++i)
        if (std::min(here[i], there[i]) > floor && std::max(here[i], there[i]) > limit * std::min(here[i], there[i]))
          return false;
    }
  }
  return true;
}

SpectrumInterpolator::Basis SpectrumInterpolator::shared_spectrum(std::size_t path) const {
  thread_local std::vector<Share> of_path;
  shares(path, of_path);
  Basis sum{std::vector<double>(spectra_.grid().size()), std::vector<double>(spectra_.grid().size())};
  for (Share const& s : of_path)
    for (std::size_t i = 0; i < sum.psd.size(); ++i) {
      sum.psd[i] += s.weight * basis_[s.basis].psd[i];
      sum.linear[i] += s.weight * basis_[s.basis].linear[i];
    }
  return sum;
}

bool SpectrumInterpolator::accurate() {
  found_ = checks_.compared([&](std::size_t path) { return shared_spectrum(path).psd; });
  return std::ranges::all_of(found_, [](SpotCheck const& c) { return c.error <= tolerance; });
}

void SpectrumInterpolator::refine_cells(std::size_t most) {
  while (!accurate()) {
    Lattice finer{lattice_.step / 2, lattice_.drift_step / 2, {}, {}};
    if (!sort_into(finer, most)) return;
    use_means(std::move(finer));
  }
}

// Paths computed individually, where interpolated spectra fail their checks.

void SpectrumInterpolator::compute_paths(std::size_t most) {
  Lattice each{same, same, {}, {}};
  if (!sort_into(each, most)) return use_sample(most);
  mixture_.reset();
  unshared_ = false;
  use_means(std::move(each));
  found_.clear();
}

SpectrumInterpolator::Basis SpectrumInterpolator::own_spectrum(std::size_t path) const {
  PhaseSpectrum s = spectra_(paths_.of(path));
  return {std::move(s.psd), std::move(s.linear)};
}

// The spectra of the nodes are used where the sum of their residuals has the smaller variance, and dropped elsewhere.
void SpectrumInterpolator::use_sample(std::size_t most) {
  sample_.emplace(spectra_, paths_, most);
  if (unshared_) basis_.clear();
  std::vector<Basis> own, shared;
  std::vector<std::uint32_t> first;
  for (StrengthSample::Stratum const& s : sample_->strata()) {
    first.push_back(static_cast<std::uint32_t>(own.size()));
    for (std::size_t const path : {s.first, s.second}) {
      if (s.single && own.size() > first.back()) continue;
      own.push_back(own.size() > first.back() && s.first == s.second ? own.back() : own_spectrum(path));
      shared.push_back(shared_spectrum(path));
    }
  }
  for (std::uint32_t& basis : drawn_ = std::move(first)) basis += static_cast<std::uint32_t>(basis_.size());
  std::vector<bool> const keep = interpolated_bins(own, shared);
  for (Basis& b : basis_)
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (!keep[i]) b.psd[i] = b.linear[i] = 0;
  for (std::size_t d = 0; d < own.size(); ++d) {
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (!keep[i]) continue;
      own[d].psd[i] -= shared[d].psd[i];
      own[d].linear[i] -= shared[d].linear[i];
    }
    basis_.push_back(std::move(own[d]));
  }
}

// Also, no drawn path may deviate by more than a tenth of the mean: otherwise rare paths that were not drawn deviate by
// more than the draws resolve.
std::vector<bool> SpectrumInterpolator::interpolated_bins(std::vector<Basis> const& own,
                                                          std::vector<Basis> const& shared) const {
  std::vector<double> weight(sample_->strata().size());
  for (std::size_t i = 0; i < paths_.size(); ++i) weight[sample_->stratum(i)] += paths_.weight_of(i);
  std::size_t const bins = spectra_.grid().size();
  std::vector<double> left(bins), whole(bins), mean(bins), off(bins);
  double total = 0;
  for (std::size_t s = 0; s < weight.size(); ++s) {
    std::size_t const a = drawn_[s] - basis_.size(), b = sample_->strata()[s].single ? a : a + 1;
    total += weight[s];
    for (std::size_t i = 0; i < bins; ++i) {
      double const of_own = own[a].psd[i] - own[b].psd[i], of_shared = shared[a].psd[i] - shared[b].psd[i];
      whole[i] += std::pow(weight[s] * of_own, 2);
      left[i] += std::pow(weight[s] * (of_own - of_shared), 2);
      mean[i] += weight[s] * (own[a].psd[i] + own[b].psd[i]) / 2;
      for (std::size_t const d : {a, b}) off[i] = std::max(off[i], std::fabs(shared[d].psd[i] - own[d].psd[i]));
    }
  }
  std::vector<bool> keep;
  for (std::size_t i = 0; i < bins; ++i) keep.push_back(left[i] <= whole[i] && off[i] * total <= 0.1 * mean[i]);
  return keep;
}

std::size_t SpectrumInterpolator::drawn() const {
  std::size_t count = 0;
  if (sample_)
    for (StrengthSample::Stratum const& s : sample_->strata()) count += s.single || s.first == s.second ? 1 : 2;
  return count;
}

void SpectrumInterpolator::add_variance(std::span<double const> weights, std::vector<double>& variance) const {
  for (std::size_t s = 0; s < drawn_.size(); ++s) {
    std::size_t const a = drawn_[s], b = a + 1;
    if (sample_->strata()[s].single || (weights[a] == 0 && weights[b] == 0)) continue;
    for (std::size_t i = 0; i < variance.size(); ++i)
      variance[i] += std::pow(weights[a] * basis_[a].psd[i] - weights[b] * basis_[b].psd[i], 2);
  }
}

// Paths that several classes of Gaussian motion move strongly.

// Of the slow part of the strongest path: faster motion is linear and does not wrap fringes.
std::vector<double> SpectrumInterpolator::square_rates() const {
  std::size_t const classes = paths_.classes;
  std::vector<double> most(classes);
  std::vector<bool> strong(classes);
  for (std::size_t i = 0; i < paths_.size(); ++i)
    for (std::size_t c = 0; c < classes; ++c) {
      double const k = paths_.of(i)[c];
      most[c] = std::max(most[c], k);
      if (spectra_.is_strong(c, k)) strong[c] = true;
    }
  double const highest = spectra_.split_hz(most);
  std::vector<double> rate(classes);
  for (std::size_t c = 0; c < classes; ++c) {
    MotionClass const& one = spectra_.classes()[c];
    if (!strong[c]) continue;
    if (one.drift || one.tone_frequency > 0) return {};
    // The strength part of u separates motion that is too fast to wrap.
    rate[c] = one.reference.rate_power(highest) + 1e-3 * highest * highest * spectra_.variance(c);
  }
  for (std::size_t i = 0; i < paths_.size(); ++i)
    for (std::size_t c = 0; c < classes; ++c)
      if (rate[c] > 0 && paths_.of(i)[c] < 0) return {};
  return std::ranges::count_if(rate, [](double r) { return r > 0; }) > 1 ? rate : std::vector<double>();
}

bool SpectrumInterpolator::use_mixture(Options const& options) {
  std::vector<double> const rate = square_rates();
  if (rate.empty()) return false;
  double least = infinity;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    double square = 0;
    bool strong = false;
    for (std::size_t c = 0; c < rate.size(); ++c) {
      square += rate[c] * paths_.of(i)[c];
      strong = strong || spectra_.is_strong(c, paths_.of(i)[c]);
    }
    if (strong) least = std::min(least, square);
  }
  std::size_t const most = 5 * options.most;
  for (double widening = 1;; widening *= 1.5) {
    if (!try_mixture(rate, least, options.step * widening, most)) return true;
    if (mixture_->size() <= most || widening > 10) break;
  }
  compute();
  while (!accurate() && options.refine && 2 * mixture_->size() <= most) {
    forget_nodes();
    if (!try_mixture(rate, least, mixture_->step() / 2, most)) return true;
    compute();
  }
  known_.clear();
  return true;
}

// False when the paths have no more strengths than there would be nodes: then the strengths are the nodes.
bool SpectrumInterpolator::try_mixture(std::vector<double> const& rate, double least, double step, std::size_t most) {
  MixtureLattice lattice(rate, paths_.kappa, least, step, most);
  mixture_.reset();
  kappa_ = lattice.kappa();
  if (use_strengths()) return false;
  still_ = kappa_.size();
  kappa_.emplace_back(rate.size());
  mixed_.clear();
  for (double const r : rate) mixed_.push_back(r > 0);
  lattice_.step = step;
  mixture_ = std::move(lattice);
  return true;
}

void SpectrumInterpolator::mixed_shares(std::size_t path, std::vector<Share>& out) const {
  std::span<double const> const kappa = paths_.of(path);
  thread_local std::vector<MixtureLattice::Share> nodes;
  bool const held = mixture_->holds(kappa);
  if (held)
    mixture_->shares(kappa, nodes);
  else
    nodes.assign(1, {static_cast<std::uint32_t>(still_), 1});
  auto const first_order = [&](std::size_t c) { return !held || !mixed_[c]; };
  double weak_power = 0;
  for (std::size_t c = 0; c < kappa.size(); ++c)
    if (first_order(c)) weak_power += kappa[c] * spectra_.variance(c);
  for (MixtureLattice::Share const& n : nodes) {
    std::uint32_t basis = first_basis_[n.node];
    out.push_back({basis, n.weight * (1 - weak_power)});
    for (std::size_t c = 0; c < kappa.size(); ++c) {
      if (!weak_[c] || !first_order(c)) continue;
      ++basis;
      if (kappa[c] != 0) out.push_back({basis, n.weight * kappa[c]});
    }
  }
}

}  // namespace straytrace::noise
