// SPDX-License-Identifier: BSD-3-Clause
#include "noise/classes/motion_classes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "motion/axis_motion.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::noise {
namespace {

using Transfer = MotionClass::Transfer;

std::complex<double> at(Transfer const& t, double hz) { return t ? (*t)(hz) : 1; }

std::vector<Transfer> distinct_transfers(MotionInput const& input) {
  std::vector<Transfer> found;
  for (Gain const& gain : input.gains)
    if (std::ranges::find(found, gain.transfer) == found.end()) found.push_back(gain.transfer);
  return found;
}

Spectrum seen_through(Spectrum const& s, Transfer const& t) {
  return t ? filtered(
                 s, [&](double f) { return std::norm((*t)(f)); }, t->features())
           : s;
}

// 4 sin^2(pi f (t_a - t_b)) |H|^2 of one system with two delays; none of two systems.
std::function<double(double)> difference_of_delays(Transfer const& a, Transfer const& b) {
  TransferFunction const unchanged({}, {}, 1), of_a = a ? *a : unchanged, of_b = b ? *b : unchanged;
  if (of_a.delayed(-of_a.delay()) != of_b.delayed(-of_b.delay())) return {};
  double const between = of_a.delay() - of_b.delay();
  return [of_a, between](double f) { return std::norm(2 * std::sin(pi * f * between) * of_a(f)); };
}

Spectrum of_difference(Spectrum const& s, Transfer const& a, Transfer const& b) {
  std::vector<double> features = a ? a->features() : std::vector<double>();
  std::vector<double> const more = b ? b->features() : std::vector<double>();
  features.insert(features.end(), more.begin(), more.end());
  if (auto const by_delay = difference_of_delays(a, b)) return filtered(s, by_delay, features);
  return filtered(
      s, [&](double f) { return std::norm(at(a, f) - at(b, f)); }, features,
      [&](double f) { return std::norm(at(a, f)) + std::norm(at(b, f)); });
}

void add(std::vector<MotionClass>& classes, Spectrum spectrum, MotionClass::Member member) {
  if (!(spectrum.total() > 0)) return;
  auto const same = std::ranges::find_if(classes, [&](MotionClass const& c) {
    return c.tone_frequency == 0 && !c.drift && same_shape(c.reference, spectrum);
  });
  member.scale = same == classes.end() ? 1 : spectrum.total() / same->reference.total();
  if (same != classes.end())
    same->members.push_back(std::move(member));
  else
    classes.push_back({std::move(spectrum), 0, {std::move(member)}});
}

// A sum of terms; zero when only rounding remains.
class Sum {
 public:
  void add(std::complex<double> x) {
    sum_ += x;
    size_ += std::fabs(x.real()) + std::fabs(x.imag());
  }
  std::complex<double> value() const { return std::norm(sum_) > 1e-28 * size_ * size_ ? sum_ : 0; }

 private:
  std::complex<double> sum_ = 0;
  double size_ = 0;
};

double kappa_of(MotionInput const& input, MotionClass::Member const& member,
                std::span<PhaseSensitivity const> phase_sensitivities) {
  Sum all, first, second;
  for (PhaseSensitivity const& phase_sensitivity : phase_sensitivities)
    for (Gain const& gain : input.gains) {
      if (gain.body != phase_sensitivity.body) continue;
      std::complex<double> const term = phase_sensitivity.d[gain.axis] * gain.value;
      all.add(term);
      if (gain.transfer == member.first) first.add(term);
      if (gain.transfer == member.second) second.add(term);
    }
  if (member.difference) return -(first.value() * std::conj(second.value())).real();
  return (first.value() * std::conj(all.value())).real();
}

// True for a class that includes phases of light: these have no second moments.
bool of_light(MotionSet const& motion, MotionClass const& c) {
  return std::ranges::any_of(c.members, [&](MotionClass::Member const& m) {
    return std::ranges::any_of(motion.inputs[m.input].gains,
                               [&](Gain const& g) { return motion.light.is_light(g.body.value); });
  });
}

// The coefficients by which kappa of a class is linear in the products of phase sensitivities of two bodies.
std::array<double, 36> coefficients(MotionSet const& motion, MotionClass const& c, BodyId first, BodyId second) {
  std::array<double, 36> out = {};
  for (MotionClass::Member const& m : c.members) {
    std::vector<Gain> const& gains = motion.inputs[m.input].gains;
    for (Gain const& p : gains)
      for (Gain const& q : gains) {
        if (p.transfer != m.first || (m.difference && q.transfer != m.second)) continue;
        double const term = (m.difference ? -1 : 1) * m.scale * (p.value * std::conj(q.value)).real();
        if (p.body == first && q.body == second) out[6 * p.axis + q.axis] += term;
        if (first != second && q.body == first && p.body == second) out[6 * q.axis + p.axis] += term;
      }
  }
  return out;
}

}  // namespace

