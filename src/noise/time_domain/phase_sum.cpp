// SPDX-License-Identifier: BSD-3-Clause
#include "noise/time_domain/phase_sum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>
#include <thread>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "base/math/simd.hpp"
#include "base/process/threads.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::noise {
namespace {

using Lines = std::vector<std::complex<double>>;
using Key = std::pair<std::uint32_t, int>;  // body, axis

// The sum for one coordinate: Fourier coefficients of the period, and samples.
struct Draft {
  Lines lines;
  std::vector<double> position, velocity;
};

class Drawing {
 public:
  Drawing(SampleTimes const& times, std::uint64_t seed, std::uint32_t realisation)
      : times_(times), seed_(seed), realisation_(realisation), period_(quick_length(times.samples)) {
    if (period_ % 2) period_ *= 2;
  }
  void add(MotionInput const&, std::uint32_t number);
  MotionSeries finished();

 private:
  void add_gaussian(MotionInput const&, std::uint32_t number);
  void add_tone(MotionInput const&);
  void add_drift(MotionInput const&);
  void add_recorded(MotionInput const&);
  Draft& at(Gain const& gain) { return drafts_[{gain.body.value, gain.axis}]; }
  Draft& samples_of(Gain const& gain) {
    Draft& draft = at(gain);
    draft.position.resize(times_.samples);
    draft.velocity.resize(times_.samples);
    return draft;
  }

  SampleTimes times_;
  std::uint64_t seed_;
  std::uint32_t realisation_;
  std::size_t period_;
  std::map<Key, Draft> drafts_;
};

void Drawing::add(MotionInput const& input, std::uint32_t number) {
  if (input.gains.empty()) return;
  if (input.recorded)
    add_recorded(input);
  else if (input.drift)
    add_drift(input);
  else if (input.tone_frequency > 0)
    add_tone(input);
  else if (input.spectrum.total() > 0)
    add_gaussian(input, number);
}

void Drawing::add_gaussian(MotionInput const& input, std::uint32_t number) {
  double const spacing = times_.rate / static_cast<double>(period_);
  std::size_t const last = std::min(static_cast<std::size_t>(input.spectrum.highest() / spacing + 1), period_ / 2 - 1);
  Lines drawn(last + 1);
  for (std::size_t k = 1; k <= last; ++k) {
    double const f = static_cast<double>(k);
    double const power = input.spectrum.power((f - 0.5) * spacing, (f + 0.5) * spacing);
    if (!(power > 0)) continue;
    Rng rng(seed_, std::uint64_t{realisation_} << 32 | number, static_cast<std::uint32_t>(k), Stream::motion);
    double const size = std::sqrt(-0.5 * power * std::log(rng.uniform()));  // <(2 |c|)^2>/2 = power
    drawn[k] = std::polar(size, 2 * pi * rng.uniform());
  }
  for (Gain const& gain : input.gains) {
    Lines& lines = at(gain).lines;
    if (lines.size() <= last) lines.resize(last + 1);
    for (std::size_t k = 1; k <= last; ++k) {
      if (drawn[k] == 0.0) continue;
      std::complex<double> const t = gain.transfer ? (*gain.transfer)(static_cast<double>(k) * spacing) : 1.0;
      lines[k] += drawn[k] * gain.value * std::conj(t);  // c_k goes with exp(+2 pi i f t)
    }
  }
}

void Drawing::add_tone(MotionInput const& input) {
  double const omega = 2 * pi * input.tone_frequency;
  std::vector<std::complex<double>> turning(times_.samples);
  for (std::size_t i = 0; i < times_.samples; ++i) {
    double const cycles =
        input.tone_frequency * static_cast<double>(i) / times_.rate;  // reduced before the sine: R4.09
    turning[i] = std::polar(1.0, 2 * pi * (cycles - std::floor(cycles)));
  }
  for (Gain const& gain : input.gains) {
    Draft& draft = samples_of(gain);
    for (std::size_t i = 0; i < times_.samples; ++i) {
      std::complex<double> const now = gain.value * turning[i];
      draft.position[i] += now.imag();
      draft.velocity[i] += omega * now.real();
    }
  }
}

void Drawing::add_drift(MotionInput const& input) {
  for (Gain const& gain : input.gains) {
    Draft& draft = samples_of(gain);
    for (std::size_t i = 0; i < times_.samples; ++i) {
      draft.position[i] += gain.value.real() * static_cast<double>(i) / times_.rate;
      draft.velocity[i] += gain.value.real();
    }
  }
}

// Central differences; one-sided at the ends.
std::vector<double> slope(std::vector<double> const& x, double rate) {
  std::vector<double> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::size_t const from = i > 0 ? i - 1 : 0, to = std::min(i + 1, x.size() - 1);
    if (to > from) out[i] = (x[to] - x[from]) * rate / static_cast<double>(to - from);
  }
  return out;
}

