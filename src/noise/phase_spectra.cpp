// SPDX-License-Identifier: BSD-3-Clause
#include "noise/phase_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"

namespace straytrace {
namespace {

bool is_tone(MotionClass const& c) { return c.tone_frequency > 0; }

// Power of the low part in each bin of the grid, its lines taken as wide as their spacing.
void add_lines(LowPart const& low, FrequencyGrid const& grid, std::span<double> bin_power) {
  std::size_t bin = 0;
  for (std::size_t k = 0; k < low.density.size(); ++k) {
    double const from = (static_cast<double>(k) - 0.5) * low.spacing, to = from + low.spacing;
    while (bin < grid.size() && grid.edges[bin + 1] <= from) ++bin;
    for (std::size_t i = bin; i < grid.size() && grid.edges[i] < to; ++i)
      bin_power[i] += low.density[k] * (std::min(to, grid.edges[i + 1]) - std::max(from, grid.edges[i]));
  }
}

// The low part in bins 3 % wide; all that lies within a small part of the first bin of the grid is at f = 0.
Kernel condensed(LowPart const& low, double nil) {
  constexpr double ratio = 1.03;
  Kernel kernel{{0}, {low.constant + low.density[0] * low.spacing / 2}};
  double end = 0, power = 0, moment = 0;
  auto const flush = [&] {
    if (power > 0) {
      kernel.hz.push_back(moment / power);
      kernel.power.push_back(power);
    }
    power = moment = 0;
  };
  for (std::size_t k = 1; k < low.density.size(); ++k) {
    double const f = static_cast<double>(k) * low.spacing, p = low.density[k] * low.spacing;
    if (f < nil) {
      kernel.power[0] += p;
      continue;
    }
    if (f > end) {
      flush();
      end = f * ratio;
    }
    power += p;
    moment += p * f;
  }
  flush();
  return kernel;
}

}  // namespace

struct PhaseSpectra::Slow : SlowPhase {
  std::span<MotionClass const> classes;
  std::span<double const> kappa;

  double power(double low, double high) const override {
    double sum = 0;
    for (std::size_t c = 0; c < classes.size(); ++c)
      if (!is_tone(classes[c]) && kappa[c] > 0)
        sum += kappa[c] * classes[c].reference.power(low, std::min(high, highest));
    return sum;
  }
};

PhaseSpectra::PhaseSpectra(std::vector<MotionClass> classes, FrequencyGrid grid)
    : classes_(std::move(classes)), grid_(std::move(grid)) {
  double lowest = infinity, highest = 0;
  for (MotionClass const& c : classes_) {
    if (is_tone(c)) continue;
    lowest = std::min(lowest, c.reference.lowest());
    highest = std::max(highest, c.reference.highest());
  }
  resolution_ = std::min({0.01, grid_.edges.front() / 10, grid_.width(0) / 8, std::max(lowest / 2, 0.002)});
  fine_psd_.resize(classes_.size());
  power_above_.resize(classes_.size());
  if (!(lowest < highest)) return;
  auto const bins = static_cast<std::size_t>(std::ceil(64 * std::log2(highest / lowest)));
  for (std::size_t i = 0; i <= bins; ++i)
    fine_.push_back(lowest * std::pow(highest / lowest, static_cast<double>(i) / static_cast<double>(bins)));
  fine_.back() = highest;
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    fine_psd_[c].assign(bins, 0);
    power_above_[c].assign(bins + 1, 0);
    for (std::size_t i = bins; i-- > 0;) {
      double const power = classes_[c].reference.power(fine_[i], fine_[i + 1]);
      fine_psd_[c][i] = power / (fine_[i + 1] - fine_[i]);
      power_above_[c][i] = power_above_[c][i + 1] + power;
    }
  }
}

double PhaseSpectra::mean_square_phase(std::span<double const> kappa) const {
  double sum = 0;
  for (std::size_t c = 0; c < classes_.size(); ++c) sum += kappa[c] * classes_[c].variance();
  return sum;
}

