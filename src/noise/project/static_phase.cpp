// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/static_phase.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"

namespace straytrace::noise {
namespace {

bool moved_by(CouplingClass const& c, std::uint32_t body) {
  auto const moves = [&](PhaseSensitivity const& s) {
    return s.body.value == body && std::ranges::any_of(s.d, [](double d) { return d != 0; });
  };
  return std::ranges::any_of(c.records,
                             [&](PathRecord const& r) { return std::ranges::any_of(r.phase_sensitivities, moves); });
}

// The one of these bodies that moves a route.
StaticPhase const* body_of(CouplingTable const& table, CouplingClass const& c, MotionSet const& motion,
                           std::vector<StaticPhase> const& stated, ifo::Interferometer const& ifo) {
  if (c.deterministic() && (c.kind != ClassKind::ghost || c.adds_fields())) return nullptr;
  StaticPhase const* by = nullptr;
  for (StaticPhase const& s : stated) {
    auto const body = std::ranges::find(motion.bodies, s.body);
    if (body == motion.bodies.end() || !moved_by(c, std::uint32_t(body - motion.bodies.begin()))) continue;
    if (by)
      throw InputError(fmt::format("'{}' and '{}' both state the static phase of route '{}'", by->body, s.body,
                                   route_name(table, c)),
                       "keep one of them in 'static_phase' of 'noise'");
    by = &s;
  }
  if (by && ifo.copies(c.port) != 1)
    throw InputError(fmt::format("'static_phase' of '{}' is that of one scatterer, and port '{}' has {:g} equal copies",
                                 by->body, table.ports[c.port.value], ifo.copies(c.port)),
                     "write 'copies: 1' for this port in the interferometer, or 'arms: 1'");
  return by;
}

}  // namespace

std::vector<std::optional<double>> known_phases(CouplingTable const& table, MotionSet const& motion,
                                                std::vector<StaticPhase> const& stated,
                                                ifo::Interferometer const& ifo) {
  std::vector<std::optional<double>> phases(table.classes.size());
  for (std::size_t r = 0; !stated.empty() && r < table.classes.size(); ++r)
    if (StaticPhase const* by = body_of(table, table.classes[r], motion, stated, ifo)) phases[r] = by->phase;
  return phases;
}

std::vector<bool> scanned_routes(CouplingTable const& table, MotionSet const& motion, NoiseSettings const& settings,
                                 ifo::Interferometer const& ifo) {
  if (!settings.scanned) return {};
  std::vector<StaticPhase> stated = settings.static_phases;
  stated.push_back({settings.scanned->body});
  std::vector<bool> scanned;
  for (CouplingClass const& c : table.classes)
    scanned.push_back(body_of(table, c, motion, stated, ifo) == &stated.back());
  return scanned;
}

namespace {

struct Strength {
  std::vector<double> phase, amplitude, both;  // per class; `both`: of their cross spectrum
  double weight = 0, square = 0;               // square: mean-square phase
  bool has_amplitude() const {
    return std::ranges::any_of(amplitude, [](double k) { return k != 0; });
  }
};

// Of the sum of the lever of the phase and `sign` times that of the amplitude.
std::vector<double> kappa_of_sum(MotionSet const& motion, std::vector<MotionClass> const& classes, PathRecord const& r,
                                 double sign) {
  std::vector<PhaseSensitivity> sum = r.phase_sensitivities;
  for (PhaseSensitivity const& a : r.amplitude_levers) {
    auto at = std::ranges::find(sum, a.body, &PhaseSensitivity::body);
    if (at == sum.end()) at = sum.insert(at, PhaseSensitivity{a.body});
    at->add(a, sign);
  }
  return kappa_of(motion, classes, sum);
}

Strength strength_of(PhaseSpectra const& spectra, MotionSet const& motion, PathRecord const& r) {
  std::vector<MotionClass> const& classes = spectra.classes();
  std::vector<double> const none(classes.size());
  Strength s{kappa_of(motion, classes, r.phase_sensitivities), none, none, r.weight, 0};
  s.square = spectra.mean_square_phase(s.phase);
  if (r.amplitude_levers.empty()) return s;
  s.amplitude = kappa_of(motion, classes, r.amplitude_levers);
  std::vector<double> const plus = kappa_of_sum(motion, classes, r, 1), minus = kappa_of_sum(motion, classes, r, -1);
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (classes[c].drift) s.amplitude[c] = 0;
    if (!classes[c].drift) s.both[c] = (plus[c] - minus[c]) / 4;
  }
  return s;
}

// Shares of equal power in the order of strength, each by the path in its middle.
std::vector<Strength> chosen(std::vector<Strength> all) {
  if (all.size() <= representatives) return all;
  std::ranges::stable_sort(all, {}, &Strength::square);
  double const power =
      std::accumulate(all.begin(), all.end(), 0.0, [](double sum, Strength const& s) { return sum + s.weight; });
  std::vector<Strength> some;
  double before = 0;
  for (Strength const& s : all) {
    double const after = before + s.weight / power * double(representatives);
    double const middles = std::floor(after + 0.5) - std::floor(before + 0.5);
    if (middles > 0) {
      some.push_back(s);
      some.back().weight = middles;
    }
    before = after;
  }
  return some;
}

std::vector<double> sum_of(std::vector<double> const& a, std::vector<double> const& b, double factor) {
  std::vector<double> sum = a;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * b[i];
  return sum;
}

// exp[-(own R(0) - cross R)], own of phase and amplitude together; the amplitude has the same sign in both factors of
// s s', the phase the opposite one.
PhasePair opposite_pair(Strength const& s) {
  return {s.weight, sum_of(s.phase, s.amplitude, 1), sum_of(s.amplitude, s.phase, -1)};
}

// Of 2 <a phi'>: half a difference of two exponents moved by a part of it.
void add_cross_terms(Strength const& s, std::vector<PhasePair>& pairs) {
  double part = 1;
  PhasePair const middle = opposite_pair(s);
  for (std::size_t c = 0; c < s.both.size(); ++c)
    if (s.both[c] != 0)
      part = std::min(part, (std::fabs(middle.own[c]) - std::fabs(middle.cross[c])) / std::fabs(s.both[c]));
  if (!(part > 1e-6)) return;
  for (double const sign : {1.0, -1.0})
    pairs.push_back({sign * s.weight / part, middle.own, sum_of(middle.cross, s.both, sign * part)});
}

// Whether the first order in the motion holds to 1e-6. Where it does, differences of exponentials would be rounding.
bool moves_little(PhaseSpectra const& spectra, Strength const& s) {
  return s.square + spectra.mean_square_phase(s.amplitude) < 1e-6;
}

// (A + iJ)^2/(A^2 + J^2) of the motion in each bin.
std::vector<std::complex<double>> small_relation(PhaseSpectra const& spectra, std::vector<Strength> const& all) {
  std::vector<std::complex<double>> ratio(spectra.grid().size());
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    std::complex<double> square = 0;
    double size = 0;
    for (std::size_t c = 0; c < spectra.classes().size(); ++c) {
      double const power = spectra.first_order_weight(c, i);
      for (Strength const& s : all) {
        square += s.weight * power * std::complex<double>(s.amplitude[c] - s.phase[c], 2 * s.both[c]);
        size += s.weight * power * (s.amplitude[c] + s.phase[c]);
      }
    }
    if (size > 0) ratio[i] = square / size;
  }
  return ratio;
}

}  // namespace