void Drawing::add_recorded(MotionInput const& input) {
  std::vector<double> const measured = resampled(*input.recorded, times_);
  for (Gain const& gain : input.gains) {
    std::vector<double> x = measured;
    if (gain.transfer) {
      TransferFunction const response = gain.transfer->holding_ends();  // a record holds every frequency
      double const lowest = times_.rate / static_cast<double>(2 * period_);
      x = filtered(made_periodic(x, period_ + period_ / 4 * 2), times_.rate, response, std::real(response(lowest)));
      x.resize(times_.samples);
    }
    std::vector<double> const v = slope(x, times_.rate);
    Draft& draft = samples_of(gain);
    for (std::size_t i = 0; i < times_.samples; ++i) {
      draft.position[i] += gain.value.real() * x[i];
      draft.velocity[i] += gain.value.real() * v[i];
    }
  }
}

MotionSeries Drawing::finished() {
  MotionSeries out{times_, {}};
  double const spacing = times_.rate / static_cast<double>(period_);
  for (auto& [key, draft] : drafts_) {
    MovingCoordinate c{BodyId{key.first}, key.second, std::move(draft.position), std::move(draft.velocity)};
    c.position.resize(times_.samples);
    c.velocity.resize(times_.samples);
    if (!draft.lines.empty()) {
      std::vector<double> const x = synthesised(draft.lines, period_);
      for (std::size_t k = 0; k < draft.lines.size(); ++k)
        draft.lines[k] *= std::complex<double>(0, 2 * pi * static_cast<double>(k) * spacing);
      std::vector<double> const v = synthesised(draft.lines, period_);
      for (std::size_t i = 0; i < times_.samples; ++i) {
        c.position[i] += x[i];
        c.velocity[i] += v[i];
      }
    }
    out.coordinates.push_back(std::move(c));
  }
  return out;
}

double highest(MotionInput const& input) {
  if (input.gains.empty() || input.drift || input.recorded) return 0;
  return input.tone_frequency > 0 ? input.tone_frequency : input.spectrum.highest();
}

}  // namespace

double highest_motion(MotionSet const& motion) {
  double hz = 0;
  for (MotionInput const& input : motion.inputs) hz = std::max(hz, highest(input));
  for (LightTone const& tone : motion.light.tones) hz = std::max(hz, tone.frequency);
  return hz;
}

MotionSeries draw_motion(MotionSet const& motion, SampleTimes const& times, std::uint64_t seed,
                         std::uint32_t realisation) {
  for (MotionInput const& input : motion.inputs)
    if (highest(input) >= times.rate / 2)
      throw InputError(fmt::format("'{}' moves at up to {:g} Hz, too fast for {:g} samples per second", input.name,
                                   highest(input), times.rate),
                       fmt::format("write a rate above {:g} Hz", 2 * highest(input)));
  Drawing drawing(times, seed, realisation);
  for (std::uint32_t i = 0; i < motion.inputs.size(); ++i) drawing.add(motion.inputs[i], i);
  MotionSeries series = drawing.finished();
  series.light = motion.light;
  return series;
}

std::vector<double> made_periodic(std::span<double const> x, std::size_t period) {
  std::vector<double> out(x.begin(), x.end());
  double const gap = static_cast<double>(period - x.size()) + 1;
  for (std::size_t i = x.size(); i < period; ++i) {
    double const way = 0.5 - 0.5 * std::cos(pi * static_cast<double>(i - x.size() + 1) / gap);
    out.push_back(x.back() + way * (x.front() - x.back()));
  }
  return out;
}

