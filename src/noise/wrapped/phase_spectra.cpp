// SPDX-License-Identifier: BSD-3-Clause
#include "noise/wrapped/phase_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <math.h>

#include "base/errors.hpp"

namespace straytrace::noise {
namespace {

constexpr std::size_t most_kept = std::size_t{1} << 23;  // numbers: 64 MB

}  // namespace

std::vector<double> const& ClassCovariances::line_powers(MotionClass const& motion, std::size_t c, double spacing,
                                                         std::size_t count) {
  std::vector<double>& power = power_[c];
  for (std::size_t k = power.size(); k < count; ++k) {
    double const line = static_cast<double>(k);
    power.push_back(k == 0 ? 0 : motion.reference.power((line - 0.5) * spacing, (line + 0.5) * spacing));
  }
  return power;
}

std::vector<double> ClassCovariances::lines(std::span<MotionClass const> classes, std::span<double const> kappa,
                                            double highest, double spacing) {
  std::vector<double> out(static_cast<std::size_t>(highest / spacing + 0.5) + 1);
  std::size_t const last = out.size() - 1;  // cut off at `highest`
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (kappa[c] == 0 || !classes[c].gaussian()) continue;
    std::vector<double> const& one = line_powers(classes[c], c, spacing, last);
    for (std::size_t k = 1; k < last; ++k) out[k] += kappa[c] * one[k];
    if (last > 0)
      out[last] += kappa[c] * classes[c].reference.power((static_cast<double>(last) - 0.5) * spacing, highest);
  }
  return out;
}

Covariance const& ClassCovariances::of_class(Band& band, std::span<MotionClass const> classes, std::size_t c,
                                             double highest, LagGrid const& lags) {
  if (band[c].at.empty()) {
    std::vector<double> only(classes.size());
    only[c] = 1;
    band[c] = covariance(lines(classes, only, highest, lags.spacing), lags);
    kept_ += band[c].at.size();
  }
  return band[c];
}

Covariance ClassCovariances::sum(std::span<MotionClass const> classes, std::span<double const> kappa, double highest,
                                 LagGrid const& lags) {
  bool const other_lines = lags.spacing != spacing_;
  if (other_lines) power_.assign(classes.size(), {});
  if (other_lines || kept_ > most_kept) {
    bands_.clear();
    kept_ = 0;
  }
  spacing_ = lags.spacing;
  auto const moving = [&](std::size_t c) { return kappa[c] != 0 && classes[c].gaussian(); };
  std::size_t together = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) together += moving(c);
  if (together > few) return covariance(lines(classes, kappa, highest, lags.spacing), lags);
  Band& band = bands_[{highest, lags.samples}];
  band.resize(classes.size());
  Covariance r{0, std::vector<double>(lags.size()), {}};
  std::size_t most_digits = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (!moving(c)) continue;
    Covariance const& one = of_class(band, classes, c, highest, lags);
    r.at_zero += kappa[c] * one.at_zero;
    for (std::size_t i = 0; i < r.at.size(); ++i) r.at[i] += kappa[c] * one.at[i];
    most_digits = std::max(most_digits, one.fall.size());
  }
  r.fall.assign(most_digits, 0);
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (std::size_t i = 0; moving(c) && i < most_digits; ++i) r.fall[i] += kappa[c] * band[c].fall_at(i);
  return r;
}

namespace {

constexpr std::size_t edges_apart = 16;  // splits lie a quarter of an octave apart

bool is_tone(MotionClass const& c) { return c.tone_frequency > 0; }
double drift_hz(double kappa) { return std::sqrt(kappa) / (2 * pi); }

// Phase power of all Gaussian motion between two frequencies [rad^2].
double gaussian_power(std::span<MotionClass const> classes, std::span<double const> kappa, double low, double high) {
  double sum = 0;
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (classes[c].gaussian() && kappa[c] != 0) sum += kappa[c] * classes[c].reference.power(low, high);
  return sum;
}

// Hz, below which there is a thousandth of the power: tails do not decide on the resolution.
double lowest_of(Spectrum const& s) {
  double low = s.lowest(), high = s.highest();
  while (high > 1.001 * low) {
    double const middle = std::sqrt(low * high);
    (s.power(0, middle) < 1e-3 * s.total() ? low : high) = middle;
  }
  return low;
}

}  // namespace

