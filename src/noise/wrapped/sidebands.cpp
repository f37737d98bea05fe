// SPDX-License-Identifier: BSD-3-Clause
#include "noise/wrapped/sidebands.hpp"

#include <algorithm>
#include <cmath>

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

// Neighbouring bins of a width that hardly differs.
struct Octave {
  double high, narrowest;
  // How finely the low part must be known at a frequency that reaches these bins: a quarter of a bin, or half a step
  // of the modulation (1.1 % of its frequency) where that comes from far above.
  double step(double hz) const { return std::max(narrowest / 4, 0.0055 * (hz - high)); }
};

// The low part as lines at their centres of power, and what counts as unshifted.
struct Condensed {
  Kernel lines;
  double at_zero;
};

Condensed condensed(WrappedSpectrum const& low, Octave const& octave) {
  Condensed out{{}, low.constant + low.density[0] * low.spacing / 2};
  std::size_t k = 1;
  auto const hz = [&](std::size_t i) { return static_cast<double>(i) * low.spacing; };
  for (; k < low.density.size() && hz(k) < octave.step(0) / 2; ++k) out.at_zero += low.density[k] * low.spacing;
  while (k < low.density.size()) {
    double const first = hz(k), end = first + octave.step(first);
    double power = 0, moment = 0;
    for (; k < low.density.size() && hz(k) < end; ++k) {
      power += low.density[k];
      moment += low.density[k] * hz(k);
    }
    if (power == 0) continue;
    out.lines.hz.push_back(std::clamp(moment / power, first, end));
    out.lines.power.push_back(power * low.spacing);
  }
  return out;
}

}  // namespace

void add_sidebands(Kernel const& kernel, Steps const& steps, std::span<double const> e, std::span<double> bin_power) {
  if (steps.psd.empty()) return;
  for (std::size_t line = 0; line < kernel.hz.size(); ++line) {
    double const g = kernel.hz[line], half = kernel.power[line] / 2;
    if (e.back() + g <= steps.edges.front() || g - e.back() >= steps.edges.back()) continue;
    Sweep upper(steps), lower(steps), folded(steps);
    for (std::size_t i = 0; i < bin_power.size(); ++i) {
      bin_power[i] += half * upper(e[i] + g, e[i + 1] + g);
      if (e[i + 1] > g) bin_power[i] += half * lower(std::max(e[i] - g, 0.0), e[i + 1] - g);
    }
    for (std::size_t i = bin_power.size(); i-- > 0;)  // frequencies below the line: |f - g| grows downwards
      if (e[i] < g) bin_power[i] += half * folded(std::max(g - e[i + 1], 0.0), g - e[i]);
  }
}

void add_lines(WrappedSpectrum const& low, std::span<double const> edges, std::span<double> bin_power) {
  std::size_t bin = 0;
  for (std::size_t k = 0; k < low.density.size(); ++k) {
    double const from = (static_cast<double>(k) - 0.5) * low.spacing, to = from + low.spacing;
    while (bin < bin_power.size() && edges[bin + 1] <= from) ++bin;
    for (std::size_t i = bin; i < bin_power.size() && edges[i] < to; ++i)
      bin_power[i] += low.density[k] * (std::min(to, edges[i + 1]) - std::max(from, edges[i]));
  }
}

void modulate(WrappedSpectrum const& low, Steps const& fast, std::span<double const> unshifted,
              std::span<double const> edges, std::span<double> bin_power) {
  auto const width = [&](std::size_t i) { return edges[i + 1] - edges[i]; };
  for (std::size_t first = 0, next = 0; first < bin_power.size(); first = next) {
    double narrowest = width(first);
    for (; next < bin_power.size() && width(next) < 2 * width(first) && width(next) > 0.5 * width(first); ++next)
      narrowest = std::min(narrowest, width(next));
    Condensed const c = condensed(low, {edges[next], narrowest});
    for (std::size_t i = first; i < next; ++i) bin_power[i] += c.at_zero * unshifted[i];
    add_sidebands(c.lines, fast, edges.subspan(first, next - first + 1), bin_power.subspan(first, next - first));
  }
}

Steps as_steps(WrappedSpectrum const& low) {
  Steps steps{{0}, low.density};
  for (std::size_t k = 0; k < low.density.size(); ++k)
    steps.edges.push_back((static_cast<double>(k) + 0.5) * low.spacing);
  return steps;
}

}  // namespace straytrace