std::vector<double> filtered(std::vector<double> const& x, double rate,
                             std::function<std::complex<double>(double hz)> const& response, double at_zero) {
  Fourier fourier;
  Complexes lines = fourier.forward(x);
  lines[0] *= at_zero;
  for (std::size_t k = 1; k < lines.size(); ++k)  // this transform has exp(+2 pi i f t): the conjugate
    lines[k] *= std::conj(response(static_cast<double>(k) * rate / static_cast<double>(x.size())));
  if (x.size() % 2 == 0) lines.back() = lines.back().real();
  return fourier.inverse(lines, x.size());
}

std::vector<double> synthesised(std::vector<std::complex<double>> const& coefficients, std::size_t n) {
  Complexes lines(n / 2 + 1);
  for (std::size_t k = 1; k < std::min(coefficients.size(), n / 2); ++k)
    lines[k] = static_cast<double>(n) * coefficients[k];
  return Fourier().inverse(lines, n);
}

namespace {

constexpr std::size_t block = 512;  // samples: the working set of one path fits the L1 cache

struct Block {
  alignas(64) double phase[block], real[block], imag[block];
};

#if STRAY_VECTORS
using Lane = simd::Doubles;
constexpr std::size_t width = simd::lanes;
#else
using Lane = double;
constexpr std::size_t width = 1;
#endif

// Adds a exp(2 pi i u) for each phase u of a block.
STRAY_INLINE void add_turned(Block& b, double a) {
  for (std::size_t i = 0; i < block; i += width)
    straytrace::add_turned(reinterpret_cast<Lane const&>(b.phase[i]), a, reinterpret_cast<Lane&>(b.real[i]),
                           reinterpret_cast<Lane&>(b.imag[i]));
}

STRAY_INLINE void sum_block(PhaseTerms const& t, std::size_t from, std::size_t n, Block& b) {
  std::fill_n(b.real, block, 0.0);
  std::fill_n(b.imag, block, 0.0);
  std::size_t const coordinates = t.coordinate.size();
  for (std::size_t j = 0; j < t.paths(); ++j) {
    std::fill_n(b.phase, block, t.turns[j]);
    for (std::size_t c = 0; c < coordinates; ++c) {
      double const phase_sensitivity = t.phase_sensitivity[j * coordinates + c];
      if (phase_sensitivity == 0) continue;
      double const* const x = t.coordinate[c].data() + from;
      for (std::size_t i = 0; i < n; ++i) b.phase[i] += phase_sensitivity * x[i];
    }
    add_turned(b, t.amplitude[j]);
  }
}

// One source for three instruction sets; every lane does the same IEEE operations, so the bits agree.
using Version = void (*)(PhaseTerms const&, std::size_t, std::size_t, Block&);
#if STRAY_VECTORS && defined(__x86_64__)
__attribute__((target("avx512f,avx512vl,avx512dq,prefer-vector-width=512"))) void sum_512(PhaseTerms const& t,
                                                                                          std::size_t from,
                                                                                          std::size_t n, Block& b) {
  sum_block(t, from, n, b);
}
__attribute__((target("avx2"))) void sum_256(PhaseTerms const& t, std::size_t from, std::size_t n, Block& b) {
  sum_block(t, from, n, b);
}
#endif
void sum_128(PhaseTerms const& t, std::size_t from, std::size_t n, Block& b) { sum_block(t, from, n, b); }

Version version_for_this_processor() {
#if STRAY_VECTORS && defined(__x86_64__)
  char const* const named = std::getenv("STRAYTRACE_ISA");
  std::string_view const wanted = named ? named : "avx512";
  if (wanted == "portable") return sum_128;
  if (wanted != "avx2" && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq"))
    return sum_512;
  if (__builtin_cpu_supports("avx2")) return sum_256;
#endif
  return sum_128;
}

// The paths of `all` whose numbers are listed, moved by the one coordinate c that is sampled at `nodes`.
PhaseTerms of_one(PhaseTerms const& all, std::vector<std::size_t> const& paths, std::size_t c,
                  std::span<double const> nodes) {
  PhaseTerms one;
  one.coordinate = {nodes};
  for (std::size_t j : paths) {
    one.amplitude.push_back(all.amplitude[j]);
    one.turns.push_back(all.turns[j]);
    one.phase_sensitivity.push_back(all.phase_sensitivity[j * all.coordinate.size() + c]);
  }
  return one;
}

// The rest, with all coordinates.
PhaseTerms only(PhaseTerms const& all, std::vector<std::size_t> const& paths) {
  PhaseTerms some;
  some.coordinate = all.coordinate;
  std::size_t const n = all.coordinate.size();
  for (std::size_t j : paths) {
    some.amplitude.push_back(all.amplitude[j]);
    some.turns.push_back(all.turns[j]);
    some.phase_sensitivity.insert(some.phase_sensitivity.end(), all.phase_sensitivity.begin() + std::ptrdiff_t(j * n),
                                  all.phase_sensitivity.begin() + std::ptrdiff_t((j + 1) * n));
  }
  return some;
}

constexpr std::size_t points = 8;      // of an interpolation: at 64 nodes a turn its error is 1e-11
constexpr std::size_t before = 3;      // of them, below the place
constexpr double nodes_per_turn = 64;  // of the strongest phase sensitivity

// Lagrange weights at nodes -3 .. 4 for a place between 0 and 1.
std::array<double, points> lagrange(double x) {
  std::array<double, points> w;
  for (std::size_t i = 0; i < points; ++i) {
    w[i] = 1;
    for (std::size_t k = 0; k < points; ++k)
      if (k != i) w[i] *= (x + 3 - double(k)) / (double(i) - double(k));
  }
  return w;
}

// False when a table would cost more than the samples.
bool add_by_table(PhaseTerms const& all, std::vector<std::size_t> const& paths, std::size_t c, DirectSum const& direct,
                  std::vector<std::complex<double>>& out) {
  std::span<double const> const x = all.coordinate[c];
  auto const [low, high] = std::minmax_element(x.begin(), x.end());
  double strongest = 0;
  for (std::size_t j : paths)
    strongest = std::max(strongest, std::fabs(all.phase_sensitivity[j * all.coordinate.size() + c]));
  double const step = 1 / (nodes_per_turn * strongest), wanted = (*high - *low) / step + points;
  if (!(wanted * double(paths.size()) + 40 * double(x.size()) < double(x.size()) * double(paths.size()))) return false;
  double const first = *low - double(before) * step;
  std::vector<double> nodes(static_cast<std::size_t>(wanted) + 1);
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = first + step * double(i);
  std::vector<std::complex<double>> const table = direct(of_one(all, paths, c, nodes));
  for (std::size_t i = 0; i < x.size(); ++i) {
    double const place = (x[i] - first) / step;
    std::size_t const at = std::max(static_cast<std::size_t>(place), before);  // the lowest x may round to below it
    std::array<double, points> const w = lagrange(place - double(at));
    for (std::size_t k = 0; k < points; ++k) out[i] += w[k] * table[at - before + k];
  }
  return true;
}

// The only coordinate that moves a path; none when there are several.
std::size_t only_mover(PhaseTerms const& t, std::size_t path, std::size_t none) {
  std::size_t found = none;
  for (std::size_t c = 0; c < t.coordinate.size(); ++c)
    if (t.phase_sensitivity[path * t.coordinate.size() + c] != 0) {
      if (found != none) return none;
      found = c;
    }
  return found;
}

}  // namespace

std::vector<std::complex<double>> direct_phase_sum(PhaseTerms const& t, unsigned threads, SumProgress const& progress) {
  static Version const version = version_for_this_processor();
  std::size_t const samples = t.coordinate.empty() ? 0 : t.coordinate.front().size();
  std::vector<std::complex<double>> out(samples);
  std::atomic<std::size_t> next{0};
  auto const work = [&](bool reports) {
    Block b;
    for (std::size_t from = block * next++; from < samples; from = block * next++) {
      std::size_t const n = std::min(block, samples - from);
      version(t, from, n, b);
      for (std::size_t i = 0; i < n; ++i) out[from + i] = {b.real[i], b.imag[i]};
      if (reports && progress) progress(double(from + n) / double(samples));
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned i = 1; i < thread_count(threads); ++i) workers.emplace_back(work, false);
  work(true);
  workers.clear();  // joins
  return out;
}

std::vector<std::complex<double>> phase_sum(PhaseTerms const& t, unsigned threads, DirectSum const& direct,
                                            SumProgress const& progress) {
  if (!direct)
    return phase_sum(t, threads, [&](PhaseTerms const& some) { return direct_phase_sum(some, threads, progress); });
  std::size_t const none = t.coordinate.size();
  std::vector<std::vector<std::size_t>> moved(none + 1);  // by their only coordinate; the others last
  for (std::size_t j = 0; j < t.paths(); ++j) moved[only_mover(t, j, none)].push_back(j);
  std::vector<std::complex<double>> from_tables(t.coordinate.empty() ? 0 : t.coordinate.front().size());
  for (std::size_t c = 0; c < none; ++c)
    if (!moved[c].empty() && !add_by_table(t, moved[c], c, direct, from_tables))
      moved[none].insert(moved[none].end(), moved[c].begin(), moved[c].end());
  if (moved[none].empty()) return from_tables;
  std::vector<std::complex<double>> out = direct(only(t, moved[none]));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += from_tables[i];
  return out;
}

namespace {

struct PhaseSensitivitySums {
  double weight = 0, size = 0, square = 0;
  double mean[6] = {};
};

std::map<std::uint32_t, PhaseSensitivitySums> phase_sensitivity_sums(CouplingClass const& c, double& weight) {
  std::map<std::uint32_t, PhaseSensitivitySums> sums;
  weight = 0;
  for (PathRecord const& r : c.records) {
    weight += r.weight;
    for (PhaseSensitivity const& phase_sensitivity : r.phase_sensitivities) {
      PhaseSensitivitySums& s = sums[phase_sensitivity.body.value];
      double const size = std::hypot(phase_sensitivity.d[0], phase_sensitivity.d[1], phase_sensitivity.d[2]);
      s.size += r.weight * size;
      s.square += r.weight * size * size;
      for (int axis = 0; axis < 6; ++axis) s.mean[axis] += r.weight * phase_sensitivity.d[axis];
    }
  }
  return sums;
}

double at(std::vector<double> const& sorted, double below) {
  return sorted[std::size_t(std::lround(below * double(sorted.size() - 1)))];
}

}  // namespace

std::vector<double> fringe_frequency(std::span<double const> velocity, double wavelength, double bounces) {
  std::vector<double> hz;
  for (double v : velocity) hz.push_back(bounces * 2 * std::fabs(v) / wavelength);
  return hz;
}

FringeCurve fringe_curve(CouplingTable const& table, std::uint32_t route, MotionSeries const& motion) {
  CouplingClass const& c = table.classes.at(route);
  FringeCurve out{route, route_name(table, c), {}, std::vector<double>(motion.times.samples)};
  double weight = 0;
  double const two_k = 4 * pi / table.wavelength;
  for (auto const& [body, s] : phase_sensitivity_sums(c, weight)) {
    bool moves = false;
    bool const light = motion.light.is_light(body);
    for (MovingCoordinate const& m : motion.coordinates) {
      if (m.body.value != body) continue;
      moves = moves || light || m.axis < 3;
      double const turns = s.mean[m.axis] / weight / (2 * pi);
      for (std::size_t i = 0; i < out.hz.size(); ++i) out.hz[i] += turns * m.velocity[i];
    }
    double const mean = s.size / weight;
    double const spread = std::sqrt(std::max(0.0, s.square / weight - mean * mean));
    if (moves && (light || mean > 0)) out.bodies.push_back({BodyId{body}, mean / two_k, spread / two_k});
  }
  for (double& f : out.hz) f = std::fabs(f);
  std::ranges::stable_sort(out.bodies,
                           [](Multiplicity const& a, Multiplicity const& b) { return a.bounces > b.bounces; });
  return out;
}

FringeCurves fringe_curves(CouplingTable const& table, std::span<std::uint32_t const> routes,
                           MotionSeries const& motion, std::size_t most) {
  std::vector<std::uint32_t> by_coupling(routes.begin(), routes.end());
  std::ranges::stable_sort(by_coupling, std::greater(),
                           [&](std::uint32_t r) { return table.classes[r].reverse * table.classes[r].coupling.mean; });
  FringeCurves out;
  out.largest.resize(motion.times.samples);
  for (std::uint32_t const r : by_coupling) {
    if (out.curves.size() >= most) {
      ++out.left_out;
      continue;
    }
    FringeCurve curve = fringe_curve(table, r, motion);
    if (curve.bodies.empty()) continue;
    for (std::size_t i = 0; i < curve.hz.size(); ++i) out.largest[i] = std::max(out.largest[i], curve.hz[i]);
    out.curves.push_back(std::move(curve));
  }
  return out;
}

void take_frequencies(FringeCurves& found, CouplingTable const& table, MotionSeries const& motion) {
  found.largest.assign(motion.times.samples, 0);
  for (FringeCurve& curve : found.curves) {
    curve.hz = fringe_curve(table, curve.route, motion).hz;
    for (std::size_t i = 0; i < curve.hz.size(); ++i) found.largest[i] = std::max(found.largest[i], curve.hz[i]);
  }
}

std::vector<FringeStride> by_stride(std::span<double const> hz, SampleTimes const& times, double stride,
                                    double threshold) {
  auto const n = std::max<std::size_t>(1, std::size_t(std::llround(stride * times.rate)));
  std::vector<FringeStride> out;
  for (std::size_t from = 0; from < hz.size(); from += n) {
    std::size_t const to = std::min(from + n, hz.size());
    std::vector<double> sorted(hz.begin() + std::ptrdiff_t(from), hz.begin() + std::ptrdiff_t(to));
    std::ranges::sort(sorted);
    auto const above = sorted.end() - std::ranges::upper_bound(sorted, threshold);
    out.push_back({times.start + double(from) / times.rate, times.start + double(to) / times.rate, at(sorted, 0.5),
                   at(sorted, 0.95), sorted.back(), double(above) / double(sorted.size())});
  }
  return out;
}

std::vector<StretchAbove> stretches_above(std::span<FringeStride const> strides, double threshold) {
  std::vector<StretchAbove> out;
  bool inside = false;
  for (FringeStride const& s : strides) {
    bool const above = s.largest > threshold;
    if (above && !inside) out.push_back({s.from, s.to, 0});
    if (above) {
      out.back().to = s.to;
      out.back().largest = std::max(out.back().largest, s.largest);
    }
    inside = above;
  }
  return out;
}

namespace {

constexpr double half_width = 32;  // samples of the slower clock
constexpr double beta = 9;         // of the Kaiser window: leakage from other bands is below 1e-4 in amplitude

double kaiser(double u) { return u * u < 1 ? std::cyl_bessel_i(0, beta * std::sqrt(1 - u * u)) : 0; }

double sinc(double x) { return std::fabs(x) < 1e-9 ? 1 : std::sin(pi * x) / (pi * x); }

// Beyond its ends the series is continued by point reflection: value and slope are continuous.
double sample(std::vector<double> const& x, std::ptrdiff_t i) {
  auto const last = static_cast<std::ptrdiff_t>(x.size()) - 1;
  if (i < 0) return 2 * x.front() - x[static_cast<std::size_t>(std::min(-i, last))];
  if (i > last) return 2 * x.back() - x[static_cast<std::size_t>(std::max<std::ptrdiff_t>(2 * last - i, 0))];
  return x[static_cast<std::size_t>(i)];
}

}  // namespace

std::vector<double> resampled(TimeSeries const& series, SampleTimes const& times) {
  double const early = (times.start - series.start) * series.rate, step = series.rate / times.rate;
  double const late = early + step * static_cast<double>(times.samples - 1);
  if (series.samples.size() < 2 || early < -1e-3 || late > static_cast<double>(series.samples.size()) + 1e-3)
    throw InputError(fmt::format("'{}' covers GPS {:.3f} to {:.3f}, not all of {:.3f} to {:.3f}", series.name,
                                 series.start, series.end(), times.start, times.start + times.duration()),
                     "choose a shorter or another stretch of time");
  std::vector<double> out(times.samples);
  double const cut = std::min(1.0, 1 / step);  // of the half rate of the recording
  double const reach = half_width / cut, norm = kaiser(0);
  for (std::size_t i = 0; i < times.samples; ++i) {
    double const at = early + step * static_cast<double>(i), nearest = std::round(at);
    if (step == 1 && std::fabs(at - nearest) < 1e-6) {
      out[i] = sample(series.samples, static_cast<std::ptrdiff_t>(nearest));
      continue;
    }
    double sum = 0, weights = 0;
    for (auto k = static_cast<std::ptrdiff_t>(std::ceil(at - reach)); static_cast<double>(k) <= at + reach; ++k) {
      double const d = at - static_cast<double>(k), w = sinc(cut * d) * kaiser(d / reach) / norm;
      sum += w * sample(series.samples, k);
      weights += w;
    }
    out[i] = sum / weights;
  }
  return out;
}

}  // namespace straytrace::noise
