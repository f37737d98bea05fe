// SPDX-License-Identifier: BSD-3-Clause
// Tapping with known answers (R6.02).
#include "analysis/coupling/taps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::commission_taps {
namespace {

using namespace straytrace::testing;

constexpr double rate = 512, resonance = 91, start = 1e9, each = 20;
constexpr WelchSettings settings{.segment = 512};

// A mode of the target that answers to force: two-pole filter of Q about 10.
std::vector<double> answered(std::vector<double> const& force) {
  double const r = std::exp(-pi * resonance / (10 * rate)), c = 2 * r * std::cos(2 * pi * resonance / rate);
  std::vector<double> y(force.size());
  for (std::size_t i = 2; i < y.size(); ++i) y[i] = force[i] + c * y[i - 1] - r * r * y[i - 2];
  return y;
}

struct Taps {
  TapSeries series;
  std::vector<TapPlace> places;
  GpsSpan quiet{start, start + each};
};

struct Impulse {
  std::string place;
  double factor, newton;
  double saturates = 0;  // target amplitude at which coupling folds, as sin() does; 0: linear
};

// Quiet for 20 s, then each place for 20 s: an impulse each second, its force random within a factor of four.
Taps tapping(std::vector<Impulse> const& impulses, std::uint64_t seed) {
  auto const n = std::size_t(each * rate);
  std::vector<double> force(n), heard(n);
  Taps t;
  Rng rng(seed, 1, 0, Stream::source);
  for (Impulse const& k : impulses) {
    std::vector<double> f(n);
    for (std::size_t i = 200; i < n; i += std::size_t(rate))
      f[i + std::size_t(100 * rng.uniform())] = k.newton * std::pow(4, rng.uniform());
    std::vector<double> y = k.factor * answered(f);
    for (double& v : y)
      if (k.saturates > 0) v = k.saturates * std::sin(v / k.saturates);
    t.places.push_back({k.place, start + double(force.size()) / rate, each, ""});
    force.insert(force.end(), f.begin(), f.end());
    heard.insert(heard.end(), y.begin(), y.end());
  }
  t.series.force = channel("HAMMER", "N", rate, force + white_noise(force.size(), 3 * seed, 0.05), start);
  t.series.target = channel("H", "1", rate, heard + white_noise(heard.size(), 3 * seed + 1, 1), start);
  t.series.local = {channel("ACC_A", "m/s^2", rate, 3.0 * heard + white_noise(heard.size(), 3 * seed + 2, 1), start)};
  return t;
}

// The strongest peak near the resonance.
TapPeak const* at_resonance(std::vector<TapPeak> const& peaks) {
  TapPeak const* best = nullptr;
  for (TapPeak const& p : peaks)
    if (std::fabs(p.hz - resonance) < 5 && (!best || p.places[0].target_ratio > best->places[0].target_ratio))
      best = &p;
  return best;
}

TEST(Taps, RightPlaceComesFirstAtRatioTwoR6_02) {
  constexpr int trials = 60;
  int right = 0, seen = 0;
  Coverage coverage;
  double lead = 0;
  for (int i = 0; i < trials; ++i) {
    auto const seed = std::uint64_t(i);
    // The guilty one is struck more softly, so that the target alone would name another place.
    Taps const t = tapping({{"tower", 1, 32}, {"link", 2, 8}, {"bench", 1, 16}, {"pipe", 0.3, 16}}, 50 + seed);
    auto const peaks = tap_peaks(t.series, t.places, t.quiet, settings, {});
    TapPeak const* const p = at_resonance(peaks);
    if (!p || p->places.size() < 3) continue;
    ++seen;
    right += p->places[0].place == "link";
    lead += p->lead / trials;
    std::map<std::string, TapAnswer> by;
    for (TapAnswer const& a : p->places) by[a.place] = a;
    double const value = std::log(by["tower"].coupling / by["bench"].coupling);  // truth 0
    coverage.add(value,
                 std::hypot(by["tower"].coupling_sigma / by["tower"].coupling,
                            by["bench"].coupling_sigma / by["bench"].coupling),
                 0);
    EXPECT_EQ(p->places[0].local, "ACC_A");
    EXPECT_FALSE(by["tower"].target_ratio < by["link"].target_ratio) << "control: ranked by the target alone";
  }
  EXPECT_EQ(seen, trials);
  EXPECT_GE(right, 0.95 * trials);
  EXPECT_GT(lead, 3);
  EXPECT_GT(coverage.share(), 0.55);
  EXPECT_LT(coverage.share(), 0.80);
}

TEST(Taps, RatioIsOfRatiosR6_02) {
  Taps const t = tapping({{"link", 2, 30}}, 7);
  auto const peaks = tap_peaks(t.series, t.places, t.quiet, settings, {});
  TapPeak const* const p = at_resonance(peaks);
  ASSERT_TRUE(p);
  TapAnswer const& a = p->places[0];
  EXPECT_NEAR(a.ratio, a.target_ratio / a.force_ratio, 1e-9 * a.ratio);
  double const w = 2 * pi * p->hz / rate, r = std::exp(-pi * resonance / (10 * rate));
  std::complex<double> const z = std::polar(1.0, -w);
  double const gain = 2 / std::abs(1.0 - 2 * r * std::cos(2 * pi * resonance / rate) * z + r * r * z * z);
  EXPECT_NEAR(a.coupling / gain, 1, 0.1);  // the Hann window spans half a width of the mode
  EXPECT_TRUE(std::isnan(p->lead));
}

TEST(Taps, SlopeOfRepeatsDistinguishesLinearFromWrappedR6_02) {
  int linear = 0, folded = 0;
  constexpr int trials = 20;
  for (int i = 0; i < trials; ++i) {
    auto const impulses = [&](double fold) {
      return std::vector<Impulse>{{"link", 2, 3, fold}, {"link", 2, 8, fold}, {"link", 2, 20, fold}};
    };
    auto const flagged = [&](double fold) {
      Taps const t = tapping(impulses(fold), 400 + std::uint64_t(i));
      auto const peaks = tap_peaks(t.series, t.places, t.quiet, settings, {});
      TapPeak const* const p = at_resonance(peaks);
      EXPECT_TRUE(p && p->places[0].repeats == 3);
      return p->places[0].not_linear;
    };
    linear += flagged(0);
    folded += flagged(12);
  }
  EXPECT_LE(linear, 2);
  EXPECT_EQ(folded, trials);
}

TEST(Taps, QuietPlacesAreNotKept) {
  int kept = 0;
  for (int i = 0; i < 10; ++i) {
    Taps const t = tapping({{"far", 0, 8}, {"link", 2, 0.01}}, 900 + std::uint64_t(i));
    kept += int(tap_peaks(t.series, t.places, t.quiet, settings, {}).size());
  }
  EXPECT_EQ(kept, 0);
}

// A place whose answer is lost in the noise has a limit that its coupling is below in 95 % of all trials, not far above
// what the noise lets one see.
TEST(Taps, SilentPlacesHaveLimitsR6_02) {
  constexpr int trials = 60;
  int silent = 0, holds = 0, tenth = 0;
  for (int i = 0; i < trials; ++i) {
    Taps const t = tapping({{"link", 2, 8}, {"pipe", 0.02, 16}}, 1300 + std::uint64_t(i));
    auto const peaks = tap_peaks(t.series, t.places, t.quiet, settings, {});
    TapPeak const* const p = at_resonance(peaks);
    ASSERT_TRUE(p);
    if (p->limits.empty()) continue;
    ++silent;
    EXPECT_EQ(p->limits[0].place, "pipe");
    double const truth = p->places[0].coupling * 0.02 / 2;  // the same mode, a hundredth of it
    holds += truth <= p->limits[0].coupling;
    tenth += truth <= p->limits[0].coupling / 10;
    EXPECT_LT(p->limits[0].coupling, p->places[0].coupling / 5);
  }
  EXPECT_GE(silent, trials / 2);
  EXPECT_GE(holds, 0.95 * silent - 3 * std::sqrt(0.05 * 0.95 * silent));
  EXPECT_LT(tenth, 0.5 * silent) << "control: a limit ten times too low";
}

TEST(Taps, ValidListsAreReadOthersAreErrors) {
  auto const places = parse_tap_list(
      "# of May\nplace,start,duration,strength\n\"tower\", 1000000000 ,20,soft\nlink,1e9,20\n", "taps.csv");
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].name, "tower");
  EXPECT_EQ(places[0].strength, "soft");
  EXPECT_EQ(places[1].start, 1e9);
  auto const said = [](char const* text) {
    try {
      parse_tap_list(text, "taps.csv");
    } catch (InputError const& e) {
      return std::string(e.what());
    }
    return std::string("taken");
  };
  EXPECT_EQ(said("place,start,duration\ntower,now,20\n,1,-1\n"),
            "taps.csv:2:7: error: 'now' is not a number\n  write a finite number without unit; the unit belongs in the "
            "header\ntaps.csv:3:1: error: a place without a name\n  write it in column 'place'\n"
            "taps.csv:3:4: error: a duration of -1 s\n  taps of about 20 s are usual");
  EXPECT_EQ(said("place,start,duration\ntower,10,5,20\n"),
            "taps.csv:2:1: error: 4 values, but the header has 3 columns\n  use decimal points, not decimal commas: "
            "1.5, not 1,5");
  EXPECT_NE(said("place,start\n").find("no column 'duration'"), std::string::npos);
  EXPECT_NE(said("place,start [m],duration\na,1,2\n").find("'start' is in m, not in s"), std::string::npos);
  EXPECT_NE(said("").find("the table has no rows"), std::string::npos);
}

}  // namespace
}  // namespace straytrace::commission_taps
