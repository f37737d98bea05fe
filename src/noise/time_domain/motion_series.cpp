// SPDX-License-Identifier: BSD-3-Clause
#include "noise/time_domain/motion_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
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

}  // namespace straytrace::noise
