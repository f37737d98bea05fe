// SPDX-License-Identifier: BSD-3-Clause
// Impulses, the response they ring and when something was injected (R6.01, R6.02).
#include "analysis/coupling/impulse.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::commission_impulse {
namespace {

using namespace straytrace::testing;

constexpr double rate = 1024;

// exp(-t/tau) cos(2 pi f t) as a recursion driven by force: amplitude 1 per unit of one sample.
std::vector<double> ringing(std::vector<double> const& force, double hz, double tau) {
  std::complex<double> const step = std::exp(std::complex<double>(-1 / (tau * rate), 2 * pi * hz / rate));
  std::complex<double> state = 0;
  std::vector<double> y;
  for (double const f : force) {
    state = state * step + f;
    y.push_back(state.real());
  }
  return y;
}

struct Ringing {
  TimeSeries force, target;
};
Ringing ringing(std::uint64_t seed, double noise, double tau = 0.35, double every = 2.5) {
  auto const n = std::size_t(30 * rate);
  std::vector<double> f(n);
  Rng rng(seed, 5, 0, Stream::source);
  for (std::size_t i = 500; i + 2 < n; i += std::size_t(every * rate)) {
    double const newton = 20 * (1 + rng.uniform());
    f[i] = newton;
    f[i + 1] = 1.5 * newton;
    f[i + 2] = newton;
  }
  std::vector<double> const y = ringing(f, 91.3, tau) + 0.5 * ringing(f, 153.7, 0.1);
  return {channel("HAMMER", "N", rate, f + white_noise(n, seed, 0.01)),
          channel("H", "1", rate, y + white_noise(n, seed + 1000, noise))};
}

ImpulseResponse response(Ringing const& k) {
  std::vector<double> const taps = find_taps(k.force, 8, 2);
  EXPECT_EQ(taps.size(), 12u);
  return impulse_response(k.force, k.target, taps, {.length = 2, .low = 20, .high = 300});
}

TEST(Impulse, ResponseAndModesOfAnImpulseR6_02) {
  ImpulseResponse const r = response(ringing(1, 0.05));
  EXPECT_EQ(r.stretches, 12u);
  ASSERT_GE(r.modes.size(), 2u);
  EXPECT_NEAR(r.modes[0].hz, 91.3, 0.01);
  EXPECT_NEAR(r.modes[0].quality / (pi * 91.3 * 0.35), 1, 0.01);
  EXPECT_NEAR(r.modes[0].amplitude / rate, 1, 0.01);  // 1 per sample is rate per second
  EXPECT_NEAR(r.modes[1].hz, 153.7, 0.05);
  EXPECT_NEAR(r.modes[1].quality / (pi * 153.7 * 0.1), 1, 0.05);
  double worst = 0;
  for (std::size_t i = 5; i < 500; ++i) {
    double const t = double(i) / rate;
    double const truth =
        std::exp(-t / 0.35) * std::cos(2 * pi * 91.3 * t) + 0.5 * std::exp(-t / 0.1) * std::cos(2 * pi * 153.7 * t);
    worst = std::max(worst, std::fabs(r.value[i] / rate - truth));
  }
  EXPECT_LT(worst, 0.06) << "of 1.5; the coherence damps what is below the noise";
  // The modes, drawn, are the response: their phases count. Control: cosines that all begin at their top a quarter
  // later.
  auto const off = [&](double turn) {
    double most = 0;
    for (std::size_t i = 5; i < 500; ++i) {
      double sum = 0;
      for (RingDown const& m : r.modes)
        sum += m.amplitude / rate * std::exp(-r.time[i] / m.tau) * std::cos(2 * pi * m.hz * r.time[i] + m.phase + turn);
      most = std::max(most, std::fabs(sum - r.value[i] / rate));
    }
    return most;
  };
  EXPECT_LT(off(0), 0.08);
  EXPECT_GT(off(pi / 2), 0.5) << "negative control";
}

TEST(Impulse, TruncatedRingingGivesTheQ) {  // 2 s of a ring of 1.5 s
  Ringing const k = ringing(2, 0.02, 1.5, 9.5);
  std::vector<double> const taps = find_taps(k.force, 8, 2);
  ImpulseSettings s{.length = 2, .low = 20, .high = 300};
  ImpulseResponse const r = impulse_response(k.force, k.target, taps, s);
  ASSERT_GE(r.modes.size(), 1u);
  EXPECT_NEAR(r.modes[0].quality / (pi * 91.3 * 1.5), 1, 0.02);
  EXPECT_NEAR(r.modes[0].hz, 91.3, 0.005);
  s.cut = false;
  ImpulseResponse const control = impulse_response(k.force, k.target, taps, s);
  ASSERT_GE(control.modes.size(), 1u);
  EXPECT_NEAR(r.modes[0].amplitude / rate, 1, 0.02);
  EXPECT_GT(std::fabs(control.modes[0].amplitude / rate - 1), 0.1) << "control: taken as if it had died away";
}

TEST(Impulse, ErrorsOfFrequencyAndQAreThoseOfRepeatedImpulses) {
  Coverage hz, q;
  for (int i = 0; i < 60; ++i) {
    ImpulseResponse const r = response(ringing(2000 + std::uint64_t(i), 3, 0.2));
    ASSERT_FALSE(r.modes.empty());
    hz.add(r.modes[0].hz, r.modes[0].hz_sigma, 91.3);
    q.add(r.modes[0].quality, r.modes[0].quality_sigma, pi * 91.3 * 0.2);
  }
  for (Coverage const& c : {hz, q}) {
    EXPECT_GT(c.share(), 0.55);
    EXPECT_LT(c.share(), 0.80);
  }
}

// Impulses on a mode of 91.3 Hz at these distances, and its fit without the list of earlier impulses.
struct Rung {
  RingDown mode, alone;
};
template <class Distance>
Rung rung(std::uint64_t seed, double tau, double noise, Distance const& distance) {
  auto const n = std::size_t(30 * rate);
  std::vector<double> f(n), starts;
  Rng rng(seed, 6, 0, Stream::source);
  for (double t = 0.5; t < 27.5; t += distance(rng)) {
    f[std::size_t(t * rate)] = 20 * (1 + rng.uniform());
    starts.push_back(1e9 + std::floor(t * rate) / rate);
  }
  std::vector<double> const y = ringing(f, 91.3, tau);
  ImpulseResponse const r =
      impulse_response(channel("HAMMER", "N", rate, f), channel("H", "1", rate, y + white_noise(n, seed + 700, noise)),
                       starts, {.length = 2, .low = 20, .high = 300, .modes = 1});
  EXPECT_EQ(r.modes.size(), 1u);
  auto const top = std::size_t(std::lround(91.3 / r.hz[1]));
  return {r.modes.empty() ? RingDown() : r.modes[0], fit_ring_down(r, top - 10, top + 10, 2 - 0.01)};
}

// The impulse before still rings: 10 % of it is there when the next falls, at any phase.
TEST(Impulse, RemainingRingingIsSubtractedFromTheAmplitude) {
  Coverage amplitude, hz, q, alone;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    Rung const r = rung(seed, 0.9, 1, [](Rng& rng) { return 2.1 + 0.1 * rng.uniform(); });
    amplitude.add(r.mode.amplitude, r.mode.amplitude_sigma, rate);
    alone.add(r.alone.amplitude, r.alone.amplitude_sigma, rate);
    hz.add(r.mode.hz, r.mode.hz_sigma, 91.3);
    q.add(r.mode.quality, r.mode.quality_sigma, pi * 91.3 * 0.9);
  }
  for (Coverage const& c : {amplitude, hz, q}) EXPECT_NEAR(c.share(), 0.683, 0.13);
  EXPECT_LT(alone.share(), 0.3) << "control: as if each impulse fell on silence";
}

