// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/first_order_ratio.hpp"

#include <numeric>

#include "noise/project/route_noise.hpp"

namespace straytrace {

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

}  // namespace straytrace
