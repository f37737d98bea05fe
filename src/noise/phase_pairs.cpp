// SPDX-License-Identifier: BSD-3-Clause
#include "noise/phase_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <math.h>

#include "base/message.hpp"

namespace straytrace {
namespace {

// The strongest motion of any pair, in each class: it decides on the split and on the lags.
std::vector<double> strongest(std::span<PhasePair const> pairs, std::size_t classes) {
  std::vector<double> kappa(classes);
  for (PhasePair const& p : pairs)
    for (std::size_t c = 0; c < classes; ++c) kappa[c] = std::max(kappa[c], std::fabs(p.own[c]));
  return kappa;
}

class Pairs {
 public:
  Pairs(PhaseSpectra const& spectra, std::span<PhasePair const> pairs)
      : spectra_(spectra), pairs_(pairs), edge_(spectra.split_hz(strongest(pairs, spectra.classes().size()))) {
    std::vector<double> const kappa = strongest(pairs, classes().size());
    double rate = 0;
    for (std::size_t c = 0; c < classes().size(); ++c) {
      if (classes()[c].drift && kappa[c] > 0)
        throw NumericalError("fields with known phases cannot be added while they drift (physics.md eq. 10.5)");
      if (classes()[c].tone_frequency > 0 && kappa[c] > 0)
        slow_.tones.push_back({classes()[c].tone_frequency, std::sqrt(2 * kappa[c])});
      if (!(classes()[c].tone_frequency > 0)) rate += kappa[c] * classes()[c].reference.rate_power(edge_);
    }
    slow_.highest = edge_;
    slow_.fringe_rate = std::sqrt(2 * rate) / (2 * pi);
  }

  PairSpectrum spectrum() {
    FrequencyGrid const& grid = spectra_.grid();
    PairSpectrum out{std::vector<double>(grid.size()), 0};
    LagGrid lags = lags_for(slow_, spectra_.resolution());
    for (; lags.samples <= most_samples; lags.samples *= 2) {
      prepare(lags);
      LowPart low;
      if (!transformed([&](PhasePair const& p) { return p.weight * (1 - fast_power(p)); }, lags, low)) continue;
      add_lines(low, grid.edges, out.psd);
      out.constant = low.constant;
      for (std::size_t c = 0; c < classes().size(); ++c) {
        if (classes()[c].tone_frequency > 0 || classes()[c].reference.highest() <= edge_) continue;
        transformed([&](PhasePair const& p) { return p.weight * p.cross[c]; }, lags, low);
        Spectrum const& s = classes()[c].reference;
        Steps const fast = spectra_.fast_steps(c, edge_);
        std::vector<double> unshifted;
        for (std::size_t i = 0; i < grid.size(); ++i)
          unshifted.push_back(s.power(std::max(grid.edges[i], edge_), grid.edges[i + 1]));
        modulate(low, fast, unshifted, grid.edges, out.psd);
      }
      for (std::size_t i = 0; i < grid.size(); ++i) out.psd[i] /= grid.width(i);
      return out;
    }
    throw too_strong(slow_, lags);
  }

 private:
  std::vector<MotionClass> const& classes() const { return spectra_.classes(); }

  double fast_power(PhasePair const& p) const {
    double sum = 0;
    for (std::size_t c = 0; c < classes().size(); ++c)
      if (!(classes()[c].tone_frequency > 0)) sum += p.own[c] * classes()[c].reference.power(edge_, infinity);
    return sum;
  }

  // Covariance of each class, or the cosine of a tone.
  void prepare(LagGrid const& lags) {
    lag_functions_.clear();
    for (MotionClass const& c : classes()) {
      Covariance r;
      if (!(c.tone_frequency > 0)) r = ClassCovariances().sum({&c, 1}, std::array{1.0}, edge_, lags);
      for (std::size_t i = 0; c.tone_frequency > 0 && i < lags.size(); ++i)
        r.at.push_back(std::cos(2 * pi * lags.turns(c.tone_frequency, i)));
      lag_functions_.push_back(std::move(r));
    }
  }