PhaseSpectra::PhaseSpectra(std::vector<MotionClass> classes, FrequencyGrid grid)
    : classes_(std::move(classes)), grid_(std::move(grid)) {
  double lowest = infinity, highest = 0, lowest_power = infinity;
  for (MotionClass const& c : classes_) {
    variance_.push_back(c.variance());
    if (!c.gaussian()) continue;
    lowest = std::min(lowest, c.reference.lowest());
    highest = std::max(highest, c.reference.highest());
    lowest_power = std::min(lowest_power, lowest_of(c.reference));
  }
  resolution_ = std::min({0.01, grid_.edges.front() / 10, grid_.width(0) / 8, std::max(lowest_power / 2, 0.002)});
  auto const bins = lowest < highest ? static_cast<std::size_t>(std::ceil(64 * std::log2(highest / lowest))) : 0;
  for (std::size_t i = 0; bins > 0 && i <= bins; ++i)
    fine_.push_back(lowest * std::pow(highest / lowest, static_cast<double>(i) / static_cast<double>(bins)));
  if (bins > 0) fine_.back() = highest;
  for (MotionClass const& c : classes_) {
    std::vector<double>&psd = fine_psd_.emplace_back(bins), &above = power_above_.emplace_back(bins + 1),
    &in = grid_power_.emplace_back(grid_.size()), &above_bin = above_grid_.emplace_back(grid_.size());
    if (!c.gaussian()) continue;
    for (std::size_t i = bins; i-- > 0;) {
      double const power = c.reference.power(fine_[i], fine_[i + 1]);
      psd[i] = power / (fine_[i + 1] - fine_[i]);
      above[i] = above[i + 1] + power;
    }
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      in[i] = c.reference.power(grid_.edges[i], grid_.edges[i + 1]);
      above_bin[i] = c.reference.power(grid_.edges[i + 1], infinity);
    }
  }
}

double PhaseSpectra::mean_square_phase(std::span<double const> kappa) const {
  double sum = 0;
  for (std::size_t c = 0; c < classes_.size(); ++c)
    sum += !classes_[c].drift ? kappa[c] * variance_[c] : is_strong(c, kappa[c]) ? pi * pi / 3 : 0;
  return sum;
}

bool PhaseSpectra::is_strong(std::size_t c, double kappa) const {
  if (classes_[c].drift) return drift_hz(kappa) >= resolution_ / 2;
  return std::fabs(kappa) * variance_[c] >= weak / (is_tone(classes_[c]) ? 1 : classes_.size());
}

double PhaseSpectra::first_order_weight(std::size_t c, std::size_t bin) const {
  double const hz = classes_[c].tone_frequency;
  bool const tone_in_bin = hz >= grid_.edges[bin] && hz < grid_.edges[bin + 1];
  return (is_tone(classes_[c]) ? (tone_in_bin ? 0.25 : 0) : grid_power_[c][bin] / 2) / grid_.width(bin);
}

// The lowest edge above which the remaining motion is weak, or a little higher: a few different edges share
// covariances.
std::size_t PhaseSpectra::split(std::span<double const> kappa) const {
  std::size_t edge = fine_.empty() ? 0 : fine_.size() - 1;
  for (; edge > 0; --edge) {
    double left = 0;
    for (std::size_t c = 0; c < classes_.size(); ++c) left += std::fabs(kappa[c]) * power_above_[c][edge - 1];
    if (left >= weak) break;
  }
  return std::min((edge + edges_apart - 1) / edges_apart * edges_apart, fine_.empty() ? 0 : fine_.size() - 1);
}

double PhaseSpectra::split_hz(std::span<double const> kappa) const {
  std::size_t const edge = split(kappa);
  return edge > 0 ? fine_[edge] : 0;
}

Steps PhaseSpectra::fast_steps(std::size_t c, double from_hz) const {
  std::vector<double> only(classes_.size());
  only[c] = 1;
  auto const edge = std::ranges::lower_bound(fine_, from_hz) - fine_.begin();
  return fast_part(only, static_cast<std::size_t>(edge));
}

