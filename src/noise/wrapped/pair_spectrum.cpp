// SPDX-License-Identifier: BSD-3-Clause
// Spectra of sums of correlations whose exponents hold two numbers per class of motion.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <math.h>

#include "base/errors.hpp"
#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace::noise {
namespace {

using Values = std::vector<double>;

// The strongest motion of any pair, in each class: it decides on the split and on the lags.
Values strongest(std::span<PhasePair const> pairs, std::size_t classes) {
  Values kappa(classes);
  for (PhasePair const& p : pairs)
    for (std::size_t c = 0; c < classes; ++c) kappa[c] = std::max(kappa[c], std::fabs(p.own[c]));
  return kappa;
}

// Whether two paths drift apart: the square of the difference of their rates is 2 (own - cross).
bool drift_apart(PhaseSpectra const& spectra, PhasePair const& p) {
  for (std::size_t c = 0; c < p.own.size(); ++c)
    if (spectra.classes()[c].drift && spectra.is_strong(c, 2 * (p.own[c] - p.cross[c]))) return true;
  return false;
}

// To a part in 1e12: exponents that differ only by rounding are equal.
double rounded(double x) {
  int exponent;
  double const mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, 40)), exponent - 40);
}

// Terms with a non-zero mean; terms of equal exponents are merged.
std::vector<PhasePair> distinct(PhaseSpectra const& spectra, std::span<PhasePair const> pairs) {
  std::map<Values, std::size_t> place;
  std::vector<PhasePair> out;
  for (PhasePair const& p : pairs) {
    if (drift_apart(spectra, p)) continue;
    Values key;
    for (Values const* part : {&p.own, &p.cross})
      for (double const x : *part) key.push_back(rounded(x));
    auto const [at, added] = place.try_emplace(std::move(key), out.size());
    if (added)
      out.push_back(p);
    else
      out[at->second].weight += p.weight;
  }
  return out;
}

// Peaks a, b [rad] of a tone on the two paths: a^2 + b^2 = 2 own, a b = cross.
std::pair<double, double> peaks(double own, double cross) {
  double const sum = std::sqrt(std::max(0.0, 2 * own + 2 * cross)),
               difference = std::sqrt(std::max(0.0, 2 * own - 2 * cross));
  return {(sum + difference) / 2, (sum - difference) / 2};
}
// Neumann's sum: mean of J_0 over all phases of the tone.
double mean_of_tone(double own, double cross) {
  auto const [a, b] = peaks(own, cross);
  return ::j0(a) * ::j0(b);
}
double apart_by_tone(double own, double cross) { return ::j0(std::sqrt(std::max(0.0, 2 * own - 2 * cross))); }

class Pairs {
 public:
  Pairs(PhaseSpectra const& spectra, std::span<PhasePair const> pairs)
      : spectra_(spectra),
        pairs_(distinct(spectra, pairs)),
        strongest_(strongest(pairs_, spectra.classes().size())),
        edge_(spectra.split_hz(strongest_)) {
    double rate = 0;
    for (std::size_t c = 0; c < classes().size(); ++c) {
      if (is_tone(c) && strongest_[c] > 0)
        slow_.tones.push_back({classes()[c].tone_frequency, std::sqrt(2 * strongest_[c])});
      if (classes()[c].drift) drift_ += std::sqrt(strongest_[c]) / (2 * pi);
      if (is_gaussian(c)) rate += strongest_[c] * classes()[c].reference.rate_power(edge_);
      if (is_gaussian(c) && classes()[c].reference.highest() > edge_) fast_.push_back(c);
    }
    slow_.highest = edge_;
    slow_.fringe_rate = std::sqrt(2 * rate) / (2 * pi);
  }