std::vector<std::complex<double>> phase_relation(PhaseSpectra const& spectra, MotionSet const& motion,
                                                 CouplingClass const& c) {
  std::vector<Strength> all;
  for (PathRecord const& r : c.records)
    if (r.weight > 0) all.push_back(strength_of(spectra, motion, r));
  std::vector<std::complex<double>> ratio(spectra.grid().size());
  if (all.empty()) return ratio;
  all = chosen(std::move(all));
  if (std::ranges::all_of(all, [&](Strength const& s) { return moves_little(spectra, s); }))
    return small_relation(spectra, all);
  std::vector<PhasePair> same, opposite, across;
  for (Strength const& s : all) {
    std::vector<double> const own = sum_of(s.phase, s.amplitude, 1);
    same.push_back({s.weight, own, own});
    opposite.push_back(opposite_pair(s));
    if (s.has_amplitude()) add_cross_terms(s, across);
  }
  PairSpectrum const mean = pair_spectrum(spectra, same), real = pair_spectrum(spectra, opposite),
                     imaginary = across.empty() ? PairSpectrum{} : pair_spectrum(spectra, across);
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    if (!(mean.psd[i] > 0)) continue;
    ratio[i] = {real.psd[i] / mean.psd[i], across.empty() ? 0 : imaginary.psd[i] / mean.psd[i]};
    if (double const size = std::abs(ratio[i]); size > 1) ratio[i] /= size;
  }
  return ratio;
}

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
