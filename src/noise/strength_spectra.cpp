// SPDX-License-Identifier: BSD-3-Clause
// Spectra of the nodes, and how well they hold.
#include <algorithm>
#include <cmath>

#include "noise/strength_nodes.hpp"

namespace straytrace {
namespace {

constexpr double below_highest = 1e-12;  // bins that decide on the step

}  // namespace

void StrengthNodes::compute() {
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

void StrengthNodes::forget_nodes() {
  for (std::size_t n = 0; n < first_basis_.size(); ++n) {
    auto const end = n + 1 < first_basis_.size() ? first_basis_[n + 1] : basis_.size();
    known_[kappa_[n]].assign(basis_.begin() + first_basis_[n], basis_.begin() + static_cast<std::ptrdiff_t>(end));
  }
  first_basis_.clear();
  basis_.clear();
}

// Compares each node with its next one along each axis.
bool StrengthNodes::smooth() const {
  for (auto const& [at, node] : node_) {
    auto const strong = std::count_if(at.begin(), at.end(), [](std::int32_t a) { return a != none; });
    double const limit = std::exp(strong == 1 ? 0.8 : 0.4);
    std::vector<double> const& here = basis_[first_basis_[node]].psd;
    double const floor = below_highest * *std::max_element(here.begin(), here.end());
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

StrengthNodes::Basis StrengthNodes::shared_spectrum(std::size_t path) const {
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

bool StrengthNodes::accurate() {
  found_ = checks_.compared([&](std::size_t path) { return shared_spectrum(path).psd; });
  return std::all_of(found_.begin(), found_.end(), [](SpotCheck const& c) { return c.error <= tolerance; });
}

void StrengthNodes::refine_cells(std::size_t most) {
  while (!accurate()) {
    Lattice finer{lattice_.step / 2, lattice_.drift_step / 2, {}, {}};
    if (!sort_into(finer, most)) return;
    use_means(std::move(finer));
  }
}

}  // namespace straytrace