// Impulses at equal distances, of 183 periods here: what is left adds up.
TEST(Impulse, RingingOfRegularImpulsesIsSubtracted) {
  Rung const r = rung(5, 0.9, 0.1, [](Rng&) { return 183 / 91.3; });
  EXPECT_NEAR(r.mode.amplitude / rate, 1, 0.01);
  EXPECT_GT(r.alone.amplitude / rate, 1.08) << "negative control";
}

// At Q = 5 the line at negative frequency reaches over.
TEST(Impulse, LowQIsNotBiased) {
  Coverage q, amplitude;
  double pull = 0;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    RingDown const m = rung(seed, 5 / (pi * 91.3), 1, [](Rng&) { return 2.1; }).mode;
    q.add(m.quality, m.quality_sigma, 5);
    amplitude.add(m.amplitude, m.amplitude_sigma, rate);
    pull += (m.quality - 5) / m.quality_sigma / 80;
  }
  for (Coverage const& c : {q, amplitude}) EXPECT_GT(c.share(), 0.5);
  EXPECT_NEAR(pull, 0, 0.6);
}

// One mode is fitted where two ring: errors are those of what the fit leaves.
TEST(Impulse, ErrorsGrowNearAnotherMode) {
  auto const n = std::size_t(30 * rate);
  std::vector<double> f(n), starts;
  for (double t = 0.5; t < 27.5; t += 2.5) {
    f[std::size_t(t * rate)] = 20;
    starts.push_back(1e9 + std::floor(t * rate) / rate);
  }
  std::vector<double> const y = ringing(f, 91.3, 0.3) + 0.5 * ringing(f, 96, 0.3);
  ImpulseResponse const r =
      impulse_response(channel("HAMMER", "N", rate, f), channel("H", "1", rate, y + white_noise(n, 3, 0.05)), starts,
                       {.length = 2, .low = 20, .high = 300, .modes = 1});
  ASSERT_EQ(r.modes.size(), 1u);
  RingDown const& m = r.modes[0];
  EXPECT_GT(m.chi_square, 20 * m.degrees) << "the fit is not good";
  EXPECT_NEAR(m.quality, pi * 91.3 * 0.3, 3 * m.quality_sigma);
  EXPECT_NEAR(m.hz, 91.3, 3 * m.hz_sigma);
}

