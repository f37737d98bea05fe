// SPDX-License-Identifier: BSD-3-Clause
#include "noise/phase_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"

namespace straytrace {
namespace {

bool is_tone(MotionClass const& c) { return c.tone_frequency > 0; }

// Phase power of all Gaussian motion between two frequencies [rad^2].
double gaussian_power(std::span<MotionClass const> classes, std::span<double const> kappa, double low, double high) {
  double sum = 0;
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (!is_tone(classes[c]) && kappa[c] > 0) sum += kappa[c] * classes[c].reference.power(low, high);
  return sum;
}

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

// The low part in steps of `width`, each at its centre of power; without what is at f = 0 within half a step.
Kernel condensed(LowPart const& low, double width) {
  Kernel kernel;
  double step = 0, power = 0, moment = 0;
  auto const flush = [&] {
    if (power > 0 && step > 0) {
      kernel.hz.push_back(moment / power);
      kernel.power.push_back(power);
    }
    power = moment = 0;
  };
  for (std::size_t k = 0; k < low.density.size(); ++k) {
    if (low.density[k] == 0) continue;
    double const f = static_cast<double>(k) * low.spacing, now = std::floor(f / width + 0.5);
    if (now != step) flush();
    step = now;
    power += low.density[k] * low.spacing;
    moment += low.density[k] * low.spacing * f;
  }
  flush();
  return kernel;
}

double power_at_zero(LowPart const& low, double width) {
  double power = low.constant + low.density[0] * low.spacing / 2;
  for (std::size_t k = 1; k < low.density.size(); ++k) {
    if (std::floor(static_cast<double>(k) * low.spacing / width + 0.5) > 0) break;
    power += low.density[k] * low.spacing;
  }
  return power;
}

// The low part as a density that a tone can shift.
Steps as_steps(LowPart const& low) {
  Steps steps{{0}, low.density};
  for (std::size_t k = 0; k < low.density.size(); ++k)
    steps.edges.push_back((static_cast<double>(k) + 0.5) * low.spacing);
  return steps;
}

double total(LowPart const& low) {
  double sum = low.constant + low.density[0] * low.spacing / 2;
  for (std::size_t k = 1; k < low.density.size(); ++k) sum += low.density[k] * low.spacing;
  return sum;
}

}  // namespace

struct PhaseSpectra::Slow : SlowPhase {
  std::span<MotionClass const> classes;
  std::span<double const> kappa;

  double power(double low, double high) const override {
    return gaussian_power(classes, kappa, low, std::min(high, highest));
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

LowPart PhaseSpectra::slow_part(Slow const& slow) const {
  if (slow.highest == 0 && slow.tones.empty()) return {resolution_, {0}, 0.5, 0};  // unmoved light
  return transform(slow, resolution_);
}

// Octave by octave: the low part need not be known finer than a fraction of the bins it is moved into.
void PhaseSpectra::modulate(LowPart const& low, Steps const& fast, std::span<double const> unshifted,
                            std::span<double> bin_power) const {
  for (std::size_t first = 0, next = 0; first < grid_.size(); first = next) {
    double narrowest = grid_.width(first);
    while (next < grid_.size() && grid_.width(next) < 2 * grid_.width(first) &&
           grid_.width(next) > 0.5 * grid_.width(first)) {
      narrowest = std::min(narrowest, grid_.width(next));
      ++next;
    }
    double const step = narrowest / 4;
    std::span<double const> const edges = std::span(grid_.edges).subspan(first, next - first + 1);
    std::span<double> const bins = bin_power.subspan(first, next - first);
    double const at_zero = power_at_zero(low, step);
    for (std::size_t i = first; i < next; ++i) bin_power[i] += at_zero * unshifted[i];
    add_sidebands(condensed(low, step), fast, edges, bins);
  }
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
  LowPart const low = slow_part(slow);
  std::vector<double> power(grid_.size());
  add_lines(low, grid_, power);
  for (PhaseTone const& t : weak_tones) {
    double const z2 = t.peak * t.peak / 2;
    Kernel const line{{t.frequency}, {z2}};
    add_sidebands(line, as_steps(low), grid_.edges, power);
    for (std::size_t i = 0; i < grid_.size(); ++i)
      if (t.frequency >= grid_.edges[i] && t.frequency < grid_.edges[i + 1]) power[i] += low.constant * z2;
    weak_power += z2;
  }
  std::vector<double> unshifted(grid_.size());
  for (std::size_t i = 0; i < grid_.size(); ++i)
    unshifted[i] = gaussian_power(classes_, kappa, std::max(grid_.edges[i], slow.highest), grid_.edges[i + 1]);
  modulate(low, fast_part(kappa, edge), unshifted, power);

  double const kept = std::exp(-weak_power);
  for (std::size_t i = 0; i < grid_.size(); ++i) out.psd.push_back(kept * power[i] / grid_.width(i));
  out.constant = kept * low.constant;
  out.total = total(low) * kept * (1 + weak_power);
  out.split = slow.highest;
  if (!(std::fabs(out.total - 0.5) < 0.5e-3))
    throw NumericalError(fmt::format("power of a fringe spectrum is {:.6g}, not 1/2 (physics.md eq. 7.10)", out.total));
  return out;
}

}  // namespace straytrace