// The lowest edge above which all that is left is weak.
std::size_t PhaseSpectra::split(std::span<double const> kappa) const {
  std::size_t edge = fine_.empty() ? 0 : fine_.size() - 1;
  for (; edge > 0; --edge) {
    double left = 0;
    for (std::size_t c = 0; c < classes_.size(); ++c) left += kappa[c] * power_above_[c][edge - 1];
    if (left >= weak) break;
  }
  return edge;
}

Kernel PhaseSpectra::slow_part(Slow const& slow, std::span<double> bin_power, double& constant) const {
  if (slow.highest == 0 && slow.tones.empty()) {
    constant = 0.5;
    return {{0}, {0.5}};
  }
  LowPart const low = transform(slow, resolution_);
  constant = low.constant;
  add_lines(low, grid_, bin_power);
  return condensed(low, grid_.width(0) / 20);
}

Steps PhaseSpectra::fast_part(std::span<double const> kappa, std::size_t from) const {
  Steps steps{{fine_.begin() + static_cast<std::ptrdiff_t>(from), fine_.end()}, {}};
  for (std::size_t i = from; i + 1 < fine_.size(); ++i) {
    double sum = 0;
    for (std::size_t c = 0; c < classes_.size(); ++c)
      if (kappa[c] > 0 && !is_tone(classes_[c])) sum += kappa[c] * fine_psd_[c][i];
    steps.psd.push_back(sum);
  }
  return steps;
}

PhaseSpectrum PhaseSpectra::operator()(std::span<double const> kappa) const {
  std::size_t const edge = split(kappa);
  Slow slow;
  slow.classes = classes_;
  slow.kappa = kappa;
  slow.highest = edge > 0 ? fine_[edge] : 0;
  double rate = 0, weak_power = 0;
  std::vector<PhaseTone> weak_tones;
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    if (is_tone(classes_[c])) {
      auto& list = kappa[c] / 2 < weak ? weak_tones : slow.tones;
      if (kappa[c] > 0) list.push_back({classes_[c].tone_frequency, std::sqrt(kappa[c])});
    } else {
      rate += kappa[c] * classes_[c].reference.rate_power(slow.highest);
      if (!fine_.empty()) weak_power += kappa[c] * power_above_[c][edge];
    }
  }
  slow.fringe_rate = std::sqrt(rate) / (2 * pi);

  PhaseSpectrum out;
  std::vector<double> power(grid_.size()), moved(grid_.size());
  Kernel kernel = slow_part(slow, power, out.constant);
  double slow_total = 0;
  for (double p : kernel.power) slow_total += p;
  for (PhaseTone const& t : weak_tones) {
    constexpr double narrow = 1e-9;
    double const z2 = t.peak * t.peak / 2, width = 2 * narrow * t.frequency;
    add_sidebands(kernel, {{t.frequency - width / 2, t.frequency + width / 2}, {z2 / width}}, grid_, moved);
    weak_power += z2;
  }
  // At g = 0 the exact integrals of the spectra; elsewhere their averages in fine bins.
  for (std::size_t c = 0; c < classes_.size(); ++c)
    for (std::size_t i = 0; i < grid_.size() && kappa[c] > 0; ++i)
      moved[i] += kernel.power[0] * kappa[c] *
                  classes_[c].reference.power(std::max(grid_.edges[i], slow.highest), grid_.edges[i + 1]);
  kernel.hz.erase(kernel.hz.begin());
  kernel.power.erase(kernel.power.begin());
  if (!kernel.hz.empty()) add_sidebands(kernel, fast_part(kappa, edge), grid_, moved);

  double const kept = std::exp(-weak_power);
  for (std::size_t i = 0; i < grid_.size(); ++i) out.psd.push_back(kept * (power[i] + moved[i]) / grid_.width(i));
  out.constant *= kept;
  out.total = slow_total * kept * (1 + weak_power);
  out.split = slow.highest;
  if (!(std::fabs(out.total - 0.5) < 0.5e-3))
    throw NumericalError(fmt::format("power of a fringe spectrum is {:.6g}, not 1/2 (physics.md eq. 7.10)", out.total));
  return out;
}

}  // namespace straytrace