WrappedSpectrum PhaseSpectra::slow_part(SlowPhase const& slow, std::span<double const> kappa) const {
  auto const gaussian = [&](LagGrid const& l) { return covariances_.sum(classes_, kappa, slow.highest, l); };
  bool const unmoved = slow.highest == 0 && slow.tones.empty();
  WrappedSpectrum low = unmoved ? WrappedSpectrum{resolution_, {0}, 0.5, 0} : transform(slow, gaussian, resolution_);
  for (std::size_t c = 0; c < classes_.size(); ++c)
    if (classes_[c].drift && kappa[c] > 0) low = drifting(low, drift_hz(kappa[c]));
  return low;
}

Steps PhaseSpectra::fast_part(std::span<double const> kappa, std::size_t from) const {
  if (fine_.empty()) return {};
  Steps steps{{fine_.begin() + static_cast<std::ptrdiff_t>(from), fine_.end()}, {}};
  steps.psd.assign(steps.edges.size() - 1, 0);
  for (std::size_t c = 0; c < classes_.size(); ++c)
    for (std::size_t i = 0; kappa[c] != 0 && i < steps.psd.size(); ++i)
      steps.psd[i] += kappa[c] * fine_psd_[c][from + i];
  return steps;
}

void PhaseSpectra::add_tone(WrappedSpectrum const& low, double hz, double mean_square,
                            std::span<double> bin_power) const {
  add_sidebands(Kernel{{hz}, {mean_square}}, as_steps(low), grid_.edges, bin_power);
  for (std::size_t i = 0; i < grid_.size(); ++i)
    if (hz >= grid_.edges[i] && hz < grid_.edges[i + 1]) bin_power[i] += low.constant * mean_square;
}

std::vector<double> PhaseSpectra::response(WrappedSpectrum const& low, std::size_t c, double kept) const {
  std::vector<double> power(grid_.size());
  if (is_tone(classes_[c]))
    add_tone(low, classes_[c].tone_frequency, variance_[c], power);
  else if (classes_[c].gaussian())
    modulate(low, fast_steps(c, 0), grid_power_[c], grid_.edges, power);
  for (std::size_t i = 0; i < grid_.size(); ++i) power[i] *= kept / grid_.width(i);
  return power;
}

double PhaseSpectra::moved_by_drifts(std::span<double const> kappa, double low, double high,
                                     std::function<double(double, double)> const& power) const {
  std::vector<double> shifts = {0};
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    if (!classes_[c].drift || !is_strong(c, kappa[c])) continue;
    std::size_t const before = shifts.size();
    for (std::size_t i = 0; i < before; ++i) {
      shifts.push_back(shifts[i] - drift_hz(kappa[c]));
      shifts[i] += drift_hz(kappa[c]);
    }
  }
  double sum = 0;
  for (double const shift : shifts) {
    double const from = low + shift, to = high + shift;
    if (to <= 0)
      sum += power(-to, -from);
    else
      sum += from < 0 ? power(0, -from) + power(0, to) : power(from, to);
  }
  return sum / static_cast<double>(shifts.size());
}

// kappa S/2 of the motion in a band, less the part that faster motion removes; in(c), above(c): power of a class in the
// band and beyond it. Slower motion moves it to neighbouring bins, which is left out.
template <class In, class Above>
double PhaseSpectra::first_order_power(std::span<double const> kappa, double low, double high, In in,
                                       Above above) const {
  double power = 0, faster = 0, kept = 1;
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    if (classes_[c].gaussian()) {
      power += kappa[c] * in(c) / 2;
      faster += kappa[c] * above(c);
    }
    double const hz = classes_[c].tone_frequency, z = is_tone(classes_[c]) ? std::sqrt(kappa[c]) : 0;
    if (hz >= low && hz < high) power += std::pow(::j1(z), 2);
    if (hz >= high) kept *= std::pow(::j0(z), 2);
  }
  return std::exp(-faster) * kept * power;
}

