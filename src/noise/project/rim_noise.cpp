// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/rim_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"

namespace straytrace::noise {
namespace {

using Kappa = std::vector<double>;

// One-sided PSD of a motion: of the Gaussian classes, and tones.
class MotionPower {
 public:
  MotionPower(std::vector<MotionClass> const& classes, Kappa const& kappa) {
    for (std::size_t c = 0; c < classes.size(); ++c) {
      MotionClass const& m = classes[c];
      if (kappa[c] == 0 || m.drift) continue;
      if (m.gaussian())
        gaussian_.emplace_back(kappa[c], &m.reference);
      else
        tones_.emplace_back(m.tone_frequency, kappa[c]);
    }
  }
  // Integral over a band, which may reach below 0 Hz, where the PSD is that at |f|.
  double in(double low, double high) const {
    if (low < 0) return in(0, std::max(high, -low)) + (high > 0 ? in(0, std::min(high, -low)) : -in(0, -high));
    double sum = 0;
    for (auto const& [k, s] : gaussian_) sum += k * s->power(low, high);
    return sum;
  }
  double lowest() const {
    double hz = infinity;
    for (auto const& [k, s] : gaussian_) hz = std::min(hz, s->lowest());
    return hz;
  }
  double highest() const {
    double hz = 0;
    for (auto const& [k, s] : gaussian_) hz = std::max(hz, s->highest());
    return hz;
  }
  std::vector<std::pair<double, double>> const& tones() const { return tones_; }  // Hz, square of the peak

 private:
  std::vector<std::pair<double, Spectrum const*>> gaussian_;
  std::vector<std::pair<double, double>> tones_;
};

// Bins of the slow one of two motions whose frequencies add, each with its power.
struct FineBins {
  std::vector<double> edges, power;
  explicit FineBins(MotionPower const& s) {
    constexpr double ratio = 1.03;
    if (!(s.highest() > 0)) return;
    double const low = std::max(s.lowest(), 1e-6 * s.highest());
    if (s.lowest() < low) edges.push_back(s.lowest());
    for (double f = low; f < s.highest() * ratio; f *= ratio) edges.push_back(f);
    for (std::size_t i = 1; i < edges.size(); ++i) power.push_back(s.in(edges[i - 1], edges[i]));
  }
};

// Mean over a bin of the convolution S * S over both signs, of the Gaussian motion alone. The frequency of the slow
// factor is at most half of the sum.
double gaussian_pairs(MotionPower const& s, FineBins const& slow, double low, double high) {
  double const half = 0.25 * (low + high);
  double sum = 0;
  for (std::size_t i = 0; i < slow.power.size(); ++i) {
    double const u = std::sqrt(slow.edges[i] * slow.edges[i + 1]);
    sum += slow.power[i] * s.in(low + u, high + u);  // difference of two frequencies
    if (slow.edges[i] >= half) continue;
    double const to = std::min(slow.edges[i + 1], half), v = std::sqrt(slow.edges[i] * to);
    sum += (to == half ? s.in(slow.edges[i], half) : slow.power[i]) * s.in(low - v, high - v);
  }
  return 2 * sum / (high - low);
}

// The same of a tone with the Gaussian motion, and of tones with each other.
double tone_pairs(MotionPower const& s, double low, double high) {
  double sum = 0;
  auto const line = [&](double hz) { return hz >= low && hz < high ? 1.0 : 0.0; };
  auto const& tones = s.tones();
  for (std::size_t t = 0; t < tones.size(); ++t) {
    auto const [hz, square] = tones[t];
    sum += square * (s.in(low - hz, high - hz) + s.in(low + hz, high + hz));
    sum += square * square / 8 * line(2 * hz);
    for (std::size_t other = 0; other < t; ++other)
      sum +=
          square * tones[other].second / 2 * (line(hz + tones[other].first) + line(std::fabs(hz - tones[other].first)));
  }
  return sum / (high - low);
}

std::vector<PhaseSensitivity> combined(std::vector<PhaseSensitivity> const& a, std::vector<PhaseSensitivity> const& b,
                                       double sign) {
  std::vector<PhaseSensitivity> sum = a;
  for (PhaseSensitivity const& s : b) {
    auto at = std::ranges::find(sum, s.body, &PhaseSensitivity::body);
    if (at == sum.end()) at = sum.insert(at, {s.body, {}});
    for (int i = 0; i < 6; ++i) at->d[i] += sign * s.d[i];
  }
  return sum;
}

}  // namespace

Bins squared_motion(PhaseSpectra const& spectra, MotionSet const& motion,
                    std::span<std::vector<PhaseSensitivity> const> directions, std::span<double const> signs) {
  FrequencyGrid const& grid = spectra.grid();
  Bins psd(grid.size());
  for (std::size_t a = 0; a < directions.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      Kappa kappa = kappa_of(motion, spectra.classes(), combined(directions[a], directions[b], 1));
      Kappa const apart = kappa_of(motion, spectra.classes(), combined(directions[a], directions[b], -1));
      for (std::size_t c = 0; c < kappa.size(); ++c) kappa[c] = (kappa[c] - apart[c]) / 4;
      MotionPower const s(spectra.classes(), kappa);
      FineBins const slow(s);
      double const factor = (a == b ? 0.25 : 0.5) * signs[a] * signs[b];
      for (std::size_t i = 0; i < psd.size(); ++i) {
        double const low = grid.edges[i], high = grid.edges[i + 1];
        psd[i] += factor * (gaussian_pairs(s, slow, low, high) + tone_pairs(s, low, high));
      }
    }
  for (double& x : psd) x = std::max(0.0, x);
  return psd;
}

InputError without_passing_amplitude(std::string const& port) {
  return InputError(fmt::format("the interferometer has no response to the amplitude of the main beam at port '{}', "
                                "which the rims of 'rims' change",
                                port),
                    "take a preset that solves the network, for example 'preset: adv', or write 'rims: off'");
}

RimTerms rim_terms(CouplingClass const& c) {
  RimTerms terms;
  for (PathRecord const& r : c.records)
    if (RimTerm(r.event) == RimTerm::first) {
      terms.first = &r;
    } else {
      terms.second.push_back(&r);
      terms.sign.push_back(RimTerm(r.event) == RimTerm::second_plus ? 1 : -1);
    }
  if (!terms.first) throw NumericalError("a route of kind rim has no term of first order");
  return terms;
}

RouteSpectrum rim_spectrum(PhaseSpectra const& spectra, MotionSet const& motion, CouplingClass const& c) {
  RimTerms const terms = rim_terms(c);
  double const removed = terms.first->weight;
  Kappa const kappa = kappa_of(motion, spectra.classes(), terms.first->phase_sensitivities);
  RouteSpectrum route;
  route.exact = true;
  route.mean_square_phase = spectra.mean_square_phase(kappa);
  route.linear.resize(spectra.grid().size());
  // The first-order weight is that of one quadrature in the mean over static phases, half of the whole.
  for (std::size_t i = 0; i < route.linear.size(); ++i)
    for (std::size_t k = 0; k < kappa.size(); ++k)
      if (!spectra.classes()[k].drift) route.linear[i] += 2 * removed * kappa[k] * spectra.first_order_weight(k, i);
  std::vector<std::vector<PhaseSensitivity>> second;
  for (PathRecord const* r : terms.second) second.push_back(r->phase_sensitivities);
  route.psd = squared_motion(spectra, motion, second, terms.sign);
  for (std::size_t i = 0; i < route.psd.size(); ++i) route.psd[i] = route.linear[i] + removed * route.psd[i];
  return route;
}

}  // namespace straytrace::noise
