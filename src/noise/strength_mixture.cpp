// SPDX-License-Identifier: BSD-3-Clause
// Paths that several classes of Gaussian motion move strongly.
#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "noise/strength_nodes.hpp"

namespace straytrace {

// Of the slow part of the strongest path: what lies above is linear and has no part in the wrapping of fringes.
std::vector<double> StrengthNodes::square_rates() const {
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
    // The share of u that is mere strength keeps apart what is too fast to wrap.
    rate[c] = one.reference.rate_power(highest) + 1e-3 * highest * highest * spectra_.variance(c);
  }
  for (std::size_t i = 0; i < paths_.size(); ++i)
    for (std::size_t c = 0; c < classes; ++c)
      if (rate[c] > 0 && paths_.of(i)[c] < 0) return {};
  return std::count_if(rate.begin(), rate.end(), [](double r) { return r > 0; }) > 1 ? rate : std::vector<double>();
}

bool StrengthNodes::use_mixture(Options const& options) {
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

// False when the paths have no more strengths than it has nodes: these are then used.
bool StrengthNodes::try_mixture(std::vector<double> const& rate, double least, double step, std::size_t most) {
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

void StrengthNodes::mixed_shares(std::size_t path, std::vector<Share>& out) const {
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

}  // namespace straytrace
