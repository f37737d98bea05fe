// SPDX-License-Identifier: BSD-3-Clause
#include "noise/sidebands.hpp"

#include <algorithm>

namespace straytrace {
namespace {

// Integral of the steps over intervals whose lower ends come in increasing order.
class Sweep {
 public:
  explicit Sweep(Steps const& steps) : edges_(steps.edges), psd_(steps.psd) {}
  double operator()(double low, double high) {
    if (fresh_) at_ = static_cast<std::size_t>(std::upper_bound(edges_.begin(), edges_.end(), low) - edges_.begin());
    if (fresh_ && at_ > 0) --at_;
    fresh_ = false;
    while (at_ < psd_.size() && edges_[at_ + 1] <= low) ++at_;
    double sum = 0;
    for (std::size_t j = at_; j < psd_.size() && edges_[j] < high; ++j)
      sum += psd_[j] * (std::min(high, edges_[j + 1]) - std::max(low, edges_[j]));
    return sum;
  }

 private:
  std::vector<double> const &edges_, &psd_;
  std::size_t at_ = 0;
  bool fresh_ = true;
};

}  // namespace

void add_sidebands(Kernel const& kernel, Steps const& steps, std::span<double const> e, std::span<double> bin_power) {
  if (steps.psd.empty()) return;
  for (std::size_t line = 0; line < kernel.hz.size(); ++line) {
    double const g = kernel.hz[line], half = kernel.power[line] / 2;
    Sweep upper(steps), lower(steps), folded(steps);
    for (std::size_t i = 0; i < bin_power.size(); ++i) {
      bin_power[i] += half * upper(e[i] + g, e[i + 1] + g);
      if (e[i + 1] > g) bin_power[i] += half * lower(std::max(e[i] - g, 0.0), e[i + 1] - g);
    }
    for (std::size_t i = bin_power.size(); i-- > 0;)  // frequencies below the line: |f - g| grows downwards
      if (e[i] < g) bin_power[i] += half * folded(std::max(g - e[i + 1], 0.0), g - e[i]);
  }
}

}  // namespace straytrace