std::vector<MotionClass> group_by_shape(MotionSet const& motion) {
  std::vector<MotionClass> classes;
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) {
    MotionInput const& input = motion.inputs[i];
    if (input.tone_frequency > 0 || input.drift) {
      classes.push_back({{}, input.tone_frequency, {{i, 1, {}, {}}}, input.drift});
      continue;
    }
    std::vector<Transfer> const transfers = distinct_transfers(input);
    for (std::size_t k = 0; k < transfers.size(); ++k) {
      add(classes, seen_through(input.spectrum, transfers[k]), {i, 1, transfers[k], transfers[k]});
      for (std::size_t l = 0; l < k; ++l)
        add(classes, of_difference(input.spectrum, transfers[k], transfers[l]),
            {i, 1, transfers[k], transfers[l], true});
    }
  }
  return classes;
}

std::vector<double> kappa_of(MotionSet const& motion, std::vector<MotionClass> const& classes,
                             std::span<PhaseSensitivity const> phase_sensitivities) {
  std::vector<double> kappa(classes.size());
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (MotionClass::Member const& m : classes[c].members)
      kappa[c] += m.scale * kappa_of(motion.inputs[m.input], m, phase_sensitivities);
  return kappa;
}

std::vector<double> kappa_of(MotionSet const& motion, std::vector<MotionClass> const& classes, PathRecord const& r) {
  std::vector<double> kappa = kappa_of(motion, classes, r.phase_sensitivities);
  if (r.amplitude_levers.empty()) return kappa;
  std::vector<double> const amplitude = kappa_of(motion, classes, r.amplitude_levers);
  for (std::size_t c = 0; c < kappa.size(); ++c)
    if (!classes[c].drift) kappa[c] += amplitude[c];
  return kappa;
}

std::vector<KappaSum> kappa_sums(MotionSet const& motion, std::vector<MotionClass> const& classes,
                                 std::span<PhaseSensitivityProduct const> products) {
  constexpr double rounding = 1e-9;  // of the sum of the moduli of the terms
  std::vector<KappaSum> out(classes.size());
  for (std::size_t c = 0; c < classes.size(); ++c) {
    std::map<std::pair<BodyId, BodyId>, std::array<double, 36>> known;
    double sum = 0, size = 0;
    for (PhaseSensitivityProduct const& p : products) {
      auto const [at, fresh] = known.try_emplace({p.first, p.second});
      if (fresh) at->second = coefficients(motion, classes[c], p.first, p.second);
      for (std::size_t i = 0; i < p.sum.size(); ++i) {
        double const term = at->second[i] * p.sum[i];
        out[c].of[p.replica] += term;
        size += std::fabs(term);
      }
    }
    for (double const x : out[c].of) sum += x;
    out[c].known = !of_light(motion, classes[c]) && std::fabs(sum) > rounding * size;
  }
  return out;
}

MotionDirections::MotionDirections(MotionSet const& motion) : motion_(motion) {
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) add_columns(i);
}

void MotionDirections::add_columns(std::size_t input) {
  std::vector<Gain> const& gains = motion_.inputs[input].gains;
  std::size_t const first = columns_.size();
  for (Gain const& g : gains)
    for (bool const imaginary : {false, true}) {
      bool const there = std::any_of(columns_.begin() + std::ptrdiff_t(first), columns_.end(), [&](Column const& c) {
        return c.transfer == g.transfer.get() && c.imaginary == imaginary;
      });
      if (!there && (!imaginary || g.value.imag() != 0)) columns_.push_back({input, g.transfer.get(), imaginary});
    }
  for (std::size_t c = first; c < columns_.size(); ++c)
    for (std::size_t k = 0; k < gains.size(); ++k) {
      Gain const& g = gains[k];
      if (g.transfer.get() != columns_[c].transfer) continue;
      if (of_body_.size() <= g.body.value) of_body_.resize(g.body.value + 1);
      of_body_[g.body.value].push_back({c, k, g.axis, columns_[c].imaginary ? g.value.imag() : g.value.real()});
    }
}

