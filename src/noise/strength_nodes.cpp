// SPDX-License-Identifier: BSD-3-Clause
#include "noise/strength_nodes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/message.hpp"
#include "noise/lagrange.hpp"

namespace straytrace {
namespace {

constexpr double drift_step = 0.02;  // of ln kappa: 1 % in frequency, a quarter of a usual bin

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

std::size_t StrengthNodes::Hash::operator()(Address const& a) const {
  std::uint64_t h = 0;
  for (std::int32_t x : a) h = (h ^ static_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ULL, h ^= h >> 29;
  return h;
}

StrengthNodes::StrengthNodes(PhaseSpectra const& spectra, Strengths const& paths, Options options)
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
  bool const off =
      std::any_of(found_.begin(), found_.end(), [](SpotCheck const& c) { return !(c.error <= tolerance); });
  if (off && falls_back) compute_paths(options.direct);
}

void StrengthNodes::interpolate(Options const& options) {
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

bool StrengthNodes::sort_into(Lattice& lattice, std::size_t most) const {
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

std::uint32_t StrengthNodes::node_at(Lattice const& lattice, Address const& at) {
  auto const [hit, fresh] = node_.try_emplace(at, static_cast<std::uint32_t>(kappa_.size()));
  if (!fresh) return hit->second;
  std::vector<double>& kappa = kappa_.emplace_back(at.size());
  for (std::size_t c = 0; c < at.size(); ++c)
    if (at[c] != none)
      kappa[c] = (at[c] & 1 ? -1 : 1) * std::exp((at[c] >> 1) * lattice.step_of(spectra_.classes()[c]));
  return hit->second;
}

void StrengthNodes::place_nodes(Lattice& lattice) {
  for (Cell& cell : lattice.cells) {
    for (Offset const& o : offsets(cell.strong, spectra_.classes())) {
      Address at = cell.at;
      if (o.a != 0) at[o.class_a] += 2 * o.a;
      if (o.b != 0) at[o.class_b] += 2 * o.b;
      cell.nodes.push_back(node_at(lattice, at));
    }
  }
}

bool StrengthNodes::any_negative() const {
  for (std::size_t i = 0; i < paths_.size(); ++i)
    for (std::size_t c = 0; c < paths_.classes; ++c)
      if (double const k = paths_.of(i)[c]; k < 0 && spectra_.is_strong(c, k)) return true;
  return false;
}

void StrengthNodes::start(double step, std::size_t most, bool stencils) {
  for (double widening = 1;; widening *= 1.5) {
    Lattice lattice{step * widening, drift_step * widening, {}, {}};
    if (!sort_into(lattice, most)) continue;
    node_.clear();
    kappa_.clear();
    if (stencils) place_nodes(lattice);
    if (kappa_.size() > most && lattice.cells.size() > 1) continue;
    lattice_ = std::move(lattice);
    return;
  }
}

bool StrengthNodes::halve(std::size_t most) {
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

bool StrengthNodes::use_strengths() {
  Lattice exact{same, same, {}, {}};
  if (!sort_into(exact, kappa_.size())) return false;
  use_means(std::move(exact));
  found_.clear();
  return true;
}

void StrengthNodes::use_means(Lattice cells) {
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

double StrengthNodes::position(Cell const& cell, std::size_t c, double kappa) const {
  return std::log(std::fabs(kappa)) / lattice_.step_of(spectra_.classes()[c]) - (cell.at[c] >> 1);
}

// Along each axis and for each pair of axes, in the order of `offsets`.
void StrengthNodes::weigh(Cell const& cell, std::span<double const> kappa, std::vector<double>& weight) const {
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

void StrengthNodes::shares(std::size_t path, std::vector<Share>& out) const {
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

}  // namespace straytrace
