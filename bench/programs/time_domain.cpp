// SPDX-License-Identifier: BSD-3-Clause
#include "time_domain.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <functional>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "noise/time_domain/phase_sum.hpp"
#include "spectra/welch.hpp"

namespace straytrace::bench {
namespace {

using Samples = std::vector<double>;

struct Problem {
  std::vector<Samples> motion;
  PhaseTerms terms;
};

// Tones of 1 um, 5 Hz, in each coordinate; phase sensitivities up to 2k.
Problem problem(std::size_t paths, std::size_t coordinates, std::size_t samples, double rate) {
  Problem p;
  Rng rng(1, 0, 0, Stream::source);
  double const two_over_lambda = 2 / 1064e-9;  // turns per metre of one bounce
  for (std::size_t c = 0; c < coordinates; ++c) {
    p.motion.emplace_back(samples);
    for (std::size_t i = 0; i < samples; ++i) {
      double const cycles = 5 * double(i) / rate;
      p.motion[c][i] = 1e-6 * std::sin(2 * pi * (cycles - std::floor(cycles)) + double(c));
    }
  }
  p.terms.coordinate.assign(p.motion.begin(), p.motion.end());
  for (std::size_t j = 0; j < paths; ++j) {
    p.terms.amplitude.push_back(1 / std::sqrt(double(paths)));
    p.terms.turns.push_back(rng.uniform());
    for (std::size_t c = 0; c < coordinates; ++c)
      p.terms.phase_sensitivity.push_back(two_over_lambda * (2 * rng.uniform() - 1));
  }
  return p;
}

double seconds(std::function<void()> const& work) {
  auto const start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A loop over sin and cos, in order.
std::vector<std::complex<double>> plain_sum(PhaseTerms const& t) {
  std::vector<std::complex<double>> out(t.coordinate[0].size());
  for (std::size_t j = 0; j < t.paths(); ++j)
    for (std::size_t i = 0; i < out.size(); ++i) {
      double turns = t.turns[j];
      for (std::size_t c = 0; c < t.coordinate.size(); ++c)
        turns += t.phase_sensitivity[j * t.coordinate.size() + c] * t.coordinate[c][i];
      out[i] += std::complex(t.amplitude[j] * std::cos(2 * pi * turns), t.amplitude[j] * std::sin(2 * pi * turns));
    }
  return out;
}

double largest_difference(std::vector<std::complex<double>> const& a, std::vector<std::complex<double>> const& b) {
  double d = 0;
  for (std::size_t i = 0; i < a.size(); ++i) d = std::max(d, std::abs(a[i] - b[i]));
  return d;
}

void phase_sum_lines(std::ostream& out, std::size_t coordinates, std::vector<std::complex<double>>& sum) {
  Problem const p = problem(200, coordinates, 6 * 32768, 32768);
  std::vector<std::complex<double>> plain;
  double const theirs = seconds([&] { plain = plain_sum(p.terms); });
  for (unsigned const threads : {1u, 0u}) {
    double const ours = seconds([&] { sum = phase_sum(p.terms, threads); });
    out << nlohmann::ordered_json{{"name", "phase sum, 200 paths, " + std::to_string(coordinates) +
                                               " coordinates, 6 s x 32768 Hz"},
                                  {"threads", threads ? "1" : "all"},
                                  {"ours", ours},
                                  {"theirs", theirs},
                                  {"ratio", theirs / ours},
                                  {"error", largest_difference(sum, plain)}}
        << '\n';
  }
}

void many_paths(std::ostream& out, std::size_t coordinates) {
  Problem const p = problem(100000, coordinates, 100000, 32768);
  for (unsigned const threads : {1u, 0u})
    out << nlohmann::ordered_json{{"name", "1e5 paths x 1e5 samples, " + std::to_string(coordinates) + " coordinates"},
                                  {"threads", threads ? "1" : "all"},
                                  {"ours", seconds([&] { phase_sum(p.terms, threads); })}}
        << '\n';
}

}  // namespace

void time_domain(std::ostream& out, bool long_ones) {
  std::vector<std::complex<double>> sum;
  phase_sum_lines(out, 1, sum);
  phase_sum_lines(out, 2, sum);
  Samples quadrature;
  for (std::complex<double> const s : sum) quadrature.push_back(s.imag());
  WelchSettings settings;
  settings.segment = 32768;
  double const welch_seconds = seconds([&] { welch(quadrature, 32768, settings); });
  out << nlohmann::ordered_json{{"name", "Welch, 6 s x 32768 Hz, segments of 1 s"},
                                {"threads", "1"},
                                {"ours", welch_seconds}}
      << '\n';
  many_paths(out, 1);
  if (long_ones) many_paths(out, 3);
}

}  // namespace straytrace::bench