std::vector<double> PhaseSpectra::first_order(std::span<double const> kappa, std::span<double const> psd) const {
  bool drifts = false;
  for (std::size_t c = 0; c < classes_.size(); ++c) drifts |= classes_[c].drift && is_strong(c, kappa[c]);
  auto const anywhere = [&](double low, double high) {
    auto const reference = [&](std::size_t c) -> Spectrum const& { return classes_[c].reference; };
    return first_order_power(
        kappa, low, high, [&](std::size_t c) { return reference(c).power(low, high); },
        [&](std::size_t c) { return reference(c).power(high, infinity); });
  };
  std::vector<double> out;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    double const low = grid_.edges[i], high = grid_.edges[i + 1];
    double const power = drifts ? moved_by_drifts(kappa, low, high, anywhere)
                                : first_order_power(
                                      kappa, low, high, [&](std::size_t c) { return grid_power_[c][i]; },
                                      [&](std::size_t c) { return above_grid_[c][i]; });
    out.push_back(std::clamp(power / grid_.width(i), 0.0, std::max(psd[i], 0.0)));
  }
  return out;
}

PhaseSpectrum PhaseSpectra::strong(std::span<double const> kappa, std::vector<bool> const& responses) const {
  std::size_t const edge = split(kappa);
  SlowPhase slow;
  slow.highest = split_hz(kappa);
  double rate = 0, fast_power = 0;
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    if (is_tone(classes_[c]) && kappa[c] > 0) slow.tones.push_back({classes_[c].tone_frequency, std::sqrt(kappa[c])});
    if (!classes_[c].gaussian() || kappa[c] == 0) continue;
    rate += kappa[c] * classes_[c].reference.rate_power(slow.highest);
    fast_power += kappa[c] * power_above_[c][edge];
  }
  slow.fringe_rate = std::sqrt(std::max(rate, 0.0)) / (2 * pi);

  WrappedSpectrum const low = slow_part(slow, kappa);
  PhaseSpectrum out;
  out.psd.assign(grid_.size(), 0);
  add_lines(low, grid_.edges, out.psd);
  if (fast_power != 0) {
    std::vector<double> unshifted(grid_.size());
    for (std::size_t i = 0; i < grid_.size(); ++i)
      unshifted[i] = gaussian_power(classes_, kappa, std::max(grid_.edges[i], slow.highest), grid_.edges[i + 1]);
    modulate(low, fast_part(kappa, edge), unshifted, grid_.edges, out.psd);
  }
  double const kept = std::exp(-fast_power);
  for (std::size_t i = 0; i < grid_.size(); ++i) out.psd[i] *= kept / grid_.width(i);
  out.linear = first_order(kappa, out.psd);
  for (std::size_t c = 0; c < classes_.size(); ++c)
    out.response.push_back(responses[c] ? response(low, c, kept) : std::vector<double>());
  out.constant = kept * low.constant;
  out.total = total(low) * kept * (1 + fast_power);
  out.split = slow.highest;
  if (!(std::fabs(out.total - 0.5) < conserved / 2))
    throw NumericalError(
        fmt::format("power of a fringe spectrum is {:.9g}, not 1/2 (docs/theory/spectra.md, eq. 7.10)", out.total));
  return out;
}

PhaseSpectrum PhaseSpectra::operator()(std::span<double const> kappa) const {
  std::vector<double> in_exponent(kappa.size());
  std::vector<bool> is_weak(kappa.size());
  double weak_power = 0;
  for (std::size_t c = 0; c < kappa.size(); ++c) {
    if (is_strong(c, kappa[c]))
      in_exponent[c] = kappa[c];
    else if (kappa[c] != 0)
      is_weak[c] = true;
    if (is_weak[c]) weak_power += kappa[c] * variance_[c];
  }
  PhaseSpectrum s = strong(in_exponent, is_weak);
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    s.psd[i] *= 1 - weak_power;
    s.linear[i] *= 1 - weak_power;
    for (std::size_t c = 0; c < kappa.size(); ++c) {
      if (!is_weak[c]) continue;
      s.psd[i] += kappa[c] * s.response[c][i];
      s.linear[i] += kappa[c] * s.response[c][i];
    }
  }
  s.constant *= 1 - weak_power;
  return s;
}

}  // namespace straytrace::noise
