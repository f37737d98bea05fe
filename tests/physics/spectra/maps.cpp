// SPDX-License-Identifier: BSD-3-Clause
// Whitening, rms within bands, spectrograms, constant-Q tiles, filters (R2.15; Parseval).
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.hpp"
#include "spectra/filters.hpp"
#include "spectra/welch.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::signal_maps {
namespace {

using testing::series_with;
using testing::white_noise;
constexpr double rate = 256;

TimeSeries coloured(std::uint64_t seed, std::size_t seconds) {
  testing::Oscillator const system{20, 3, rate};
  return series_with(system.driven(white_noise(256 * seconds, seed)), rate, "m");
}

TEST(Whitening, MakesTheSpectrumFlat) {
  TimeSeries const s = coloured(1, 400), all = whitened(s, {.segment = 1024}), w = cut(all, {1e9 + 2, 1e9 + 398});
  EXPECT_EQ(w.unit, "1");
  EXPECT_NEAR(std::pow(rms(w.samples), 2), 1, 0.02);
  WelchSpectrum const after = welch(w.samples, rate, {.segment = 512}),
                      before = welch(s.samples, rate, {.segment = 512});
  double chi = 0, lines = 0;
  for (std::size_t k = 4; k < 240; k += 2, ++lines)
    chi += std::pow((after.psd[k] * rate / 2 - 1) / after.sigma[k] * after.psd[k], 2);
  EXPECT_LT(chi / lines, 1.5) << "flat within its error";
  EXPECT_GT(before.psd[40] / before.psd[200], 1e4) << "the record was not flat";
}

TEST(BandRms, PowersAddUpToTheMeanSquare) {  // Parseval: whole band of an unwindowed, untouched record, split anywhere
  std::vector<double> const x = white_noise(4096, 3);
  WelchSettings const whole{.segment = 4096, .overlap = 0, .window = Window::rectangular, .detrend = Detrend::none};
  WelchSpectrum const s = welch(x, rate, whole);
  double const all = band_power(s, whole, 0, rate / 2).power;
  EXPECT_NEAR(all, std::pow(rms(x), 2), 1e-12);
  EXPECT_NEAR(band_power(s, whole, 0, 17.3).power + band_power(s, whole, 17.3, rate / 2).power, all, 1e-12);
  for (double const overlap : {0.0, 0.5})  // and on average for windows and overlaps
    for (Window const window : {Window::hann, Window::tukey, Window::flat_top, Window::blackman_harris}) {
      WelchSettings const settings{
          .segment = 256, .overlap = overlap, .window = window, .window_parameter = 0.3, .detrend = Detrend::none};
      std::vector<double> const long_one = white_noise(256 * 400, 4);
      BandPower const p = band_power(welch(long_one, rate, settings), settings, 0, rate / 2);
      EXPECT_NEAR(p.power, std::pow(rms(long_one), 2), 4 * p.sigma);
      EXPECT_LT(p.sigma, 0.02);
    }
}

TEST(BandRms, ErrorIsTheSpreadOfTrials) {  // power of 10 to 30 Hz: 1/sqrt(B T) of it, whatever the window shares
  WelchSettings const settings{.segment = 512};
  double sum = 0, square = 0, stated = 0;
  constexpr int trials = 300;
  for (int i = 0; i < trials; ++i) {
    BandPower const p =
        band_power(welch(white_noise(512 * 6, 50 + std::uint64_t(i)), rate, settings), settings, 10, 30);
    sum += p.power / trials;
    square += p.power * p.power / trials;
    stated += p.sigma / trials;
  }
  EXPECT_NEAR(sum, 20 * 2 / rate, 0.01);
  EXPECT_NEAR(stated / std::sqrt(square - sum * sum), 1, 0.15);
}

TEST(BandRms, TrendSeesABurst) {
  TimeSeries s = series_with(white_noise(256 * 60, 5, 0.01), rate);
  for (std::size_t i = 256 * 30; i < 256 * 32; ++i) s.samples[i] += std::sin(2 * pi * 20 * double(i) / rate);
  RmsTrend const t = rms_trend(s, 15, 25, 2), other = rms_trend(s, 40, 60, 2);
  ASSERT_EQ(t.time.size(), 30u);
  EXPECT_EQ(t.time[15], 1e9 + 31);
  EXPECT_NEAR(t.rms[15], std::sqrt(0.5), 0.03);
  EXPECT_LT(t.rms[10], 0.02);
  EXPECT_LT(other.rms[15], 0.1);
}

TEST(Spectrogram, StridesAreSpectraAndTheMedianIsOne) {
  TimeSeries const s = series_with(white_noise(256 * 64, 6), rate);
  Spectrogram const map = spectrogram(s, 2, {.segment = 256}), flat = normalised(map);
  ASSERT_EQ(map.time.size(), 32u);
  EXPECT_EQ(map.time[0], 1e9 + 1);
  WelchSpectrum const third = welch(std::span(s.samples).subspan(1024, 512), rate, {.segment = 256});
  for (std::size_t k = 0; k < map.hz.size(); ++k) EXPECT_EQ(map.at(2, k), std::sqrt(third.psd[k]));
  for (std::size_t k = 0; k < map.hz.size(); k += 10) {
    std::size_t above = 0;
    for (std::size_t i = 0; i < 32; ++i) above += flat.at(i, k) > 1 ? 1 : 0;
    EXPECT_EQ(above, 16u);
  }
}

TEST(QTransform, FindsABurstAndCountsNoise) {
  TimeSeries const noise = series_with(white_noise(256 * 64, 7), rate);
  QSettings const q{.q = 8, .low_hz = 20, .high_hz = 60, .columns = 100000};
  Spectrogram const quiet = q_transform(noise, q);
  double above = 0;
  for (double const e : quiet.value) above += e > 3 ? 1.0 / double(quiet.value.size()) : 0;
  EXPECT_NEAR(above, std::exp(-3), 0.012)
      << "exponential: the control that divides by the median alone has exp(-3 ln 2)";
  TimeSeries burst = noise;
  for (std::size_t i = 0; i < burst.samples.size(); ++i) {
    double const t = double(i) / rate - 33;
    burst.samples[i] += 3 * std::exp(-std::pow(t / 0.05, 2)) * std::sin(2 * pi * 37 * t);
  }
  Spectrogram const seen = q_transform(burst, {.q = 8, .low_hz = 20, .high_hz = 60});
  std::size_t const top = std::size_t(std::max_element(seen.value.begin(), seen.value.end()) - seen.value.begin());
  EXPECT_NEAR(seen.time[top / seen.hz.size()], 1e9 + 33, 0.1);
  EXPECT_NEAR(seen.hz[top % seen.hz.size()], 37, 3);
  EXPECT_GT(seen.value[top], 30);
}

double amplitude(std::vector<double> const& x) {
  return std::sqrt(2.0) * rms(std::span(x).subspan(x.size() / 4, x.size() / 2));
}

TEST(Filters, PassTheirBandWithoutPhase) {
  auto const tone = [](double hz) {
    std::vector<double> x(256 * 40);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(2 * pi * hz * double(i) / rate);
    return series_with(x, rate);
  };
  TimeSeries const in = tone(16);
  TimeSeries const kept = band_passed(in, 5, 50);
  for (std::size_t i = 2560; i < 7680; i += 7) ASSERT_NEAR(kept.samples[i], in.samples[i], 1e-3);
  EXPECT_NEAR(amplitude(band_passed(tone(50), 5, 50).samples), 0.5, 0.01) << "both ways: -6 dB at the edge";
  EXPECT_LT(amplitude(band_passed(tone(1), 5, 50).samples), 1e-4);
  EXPECT_LT(amplitude(notched(tone(50), 50).samples), 1e-3);
  EXPECT_NEAR(amplitude(notched(tone(40), 50).samples), 1, 0.01);
}

TEST(Filters, DecimationDoesNotAlias) {  // to 64 Hz: 10 Hz stays, 54 Hz would fold onto 10 Hz
  auto const tone = [](double hz) {
    std::vector<double> x(256 * 40);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(2 * pi * hz * double(i) / rate);
    return series_with(x, rate);
  };
  TimeSeries const slow = decimated(tone(10), 4);
  EXPECT_EQ(slow.rate, 64);
  for (std::size_t i = 640; i < 1920; ++i) ASSERT_NEAR(slow.samples[i], std::sin(2 * pi * 10 * double(i) / 64), 2e-4);
  EXPECT_LT(amplitude(decimated(tone(54), 4).samples), 2e-4);
}

TEST(Series, AlignedSeriesHaveTheSlowerRate) {
  std::vector<double> fast(2560), slow(320);
  for (std::size_t i = 0; i < fast.size(); ++i) fast[i] = std::sin(2 * pi * 3 * double(i) / 256);
  for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = double(i);
  TimeSeries const a = series_with(fast, 256, "m", 1e9), b = series_with(slow, 32, "m", 1e9 + 2);
  std::vector<TimeSeries> const both = aligned({a, b});
  EXPECT_EQ(both[0].start, 1e9 + 2);
  EXPECT_EQ(both[0].rate, 32);
  ASSERT_EQ(both[0].samples.size(), both[1].samples.size());
  EXPECT_EQ(both[0].samples.size(), 8u * 32);
  for (std::size_t i = 32; i < 200; ++i)
    ASSERT_NEAR(both[0].samples[i], std::sin(2 * pi * 3 * (2 + double(i) / 32)), 2e-4);
  EXPECT_THROW(aligned({a, series_with(slow, 32, "m", 2e9)}), InputError);
  EXPECT_THROW(aligned({a, series_with(slow, 30, "m", 1e9)}), InputError);
  EXPECT_THROW(aligned({a, series_with(slow, 32, "m", 1e9 + 2.001)}), InputError);
  EXPECT_THROW(cut(a, {1e9 - 1, 1e9 + 5}), InputError);
  EXPECT_EQ(cut(a, {1e9 + 1, 1e9 + 5}).samples.size(), 4u * 256);
}

}  // namespace
}  // namespace straytrace::signal_maps
