// SPDX-License-Identifier: BSD-3-Clause
// Welch spectra of simulated h(t) against the exact spectra, within their own error.
#pragma once

#include <functional>

#include "noise/time_domain/time_domain.hpp"
#include "physics/noise/support.hpp"
#include "spectra/welch.hpp"
#include "support/chi_square.hpp"

namespace straytrace::testing {

// Different transfer functions for the two quadratures, with phase, as in an arm: flat, and 1/f^2.
class TwoQuadratures final : public Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double hz) const override { return 1.0 / std::complex(1.0, -hz / 30); }
  std::complex<double> strain_per_amplitude(PortId, double hz) const override { return -20.0 / (hz * hz); }
  double copies(PortId) const override { return 2; }
  std::string description() const override { return "low pass of Im s, 1/f^2 of Re s"; }
};

struct Simulation {
  CouplingTable table;
  MotionSet motion;
  Interferometer const* ifo;
  std::vector<double> edges;  // Hz, of the bands that are compared
  double duration = 16, rate = 1024, segment = 4;
  std::uint32_t realisations = 100;
};
using Field = std::function<std::vector<PortField>(std::vector<StrayPath>, MotionSeries const&)>;

inline std::vector<PortField> as_it_is(std::vector<StrayPath> paths, MotionSeries const& m) {
  return stray_fields(paths, m);
}
// Negative controls: all static phases equal; phase modulation to first order only.
inline std::vector<PortField> without_static_phases(std::vector<StrayPath> paths, MotionSeries const& m) {
  for (StrayPath& p : paths) p.turns = 0.2;
  return stray_fields(paths, m);
}
inline std::vector<PortField> linear(std::vector<StrayPath> paths, MotionSeries const& m) {
  PortField f{PortId{0}, std::vector<std::complex<double>>(m.times.samples)};
  PhaseTerms const t = phase_terms(paths, m);
  for (std::size_t j = 0; j < t.paths(); ++j)
    for (std::size_t i = 0; i < f.field.size(); ++i) {
      double turns = 0;
      for (std::size_t c = 0; c < t.coordinate.size(); ++c)
        turns += t.phase_sensitivity[j * t.coordinate.size() + c] * t.coordinate[c][i];
      f.field[i] += std::polar(t.amplitude[j], 2 * pi * t.turns[j]) * std::complex(1.0, 2 * pi * turns);
    }
  return {f};
}

// Means over bands of Welch's PSD, lines whose centres are inside.
inline std::vector<double> bands(std::vector<double> const& h, double rate, double segment,
                                 std::vector<double> const& edges) {
  WelchSpectrum const w = welch(h, rate, {static_cast<std::size_t>(segment * rate), 0.5, Window::hann, true});
  std::vector<double> out(edges.size() - 1), lines(out.size());
  for (std::size_t k = 0; k < w.hz.size(); ++k)
    for (std::size_t b = 0; b < out.size(); ++b)
      if (w.hz[k] > edges[b] && w.hz[k] < edges[b + 1]) {
        out[b] += w.psd[k];
        ++lines[b];
      }
  for (std::size_t b = 0; b < out.size(); ++b) out[b] /= lines[b];
  return out;
}

struct Comparison {
  std::vector<double> mean, error, exact;  // PSD by band; standard error from the scatter of the realisations
  double p = 0;                            // of chi-square over the bands
};

// Power that a line of a Hann-windowed spectrum takes from `bins` on either side; its integral is 1 (ENBW of 1.5 bins).
inline double hann_power(double bins) {
  double const rest = 1 - bins * bins, x = pi * bins;
  double const field = std::fabs(rest) < 1e-9 ? 0.5 : std::fabs(x) < 1e-9 ? 1 : std::sin(x) / x / rest;
  return field * field / 1.5;
}

// The exact spectrum as Hann windows see it, averaged over the same lines. Below `lowest` nothing is simulated.
inline std::vector<double> exact_bands(Simulation const& s, double lowest) {
  constexpr double finer = 4, reach = 4;  // points per line of Welch's spectrum; bins to each side
  double const spacing = 1 / s.segment, step = spacing / finer;
  std::vector<double> at, edges;  // Hz; bins around multiples of `step`
  for (double f = step * std::ceil(lowest / step); f < s.edges.back() + reach * spacing; f += step) {
    at.push_back(f);
    edges.push_back(f - step / 2);
  }
  edges.push_back(at.back() + step / 2);
  std::vector<double> const asd = project_noise(s.table, s.motion, *s.ifo, on(edges)).total.asd;
  std::vector<double> out(s.edges.size() - 1), lines(out.size());
  for (std::size_t b = 0; b < out.size(); ++b) {
    for (double f = spacing * std::ceil(s.edges[b] / spacing); f < s.edges[b + 1]; f += spacing, ++lines[b])
      for (std::size_t i = 0; i < at.size(); ++i)
        if (double const bins = (at[i] - f) / spacing; std::fabs(bins) <= reach)
          out[b] += asd[i] * asd[i] * hann_power(bins) / finer;
    out[b] /= lines[b];
  }
  return out;
}

// Every realisation has its own motion and static phases. Edges lie midway between lines of Welch's spectrum.
inline Comparison compared(Simulation const& s, Field const& field = as_it_is) {
  std::size_t const n = s.edges.size() - 1;
  constexpr double lowest = 0.2;  // Hz
  Comparison c{std::vector<double>(n), std::vector<double>(n), {}};
  for (std::uint32_t r = 0; r < s.realisations; ++r) {
    SampleTimes const times{0, s.rate, static_cast<std::size_t>(s.duration * s.rate)};
    MotionSeries const m = draw_motion(s.motion, times, 7, r);
    PathChoice choice{{}, 0, 7, r};
    for (std::uint32_t i = 0; i < s.table.classes.size(); ++i) choice.routes.push_back(i);
    std::vector<PortField> const f = field(stray_paths(s.table, *s.ifo, choice), m);
    std::vector<double> const psd = bands(strain(f, *s.ifo, s.rate, lowest, 0), s.rate, s.segment, s.edges);
    for (std::size_t b = 0; b < n; ++b) {
      c.mean[b] += psd[b] / s.realisations;
      c.error[b] += psd[b] * psd[b] / s.realisations;
    }
  }
  c.exact = exact_bands(s, lowest);
  double statistic = 0;
  for (std::size_t b = 0; b < n; ++b) {
    c.error[b] = std::sqrt((c.error[b] - c.mean[b] * c.mean[b]) / (s.realisations - 1));
    statistic += std::pow((c.mean[b] - c.exact[b]) / c.error[b], 2);
  }
  c.p = chi_square_tail(statistic, static_cast<double>(n));
  return c;
}

// `smallest`: relative error of the PSD that one band alone would show at 5 sigma.
inline void expect_agreement(Comparison const& c, double smallest) {
  EXPECT_GT(c.p, 1e-6);
  for (std::size_t b = 0; b < c.mean.size(); ++b) {
    EXPECT_TRUE(5 * c.error[b] < smallest * c.exact[b]) << "blind in band " << b;
    bool const agrees = std::fabs(c.mean[b] - c.exact[b]) < 5 * c.error[b];
    EXPECT_TRUE(agrees) << "band " << b << ": " << c.mean[b] / c.exact[b];
    if (agrees) record_mean("ratio of the band to theory", c.mean[b] / c.exact[b], c.error[b] / c.exact[b], 1);
  }
}

}  // namespace straytrace::testing