  PairSpectrum spectrum() {
    FrequencyGrid const& grid = spectra_.grid();
    LagGrid lags = lags_for(slow_, spectra_.resolution());
    double const room = 4.0 / 3 * double(lags.samples) + 8.0 / 3 * drift_ / lags.spacing;
    while (drift_ > 0 && double(lags.samples) < room && lags.samples <= most_samples) lags.samples *= 2;
    for (; lags.samples <= most_samples; lags.samples = more_samples(lags.samples)) {
      prepare(lags);
      PairSpectrum out{Values(grid.size()), {}, 0};
      WrappedSpectrum low;
      std::vector<Part> const parts = correlations(lags);
      if (!transformed(parts[0], lags, low)) continue;
      add_lines(low, grid.edges, out.psd);
      out.constant = low.constant;
      for (std::size_t k = 0; k < fast_.size(); ++k) {
        transformed(parts[k + 1], lags, low);
        Spectrum const& s = classes()[fast_[k]].reference;
        Values unshifted;
        for (std::size_t i = 0; i < grid.size(); ++i)
          unshifted.push_back(s.power(std::max(grid.edges[i], edge_), grid.edges[i + 1]));
        modulate(low, spectra_.fast_steps(fast_[k], edge_), unshifted, grid.edges, out.psd);
      }
      for (std::size_t i = 0; i < grid.size(); ++i) out.psd[i] /= grid.width(i);
      out.linear = first_order(out.psd);
      return out;
    }
    throw too_strong(slow_, lags);
  }

 private:
  // Sum over the pairs of a weight times the correlation less its mean over all lags.
  struct Part {
    Values sum;
    double constant = 0, largest = 0;  // sums of those means, and of the sizes of the weights
  };

  std::vector<MotionClass> const& classes() const { return spectra_.classes(); }
  bool is_tone(std::size_t c) const { return classes()[c].tone_frequency > 0; }
  bool is_gaussian(std::size_t c) const { return !is_tone(c) && !classes()[c].drift; }

  double fast_power(PhasePair const& p) const {
    double sum = 0;
    for (std::size_t const c : fast_) sum += p.own[c] * classes()[c].reference.power(edge_, infinity);
    return sum;
  }

  // Cosine of a frequency, taken to the nearest line.
  static double cosine(double hz, LagGrid const& lags, std::size_t lag) {
    return std::cos(2 * pi * lags.turns(hz, lag));
  }

  // Covariance of each class, or the cosine of a tone.
  void prepare(LagGrid const& lags) {
    lag_functions_.clear();
    for (std::size_t c = 0; c < classes().size(); ++c) {
      Covariance r;
      if (is_gaussian(c)) r = ClassCovariances().sum({&classes()[c], 1}, std::array{1.0}, edge_, lags);
      for (std::size_t i = 0; is_tone(c) && i < lags.size(); ++i)
        r.at.push_back(cosine(classes()[c].tone_frequency, lags, i));
      lag_functions_.push_back(std::move(r));
    }
  }

  double correlation(PhasePair const& p, std::size_t lag) const {
    double exponent = 0, factor = 1;
    for (std::size_t c = 0; c < classes().size(); ++c) {
      Covariance const& r = lag_functions_[c];
      if (is_tone(c))
        factor *= apart_by_tone(p.own[c], p.cross[c] * r.at[lag]);
      else if (is_gaussian(c))
        exponent += lag < r.fall.size() ? (p.cross[c] - p.own[c]) * r.at_zero - p.cross[c] * r.fall[lag]
                                        : p.cross[c] * r.at[lag] - p.own[c] * r.at_zero;
    }
    return factor * std::exp(exponent);
  }

  // Frequencies that a pair drifts by, of at least one line.
  Values drifts(PhasePair const& p, LagGrid const& lags) const {
    Values hz;
    for (std::size_t c = 0; c < classes().size(); ++c)
      if (double const f = std::sqrt(std::fabs(p.own[c])) / (2 * pi);
          classes()[c].drift && std::round(f / lags.spacing) > 0)
        hz.push_back(f);
    return hz;
  }

  // Mean over all lags in the limit of no correlation: cross = 0.
  double unmoved(PhasePair const& p) const {
    double value = 1;
    for (std::size_t c = 0; c < classes().size(); ++c)
      if (is_tone(c))
        value *= mean_of_tone(p.own[c], p.cross[c]);
      else if (is_gaussian(c))
        value *= std::exp(-p.own[c] * lag_functions_[c].at_zero);
    return value;
  }

  // Of the slow part, and of the first order in each fast class.
  std::vector<Part> correlations(LagGrid const& lags) const {
    std::vector<Part> parts(1 + fast_.size(), {Values(lags.size())});
    for (PhasePair const& p : pairs_) {
      Values weight = {p.weight * (1 - fast_power(p))};
      for (std::size_t const c : fast_) weight.push_back(p.weight * p.cross[c]);
      Values const moving = drifts(p, lags);
      double const still = moving.empty() ? unmoved(p) : 0;  // a drift turns it into a line
      for (std::size_t k = 0; k < parts.size(); ++k) {
        parts[k].constant += weight[k] * still;
        parts[k].largest += std::fabs(weight[k]);
      }
      for (std::size_t i = 0; i < lags.size(); ++i) {
        double value = correlation(p, i);
        for (double const hz : moving) value *= cosine(hz, lags, i);
        for (std::size_t k = 0; k < parts.size(); ++k) parts[k].sum[i] += weight[k] * (value - still);
      }
    }
    return parts;
  }