// Impulses of one place that couple by 20 % more or less: the error is that of their mean. Control: the fit of the mean
// alone.
TEST(Impulse, ImpulsesThatDifferAreInTheErrorOfTheAmplitude) {
  auto const n = std::size_t(30 * rate);
  Coverage amplitude, alone;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    std::vector<double> f(n), driven(n), starts;
    Rng rng(seed, 8, 0, Stream::source);
    for (double t = 0.5; t < 27.5; t += 2.5) {
      auto const i = std::size_t(t * rate);
      f[i] = 20;
      driven[i] = 20 * (1 + 0.35 * (2 * rng.uniform() - 1));  // 20 % rms
      starts.push_back(1e9 + std::floor(t * rate) / rate);
    }
    ImpulseResponse const r =
        impulse_response(channel("HAMMER", "N", rate, f),
                         channel("H", "1", rate, ringing(driven, 91.3, 0.3) + white_noise(n, seed, 0.1)), starts,
                         {.length = 2, .low = 20, .high = 300, .modes = 1});
    ASSERT_EQ(r.modes.size(), 1u);
    auto const top = std::size_t(std::lround(91.3 / r.hz[1]));
    RingDown const control = fit_ring_down(r, top - 10, top + 10, 2 - 0.01);
    amplitude.add(r.modes[0].amplitude, r.modes[0].amplitude_sigma, rate);
    alone.add(control.amplitude, control.amplitude_sigma, rate);
  }
  EXPECT_NEAR(amplitude.share(), 0.66, 0.15);
  EXPECT_LT(alone.share(), 0.3);
}

TEST(Impulse, ASingleImpulseIsAnError) {
  Ringing const k = ringing(1, 0.1);
  std::vector<double> const one{1e9 + 3};
  EXPECT_THROW(impulse_response(k.force, k.target, one, {}), InputError);
}

TEST(Events, InjectionIsFoundInTimeAndFrequencyR6_01) {
  constexpr double fs = 256;
  auto const n = std::size_t(200 * fs);
  int found = 0, spurious = 0;
  EventSettings const s{.welch = {.segment = 256}, .averages = 20};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::vector<double> x = white_noise(n, seed);
    for (auto i = std::size_t(100 * fs); i < std::size_t(130 * fs); ++i)  // 3 x quiet in the bin at 40 Hz
      x[i] += std::sqrt(2 * 1.5 * 8 * 2 / fs) * std::sin(2 * pi * 40 * double(i) / fs);
    TimeSeries const record = channel("H", "1", fs, x), quiet = channel("H", "1", fs, white_noise(n, seed + 50));
    auto const events = find_events(record, quiet, s);
    for (LoudStretch const& e : events) {
      bool const right =
          e.hz == 40 && e.from <= 1e9 + 110 && e.to >= 1e9 + 120 && e.from >= 1e9 + 85 && e.to <= 1e9 + 145;
      (right ? found : spurious) += 1;
      if (!right) continue;
      EXPECT_GT(e.significance, 5);
      EXPECT_NEAR(e.ratio, 3, 0.7);
    }
  }
  EXPECT_EQ(found, 10);
  EXPECT_EQ(spurious, 0);
}

}  // namespace
}  // namespace straytrace::commission_impulse