  double correlation(PhasePair const& p, std::size_t lag) const {
    double exponent = 0, factor = 1;
    for (std::size_t c = 0; c < classes().size(); ++c) {
      Covariance const& r = lag_functions_[c];
      if (classes()[c].tone_frequency > 0)
        factor *= ::j0(std::sqrt(std::max(0.0, 2 * p.own[c] - 2 * p.cross[c] * r.at[lag])));
      else
        exponent += p.cross[c] * r.at[lag] - p.own[c] * r.at_zero;
    }
    return factor * std::exp(exponent);
  }

  // Mean over all lags in the limit of no correlation: cross = 0; of a tone J_0(a)^2 or J_0(a) J_0(b) by Neumann's sum.
  double unmoved(PhasePair const& p) const {
    double value = 1;
    for (std::size_t c = 0; c < classes().size(); ++c) {
      double const own = p.own[c], cross = p.cross[c];
      if (classes()[c].tone_frequency > 0) {  // a^2 + b^2 = 2 own, a b = cross
        double const sum = std::sqrt(std::max(0.0, 2 * own + 2 * cross)),
                     difference = std::sqrt(std::max(0.0, 2 * own - 2 * cross));
        value *= ::j0((sum + difference) / 2) * ::j0((sum - difference) / 2);
      } else {
        value *= std::exp(-own * lag_functions_[c].at_zero);
      }
    }
    return value;
  }

  template <class Weight>
  bool transformed(Weight&& weight, LagGrid const& lags, LowPart& low) const {
    std::vector<double> sum(lags.size());
    double constant = 0, largest = 0, rounding = 0;
    for (PhasePair const& p : pairs_) {
      double const w = weight(p), unmoved_power = unmoved(p);
      constant += w * unmoved_power;
      largest += std::fabs(w);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += w * (correlation(p, i) - unmoved_power);
    }
    double r0 = 0;
    std::vector<double> const kappa = strongest(pairs_, classes().size());
    for (std::size_t c = 0; c < classes().size(); ++c)
      if (!(classes()[c].tone_frequency > 0)) r0 += kappa[c] * lag_functions_[c].at_zero;
    rounding = rounding_of(slow_, sum, r0, largest) + 8 * largest * std::sqrt(double(lags.samples));
    low.constant = constant / 2;
    return transform_lags(sum, lags, rounding, low);
  }

  PhaseSpectra const& spectra_;
  std::span<PhasePair const> pairs_;
  double edge_;  // Hz, f1 of eq. 7.14
  SlowPhase slow_;
  std::vector<Covariance> lag_functions_;  // of a tone: its cosine
};

}  // namespace

PairSpectrum pair_spectrum(PhaseSpectra const& spectra, std::span<PhasePair const> pairs) {
  return Pairs(spectra, pairs).spectrum();
}

std::vector<PhasePair> with_static_phase(std::span<double const> kappa, double phi_0) {
  std::vector<double> own(kappa.begin(), kappa.end()), against = own;
  for (double& k : against) k = -k;
  return {{1, own, own}, {-std::cos(2 * phi_0), own, against}};
}

std::vector<PhasePair> coherent_family(MotionSet const& motion, std::vector<MotionClass> const& classes,
                                       std::span<CoherentPath const> paths) {
  if (paths.size() > most_coherent)
    throw NumericalError(fmt::format("{} paths cannot be added as fields: at most {}", paths.size(), most_coherent));
  std::vector<std::vector<double>> kappa;
  for (CoherentPath const& p : paths) kappa.push_back(kappa_of(motion, classes, p.levers));
  std::vector<PhasePair> pairs;
  for (std::size_t j = 0; j < paths.size(); ++j) {
    pairs.push_back({std::norm(paths[j].field), kappa[j], kappa[j]});
    for (std::size_t k = j + 1; k < paths.size(); ++k) {
      std::vector<Lever> apart = paths[j].levers;
      for (Lever l : paths[k].levers) {
        for (double& d : l.d) d = -d;
        apart.push_back(l);
      }
      std::vector<double> own = kappa_of(motion, classes, apart), cross = own;  // of the difference of both phases
      for (std::size_t c = 0; c < classes.size(); ++c) {
        double const both = (kappa[j][c] + kappa[k][c]) / 2;
        cross[c] = both - own[c] / 2;
        own[c] = both;
      }
      pairs.push_back({2 * (paths[j].field * std::conj(paths[k].field)).real(), std::move(own), std::move(cross)});
    }
  }
  return pairs;
}

}  // namespace straytrace
