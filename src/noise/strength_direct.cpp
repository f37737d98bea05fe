// SPDX-License-Identifier: BSD-3-Clause
// Paths computed by themselves, where spectra of nodes do not hold.
#include <algorithm>
#include <cmath>

#include "noise/strength_nodes.hpp"

namespace straytrace {

void StrengthNodes::compute_paths(std::size_t most) {
  Lattice each{same, same, {}, {}};
  if (!sort_into(each, most)) return use_sample(most);
  mixture_.reset();
  unshared_ = false;
  use_means(std::move(each));
  found_.clear();
}

StrengthNodes::Basis StrengthNodes::own_spectrum(std::size_t path) const {
  PhaseSpectrum s = spectra_(paths_.of(path));
  return {std::move(s.psd), std::move(s.linear)};
}

// The spectra of the nodes stay where the sum of what they leave has the smaller variance, and are taken out elsewhere.
void StrengthNodes::use_sample(std::size_t most) {
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

// Also, no drawn path may be off by more than a tenth of the mean: where some are, rare ones that were not drawn are
// off by more than the draws can tell.
std::vector<bool> StrengthNodes::interpolated_bins(std::vector<Basis> const& own,
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

std::size_t StrengthNodes::drawn() const {
  std::size_t count = 0;
  if (sample_)
    for (StrengthSample::Stratum const& s : sample_->strata()) count += s.single || s.first == s.second ? 1 : 2;
  return count;
}

void StrengthNodes::add_variance(std::span<double const> weights, std::vector<double>& variance) const {
  for (std::size_t s = 0; s < drawn_.size(); ++s) {
    std::size_t const a = drawn_[s], b = a + 1;
    if (sample_->strata()[s].single || (weights[a] == 0 && weights[b] == 0)) continue;
    for (std::size_t i = 0; i < variance.size(); ++i)
      variance[i] += std::pow(weights[a] * basis_[a].psd[i] - weights[b] * basis_[b].psd[i], 2);
  }
}

}  // namespace straytrace