MotionDirections::Gains MotionDirections::of(std::span<PhaseSensitivity const> phase_sensitivities) const {
  std::vector<std::tuple<std::size_t, std::size_t, double>> terms;  // column, gain: the order of the sum
  for (PhaseSensitivity const& phase_sensitivity : phase_sensitivities)
    if (phase_sensitivity.body.value < of_body_.size())
      for (Entry const& e : of_body_[phase_sensitivity.body.value])
        terms.emplace_back(e.column, e.gain, phase_sensitivity.d[e.axis] * e.value);
  std::ranges::stable_sort(terms, [](auto const& a, auto const& b) {
    return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
  });
  Gains out;
  for (auto const& [column, gain, value] : terms) {
    if (out.empty() || out.back().first != column) out.emplace_back(column, 0);
    out.back().second += value;
  }
  return out;
}

double MotionDirections::root_power(std::size_t input, double low, double high, bool everywhere) const {
  MotionInput const& in = motion_.inputs[input];
  if (in.drift) return 0;
  bool const tone = in.tone_frequency > 0, inside = in.tone_frequency >= low && in.tone_frequency < high;
  if (everywhere) return std::sqrt(tone ? 0.5 : in.spectrum.total());
  return std::sqrt((tone ? (inside ? 0.5 : 0) : in.spectrum.power(low, high)) / (high - low));
}

std::vector<std::complex<double>> MotionDirections::to_inputs(FrequencyGrid const& grid, std::size_t bin,
                                                              bool everywhere) const {
  std::vector<std::complex<double>> out;
  for (Column const& column : columns_) {
    double const hz = motion_.inputs[column.input].tone_frequency;
    std::complex<double> factor = root_power(column.input, grid.edges[bin], grid.edges[bin + 1], everywhere);
    if (column.transfer && hz == 0 && !everywhere) factor *= (*column.transfer)(grid.centre(bin));
    if (column.imaginary) factor *= std::complex<double>(0, 1);
    out.push_back(factor);
  }
  return out;
}

namespace {

CoordinateMotion coordinate_motion(MotionSet const& motion, std::vector<MotionClass> const& classes, std::uint32_t body,
                                   int axis, std::span<double const> from) {
  PhaseSensitivity phase_sensitivity{BodyId{body}, {}};
  phase_sensitivity.d[axis] = 1;
  bool const mode = motion.bodies[body].find('/') != std::string::npos;
  CoordinateMotion row{motion.bodies[body], mode ? "q" : std::string(axis_names[axis]), axis < 3 ? "m" : "rad"};
  row.kappa = kappa_of(motion, classes, {&phase_sensitivity, 1});
  double total = 0, rate = 0;
  row.above.resize(from.size());
  for (std::size_t c = 0; c < classes.size(); ++c) {
    MotionClass const& of = classes[c];
    double const k = row.kappa[c], tone = of.tone_frequency;
    if (of.drift) row.drift = std::sqrt(k);
    total += k * of.variance();
    rate += tone > 0 ? k / 2 * std::pow(2 * pi * tone, 2) : k * of.reference.rate_power(infinity);
    for (std::size_t b = 0; b < from.size(); ++b)
      row.above[b] += tone > 0 ? (tone >= from[b] ? k / 2 : 0) : k * of.reference.power(from[b], infinity);
  }
  row.rms = std::sqrt(std::max(0.0, total));
  row.rate = std::sqrt(std::max(0.0, rate));
  for (double& power : row.above) power = std::sqrt(std::max(0.0, power));
  return row;
}

}  // namespace

double CoordinateMotion::asd(std::vector<MotionClass> const& classes, double hz) const {
  double psd = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) psd += kappa[c] * classes[c].reference.at(hz);
  return std::sqrt(std::max(0.0, psd));
}

std::vector<CoordinateMotion> coordinate_motions(MotionSet const& motion, std::vector<MotionClass> const& classes,
                                                 std::span<double const> above) {
  std::vector<CoordinateMotion> all;
  for (std::uint32_t body = 0; body < motion.bodies.size(); ++body)
    for (int axis = 0; axis < 6; ++axis)
      if (CoordinateMotion row = coordinate_motion(motion, classes, body, axis, above); row.moves())
        all.push_back(std::move(row));
  return all;
}

}  // namespace straytrace::noise