  bool transformed(Part const& part, LagGrid const& lags, WrappedSpectrum& low) const {
    Covariance r;
    for (std::size_t c = 0; c < classes().size(); ++c)
      if (is_gaussian(c)) r.fall.resize(std::max(r.fall.size(), lag_functions_[c].fall.size()));
    for (std::size_t c = 0; c < classes().size(); ++c) {
      if (!is_gaussian(c)) continue;
      r.at_zero += strongest_[c] * lag_functions_[c].at_zero;
      for (std::size_t i = 0; i < r.fall.size(); ++i) r.fall[i] += strongest_[c] * lag_functions_[c].fall_at(i);
    }
    double const rounding =
        rounding_of(slow_, part.sum, r, part.largest) + 8 * part.largest * std::sqrt(double(lags.samples));
    low.constant = part.constant / 2;
    return transform_lags(part.sum, lags, rounding, low);
  }

  // First order in the motion of a band: slower motion reduces a pair by its phase difference, faster motion
  // reduces each path.
  double first_order(PhasePair const& p, double low, double high) const {
    double power = 0, kept = p.weight, exponent = 0;
    for (std::size_t c = 0; c < classes().size(); ++c) {
      double const own = p.own[c], cross = p.cross[c], hz = classes()[c].tone_frequency;
      if (is_gaussian(c)) {
        Spectrum const& s = classes()[c].reference;
        power += cross * s.power(low, high) / 2;
        exponent -= own * s.power(high, infinity) + (own - cross) * s.power(0, low);
      } else if (is_tone(c) && hz >= low && hz < high) {
        auto const [a, b] = peaks(own, cross);
        power += ::j1(a) * ::j1(b);
      } else if (is_tone(c)) {
        kept *= hz >= high ? mean_of_tone(own, cross) : apart_by_tone(own, cross);
      }
    }
    return kept * std::exp(exponent) * power;
  }

  Values first_order(Values const& psd) const {
    FrequencyGrid const& grid = spectra_.grid();
    Values out(grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) {
      double power = 0;
      for (PhasePair const& p : pairs_)
        power += spectra_.moved_by_drifts(p.own, grid.edges[i], grid.edges[i + 1],
                                          [&](double low, double high) { return first_order(p, low, high); });
      out[i] = std::clamp(power / grid.width(i), 0.0, std::max(psd[i], 0.0));
    }
    return out;
  }

  PhaseSpectra const& spectra_;
  std::vector<PhasePair> pairs_;
  Values strongest_;
  double edge_;                    // Hz, f1 of eq. 7.14
  double drift_ = 0;               // Hz, the fastest drift of any pair
  std::vector<std::size_t> fast_;  // classes that move beyond the edge
  SlowPhase slow_;
  std::vector<Covariance> lag_functions_;  // of a tone: its cosine
};

}  // namespace

PairSpectrum pair_spectrum(PhaseSpectra const& spectra, std::span<PhasePair const> pairs) {
  return Pairs(spectra, pairs).spectrum();
}

std::vector<PhasePair> coherent_family(MotionSet const& motion, std::vector<MotionClass> const& classes,
                                       std::span<CoherentPath const> paths) {
  if (paths.size() > most_coherent)
    throw NumericalError(fmt::format("cannot add {} paths as fields: the limit is {}", paths.size(), most_coherent));
  std::vector<std::vector<double>> kappa;
  for (CoherentPath const& p : paths) kappa.push_back(kappa_of(motion, classes, p.phase_sensitivities));
  std::vector<PhasePair> pairs;
  for (std::size_t j = 0; j < paths.size(); ++j) {
    pairs.push_back({std::norm(paths[j].field), kappa[j], kappa[j]});
    for (std::size_t k = j + 1; k < paths.size(); ++k) {
      std::vector<PhaseSensitivity> apart = paths[j].phase_sensitivities;
      for (PhaseSensitivity l : paths[k].phase_sensitivities) {
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

}  // namespace straytrace::noise
